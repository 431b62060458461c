//! The paper's calibration: 648 contacts on six diameters of the plate.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378, section 2.4. It names 73 places, 13 × 6 − 5, but counts 216 normal
//! contacts, which is 72 × 3, and 432 inclined ones, 72 × 6. So the centre is left out of the calibration. It belongs to
//! the comparison with the simulation, which names 73 presses of 1 N ([`places_mm`]).

use super::{Load, PlanDraft, cut_mm, label, polar_mm};
use crate::pad::device::Patch;
use crate::tables::measured::{Approach, Table};

/// The session of the contacts.
pub const CALIBRATION: &str = "calibration";

/// Places, the centre among them.
pub const PLACES: usize = 2 * RINGS * DIAMETERS + 1;

const DIAMETERS: usize = 6;
/// Places between the centre and the last circle, which is the sixth. The paper does not give its radii: ours are even.
const RINGS: usize = 6;
/// Places whose contacts are between two zeros.
const PLACES_PER_ZERO: usize = 2 * RINGS;
/// 1, 3 and 5 N of 5 N.
const MAGNITUDES: [f64; 3] = [0.2, 0.6, 1.0];
const TILTS_DEG: [f64; 2] = [30.0, 60.0];
const AZIMUTHS_DEG: [f64; 3] = [0.0, 120.0, 240.0];
/// The paper has none.
const DWELL_S: f64 = 2.0;

/// The 73 places, one diameter after the other; the centre comes with the first one.
///
/// The last circle is that of the farthest contacts, so no contact leaves the plate.
pub fn places_mm(patch: &Patch) -> Vec<[f64; 2]> {
    let mut places_mm = Vec::with_capacity(PLACES);
    for diameter in 0..DIAMETERS {
        let deg = diameter as f64 * 180.0 / DIAMETERS as f64;
        for step in 0..=2 * RINGS {
            let share = step as f64 / RINGS as f64 - 1.0;
            if step != RINGS || diameter == 0 {
                places_mm.push(polar_mm(share * patch.max_centre_radius_mm, deg).map(cut_mm));
            }
        }
    }
    places_mm
}

/// The paper's plan: 648 contacts in session [`CALIBRATION`], with zeros between them.
///
/// First the 216 normal contacts, then the inclined ones in three passes of 144, so that the first 216, 360, 504 and 648
/// contacts are the samples of the paper's Table 3. A pass has one azimuth for each place, with both tilts; over a pass
/// each azimuth meets each magnitude equally often.
pub fn plan(patch: &Patch) -> Table {
    let mut places_mm = places_mm(patch);
    places_mm.retain(|place_mm| *place_mm != [0.0; 2]);
    let mut draft = PlanDraft::new(DWELL_S);
    let passes = std::iter::once(None).chain((0..AZIMUTHS_DEG.len()).map(Some));
    for pass in passes {
        for (index, place_mm) in places_mm.iter().enumerate() {
            if index % PLACES_PER_ZERO == 0 {
                draft.zero();
            }
            let loads = pass.map_or_else(|| normal().to_vec(), |pass| inclined(index, pass).to_vec());
            for load in loads {
                let magnitude_n = load.magnitude_n * patch.full_scale_n;
                let label = label(*place_mm, Load { magnitude_n, ..load });
                draft.press(CALIBRATION, label, Approach::Loading, DWELL_S);
            }
        }
    }
    draft.zero();
    draft.table
}

/// The normal loads of a place, in full scales.
fn normal() -> [Load; MAGNITUDES.len()] {
    MAGNITUDES.map(Load::normal)
}

