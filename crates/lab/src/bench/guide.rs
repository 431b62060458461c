//! First measurements of a new pad, step by step: what to do next, and what came of it. It is fed with a pad's calls and reads no clock.

use firmware_proto::identity::Identity;

use super::deed::Deed;
use super::order::{DeedReading, Order, OrderSearch};
use super::rest::{InputFault, InputRest, NOISE_MAX_UV, rest};
use super::samples::{BenchSample, SampleReader, StreamEvent};
use super::touch::{Touch, TouchFinder};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::weight::weight_n;
use tactpad_core::pipeline::call::Call;
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::time::HostInstant;
use tactpad_numeric::statistics::rms;

/// The pad is left alone for so long.
pub const REST_S: f64 = 5.0;
/// While that is measured, so many inputs with more noise than this are a hand, not the inputs' own.
const MOVED_INPUTS: usize = 3;
const MOVED_UV: f64 = 60.0;
/// So often it is asked once more to leave the pad alone.
const RESTS_MAX: usize = 3;
/// A press reads so much at least in some input.
const PRESS_UV: f64 = 60.0;
/// A weight is felt from this part of what it should read in the input that it moves most.
const WEIGHT_PART: f64 = 0.4;
/// Deeds are asked for so often where they do not decide.
const ROUNDS_MAX: usize = 2;
/// An input whose largest part of a deed is smaller does not answer: with five deeds every channel has more.
const SILENT_SHARE: f64 = 0.04;

/// Step to do now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BenchStep {
    /// Leave the pad alone.
    Rest {
        /// It was left alone for so long.
        rested_s: f64,
        /// Whether something moved it before.
        is_again: bool,
    },
    /// Put the weight on the middle, and take it away.
    Weigh {
        /// What is seen of it.
        touch: Touch,
    },
    /// Press or push.
    Do {
        /// What.
        deed: Deed,
        /// What is seen of it.
        touch: Touch,
        /// Whether it was done before and did not decide.
        is_again: bool,
    },
    /// Nothing is left to do.
    Done,
}

/// What stands in the way of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenchTrouble {
    /// The pad says that its excitation or its reference is wrong.
    Supply,
    /// The pad has another number of channels.
    OtherChannels,
}

/// What was measured.
#[derive(Clone, Debug)]
pub struct BenchResult {
    /// Who the pad is, if it told.
    pub identity: Option<Identity>,
    /// Samples per second, by the pad's clock.
    pub rate_hz: f64,
    /// Frames that were missing.
    pub frames_lost: u64,
    /// Frames that were damaged.
    pub frames_damaged: u64,
    /// Each input at rest, with its fault.
    pub rest: [InputRest; CHANNELS],
    /// What the weight made each input read, µV, if there was one and it was felt.
    pub weight_uv: Option<[f64; CHANNELS]>,
    /// Whether the weight was too light for this noise.
    pub is_weight_unfelt: bool,
    /// What was done.
    pub readings: Vec<DeedReading>,
    /// The wiring by that; `None` where too few inputs tell anything.
    pub order: Option<Order>,
}

/// Leads through the measurements of a pad.
pub struct BenchGuide<'p> {
    search: OrderSearch<'p>,
    field: &'p PadField,
    weight_g: Option<f64>,
    reader: SampleReader,
    trouble: Option<BenchTrouble>,
    step: BenchStep,
    rested: Vec<BenchSample>,
    rests: usize,
    finder: Option<TouchFinder>,
    rest: Option<[InputRest; CHANNELS]>,
    rate_hz: f64,
    weight_uv: Option<[f64; CHANNELS]>,
    is_weight_unfelt: bool,
    readings: Vec<DeedReading>,
    order: Option<Order>,
}

impl<'p> BenchGuide<'p> {
    /// For a pad that should be like this one, and a weight of so many grams, if one is at hand.
    pub fn new(device: &'p Device, field: &'p PadField, weight_g: Option<f64>) -> Self {
        Self {
            search: OrderSearch::new(device, field),
            field,
            weight_g,
            reader: SampleReader::default(),
            trouble: None,
            step: BenchStep::Rest { rested_s: 0.0, is_again: false },
            rested: Vec::new(),
            rests: 0,
            finder: None,
            rest: None,
            rate_hz: 0.0,
            weight_uv: None,
            is_weight_unfelt: false,
            readings: Vec::new(),
            order: None,
        }
    }

    /// Step to do now.
    pub const fn step(&self) -> &BenchStep {
        &self.step
    }

    /// The weight, in grams.
    pub const fn weight_g(&self) -> Option<f64> {
        self.weight_g
    }

    /// What stands in the way now.
    pub const fn trouble(&self) -> Option<BenchTrouble> {
        self.trouble
    }

    /// Makes a call, and looks what is to be done after it.
    pub fn apply(&mut self, now: HostInstant, call: Call<'_>) {
        let mut events = Vec::new();
        self.reader.apply(now, call, |event| events.push(event));
        for event in events {
            match event {
                StreamEvent::Sample(sample) => {
                    self.trouble = None;
                    self.take(&sample);
                }
                StreamEvent::Anew => self.begin_again(),
                StreamEvent::SupplyFault => self.trouble = Some(BenchTrouble::Supply),
                StreamEvent::OtherChannels => self.trouble = Some(BenchTrouble::OtherChannels),
            }
        }
    }

    /// What was measured; `None` before the pad has rested.
    pub fn result(self) -> Option<BenchResult> {
        let mut rest = self.rest?;
        for (input, told) in self.told(&self.readings).into_iter().enumerate() {
            if !told {
                rest[input].fault.get_or_insert(InputFault::Silent);
            }
        }
        Some(BenchResult {
            identity: self.reader.identity().copied(),
            rate_hz: self.rate_hz,
            frames_lost: self.reader.frames_lost(),
            frames_damaged: self.reader.frames_damaged(),
            rest,
            weight_uv: self.weight_uv,
            is_weight_unfelt: self.is_weight_unfelt,
            readings: self.readings,
            order: self.order,
        })
    }

