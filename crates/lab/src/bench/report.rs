//! What the first measurements of a pad say: each input, each channel, and how what is wrong is mended.

use serde::Serialize;

use super::deed::{Deed, PlateAxis};
use super::guide::BenchResult;
use super::order::Order;
use super::rest::{InputFault, InputRest};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::weight::weight_n;
use tactpad_core::pad::wiring::front_end;
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::pipeline::contact::inverse::Inverse;
use tactpad_core::pipeline::contact::uncertainty::Noise;
use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS, Contact, MODULES, Strain};

/// An input with so many times the noise that the converter's data sheet lets expect is loud.
const LOUD: f64 = 3.0;
/// Samples whose mean is told beside a single one, by their time.
const MEAN_S: f64 = 0.01;
const AXES: usize = CHANNELS / MODULES;

/// All that was found.
#[derive(Clone, Debug, Serialize)]
pub struct BenchReport {
    /// The pad's serial number, if it told one.
    pub serial_number: Option<String>,
    /// Samples per second.
    pub rate_hz: f64,
    /// Frames that were missing.
    pub frames_lost: u64,
    /// Frames that were damaged.
    pub frames_damaged: u64,
    /// Noise that the converter's data sheet lets expect at this rate, µV rms.
    pub expected_noise_uv: f64,
    /// Each input at rest.
    pub inputs: [InputReport; CHANNELS],
    /// The weight, if it was felt.
    pub weight: Option<WeightReport>,
    /// What was done.
    pub deeds: Vec<DeedReport>,
    /// Each channel, and what it is sent as.
    pub channels: [ChannelReport; CHANNELS],
    /// The wiring that mends the order in software; nothing where it is in order or not known.
    pub wiring: Option<String>,
    /// What is wrong, with the way out, a sentence each.
    pub faults: Vec<String>,
    /// What could not be found out, a sentence each.
    pub open: Vec<String>,
}

/// An input at rest.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct InputReport {
    /// The channel in whose place it is sent.
    pub name: &'static str,
    /// What was measured.
    #[serde(flatten)]
    pub rest: InputRest,
}

/// A known weight in the middle of the plate.
#[derive(Clone, Debug, Serialize)]
pub struct WeightReport {
    /// Grams.
    pub weight_g: f64,
    /// Newtons.
    pub force_n: f64,
    /// What each channel read of it, µV; as it is sent where the order is not known.
    pub step_uv: [f64; CHANNELS],
    /// What the decoder of the nominal pad makes of that.
    pub decoded: Option<Contact>,
    /// Deviation of the normal force in a single sample, N.
    pub resolution_n: f64,
    /// The same of the mean of 10 ms, N.
    pub mean_resolution_n: f64,
}

/// A deed with what it read.
#[derive(Clone, Debug, Serialize)]
pub struct DeedReport {
    /// What it was.
    pub deed: String,
    /// What each channel read, µV; as it is sent where the order is not known.
    pub channels_uv: [f64; CHANNELS],
    /// The contact that explains it best.
    pub contact: Option<Contact>,
    /// Of what no contact explains, the largest part: its channel, and its share of the largest reading.
    pub unexplained: Option<(&'static str, f64)>,
}

/// A channel, and what it is sent as.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ChannelReport {
    /// Its name.
    pub name: &'static str,
    /// The input that carries it; nothing where presses do not decide.
    pub sent_as: Option<&'static str>,
    /// Whether its sign is the other one; nothing where presses do not decide.
    pub is_reversed: Option<bool>,
}

impl BenchReport {
    /// Whether nothing is wrong and nothing is open.
    pub fn is_good(&self) -> bool {
        self.faults.is_empty() && self.open.is_empty()
    }

