//! A pipeline that is told anything, and is checked after every call.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad::pad::field::PadField;
use tactpad::pad::influence::InfluenceField;
use tactpad::pad::weight::Weight;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::pipeline::{NoProbe, Phase, Pipeline};
use tactpad::quantity::Contact;
use tactpad::time::{HostInstant, StreamInstant};

use crate::body::framed;
use crate::step::{Finger, Oddity, Step, Waking};

static FIELD: LazyLock<InfluenceField> = LazyLock::new(|| PadField::nominal().signals);

/// Counts per microvolt of a pad that does not identify itself.
const COUNTS_PER_UV: f32 = 100.0;

/// More calls than this at one time of the host are no progress: each call answers one of the 20 controls at least.
/// The farthest that the pointer goes in one step.
const STEP_MAX: i32 = 127;

const CALLS_MAX: usize = 50;

/// A pipeline under test, its pad and its host.
pub struct Rig {
    pub pipeline: Pipeline,
    pub now: HostInstant,
    sequence: u32,
    time_us: u64,
    held: BTreeMap<(OutputDevice, Code), i32>,
    newest: StreamInstant,
}

/// The shipped profile `number`, counted round and round.
fn profile_text(number: u8) -> &'static str {
    let names: Vec<_> = shipped::names().collect();
    shipped::text(names[usize::from(number) % names.len()]).unwrap()
}

/// The first shipped profile.
pub fn first_profile() -> Profile {
    check::read(profile_text(0), OutputChoice::AsWritten).0.unwrap()
}

impl Default for Rig {
    fn default() -> Self {
        Self::new(first_profile())
    }
}

impl Rig {
    /// A rig whose pad has just been plugged in.
    pub fn new(profile: Profile) -> Self {
        let pipeline = Pipeline::new(tactpad::pipeline::shipped::decoder(), profile);
        let now = HostInstant::from_ns(1_000_000_000);
        Self {
            pipeline,
            now,
            sequence: 0,
            time_us: 0,
            held: BTreeMap::new(),
            newest: StreamInstant::default(),
        }
    }

    /// Lets `step` happen.
    pub fn play(&mut self, step: &Step) {
        match step {
            Step::Hold { finger, samples } => (0..*samples).for_each(|_| self.sample(finger, 1_000)),
            Step::Rest => {
                (0..20).for_each(|_| self.sample(&Finger { x: 0, y: 0, fx: 0, fy: 0, fz: 0 }, 25_000))
            }
            Step::Odd { finger, oddity } => self.odd(finger, *oddity),
            Step::Bytes(bytes) => self.call(Call::Bytes(bytes)),
            Step::Body(body) => self.call(Call::Bytes(&framed(body))),
            Step::Identity { channels, count_bits, picovolts_per_count } => {
                self.send(&Message::Identity(Identity {
                    serial_number: SerialNumber::from_ascii("FUZZ").unwrap(),
                    channels: *channels,
                    count_bits: *count_bits,
                    rate_hz: 1_000,
                    picovolts_per_count: *picovolts_per_count,
                }));
            }
            Step::Silence { us, waking } => self.silence(u64::from(*us), *waking),
            Step::Timeout => self.call(Call::Timeout),
            Step::Unplugged => self.call(Call::Unplugged),
            Step::Pause => self.call(Call::Pause),
            Step::Resume => self.call(Call::Resume),
            Step::ReleaseAll => self.call(Call::ReleaseAll),
            Step::Retare => self.call(Call::Retare),
            Step::Weigh(g) => self.call(Call::Weigh(Weight::of_g(30.0 + f64::from(*g)).unwrap())),
            Step::Profile { number, keyboard } => {
                let output = if *keyboard { OutputChoice::Keyboard } else { OutputChoice::AsWritten };
                let read = ReadProfile::read(profile_text(*number), output).0.unwrap();
                self.call(Call::Profile(&read));
            }
        }
    }

    /// A finger goes over the plate and pushes every way; then it lifts, and the pad is left alone.
    pub fn sweep(&mut self) {
        self.play(&Step::Rest);
        for place in 0..16_i8 {
            let (x, y) = ((place % 4) * 24 - 36, (place / 4) * 24 - 36);
            let finger = Finger { x, y, fx: 3 * x, fy: -3 * y, fz: 90 };
            (0..4).for_each(|_| self.sample(&finger, 20_000));
        }
        self.end();
    }

    /// After 80 ms without a sample nothing may be held, whatever was before.
    pub fn end(&mut self) {
        self.now = self.now.plus_us(200_000);
        self.call(Call::Timeout);
        assert!(self.held.is_empty(), "held after silence: {:?}", self.held);
        assert!(self.pipeline.held().next().is_none(), "a rate after silence");
    }

    /// Makes one call and checks what comes of it.
    pub fn call(&mut self, call: Call<'_>) {
        let Self { pipeline, now, held, newest, .. } = self;
        let mut left = Some(call);
        while let Some(call) = left {
            left = pipeline.apply(*now, call, &mut NoProbe);
            check_group(pipeline.events(), held, newest);
        }
        self.check();
    }

