//! Calibration at home: presses without labels and a known weight on five marks, on pads whose truth is known.
//!
//! A pad is like the paper's, with other gains (10 %), poses (0.1 mm, 1.2°), crosstalk of 1.5 % between all channels, and with its
//! friction, creep, restless finger and lasting noise. It does not age. Its field is the nominal one and its sensitivities: what the
//! simulator's second order is worth is no question here. Beside it stands the same pad, calibrated by twenty contacts that a rig labelled.
//!
//! The proof calibrates twenty pads, also by ten minutes of play, by presses near the middle alone and by the weight alone, and
//! prints what the errors are of the rig's, median and worst. Seeds are counted from 1.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use std::f64::consts::TAU;

use tactpad::lab::calibration::fit::fit;
use tactpad::lab::evaluation::Evaluation;
use tactpad::lab::play::home::{AtHome, calibrated};
use tactpad::lab::play::weights::Placement;
use tactpad::lab::play::windows::{SampleContext, Window, WindowCollector};
use tactpad::lab::rig::measurement::carry_out;
use tactpad::lab::tangent::SimulatedPad;
use tactpad::numeric::random::SplitMix64;
use tactpad::numeric::zernike::jets;
use tactpad::pad::device::Device;
use tactpad::pad::device::behaviour::Crosstalk;
use tactpad::pad::field::PadField;
use tactpad::pad::influence::{InfluenceField, MAPS};
use tactpad::pad::twin::hand::Hand;
use tactpad::pad::twin::pad::{Circumstances, TwinPad};
use tactpad::pipeline::contact::Decoder;
use tactpad::quantity::{CHANNELS, Contact};
use tactpad::tables::plans;
use tactpad::tables::recording::Recording;

const PAPER: &str = include_str!("../../models/imperfections/paper.toml");
const PERIOD_S: f64 = 1e-3;
/// Degree of the sensitivities' polynomials is no larger.
const DEGREE: usize = 24;
const MARKS_MM: [[f64; 2]; 5] = [[0.0, 0.0], [15.0, 0.0], [-15.0, 0.0], [0.0, 15.0], [0.0, -15.0]];
const WEIGHT_G: f64 = 200.0;
const G_N_PER_G: f64 = 9.80665e-3;
/// Where a player of a game presses: four directions and the middle, by this scatter.
const AIM_MM: f64 = 3.0;

/// A pad.
pub(super) struct Pad {
    pub(super) device: Device,
    pub(super) field: PadField,
    seed: u64,
}

impl Pad {
    pub(super) fn drawn(seed: u64) -> Self {
        let mut random = SplitMix64::named(seed, "pads");
        let mut normal = |size: f64| size * f64::from(random.normal());
        let nominal = PadField::nominal();
        let mut device = Device::nominal().with_imperfections(PAPER).0.unwrap();
        let shifts: Vec<f64> = nominal
            .sensitivities
            .iter()
            .map(|it| match it.parameter.name() {
                name if name.contains("module") && name.ends_with("_mm") => normal(0.1),
                name if name.contains("module") && name.ends_with("rotation_deg") => normal(1.2),
                _ => 0.0,
            })
            .collect();
        for module in &mut device.modules {
            module.gain = module.gain.map(|gain| gain * (1.0 + normal(0.1)));
            module.offset_uv = module.offset_uv.map(|uv| uv + normal(200.0));
        }
        let pairs = (0..CHANNELS * CHANNELS).map(|index| (index / CHANNELS, index % CHANNELS));
        // Five hundred unseen contacts would take a percent and a half of what it reads.
        device.behaviour.ageing.share = [0.0; CHANNELS];
        device.behaviour.crosstalk = pairs
            .filter(|(channel, with)| channel != with)
            .map(|(channel, with)| Crosstalk { channel, with, share: normal(0.015) })
            .collect();
        let signals = bent(&nominal, &shifts);
        Self { device, field: PadField { signals, ..nominal }, seed }
    }