    /// What the measurements of a pad say that should be this one.
    pub fn of(result: &BenchResult, weight_g: Option<f64>, device: &Device, field: &PadField) -> Self {
        let expected_noise_uv = front_end::noise_uv(device, result.rate_hz);
        let told = result.rest.map(|it| it.fault.is_none());
        let order = result.order.as_ref();
        let wiring = order.map_or(SignedPermutation::IDENTITY, |order| order.told_wiring(&told));
        let is_known = told == [true; CHANNELS] && order.is_some_and(|order| order.is_decided(&told));
        let noise_uv = result.rest.map(|it| it.noise_uv);
        let decoder = Decoding { decoder: decoder(field), wiring, is_known };
        let weight = result.weight_uv.zip(weight_g).map(|(uv, weight_g)| {
            let resolution_n = decoder.resolution_n(&noise_uv);
            let step_uv = wiring.of(&uv);
            WeightReport {
                weight_g,
                force_n: weight_n(weight_g),
                step_uv,
                decoded: decoder.contact(&step_uv).map(|it| it.0),
                resolution_n,
                mean_resolution_n: resolution_n / (MEAN_S * result.rate_hz).max(1.0).sqrt(),
            }
        });
        let mut report = Self {
            serial_number: result
                .identity
                .map(|it| it.serial_number.to_string())
                .filter(|number| !number.is_empty()),
            rate_hz: result.rate_hz,
            frames_lost: result.frames_lost,
            frames_damaged: result.frames_damaged,
            expected_noise_uv,
            inputs: std::array::from_fn(|k| InputReport { name: CHANNEL_NAMES[k], rest: result.rest[k] }),
            weight,
            deeds: result.readings.iter().map(|it| decoder.deed(it.deed, &it.uv)).collect(),
            channels: channels(result),
            wiring: None,
            faults: Vec::new(),
            open: Vec::new(),
        };
        report.judge_inputs(device);
        report.judge_order(order, &wiring);
        if result.is_weight_unfelt {
            report.open.push(
                "the weight is too light to be told from this noise: take a heavier one, or lower the noise first".into(),
            );
        }
        report
    }

    fn judge_inputs(&mut self, device: &Device) {
        let range_mv = front_end::range_mv(device);
        for InputReport { name, rest } in &self.inputs {
            let (noise_uv, expected_uv) = (rest.noise_uv, self.expected_noise_uv);
            let fault = match rest.fault {
                Some(InputFault::OutOfRange) => format!(
                    "{name} is out of range (±{range_mv:.0} mV with docs/build.md's converter): a gauge or its wire is open or shorted, or \
                     the tap is not joined"
                ),
                Some(InputFault::Constant) => format!(
                    "{name} sends the same number all the time: its converter does not convert, or the firmware does not read it"
                ),
                Some(InputFault::Noisy) => format!(
                    "{name} has noise of {noise_uv:.0} µV, so that no press is told by it: look for a loose wire, or a tap that floats"
                ),
                Some(InputFault::Silent) => {
                    format!("{name} answers to no press: its tap is not joined to its bridge")
                }
                None if noise_uv > LOUD * expected_uv => format!(
                    "{name} has noise of {noise_uv:.1} µV, where the converter's data sheet lets expect {expected_uv:.1}: look at its \
                     supply, its reference and its ground"
                ),
                None => continue,
            };
            self.faults.push(fault);
        }
        for InputReport { name, rest } in &self.inputs {
            if let Some(hum) = rest.hum.filter(|hum| hum.amplitude_uv > self.expected_noise_uv) {
                self.faults.push(format!(
                    "{name} has {:.1} µV of {:.0} Hz: twist its wires, shield them, and ground the pad at one point",
                    hum.amplitude_uv, hum.frequency_hz
                ));
            }
        }
    }

    fn judge_order(&mut self, order: Option<&Order>, wiring: &SignedPermutation) {
        let Some(order) = order else {
            self.open.push(
                "which channel is which cannot be told: no press was read, or more than three inputs tell nothing; mend them first"
                    .into(),
            );
            return;
        };
        if !order.is_sound() {
            self.open.push(format!(
                "which channel is which cannot be told: the presses are not those of this pad where it was asked (they miss by {:.1}, a \
                 sound pad's by {:.1} at most). Is module 0 at +x, was each press above its module, and is it the device file's pad?",
                order.cost,
                super::order::SOUND
            ));
            return;
        }
        let untold: Vec<&str> =
            self.channels.iter().filter(|it| self.is_open(it)).map(|it| it.name).collect();
        if !untold.is_empty() {
            self.open.push(format!(
                "cannot tell what {} are sent as, or with which sign: press more firmly and nearer to the middle of each module, and push \
                 harder along the plate",
                untold.join(", ")
            ));
        }
        if *wiring != SignedPermutation::IDENTITY {
            self.wiring = Some(wiring.to_string());
            self.faults.extend(wired(wiring));
        }
    }

    /// Whether presses leave open what a channel is sent as; of one that is sent as an input that tells nothing they cannot say more.
    fn is_open(&self, channel: &ChannelReport) -> bool {
        let is_mute =
            |name: &str| self.inputs.iter().any(|input| input.name == name && input.rest.fault.is_some());
        match channel.sent_as {
            Some(sent) => channel.is_reversed.is_none() && !is_mute(sent),
            None => true,
        }
    }
}

fn channels(result: &BenchResult) -> [ChannelReport; CHANNELS] {
    let told = result.order.as_ref().map_or([None; CHANNELS], Order::told);
    let places = result.order.as_ref().map_or([None; CHANNELS], Order::told_places);
    std::array::from_fn(|k| ChannelReport {
        name: CHANNEL_NAMES[k],
        sent_as: places[k].map(|sent| CHANNEL_NAMES[sent]),
        is_reversed: told[k].map(|(_, is_reversed)| is_reversed),
    })
}

