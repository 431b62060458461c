//! How a pad's field changes with its mechanics: by the simulator's derivatives, and by what a module may lack.

use std::sync::Arc;

use super::setting::Change;
use tactpad_core::pad::changes::{FieldChange, Flaw};
use tactpad_core::pad::device::unit::Unit;
use tactpad_core::pad::device::{Device, Side, Stack};
use tactpad_core::pad::field::{ForceMaps, PadField, Sensitivity};
use tactpad_core::pad::influence::{InfluenceField, MAPS};
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_numeric::zernike::{Jet, Polynomial, count, jets};

/// Per channel, what a unit force along each axis gives.
pub(crate) type Maps = [[f64; 3]; CHANNELS];

/// The changes that there are about the field of `own`, a pad that is held to be `nominal`.
pub(crate) fn changes(
    nominal: &Device,
    own: &Device,
    field: &PadField,
    flaws: &[FieldChange],
) -> Vec<Change> {
    let numbers = free(field).map(|it| Change::Number {
        name: it.parameter.name(),
        own: it.parameter.get(own),
        nominal: it.parameter.get(nominal),
        is_stiffness: it.parameter.unit() == Unit::Megapascal || it.parameter.name().ends_with("_e_factor"),
    });
    let flaws = flaws.iter().flat_map(|it| {
        (0..MODULES).map(|module| match it.flaw {
            Flaw::FrameOpen(side) => Change::FrameOpen(module, side),
            Flaw::Debonded(side, share) => Change::Debonded(module, side, share),
        })
    });
    numbers.chain(flaws).collect()
}

/// The numbers of the device that a cause can change.
fn free(field: &PadField) -> impl Iterator<Item = &Sensitivity> {
    let is_free =
        |it: &&Sensitivity| it.parameter.module().is_some() || it.parameter.name() == "material.plate.e_mpa";
    field.sensitivities.iter().filter(is_free)
}

/// The changes of the maps at each place, in the order of [`changes`]. Rows of one place share them.
pub(crate) fn at_places(
    field: &PadField,
    flaws: &[FieldChange],
    plate_mm: f64,
    places_mm: &[[f64; 2]],
) -> Vec<Arc<[Maps]>> {
    let mut order: Vec<usize> = (0..places_mm.len()).collect();
    let key = |at: usize| places_mm[at].map(f64::to_bits);
    order.sort_unstable_by_key(|at| key(*at));
    let mut known: Vec<Option<Arc<[Maps]>>> = vec![None; places_mm.len()];
    let mut last: Option<usize> = None;
    for at in order {
        known[at] = match last.filter(|last| key(*last) == key(at)) {
            Some(same) => known[same].clone(),
            None => Some(at_place(field, flaws, places_mm[at].map(|mm| mm / plate_mm))),
        };
        last = Some(at);
    }
    known.into_iter().flatten().collect()
}

/// The same at one place, in units of the plate's radius.
pub(crate) fn at_place(field: &PadField, flaws: &[FieldChange], place: [f64; 2]) -> Arc<[Maps]> {
    let polynomials = jets(degree(free(field).map(|it| &it.maps)), place);
    let numbers = free(field).map(|it| values(&it.maps, &polynomials));
    // All modules are alike: the pad is turned until the flawed one is in the place of the first.
    let turns: Vec<PadRotation> = (0..MODULES).map(PadRotation::back).collect();
    let degree = degree(flaws.iter().map(|it| &it.maps));
    let turned: Vec<Vec<Jet>> = turns.iter().map(|turn| jets(degree, turn.vector(place))).collect();
    let flaws = flaws.iter().flat_map(|it| {
        turns.iter().zip(&turned).map(|(turn, polynomials)| turn.maps(&values(&it.maps, polynomials)))
    });
    numbers.chain(flaws).collect()
}

