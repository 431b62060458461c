//! The contact stage: from a sample to the contact that it shows, and what is left of it all when something interrupts.

use firmware_proto::channels::ChannelSample;
use firmware_proto::contact::ContactSample;
use firmware_proto::identity::Identity;
use firmware_proto::sample::Sample;

use super::standing::Standing;
use super::told;
use super::touch::{Touch, TouchState};
use super::uncertainty::Estimate;
use super::watch::{Doubt, Warning, Watch, load_without_stray_n};
use super::{Decoder, Method};
use crate::pipeline::compensation::gain::CommonGain;
use crate::pipeline::compensation::memory::Memory;
use crate::pipeline::compensation::thermometer::Thermometer;
use crate::pipeline::health::Health;
use crate::pipeline::interruption::{Cause, Effect, Effects};
use crate::pipeline::link::reading::{Measured, Reading};
use crate::pipeline::probe::{PipelineStage, Probe};
use crate::pipeline::signal::filter::MeanFilter;
use crate::pipeline::signal::{Conditioned, Loads, PadState, Scale, Signal};
use crate::quantity::{CHANNELS, Contact, Strain};
use crate::time::StreamInstant;

/// Result of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DecodedSample {
    /// The contact; `None` if nothing touches the pad.
    Contact(Option<Contact>),
    /// Nothing can be said yet: the zero is being measured.
    Taring,
    /// Nothing can be said: the zero cannot be measured, as something lies on the pad.
    Loaded,
    /// Nothing can be said: a channel cannot be trusted.
    Faulty,
    /// Nothing can be said: what the channels read together is no finger.
    Doubtful,
    /// Nothing can be said: the decoder is for a pad with another number of channels, which is this one's.
    Unsuited {
        /// How many channels the pad has.
        channels: usize,
    },
}

/// Signal, compensation, decoder, touch and watch:
///
/// ```text
/// sample ─signal→ strain ─gain→ as calibrated ─thermometer→ at T₀ ─memory→ e ─decoder→ contact ─touch→ touched or not ─watch→ warning
///        less z           ÷ S                  ÷ its gain         less the past
/// ```
///
/// From the sample before, signal and thermometer know whether the pad was touched, signal also what warmth has added and what
/// the past has left behind, and memory the e that it follows.
#[derive(Clone, Debug)]
pub struct ContactStage {
    signal: Signal,
    gain: CommonGain,
    thermometer: Thermometer,
    memory: Memory,
    decoder: Decoder,
    touch: Touch,
    standing: Standing,
    watch: Watch,
    /// Strain decoded last, µV; `None` if the last sample could not be.
    strain: Option<Strain>,
    /// Raw channels of the last sample, µV.
    raw_uv: [f64; CHANNELS],
    /// What the last sample told, if the pad decodes on its own.
    told: Option<Estimate>,
}

impl ContactStage {
    /// A stage that has seen nothing: it measures its zero first. The mean filter has seen nothing either.
    pub fn new(decoder: Decoder, filter: MeanFilter) -> Self {
        Self {
            signal: Signal::new(
                decoder.channels(),
                decoder.is_clamped(),
                decoder.scale().unwrap_or_else(Scale::unidentified),
                filter,
            ),
            gain: CommonGain::ONE,
            thermometer: Thermometer::of(decoder.compensation.thermal),
            memory: Memory::of(&decoder.compensation),
            touch: Touch::new(),
            standing: Standing::new(decoder.standing_n()),
            watch: Watch::new(decoder.inverse()),
            decoder,
            strain: None,
            raw_uv: [0.0; CHANNELS],
            told: None,
        }
    }

    /// The channels of the last sample as the decoder got them; `None` if they could not be trusted.
    pub const fn strain(&self) -> Option<&Strain> {
        self.strain.as_ref()
    }

    /// Raw channels of the last sample, µV: not tared, nothing taken off.
    pub const fn raw_uv(&self) -> &[f64; CHANNELS] {
        &self.raw_uv
    }