/// The mistakes of a wiring, a sentence each.
fn wired(wiring: &SignedPermutation) -> Vec<String> {
    let mut told = Vec::new();
    let sources = wiring.sources();
    let module_of = |module: usize| {
        let from = sources[AXES * module].0 / AXES;
        let is_whole = (0..AXES).all(|axis| sources[AXES * module + axis].0 == AXES * from + axis);
        is_whole.then_some(from)
    };
    let modules: Vec<Option<usize>> = (0..MODULES).map(module_of).collect();
    if modules.iter().all(Option::is_some) {
        let moved = modules
            .iter()
            .enumerate()
            .filter_map(|(to, from)| from.filter(|it| *it != to).map(|it| (to, it)));
        let moved: Vec<String> =
            moved.map(|(module, sent)| format!("module {module} is sent as module {sent}")).collect();
        if !moved.is_empty() {
            told.push(format!(
                "{}: their cables or chip selects are exchanged, or the pad lies turned or face down: module 0 belongs to the right",
                moved.join(", ")
            ));
        }
    } else {
        let moved = sources.iter().enumerate().filter(|(channel, (sent, _))| channel != sent);
        let moved: Vec<String> = moved
            .map(|(channel, (sent, _))| {
                format!("{} is sent as {}", CHANNEL_NAMES[channel], CHANNEL_NAMES[*sent])
            })
            .collect();
        told.push(format!("{}: exchange the taps' wires", moved.join(", ")));
    }
    for module in 0..MODULES {
        let reversed: Vec<usize> =
            (0..AXES).map(|axis| AXES * module + axis).filter(|channel| sources[*channel].1).collect();
        if reversed.len() == AXES {
            told.push(format!(
                "all of module {module} is reversed: excitation and ground of its bridges are exchanged"
            ));
            continue;
        }
        for channel in reversed {
            let sent = sources[channel].0;
            told.push(format!(
                "{} is reversed: exchange AIN{axis}P and AIN{axis}N at the converter of module {}, or the two ends of its bridge",
                CHANNEL_NAMES[channel],
                sent / AXES,
                axis = sent % AXES
            ));
        }
    }
    told
}

fn decoder(field: &PadField) -> Inverse {
    // In which unit the noise is plays no part: only contacts and what they leave over are asked.
    Inverse::new(field.signals.clone(), Noise::of_channels([10.0; CHANNELS], [0.05; CHANNELS]))
}

/// The pad's channels decoded.
struct Decoding {
    decoder: Inverse,
    wiring: SignedPermutation,
    /// Whether all of it is known, so that there are contacts.
    is_known: bool,
}

impl Decoding {
    fn contact(&self, channels_uv: &[f64; CHANNELS]) -> Option<(Contact, [f64; CHANNELS])> {
        let uv = channels_uv.map(|uv| uv as f32);
        let fit = self.decoder.explain(&Strain { uv }).filter(|_| self.is_known)?;
        Some((fit.contact, fit.left_uv))
    }

    fn deed(&self, deed: Deed, sent_uv: &[f64; CHANNELS]) -> DeedReport {
        let channels_uv = self.wiring.of(sent_uv);
        let found = self.contact(&channels_uv);
        let largest = channels_uv.iter().fold(0.0, |largest: f64, uv| largest.max(uv.abs()));
        let unexplained = found.and_then(|(_, left)| {
            let parts = left.iter().map(|uv| uv.abs() / largest).enumerate();
            parts.max_by(|one, other| one.1.total_cmp(&other.1)).map(|(k, share)| (CHANNEL_NAMES[k], share))
        });
        DeedReport { deed: named(deed), channels_uv, contact: found.map(|it| it.0), unexplained }
    }

    /// Deviation of the normal force by the inputs' noise: the force is linear in the channels.
    fn resolution_n(&self, noise_uv: &[f64; CHANNELS]) -> f64 {
        let sources = self.wiring.sources();
        let variance: f64 = (0..CHANNELS)
            .map(|k| {
                let mut uv = [0.0; CHANNELS];
                uv[k] = 1.0;
                (f64::from(self.decoder.load_n(&Strain { uv })) * noise_uv[sources[k].0]).powi(2)
            })
            .sum();
        variance.sqrt()
    }
}

/// A deed as it is told.
pub fn named(deed: Deed) -> String {
    match deed {
        Deed::Press { module } => format!("press above module {module}"),
        Deed::Push { axis: PlateAxis::X } => "push to the right".into(),
        Deed::Push { axis: PlateAxis::Y } => "push up".into(),
    }
}