    fn check(&self) {
        // A rate is stated but has no edges.
        let stated = self.pipeline.held().filter(|level| !matches!(level.code, Code::Relative(_)));
        let held = stated.map(|level| ((level.device, level.code), level.value)).collect();
        assert_eq!(self.held, held, "what the events say is not what the pipeline says");
        let is_still = matches!(self.pipeline.phase(), Phase::Paused | Phase::Weighing);
        if is_still || self.pipeline.refusal().is_some() {
            assert!(
                self.pipeline.held().next().is_none(),
                "held in a pause, under a weight, or with a pad that is refused"
            );
        }
    }

    fn silence(&mut self, us: u64, waking: Waking) {
        let end = self.now.plus_us(us % 1_000_000);
        while let Some(due) =
            self.pipeline.poll_timeout().filter(|due| waking == Waking::OnTime && *due <= end)
        {
            self.now = due.max(self.now);
            self.answer_deadlines();
        }
        self.now = end;
        self.answer_deadlines();
    }

    /// Calls until nothing is due; a host that could call for ever would burn.
    fn answer_deadlines(&mut self) {
        for _ in 0..CALLS_MAX {
            if self.pipeline.poll_timeout().is_none_or(|due| due > self.now) {
                return;
            }
            self.call(Call::Timeout);
        }
        panic!("always due: {:?} at {:?}", self.pipeline.poll_timeout(), self.now);
    }

    fn next_sample(&mut self, finger: &Finger, period_us: u64) -> Sample {
        self.now = self.now.plus_us(period_us);
        self.sequence = self.sequence.wrapping_add(1);
        self.time_us = self.time_us.wrapping_add(period_us);
        let strain = FIELD.strain_uv(&contact(finger));
        // A channel that never changes counts as stuck: the last bit moves.
        let counts = strain.uv.map(|uv| (uv * COUNTS_PER_UV) as i32 + (self.sequence & 1) as i32);
        let Self { sequence, time_us, .. } = *self;
        Sample { sequence, time_us, counts, temperature_centi_c: 2_300, status: Status::OK }
    }

    fn sample(&mut self, finger: &Finger, period_us: u64) {
        let sample = self.next_sample(finger, period_us);
        self.send(&Message::Sample(sample));
    }

    fn odd(&mut self, finger: &Finger, oddity: Oddity) {
        let mut sample = self.next_sample(finger, 1_000);
        match oddity {
            Oddity::Counts(counts) => sample.counts = counts,
            Oddity::Status(status) => sample.status = Status(status),
            Oddity::Sequence(sequence) => (self.sequence, sample.sequence) = (sequence, sequence),
            Oddity::TimeUs(time_us) => (self.time_us, sample.time_us) = (time_us, time_us),
            Oddity::Repeated => self.send(&Message::Sample(sample)),
            Oddity::Damaged { place, bit } => {
                let mut frame = encoded(&Message::Sample(sample));
                let place = usize::from(place) % frame.len();
                frame[place] ^= 1 << (bit % 8);
                return self.call(Call::Bytes(&frame));
            }
        }
        self.send(&Message::Sample(sample));
    }

    fn send(&mut self, message: &Message) {
        self.call(Call::Bytes(&encoded(message)));
    }
}

fn encoded(message: &Message) -> Vec<u8> {
    let mut frame = [0; ENCODED_MAX];
    let length = encode_message(message, &mut frame);
    frame[..length].to_vec()
}

fn contact(finger: &Finger) -> Contact {
    let Finger { x, y, fx, fy, fz } = *finger;
    let [x_mm, y_mm] = [x, y].map(|half_mm| f32::from(half_mm) * 0.5);
    let [fx_n, fy_n] = [fx, fy].map(|twentieth_n| f32::from(twentieth_n) * 0.05);
    Contact { x_mm, y_mm, fx_n, fy_n, fz_n: f32::from(fz) * 0.05 }
}

/// A group is simultaneous: each control stands in it once, and always with a new value. Time does not run back.
fn check_group(
    events: &[OutputEvent],
    held: &mut BTreeMap<(OutputDevice, Code), i32>,
    newest: &mut StreamInstant,
) {
    for (index, event) in events.iter().enumerate() {
        let control = (event.device, event.code);
        assert!(
            !events[..index].iter().any(|other| (other.device, other.code) == control),
            "twice in {events:?}"
        );
        assert!(event.at >= *newest, "{event:?} is earlier than {newest:?}");
        *newest = event.at;
        if matches!(event.code, Code::Relative(_)) {
            assert!(event.value != 0 && event.value.abs() <= STEP_MAX, "{event:?}");
            continue;
        }
        let before = if event.value == 0 { held.remove(&control) } else { held.insert(control, event.value) };
        assert_ne!(before.unwrap_or(0), event.value, "{event:?} is no change");
    }
}
