//! Where a hand has its centre, and how it is turned: by the places of touches that meant directions.

use super::labels::Labels;
use super::trace::{Trace, TraceEvents};
use super::vocabulary::in_order;
use tactpad_core::pipeline::mapping::profile::{Binding, Dpad};
use tactpad_core::quantity::Contact;

/// A touch is where it is at this share of its highest force or more: what comes before and after is on the way.
const PRESSED_SHARE: f32 = 0.5;

/// Fewer touches of a direction say nothing.
const TOUCHES_MIN: usize = 3;

/// A hand on the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandPose {
    /// Its centre.
    pub centre_mm: [f64; 2],
    /// What it takes for right is so far counter-clockwise of right.
    pub rotation_deg: f64,
    /// How far it goes for a direction.
    pub radius_mm: f64,
}

/// The centre alone, for a hand that is not turned, and both together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseFits {
    /// With the rotation that was given.
    pub shifted: HandPose,
    /// With the rotation that fits best.
    pub turned: HandPose,
}

/// Fits the place pₖ of touches that mean the direction uₖ:
///
/// ```text
/// pₖ = c + r R(φ) uₖ        least squares over the directions, each by the median of its touches, and by their number
/// ```
///
/// With a and b for r cos φ and r sin φ it is linear. `None` unless at least two directions are known that are not the same.
pub fn hand(dpad: &Dpad, trace: &Trace, labels: &Labels, rotation_deg: f64) -> Option<PoseFits> {
    let known = directions(dpad, trace, labels);
    let total: f64 = known.iter().map(|it| it.weight).sum();
    let mean = |of: fn(&Direction) -> [f64; 2]| {
        let sum = |axis: usize| known.iter().map(|it| it.weight * of(it)[axis]).sum::<f64>() / total;
        [sum(0), sum(1)]
    };
    let (p, u) = (mean(|it| it.place_mm), mean(|it| it.towards));
    let (mut along, mut across, mut spread) = (0.0, 0.0, 0.0);
    for it in &known {
        let [px, py] = [it.place_mm[0] - p[0], it.place_mm[1] - p[1]];
        let [ux, uy] = [it.towards[0] - u[0], it.towards[1] - u[1]];
        along += it.weight * (ux * px + uy * py);
        across += it.weight * (ux * py - uy * px);
        spread += it.weight * (ux * ux + uy * uy);
    }
    if spread <= 1e-9 * total || known.len() < 2 {
        return None;
    }
    let (a, b) = (along / spread, across / spread);
    let at = |a: f64, b: f64| HandPose {
        centre_mm: [p[0] - (a * u[0] - b * u[1]), p[1] - (b * u[0] + a * u[1])],
        rotation_deg: b.atan2(a).to_degrees(),
        radius_mm: a.hypot(b),
    };
    let (sin, cos) = rotation_deg.to_radians().sin_cos();
    let radius_mm = a * cos + b * sin;
    let shifted = HandPose { rotation_deg, ..at(radius_mm * cos, radius_mm * sin) };
    Some(PoseFits { shifted, turned: at(a, b) })
}

/// The touches that meant one direction.
struct Direction {
    towards: [f64; 2],
    place_mm: [f64; 2],
    weight: f64,
}

fn directions(dpad: &Dpad, trace: &Trace, labels: &Labels) -> Vec<Direction> {
    let classes = labels.classes().iter().enumerate();
    let of_class = |(number, class): (usize, &super::labels::Class)| {
        let towards = towards(dpad, &class.controls)?;
        let meant = labels.labels().iter().filter(|label| label.class == number);
        let places: Vec<[f64; 2]> =
            meant.filter_map(|label| place_mm(&trace.between(label.begin_us, label.end_us))).collect();
        (places.len() >= TOUCHES_MIN).then(|| Direction {
            towards,
            place_mm: [0, 1].map(|axis| median(places.iter().map(|place| place[axis]).collect())),
            weight: places.len() as f64,
        })
    };
    classes.filter_map(of_class).collect()
}

