//! Simulation-based calibration: pads and rigs are drawn from the priors that docs/decoding.md declares, measured by the twin, and
//! calibrated. Then the truth has to lie in the posterior as a draw from it would: the rank u = Φ((truth − value)/deviation) of each
//! number is even in 0..1, and stated 95 % regions of contacts hold 95 % at every radius, force and axis.
//!
//! Fields are bent by the simulator's derivatives, as the prior says, so this asks about the inference and not about the
//! mechanics; `tests/hidden/calibrated` asks about these, with another program's fields. The proof has 200 pads, and prints the tables of
//! docs/decoding.md. Seeds are counted from 1.
//!
//! Source: S. Talts, M. Betancourt, D. Simpson, A. Vehtari, A. Gelman, arXiv:1804.06788 (2018).
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use std::collections::BTreeMap;

use tactpad::lab::calibration::fit::{Calibration, fit};
use tactpad::lab::calibration::result::numbers::{Number, Quantity};
use tactpad::lab::diagnosis::data::target::Target;
use tactpad::lab::effect::Effect;
use tactpad::lab::evaluation::strain;
use tactpad::lab::rig::measurement::carry_out;
use tactpad::numeric::chi_square::exceeded;
use tactpad::numeric::random::SplitMix64;
use tactpad::numeric::zernike::jets;
use tactpad::pad::device::Device;
use tactpad::pad::device::behaviour::Crosstalk;
use tactpad::pad::field::PadField;
use tactpad::pad::influence::{InfluenceField, MAPS};
use tactpad::pipeline::contact::Decoder;
use tactpad::quantity::{CHANNELS, MODULES};
use tactpad::tables::measured::Table;
use tactpad::tables::plans;
use tactpad::tables::recording::Recording;

/// Contacts of a calibration: a hard case, as the prior counts.
const ROWS: usize = 73;
/// Unseen contacts of each pad, and how far out and how strong they are at most.
const UNSEEN: usize = 120;
const REACH_MM: f64 = 26.0;
const FULL_SCALE_N: f64 = 5.0;
/// Degree of the sensitivities' polynomials is no larger.
const DEGREE: usize = 24;
const BINS: usize = 10;
/// Cycles at which ageing slows down, of which docs/decoding.md tells.
const ONSET_CYCLES: f64 = 500.0;
/// χ² of five numbers below which 95 % of all cases lie, and the end of an interval at 95 %.
const CHI_SQUARE_95: f64 = 11.0705;
const HALF_WIDTH: f64 = 1.96;
/// Deviations of a module's displacement, with the probability of the wide one.
const SHIFTS_MM: [f64; 2] = [0.15, 0.75];
const FAR_OFF: f64 = 0.1;
/// Deviations of the narrow part of a prior of the rig over those of the wide one.
const NARROW: f64 = 0.1;
/// What the common gain differs by from one recording to the next, and from one contact to the next within one.
const GAIN_BETWEEN: f64 = 0.005;
const GAIN_WITHIN: f64 = 0.006;
/// Readings that the prior of a channel's noise counts as, and contacts that the prior of the common gain does.
const PSEUDO_READINGS: usize = 10;
const GAIN_PSEUDO_CONTACTS: usize = 30;

/// A pad and a rig, by the declared priors.
struct Drawn {
    device: Device,
    field: PadField,
    /// The truth of each number, by its name and target.
    truth: BTreeMap<String, f64>,
    /// What the common gain comes to until the next recording, and its standard deviation from contact to contact.
    wandered: f64,
    wander: f64,
}

fn key(name: &str, target: Target) -> String {
    match target {
        Target::Channels { into, from } => format!("{name} {into} {from}"),
        Target::Channel(channel) => format!("{name} {channel}"),
        _ => name.to_owned(),
    }
}

