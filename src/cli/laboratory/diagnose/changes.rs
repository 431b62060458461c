//! The report of changes that play shows: a document, a page of text, and one line.

use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::document::Finding;
use super::text::{cause, sized};
use crate::cli::printing::wrapped::hanging;
use crate::cli::printing::written::quoted;
use tactpad::lab::diagnosis::data::target::Target;
use tactpad::lab::diagnosis::report;
use tactpad::lab::effect::Effect;
use tactpad::lab::play::change::DetectedChanges;
use tactpad::lab::play::windows::WINDOW_S;
use tactpad::quantity::{CHANNEL_NAMES, MODULES};

/// Version of the document's form.
const SCHEMA: u32 = 1;
/// Changes that no press shows.
const UNSEEN: &str = "A gain that all channels share, and a shift or turn of all modules, stay unseen: no press tells them. A known \
                      weight tells the gain (tactpad weigh).";

/// The document.
#[derive(Serialize)]
pub(crate) struct ChangesDocument<'c> {
    schema: u32,
    verdict: &'static str,
    findings: Vec<Finding<'c>>,
    presses: PressNumbers,
    inflation: f64,
    not_detected: Vec<NotDetected>,
    not_testable: [NotTestable; 3],
    /// Play does not tell what is left beside its findings.
    unnamed_share: Option<f64>,
    gatekeepers: [(); 0],
}

/// A module whose gain was not found to have changed, and from which change on it would have been.
#[derive(Serialize)]
struct NotDetected {
    effect: Effect,
    target: String,
    minimum_detectable: MinimumDetectable,
}

#[derive(Serialize)]
struct MinimumDetectable {
    gain: f64,
}

#[derive(Serialize)]
struct NotTestable {
    effect: Effect,
    target: &'static str,
    needs: &'static str,
}

/// Changes that no press shows.
const NOT_TESTABLE: [NotTestable; 3] = [
    NotTestable { effect: Effect::ExcitationGain, target: "pad", needs: "a known weight: tactpad weigh" },
    NotTestable {
        effect: Effect::ModuleDisplaced,
        target: "all",
        needs: "a weight on marked places: tactpad calibrate",
    },
    NotTestable {
        effect: Effect::ModuleRotated,
        target: "all",
        needs: "a weight on marked places: tactpad calibrate",
    },
];

/// Of a decoder there is no earlier number.
#[derive(Serialize)]
struct PressNumbers {
    earlier: Option<usize>,
    later: usize,
}

/// The reference with which play is compared.
#[derive(Clone, Copy)]
pub(crate) enum Reference<'p> {
    /// An earlier play.
    Played,
    /// This decoder's calibration.
    Calibrated(&'p Path),
}

/// The result of a comparison, with its reference and its play.
pub(crate) struct Comparison<'p> {
    pub(crate) found: &'p DetectedChanges,
    pub(crate) since: Reference<'p>,
    pub(crate) play: &'p Path,
}

impl<'c> ChangesDocument<'c> {
    pub(crate) fn of(found: &'c DetectedChanges) -> Self {
        let (earlier, later) = found.presses;
        Self {
            schema: SCHEMA,
            verdict: if found.findings.is_empty() { "no_discrepancy" } else { "explained" },
            findings: findings(found),
            presses: PressNumbers { earlier, later },
            inflation: found.inflation,
            not_detected: not_detected(found),
            not_testable: NOT_TESTABLE,
            unnamed_share: None,
            gatekeepers: [],
        }
    }
}

/// The gains of modules that no finding is of.
fn not_detected(found: &DetectedChanges) -> Vec<NotDetected> {
    let is_found = |target: &Target| found.findings.iter().any(|it| it.target == *target);
    let modules = (0..MODULES).map(Target::Module).filter(|target| !is_found(target));
    let gain = found.least_module_gain;
    let one = |target: Target| NotDetected {
        effect: Effect::ModuleGain,
        target: target.name(&names()),
        minimum_detectable: MinimumDetectable { gain },
    };
    modules.map(one).collect()
}

/// The findings as documents have them.
pub(crate) fn findings(found: &DetectedChanges) -> Vec<Finding<'_>> {
    found.findings.iter().map(|it| Finding::of(it, &names())).collect()
}

fn names() -> Vec<String> {
    CHANNEL_NAMES.map(str::to_owned).to_vec()
}

/// A change as people say it: `module 1 has lost 8.1 %`. Of what is no gain its cause with its numbers.
fn said(finding: &report::Finding) -> String {
    let whose = match finding.target {
        Target::Module(module) => format!("module {module}"),
        target => target.name(&names()),
    };
    let gain = finding.parameters.iter().find(|it| it.name == "gain");
    match gain {
        Some(gain) if gain.value < 1.0 => format!("{whose} has lost {:.1} %", 100.0 * (1.0 - gain.value)),
        Some(gain) => format!("{whose} has gained {:.1} %", 100.0 * (gain.value - 1.0)),
        None => sized(finding, &names()),
    }
}

