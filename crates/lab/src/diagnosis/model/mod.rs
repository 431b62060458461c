//! What the engine asks of a model of the channels, and what it knows of the hypotheses.

pub(crate) mod chain;
pub(crate) mod inverse;
pub(crate) mod mechanics;
pub(crate) mod memory;
pub(crate) mod setting;

use self::inverse::Written;
use crate::diagnosis::data::noise::Noise;
use crate::diagnosis::data::observations::Observations;
use crate::diagnosis::data::target::Target;
use crate::effect::Effect;

/// A number of a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameter {
    /// As reports name it, its unit last.
    pub(crate) name: &'static str,
    /// Where there is no effect.
    pub(crate) none: f64,
    /// Least and greatest value that is physically possible.
    pub(crate) range: [f64; 2],
    /// Half the width of the difference that makes its derivative, in the coordinate ψ.
    pub(crate) step: f64,
    /// What the coordinate is.
    pub(crate) coordinate: Coordinate,
    /// Of a number that nobody asks for, but without which an effect has no course: its coordinate's prior deviation. Where there is
    /// no effect it changes nothing.
    pub(crate) shape: Option<f64>,
}

/// How a coordinate ψ follows from a value v and its none v₀.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coordinate {
    /// ψ = v − v₀.
    Difference,
    /// ψ = ln(v/v₀): positive by construction.
    Logarithm,
    /// ψ = v² − v₀²: what only its square acts by.
    Square,
}

impl Parameter {
    /// An additive parameter.
    pub(crate) const fn additive(name: &'static str, range: [f64; 2], step: f64) -> Self {
        Self { name, none: 0.0, range, step, coordinate: Coordinate::Difference, shape: None }
    }

    /// A factor that is positive by construction.
    pub(crate) const fn factor(name: &'static str, range: [f64; 2]) -> Self {
        Self { name, none: 1.0, range, step: 1e-3, coordinate: Coordinate::Logarithm, shape: None }
    }

    /// A factor in an effect's course, to a deviation of its logarithm. These come last.
    const fn shape((name, deviation): (&'static str, f64)) -> Self {
        let coordinate = Coordinate::Logarithm;
        Self { name, none: 1.0, range: [1e-3, 1e3], step: 0.02, coordinate, shape: Some(deviation) }
    }

    /// Whether there is nothing below none.
    pub(crate) fn is_one_sided(&self) -> bool {
        self.range[0] >= self.none
    }

    /// The value at a coordinate, kept in the range.
    pub(crate) fn value(&self, coordinate: f64) -> f64 {
        let value = match self.coordinate {
            Coordinate::Difference => self.none + coordinate,
            Coordinate::Logarithm => self.none * libm::exp(coordinate),
            Coordinate::Square => libm::sqrt((self.none * self.none + coordinate).max(0.0)),
        };
        value.clamp(self.range[0], self.range[1])
    }

    /// The coordinate of a value.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        match self.coordinate {
            Coordinate::Difference => value - self.none,
            Coordinate::Logarithm => libm::log(value / self.none),
            Coordinate::Square => value * value - self.none * self.none,
        }
    }
}

/// An effect's size, and the factors in its course with the deviations of their logarithms.
pub(crate) const fn with_shapes<const SHAPES: usize, const ALL: usize>(
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
pub(crate) struct Hypothesis {
    /// The cause.
    pub(crate) effect: Effect,
    /// Where.
    pub(crate) target: Target,
    /// Its numbers.
    pub(crate) parameters: Vec<Parameter>,
    /// Standard deviation of how large its signature is, as a share: by so much of themselves its numbers are known at best.
    pub(crate) signature_error: f64,
}

/// Largest background, as a share of a channel's root mean square.
pub(crate) const BACKGROUND_MAX: f64 = 0.03;
/// A field is known no better than the largest background that is left beside it, and so are signatures that are made of it.
pub(crate) const SIGNATURE_ERROR: f64 = BACKGROUND_MAX;

impl Hypothesis {
    /// The numbers that are asked for.
    pub(crate) fn asked(&self) -> &[Parameter] {
        let shapes = self.parameters.iter().filter(|it| it.shape.is_some()).count();
        &self.parameters[..self.parameters.len() - shapes]
    }
}

/// Readings that change together: each channel's, or `None` where nothing changes.
pub(crate) type Signature = Vec<Option<Vec<f64>>>;

/// A column of all: its signature, channel by channel.
pub(crate) type Column<'c> = &'c [Option<Vec<f64>>];

/// Something that the model gets wrong by a known amount, in all contacts alike.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CommonError {
    /// Its standard deviation.
    pub(crate) deviation: f64,
    /// What one unit of it changes.
    pub(crate) signature: Signature,
}

/// Everything about the present point ψ.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Linearised {
    /// Each channel's readings, row by row.
    pub(crate) readings: Vec<Vec<f64>>,
    /// The loads by which the model has come to them, row by row: what it gets wrong goes with these.
    pub(crate) loads: Vec<[f64; 3]>,
    /// The same way as the readings, the standard deviation that they have where the model is as far off as it may be and an effect
    /// makes more of that; nothing for channels where none does.
    pub(crate) doubts: Vec<Vec<f64>>,
    /// For each hypothesis and each of its parameters, ∂readings/∂ψ.
    pub(crate) signatures: Vec<Vec<Signature>>,
}

/// Zero and noise of each channel.
pub(crate) struct ChannelBaselines<'t> {
    /// What it reads without load.
    pub(crate) zeros: &'t [f64],
    /// Its noise.
    pub(crate) noise: &'t [Noise],
}

/// A model of N channels at the rows of a measurement.
pub(crate) trait Model: Sync {
    /// What may be wrong with it.
    fn hypotheses(&self) -> &[Hypothesis];
    /// Each channel's readings, row by row, when hypotheses hold with these coordinates.
    fn readings(&self, applied: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>>;
    /// Each channel's root mean square over the whole measurement, of which these may be some rows.
    fn sizes(&self) -> Vec<f64>;
    /// Each channel's largest reading over the whole measurement; nothing where no effect is a share of it.
    fn full_scale(&self) -> Vec<f64> {
        Vec::new()
    }
    /// The readings, and their derivatives by all coordinates.
    fn linearised(&self, applied: &[(usize, Vec<f64>)]) -> Linearised;
    /// What is known of its own errors.
    fn common_errors(&self) -> Vec<CommonError>;
    /// A channel's further errors, row by row: independent columns of deviation 1 each, which no other channel shares.
    fn stated_errors(&self, _channel: usize) -> &[Vec<f64>] {
        &[]
    }
    /// For each row, the contact that must have been written for these hypotheses to read what was read. None where the model
    /// knows no contacts.
    fn contacts(
        &self,
        _applied: &[(usize, Vec<f64>)],
        _told: &ChannelBaselines<'_>,
    ) -> Option<Vec<Option<Written>>> {
        None
    }
    /// The same at other rows, which nobody measured, and what the model gets wrong there. None where it cannot say.
    fn elsewhere(
        &self,
        _rows: &Observations,
        _applied: &[(usize, Vec<f64>)],
    ) -> Option<(Linearised, Vec<CommonError>)> {
        None
    }
}