impl Drawn {
    fn new(seed: u64) -> Self {
        let mut random = SplitMix64::named(seed, "priors");
        let mut truth = BTreeMap::new();
        let mut device = Device::nominal();
        let field = bent(&mut random, &mut truth);
        wire(&mut device, &mut random, &mut truth);
        mount(&mut device, &mut random, &mut truth);
        let noise = &mut device.behaviour.noise;
        noise.additive_uv = [0; CHANNELS].map(|_| deviation(&mut random, 8.0, PSEUDO_READINGS));
        noise.share = [0; CHANNELS].map(|_| deviation(&mut random, 0.02, PSEUDO_READINGS));
        let wandered = 1.0 + normal(&mut random, GAIN_BETWEEN);
        let wander = deviation(&mut random, GAIN_WITHIN, GAIN_PSEUDO_CONTACTS);
        Self { device, field, truth, wandered, wander }
    }

    /// The table of a measurement, with another common gain at each contact; the untouched pad reads nothing that it would change.
    fn wandering(&self, mut table: Table, seed: u64) -> Table {
        let mut random = SplitMix64::named(seed, "wander");
        for row in &mut table.rows {
            let gain = 1.0 + normal(&mut random, self.wander);
            row.uv.iter_mut().flatten().for_each(|uv| *uv *= gain);
        }
        table
    }

    /// The pad as it is after the calibration, on a perfect rig.
    fn afterwards(&self) -> Device {
        let mut device = self.device.clone();
        let left = self.wandered * (1.0 - device.behaviour.ageing.share[0]);
        device.modules.iter_mut().for_each(|module| module.gain = module.gain.map(|gain| left * gain));
        device.behaviour.ageing = Device::nominal().behaviour.ageing;
        device.behaviour.rig = Device::nominal().behaviour.rig;
        device
    }
}

fn normal(random: &mut SplitMix64, deviation: f64) -> f64 {
    deviation * f64::from(random.normal())
}

/// A standard deviation whose prior counts as ν readings of this one: σ² = ν σ₀²/χ².
fn deviation(random: &mut SplitMix64, expected: f64, readings: usize) -> f64 {
    let square: f64 = (0..readings).map(|_| normal(random, 1.0).powi(2)).sum();
    expected * (readings as f64 / square).sqrt()
}

/// The nominal field, bent by poses, stiffnesses and blur.
fn bent(random: &mut SplitMix64, truth: &mut BTreeMap<String, f64>) -> PadField {
    let (nominal, device) = (PadField::nominal(), Device::nominal());
    let mut weights = Vec::new();
    let shifts_mm: [f64; MODULES] =
        [0; MODULES].map(|_| SHIFTS_MM[usize::from(f64::from(random.fraction()) < FAR_OFF)]);
    for it in &nominal.sensitivities {
        let (name, own) = (it.parameter.name(), it.parameter.get(&device));
        let (value, weight) = match name {
            "material.plate.e_mpa" => continue,
            // w = t/3 (1 − e^−3q) of the plate, E (1 − e^−q) of a modulus.
            "plate.thickness_mm" => factor(normal(random, 0.08), own, 3.0),
            _ if name.ends_with("_e_factor") => factor(normal(random, 0.3), own, 1.0),
            _ if name.ends_with("e_mpa") => factor(normal(random, 0.2), own, 1.0),
            _ if name.starts_with("module.") && name.ends_with("_mm") => {
                additive(normal(random, shifts_mm[it.parameter.module().unwrap()]))
            }
            _ if name.starts_with("module.") && name.ends_with("_deg") => additive(normal(random, 2.0)),
            _ => continue,
        };
        truth.insert(name.to_owned(), value);
        weights.push((weight, it));
    }
    let blur_mm2 = normal(random, 0.5);
    truth.insert("blur_mm2".into(), blur_mm2);
    let signals = &nominal.signals;
    let (spacing_mm, reach_mm) = (f64::from(signals.spacing_mm()), f64::from(signals.radius_mm()));
    let maps = |place_mm: [f64; 2]| {
        let gains = signals.gains(place_mm[0] as f32, place_mm[1] as f32).value;
        let laplacian = signals.laplacian(place_mm);
        let jets = jets(DEGREE, place_mm.map(|mm| mm / device.plate.radius_mm()));
        std::array::from_fn::<f64, MAPS, _>(|map| {
            let (channel, axis) = (map / 3, map % 3);
            let more: f64 =
                weights.iter().map(|(weight, it)| weight * it.maps[channel][axis].value(&jets)).sum();
            gains[channel][axis] + blur_mm2 * laplacian[channel][axis] + more
        })
    };
    let signals = InfluenceField::sampled(spacing_mm, reach_mm, reach_mm, maps);
    PadField { signals, ..nominal }
}

