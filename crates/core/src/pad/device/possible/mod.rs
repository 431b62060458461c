//! Whether the parts of a device fit together. What does not is reported at the number that is most likely wrong.
//!
//! A module's film, and the frame below it, must lie under the plate: the file has no outline for the base, so
//! the base ends where the plate does.

use std::f64::consts::TAU;

use self::finding::Finding;
use super::reading::DeviceText;
use super::schema::GAUGE_NAMES;
use super::unit::shown;
use super::{Device, Direction, Gauge};
use crate::quantity::MODULES;

mod behaviour;
mod finding;

/// Modules that stand closer than this are meant to stand elsewhere.
const CLOSE_DEG: f64 = 30.0;
/// Lengths differ by more than this if they differ; sums of decimal fractions are off by less.
const ROUNDING_MM: f64 = 1e-9;

/// Reports every pair of numbers that contradict each other. A number that is NaN contradicts none.
pub(super) fn check(device: &Device, reading: &mut DeviceText<'_>) {
    let mut finding = Finding::new(reading);
    check_window(device, &mut finding);
    check_gauges(device, &mut finding);
    if check_angles(&device.sites.angles_deg, &mut finding) {
        check_overlap(device, &mut finding);
    }
    check_outline(device, &mut finding);
    check_tilt(device, &mut finding);
    check_contact(device, &mut finding);
    behaviour::check(&device.behaviour, &mut finding);
}

fn check_window(device: &Device, finding: &mut Finding<'_, '_>) {
    let stack = &device.stack;
    let sides = [
        ("film_length_x_mm", stack.film_length_x_mm, "post_length_x_mm", stack.post_length_x_mm),
        ("film_width_y_mm", stack.film_width_y_mm, "post_width_y_mm", stack.post_width_y_mm),
    ];
    for (film_key, film_mm, post_key, post_mm) in sides {
        let window_mm = film_mm - 2.0 * stack.frame_width_mm;
        if window_mm <= ROUNDING_MM {
            let message = format!(
                "\"frame_width_mm\" ({}) leaves no window: \"{film_key}\" is {}",
                shown(stack.frame_width_mm),
                shown(film_mm)
            );
            let help = format!("write less than {}, or a larger film", shown(film_mm / 2.0));
            finding.refuse(&["stack.frame_width_mm"], message, help);
        } else if post_mm >= window_mm - ROUNDING_MM {
            let message = format!("\"{post_key}\" ({}) does not fit into the frame's window", shown(post_mm));
            let help = format!(
                "the post stands on the free film: write less than {}, or a narrower frame",
                rounded(window_mm)
            );
            finding.refuse(&[&format!("stack.{post_key}")], message, help);
        }
    }
}

/// Half the gauge's size along x and y.
fn half_size_mm(gauge: &Gauge) -> [f64; 2] {
    match gauge.direction {
        Direction::X => [gauge.length_mm / 2.0, gauge.width_mm / 2.0],
        Direction::Y => [gauge.width_mm / 2.0, gauge.length_mm / 2.0],
    }
}

fn check_gauges(device: &Device, finding: &mut Finding<'_, '_>) {
    let film_mm = [device.stack.film_length_x_mm / 2.0, device.stack.film_width_y_mm / 2.0];
    for (index, (gauge, name)) in device.gauges.iter().zip(GAUGE_NAMES).enumerate() {
        let half_mm = half_size_mm(gauge);
        let axes = [("x", gauge.x_mm, half_mm[0], film_mm[0]), ("y", gauge.y_mm, half_mm[1], film_mm[1])];
        for (axis, centre_mm, half_mm, edge_mm) in axes {
            if centre_mm.abs() + half_mm > edge_mm + ROUNDING_MM {
                let message = format!("gauge {name} leaves the film");
                let help = format!(
                    "along {axis} it reaches {} mm from the module's centre, the film {}",
                    rounded(centre_mm.abs() + half_mm),
                    rounded(edge_mm)
                );
                finding.refuse(&[&format!("gauge.{name}.{axis}")], message, help);
            }
        }
        for (other, other_name) in device.gauges.iter().zip(GAUGE_NAMES).take(index) {
            if gauges_overlap(gauge, other) {
                let message = format!("gauges {other_name} and {name} overlap");
                let help = "gauges lie side by side on the film's underside";
                finding.refuse(&[&format!("gauge.{name}.x")], message, help);
            }
        }
    }
}

