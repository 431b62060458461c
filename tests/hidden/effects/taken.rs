//! Two causes whose change of the field no table holds: a module that stands askew, and a bond that has come off.
//!
//! Both act through the moments that a post carries, which no channel reads by itself; formulas from the tables alone
//! come no nearer than 20 to 40 % (tilt), or not near at all (bond). So the change is taken from the program's own
//! simulator, from outside, and added to the independent field. What is found of these two says nothing about whether
//! the simulator has them right: `sizes::INDEPENDENT` leaves them out of the gates on sizes.

use crate::plan::Contact;
use crate::program::simulated;
use crate::truth::Truth;

/// Adds the change to what the contacts read.
pub(crate) fn add(truths: &[Truth], contacts: &[Contact], signals: &mut [[f64; 9]]) {
    for truth in truths {
        let Some(text) = imperfections(truth) else { continue };
        let [with, without] =
            [Some(("--imperfections", text.as_str())), None].map(|pad| simulated(contacts, pad));
        for ((signal, with), without) in signals.iter_mut().zip(with).zip(without) {
            (0..9).for_each(|channel| signal[channel] += with[channel] - without[channel]);
        }
    }
}

fn imperfections(truth: &Truth) -> Option<String> {
    let value = |name: &str| truth.value_or_zero(name);
    let keys = match truth.effect.as_str() {
        "module_tilted" => format!(
            "tilt_tangential_deg = {:?}\ntilt_radial_deg = {:?}",
            value("tangential_deg"),
            value("radial_deg")
        ),
        "module_debonded" => format!(
            "debonded_share = {:?}\ndebonded_side = \"{}\"",
            value("area_share"),
            truth.side.as_deref().unwrap_or_default()
        ),
        _ => return None,
    };
    Some(format!("[[module]]\nindex = {}\n{keys}\n", truth.module()))
}
