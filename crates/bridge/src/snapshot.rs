//! All that there is to show of a running bridge, as one value: for `ctl status`, for screens, for other programs.

use std::collections::BTreeMap;

use firmware_proto::identity::SerialNumber;
use serde::{Serialize, Serializer};

use crate::changes::PadChanges;
use crate::latency::Percentiles;
use crate::state::State;
use crate::weighing::WeighingStatus;
use tactpad_core::pipeline::contact::uncertainty::Estimate;
use tactpad_core::pipeline::contact::watch::Warning;
use tactpad_core::pipeline::health::Health;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::pipeline::mapping::live::Presses;
use tactpad_core::pipeline::mapping::live::intent::Level;
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::time::HostInstant;

/// A running bridge at one moment.
#[derive(Clone, Debug, Serialize)]
pub struct Snapshot {
    /// Host time of the snapshot.
    #[serde(rename = "at_s", serialize_with = "in_seconds")]
    pub at: HostInstant,
    /// The status at that time.
    #[serde(flatten)]
    pub status: Status,
    /// The newest channels as the decoder got them, in the order of [`tactpad_core::quantity::CHANNEL_NAMES`]; `None` while
    /// there are none that can be trusted.
    pub channels_uv: Option<[f32; CHANNELS]>,
    /// How sure the contact is, if there is one and the decoder knows.
    pub uncertainty: Option<Uncertainty>,
}

/// The status of a bridge; the answer to `ctl status`.
#[derive(Clone, Debug, Serialize)]
pub struct Status {
    /// The state of the bridge.
    pub state: State,
    /// The pad's serial number, if it told.
    #[serde(serialize_with = "as_text")]
    pub pad: Option<SerialNumber>,
    /// The profile's name.
    pub profile: String,
    /// The layer of it that is on.
    pub layer: Option<String>,
    /// Why it is this one, for people.
    pub profile_reason: String,
    /// The error of the profile that would be played otherwise, for people.
    pub profile_error: Option<String>,
    /// Whether it is played for a try, and is not kept.
    pub preview: bool,
    /// Display name of the decoder.
    pub decoder: String,
    /// Where events go.
    pub output: String,
    /// The contact that is being mapped.
    pub contact: Option<Contact>,
    /// The held controls; as text, their names.
    #[serde(serialize_with = "by_name")]
    pub held: Vec<Level>,
    /// A warning about the touches, for the player.
    pub warning: Option<Warning>,
    /// How many presses of buttons counted, and how many did not (Slow Keys, Bounce Keys, dwell).
    pub presses: Presses,
    /// Counts of errors so far.
    pub health: BridgeHealth,
    /// From bytes readable to events written.
    pub latency_us: Percentiles,
    /// The file of the decoder, by its whole path or its name in the program; `None` where nothing was read.
    pub decoder_file: Option<String>,
    /// Gain: the pad's readings over those at its calibration, without a unit. 1 unless a weighing found another one.
    pub gain: f64,
    /// The newest weighing.
    pub weighing: Option<WeighingStatus>,
    /// Changes in the pad that play shows since its decoder was made; `None` before enough was played.
    pub changes: Option<PadChanges>,
    /// What is wrong with the pad's stream as a whole.
    pub line: Option<LineStatus>,
    /// The held controls as people call them: `A: jump`.
    pub held_names: Vec<String>,
    /// What controls do in the game, by the controls as bindings write them.
    #[serde(skip)]
    pub labels: BTreeMap<String, String>,
}

/// What is wrong with the pad's stream as a whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineStatus {
    /// With its numbers.
    #[serde(flatten)]
    pub finding: LineFinding,
    /// In one sentence.
    pub sentence: String,
}

impl LineStatus {
    /// The status of a finding.
    pub fn of(finding: &LineFinding) -> Self {
        Self { finding: *finding, sentence: finding.to_string() }
    }
}

/// Everything that went wrong, on the way from the pad and on the way out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct BridgeHealth {
    /// On the way from the pad.
    #[serde(flatten)]
    pub pipeline: Health,
    /// On the way out.
    #[serde(flatten)]
    pub drops: Drops,
}

/// Counts of groups and calls that were not taken in time. The bridge waits for no log and for no capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Drops {
    /// Groups of events that were not taken in time, by an event log or an X server.
    pub groups_dropped: u64,
    /// Calls that are missing at the end of the capture.
    pub calls_unrecorded: u64,
}