    /// The zeros are other ones: what was done so far stays, what goes on begins anew.
    fn begin_again(&mut self) {
        match self.step {
            BenchStep::Done => {}
            BenchStep::Rest { .. } => self.rested.clear(),
            _ => self.finder = self.finder.take().map(TouchFinder::anew),
        }
    }

    fn take(&mut self, sample: &BenchSample) {
        match self.step {
            BenchStep::Rest { .. } => self.take_rest(sample),
            BenchStep::Weigh { .. } | BenchStep::Do { .. } => {
                let seen = self.finder.as_mut().and_then(|finder| finder.push(sample));
                if let Some(touch) = seen {
                    self.touched(touch);
                }
            }
            BenchStep::Done => {}
        }
    }

    fn take_rest(&mut self, sample: &BenchSample) {
        self.rested.push(*sample);
        let rested_s = self.rested.first().map_or(0.0, |first| sample.t_s - first.t_s);
        let is_again = self.rests > 0;
        self.step = BenchStep::Rest { rested_s, is_again };
        if rested_s < REST_S {
            return;
        }
        let samples = std::mem::take(&mut self.rested);
        let Some(rest) = rest(&samples) else { return };
        self.rests += 1;
        let is_moved = |it: &&InputRest| it.fault != Some(InputFault::OutOfRange) && it.noise_uv > MOVED_UV;
        if rest.iter().filter(is_moved).count() >= MOVED_INPUTS && self.rests < RESTS_MAX {
            self.step = BenchStep::Rest { rested_s: 0.0, is_again: true };
            return;
        }
        self.rate_hz = (samples.len() - 1) as f64 / rested_s;
        self.rest = Some(rest);
        self.begin_weighing();
    }

    fn begin_weighing(&mut self) {
        let Some(weight_g) = self.weight_g else { return self.begin_deeds(false) };
        let middle = Contact { fz_n: weight_n(weight_g) as f32, ..Contact::default() };
        let uv = self.field.signals.strain_uv(&middle).uv.map(|uv| f64::from(uv).abs());
        let least_uv = WEIGHT_PART * uv.into_iter().fold(0.0, f64::max);
        self.finder = self.new_finder(least_uv);
        if self.finder.as_ref().is_some_and(|finder| finder.feels(least_uv)) {
            self.step = BenchStep::Weigh { touch: Touch::None };
        } else {
            self.is_weight_unfelt = true;
            self.begin_deeds(false);
        }
    }

    fn new_finder(&self, least_uv: f64) -> Option<TouchFinder> {
        let rest = self.rest?;
        let noise_uv = rest.map(|it| it.noise_uv.min(NOISE_MAX_UV));
        Some(TouchFinder::new(noise_uv, self.rate_hz, rest.map(|it| it.fault.is_none()), least_uv))
    }

    fn begin_deeds(&mut self, is_again: bool) {
        self.finder = self.new_finder(PRESS_UV);
        self.step = BenchStep::Do { deed: Deed::ALL[0], touch: Touch::None, is_again };
    }

    fn touched(&mut self, touch: Touch) {
        match (self.step, touch) {
            (BenchStep::Weigh { .. }, Touch::Ended { uv }) => {
                self.weight_uv = Some(uv);
                self.begin_deeds(false);
            }
            (BenchStep::Weigh { touch: before }, touch) => {
                self.step = BenchStep::Weigh { touch: told(before, touch) };
            }
            (BenchStep::Do { deed, is_again, .. }, Touch::Ended { uv }) => {
                self.readings.push(DeedReading { deed, uv });
                self.next_deed(deed, is_again);
            }
            (BenchStep::Do { deed, touch: before, is_again }, touch) => {
                self.step = BenchStep::Do { deed, touch: told(before, touch), is_again };
            }
            _ => {}
        }
    }

    fn next_deed(&mut self, done: Deed, is_again: bool) {
        let next = Deed::ALL.iter().skip_while(|deed| **deed != done).nth(1);
        if let Some(deed) = next {
            self.step = BenchStep::Do { deed: *deed, touch: Touch::None, is_again };
            return;
        }
        let told = self.told(&self.readings);
        self.order = self.search.wiring(&self.readings, &told);
        let is_decided = self.order.as_ref().is_none_or(|order| order.is_decided(&told));
        if is_decided || self.readings.len() >= ROUNDS_MAX * Deed::ALL.len() {
            self.step = BenchStep::Done;
        } else {
            self.begin_deeds(true);
        }
    }

    /// Inputs that tell something of these deeds.
    fn told(&self, readings: &[DeedReading]) -> [bool; CHANNELS] {
        let is_sound = |input: usize| self.rest.is_none_or(|rest| rest[input].fault.is_none());
        let sound: Vec<usize> = (0..CHANNELS).filter(|input| is_sound(*input)).collect();
        let share = |reading: &DeedReading, input: usize| {
            reading.uv[input].abs() / rms(sound.iter().map(|input| reading.uv[*input])).max(f64::MIN_POSITIVE)
        };
        let answers = |input: usize| {
            readings.is_empty() || readings.iter().any(|reading| share(reading, input) >= SILENT_SHARE)
        };
        std::array::from_fn(|input| is_sound(input) && answers(input))
    }
}

/// That something was too short stays told until the next touch.
fn told(before: Touch, now: Touch) -> Touch {
    if now == Touch::None && before == Touch::TooShort { before } else { now }
}
