//! What a profile's parts do in the game, as a person named it.

use crate::pipeline::mapping::profile::words::SIDES;
use crate::pipeline::mapping::profile::{Direction, Labelled, Labels, Role};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Section;

/// The key of a name; with the directions, the table of theirs.
pub(crate) const LABEL: &str = "label";

/// Reads all names. Which keys there are is looked at where their tables are read.
pub(crate) fn read(root: &Section<'_>, findings: &mut Findings<'_>) -> Labels {
    let mut labels = Labels::default();
    for names in root.inner("dpad").iter().flat_map(|dpad| dpad.inner(LABEL)) {
        for direction in Direction::ALL {
            labels.add(Labelled::Direction(direction), names.name(direction.name(), findings));
        }
    }
    for (index, button) in root.inner("button").iter().enumerate() {
        for role in Role::ALL {
            let effects = button.inner(role.name());
            effects.iter().for_each(|it| labels.add(Labelled::Press(index, role), it.name(LABEL, findings)));
        }
    }
    for kind in ["stick", "trigger"] {
        for table in root.inner(kind) {
            let label = table.name(LABEL, findings);
            let side = SIDES.iter().find(|(word, _)| table.word_is(kind, word));
            if let Some((_, side)) = side {
                let part = if kind == "stick" { Labelled::Stick(*side) } else { Labelled::Trigger(*side) };
                labels.add(part, label);
            }
        }
    }
    labels
}
