//! Where words stand on a drawn plate: each where it covers no other one and no line, and within what it names.

/// Letters are at most so high where a plate is drawn,
const LETTER_MM: f32 = 2.8;
/// and so wide, of their height.
const LETTER_WIDTH: f32 = 0.56;
/// From one line to the next, of a letter's height.
const LINE: f32 = 1.2;
/// A picture of the plate shows this, to each side.
const PICTURE_MM: [f32; 2] = [38.0, 36.0];

/// What it costs that a word stands where it should not, in the square millimetres of another one that it would rather cover.
const TOO_NEAR: f32 = 1000.0;
const OUTSIDE: f32 = 100.0;
const ON_A_LINE: f32 = 3.0;
/// Each further candidate is so much worse than the one before.
const LATER: f32 = 0.01;

/// The rectangle that a word fills.
#[derive(Clone, Copy, Debug)]
pub(super) struct WordBox {
    at_mm: [f32; 2],
    half_mm: [f32; 2],
}

impl WordBox {
    /// Of a word around a place; what a control does in the game stands in a line of its own.
    pub(super) fn of(word: &str, at_mm: [f32; 2]) -> Self {
        let lines = word.split(": ").count() as f32;
        let letters = word.split(": ").map(|line| line.chars().count()).max().unwrap_or(0) as f32;
        Self {
            at_mm,
            half_mm: [letters * LETTER_WIDTH, lines * LINE].map(|of_height| 0.5 * LETTER_MM * of_height),
        }
    }

    /// How much of both is the same, mm².
    pub(super) fn overlap_mm2(&self, other: &Self) -> f32 {
        let [x_mm, y_mm] = [0, 1].map(|axis| {
            let apart_mm = (self.at_mm[axis] - other.at_mm[axis]).abs();
            (self.half_mm[axis] + other.half_mm[axis] - apart_mm).max(0.0)
        });
        x_mm * y_mm
    }

    /// The least and the largest distance from a place.
    pub(super) fn distances_mm(&self, from_mm: [f32; 2]) -> [f32; 2] {
        let away_mm = [0, 1].map(|axis| (self.at_mm[axis] - from_mm[axis]).abs());
        let [x, y] = [0, 1].map(|axis| (away_mm[axis] - self.half_mm[axis]).max(0.0));
        let [far_x, far_y] = [0, 1].map(|axis| away_mm[axis] + self.half_mm[axis]);
        [libm::hypotf(x, y), libm::hypotf(far_x, far_y)]
    }
}

/// The words of a plate.
pub(super) struct WordPlaces {
    /// Radius of the plate.
    plate_mm: f32,
    /// The centre of the hand.
    centre_mm: [f32; 2],
    taken: Vec<WordBox>,
}

impl WordPlaces {
    pub(super) const fn on(plate_mm: f32, centre_mm: [f32; 2]) -> Self {
        Self { plate_mm, centre_mm, taken: Vec::new() }
    }

    /// The best of the candidates, of which earlier ones are better; no part of the word is to be nearer to the hand's centre than `from_mm`.
    pub(super) fn place(
        &mut self,
        word: &str,
        from_mm: f32,
        candidates: impl Iterator<Item = [f32; 2]>,
    ) -> [f32; 2] {
        let costs = candidates.enumerate().map(|(index, at_mm)| {
            let it = WordBox::of(word, at_mm);
            (it, LATER.mul_add(index as f32, self.cost(&it, from_mm)))
        });
        let best = costs.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(it, _)| it);
        self.taken.extend(best);
        best.map_or(self.centre_mm, |it| it.at_mm)
    }

    fn cost(&self, it: &WordBox, from_mm: f32) -> f32 {
        let covered: f32 = self.taken.iter().map(|other| it.overlap_mm2(other)).sum();
        let [near_mm, _] = it.distances_mm(self.centre_mm);
        let [inner_mm, outer_mm] = it.distances_mm([0.0; 2]);
        let is_outside =
            [0, 1].iter().any(|&axis| it.at_mm[axis].abs() + it.half_mm[axis] > PICTURE_MM[axis]);
        let mut cost = 10.0 * covered;
        for (is_so, price) in [
            (near_mm < from_mm, TOO_NEAR + 10.0 * (from_mm - near_mm)),
            (is_outside, OUTSIDE),
            (inner_mm < self.plate_mm && outer_mm > self.plate_mm, ON_A_LINE),
        ] {
            if is_so {
                cost += price;
            }
        }
        cost
    }
}