/// A number by the logarithm q of its factor, and the weight own/n (1 − e^−nq) of its derivative.
fn factor(q: f64, own: f64, power: f64) -> (f64, f64) {
    (own * q.exp(), own / power * (1.0 - (-power * q).exp()))
}

const fn additive(change: f64) -> (f64, f64) {
    (change, change)
}

/// Gains, crosstalk and ageing.
fn wire(device: &mut Device, random: &mut SplitMix64, truth: &mut BTreeMap<String, f64>) {
    let lost = normal(random, 0.05);
    (device.behaviour.ageing.share, device.behaviour.ageing.onset_cycles) = ([lost; CHANNELS], ONSET_CYCLES);
    let gains: [f64; CHANNELS] = [0; CHANNELS].map(|_| (1.0 + normal(random, 0.3)).max(0.2));
    for (channel, gain) in gains.iter().enumerate() {
        device.modules[channel / 3].gain[channel % 3] = *gain;
        truth.insert(format!("gain {channel}"), (1.0 - lost) * gain);
    }
    truth.insert("ageing.share_at_end".into(), lost);
    let pairs = (0..CHANNELS * CHANNELS).map(|index| (index / CHANNELS, index % CHANNELS));
    for (channel, with) in pairs.filter(|(channel, with)| channel != with) {
        let share = normal(random, 0.02);
        device.behaviour.crosstalk.push(Crosstalk { channel, with, share });
        truth.insert(format!("crosstalk {channel} {with}"), share);
    }
}

/// The rig: most are right in most of this, and some are wrong in some of it.
fn mount(device: &mut Device, random: &mut SplitMix64, truth: &mut BTreeMap<String, f64>) {
    let mut error = |name: &str, wide: f64, probability: f64, expected: f64| {
        let size = if f64::from(random.fraction()) < probability { wide } else { NARROW * wide };
        let value = expected + normal(random, size);
        truth.insert(name.into(), value);
        value
    };
    let rig = &mut device.behaviour.rig;
    rig.stage_x_mm = error("stage_offset.x_mm", 0.4, 0.05, 0.0);
    rig.stage_y_mm = error("stage_offset.y_mm", 0.4, 0.05, 0.0);
    rig.stage_rotation_deg = error("stage_rotation.deg", 1.0, 0.05, 0.0);
    rig.stage_scale = error("stage_scale.scale", 4e-3, 0.05, 1.0);
    rig.reference_tilt_x_deg = error("reference_tilt.x_deg", 1.5, 0.5, 0.0);
    rig.reference_tilt_y_deg = error("reference_tilt.y_deg", 1.5, 0.5, 0.0);
    rig.reference_gain = error("reference_gain.gain", 0.015, 0.5, 1.0);
    let zeros = ["reference_zero.fx_n", "reference_zero.fy_n", "reference_zero.fz_n"];
    rig.reference_zero_n = zeros.map(|name| error(name, 0.02, 0.5, 0.0));
    (rig.stage_scatter_mm, rig.reference_noise_n) = (0.1, 0.02);
}