/// The inclined loads of a place in one pass, in full scales.
fn inclined(place: usize, pass: usize) -> [Load; TILTS_DEG.len()] {
    // By threes of places. By single places the magnitude, which follows those, would never change in a pass.
    let azimuth = (place / AZIMUTHS_DEG.len() + pass) % AZIMUTHS_DEG.len();
    let azimuth_deg = AZIMUTHS_DEG.get(azimuth).copied().unwrap_or_default();
    // The magnitudes shift to the right from place to place.
    let turns = MAGNITUDES.len() - place % MAGNITUDES.len();
    let magnitude_n = MAGNITUDES.get((azimuth + turns) % MAGNITUDES.len()).copied().unwrap_or_default();
    TILTS_DEG.map(|tilt_deg| Load { magnitude_n, tilt_deg, azimuth_deg })
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;
    use crate::tables::measured::zero::ZERO;
    use crate::tables::measured::{Label, Row};

    const PATCH: Patch = Patch { patch_radius_mm: 1.0, max_centre_radius_mm: 29.0, full_scale_n: 5.0 };

    /// The rows of the calibration, in their order.
    fn contacts(plan: &Table) -> Vec<Row> {
        let calibration = plan.sessions.iter().position(|name| name == CALIBRATION);
        plan.rows.iter().copied().filter(|row| row.session == calibration).collect()
    }

    /// Magnitude in N, tilt and azimuth in degrees, to the nearest whole number.
    fn spherical(Label { fx_n, fy_n, fz_n, .. }: Label) -> [i64; 3] {
        let shear_n = fx_n.hypot(fy_n);
        let azimuth_deg = fy_n.atan2(fx_n).to_degrees().rem_euclid(360.0);
        [shear_n.hypot(fz_n), shear_n.atan2(fz_n).to_degrees(), azimuth_deg]
            .map(|number| number.round() as i64)
    }

    fn place(label: Label) -> [i64; 2] {
        [label.x_mm, label.y_mm].map(|mm| (mm * 100.0).round() as i64)
    }

    #[test]
    fn places_are_six_diameters_of_thirteen_and_one_centre() {
        let places_mm = places_mm(&PATCH);
        assert_eq!(places_mm.len(), PLACES);
        assert_eq!(places_mm.iter().filter(|place_mm| **place_mm == [0.0; 2]).count(), 1);
        let mut circles = BTreeMap::new();
        for [x_mm, y_mm] in places_mm {
            assert!(x_mm.hypot(y_mm) <= 29.0);
            *circles.entry((x_mm.hypot(y_mm) * 6.0 / 29.0).round() as i64).or_insert(0) += 1;
        }
        assert_eq!(
            circles.into_iter().collect::<Vec<_>>(),
            [(0, 1), (1, 12), (2, 12), (3, 12), (4, 12), (5, 12), (6, 12)]
        );
    }

    #[test]
    fn counts_are_the_papers() {
        let plan = plan(&PATCH);
        let contacts = contacts(&plan);
        let is_normal = |row: &Row| (row.label.fx_n, row.label.fy_n) == (0.0, 0.0);
        assert_eq!(contacts.len(), 648);
        assert_eq!(contacts.iter().filter(|row| is_normal(row)).count(), 216);
        assert!(contacts[..216].iter().all(is_normal) && !contacts[216..].iter().any(is_normal));
        let places: BTreeSet<_> = contacts.iter().map(|row| place(row.label)).collect();
        assert!(places.len() == 72 && !places.contains(&[0, 0]));
        for place_of in places {
            let here =
                || contacts.iter().filter(|row| place(row.label) == place_of).map(|row| spherical(row.label));
            let normal: Vec<_> =
                here().filter(|[_, tilt, _]| *tilt == 0).map(|[magnitude, ..]| magnitude).collect();
            assert_eq!(normal, [1, 3, 5]);
            let inclined: BTreeSet<_> =
                here().filter(|[_, tilt, _]| *tilt > 0).map(|[_, tilt, azimuth]| (tilt, azimuth)).collect();
            assert_eq!(
                inclined.into_iter().collect::<Vec<_>>(),
                [(30, 0), (30, 120), (30, 240), (60, 0), (60, 120), (60, 240)]
            );
        }
        let one_way = |row: &Row| row.approach == Some(Approach::Loading) && row.dwell_s == Some(DWELL_S);
        assert!(contacts.iter().all(|row| one_way(row) && row.trial.is_none()));
    }

    #[test]
    fn directions_tilts_and_magnitudes_meet_equally_often_in_each_pass() {
        let plan = plan(&PATCH);
        for pass in contacts(&plan)[216..].chunks(144) {
            let mut counts = BTreeMap::new();
            for row in pass {
                *counts.entry(spherical(row.label)).or_insert(0) += 1;
            }
            assert!(counts.len() == 18 && counts.values().all(|count| *count == 8), "{counts:?}");
            let places: BTreeSet<_> = pass.iter().map(|row| place(row.label)).collect();
            assert_eq!(places.len(), 72);
        }
    }

    #[test]
    fn magnitudes_shift_right_from_place_to_place() {
        let plan = plan(&PATCH);
        let mut magnitudes = BTreeMap::new();
        for row in &contacts(&plan)[216..] {
            let [magnitude, _, azimuth] = spherical(row.label);
            magnitudes.entry(place(row.label)).or_insert_with(BTreeMap::new).insert(azimuth, magnitude);
        }
        let wanted = [[1, 3, 5], [5, 1, 3], [3, 5, 1]];
        let around = places_mm(&PATCH).into_iter().filter(|place_mm| *place_mm != [0.0; 2]);
        for (index, [x_mm, y_mm]) in around.enumerate() {
            let found: Vec<_> =
                magnitudes[&place(Label { x_mm, y_mm, ..Label::default() })].values().copied().collect();
            assert_eq!(found, wanted[index % 3]);
        }
    }

    #[test]
    fn zeros_come_first_last_and_with_each_diameter() {
        let plan = plan(&PATCH);
        let zero = plan.sessions.iter().position(|name| name == ZERO);
        let zeros: Vec<_> = (0..plan.rows.len()).filter(|index| plan.rows[*index].session == zero).collect();
        assert_eq!((zeros.len(), zeros[0], zeros[24]), (25, 0, plan.rows.len() - 1));
        assert!(zeros.windows(2).all(|pair| pair[1] - pair[0] <= 37));
        assert!(zeros.iter().all(|index| plan.rows[*index].label == Label::default()));
        assert_eq!(plan.rows.len(), 648 + 25);
    }

    #[test]
    fn the_device_sets_the_ranges() {
        let small = Patch { patch_radius_mm: 1.0, max_centre_radius_mm: 12.0, full_scale_n: 10.0 };
        let labels = plan(&small).rows.into_iter().map(|row| row.label);
        let far_mm = labels.clone().map(|label| label.x_mm.hypot(label.y_mm)).fold(0.0, f64::max);
        let most_n = labels.map(|label| label.fz_n).fold(0.0, f64::max);
        assert_eq!((far_mm, most_n), (12.0, 10.0));
    }
}
