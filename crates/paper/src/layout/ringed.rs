//! The simulated pads with other numbers of modules.

use std::fmt;

use rayon::prelude::*;

use super::conditioning::Conditioning;
use super::module_count::{ModuleCounts, Ringed, Wiring};
use super::precision::{AreaPlace, Precision, Press, places};
use super::scan::PRESS_N;
use super::study::StudyError;
use tactpad_core::pad::device::{Device, GAUGES};
use tactpad_core::pad::field::ForceMaps;
use tactpad_core::pad::influence::Gains;
use tactpad_mechanics::mesh::Fineness;
use tactpad_mechanics::ring::{BRIDGES, Ring};
use tactpad_mechanics::simulator::{PLATE_DEGREE, Simulator};

/// The readings of a contact at a place.
type Contact = (AreaPlace, Gains<Vec<[f64; 3]>>);

impl ModuleCounts {
    /// Pads with these numbers of the device's modules at equal angles, each at least one; `noise_uv` is each reading's
    /// standard deviation. `progress` hears what is done.
    ///
    /// # Errors
    /// A number of modules that has no room, or as the simulator's.
    pub fn of(
        device: &Device,
        counts: &[usize],
        noise_uv: f64,
        mut progress: impl FnMut(fmt::Arguments<'_>),
    ) -> Result<Self, StudyError> {
        if let Some(crowd) = counts.iter().find(|count| !device.has_room_for(**count)) {
            let room = (1..*crowd).take_while(|count| device.has_room_for(*count)).last().unwrap_or(1);
            return Err(StudyError::Crowded { modules: *crowd, room });
        }
        progress(format_args!("solving the modules"));
        let modules = Simulator::new(Fineness::STANDARD).superelements(device)?;
        let press = Press { force_n: PRESS_N, noise_uv };
        let mut rows = Vec::with_capacity(2 * counts.len());
        for count in counts {
            progress(format_args!("a pad on {count} of them"));
            let ring = Ring::of(device, *count, PLATE_DEGREE, &modules)?;
            let (bridges, gauges) = (ring.bridges(), ring.gauges());
            for (wiring, maps, each) in
                [(Wiring::Bridges, bridges, BRIDGES), (Wiring::Gauges, gauges, GAUGES)]
            {
                let contacts = contacts(&ring, &maps, device.contact.max_centre_radius_mm);
                rows.push(ringed(device, wiring, &contacts, each, &press));
            }
        }
        Ok(Self {
            press_n: press.force_n,
            noise_uv,
            centre_radius_mm: device.sites.centre_radius_mm,
            plate_radius_mm: device.plate.radius_mm(),
            rows,
        })
    }
}

fn contacts(ring: &Ring<'_>, maps: &[ForceMaps], contact_radius_mm: f64) -> Vec<Contact> {
    let places: Vec<AreaPlace> = places(contact_radius_mm).collect();
    places.into_par_iter().map(|place| (place, ring.gains(maps, place.at_mm))).collect()
}

fn ringed(device: &Device, wiring: Wiring, contacts: &[Contact], each: usize, press: &Press) -> Ringed {
    let readings = contacts.first().map_or(0, |(_, gains)| gains.value.len());
    let all = contacts.iter().map(|(place, gains)| (*place, gains));
    let radius_mm = device.plate.radius_mm();
    Ringed {
        modules: readings / each,
        wiring,
        readings,
        conditioning: Conditioning::over(contacts.iter().map(|(_, gains)| gains), press, radius_mm),
        precision: Precision::over(all, press),
        worst_without_one_mm: worst_without_one_mm(contacts, readings / each, each, press),
    }
}

/// Every module in turn is not read.
fn worst_without_one_mm(contacts: &[Contact], modules: usize, each: usize, press: &Press) -> f64 {
    let without = |silent: usize| {
        let rest = contacts.iter().map(|(place, gains)| (*place, read_without(gains, silent, each)));
        Precision::over(rest, press).worst_mm
    };
    (0..modules).into_par_iter().map(without).reduce(|| 0.0, f64::max)
}

/// The readings of all modules but one.
fn read_without(gains: &Gains<Vec<[f64; 3]>>, silent: usize, each: usize) -> Gains<Vec<[f64; 3]>> {
    let rest = |rows: &[[f64; 3]]| {
        let (before, from) = rows.split_at(silent * each);
        [before, &from[each..]].concat()
    };
    Gains { value: rest(&gains.value), dx: rest(&gains.dx), dy: rest(&gains.dy) }
}