/// All changes on one line; where none was found, what would have been.
pub(crate) fn line(found: &DetectedChanges) -> String {
    let all: Vec<String> = found.findings.iter().map(said).collect();
    if all.is_empty() {
        return format!(
            "none found (a module's loss of {:.1} % would have been)",
            100.0 * found.least_module_gain
        );
    }
    all.join(", ")
}

/// A change with its numbers, and what play does not tell it from.
fn told(finding: &report::Finding) -> String {
    let (said, sized) = (said(finding), sized(finding, &names()));
    let first = if said == sized { sized } else { format!("{said}: {sized}") };
    let text = format!("{first}; p {:.0e}", finding.p_value);
    let others = finding.confounded_with.iter().map(|(effect, target)| cause(*effect, target, &names()));
    let others: Vec<String> = others.collect();
    if others.is_empty() {
        text + "."
    } else {
        format!("{text}. Play does not tell it from {}.", others.join(", or from "))
    }
}

/// How long a finger pressed in so many windows.
fn pressed(windows: usize) -> String {
    format!("{:.0} s of presses", windows as f64 * WINDOW_S)
}

/// The report for people.
pub(crate) struct ChangesText<'c>(pub(crate) &'c Comparison<'c>);

impl fmt::Display for ChangesText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(Comparison { found, since, play }) = self;
        let (earlier, later) = found.presses;
        let (held, when) = match (since, earlier) {
            (Reference::Calibrated(decoder), _) => {
                (format!("{} against {}", pressed(later), decoder.display()), " since it was calibrated")
            }
            (Reference::Played, earlier) => {
                (format!("{} against {} before", pressed(later), pressed(earlier.unwrap_or_default())), "")
            }
        };
        let least = 100.0 * found.least_module_gain;
        let first = match found.findings.as_slice() {
            [] => format!(
                "No change{when} ({held}). A module whose gain had changed by {least:.1} % would have been found in nine of ten such plays."
            ),
            _ => format!("The pad has changed{when} ({held}):"),
        };
        writeln!(f, "{}", hanging("", &first))?;
        for (number, finding) in (1..).zip(&found.findings) {
            writeln!(f, "\n{}", hanging(&format!("{number:>3}  "), &told(finding)))?;
        }
        writeln!(f, "\n{}", hanging("", UNSEEN))?;
        match since {
            Reference::Calibrated(decoder) if !found.findings.is_empty() => {
                write_adapt_command(f, play, decoder)
            }
            _ => Ok(()),
        }
    }
}

/// The command that makes a decoder of the pad as it is now by this play. That decoder has lost the old scale of forces, also with
/// `--from`: its forces need a weight.
fn write_adapt_command(f: &mut fmt::Formatter<'_>, play: &Path, decoder: &Path) -> fmt::Result {
    let [play, from] = [play, decoder].map(|path| quoted(&path.display().to_string()));
    writeln!(f, "\nA decoder of the pad as it is now, by this play, beside the old one:")?;
    writeln!(f, "\n  tactpad adapt --play {play} --from {from} --out new.decoder")?;
    let then = "Its forces have no scale: play alone cannot tell it, also with --from. It needs one known weight: run it, then \
                tactpad ctl weigh.";
    writeln!(f, "\n{}", hanging("", then))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad::lab::diagnosis::report::Estimate;

    fn finding(effect: Effect, target: Target, name: &'static str, value: f64) -> report::Finding {
        let interval95 = [value - 0.01, value + 0.01];
        report::Finding {
            effect,
            target,
            parameters: vec![Estimate { name, value, interval95 }],
            shapes: Vec::new(),
            p_value: 1e-9,
            share: 1.0,
            confounded_with: Vec::new(),
            separate_by: None,
            labels: None,
        }
    }

    fn changed(findings: Vec<report::Finding>) -> DetectedChanges {
        DetectedChanges { findings, presses: (None, 600), inflation: 1.0, least_module_gain: 0.021 }
    }

    #[test]
    fn a_loss_is_said_as_people_say_it() {
        let found = changed(vec![
            finding(Effect::ModuleGain, Target::Module(1), "gain", 0.919),
            finding(Effect::ChannelGain, Target::Channel(2), "gain", 1.052),
            finding(Effect::ModuleRotated, Target::Module(0), "deg", 1.5),
        ]);
        let said = "module 1 has lost 8.1 %, m0z has gained 5.2 %, module_rotated of module0: 1.500° (1.490 to 1.510)";
        assert_eq!(line(&found), said);
        assert_eq!(line(&changed(Vec::new())), "none found (a module's loss of 2.1 % would have been)");
    }

    #[test]
    fn a_new_decoder_is_offered_where_a_decoder_is_old() {
        let found = changed(vec![finding(Effect::ModuleGain, Target::Module(1), "gain", 0.919)]);
        let text = |since| {
            ChangesText(&Comparison { found: &found, since, play: Path::new("my play.cap") }).to_string()
        };
        let offered = text(Reference::Calibrated(Path::new("my.decoder")));
        let command = "tactpad adapt --play 'my play.cap' --from my.decoder --out new.decoder";
        assert!(offered.contains(command) && offered.contains("since it was calibrated"), "{offered}");
        assert!(!text(Reference::Played).contains("adapt"));
    }
}
