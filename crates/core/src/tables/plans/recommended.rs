//! The recommended plan: what the paper's confounds, this one separates.
//!
//! `docs/protocol.md` says which part tells which causes apart.

use super::{Load, PlanDraft, label, polar_mm};
use crate::pad::device::Patch;
use crate::tables::measured::{Approach, Label, Table};
use tactpad_numeric::random::SplitMix64;

/// The session of the contacts that are all different.
pub const SPREAD: &str = "spread";
/// The session of the contacts that are repeated.
pub const REPLICATES: &str = "replicates";
/// The session of the time series.
pub const SERIES: &str = "series";

const PLACES: usize = 120;
const REPLICATED_PLACES: usize = 8;
const REPEATS: usize = 6;
const PRESSES_PER_ZERO: usize = 20;
/// Ten times apart, so that what creeps within seconds shows.
const DWELLS_S: [f64; 2] = [2.0, 20.0];
const APPROACHES: [Approach; 2] = [Approach::Loading, Approach::Unloading];
/// In full scales: the noise floor hides less, and unloading needs room to come from above.
const MAGNITUDE_MIN: f64 = 0.1;
const UNLOADING_MAX: f64 = 0.8;
/// A rubber tip on steel slides somewhere above.
const TILT_MAX_DEG: f64 = 45.0;
/// The angle between two successive places of a sunflower, 180° (3 − √5).
const GOLDEN_DEG: f64 = 137.507_764_050_037_85;
/// The real root of g⁴ = g + 1. The multiples of 1/g, 1/g² and 1/g³ fill a cube evenly.
const QUARTIC: f64 = 1.220_744_084_605_759_5;

/// A static contact.
#[derive(Clone, Copy, Debug)]
struct Press {
    session: &'static str,
    label: Label,
    approach: Approach,
    dwell_s: f64,
}

/// The recommended plan. The same seed gives the same plan; another one other places, loads and another order.
///
/// 120 places × 4 contacts and 8 places × 6 repeats in random order, with a zero before every 20; before them a rest,
/// after them slow and fast ramps, and a load that is held.
pub fn plan(patch: &Patch, seed: u64) -> Table {
    let mut random = SplitMix64::new(seed);
    let mut presses = spread(patch, &mut random);
    presses.extend(replicates(patch, &mut random));
    random.shuffle(&mut presses);
    let mut draft = PlanDraft::new(DWELLS_S[0]);
    draft.trial("rest", SERIES, [0.0; 2], (0..=300).map(|step| [f64::from(step) / 10.0, 0.0]));
    for (index, press) in presses.into_iter().enumerate() {
        if index % PRESSES_PER_ZERO == 0 {
            draft.zero();
        }
        draft.press(press.session, press.label, press.approach, press.dwell_s);
    }
    draft.zero();
    ramps(&mut draft, patch);
    let held_n = 0.6 * patch.full_scale_n;
    let hold =
        (0..=125).map(|second| [f64::from(second), if (5..65).contains(&second) { held_n } else { 0.0 }]);
    draft.trial("hold", SERIES, [0.0; 2], hold);
    draft.zero();
    draft.table
}

/// Each place with each approach and each dwell once, and with four loads.
fn spread(patch: &Patch, random: &mut SplitMix64) -> Vec<Press> {
    let places_mm = sunflower_mm(patch, PLACES, random);
    let ways = APPROACHES.into_iter().flat_map(|approach| DWELLS_S.map(|dwell_s| (approach, dwell_s)));
    let ways: Vec<_> = ways.collect();
    let offsets = [(); 3].map(|()| f64::from(random.fraction()));
    let mut presses = Vec::with_capacity(places_mm.len() * ways.len());
    for place_mm in places_mm {
        for &(approach, dwell_s) in &ways {
            let load = load(even(presses.len(), offsets), approach, patch);
            presses.push(Press { session: SPREAD, label: label(place_mm, load), approach, dwell_s });
        }
    }
    presses
}

/// The same few contacts again and again.
fn replicates(patch: &Patch, random: &mut SplitMix64) -> Vec<Press> {
    let places_mm = sunflower_mm(patch, REPLICATED_PLACES, random);
    let offsets = [(); 3].map(|()| f64::from(random.fraction()));
    let press = |(index, place_mm)| {
        let approach = Approach::Loading;
        let label = label(place_mm, load(even(index, offsets), approach, patch));
        Press { session: REPLICATES, label, approach, dwell_s: DWELLS_S[0] }
    };
    let presses = places_mm.into_iter().enumerate().map(press);
    presses.flat_map(|press| [press; REPEATS]).collect()
}