/// The way of the direction that is among these controls; of two the way between them.
fn towards(dpad: &Dpad, controls: &[Binding]) -> Option<[f64; 2]> {
    let all =
        [(dpad.right, [1.0, 0.0]), (dpad.up, [0.0, 1.0]), (dpad.left, [-1.0, 0.0]), (dpad.down, [0.0, -1.0])];
    let meant = all.into_iter().filter(|(keys, _)| {
        let keys = in_order(keys.iter().collect());
        !keys.is_empty() && keys.iter().all(|key| controls.contains(key))
    });
    let [x, y] = meant.fold([0.0, 0.0], |[x, y], (_, [ux, uy])| [x + ux, y + uy]);
    let length = f64::hypot(x, y);
    (length > 0.0).then(|| [x / length, y / length])
}

/// Where the touch of a stretch was: the mean of its places under force, each by its force.
fn place_mm(stretch: &Trace) -> Option<[f64; 2]> {
    let touched = || {
        stretch.moments().iter().filter_map(|moment| match &moment.heard {
            TraceEvents::Contact(contact) => Some(contact),
            TraceEvents::Nothing | TraceEvents::Doubt => None,
        })
    };
    let highest_n = touched().map(|contact| contact.fz_n).fold(0.0, f32::max);
    let pressed = || touched().filter(|contact| contact.fz_n >= PRESSED_SHARE * highest_n);
    let sum = |of: fn(&Contact) -> f64| pressed().map(of).sum::<f64>();
    let total = sum(|it| f64::from(it.fz_n));
    let x = sum(|it| f64::from(it.fz_n) * f64::from(it.x_mm));
    let y = sum(|it| f64::from(it.fz_n) * f64::from(it.y_mm));
    (total > 0.0).then(|| [x / total, y / total])
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.get(..=middle) {
        Some([.., below, at]) if values.len().is_multiple_of(2) => 0.5 * (below + at),
        Some([.., at]) => *at,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tuning::trace::TracePoint;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::pipeline::mapping::read::shipped;
    use tactpad_core::time::StreamInstant;

    /// A hand that touches `names` in turn, three times each.
    fn found(names: &[&str], centre_mm: [f64; 2], rotation_deg: f64) -> Option<PoseFits> {
        let profile = read(shipped::text("contra").unwrap(), OutputChoice::AsWritten).0.unwrap();
        let angle_deg = |name: &str| match name {
            "right" => 0.0,
            "up+right" => 45.0,
            "up" => 90.0,
            "left" => 180.0,
            _ => 270.0_f64,
        };
        let (mut moments, mut table) = (Vec::new(), "begin_s,end_s,meant\n".to_owned());
        for (number, name) in names.iter().cycle().take(3 * names.len()).enumerate() {
            table += &format!("{number},{number}.5,{name}\n");
            let (sin, cos) = (angle_deg(name) + rotation_deg).to_radians().sin_cos();
            moments.extend((0..400).map(|ms| TracePoint {
                at: StreamInstant::from_us(1_000_000 * number as u64 + 1_000 * ms),
                heard: TraceEvents::Contact(Contact {
                    x_mm: (centre_mm[0] + 12.0 * cos) as f32,
                    y_mm: (centre_mm[1] + 12.0 * sin) as f32,
                    fz_n: 1.0,
                    ..Contact::default()
                }),
            }));
        }
        let labels = Labels::read(&table, &profile).unwrap();
        hand(profile.dpad.as_ref().unwrap(), &Trace::new(moments), &labels, 0.0)
    }

    #[test]
    fn a_hand_is_found_by_two_directions_or_more() {
        for names in [&["right", "up", "left", "down"][..], &["up", "down"], &["right", "up+right", "up"]] {
            let HandPose { centre_mm: [x, y], rotation_deg, radius_mm } =
                found(names, [3.0, -4.0], 20.0).unwrap().turned;
            let misses = [x - 3.0, y + 4.0, rotation_deg - 20.0, radius_mm - 12.0];
            assert!(misses.iter().all(|miss| miss.abs() < 1e-3), "{names:?} {misses:?}");
        }
        let still = found(&["right", "left"], [3.0, 1.0], 0.0).unwrap().shifted;
        assert!((still.centre_mm[0] - 3.0).abs() < 1e-3 && (still.centre_mm[1] - 1.0).abs() < 1e-3);
        assert_eq!(still.rotation_deg, 0.0);
        assert_eq!(found(&["up"], [0.0; 2], 0.0), None);
    }
}