/// What came of one pad.
#[derive(Default)]
struct Seen {
    /// Kind of each number, and its (truth − value)/deviation.
    numbers: Vec<(&'static str, f64)>,
    contacts: Vec<Contact>,
}

/// An unseen contact: its radius, its force, whether its region of all five holds it, and each interval.
struct Contact {
    radius_mm: f64,
    force_n: f64,
    inside: [bool; 6],
}

fn kind(number: &Number) -> Option<&'static str> {
    let kind = match number.quantity {
        Quantity::Gain => "gains",
        Quantity::Crosstalk => "crosstalk",
        Quantity::Blur => "blur",
        Quantity::Ageing => "ageing",
        // Static samples tell nothing of it.
        Quantity::Rig(it) if it.effect == Effect::TimeLag => return None,
        Quantity::Rig(_) => "rig",
        Quantity::Physical(it) if it.parameter.name().ends_with("_deg") => "turns and tilts",
        Quantity::Physical(it)
            if it.parameter.name().starts_with("module") && it.parameter.name().ends_with("_mm") =>
        {
            "displacements"
        }
        Quantity::Physical(_) => "stiffnesses",
        _ => return None,
    };
    Some(kind)
}

fn seen(seed: u64) -> Seen {
    let drawn = Drawn::new(seed);
    let contact = &drawn.device.contact;
    let plan = plans::recommended::plan(contact, seed);
    // The loss of the prior is that of the whole plan.
    let cycles = carry_out(&plan, &drawn.device, &drawn.field, seed).cycles;
    let mut device = drawn.device.clone();
    device.behaviour.ageing.cycles = cycles.last().copied().unwrap();
    let measured = carry_out(&plan, &device, &drawn.field, seed);
    let table = drawn.wandering(measured.counted().table, seed);
    let recording = Recording::of(table, contact.full_scale_n).unwrap();
    let mut rows = recording.contacts();
    SplitMix64::named(seed, "rows").shuffle(&mut rows);
    rows.truncate(ROWS);
    let found = fit(&recording, &rows, &Device::nominal(), &PadField::nominal(), None).unwrap();
    Seen { numbers: off(&found, &drawn), contacts: contacts(&found.decoder(), &drawn, seed) }
}

fn off(found: &Calibration, drawn: &Drawn) -> Vec<(&'static str, f64)> {
    let one = |number: &Number| {
        let (kind, truth) = (kind(number)?, drawn.truth.get(&key(number.quantity.name(), number.target))?);
        // Of a factor the fit has the logarithm.
        let is_factor =
            kind == "stiffnesses" || matches!(number.quantity, Quantity::Rig(_)) && number.expected == 1.0;
        let off = if is_factor {
            number.value * (truth / number.value).ln() / number.deviation
        } else {
            (truth - number.value) / number.deviation
        };
        Some((kind, off))
    };
    found.numbers.iter().filter_map(one).collect()
}

fn contacts(decoder: &Decoder, drawn: &Drawn, seed: u64) -> Vec<Contact> {
    let device = drawn.afterwards();
    let plan = plans::recommended::plan(&device.contact, seed + 10_000);
    let unseen = carry_out(&plan, &device, &drawn.field, seed + 10_000);
    let table = drawn.wandering(unseen.table, seed + 10_000);
    let recording = Recording::of(table, device.contact.full_scale_n).unwrap();
    let rows = recording.taken(decoder).rows;
    let one = |at: usize| {
        let truth = unseen.truth[at].numbers();
        let estimate = decoder.inverse()?.estimate(&strain(&rows[at]))?;
        let found = estimate.contact;
        let found = [found.x_mm, found.y_mm, found.fx_n, found.fy_n, found.fz_n].map(f64::from);
        let inside = |axis: usize| {
            (found[axis] - truth[axis]).abs() <= HALF_WIDTH * estimate.covariance[axis][axis].sqrt()
        };
        let all = estimate.distance_square(&truth)? <= CHI_SQUARE_95;
        Some(Contact {
            radius_mm: truth[0].hypot(truth[1]),
            force_n: truth[2].hypot(truth[3]).hypot(truth[4]),
            inside: std::array::from_fn(|k| k.checked_sub(1).map_or(all, inside)),
        })
    };
    recording.contacts().into_iter().step_by(5).take(UNSEEN).filter_map(one).collect()
}

/// Φ.
fn normal_cdf(z: f64) -> f64 {
    0.5 * (1.0 + z.signum() * (1.0 - exceeded(z * z, 1)))
}