    /// Errors against the truth on unseen contacts of the recommended plan: mm, N, share inside the stated regions.
    fn errors(&self, decoder: &Decoder) -> [f64; 3] {
        let plan = plans::recommended::plan(&self.device.contact, self.seed + 100);
        let unseen = carry_out(&plan, &self.device, &self.field, self.seed + 100);
        let full_scale_n = self.device.contact.full_scale_n;
        let found = Evaluation::of(decoder, unseen.table, Some(&unseen.truth), full_scale_n).unwrap();
        let truth = found.truth.unwrap();
        [truth.errors.position_mae_mm, truth.errors.force_mae_n, truth.coverage95.unwrap()]
    }

    /// By so many seconds of play at home, and a weight on five marks.
    pub(super) fn by_play(&self, seconds: f64) -> Decoder {
        let (windows, placements) = recorded(self, seconds, 26.0);
        at_home(&windows, &placements).calibration.decoder()
    }

    /// By so many contacts that a rig labelled.
    pub(super) fn by_rig(&self, labels: usize) -> Decoder {
        let measured =
            carry_out(&plans::paper::plan(&self.device.contact), &self.device, &self.field, self.seed);
        let recording = Recording::of(measured.table, self.device.contact.full_scale_n).unwrap();
        let mut rows = recording.contacts();
        SplitMix64::named(self.seed, "rows").shuffle(&mut rows);
        rows.truncate(labels);
        fit(&recording, &rows, &Device::nominal(), &PadField::nominal(), None).unwrap().decoder()
    }
}

/// The simulated maps and these multiples of their sensitivities.
fn bent(nominal: &PadField, shifts: &[f64]) -> InfluenceField {
    let signals = &nominal.signals;
    let (spacing_mm, reach_mm) = (f64::from(signals.spacing_mm()), f64::from(signals.radius_mm()));
    let plate_mm = Device::nominal().plate.radius_mm();
    InfluenceField::sampled(spacing_mm, reach_mm, reach_mm, |place_mm: [f64; 2]| {
        let gains = signals.gains(place_mm[0] as f32, place_mm[1] as f32).value;
        let jets = jets(DEGREE, place_mm.map(|mm| mm / plate_mm));
        let bent = |map: usize| {
            let slopes = nominal.sensitivities.iter().zip(shifts).filter(|(_, shift)| **shift != 0.0);
            let more = slopes.map(|(it, shift)| shift * it.maps[map / 3][map % 3].value(&jets));
            gains[map / 3][map % 3] + more.sum::<f64>()
        };
        std::array::from_fn::<f64, MAPS, _>(bent)
    })
}

/// Somebody at home, and what the pad makes of it at a thousand samples a second.
struct Player {
    pad: TwinPad,
    hand: Hand,
    random: SplitMix64,
    gatherer: WindowCollector,
    around: Circumstances,
    at_s: f64,
}

