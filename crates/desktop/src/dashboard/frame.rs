//! The messages to the page on the websocket: JSON, a document a message.

use std::collections::BTreeMap;

use serde::ser::SerializeSeq;
use serde::{Serialize, Serializer};

use super::feed::{Feed, Moment, TracePoint};
use tactpad_bridge::latency::{Durations, Percentiles};
use tactpad_bridge::snapshot::{Status, Uncertainty};
use tactpad_bridge::timing::{ProfileDelays, Stages};
use tactpad_bridge::watchers::PressLine;
use tactpad_core::pipeline::contact::balance::UV_PER_N;
use tactpad_core::pipeline::control::OutputEvent;
use tactpad_core::pipeline::mapping::plain::{controls, named};
use tactpad_core::pipeline::mapping::profile::sketch::Sketch;
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::source::{FULL_N, Measures, Source};

/// Where a reader of the feed goes on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cursor {
    trace: u64,
    events: u64,
    presses: u64,
    profiles: u64,
}

/// The newest moment, and what happened since the last frame.
#[derive(Serialize)]
struct FastFrame {
    kind: &'static str,
    host_us: u64,
    t_us: u64,
    contact: Option<Contact>,
    uncertainty: Option<Uncertainty>,
    channels_uv: Option<[f32; CHANNELS]>,
    held: Vec<String>,
    /// The same for people.
    held_names: Vec<String>,
    is_playing: bool,
    trace: Vec<JsonTracePoint>,
    events: Vec<JsonEvent>,
    presses: Vec<PressLine>,
    /// How many points, events and presses came and went unseen.
    missed: u64,
}

/// A point as `[t_us, x_mm, y_mm, fx_n, fy_n, fz_n]`; a lift as `[t_us]`.
struct JsonTracePoint(TracePoint);

impl Serialize for JsonTracePoint {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let (t, contact) = &self.0;
        let mut list = to.serialize_seq(None)?;
        list.serialize_element(&t.as_us())?;
        if let Some(Contact { x_mm, y_mm, fx_n, fy_n, fz_n }) = contact {
            for number in [x_mm, y_mm, fx_n, fy_n, fz_n] {
                // A thousandth is less than anybody sees.
                list.serialize_element(&((f64::from(*number) * 1e3).round() / 1e3))?;
            }
        }
        list.end()
    }
}

/// An event as the event log has it.
#[derive(Serialize)]
struct JsonEvent {
    t_us: u64,
    device: &'static str,
    code: String,
    value: i32,
    /// What people call the control below its rest, and above it: those of a key are the same.
    names: [String; 2],
}

impl JsonEvent {
    /// Of an event, by what controls do in the game.
    fn of(event: &OutputEvent, labels: &BTreeMap<String, String>) -> Self {
        let OutputEvent { at, device, code, value } = *event;
        let names = [-1, 1].map(|side| named::control(labels, device, code, side));
        Self { t_us: at.as_us(), device: device.name(), code: code.to_string(), value, names }
    }
}

/// The profile that is played, as it is drawn.
#[derive(Serialize)]
struct SketchMessage<'s> {
    kind: &'static str,
    profile: &'s str,
    sketch: Sketch,
}

/// The message about everything that changes slowly.
#[derive(Serialize)]
struct SlowFrame<'s> {
    kind: &'static str,
    status: StatusMessage<'s>,
    stages_us: Latency<Percentiles>,
    histogram_us: Latency<Vec<(f64, u64)>>,
    policy_ms: Option<ProfileDelays>,
}

/// The status, and what people read of it.
#[derive(Serialize)]
pub(super) struct StatusMessage<'s> {
    #[serde(flatten)]
    pub(super) status: &'s Status,
    pub(super) sentence: &'static str,
    pub(super) warning_sentence: Option<String>,
    /// The name or file by which the profile was asked for.
    pub(super) profile_id: String,
    /// What the pad is, if it is no strain pad.
    pub(super) described: Option<DescribedPad>,
}

/// What a described pad is and measures, for people.
#[derive(Serialize)]
pub(super) struct DescribedPad {
    title: String,
    /// Names of its channels; none where it tells the contact itself.
    channels: Vec<String>,
    /// What a channel's µV are on the pad, N; `None` where channels are not forces alone.
    n_per_uv: Option<f64>,
    has_shear: bool,
    scale_sentence: String,
}

