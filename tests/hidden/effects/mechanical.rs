//! What changes the influence field: modules that are displaced, turned, soft or open, another plate, another contact.
//!
//! A changed field is the nominal one and a share of the difference to a table. For a cause that a mirror turns round,
//! the difference splits into an odd and an even part, which are exact in their order; for the rest the share follows
//! the physics: a stiffness acts by its compliance.

use crate::fields::{Influence, MOVED, NOMINAL, OPEN_FRAME, SOFT_FRAME, THICK_PLATE, TURNED, Table, View};
use crate::truth::{Truth, module};

/// Share of the frame's area that is missing in the table of the open frame: 0.8 mm of 5.4 mm, of 21.76 mm².
pub(crate) const OPEN_SHARE: f64 = 0.8 * 5.4 / 21.76;

/// What a contact at a place reads per newton, with all hidden causes.
pub(crate) fn influence(truths: &[Truth], place: [f64; 2]) -> Influence {
    let mut field = NOMINAL.at(place);
    for truth in truths {
        add(&mut field, 1.0, &change(truth, place));
    }
    for truth in truths {
        mix(&mut field, truth);
    }
    field
}

/// The first-order change of the field.
fn change(truth: &Truth, place: [f64; 2]) -> Influence {
    match truth.effect.as_str() {
        "module_displaced" => displaced(truth, place),
        "module_rotated" => rotated(truth, place),
        "module_stiffness" => {
            let share = softened(truth.value("factor"), 0.6, 0.24);
            scaled(share, difference(&SOFT_FRAME, 2, truth.module(), false, place))
        }
        "module_frame_open" => {
            let mirrored = truth.side.as_deref() == Some("+x");
            let share = truth.value("area_share") / OPEN_SHARE;
            scaled(share, difference(&OPEN_FRAME, 0, truth.module(), mirrored, place))
        }
        "plate_stiffness" => {
            let share = softened(truth.value("factor"), 1.15_f64.powi(3), 0.15);
            scaled(share, difference(&THICK_PLATE, 0, 0, false, place))
        }
        "contact_size" => patch(truth.value("radius_mm"), place),
        "contact_height" => height(truth.value("mm"), place),
        _ => Influence::default(),
    }
}

/// The share of a table's change that another factor of the stiffness makes.
///
/// Between springs in a row and side by side a change of compliance c acts as c/(1 + kc): all of it where the part is
/// soft beside the rest (k = 0), less and less where the rest takes over. No table tells k; it comes from the comparison
/// with the simulator at three other factors.
fn softened(factor: f64, table: f64, k: f64) -> f64 {
    let change = |factor: f64| (1.0 / factor - 1.0) / (1.0 + k * (1.0 / factor - 1.0));
    change(factor) / change(table)
}

/// A part that the mirror leaves belongs to the radius, the other to the tangent.
fn displaced(truth: &Truth, place: [f64; 2]) -> Influence {
    let [plus, minus] = [false, true].map(|mirror| difference(&MOVED, 0, truth.module(), mirror, place));
    let mut field = Influence::default();
    let radial = truth.value_or_zero("radial_mm") / -0.7;
    let tangential = truth.value_or_zero("tangential_mm") / 0.9;
    add(&mut field, (radial + tangential) / 2.0, &plus);
    add(&mut field, (radial - tangential) / 2.0, &minus);
    field
}

/// The odd part goes with the angle, the even one with its square.
fn rotated(truth: &Truth, place: [f64; 2]) -> Influence {
    let [minus, plus] = [false, true].map(|mirror| difference(&TURNED, 1, truth.module(), mirror, place));
    let turn = truth.value("deg") / 5.0;
    let mut field = Influence::default();
    add(&mut field, (turn * turn + turn) / 2.0, &plus);
    add(&mut field, (turn * turn - turn) / 2.0, &minus);
    field
}

fn difference(table: &Table, home: usize, target: usize, mirrored: bool, place: [f64; 2]) -> Influence {
    let mut field = View { table, home, target, mirrored }.at(place);
    add(&mut field, -1.0, &View { table: &NOMINAL, home, target, mirrored }.at(place));
    field
}

/// An even disc of radius R reads the field and R²/8 of its Laplacian; the tables are for 1 mm. The mean over a ring of
/// radius ρ has ρ²/4 of it, so that a ring with ρ² = (R² − 1)/2 makes the difference.
fn patch(radius_mm: f64, place: [f64; 2]) -> Influence {
    let squared = (radius_mm * radius_mm - 1.0) / 2.0;
    let mut field = Influence::default();
    for step in 0..24 {
        let (sin, cos) = f64::from(step * 15).to_radians().sin_cos();
        let radius = squared.abs().sqrt();
        let at = [place[0] + radius * cos, place[1] + radius * sin];
        add(&mut field, squared.signum() / 24.0, &NOMINAL.at(at));
    }
    add(&mut field, -squared.signum(), &NOMINAL.at(place));
    field
}

/// A shear force above the plate tips it: fx at a height h is a moment h·fx, which a pressing force makes by moving.
fn height(height_mm: f64, place: [f64; 2]) -> Influence {
    let step = 0.1;
    let slope = |x: f64, y: f64| {
        let [ahead, behind] =
            [step, -step].map(|step| NOMINAL.at([place[0] + step * x, place[1] + step * y]));
        (0..9).map(|channel| (ahead[channel][2] - behind[channel][2]) / (2.0 * step)).collect::<Vec<f64>>()
    };
    let [along_x, along_y] = [slope(1.0, 0.0), slope(0.0, 1.0)];
    std::array::from_fn(|channel| [height_mm * along_x[channel], height_mm * along_y[channel], 0.0])
}

/// A leak between modules takes over a share of all three signals.
fn mix(field: &mut Influence, truth: &Truth) {
    if truth.effect != "module_crosstalk" {
        return;
    }
    let source = truth.with.as_deref().and_then(module).unwrap_or_default();
    let seen = *field;
    for axis in 0..3 {
        let leaks = seen[3 * source + axis].map(|value| truth.value("share") * value);
        field[3 * truth.module() + axis].iter_mut().zip(leaks).for_each(|(value, leak)| *value += leak);
    }
}

/// Adds a share of a field.
pub(crate) fn add(field: &mut Influence, share: f64, other: &Influence) {
    for (value, other) in field.iter_mut().flatten().zip(other.iter().flatten()) {
        *value += share * other;
    }
}

fn scaled(share: f64, field: Influence) -> Influence {
    field.map(|row| row.map(|value| share * value))
}