    /// The contact of the last sample with its uncertainty, if the decoder knows. Decodes it anew.
    pub fn estimate(&self) -> Option<Estimate> {
        match &self.decoder.method {
            _ if self.told.is_some() => self.told,
            Method::Inverse(inverse) => inverse.estimate(self.strain.as_ref()?),
            Method::Balance(balance) => {
                let estimate = balance.estimate(self.strain.as_ref()?)?;
                let contact = self.standing.of_weight(&estimate.contact)?;
                let share = f64::from(self.standing.share().unwrap_or(1.0));
                Some(Estimate { contact, ..estimate.with_forces_times(share) })
            }
            _ => None,
        }
    }

    /// Scale of a pad that identifies itself so; `None` for a pad that cannot be played with by this decoder. One that decodes on its
    /// own has none, and any will do.
    pub fn scale_of(&self, identity: &Identity) -> Option<Scale> {
        let channels = usize::from(identity.channels);
        match self.decoder.scale() {
            _ if channels == 0 => Some(self.signal.scale()),
            Some(scale) => (channels == self.decoder.channels()).then_some(scale),
            None => Scale::of(identity).filter(|_| channels == self.decoder.channels()),
        }
    }

    /// Warning about the touch at hand or the last one; only the inverse decoder tells it.
    pub const fn warning(&self) -> Option<Warning> {
        self.watch.warning()
    }

    /// Whether nobody was weighed yet on a pad that somebody is to stand on.
    pub const fn awaits_weight(&self) -> bool {
        self.standing.awaits_weight()
    }

    /// Decoder in use.
    pub const fn decoder(&self) -> &Decoder {
        &self.decoder
    }

    /// By how much the pad's readings have changed since the calibration, as far as is known.
    pub const fn gain(&self) -> CommonGain {
        self.gain
    }

    /// The pad reads so many times what was thought.
    pub fn regain(&mut self, ratio: f64) {
        self.gain = self.gain.times(ratio);
        self.memory.rescale(1.0 / ratio);
    }

    /// Changes the filter; its window grows anew from one sample.
    pub fn set_filter(&mut self, filter: MeanFilter) {
        self.signal.set_filter(filter);
    }

    /// Takes the scale that a pad told; false if it was thought to be that anyway. It means an interruption, which the caller
    /// tells.
    pub fn set_scale(&mut self, scale: Scale) -> bool {
        self.signal.set_scale(scale)
    }

    /// Takes the reading at `at`. Where it shows no contact, the caller tells the interruption.
    pub fn take<P: Probe>(
        &mut self,
        at: StreamInstant,
        reading: &Reading,
        health: &mut Health,
        probe: &mut P,
    ) -> DecodedSample {
        self.told = None;
        let channels = self.decoder.channels();
        match &reading.measured {
            Measured::Nine(sample) if channels == CHANNELS => self.take_sample(at, sample, health, probe),
            Measured::Few(few) if channels == few.counts().len() => {
                self.take_sample(at, &with_zeros(few), health, probe)
            }
            Measured::Contact(sample) => self.take_contact(sample, health, probe),
            Measured::Nine(_) => self.unsuited(CHANNELS),
            Measured::Few(few) => self.unsuited(few.counts().len()),
        }
    }

    fn unsuited(&mut self, channels: usize) -> DecodedSample {
        self.strain = None;
        DecodedSample::Unsuited { channels }
    }

    /// Takes a contact that the pad decoded.
    fn take_contact<P: Probe>(
        &mut self,
        sample: &ContactSample,
        health: &mut Health,
        probe: &mut P,
    ) -> DecodedSample {
        self.strain = None;
        if sample.status.supply_fault() {
            health.supply_faults += 1;
            return DecodedSample::Faulty;
        }
        self.told = told::estimate(sample);
        probe.mark(PipelineStage::Contact);
        DecodedSample::Contact(self.told.map(|told| told.contact))
    }