impl From<&Source> for DescribedPad {
    fn from(source: &Source) -> Self {
        let n_per_uv = match &source.measures {
            Measures::Cells(_, reach) => Some(reach.full_n / FULL_N / UV_PER_N),
            Measures::Wrench(..) | Measures::Contact(_) => None,
        };
        Self {
            title: source.title.clone(),
            channels: source.channel_names(),
            n_per_uv,
            has_shear: source.has_shear(),
            scale_sentence: source.scale_sentence(),
        }
    }
}

/// A value for each stage, and for the whole way.
#[derive(Serialize)]
struct Latency<T> {
    #[serde(flatten)]
    stages: Stages<T>,
    end_to_end: T,
}

impl Cursor {
    /// Where a reader begins that wants what comes now.
    pub(super) fn now(feed: &Feed) -> Self {
        let newest = feed.newest();
        let (trace, events, presses) = (newest.trace.end(), newest.events.end(), newest.presses.end());
        Self { trace, events, presses, profiles: 0 }
    }

    /// The messages there are by now: the newest moment, and the profile if it is another one.
    pub(super) fn messages(&mut self, feed: &Feed) -> Vec<String> {
        let newest = feed.newest();
        let Some(now) = &newest.now else { return Vec::new() };
        let ((trace, no_points), (events, no_events)) =
            (newest.trace.since(self.trace), newest.events.since(self.events));
        let (presses, no_presses) = newest.presses.since(self.presses);
        let Moment { at, t, contact, uncertainty, channels_uv, held, is_playing, .. } = now.clone();
        let labels = newest.profile.as_ref().map(|profile| named::labels(profile)).unwrap_or_default();
        let frame = FastFrame {
            kind: "frame",
            host_us: at.as_ns() / 1_000,
            t_us: t.as_us(),
            contact,
            uncertainty,
            channels_uv,
            held: held.iter().map(|level| controls::written(level.code, level.value)).collect(),
            held_names: held.iter().map(|it| named::control(&labels, it.device, it.code, it.value)).collect(),
            is_playing,
            trace: trace.copied().map(JsonTracePoint).collect(),
            events: events.map(|event| JsonEvent::of(event, &labels)).collect(),
            presses: newest.profile.as_ref().map_or_else(Vec::new, |profile| {
                presses.map(|verdict| PressLine::of(verdict, profile, 0)).collect()
            }),
            missed: no_points + no_events + no_presses,
        };
        (self.trace, self.events, self.presses) =
            (newest.trace.end(), newest.events.end(), newest.presses.end());
        let drawn = newest.profile.as_ref().filter(|_| newest.profiles != self.profiles);
        let drawn = drawn.map(|profile| SketchMessage {
            kind: "sketch",
            profile: &profile.name,
            sketch: Sketch::of(profile),
        });
        let messages = drawn.iter().map(json).chain([json(&frame)]).collect();
        self.profiles = newest.profiles;
        messages
    }
}

/// The message of what changes slowly.
pub(super) fn status_message(
    status: StatusMessage<'_>,
    stages: &Stages<Durations>,
    end_to_end: &Durations,
    policy_ms: Option<ProfileDelays>,
) -> String {
    json(&SlowFrame {
        kind: "status",
        status,
        stages_us: Latency {
            stages: stages.map(Durations::percentiles),
            end_to_end: end_to_end.percentiles(),
        },
        histogram_us: Latency { stages: stages.map(Durations::bins_us), end_to_end: end_to_end.bins_us() },
        policy_ms,
    })
}

/// As text; what cannot be written is an empty document.
pub(super) fn json(document: &impl Serialize) -> String {
    serde_json::to_string(document).unwrap_or_else(|_| "{}".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::source::{read, shipped};

    #[test]
    fn a_described_pad_says_what_its_numbers_are() {
        let of = |name| DescribedPad::from(&read::read(shipped::text(name).unwrap()).0.unwrap());
        let board = of("balance-board");
        assert_eq!(board.channels, ["upper left", "upper right", "lower left", "lower right"]);
        assert_eq!((board.n_per_uv, board.has_shear), (Some(0.05), false));
        let area = "its area of 433 mm by 238 mm is the plate of 60 mm";
        assert_eq!(board.scale_sentence, format!("1 N here is 50 N on the pad; {area}"));
        let standing = of("balance-board-standing").scale_sentence;
        assert_eq!(standing, format!("2 N here are the weight of who stands on the pad; {area}"));
        let pen = of("tablet");
        assert!(pen.channels.is_empty() && pen.n_per_uv.is_none());
        assert!(
            pen.scale_sentence.starts_with("1 N here is 16 % of the full pressure"),
            "{}",
            pen.scale_sentence
        );
        assert!(of("spacemouse").has_shear);
    }
}
