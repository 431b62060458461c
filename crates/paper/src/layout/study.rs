//! A layout study: the paper's rule for a pad's effective regions, and what the mechanics say of where its modules stand.

use std::fmt;

use serde::Serialize;

use super::grid;
use super::placement::{Candidate, Search};
use super::region::{Isoline, Outline};
use super::spacing::{PAIRS, Radii, RadiusError, Spacing};
use super::swarm;
use tactpad_core::quantity::MODULES;
use tactpad_mechanics::system::SolveError;

/// The paper's layout problem and its three answers.
#[derive(Clone, Debug, Serialize)]
pub struct SpacingAnswers {
    /// Radii of the effective regions.
    pub radii_mm: [f64; MODULES],
    /// The largest distance of each pair, by the paper's rule.
    pub limits_mm: [f64; PAIRS],
    /// The particle swarm's.
    pub swarm: Spacing,
    /// The grid search's.
    pub grid: Spacing,
    /// In closed form.
    pub closed_form: Spacing,
    /// Between what each distance of an optimal layout lies.
    pub optimal_ranges_mm: [[f64; 2]; PAIRS],
}

/// What the mechanics of a pad add.
#[derive(Clone, Debug, Serialize)]
pub struct Simulated {
    /// Share of a press above which a module counts as effective.
    pub threshold: f64,
    /// Standard deviation of each channel.
    pub noise_uv: f64,
    /// Per module; nothing where the isoline is not on the plate.
    pub isolines: [Option<Isoline>; MODULES],
    /// The isolines for pictures.
    #[serde(skip)]
    pub outlines: [Outline; MODULES],
    /// The force of the press whose location errors follow.
    pub press_n: [f64; 3],
    /// The pad as its device file has it.
    pub as_built: Candidate,
    /// The same with its modules where the paper's rule puts them.
    pub by_rule: Candidate,
    /// Placements that were tried.
    pub search: Search,
}

/// Why there is no study.
#[derive(Debug)]
#[non_exhaustive]
pub enum StudyError {
    /// The pad's equations have no answer here.
    Unsolved(SolveError),
    /// At this threshold a module has no effective region.
    NoRegion {
        /// The threshold.
        threshold: f64,
    },
    /// So many modules would lie over each other.
    Crowded {
        /// The number.
        modules: usize,
        /// The most that have room.
        room: usize,
    },
    /// A region's radius is no length that the rule takes.
    Radius(RadiusError),
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsolved(error) => write!(f, "the simulator: {error}"),
            Self::NoRegion { threshold } => write!(
                f,
                "at a threshold of {threshold} an isoline is not on the plate: choose another --threshold"
            ),
            Self::Crowded { modules, room } => write!(
                f,
                "{modules} modules at the device's radius would lie over each other: ask for {room} at most, or give a \
                 device whose modules stand farther out"
            ),
            Self::Radius(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for StudyError {}

impl From<SolveError> for StudyError {
    fn from(error: SolveError) -> Self {
        Self::Unsolved(error)
    }
}

impl SpacingAnswers {
    /// Solves the layout problem for these radii; `seed` draws the swarm.
    pub fn of(radii: &Radii, seed: u64) -> Self {
        Self {
            radii_mm: radii.mm(),
            limits_mm: radii.limits_mm(),
            swarm: swarm::solve(radii, seed),
            grid: grid::search(radii),
            closed_form: radii.widest(),
            optimal_ranges_mm: radii.optimal_ranges_mm(),
        }
    }
}