/// Σⱼ wⱼ Cⱼ as a field of its own, the changes in the order of [`changes`]; none where no weight acts.
pub(crate) fn changed(
    field: &PadField,
    flaws: &[FieldChange],
    plate_mm: f64,
    weights: &[f64],
) -> Option<InfluenceField> {
    if weights.iter().all(|weight| *weight == 0.0) {
        return None;
    }
    let numbers: Vec<&Sensitivity> = free(field).collect();
    let (of_numbers, of_flaws) = weights.split_at(numbers.len().min(weights.len()));
    let smooth = mixed(numbers.iter().map(|it| &it.maps).zip(of_numbers));
    let turns: Vec<PadRotation> = (0..MODULES).map(PadRotation::back).collect();
    let turned: Vec<(&PadRotation, [ForceMaps; CHANNELS])> = (turns.iter().enumerate())
        .map(|(module, turn)| {
            let own = of_flaws.iter().skip(module).step_by(MODULES);
            (turn, mixed(flaws.iter().map(|it| &it.maps).zip(own)))
        })
        .collect();
    let at = |place_mm: [f64; 2]| {
        let place = place_mm.map(|mm| mm / plate_mm);
        let mut sum = values(&smooth, &jets(degree([&smooth].into_iter()), place));
        for (turn, maps) in turned.iter().filter(|(_, maps)| !maps[0][0].coefficients.is_empty()) {
            let change = turn.maps(&values(maps, &jets(degree([maps].into_iter()), turn.vector(place))));
            sum.iter_mut().flatten().zip(change.iter().flatten()).for_each(|(sum, change)| *sum += change);
        }
        std::array::from_fn(|map| sum[map / 3][map % 3])
    };
    let [spacing_mm, radius_mm] = [field.signals.spacing_mm(), field.signals.radius_mm()].map(f64::from);
    Some(InfluenceField::sampled(spacing_mm, radius_mm, plate_mm, at))
}

/// The signals of a pad of which this module has the flaw.
pub(crate) fn flawed(field: &PadField, change: &FieldChange, module: usize, plate_mm: f64) -> InfluenceField {
    let (turn, degree) = (PadRotation::back(module), degree([&change.maps].into_iter()));
    let at = |place_mm: [f64; 2]| {
        let own = field.signals.gains(place_mm[0] as f32, place_mm[1] as f32).value;
        let jets = jets(degree, turn.vector(place_mm.map(|mm| mm / plate_mm)));
        let change = turn.maps(&values(&change.maps, &jets));
        std::array::from_fn(|map| own[map / 3][map % 3] + change[map / 3][map % 3])
    };
    let [spacing_mm, radius_mm] = [field.signals.spacing_mm(), field.signals.radius_mm()].map(f64::from);
    InfluenceField::sampled(spacing_mm, radius_mm, radius_mm, at)
}

/// Σⱼ wⱼ of maps, coefficient by coefficient; empty where no weight acts.
fn mixed<'m>(terms: impl Iterator<Item = (&'m [ForceMaps; CHANNELS], &'m f64)>) -> [ForceMaps; CHANNELS] {
    let mut sum: [ForceMaps; CHANNELS] =
        std::array::from_fn(|_| std::array::from_fn(|_| Polynomial { coefficients: Vec::new() }));
    for (maps, weight) in terms.filter(|(_, weight)| **weight != 0.0) {
        for (sum, map) in sum.iter_mut().flatten().zip(maps.iter().flatten()) {
            let length = sum.coefficients.len().max(map.coefficients.len());
            sum.coefficients.resize(length, 0.0);
            let own = sum.coefficients.iter_mut().zip(&map.coefficients);
            own.for_each(|(sum, coefficient)| *sum += weight * coefficient);
        }
    }
    sum
}

/// The highest degree of these maps.
fn degree<'m>(maps: impl Iterator<Item = &'m [ForceMaps; CHANNELS]>) -> usize {
    let largest = maps.map(|maps| maps[0][0].coefficients.len()).max().unwrap_or(0);
    (0..).find(|degree| count(*degree) >= largest).unwrap_or(0)
}

fn values(maps: &[ForceMaps; CHANNELS], polynomials: &[Jet]) -> Maps {
    maps.each_ref().map(|axes| axes.each_ref().map(|map| map.value(polynomials)))
}

/// A turn of the pad that takes a module to the place of module 0.
struct PadRotation {
    module: usize,
    sin: f64,
    cos: f64,
}

impl PadRotation {
    fn back(module: usize) -> Self {
        let angle = -(module as f64) * std::f64::consts::TAU / MODULES as f64;
        Self { module, sin: libm::sin(angle), cos: libm::cos(angle) }
    }

    fn vector(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }

    /// Maps of the turned pad as those of the pad that is not.
    fn maps(&self, turned: &Maps) -> Maps {
        std::array::from_fn(|channel| {
            let [ax, ay, az] = turned[(channel + MAPS - 3 * self.module) % CHANNELS];
            // A unit force along +x here is (cos, sin) there.
            [self.cos * ax + self.sin * ay, -self.sin * ax + self.cos * ay, az]
        })
    }
}

/// The part of a frame's area that lies on a side, from corner to corner.
pub(crate) fn side_share(device: &Device, side: Side) -> f64 {
    let Stack { film_length_x_mm: length, film_width_y_mm: width, frame_width_mm: frame, .. } = device.stack;
    let whole = length * width - (length - 2.0 * frame) * (width - 2.0 * frame);
    match side {
        Side::PlusX | Side::MinusX => frame * width / whole,
        Side::PlusY | Side::MinusY => frame * length / whole,
    }
}