fn gauges_overlap(left: &Gauge, right: &Gauge) -> bool {
    let (left_half, right_half) = (half_size_mm(left), half_size_mm(right));
    (left.x_mm - right.x_mm).abs() < left_half[0] + right_half[0] - ROUNDING_MM
        && (left.y_mm - right.y_mm).abs() < left_half[1] + right_half[1] - ROUNDING_MM
}

/// Whether the angles can be the modules' at all.
fn check_angles(angles_deg: &[f64; MODULES], finding: &mut Finding<'_, '_>) -> bool {
    let name = |index: usize| format!("modules.angles_deg.{index}");
    if angles_deg.iter().all(|angle| angle.abs() <= TAU) && angles_deg.iter().any(|angle| *angle != 0.0) {
        let degrees = angles_deg.map(|angle| format!("{:.1}", angle.to_degrees())).join(", ");
        let message = "\"angles_deg\" puts the modules into one another".to_owned();
        finding.refuse(&[&name(0)], message, format!("if these are radians, write [{degrees}]"));
        return false;
    }
    for (index, pair) in (1..).zip(angles_deg.windows(2)) {
        let &[before, after] = pair else { continue };
        if after <= before {
            let message =
                format!("\"angles_deg\" must ascend: {} comes after {}", shown(after), shown(before));
            let help = "modules 0, 1 and 2 follow each other counter-clockwise, as in [0, 120, 240]";
            finding.refuse(&[&name(index)], message, help);
            return false;
        }
    }
    if angles_deg[MODULES - 1] - angles_deg[0] >= 360.0 {
        let message = "\"angles_deg\" must stay within one turn".to_owned();
        finding.refuse(&[&name(MODULES - 1)], message, "the last angle is less than the first one and 360");
        return false;
    }
    true
}

fn check_overlap(device: &Device, finding: &mut Finding<'_, '_>) {
    let poses = device.poses();
    let half_mm = half_film_mm(device);
    for (later, pose) in poses.iter().enumerate() {
        for (earlier, other) in poses.iter().enumerate().take(later) {
            if pose.overlaps(other, half_mm) {
                let (suspects, help) = why_overlap(device, earlier, later);
                let suspects: Vec<_> = suspects.iter().map(String::as_str).collect();
                finding.refuse(&suspects, format!("modules {earlier} and {later} overlap"), help);
            }
        }
    }
}

/// The numbers that may bring two modules together, the likeliest first, and the way out.
fn why_overlap(device: &Device, earlier: usize, later: usize) -> (Vec<String>, String) {
    let angle_deg = device.sites.angles_deg[later];
    let apart_deg = (angle_deg - device.sites.angles_deg[earlier]).abs();
    let (drawn, help) = if apart_deg.min(360.0 - apart_deg) < CLOSE_DEG {
        (format!("modules.angles_deg.{later}"), close_help(angle_deg))
    } else if film_is_vast(device) {
        (
            "stack.film_length_x_mm".to_owned(),
            "write a smaller film, or put the modules farther out".to_owned(),
        )
    } else {
        (
            "modules.centre_radius_mm".to_owned(),
            "put the modules farther out, or write a smaller film".to_owned(),
        )
    };
    let suspects = suspects(device, &[earlier, later], &drawn);
    if suspects.first() == Some(&drawn) {
        return (suspects, help);
    }
    (suspects, "displaced and turned, their films do not lie side by side".to_owned())
}

fn close_help(angle_deg: f64) -> String {
    if (0.0..=TAU).contains(&angle_deg) && angle_deg != 0.0 {
        return format!("if it is in radians, write {:.1}", angle_deg.to_degrees());
    }
    "modules stand all around the pad, as at 0, 120 and 240 degrees".to_owned()
}

