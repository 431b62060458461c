//! All figures of one table.

use serde::{Serialize, Serializer};

use super::ageing::{Ageing, after_cycles};
use super::decoded::{self, DecodedDrift, DecodedErrors};
use super::fem::{FemError, against_pad};
use super::holding::{HoldingLoad, of_task};
use super::hysteresis::{Hysteresis, of_loops};
use super::location::{LocationSpread, spreads};
use super::repeatability::{Repeatability, at_full_scale};
use super::resolution::{Resolution, smallest_step};
use super::response::{StepResponse, to_steps};
use super::sensitivity::{Sensitivity, of_channels};
use super::thermal::{self, ThermalDrift};
use super::{Decode, Needs};
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::tables::measured::Table;

/// The inputs of the figures.
#[derive(Clone, Copy)]
pub struct Evidence<'e> {
    /// The measured table.
    pub table: &'e Table,
    /// The simulated pad's signals, µV/N.
    pub signals: &'e InfluenceField,
    /// The decoder whose contacts are judged.
    pub decoder: Option<Decode<'e>>,
    /// The paper's network, trained on the simulation alone, and its contacts.
    pub simulation: Option<Simulation<'e>>,
}

/// The network that never saw a measured contact. The paper takes no zero anywhere, so its channels are raw.
#[derive(Clone, Copy)]
pub struct Simulation<'e> {
    /// The contacts that it is tried with.
    pub contacts: &'e Table,
    /// Contact from the nine channels in µV as they were measured.
    pub decode: Decode<'e>,
}

/// Every figure, or what it needs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Model against pad at 1 N.
    #[serde(serialize_with = "found")]
    pub fem: Result<FemError, Needs>,
    /// Unloaded channels by temperature.
    #[serde(serialize_with = "found")]
    pub thermal_drift: Result<ThermalDrift, Needs>,
    /// Decoded errors by temperature.
    #[serde(serialize_with = "found")]
    pub decoded_drift: Result<DecodedDrift, Needs>,
    /// Decoded places of a contact that stays.
    #[serde(serialize_with = "found")]
    pub location_spread: Result<[LocationSpread; 4], Needs>,
    /// Dispersion over cycles of 5 N.
    #[serde(serialize_with = "found")]
    pub repeatability: Result<Repeatability, Needs>,
    /// Loading against unloading.
    #[serde(serialize_with = "found")]
    pub hysteresis: Result<Hysteresis, Needs>,
    /// Smallest step of force.
    #[serde(serialize_with = "found")]
    pub resolution: Result<Resolution, Needs>,
    /// Reading after 50,000 cycles.
    #[serde(serialize_with = "found")]
    pub ageing: Result<Ageing, Needs>,
    /// Errors of the network trained on the simulation alone.
    #[serde(serialize_with = "found")]
    pub simulation_only: Result<DecodedErrors, Needs>,
    /// Errors of the decoder.
    #[serde(serialize_with = "found")]
    pub decoded: Result<DecodedErrors, Needs>,
    /// µV/N by channel.
    #[serde(serialize_with = "found")]
    pub sensitivity: Result<Sensitivity, Needs>,
    /// Delay, rise, bandwidth.
    #[serde(serialize_with = "found")]
    pub step_response: Result<StepResponse, Needs>,
    /// The force-holding task.
    #[serde(serialize_with = "found")]
    pub force_holding: Result<[HoldingLoad; 3], Needs>,
}

impl Figures {
    /// Looks for every figure.
    pub fn of(evidence: &Evidence) -> Self {
        let Evidence { table, signals, decoder, simulation } = *evidence;
        Self {
            fem: against_pad(table, signals),
            thermal_drift: thermal::drift(table),
            decoded_drift: decoded::drift(table, decoder),
            location_spread: spreads(table, decoder),
            repeatability: at_full_scale(table),
            hysteresis: of_loops(table),
            resolution: smallest_step(table),
            ageing: after_cycles(table),
            simulation_only: simulation
                .ok_or(Needs::SimulationNetwork)
                .and_then(|it| decoded::raw_errors(it.contacts, Some(it.decode))),
            decoded: decoded::errors(table, decoder),
            sensitivity: of_channels(table),
            step_response: to_steps(table),
            force_holding: of_task(table),
        }
    }
}

/// A figure as itself; else `{"needs": …}`.
fn found<T: Serialize, S: Serializer>(figure: &Result<T, Needs>, serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct MissingFigures {
        needs: Needs,
    }
    match figure {
        Ok(figure) => figure.serialize(serializer),
        Err(needs) => MissingFigures { needs: *needs }.serialize(serializer),
    }
}
