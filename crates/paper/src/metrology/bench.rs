//! The paper's procedures on the twin: pads of many seeds, each measured and judged.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::Decode;
use super::decoders::{Decoders, by};
use super::figures::{Evidence, Figures, Simulation};
use super::procedures;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::tables::measured::Table;
use tactpad_core::tables::plans;
use tactpad_lab::rig::measurement;

/// What the twin's pads have in common.
#[derive(Debug)]
pub struct Bench {
    /// The pad that is measured.
    pub device: Device,
    /// Its field.
    pub field: PadField,
    /// The field of the pad without imperfections, with which the others are compared.
    pub nominal: PadField,
    /// What its contacts are decoded with.
    pub decoders: Decoders,
}

impl Bench {
    /// The figures of the pad of each seed, as many at once as there are processors, and what `draw` makes of the first
    /// one; `None` without seeds. `report` hears how many are done.
    ///
    /// # Errors
    /// What `draw` says.
    pub fn all<T: Send, E: Send>(
        &self,
        seeds: &[u64],
        draw: impl Fn(&Evidence<'_>, &Figures) -> Result<T, E> + Sync,
        report: impl Fn(usize) + Sync,
    ) -> Result<(Vec<Figures>, Option<T>), E> {
        let done = AtomicUsize::new(0);
        let of_pad = |seed: &u64| {
            let is_drawn = seeds.first() == Some(seed);
            let found =
                self.of_pad(*seed, |evidence, figures| is_drawn.then(|| draw(evidence, figures)).transpose());
            report(done.fetch_add(1, Ordering::Relaxed) + 1);
            found
        };
        let found: Vec<(Figures, Option<T>)> = seeds.par_iter().map(of_pad).collect::<Result<_, E>>()?;
        let (figures, drawn): (Vec<Figures>, Vec<Option<T>>) = found.into_iter().unzip();
        Ok((figures, drawn.into_iter().flatten().next()))
    }

    /// The pad of this seed goes through the procedures. The network learns from, and is tried with, contacts of the
    /// paper's own plan, measured apart.
    fn of_pad<T, E>(
        &self,
        seed: u64,
        draw: impl FnOnce(&Evidence<'_>, &Figures) -> Result<T, E>,
    ) -> Result<(Figures, T), E> {
        let table = self.measured(&procedures::plan(&self.device.contact), seed);
        let contacts = self.measured(&plans::paper::plan(&self.device.contact), seed);
        let (judged, simulation) = (self.decoders.judged(&contacts, seed), self.decoders.simulation());
        let (judged, simulation) = (judged.as_ref().map(by), simulation.as_ref().map(by));
        let evidence = Evidence {
            table: &table,
            signals: &self.nominal.signals,
            decoder: judged.as_ref().map(|decode| decode as Decode),
            simulation: simulation.as_ref().map(|decode| Simulation { contacts: &contacts, decode }),
        };
        let figures = Figures::of(&evidence);
        let drawn = draw(&evidence, &figures)?;
        Ok((figures, drawn))
    }

    fn measured(&self, plan: &Table, seed: u64) -> Table {
        measurement::carry_out(plan, &self.device, &self.field, seed).table
    }
}