/// Up to full scale and back at the centre and over three directions, slowly and fast.
fn ramps(draft: &mut PlanDraft, patch: &Patch) {
    let out_mm = patch.max_centre_radius_mm * 2.0 / 3.0;
    let around = [0.0, 120.0, 240.0].map(|deg| polar_mm(out_mm, deg));
    for (index, place_mm) in std::iter::once([0.0; 2]).chain(around).enumerate() {
        for (name, steps, step_s) in [("slow", 30, 1.0), ("fast", 10, 0.5)] {
            let force_n =
                |step: i32| patch.full_scale_n * (1.0 - f64::from((step - steps).abs()) / f64::from(steps));
            let series = (0..=2 * steps).map(|step| [f64::from(step) * step_s, force_n(step)]);
            draft.trial(&format!("ramp {index} {name}"), SERIES, place_mm, series);
        }
    }
}

/// Places that are even over the disc: a sunflower, turned at random.
///
/// Source: H. Vogel, "A better way to construct the sunflower head", Mathematical Biosciences 44 (1979).
fn sunflower_mm(patch: &Patch, places: usize, random: &mut SplitMix64) -> Vec<[f64; 2]> {
    let turn_deg = 360.0 * f64::from(random.fraction());
    let place_mm = |index: usize| {
        let share = ((index as f64 + 0.5) / places as f64).sqrt();
        polar_mm(share * patch.max_centre_radius_mm, turn_deg + index as f64 * GOLDEN_DEG)
    };
    (0..places).map(place_mm).collect()
}

/// The point of this index in a sequence that fills the unit cube evenly, in whatever part of it one looks.
///
/// Source: M. Roberts, "The unreasonable effectiveness of quasirandom sequences" (2018).
fn even(index: usize, offsets: [f64; 3]) -> [f64; 3] {
    let mut step = 1.0;
    offsets.map(|offset| {
        step /= QUARTIC;
        (offset + (index + 1) as f64 * step).fract()
    })
}

