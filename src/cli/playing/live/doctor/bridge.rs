//! The running bridge, and what a killed one left.

use std::io;

use serde::Deserialize;
use serde_json::Value;

use super::check::Check;
use crate::cli::playing::live::ctl;
use crate::cli::playing::live::runtime::BridgeName;
use tactpad::bridge::sink::x11::LeftDown;
use tactpad::bridge::state::State;

/// What a running bridge says of itself, as far as other checks depend on it.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct RunningBridge {
    state: String,
    pub(super) output: String,
}

impl RunningBridge {
    pub(super) fn of(status: &str) -> Self {
        serde_json::from_str(status).unwrap_or_default()
    }

    /// Whether it plays as soon as a pad comes.
    pub(super) fn waits(&self) -> bool {
        self.state == State::Waiting.word()
    }

    /// Whether what it plays into is something that games read.
    pub(super) fn reaches_games(&self) -> bool {
        !(self.output.starts_with("event log") || self.output == "no output")
    }

    /// The nodes of its devices, as `event7`.
    pub(super) fn nodes(&self) -> Vec<String> {
        let words = self.output.split([' ', ',']);
        words.filter_map(|word| word.strip_prefix("/dev/input/")).map(str::to_owned).collect()
    }
}

pub(super) fn check_bridge(answer: &io::Result<String>, name: Option<&BridgeName>) -> Check {
    match answer {
        Ok(status) => {
            let name = name.map(|name| format!(" --name {name}")).unwrap_or_default();
            Check {
                mend: Some(format!("tactpad ctl status{name}")),
                ..Check::good("bridge", bridge_message(status))
            }
        }
        Err(error) if error.kind() == io::ErrorKind::TimedOut => Check::note(
            "bridge",
            "a bridge is there and does not answer: if it was stopped, continue it with `fg`",
        ),
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            Check::note("bridge", format!("no bridge can be asked: {error}"))
        }
        Err(_) => Check {
            mend: Some("tactpad run".into()),
            ..Check::note("bridge", "no bridge is running; this command starts one")
        },
    }
}

/// What a killed bridge left down. The next start lifts it, too.
pub(super) fn check_left_down(left: &LeftDown) -> Check {
    let name = "X11 keys";
    match left {
        LeftDown::Held { .. } => Check::bad(name, left.to_string(), "tactpad ctl panic"),
        LeftDown::Unanswered { .. } | LeftDown::Damaged { .. } => Check::note(name, left.to_string()),
    }
}

/// The status of a bridge in a sentence.
fn bridge_message(status: &str) -> String {
    let status: Value = serde_json::from_str(status).unwrap_or_default();
    let text = |key: &str| status.get(key).and_then(Value::as_str).unwrap_or("unknown");
    let warning = ctl::warning(&status).map(|warning| format!(" ({warning})")).unwrap_or_default();
    let (profile, decoder) = (text("profile"), text("decoder"));
    format!("a bridge is running with the profile {profile} and the decoder {decoder}{warning}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_bridge_warns_of_is_told() {
        let message = bridge_message(r#"{"warning": {"kind": "silent_channel", "channel": "m1z"}}"#);
        assert!(message.contains("channel m1z does not answer"), "{message}");
        assert!(!bridge_message(r#"{"warning": null}"#).contains('('));
    }
}
