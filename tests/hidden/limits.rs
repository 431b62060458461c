//! Shares, and how sure they are.

/// So many of so many.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Share {
    pub(crate) hits: usize,
    pub(crate) all: usize,
}

impl Share {
    pub(crate) fn of(answers: impl Iterator<Item = bool>) -> Self {
        answers.fold(Self::default(), |share, hit| Self {
            hits: share.hits + usize::from(hit),
            all: share.all + 1,
        })
    }

    /// Not a number, if there were none.
    pub(crate) fn value(self) -> f64 {
        self.hits as f64 / self.all as f64
    }

    /// The one-sided upper limit at 95 % (Clopper and Pearson): with this share so few hits would come in 5 of 100.
    pub(crate) fn upper95(self) -> f64 {
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if self.at_most(middle) > 0.05 { low = middle } else { high = middle }
        }
        if self.hits == self.all { 1.0 } else { low }
    }

    pub(crate) fn lower95(self) -> f64 {
        1.0 - Self { hits: self.all - self.hits, all: self.all }.upper95()
    }

    /// The probability of at most so many hits.
    fn at_most(self, share: f64) -> f64 {
        let mut logarithm = self.all as f64 * (1.0 - share).ln();
        let mut sum = logarithm.exp();
        for hit in 0..self.hits {
            logarithm += ((self.all - hit) as f64 / (hit + 1) as f64).ln() + (share / (1.0 - share)).ln();
            sum += logarithm.exp();
        }
        sum
    }
}

impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        if self.all == 0 {
            return write!(f, "none");
        }
        let [low, value, high] = [self.lower95(), self.value(), self.upper95()].map(|share| 100.0 * share);
        write!(f, "{} of {}: {value:.1} % ({low:.1} to {high:.1})", self.hits, self.all)
    }
}

/// The middle of a list; not a number for an empty one.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        count if count % 2 == 1 => values[middle],
        _ => (values[middle - 1] + values[middle]) / 2.0,
    }
}

#[test]
fn limits_are_those_of_the_tables() {
    // 20 of 400, one-sided 95 %: 7.19 %. None of 59: 4.95 %, as 0.95^59 is 0.0485.
    assert!((Share { hits: 20, all: 400 }.upper95() - 0.0719).abs() < 5e-4);
    assert!((Share { hits: 0, all: 59 }.upper95() - 0.0495).abs() < 5e-4);
    assert!((Share { hits: 59, all: 59 }.lower95() - 0.9505).abs() < 5e-4);
    assert!((median(vec![3.0, 1.0, 2.0]) - 2.0).abs() < 1e-12);
}
