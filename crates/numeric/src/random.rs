//! Repeatable pseudo-random numbers: whatever is drawn depends on a seed and on nothing else.

/// A stream of pseudo-random numbers that depends on nothing but its seed.
///
/// Source: G. L. Steele, D. Lea and C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA
/// 2014 (SplitMix64).
#[derive(Clone, Debug)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// The stream of this seed.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Where the stream stands: [`Self::new`] with it goes on from here.
    pub const fn state(&self) -> u64 {
        self.state
    }

    /// One of many streams of this seed, by the name of what it is for: independent of the others.
    pub fn named(seed: u64, name: &str) -> Self {
        let letters = name.bytes().fold(0, |sum: u64, letter| sum.rotate_left(8) ^ u64::from(letter));
        let purpose = Self::new(letters).next_bits();
        Self::new(Self::new(seed).next_bits() ^ purpose)
    }

    /// The next 64 bits.
    pub fn next_bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Evenly distributed in −1..1, in steps of 2⁻²³.
    pub fn uniform(&mut self) -> f32 {
        2.0 * self.fraction() - 1.0
    }

    /// Evenly distributed in 0..1, in steps of 2⁻²⁴.
    pub fn fraction(&mut self) -> f32 {
        let steps = (self.next_bits() >> 40) as f32;
        steps / (1_u32 << 24) as f32
    }

    /// Puts these in an order of which each is as likely as any other.
    ///
    /// Source: D. E. Knuth, *The Art of Computer Programming*, volume 2, algorithm 3.4.2 P.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for index in (1..items.len()).rev() {
            // The high half of a product of 64 bits each: below `index + 1`.
            let other = (u128::from(self.next_bits()) * (index as u128 + 1)) >> u64::BITS;
            items.swap(index, other as usize);
        }
    }

    /// Normally distributed with mean 0 and standard deviation 1; never beyond ±9.4.
    ///
    /// Source: G. Marsaglia and T. A. Bray, "A convenient method for generating normal variables", SIAM Review 6 (1964) 260
    /// (the polar method).
    pub fn normal(&mut self) -> f32 {
        loop {
            // A point in the square −1..1, by the halves of one draw and never in the middle; one outside the circle is drawn anew.
            let bits = self.next_bits();
            let coordinate = |half: u64| (half as f64 + 0.5) / f64::from(1_u32 << 31) - 1.0;
            let [u, v] = [bits >> 32, bits & u64::from(u32::MAX)].map(coordinate);
            let s = u * u + v * v;
            if s < 1.0 {
                // u √(−2 ln s / s)
                return (u * libm::sqrt(-2.0 * libm::log(s) / s)) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_is_the_published_one() {
        // First outputs for seed 1234567, as other implementations of SplitMix64 print them.
        let mut random = SplitMix64::new(1_234_567);
        assert_eq!(random.next_bits(), 6_457_827_717_110_365_317);
        assert_eq!(random.next_bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let mut random = SplitMix64::new(7);
        let moments = |draw: &mut dyn FnMut() -> f32| {
            let (mut mean, mut square, mut fourth) = (0.0, 0.0, 0.0);
            for _ in 0..100_000 {
                let value = f64::from(draw());
                mean += value / 1e5;
                square += value * value / 1e5;
                fourth += value.powi(4) / 1e5;
            }
            (mean, square, fourth)
        };
        let (mean, square, fourth) = moments(&mut || random.normal());
        assert!(mean.abs() < 0.015 && (square - 1.0).abs() < 0.02, "{mean} {square}");
        assert!((fourth - 3.0).abs() < 0.1, "{fourth}");
        let (mean, square, _) = moments(&mut || random.uniform());
        assert!(mean.abs() < 0.01 && (square - 1.0 / 3.0).abs() < 0.01, "{mean} {square}");
    }

    #[test]
    fn tails_are_the_normal_distributions() {
        let mut random = SplitMix64::new(17);
        let draws: Vec<f64> = (0..4_000_000).map(|_| f64::from(random.normal())).collect();
        for limit in [0.5, 1.0, 2.0, 3.0, 4.0, 4.5] {
            // P(x > a) = ½ erfc(a / √2), on either side.
            let expected = 0.5 * libm::erfc(limit / std::f64::consts::SQRT_2) * draws.len() as f64;
            for sign in [-1.0, 1.0] {
                let count = draws.iter().filter(|value| sign * **value > limit).count() as f64;
                assert!(
                    (count - expected).abs() < 4.0 * expected.sqrt(),
                    "{limit}: {count}, {expected} expected"
                );
            }
        }
    }

    #[test]
    fn every_order_comes_as_often_as_any_other() {
        let mut random = SplitMix64::new(5);
        let mut counts = std::collections::BTreeMap::new();
        for _ in 0..24_000 {
            let mut items = [0, 1, 2, 3];
            random.shuffle(&mut items);
            *counts.entry(items).or_insert(0_i32) += 1;
        }
        // Five standard deviations of 1000 expected.
        assert!(counts.len() == 24 && counts.values().all(|count| (count - 1000).abs() < 158), "{counts:?}");
    }

    #[test]
    fn a_stream_goes_on_from_where_it_stands() {
        let mut random = SplitMix64::new(11);
        random.normal();
        let mut taken_up = SplitMix64::new(random.state());
        assert_eq!([random.next_bits(), random.next_bits()], [taken_up.next_bits(), taken_up.next_bits()]);
    }

    #[test]
    fn the_seed_decides() {
        assert_eq!(SplitMix64::new(3).normal(), SplitMix64::new(3).normal());
        assert_ne!(SplitMix64::new(3).normal(), SplitMix64::new(4).normal());
    }
}