/// Standard deviations of a decoded contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Uncertainty {
    /// Of the place along x.
    pub x_mm: f64,
    /// Of the place along y.
    pub y_mm: f64,
    /// Of the force along x.
    pub fx_n: f64,
    /// Of the force along y.
    pub fy_n: f64,
    /// Of the normal force.
    pub fz_n: f64,
}

impl Uncertainty {
    /// The square roots of the covariance's diagonal.
    pub fn of(estimate: &Estimate) -> Self {
        let covariance = &estimate.covariance;
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = std::array::from_fn(|k| covariance[k][k].sqrt());
        Self { x_mm, y_mm, fx_n, fy_n, fz_n }
    }
}

fn in_seconds<S: Serializer>(at: &HostInstant, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(at.as_ns() as f64 * 1e-9)
}

fn as_text<S: Serializer>(number: &Option<SerialNumber>, to: S) -> Result<S::Ok, S::Error> {
    number.as_ref().map(SerialNumber::as_str).serialize(to)
}

fn by_name<S: Serializer>(held: &[Level], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(held.iter().map(|level| level.code.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::control::{Code, OutputDevice};

    fn snapshot() -> Snapshot {
        let held = Level { device: OutputDevice::Keyboard, code: Code::Key(103), value: 1 };
        let status = Status {
            state: State::Playing,
            pad: SerialNumber::from_ascii("A-1"),
            profile: "Contra".into(),
            layer: None,
            profile_reason: "asked for".into(),
            profile_error: None,
            preview: false,
            decoder: "inverse".into(),
            output: "nowhere".into(),
            contact: Some(Contact { x_mm: 0.1, fz_n: 2.0, ..Contact::default() }),
            held: vec![held],
            warning: None,
            line: None,
            presses: Presses { accepted: 4, rejected: 1 },
            health: BridgeHealth {
                pipeline: Health { samples: 7, ..Health::default() },
                drops: Drops { groups_dropped: 3, ..Drops::default() },
            },
            latency_us: Percentiles { p50: 12.5, ..Percentiles::default() },
            decoder_file: Some("/pads/my.decoder".into()),
            gain: 1.0,
            weighing: None,
            changes: None,
            held_names: vec!["up arrow".into()],
            labels: BTreeMap::new(),
        };
        let uncertainty = Uncertainty { x_mm: 0.25, y_mm: 0.25, fx_n: 0.5, fy_n: 0.5, fz_n: 1.0 };
        let at = HostInstant::from_ns(1_500_000_000);
        Snapshot { at, status, channels_uv: Some([1.5; CHANNELS]), uncertainty: Some(uncertainty) }
    }

    #[test]
    fn the_status_keeps_its_keys_and_their_order() {
        let text = serde_json::to_string(&snapshot().status).unwrap();
        let expected = concat!(
            r#"{"state":"playing","pad":"A-1","profile":"Contra","layer":null,"profile_reason":"asked for","#,
            r#""profile_error":null,"preview":false,"decoder":"inverse","output":"nowhere","#,
            r#""contact":{"x_mm":0.1,"y_mm":0.0,"fx_n":0.0,"fy_n":0.0,"fz_n":2.0},"held":["KEY_UP"],"#,
            r#""warning":null,"presses":{"accepted":4,"rejected":1},"health":{"samples":7,"#
        );
        assert!(text.starts_with(expected), "{text}");
        assert!(text.contains(r#","groups_dropped":3,"calls_unrecorded":0},"latency_us""#), "{text}");
        let end = concat!(
            r#""latency_us":{"p50":12.5,"p95":0.0,"p99":0.0,"max":0.0},"#,
            r#""decoder_file":"/pads/my.decoder","gain":1.0,"weighing":null,"changes":null,"line":null,"held_names":["up arrow"]}"#
        );
        assert!(text.ends_with(end), "{text}");
    }

    #[test]
    fn a_snapshot_is_the_status_and_what_was_measured_in_one_document() {
        let document = serde_json::to_value(snapshot()).unwrap();
        assert_eq!((&document["at_s"], &document["state"]), (&1.5.into(), &"playing".into()));
        assert_eq!(document["channels_uv"].as_array().map(Vec::len), Some(CHANNELS));
        assert_eq!(document["uncertainty"]["fz_n"], 1.0);
    }
}
