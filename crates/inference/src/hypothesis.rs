//! What may be wrong with a model, and the numbers of it.

/// A number of a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// As reports name it, its unit last.
    pub name: &'static str,
    /// Where there is no effect.
    pub none: f64,
    /// Least and greatest value that is physically possible.
    pub range: [f64; 2],
    /// Half the width of the difference that makes its derivative, in the coordinate ψ.
    pub step: f64,
    /// What the coordinate is.
    pub coordinate: Coordinate,
    /// Of a number that nobody asks for, but without which an effect has no course: its coordinate's prior deviation. Where there is
    /// no effect it changes nothing.
    pub shape: Option<f64>,
}

/// How a coordinate ψ follows from a value v and its none v₀.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// ψ = v − v₀.
    Difference,
    /// ψ = ln(v/v₀): positive by construction.
    Logarithm,
    /// ψ = v² − v₀²: what only its square acts by.
    Square,
}

impl Parameter {
    /// An additive parameter.
    pub const fn additive(name: &'static str, range: [f64; 2], step: f64) -> Self {
        Self { name, none: 0.0, range, step, coordinate: Coordinate::Difference, shape: None }
    }

    /// A factor that is positive by construction.
    pub const fn factor(name: &'static str, range: [f64; 2]) -> Self {
        Self { name, none: 1.0, range, step: 1e-3, coordinate: Coordinate::Logarithm, shape: None }
    }

    /// A factor in an effect's course, to a deviation of its logarithm. These come last.
    const fn shape((name, deviation): (&'static str, f64)) -> Self {
        let coordinate = Coordinate::Logarithm;
        Self { name, none: 1.0, range: [1e-3, 1e3], step: 0.02, coordinate, shape: Some(deviation) }
    }

    /// Whether there is nothing below none.
    pub fn is_one_sided(&self) -> bool {
        self.range[0] >= self.none
    }

    /// The value at a coordinate, kept in the range.
    pub fn value(&self, coordinate: f64) -> f64 {
        let value = match self.coordinate {
            Coordinate::Difference => self.none + coordinate,
            Coordinate::Logarithm => self.none * libm::exp(coordinate),
            Coordinate::Square => libm::sqrt((self.none * self.none + coordinate).max(0.0)),
        };
        value.clamp(self.range[0], self.range[1])
    }

    /// The coordinate of a value.
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.coordinate {
            Coordinate::Difference => value - self.none,
            Coordinate::Logarithm => libm::log(value / self.none),
            Coordinate::Square => value * value - self.none * self.none,
        }
    }
}

/// An effect's size, and the factors in its course with the deviations of their logarithms.
pub const fn with_shapes<const SHAPES: usize, const ALL: usize>(
    size: Parameter,
    shapes: [(&'static str, f64); SHAPES],
) -> [Parameter; ALL] {
    let mut parameters = [size; ALL];
    let mut at = 0;
    while at < SHAPES {
        parameters[at + 1] = Parameter::shape(shapes[at]);
        at += 1;
    }
    parameters
}

/// A cause in one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis<L> {
    /// What the study that asks calls it.
    pub label: L,
    /// Its numbers.
    pub parameters: Vec<Parameter>,
    /// Standard deviation of how large its signature is, as a share: by so much of themselves its numbers are known at best.
    pub signature_error: f64,
    /// Standard deviation of its first number's coordinate in any specimen, whether it is found or not; 0 where it is there or is not.
    pub prior_deviation: f64,
    /// The channel whose zero it is, if it is one: all fits have the zeros anyway, and nobody asks for them as causes.
    pub zero_of: Option<usize>,
}

impl<L> Hypothesis<L> {
    /// The numbers that are asked for.
    pub fn asked(&self) -> &[Parameter] {
        let shapes = self.parameters.iter().filter(|it| it.shape.is_some()).count();
        &self.parameters[..self.parameters.len() - shapes]
    }
}