/// What brings modules where they are, the likeliest first: displacements that are not zero, the largest first;
/// then the number `drawn` that all modules share; then displacements that a file took back to zero.
fn suspects(device: &Device, modules: &[usize], drawn: &str) -> Vec<String> {
    let mut shifts: Vec<(f64, String)> = Vec::new();
    for index in modules {
        let module = &device.modules[*index];
        let keys = [
            ("radial_mm", module.radial_mm),
            ("tangential_mm", module.tangential_mm),
            ("rotation_deg", module.rotation_deg),
        ];
        shifts.extend(keys.map(|(key, shift)| (shift.abs(), format!("module.{index}.{key}"))));
    }
    shifts.sort_by(|left, right| right.0.total_cmp(&left.0));
    let at_rest = shifts.iter().position(|(shift, _)| *shift == 0.0).unwrap_or(shifts.len());
    shifts.insert(at_rest, (0.0, drawn.to_owned()));
    shifts.into_iter().map(|(_, name)| name).collect()
}

fn check_outline(device: &Device, finding: &mut Finding<'_, '_>) {
    let plate_mm = device.plate.radius_mm();
    for (index, pose) in device.poses().iter().enumerate() {
        let corners_mm = pose.corners_mm(half_film_mm(device)).map(|[x, y]| x.hypot(y));
        let reach_mm = corners_mm.into_iter().fold(0.0, f64::max);
        if reach_mm > plate_mm + ROUNDING_MM {
            let message = format!(
                "module {index} leaves the plate: its film reaches {} mm from the axis, the plate {} mm",
                rounded(reach_mm),
                rounded(plate_mm)
            );
            let drawn =
                if film_is_vast(device) { "stack.film_length_x_mm" } else { "modules.centre_radius_mm" };
            let names = suspects(device, &[index], drawn);
            let names: Vec<_> = names.iter().map(String::as_str).collect();
            let help =
                "the base ends where the plate does, and each frame stands on it: put the module farther in";
            finding.refuse(&names, message, help);
        }
    }
}

fn check_tilt(device: &Device, finding: &mut Finding<'_, '_>) {
    let gap_mm = device.stack.post_height_mm + device.stack.bond_thickness_mm;
    let half_mm = half_film_mm(device);
    for (index, module) in device.modules.iter().enumerate() {
        let (outwards, along) = (module.tilt_tangential_deg, module.tilt_radial_deg);
        let rise_mm =
            half_mm[1] * outwards.to_radians().tan().abs() + half_mm[0] * along.to_radians().tan().abs();
        if rise_mm >= gap_mm {
            let mut keys = ["tilt_tangential_deg", "tilt_radial_deg"];
            if along.abs() > outwards.abs() {
                keys.reverse();
            }
            let message = format!("module {index} is tilted into the plate");
            let help = format!(
                "the film's corner rises by {} mm, the gap under the plate is {} mm",
                rounded(rise_mm),
                rounded(gap_mm)
            );
            let names = keys.map(|key| format!("module.{index}.{key}"));
            finding.refuse(&[&names[0], &names[1], "stack.post_height_mm"], message, help);
        }
    }
}

fn check_contact(device: &Device, finding: &mut Finding<'_, '_>) {
    let (plate_mm, contact) = (device.plate.radius_mm(), &device.contact);
    if contact.max_centre_radius_mm + contact.patch_radius_mm > plate_mm + ROUNDING_MM {
        let message = format!(
            "a contact at \"max_centre_radius_mm\" ({}) leaves the plate",
            shown(contact.max_centre_radius_mm)
        );
        let help = format!(
            "with \"patch_radius_mm\" it reaches {} mm from the axis, the plate {} mm",
            rounded(contact.max_centre_radius_mm + contact.patch_radius_mm),
            rounded(plate_mm)
        );
        let mut names = ["contact.max_centre_radius_mm", "contact.patch_radius_mm"];
        if contact.patch_radius_mm > contact.max_centre_radius_mm {
            names.reverse();
        }
        finding.refuse(&names, message, help);
    }
}

/// Whether the film is so long that it, and not its place, is wrong.
fn film_is_vast(device: &Device) -> bool {
    device.stack.film_length_x_mm > device.plate.radius_mm()
}

/// Half the film's size along a module's x and y.
const fn half_film_mm(device: &Device) -> [f64; 2] {
    [device.stack.film_length_x_mm / 2.0, device.stack.film_width_y_mm / 2.0]
}

/// A length as a sentence shows it, to a micrometre.
fn rounded(length_mm: f64) -> String {
    shown((length_mm * 1e3).round() / 1e3)
}
