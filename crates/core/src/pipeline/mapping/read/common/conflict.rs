//! Two parts of a profile that drive the same control.
//!
//! On one device a control may have several owners: it is down while any of them wants it down. That is worth
//! a warning, because games then cannot tell the owners apart. An axis that two owners push in opposite
//! directions at the same moment has no answer, so it is an error.

use std::fmt;

use super::binding::Outputs;
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::{
    Binding, ButtonPlace, CONTROLS_MAX, Direction, DpadMode, Keys, When,
};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Placed;

/// The pointer's buttons and its wheel: they are driven beside the keyboard or the gamepad.
const POINTER_CONTROLS_MAX: usize = 4;

/// Owner that drives a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    /// A direction of the D-pad: `up`, `down`, `left` or `right`.
    Direction(&'static str),
    /// A button, counted from 1, and which of its outputs: `out`, `tap`, `double` or `hold`.
    Button { number: usize, role: &'static str },
    /// A macro, counted from 1.
    Macro(usize),
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Direction(name) => write!(f, "direction \"{name}\""),
            Self::Button { number, role } => write!(f, "\"{role}\" of button {number}"),
            Self::Macro(number) => write!(f, "macro {number}"),
        }
    }
}

/// One owner and what it drives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Use {
    pub(crate) owner: Owner,
    pub(crate) outputs: Outputs,
    /// Whether it stays down when its press is over.
    pub(crate) toggles: bool,
    /// Where it counts, if not everywhere.
    pub(crate) place: Option<ButtonPlace>,
    /// And when.
    pub(crate) when: When,
}

/// One control of an owner on a device.
#[derive(Clone, Copy)]
struct Bound {
    by: Use,
    /// All that goes down with it.
    keys: Keys,
    binding: Placed<Binding>,
}

/// Reports every pair of owners that drives the same control of a device; `mode` is that of the directions.
pub(crate) fn check(uses: &[Use], mode: Option<DpadMode>, findings: &mut Findings<'_>) {
    for device in [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer] {
        let bound: Vec<Bound> = uses.iter().flat_map(|by| bound(by, device)).collect();
        check_count(device, &bound, findings);
        for (index, later) in bound.iter().enumerate() {
            if let Some(earlier) = bound.iter().take(index).find(|it| clash(it, later, mode)) {
                judge(earlier, later, findings);
            }
        }
    }
}

fn bound(by: &Use, device: OutputDevice) -> impl Iterator<Item = Bound> + use<> {
    let by = *by;
    by.outputs.on(device).into_iter().flat_map(move |Placed { value: keys, at }| {
        keys.iter().map(move |value| Bound { by, keys, binding: Placed { value, at } })
    })
}

/// Whether both drive one control in a way that is worth a word. Kinds of press of one button may share some of their keys.
fn clash(earlier: &Bound, later: &Bound, mode: Option<DpadMode>) -> bool {
    let (first, second) = (earlier.binding.value, later.binding.value);
    // What a macro presses is its own while it plays; and what counts at different times never meets.
    let of_macro = [earlier, later].iter().any(|it| matches!(it.by.owner, Owner::Macro(_)));
    if of_macro || are_apart_in_time(&earlier.by, &later.by) {
        return false;
    }
    let is_said = if first.value == second.value {
        !same_button(earlier.by.owner, later.by.owner) || earlier.keys == later.keys
    } else {
        // A wheel that is turned both ways stays where it is: nothing is held.
        !matches!(second.code, Code::Relative(_)) && meet(&earlier.by, &later.by, mode)
    };
    first.code == second.code && is_said
}

/// Reports the first control beyond those that a profile can drive.
fn check_count(device: OutputDevice, bound: &[Bound], findings: &mut Findings<'_>) {
    let mut codes = Vec::new();
    for Placed { value, at } in bound.iter().map(|it| it.binding) {
        if codes.contains(&value.code) {
            continue;
        }
        codes.push(value.code);
        if codes.len() == CONTROLS_MAX - POINTER_CONTROLS_MAX + 1 {
            let message =
                format!("a profile drives at most {} controls of the {}", codes.len() - 1, device.name());
            findings.error(at, message, "leave this one out, or bind it to one that is there");
        }
    }
}

fn judge(earlier: &Bound, later: &Bound, findings: &mut Findings<'_>) {
    let (Placed { value: first, .. }, Placed { value: second, at }) = (earlier.binding, later.binding);
    let (code, owners) = (second.code, [earlier.by.owner, later.by.owner]);
    // A default binding stands nowhere in the text, so the finding goes to the later of the two places.
    let at = at.max(earlier.binding.at);
    if first.value != second.value {
        let message = format!("{code} is pushed both ways, by {} and by {}", owners[0], owners[1]);
        findings.error(at, message, "bind one of them to another control");
    } else if same_button(owners[0], owners[1]) {
        let message = format!("two kinds of press of one button both give {code}");
        findings.warning(at, message, "a button that only holds is written with \"out\"");
    } else {
        let message = format!("{code} is driven by {} and by {}", owners[0], owners[1]);
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
fn meet(left: &Use, right: &Use, mode: Option<DpadMode>) -> bool {
    match (left.owner, right.owner) {
        (Owner::Direction(left), Owner::Direction(right)) => {
            let vertical = |name: &str| name == "up" || name == "down";
            mode == Some(DpadMode::EightWay) && vertical(left) != vertical(right)
        }
        (one, other) => {
            let is_apart = same_button(one, other) || are_apart(left.place, right.place);
            !is_apart || left.toggles || right.toggles
        }
    }
}

/// Whether one is on only while the other is not. What stays down when its press is over stays in other layers, too.
fn are_apart_in_time(left: &Use, right: &Use) -> bool {
    let is_tied = |it: &Use| it.when != When::Always && !it.toggles;
    is_tied(left) && is_tied(right) && left.when != right.when
}

/// Whether no contact is at both places: it is in one zone at a time, and holds no two opposite directions.
const fn are_apart(left: Option<ButtonPlace>, right: Option<ButtonPlace>) -> bool {
    use Direction::{Down, Left, Right, Up};
    match (left, right) {
        (Some(ButtonPlace::Zone(one)), Some(ButtonPlace::Zone(other))) => one != other,
        (Some(ButtonPlace::Direction(one)), Some(ButtonPlace::Direction(other))) => {
            matches!((one, other), (Left, Right) | (Right, Left) | (Up, Down) | (Down, Up))
        }
        _ => false,
    }
}
