//! A bond between post and plate that has come off on one side.

use crate::effects::local::LOCAL;
use crate::effects::mechanical::add;
use crate::fields::{Influence, NOMINAL, SOFT_FRAME, View};
use crate::truth::Truth;

/// Half the post along x and y, in mm.
const HALF_POST: [f64; 2] = [1.0, 0.7];
/// From the film's middle to the bond, in mm: the lever of a shear force on the post.
const LEVER_MM: f64 = 1.2 + 0.05 + 0.15;

/// What is left of the bond lies off the post's middle, towards the side that holds: the force comes to the post there,
/// and its moment rocks the post as a shear force at the bond's height does.
pub(crate) fn change(truth: &Truth, place: [f64; 2]) -> Influence {
    let share = truth.value("area_share");
    let nominal = NOMINAL.at(place);
    let first = 3 * truth.module();
    let mut field = Influence::default();
    let (axis, off) = match truth.side.as_deref() {
        Some("+x") => (0, 1.0),
        Some("-x") => (0, -1.0),
        Some("+y") => (1, 1.0),
        _ => (1, -1.0),
    };
    let middle_mm = -off * share * HALF_POST[axis];
    let rocking = if axis == 0 { LOCAL.x } else { LOCAL.yz[0][0] } / LEVER_MM;
    for (row, pressed) in field[first + axis].iter_mut().zip(nominal[first + 2]) {
        *row += rocking * middle_mm * pressed / LOCAL.yz[1][1];
    }
    let soft = View { table: &SOFT_FRAME, home: 2, target: truth.module(), mirrored: false }.at(place);
    let compliance = COMPLIANCE * share / (1.0 - share);
    add(&mut field, compliance, &soft);
    add(&mut field, -compliance, &nominal);
    field
}

/// What a bond that is gone adds to a module's compliance, in units of the table of the soft frame.
const COMPLIANCE: f64 = 0.05;