/// Of each kind of numbers: the rms of the misses in deviations, and the histogram of ranks.
fn ranks(all: &[Seen]) -> BTreeMap<&'static str, (usize, f64, [usize; BINS])> {
    let mut kinds: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
    all.iter()
        .flat_map(|seen| &seen.numbers)
        .for_each(|(kind, off)| kinds.entry(kind).or_default().push(*off));
    let of_kind = |off: Vec<f64>| {
        let rms = (off.iter().map(|it| it * it).sum::<f64>() / off.len() as f64).sqrt();
        let mut bins = [0; BINS];
        off.iter().for_each(|it| bins[((BINS as f64 * normal_cdf(*it)) as usize).min(BINS - 1)] += 1);
        (off.len(), rms, bins)
    };
    kinds.into_iter().map(|(kind, off)| (kind, of_kind(off))).collect()
}

fn share(contacts: &[&Contact], of: usize) -> f64 {
    contacts.iter().filter(|it| it.inside[of]).count() as f64 / contacts.len().max(1) as f64
}

fn coverage(all: &[Seen]) -> [Vec<f64>; 3] {
    let contacts: Vec<&Contact> = all.iter().flat_map(|seen| &seen.contacts).collect();
    let thirds = |third: &dyn Fn(&Contact) -> usize| -> Vec<f64> {
        let part =
            |at: usize| contacts.iter().copied().filter(|it| third(it).min(2) == at).collect::<Vec<_>>();
        (0..3).map(|at| share(&part(at), 0)).collect()
    };
    let by_radius = thirds(&|it| (3.0 * (it.radius_mm / REACH_MM).powi(2)) as usize);
    let by_force = thirds(&|it| (3.0 * it.force_n / FULL_SCALE_N) as usize);
    [(0..6).map(|of| share(&contacts, of)).collect(), by_radius, by_force]
}

/// How many pads, the rms of the misses in deviations, and the share of the contacts inside.
struct Goals {
    pads: u64,
    rms: [f64; 2],
    inside: [f64; 2],
    /// Of three pads a single number of each is not known to any bound.
    open: &'static [&'static str],
}

const FEW: Goals = Goals { pads: 3, rms: [0.5, 1.5], inside: [0.86, 1.0], open: &["ageing", "blur"] };
const MANY: Goals = Goals { pads: 200, rms: [0.85, 1.15], inside: [0.92, 0.98], open: &[] };

#[test]
#[ignore = "proof: 10 s: three pads and rigs drawn; a pad whose posterior is looked at stays a test"]
fn the_truth_lies_in_the_posterior_as_a_draw_from_it_would() {
    are_held(&FEW);
}

#[test]
#[ignore = "proof: 400 s: misses a goal, as docs/decoding.md says: two hundred pads and rigs instead of three"]
fn the_truth_lies_in_the_posterior_as_a_draw_from_it_would_on_many_pads() {
    are_held(&MANY);
}

fn are_held(goals: &Goals) {
    let all: Vec<Seen> = (1..=goals.pads).map(seen).collect();
    let ranks = ranks(&all);
    for (kind, (count, rms, bins)) in &ranks {
        let mean = *count as f64 / BINS as f64;
        let square: f64 = bins.iter().map(|bin| (*bin as f64 - mean).powi(2) / mean).sum();
        println!("{kind:<16} {count:6}  rms {rms:.2}  ranks {bins:?}  p {:.3}", exceeded(square, BINS - 1));
    }
    let [by_axis, by_radius, by_force] = coverage(&all);
    println!(
        "inside: all, x, y, Fx, Fy, Fz {by_axis:.3?}; by radius {by_radius:.3?}; by force {by_force:.3?}"
    );
    let ([least, most], [least_inside, most_inside]) = (goals.rms, goals.inside);
    for (kind, (_, rms, _)) in &ranks {
        assert!(goals.open.contains(kind) || (least..most).contains(rms), "{kind}: {rms}");
    }
    assert!((least_inside..=most_inside).contains(&by_axis[0]), "{by_axis:?}");
}