impl Player {
    fn new(pad: &Pad) -> Self {
        let temperature_c = pad.device.behaviour.thermal.reference_c;
        Self {
            pad: TwinPad::new(&pad.device, &pad.field, pad.seed),
            hand: Hand::new(pad.device.behaviour.finger, pad.seed),
            random: SplitMix64::named(pad.seed, "player"),
            gatherer: WindowCollector::default(),
            around: Circumstances { temperature_c, cycles: 0.0 },
            at_s: 0.0,
        }
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.random.fraction())
    }

    fn sample(&mut self, contact: &Contact) {
        self.at_s += PERIOD_S;
        let uv = self.pad.read(PERIOD_S, contact, &self.around);
        // About what a decoder of another pad says: a quarter too much force, a millimetre off.
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
        let said = Contact {
            x_mm: x_mm + 0.7,
            y_mm: y_mm - 0.7,
            fx_n: 1.25 * fx_n,
            fy_n: 1.25 * fy_n,
            fz_n: 1.25 * fz_n,
        };
        let seen = if fz_n > 0.12 { SampleContext::Contact(said) } else { SampleContext::Nothing };
        self.gatherer.push(self.at_s, &uv, None, seen);
    }

    fn rest(&mut self, seconds: f64) {
        (0..(seconds / PERIOD_S) as usize).for_each(|_| self.sample(&Contact::default()));
    }

    fn press(&mut self, meant: &Contact, seconds: f64, is_finger: bool) {
        for step in 0..(seconds / PERIOD_S) as usize {
            let passed_s = step as f64 * PERIOD_S;
            let on = (passed_s / 0.04).min((seconds - passed_s) / 0.04).clamp(0.0, 1.0) as f32;
            let held = if is_finger { self.hand.hold(PERIOD_S, meant) } else { *meant };
            let [fx_n, fy_n, fz_n] = [held.fx_n, held.fy_n, held.fz_n].map(|n| on * n);
            self.sample(&Contact { fx_n, fy_n, fz_n, ..held });
        }
    }

    /// Ordinary play: directions and the middle, at most `within_mm` from it, taps and longer presses.
    fn play(&mut self, seconds: f64, within_mm: f64) {
        let end_s = self.at_s + seconds;
        self.rest(1.0);
        while self.at_s < end_s {
            let aim_mm = MARKS_MM[(self.random.next_bits() % 5) as usize];
            let [x, y] = aim_mm.map(|mm| mm + AIM_MM * f64::from(self.random.normal()));
            let inward = (within_mm / x.hypot(y)).min(1.0);
            let fz_n = (1.5 * (0.5 * f64::from(self.random.normal())).exp()).clamp(0.4, 5.0);
            let (shear_n, way) = (fz_n * self.between(0.0, 0.3), self.between(0.0, TAU));
            let [x_mm, y_mm, fx_n, fy_n, fz_n] =
                [inward * x, inward * y, shear_n * way.cos(), shear_n * way.sin(), fz_n].map(|it| it as f32);
            let seconds = self.between(0.15, 0.8);
            self.press(&Contact { x_mm, y_mm, fx_n, fy_n, fz_n }, seconds, true);
            let pause_s = self.between(0.15, 0.6);
            self.rest(pause_s);
        }
    }

    /// A weight on five marks, off them by a third of a millimetre.
    fn weigh(&mut self) -> Vec<Placement> {
        let place = |place_mm: [f64; 2]| {
            let [x_mm, y_mm] = place_mm.map(|mm| (mm + 0.35 * f64::from(self.random.normal())) as f32);
            let fz_n = (WEIGHT_G * G_N_PER_G) as f32;
            self.rest(1.0);
            let at_s = self.at_s + 1.0;
            self.press(&Contact { x_mm, y_mm, fz_n, ..Contact::default() }, 2.0, false);
            Placement { line: 0, at_s, place_mm, weight_g: WEIGHT_G }
        };
        let placements = MARKS_MM.map(place).to_vec();
        self.rest(1.0);
        placements
    }
}

/// Play and the weights, as windows.
fn recorded(pad: &Pad, seconds: f64, within_mm: f64) -> (Vec<Window>, Vec<Placement>) {
    let mut player = Player::new(pad);
    player.play(seconds, within_mm);
    let placements = player.weigh();
    (player.gatherer.finish(), placements)
}

fn at_home(windows: &[Window], placements: &[Placement]) -> AtHome {
    let (device, nominal) = (Device::nominal(), PadField::nominal());
    // The pads' fields are bent along the tangent, so no other pad's is asked for.
    let pad = SimulatedPad::known(&device, &nominal);
    calibrated(windows, placements, &pad, None, &|_, _| ()).unwrap()
}

/// How a pad is calibrated: twenty labels of a rig first, to which all others are compared.
#[derive(Clone, Copy, Debug)]
enum By {
    Rig,
    /// So many seconds of play out to so many millimetres, with a weight on five marks or without.
    Play {
        seconds: f64,
        within_mm: f64,
        is_weighed: bool,
    },
}

const RIG: (&str, By) = ("rig, 20 labels", By::Rig);
const HOME: (&str, By) = ("home", By::Play { seconds: 120.0, within_mm: 26.0, is_weighed: true });
const UNWEIGHED: (&str, By) =
    ("home, no weight", By::Play { seconds: 120.0, within_mm: 26.0, is_weighed: false });
const LONGER: (&str, By) = ("ten minutes", By::Play { seconds: 600.0, within_mm: 26.0, is_weighed: true });
const NEAR: (&str, By) = ("within 12 mm", By::Play { seconds: 120.0, within_mm: 12.0, is_weighed: true });
const WEIGHT_ALONE: (&str, By) =
    ("weight alone", By::Play { seconds: 2.0, within_mm: 26.0, is_weighed: true });

