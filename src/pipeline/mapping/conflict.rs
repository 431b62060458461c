//! Two parts of a profile that drive the same control.
//!
//! On one device a control may have several owners: it is down while any of them wants it down. That is worth
//! a warning, because games then cannot tell the owners apart. An axis that two owners push in opposite
//! directions at the same moment has no answer, so it is an error.

use std::fmt;

use super::binding::Outputs;
use super::profile::{Binding, DpadMode};
use crate::pipeline::control::OutputDevice;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Placed;

/// What drives a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    /// A direction of the D-pad: `up`, `down`, `left` or `right`.
    Direction(&'static str),
    /// A button, counted from 1, and which of its outputs: `out`, `tap` or `hold`.
    Button { number: usize, role: &'static str },
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Direction(name) => write!(f, "direction \"{name}\""),
            Self::Button { number, role } => write!(f, "\"{role}\" of button {number}"),
        }
    }
}

/// One owner and what it drives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Use {
    pub(super) owner: Owner,
    pub(super) outputs: Outputs,
}

/// Reports every pair of owners that drives the same control of a device; `mode` is that of the directions.
pub(super) fn check(uses: &[Use], mode: Option<DpadMode>, findings: &mut Findings<'_>) {
    for device in [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer] {
        let on_device = |uses: &Use| uses.outputs.on(device).map(|binding| (uses.owner, binding));
        let bound: Vec<_> = uses.iter().filter_map(on_device).collect();
        for (index, later) in bound.iter().enumerate() {
            let clash = bound.iter().take(index).find(|earlier| {
                earlier.1.value.code == later.1.value.code
                    && (earlier.1.value.value == later.1.value.value || meet(earlier.0, later.0, mode))
            });
            if let Some(earlier) = clash {
                judge(*earlier, *later, findings);
            }
        }
    }
}

fn judge(earlier: (Owner, Placed<Binding>), later: (Owner, Placed<Binding>), findings: &mut Findings<'_>) {
    let (Placed { value: first, .. }, Placed { value: second, at }) = (earlier.1, later.1);
    let code = second.code;
    // A default binding stands nowhere in the text, so the finding goes to the later of the two places.
    let at = at.max(earlier.1.at);
    if first.value != second.value {
        let message = format!("{code} is pushed both ways, by {} and by {}", earlier.0, later.0);
        findings.error(at, message, "bind one of them to another control");
    } else if same_button(earlier.0, later.0) {
        let message = format!("a short and a long press both give {code}");
        findings.warning(at, message, "a button that only holds is written with \"out\"");
    } else {
        let message = format!("{code} is driven by {} and by {}", earlier.0, later.0);
        findings.warning(
            at,
            message,
            "it stays down until neither wants it; bind one of them to another control",
        );
    }
}

const fn same_button(left: Owner, right: Owner) -> bool {
    matches!((left, right), (Owner::Button { number: l, .. }, Owner::Button { number: r, .. }) if l == r)
}

/// Whether both owners can be active at the same moment.
fn meet(left: Owner, right: Owner, mode: Option<DpadMode>) -> bool {
    match (left, right) {
        (Owner::Direction(left), Owner::Direction(right)) => {
            let vertical = |name: &str| name == "up" || name == "down";
            mode == Some(DpadMode::EightWay) && vertical(left) != vertical(right)
        }
        _ => !same_button(left, right),
    }
}
