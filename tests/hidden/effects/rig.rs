//! What the rig gets wrong: where a contact really was, and what the reference wrote about its force.

use crate::plan::{Contact, Row};
use crate::truth::Truth;

/// The contacts as they were, from those of the plan.
pub(crate) fn true_contacts(truths: &[Truth], rows: &[Row]) -> Vec<Contact> {
    let mut contacts: Vec<Contact> = rows.iter().map(|row| row.contact).collect();
    for truth in truths {
        if truth.effect == "time_lag" {
            contacts = earlier(rows, &contacts, -truth.value("ms") / 1000.0);
        }
        // The stage knows nothing of how the pad lies on it.
        for (contact, row) in contacts.iter_mut().zip(rows) {
            contact.place = turned(place(truth, turned(contact.place, row.turned_deg)), -row.turned_deg);
        }
    }
    contacts
}

fn turned([x, y]: [f64; 2], deg: f64) -> [f64; 2] {
    let (sin, cos) = deg.to_radians().sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

fn place(truth: &Truth, [x, y]: [f64; 2]) -> [f64; 2] {
    match truth.effect.as_str() {
        "stage_offset" => [x + truth.value("x_mm"), y + truth.value("y_mm")],
        "stage_rotation" => turned([x, y], truth.value("deg")),
        "stage_scale" => [x * truth.value("scale"), y * truth.value("scale")],
        _ => [x, y],
    }
}

/// What is written about the contacts: their planned places, and their forces as the reference gives them.
pub(crate) fn labels(truths: &[Truth], rows: &[Row]) -> Vec<Contact> {
    let written = |row: &Row| {
        // Nobody asks the reference about a known weight.
        let asked = truths.iter().filter(|_| row.weight_g.is_none());
        let [fx, fy] = turned([row.contact.force[0], row.contact.force[1]], row.turned_deg);
        let [fx, fy, fz] = asked.fold([fx, fy, row.contact.force[2]], |force, truth| reference(truth, force));
        let [fx, fy] = turned([fx, fy], -row.turned_deg);
        Contact { place: row.contact.place, force: [fx, fy, fz] }
    };
    rows.iter().map(written).collect()
}

fn reference(truth: &Truth, force: [f64; 3]) -> [f64; 3] {
    let value = |name: &str| truth.value_or_zero(name);
    match truth.effect.as_str() {
        "reference_tilt" => {
            // Pressing is along -z.
            let [x, y, z] = [force[0], force[1], -force[2]];
            let (sin, cos) = value("x_deg").to_radians().sin_cos();
            let [y, z] = [cos * y - sin * z, sin * y + cos * z];
            let (sin, cos) = value("y_deg").to_radians().sin_cos();
            [cos * x + sin * z, y, sin * x - cos * z]
        }
        "reference_gain" => force.map(|force| force * value("gain")),
        "reference_zero" => [force[0] + value("fx_n"), force[1] + value("fy_n"), force[2] + value("fz_n")],
        _ => force,
    }
}

/// The contacts of each trial as they were `by_s` before; at a trial's ends they stay.
fn earlier(rows: &[Row], contacts: &[Contact], by_s: f64) -> Vec<Contact> {
    let found = |index: usize| match rows[index].in_trial_s {
        None => contacts[index],
        Some(at) => in_trial(rows, contacts, index, at - by_s),
    };
    (0..rows.len()).map(found).collect()
}

/// A trial's contact at a moment of its own, on a line between its rows.
pub(crate) fn in_trial(rows: &[Row], contacts: &[Contact], index: usize, at: f64) -> Contact {
    let own = |row: &usize| rows[*row].trial == rows[index].trial && rows[*row].in_trial_s.is_some();
    let inside: Vec<usize> = (0..rows.len()).filter(own).collect();
    let time = |row: usize| rows[row].in_trial_s.unwrap_or_default();
    let after = inside.iter().position(|row| time(*row) > at);
    match after {
        Some(0) => contacts[inside[0]],
        None => contacts[inside[inside.len() - 1]],
        Some(next) => {
            let [a, b] = [inside[next - 1], inside[next]];
            let share = (at - time(a)) / (time(b) - time(a));
            between(&contacts[a], &contacts[b], share)
        }
    }
}

fn between(a: &Contact, b: &Contact, share: f64) -> Contact {
    let mixed = |a: f64, b: f64| a + share * (b - a);
    Contact {
        place: [0, 1].map(|axis| mixed(a.place[axis], b.place[axis])),
        force: [0, 1, 2].map(|axis| mixed(a.force[axis], b.force[axis])),
    }
}