/// A load in the friction cone, by a point of the unit cube: even in magnitude and in the solid angle.
fn load([magnitude, height, azimuth]: [f64; 3], approach: Approach, patch: &Patch) -> Load {
    let largest = if approach == Approach::Unloading { UNLOADING_MAX } else { 1.0 };
    let share = MAGNITUDE_MIN + (largest - MAGNITUDE_MIN) * magnitude;
    let cos_max = libm::cos(TILT_MAX_DEG.to_radians());
    let tilt_deg = libm::acos(1.0 - (1.0 - cos_max) * height).to_degrees();
    Load { magnitude_n: share * patch.full_scale_n, tilt_deg, azimuth_deg: 360.0 * azimuth }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;
    use crate::tables::measured::Row;
    use crate::tables::measured::zero::ZERO;

    const PATCH: Patch = Patch { patch_radius_mm: 1.0, max_centre_radius_mm: 29.0, full_scale_n: 5.0 };

    fn of_session(plan: &Table, session: &str) -> Vec<Row> {
        let session = plan.sessions.iter().position(|name| name == session);
        plan.rows.iter().copied().filter(|row| row.session == session).collect()
    }

    /// Places, approaches and dwells as whole numbers.
    fn place(row: &Row) -> [i64; 2] {
        [row.label.x_mm, row.label.y_mm].map(|mm| (mm * 100.0).round() as i64)
    }

    #[test]
    fn the_seed_decides() {
        assert_eq!(plan(&PATCH, 3), plan(&PATCH, 3));
        let [one, other] = [3, 4].map(|seed| of_session(&plan(&PATCH, seed), SPREAD));
        assert!(one.iter().zip(&other).all(|(one, other)| one.label != other.label));
    }

    #[test]
    fn each_place_has_both_approaches_and_both_dwells() {
        let mut ways = BTreeMap::new();
        for row in of_session(&plan(&PATCH, 1), SPREAD) {
            let way = (row.approach.map(Approach::name), row.dwell_s.map(|dwell_s| dwell_s as i64));
            ways.entry(place(&row)).or_insert_with(Vec::new).push(way);
        }
        assert_eq!(ways.len(), PLACES);
        for mut ways in ways.into_values() {
            ways.sort_unstable();
            let both = |name| [(Some(name), Some(2)), (Some(name), Some(20))];
            assert_eq!(ways, [both("loading"), both("unloading")].concat());
        }
    }

    #[test]
    fn contacts_stay_on_the_plate_and_in_the_hysteresis_cone() {
        for seed in 0..5 {
            for row in plan(&PATCH, seed).rows {
                let Label { x_mm, y_mm, fx_n, fy_n, fz_n } = row.label;
                let (far_mm, shear_n) = (x_mm.hypot(y_mm), fx_n.hypot(fy_n));
                assert!(far_mm <= 29.0 && fz_n >= 0.0, "{:?}", row.label);
                // Forces are rounded to 1 mN.
                assert!(shear_n <= fz_n + 0.0015 && shear_n.hypot(fz_n) <= 5.001, "{:?}", row.label);
                let comes_down = row.approach == Some(Approach::Unloading);
                assert!(!comes_down || shear_n.hypot(fz_n) <= 4.001, "{:?}", row.label);
            }
        }
    }

    #[test]
    fn places_and_loads_are_even() {
        let rows = of_session(&plan(&PATCH, 2), SPREAD);
        // Eight parts of equal area by eight of equal angle: 480/64 contacts in each on average.
        let mut parts = BTreeMap::new();
        let mut azimuths = [0; 8];
        let mut signs = [[0; 2]; 2];
        for row in &rows {
            let Label { x_mm, y_mm, fx_n, fy_n, .. } = row.label;
            let eighth =
                |y: f64, x: f64| ((y.atan2(x).to_degrees().rem_euclid(360.0) / 45.0) as usize).min(7);
            let area = ((x_mm.hypot(y_mm) / 29.0).powi(2) * 8.0) as usize;
            *parts.entry((area, eighth(y_mm, x_mm))).or_insert(0) += 1;
            azimuths[eighth(fy_n, fx_n)] += 1;
            signs[usize::from(fx_n > 0.0)][usize::from(fy_n > 0.0)] += 1;
        }
        assert!(parts.len() == 64 && parts.values().all(|count| *count <= 16), "{parts:?}");
        assert!(azimuths.iter().all(|count| (54..=66).contains(count)), "{azimuths:?}");
        assert!(signs.as_flattened().iter().all(|count| (112..=128).contains(count)), "{signs:?}");
        let loads: BTreeSet<_> = rows.iter().map(|row| (row.label.fz_n * 1e3) as i64).collect();
        assert!(loads.len() > 400, "{}", loads.len());
    }

    #[test]
    fn order_is_random() {
        let rows = plan(&PATCH, 6).rows.into_iter().filter(|row| row.approach.is_some());
        let numbers: Vec<_> = rows
            .map(|row| {
                let is_down = f64::from(row.approach == Some(Approach::Unloading)) - 0.5;
                [
                    row.label.x_mm,
                    row.label.y_mm,
                    row.label.fz_n - 2.0,
                    is_down,
                    row.dwell_s.unwrap_or(0.0) - 10.0,
                ]
            })
            .collect();
        let correlation = |one: &dyn Fn(usize) -> f64, other: &dyn Fn(usize) -> f64| {
            let count = numbers.len() - 1;
            let sums =
                (0..count).map(|index| [one(index) * other(index), one(index).powi(2), other(index).powi(2)]);
            let [both, one, other] =
                sums.fold([0.0; 3], |sum, term| std::array::from_fn(|at| sum[at] + term[at]));
            both / (one * other).sqrt()
        };
        for column in 0..5 {
            let here = |index: usize| numbers[index][column];
            let next = |index: usize| numbers[index + 1][column];
            let time = |index: usize| index as f64 - 0.5 * numbers.len() as f64;
            // 1/√528 each: four and a half standard deviations.
            let found = [correlation(&here, &next), correlation(&here, &time)];
            assert!(found.iter().all(|found| found.abs() < 0.2), "column {column}: {found:?}");
        }
    }

    #[test]
    fn replicates_are_equal_and_scattered() {
        let plan = plan(&PATCH, 8);
        let mut times: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        let replicates = of_session(&plan, REPLICATES);
        let session = replicates[0].session;
        for (index, row) in plan.rows.iter().enumerate().filter(|(_, row)| row.session == session) {
            times.entry(place(row)).or_default().push(index);
            let first = replicates.iter().find(|first| place(first) == place(row)).unwrap();
            assert_eq!((row.label, row.approach, row.dwell_s), (first.label, first.approach, first.dwell_s));
        }
        assert_eq!(times.len(), REPLICATED_PLACES);
        assert!(times.values().all(|times| times.len() == REPEATS && times[5] - times[0] > 100), "{times:?}");
    }

    #[test]
    fn a_zero_comes_before_every_twenty_contacts_and_at_the_end() {
        let plan = plan(&PATCH, 9);
        let zero = plan.sessions.iter().position(|name| name == ZERO);
        let mut since = PRESSES_PER_ZERO;
        for row in plan.rows.iter().filter(|row| row.trial.is_none()) {
            since = if row.session == zero { 0 } else { since + 1 };
            assert!(since <= PRESSES_PER_ZERO);
        }
        assert!(plan.rows.last().unwrap().session == zero);
        // 528 presses: 27 before them, one after, one after the series.
        assert_eq!(of_session(&plan, ZERO).len(), 29);
    }

    #[test]
    fn series_go_up_and_down_again() {
        let plan = plan(&PATCH, 1);
        assert_eq!(plan.trials.len(), 10);
        for (index, name) in plan.trials.iter().enumerate() {
            let rows: Vec<_> = plan.rows.iter().filter(|row| row.trial == Some(index)).collect();
            assert!(
                rows.windows(2).all(|pair| pair[0].t_s < pair[1].t_s && place(pair[0]) == place(pair[1]))
            );
            let forces: Vec<_> = rows.iter().map(|row| row.label.fz_n).collect();
            let largest = forces.iter().copied().fold(0.0, f64::max);
            let wanted = match name.as_str() {
                "rest" => 0.0,
                "hold" => 3.0,
                _ => 5.0,
            };
            assert_eq!((forces[0], largest, forces[forces.len() - 1]), (0.0, wanted, 0.0), "{name}");
        }
    }
}
