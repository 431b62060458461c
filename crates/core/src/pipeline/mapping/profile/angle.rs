//! Angles on the plate.

/// The same angle between −180° and 180°, for one between −540° and 540°.
pub(crate) fn wrapped(angle_deg: f32) -> f32 {
    if angle_deg > 180.0 {
        angle_deg - 360.0
    } else if angle_deg < -180.0 {
        angle_deg + 360.0
    } else {
        angle_deg
    }
}

/// The angle of an arc of this length at this distance from the centre; the whole turn in the middle.
pub(crate) fn along_deg(arc_mm: f32, radius_mm: f32) -> f32 {
    if arc_mm > 0.0 { (arc_mm / radius_mm).to_degrees().min(360.0) } else { 0.0 }
}