    /// Takes a sample of channels.
    fn take_sample<P: Probe>(
        &mut self,
        at: StreamInstant,
        sample: &Sample,
        health: &mut Health,
        probe: &mut P,
    ) -> DecodedSample {
        let touched = self.touch.is_touched();
        self.thermometer.follow(at, sample, touched);
        let (gain, rest) = (self.gain, self.gain.read(&self.memory.rest()));
        let pad = PadState {
            touched,
            is_touch_believed: self.decoder.inverse().is_none(),
            rest,
            added_uv: self.thermometer.added_uv(),
        };
        self.strain = None;
        self.raw_uv = self.signal.raw_uv(sample);
        let loads = Loads {
            plain_n: |strain: &Strain| self.decoder.load_n(&gain.calibrated(strain)),
            without_stray_n: |strain: &Strain| load_without_stray_n(&self.decoder, &gain.calibrated(strain)),
        };
        match self.signal.condition(at, sample, &pad, &loads, health) {
            Conditioned::Strain(strain) => {
                let strain = self.memory.freed(&self.thermometer.at_reference(&gain.calibrated(&strain)));
                self.strain = Some(strain);
                self.contact(at, &strain, health, probe)
            }
            Conditioned::Pulled => {
                health.zeros_loaded += 1;
                self.interrupt(Cause::Loaded);
                self.wait(at, DecodedSample::Loaded)
            }
            Conditioned::Stray { channel } => {
                self.watch.name_stray(channel, health);
                self.interrupt(Cause::Stray);
                self.wait(at, DecodedSample::Doubtful)
            }
            Conditioned::Taring => self.wait(at, DecodedSample::Taring),
            Conditioned::Loaded => self.wait(at, DecodedSample::Loaded),
            Conditioned::Faulty => self.wait(at, DecodedSample::Faulty),
        }
    }

    fn wait(&mut self, at: StreamInstant, reading: DecodedSample) -> DecodedSample {
        self.memory.wait(at);
        reading
    }

    /// The contact of a strain that is compensated.
    fn contact<P: Probe>(
        &mut self,
        at: StreamInstant,
        strain: &Strain,
        health: &mut Health,
        probe: &mut P,
    ) -> DecodedSample {
        let (contact, explained) = self.decoder.explain(strain);
        probe.mark(PipelineStage::Contact);
        let touch = self.touch.update(at, &contact);
        if touch == TouchState::Drifted {
            self.interrupt(Cause::Drifted);
        }
        let touched = touch == TouchState::Touched;
        if self.watch.is_doubted() {
            self.memory.wait(at);
        } else {
            self.memory.follow(at, touched.then_some(strain));
        }
        let doubt = explained.zip(self.decoder.inverse()).and_then(|(explained, inverse)| {
            self.watch.see(at, strain, &explained, touched, inverse, health)
        });
        if doubt == Some(Doubt::Zero) {
            self.interrupt(Cause::Drifted);
        }
        if doubt.is_some() {
            DecodedSample::Doubtful
        } else {
            DecodedSample::Contact(self.standing.relative(at, touched.then_some(contact)))
        }
    }

    /// Does to each part what [`Cause::effects`] says.
    pub fn interrupt(&mut self, cause: Cause) {
        let effects = cause.effects();
        let Effects { gain, memory, thermometer, touch, standing, watch, .. } = effects;
        self.signal.interrupt(&effects);
        if gain == Effect::Forget {
            self.gain = CommonGain::ONE;
        }
        self.memory.interrupt(memory);
        if thermometer == Effect::Forget {
            self.thermometer = Thermometer::of(self.decoder.compensation.thermal);
        }
        self.touch.interrupt(touch);
        self.standing.interrupt(standing);
        self.watch.interrupt(watch, self.decoder.inverse());
    }
}

/// The same with as many channels as all stages have: those that the pad has not are zero.
fn with_zeros(few: &ChannelSample) -> Sample {
    let mut counts = [0; CHANNELS];
    counts.iter_mut().zip(few.counts()).for_each(|(to, count)| *to = *count);
    let ChannelSample { sequence, time_us, temperature_centi_c, .. } = *few;
    Sample { sequence, time_us, counts, temperature_centi_c, status: few.status() }
}
