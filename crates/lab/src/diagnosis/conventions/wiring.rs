//! Channels that stand in each other's place or have the wrong sign, as signed permutations.

use tactpad_core::quantity::CHANNELS;

/// Channels of a module.
const AXES: usize = 3;
const MODULES: usize = CHANNELS / AXES;

/// What each channel of the pad is read as: uₖ = σₖ yₚ₍ₖ₎ of the readings y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SignedPermutation {
    from: [usize; CHANNELS],
    sign: [f64; CHANNELS],
}

impl SignedPermutation {
    /// As it should be.
    pub(crate) const IDENTITY: Self = Self { from: [0, 1, 2, 3, 4, 5, 6, 7, 8], sign: [1.0; CHANNELS] };

    /// `None` where two channels come from one.
    pub(crate) fn new(from: [usize; CHANNELS], sign: [f64; CHANNELS]) -> Option<Self> {
        let is_taken = |channel: usize| from.contains(&channel);
        (0..CHANNELS).all(is_taken).then_some(Self { from, sign })
    }

    /// The pad's channels by the readings.
    pub(crate) fn of(&self, readings: &[f64; CHANNELS]) -> [f64; CHANNELS] {
        std::array::from_fn(|k| self.sign[k] * readings[self.from[k]])
    }

    /// This one of what another one gives.
    pub(crate) fn after(&self, first: &Self) -> Self {
        Self {
            from: self.from.map(|from| first.from[from]),
            sign: std::array::from_fn(|k| self.sign[k] * first.sign[self.from[k]]),
        }
    }

    /// The readings by the pad's channels.
    pub(crate) fn inverse(&self) -> Self {
        let mut inverse = Self::IDENTITY;
        for (k, from) in self.from.into_iter().enumerate() {
            (inverse.from[from], inverse.sign[from]) = (k, self.sign[k]);
        }
        inverse
    }

    /// Pairs of channels in each other's place, and of a larger circle each channel with the one that it comes from.
    pub(crate) fn exchanged(&self) -> Vec<[usize; 2]> {
        let moved = (0..CHANNELS).filter(|k| self.from[*k] != *k);
        let is_first = |k: &usize| *k < self.from[*k] || self.from[self.from[*k]] != *k;
        moved.filter(is_first).map(|k| [k, self.from[k]]).collect()
    }

    /// Channels of the wrong sign.
    pub(crate) fn reversed(&self) -> Vec<usize> {
        (0..CHANNELS).filter(|k| self.sign[*k] < 0.0).collect()
    }

    /// How many mistakes it takes: cables of modules, supplies and single channels.
    pub(crate) fn mistakes(&self) -> usize {
        let of_module = |module: usize| self.from[AXES * module] / AXES;
        let are_cables = (0..CHANNELS).all(|k| self.from[k] == AXES * of_module(k / AXES) + k % AXES);
        let moved = (0..CHANNELS).filter(|k| self.from[*k] != *k).count();
        let moves = if are_cables { usize::from(moved > 0) } else { moved.div_ceil(2) };
        let signs = |all: f64| {
            let of_module = |module: usize| {
                let reversed = (0..AXES).filter(|axis| all * self.sign[AXES * module + axis] < 0.0).count();
                if reversed == AXES { 1 } else { reversed }
            };
            (0..MODULES).map(of_module).sum::<usize>()
        };
        moves + signs(1.0).min(1 + signs(-1.0))
    }

    /// All that are one mistake: two channels exchanged, one reversed, cables of two modules exchanged or of all three in a circle, a module's
    /// supply reversed.
    pub(crate) fn single_mistakes() -> Vec<Self> {
        let exchanged = |pairs: &[[usize; 2]]| {
            let mut exchange = Self::IDENTITY;
            pairs.iter().for_each(|[one, other]| exchange.from.swap(*one, *other));
            exchange
        };
        let reversed = |channels: &[usize]| {
            let mut reversal = Self::IDENTITY;
            channels.iter().for_each(|k| reversal.sign[*k] = -1.0);
            reversal
        };
        let channels = |module: usize| [0, 1, 2].map(|axis| AXES * module + axis);
        let mut all: Vec<Self> = (0..CHANNELS)
            .flat_map(|one| (one + 1..CHANNELS).map(move |other| [one, other]))
            .map(|pair| exchanged(&[pair]))
            .collect();
        for (one, other) in [(0, 1), (0, 2), (1, 2)] {
            let [one, other] = [channels(one), channels(other)];
            all.push(exchanged(&[0, 1, 2].map(|axis| [one[axis], other[axis]])));
        }
        let circle = Self { from: std::array::from_fn(|k| (k + AXES) % CHANNELS), ..Self::IDENTITY };
        all.extend([circle, circle.inverse()]);
        all.extend((0..CHANNELS).map(|k| reversed(&[k])));
        all.extend((0..MODULES).map(|module| reversed(&channels(module))));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_follow_each_other_and_come_back() {
        let readings: [f64; CHANNELS] = std::array::from_fn(|k| 1.0 + k as f64);
        let all = SignedPermutation::single_mistakes();
        assert_eq!(all.len(), 36 + 3 + 2 + 9 + 3);
        for (one, other) in all.iter().zip(all.iter().rev()) {
            assert_eq!(one.after(other).of(&readings), one.of(&other.of(&readings)));
            assert_eq!(one.inverse().of(&one.of(&readings)), readings);
            assert_eq!(one.mistakes(), 1, "{one:?}");
        }
    }

    #[test]
    fn mistakes_are_counted_by_cables_and_supplies() {
        assert_eq!(SignedPermutation::IDENTITY.mistakes(), 0);
        let all_reversed = SignedPermutation { sign: [-1.0; CHANNELS], ..SignedPermutation::IDENTITY };
        assert_eq!((all_reversed.mistakes(), all_reversed.reversed().len()), (1, 9));
        let circle = SignedPermutation::single_mistakes()[39];
        assert_eq!(circle.exchanged().len(), 9);
    }
}