impl By {
    fn decoder(self, pad: &Pad) -> Decoder {
        let Self::Play { seconds, within_mm, is_weighed } = self else { return pad.by_rig(20) };
        let (windows, placements) = recorded(pad, seconds, within_mm);
        let found = at_home(&windows, if is_weighed { &placements } else { &[] });
        assert_eq!(found.knows_scale(), is_weighed);
        found.calibration.decoder()
    }
}

/// Errors of place and force over those of the rig's decoder, each the median and the worst of many pads, and the mean share inside
/// the regions.
#[derive(Debug)]
struct Compared {
    place: [f64; 2],
    force: [f64; 2],
    inside: f64,
}

impl Compared {
    fn of((name, by): (&str, By), pads: &[Pad], rig: &[[f64; 3]]) -> Self {
        let errors = errors((name, by), pads);
        // Of an even number of pads the worse of the two in the middle stands for the median.
        let both = |number: usize| {
            let mut ratios: Vec<f64> =
                errors.iter().zip(rig).map(|(it, rig)| it[number] / rig[number]).collect();
            ratios.sort_by(f64::total_cmp);
            [ratios[ratios.len() / 2], ratios[ratios.len() - 1]]
        };
        let inside = errors.iter().map(|it| it[2]).sum::<f64>() / errors.len() as f64;
        let compared = Self { place: both(0), force: both(1), inside };
        println!("{name}, over the rig's, median and worst: {compared:.3?}");
        compared
    }
}

fn errors((name, by): (&str, By), pads: &[Pad]) -> Vec<[f64; 3]> {
    let errors = |pad: &Pad| {
        let errors = pad.errors(&by.decoder(pad));
        let [mm, n, inside] = errors;
        println!("pad {:2}  {name:<16} {mm:.3} mm  {n:.4} N  {inside:.3} inside", pad.seed);
        errors
    };
    pads.iter().map(errors).collect()
}

/// The goal for the median is 1.3 and for the worst 2.2; one pad alone may be any of them.
fn is_worth_twenty_labels(home: &Compared) {
    assert!(home.place[1] <= 2.2 && home.force[1] <= 2.2, "{home:?}");
    assert!(home.inside > 0.88, "{home:?}");
}

#[test]
#[ignore = "proof: 20 s: what a calibration at home knows is tried below, and with the verb"]
fn two_minutes_of_play_and_a_weight_are_worth_twenty_labels() {
    let pads = [Pad::drawn(1)];
    let rig = errors(RIG, &pads);
    is_worth_twenty_labels(&Compared::of(HOME, &pads, &rig));
}

#[test]
#[ignore = "proof: 1020 s: twenty pads in six ways instead of one in two"]
fn two_minutes_of_play_and_a_weight_are_worth_twenty_labels_on_twenty_pads() {
    let pads: Vec<Pad> = (1..=20).map(Pad::drawn).collect();
    let rig = errors(RIG, &pads);
    let all = [HOME, UNWEIGHED, LONGER, NEAR, WEIGHT_ALONE].map(|by| Compared::of(by, &pads, &rig));
    let [home, unweighed, longer, near, weight_alone] = all;
    assert!(home.place[0] <= 1.3 && home.force[0] <= 1.3, "{home:?}");
    assert!(home.inside > 0.92, "{home:?}");
    assert!(longer.place[0] <= 1.15 && longer.force[0] <= 1.15, "{longer:?}");
    assert!(home.place[0] <= 0.85 * weight_alone.place[0], "{home:?} {weight_alone:?}");
    assert!(near.place[1] <= 2.2 && near.force[1] <= 2.2, "{near:?}");
    assert!(unweighed.place[1] <= 2.0, "{unweighed:?}");
    is_worth_twenty_labels(&home);
}

#[test]
#[ignore = "proof: 12 s: another play of two minutes; a calibration by play stays a test of the program"]
fn presses_near_the_middle_leave_the_rim_open() {
    let (windows, placements) = recorded(&Pad::drawn(1), 60.0, 8.0);
    let found = at_home(&windows, &placements);
    let regions = found.regions(&windows);
    let [middle, rim] = [&regions[0], &regions[7]];
    assert!(middle.presses > 100 && rim.presses == 0, "{regions:?}");
    assert!(rim.deviation_mm > 1.5 * middle.deviation_mm, "{regions:?}");
    let open = AtHome::open(&regions);
    assert!(open.iter().all(|region| region.name.ends_with("rim")), "{open:?}");
}
