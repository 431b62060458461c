//! Calibration from measured contacts, on pads whose truth is known: the inverse decoder beside what needs no physics.
//!
//! Proofs have all 648 contacts of the paper's plan, and two pads with faults of the field. Tests have a third of the contacts, and
//! one pad, and are held to the same bounds.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{LazyLock, Mutex, OnceLock};

use tactpad::lab::calibration::data::earlier::EarlierCalibration;
use tactpad::lab::calibration::fit::{Calibration, fit, fit_reported};
use tactpad::lab::calibration::regression::{neighbours, regression};
use tactpad::lab::calibration::result::numbers::{Number, Quantity};
use tactpad::lab::evaluation::{Errors, coverage95, decoded, errors};
use tactpad::lab::field_cache::solve;
use tactpad::lab::rig::bound::{Bound, ContactReading};
use tactpad::lab::rig::measurement::{Measurement, carry_out};
use tactpad::lab::scdf::adaptation::{adapt, examples};
use tactpad::lab::tangent::{SimulatedPad, Solve};
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::simulator::Simulator;
use tactpad::network::Zero;
use tactpad::numeric::memory::{PlayOperator, Relaxation};
use tactpad::pad::changes::{FieldChange, FieldChanges, Flaw};
use tactpad::pad::device::behaviour::{Crosstalk, OnChannels};
use tactpad::pad::device::{Device, Side};
use tactpad::pad::field::PadField;
use tactpad::pad::influence::{InfluenceField, MAPS};
use tactpad::pipeline::contact::regression::Target;
use tactpad::pipeline::contact::{Decoder, Method, read};
use tactpad::pipeline::shipped;
use tactpad::quantity::CHANNELS;
use tactpad::tables::measured::{Label, Row, Table};
use tactpad::tables::plans;
use tactpad::tables::recording::Recording;

/// As many contacts as make a calibration no better, and all of the plan.
const MANY: usize = 216;
const ALL: usize = 648;

fn field() -> &'static PadField {
    static FIELD: OnceLock<PadField> = OnceLock::new();
    FIELD.get_or_init(PadField::nominal)
}

/// The nominal pad with a sibling pad's gains, offsets, a little crosstalk, and noise: 1 % of a typical reading, and 1.3 %
/// of its own.
fn pad() -> Device {
    let mut device = Device::nominal();
    let gains = [[1.262, 1.331, 0.834], [1.285, 1.262, 0.994], [1.270, 1.330, 0.840]];
    for (module, gain) in device.modules.iter_mut().zip(gains) {
        (module.gain, module.offset_uv) = (gain, [300.0, -200.0, 500.0]);
    }
    device.behaviour.crosstalk = vec![Crosstalk { channel: 5, with: 2, share: 0.02 }];
    device.behaviour.noise.additive_uv = [60.0; CHANNELS];
    (device.behaviour.noise.share, device.behaviour.noise.share_time_s) = ([0.013; CHANNELS], 3.0);
    device
}

/// What the twin measured, as a decoder takes it, and the truths.
struct Measured {
    recording: Recording,
    truths: Vec<Label>,
}

impl Measured {
    fn of(device: &Device, plan: &Table, seed: u64) -> Self {
        Self::on(field(), device, plan, seed)
    }

    fn on(field: &PadField, device: &Device, plan: &Table, seed: u64) -> Self {
        let Measurement { table, truth: truths, .. } = carry_out(plan, device, field, seed);
        Self { recording: Recording::of(table, device.contact.full_scale_n).unwrap(), truths }
    }

    /// Contacts of the paper's plan.
    fn calibration(device: &Device) -> Self {
        Self::of(device, &plans::paper::plan(&device.contact), 1)
    }

    /// Others.
    fn unseen(device: &Device) -> Self {
        Self::of(device, &plans::recommended::plan(&device.contact, 9), 2)
    }

    /// So many of the contacts, all over the plate.
    fn some(&self, count: usize) -> Vec<usize> {
        let places = self.recording.contacts();
        (0..count).map(|index| places[index * 251 % places.len()]).collect()
    }

    fn inverse(&self, count: usize) -> Calibration {
        fit(&self.recording, &self.some(count), &Device::nominal(), field(), None).unwrap()
    }

    /// The same, begun with another pad's decoder.
    fn from(&self, count: usize, earlier: &Decoder) -> Decoder {
        let earlier = EarlierCalibration::of(earlier);
        assert!(earlier.is_some(), "only an inverse decoder tells of its pad");
        let found = fit(&self.recording, &self.some(count), &Device::nominal(), field(), earlier);
        found.unwrap().decoder()
    }

    fn rows(&self, count: usize) -> Vec<Row> {
        self.some(count).iter().map(|at| self.recording.tared().rows[*at]).collect()
    }

    /// Contacts as the decoder takes them, and their truths.
    fn taken(&self, decoder: &Decoder) -> (Vec<Row>, Vec<Label>) {
        let freed = self.recording.taken(decoder);
        self.recording.contacts().iter().map(|at| (freed.rows[*at], self.truths[*at])).unzip()
    }
}

fn inverse(measured: &Measured, count: usize) -> Decoder {
    measured.inverse(count).decoder()
}

fn wrench(measured: &Measured, count: usize) -> Decoder {
    regression(&measured.rows(count), Zero::Tared, Target::Wrench, 29.0).unwrap().into()
}

/// The shipped network after its stage II.
fn network(measured: &Measured) -> Decoder {
    let shipped = read::decoder(&shipped::bytes("scdf").unwrap()).unwrap();
    let Method::Network(start) = shipped.method else { panic!("scdf is a network") };
    let rows = measured.recording.tared().rows_at(&measured.recording.contacts());
    let adapted = adapt(&start, examples(&rows), 1, |_, _| ()).unwrap();
    adapted.trained.network.into()
}

/// What [`pad`] was measured to be, its contacts and others, and the decoder of all contacts: several tests begin there.
struct Calibrated {
    measured: Measured,
    unseen: Measured,
    decoder: Decoder,
}

static CALIBRATED: LazyLock<Calibrated> = LazyLock::new(|| {
    let device = pad();
    let (measured, unseen) = (Measured::calibration(&device), Measured::unseen(&device));
    let decoder = inverse(&measured, ALL);
    Calibrated { measured, unseen, decoder }
});

fn errors_of(decoder: &Decoder, measured: &Measured) -> Errors {
    let (rows, truths) = measured.taken(decoder);
    errors(&decoded(decoder, &rows), &truths)
}

/// Errors of place and force beside the least that the pad's noise allows.
fn beyond_bound(device: &Device, field: &PadField, errors: &Errors, measured: &Measured) -> [f64; 2] {
    let contacts: Vec<Label> = measured.recording.contacts().iter().map(|at| measured.truths[*at]).collect();
    let [x_mm, y_mm, fx_n, fy_n, fz_n] =
        Bound::new(device, field, 1).expected(&contacts, ContactReading::Mean);
    [2.0 * errors.position_mae_mm / (x_mm + y_mm), 3.0 * errors.force_mae_n / (fx_n + fy_n + fz_n)]
}

fn is_several_times_better_than_what_needs_no_physics(counts: &[usize]) {
    let device = pad();
    let Calibrated { measured, unseen, decoder } = &*CALIBRATED;
    let said = |name: &str, errors: &Errors| {
        println!("{name}: {:.3} mm, {:.4} N", errors.position_mae_mm, errors.force_mae_n);
    };
    for count in counts.iter().copied() {
        let by_inverse = if count == ALL { decoder.clone() } else { inverse(measured, count) };
        let [by_inverse, by_wrench] = [by_inverse, wrench(measured, count)].map(|it| errors_of(&it, unseen));
        said(&format!("inverse, {count}"), &by_inverse);
        said(&format!("wrench, {count}"), &by_wrench);
        // With 73 contacts and more both places are as good as the noise allows; the force still gains.
        let share = if count == 20 { 0.6 } else { 1.0 };
        assert!(by_inverse.position_mae_mm < share * by_wrench.position_mae_mm);
        assert!(by_inverse.force_mae_n < 0.6 * by_wrench.force_mae_n);
        let [place, force] = beyond_bound(&device, field(), &by_inverse, unseen);
        println!("inverse, {count}: {place:.2} and {force:.2} of the least that the noise allows");
        if count > 73 {
            assert!(place < 1.3 && force < 1.3);
        }
    }
    let rows = measured.rows(ALL);
    let linear = regression(&rows, Zero::Tared, Target::Contact, 29.0).unwrap().into();
    said("linear", &errors_of(&linear, unseen));
    said("neighbours", &errors_of(&neighbours(&rows, Zero::Tared).unwrap().into(), unseen));
}

#[test]
fn the_inverse_is_several_times_better_than_what_needs_no_physics() {
    is_several_times_better_than_what_needs_no_physics(&[20, ALL]);
}

#[test]
#[ignore = "proof: 10 s: four counts of contacts instead of two"]
fn the_inverse_is_several_times_better_with_any_count_of_contacts() {
    is_several_times_better_than_what_needs_no_physics(&[20, 73, MANY, ALL]);
}

#[test]
fn it_says_how_sure_it_is() {
    let Calibrated { unseen, decoder, .. } = &*CALIBRATED;
    let (rows, truths) = unseen.taken(decoder);
    let covered = coverage95(decoder, &rows, &truths).unwrap();
    // The rig is perfect here, and the regions hold the doubt of one that may not be.
    assert!((0.92..=0.99).contains(&covered), "{covered}");
}

fn hysteresis_is_found(counts: [(usize, f64); 2]) {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    device.behaviour.hysteresis = vec![OnChannels::all(PlayOperator { threshold: 800.0, share: 0.0625 })];
    let (measured, unseen) = (Measured::calibration(&device), Measured::unseen(&device));
    for (count, allowed_uv) in counts {
        let calibration = measured.inverse(count);
        let kept = |channel: usize| {
            let plays = calibration.compensation.hysteresis.iter();
            plays.map(|plays| plays[channel].share * plays[channel].threshold).sum::<f64>()
        };
        println!("{count}: kept at rest {:.1?} µV", std::array::from_fn::<f64, CHANNELS, _>(kept));
        // With what leaks from another channel, which keeps its own.
        let gain = |channel: usize| device.modules[channel / 3].gain[channel % 3];
        let leaks = |into: usize| {
            let into = device.behaviour.crosstalk.iter().filter(move |it| it.channel == into);
            into.map(|it| it.share * gain(it.with)).sum::<f64>()
        };
        let truly = |channel: usize| 50.0 * (gain(channel) + leaks(channel));
        assert!((0..CHANNELS).all(|channel| (kept(channel) - truly(channel)).abs() < allowed_uv));
        let [by_inverse, by_wrench] =
            [calibration.decoder(), wrench(&measured, count)].map(|it| errors_of(&it, &unseen));
        assert!(by_inverse.position_mae_mm < 0.5 * by_wrench.position_mae_mm, "{by_inverse:?}");
        assert!(by_inverse.force_mae_n < 0.4 * by_wrench.force_mae_n, "{by_inverse:?}");
    }
}

#[test]
fn hysteresis_is_found_and_taken_off() {
    hysteresis_is_found([(20, 12.0), (MANY, 4.0)]);
}

#[test]
#[ignore = "proof: 6 s: all contacts of the plan instead of a third"]
fn hysteresis_is_found_and_taken_off_with_all_contacts() {
    hysteresis_is_found([(20, 12.0), (ALL, 4.0)]);
}

/// With twenty it is nearly as good as with so many.
fn needs_twenty_contacts(many: usize) {
    let mut other = pad();
    for (k, gain) in other.modules.iter_mut().flat_map(|module| &mut module.gain).enumerate() {
        *gain *= 1.0 + 0.1 * [1.0, -0.4, 0.2, -1.3, 0.6, 0.9, -0.7, -0.2, 1.1][k];
    }
    other.behaviour.crosstalk = vec![Crosstalk { channel: 1, with: 8, share: -0.015 }];
    let earlier = &CALIBRATED.decoder;
    let (measured, unseen) = (Measured::calibration(&other), Measured::unseen(&other));
    let [few, all] =
        [measured.from(20, earlier), inverse(&measured, many)].map(|decoder| errors_of(&decoder, &unseen));
    println!("20: {few:?}\n{many}: {all:?}");
    assert!(few.position_mae_mm < 1.5 * all.position_mae_mm);
    assert!(few.force_mae_n < 1.5 * all.force_mae_n);
}

#[test]
#[ignore = "proof: 7 s: what pads share is taken over, which stays a test"]
fn another_pad_of_the_kind_needs_twenty_contacts() {
    needs_twenty_contacts(MANY);
}

#[test]
#[ignore = "proof: 8 s: beside all contacts of the plan instead of a third"]
fn another_pad_of_the_kind_needs_twenty_contacts_and_not_all() {
    needs_twenty_contacts(ALL);
}

/// Root mean square of errors over stated deviations: of poses and of frames.
fn stated(calibration: &Calibration, device: &Device) -> f64 {
    let off = |it: &Number| {
        let Quantity::Physical(number) = it.quantity else { return None };
        let is_asked = number.parameter.name().ends_with("frame_e_factor") || it.expected == 0.0;
        is_asked.then(|| (it.value - number.parameter.get(device)) / it.deviation)
    };
    let off: Vec<f64> = calibration.numbers.iter().filter_map(off).collect();
    assert_eq!(off.len(), 18);
    (off.iter().map(|off| off * off).sum::<f64>() / 18.0).sqrt()
}

/// A simulator on a coarse mesh. Of the program's own a pad takes half a minute; of fits this one tells the same, as long as all fields
/// of a test are its own.
static COARSE: LazyLock<Mutex<Simulator>> =
    LazyLock::new(|| Mutex::new(Simulator::new(Fineness::STANDARD.scaled(2.8))));

fn coarse(device: &Device) -> Option<PadField> {
    COARSE.lock().unwrap().field(device).ok()
}

static COARSE_NOMINAL: LazyLock<PadField> = LazyLock::new(|| coarse(&Device::nominal()).unwrap());

/// With this simulator, and the nominal pad's field by it. Beside it, if that is asked for, stands what the tangent alone comes to.
fn is_calibrated_about_its_own_field(solve: Solve<'_>, field: &PadField, is_compared: bool) {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    (device.modules[0].tangential_mm, device.modules[0].rotation_deg) = (2.0, -8.0);
    device.modules[2].frame_e_factor = 0.5;
    let own = solve(&device).unwrap();
    let measured = Measured::on(&own, &device, &plans::paper::plan(&device.contact), 1);
    let unseen = Measured::on(&own, &device, &plans::recommended::plan(&device.contact, 9), 2);
    let (nominal, solved) = (Device::nominal(), AtomicUsize::new(0));
    let changes = FieldChanges::nominal();
    let counted = |device: &Device| {
        solved.fetch_add(1, Ordering::Relaxed);
        solve(device)
    };
    let tried = |solve: Solve<'_>| {
        let pad = SimulatedPad { solve, flaws: &changes.0, ..SimulatedPad::known(&nominal, field) };
        let found = fit_reported(&measured.recording, &measured.some(216), &pad, None, &|_, _| ()).unwrap();
        (stated(&found, &device), errors_of(&found.decoder(), &unseen), found.flaw)
    };
    let about_own = tried(&counted);
    println!("about its own field {about_own:?}");
    assert!((1..=2).contains(&solved.into_inner()) && about_own.2.is_none());
    assert!(about_own.0 < 1.0);
    if is_compared {
        let on_tangent = tried(&|_| None);
        println!("on the tangent {on_tangent:?}");
        assert!(on_tangent.0 > 1.5 * about_own.0);
        assert!(about_own.1.position_mae_mm < on_tangent.1.position_mae_mm);
    }
    let [place, force] = beyond_bound(&device, &own, &about_own.1, &unseen);
    assert!(place < 1.3 && force < 1.3, "{place} {force}");
}

#[test]
#[ignore = "proof: 15 s: a pad of another program's field is calibrated about it, which stays a test"]
fn a_pad_that_the_tangent_does_not_reach_is_calibrated_about_its_own_field() {
    is_calibrated_about_its_own_field(&coarse, &COARSE_NOMINAL, false);
}

#[test]
#[ignore = "proof: 30 s: fields on the program's own mesh instead of a coarse one, and beside what the tangent comes to"]
fn a_pad_that_the_tangent_does_not_reach_is_calibrated_about_its_own_fine_field() {
    is_calibrated_about_its_own_field(&solve, field(), true);
}

/// The flaw that is fitted to a pad of this device and field, by a program that knows this nominal field, and that flaws change it so.
fn fitted_flaw(
    own: &PadField,
    device: &Device,
    known: &PadField,
    flaws: &[FieldChange],
) -> Option<(usize, Flaw)> {
    let nominal = Device::nominal();
    let measured = Measured::on(own, device, &plans::paper::plan(&device.contact), 1);
    let pad = SimulatedPad { flaws, ..SimulatedPad::known(&nominal, known) };
    fit_reported(&measured.recording, &measured.some(216), &pad, None, &|_, _| ()).unwrap().flaw
}

fn noisy() -> Device {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    device
}

fn with_open_frame() -> Device {
    let mut open = noisy();
    open.modules[1].frame_open = Some(Side::MinusX);
    open
}

#[test]
#[ignore = "proof: 20 s: four solutions on a coarse mesh; that channels which leak are no open frame stays a test"]
fn a_module_whose_frame_is_open_is_told_from_one_whose_channels_leak() {
    let nominal = Device::nominal();
    let mut simulator = COARSE.lock().unwrap();
    let whole = simulator.pad(&nominal).unwrap().signals();
    let mut change = |side| simulator.change(&nominal, &whole, Flaw::FrameOpen(side)).unwrap();
    let changes = Side::ALL.map(&mut change);
    drop(simulator);
    let (device, known) = (with_open_frame(), &COARSE_NOMINAL);
    let own = coarse(&device).unwrap();
    assert_eq!(fitted_flaw(&own, &device, known, &changes), Some((1, Flaw::FrameOpen(Side::MinusX))));
    assert_eq!(fitted_flaw(&own, &device, known, &[]), None);
}

#[test]
fn a_module_whose_channels_leak_has_no_open_frame() {
    // What an open frame on one side looks like: its x channel has a quarter of its z channel.
    let mut leaking = noisy();
    leaking.behaviour.crosstalk.push(Crosstalk { channel: 3, with: 5, share: 0.25 });
    assert_eq!(fitted_flaw(field(), &leaking, field(), &FieldChanges::nominal().0), None);
}

#[test]
#[ignore = "proof: 30 s: fields on the program's own mesh instead of a coarse one, and bonds that come off as well"]
fn a_module_whose_frame_is_open_is_told_from_any_other_whose_channels_leak() {
    let (device, changes) = (with_open_frame(), FieldChanges::nominal().0);
    let own = solve(&device).unwrap();
    assert_eq!(fitted_flaw(&own, &device, field(), &changes), Some((1, Flaw::FrameOpen(Side::MinusX))));
    assert_eq!(fitted_flaw(&own, &device, field(), &[]), None);
}

/// The nominal field with faults that a calibration has no number for: a plate
/// that bends more towards one side, and waves of 1.5 % of each channel.
fn faulty(seed: u32) -> PadField {
    let nominal = field();
    let mut draws = 1000 * seed;
    // Kronecker's sequence of the golden ratio.
    let mut fraction = || {
        draws += 1;
        (f64::from(draws) * 0.618_033_988_749_894_9).fract()
    };
    let signals = &nominal.signals;
    let size = |map: usize| {
        let places =
            (-28..=28).flat_map(|x| (-28..=28).map(move |y| (x, y))).filter(|(x, y)| x * x + y * y < 29 * 29);
        let squares: Vec<f64> =
            places.map(|(x, y)| signals.gains(x as f32, y as f32).value[map / 3][map % 3].powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let mut wave = || {
        let (angle, length_mm) = (TAU * fraction(), 25.0 + 30.0 * fraction());
        [TAU * angle.cos() / length_mm, TAU * angle.sin() / length_mm, TAU * fraction()]
    };
    let waves: Vec<[[f64; 3]; 3]> = (0..MAPS).map(|_| [wave(), wave(), wave()]).collect();
    let sizes: Vec<f64> = (0..MAPS).map(size).collect();
    let wrong = InfluenceField::sampled(f64::from(signals.spacing_mm()), 29.0, 29.0, |[x, y]| {
        let gains = signals.gains(x as f32, y as f32).value;
        std::array::from_fn::<f64, MAPS, _>(|map| {
            let ripple: f64 = waves[map].iter().map(|[kx, ky, phase]| (kx * x + ky * y + phase).sin()).sum();
            gains[map / 3][map % 3] * (1.0 + 0.03 * x / 29.0)
                + 0.015 * sizes[map] * ripple * (2.0_f64 / 3.0).sqrt()
        })
    });
    PadField { signals: wrong, sums: nominal.sums.clone(), sensitivities: Vec::new() }
}

/// The pad on a stage that is turned by 1° and long by 1 %. Unseen contacts are where they really are.
fn on_a_wrong_stage(device: &Device) -> Device {
    let mut device = device.clone();
    (device.behaviour.rig.stage_rotation_deg, device.behaviour.rig.stage_scale) = (1.0, 1.01);
    device
}

/// On a pad with such faults, and with so many contacts.
fn is_no_worse_than_a_wrench(seed: u32, many: usize) {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    device.behaviour.hysteresis = vec![OnChannels::all(PlayOperator { threshold: 800.0, share: 0.03 })];
    let field = faulty(seed);
    let measured = Measured::on(&field, &on_a_wrong_stage(&device), &plans::paper::plan(&device.contact), 1);
    let unseen = Measured::on(&field, &device, &plans::recommended::plan(&device.contact, 9), 2);
    let [by_few, by_all] = [20, many].map(|count| errors_of(&inverse(&measured, count), &unseen));
    for (count, by_inverse, share) in [(20, &by_few, 1.0), (many, &by_all, 0.75)] {
        let by_wrench = errors_of(&wrench(&measured, count), &unseen);
        let [place, force] = [
            by_inverse.position_mae_mm / by_wrench.position_mae_mm,
            by_inverse.force_mae_n / by_wrench.force_mae_n,
        ];
        println!("seed {seed}, {count} contacts: {place:.2} and {force:.2} of the wrench's; {by_inverse:?}");
        assert!(place < share && force < share, "{place} {force}");
    }
    let by_network = errors_of(&network(&measured), &unseen);
    let [place, force] =
        [by_all.position_mae_mm / by_network.position_mae_mm, by_all.force_mae_n / by_network.force_mae_n];
    println!("seed {seed}, {many} contacts: {place:.2} and {force:.2} of the network's");
    // The noise alone leaves 0.28 of the network's force error, and whether the reference has a gain of its own is open.
    assert!(place < 0.36 && force < 0.55, "{place} {force}");
}

#[test]
#[ignore = "proof: 10 s: the same faults are in what pads share, which stays a test"]
fn faults_that_it_has_no_number_for_do_not_make_it_worse_than_a_wrench() {
    is_no_worse_than_a_wrench(1, MANY);
}

#[test]
#[ignore = "proof: 25 s: two pads instead of one, with all contacts of the plan"]
fn faults_that_it_has_no_number_for_do_not_make_it_worse_than_a_wrench_with_all_contacts() {
    is_no_worse_than_a_wrench(1, ALL);
    is_no_worse_than_a_wrench(2, ALL);
}

#[test]
#[ignore = "proof: 10 s: two pads are calibrated, one with all contacts of the plan"]
fn what_pads_share_beyond_the_simulation_is_taken_over() {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    let field = faulty(3);
    let plan = plans::paper::plan(&device.contact);
    let earlier = inverse(&Measured::on(&field, &on_a_wrong_stage(&device), &plan, 1), ALL);
    device.modules[1].gain = [1.1, 0.9, 1.2];
    let measured = Measured::on(&field, &on_a_wrong_stage(&device), &plan, 3);
    let unseen = Measured::on(&field, &device, &plans::recommended::plan(&device.contact, 9), 2);
    let [with, without] =
        [measured.from(20, &earlier), inverse(&measured, 20)].map(|decoder| errors_of(&decoder, &unseen));
    assert!(with.position_mae_mm < 0.7 * without.position_mae_mm);
    assert!(with.force_mae_n < 0.7 * without.force_mae_n);
}

fn zeros_that_nobody_read_are_found(counts: [(usize, f64); 2]) {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    device.behaviour.hysteresis = vec![OnChannels::all(PlayOperator { threshold: 800.0, share: 0.05 })];
    let mut plan = plans::paper::plan(&device.contact);
    plan.rows.retain(|row| row.label.fz_n > 0.0);
    let Measurement { table, .. } = carry_out(&plan, &device, field(), 1);
    assert!(Recording::of(table.clone(), device.contact.full_scale_n).is_none());
    let recording = Recording::raw(table, device.contact.full_scale_n);
    let rows = recording.contacts();
    let unseen = Measured::unseen(&device);
    for (count, allowed_uv) in counts {
        let few: Vec<usize> = (0..count).map(|index| rows[index * 251 % rows.len()]).collect();
        let calibration = fit(&recording, &few, &Device::nominal(), field(), None).unwrap();
        let found_uv = calibration.compensation.zero_uv.unwrap();
        println!("{count}: {found_uv:.0?}");
        let offsets = device.modules.iter().flat_map(|module| module.offset_uv);
        assert!(found_uv.iter().zip(offsets).all(|(found, offset)| (found - offset).abs() < allowed_uv));
        let decoder = calibration.decoder();
        let errors = errors_of(&decoder, &unseen);
        println!("{count}: {errors:?}");
        assert!(errors.position_mae_mm < 0.3 && errors.force_mae_n < 0.04);
    }
}

#[test]
fn a_pad_whose_zeros_nobody_read_is_calibrated_all_the_same() {
    zeros_that_nobody_read_are_found([(20, 25.0), (MANY, 8.0)]);
}

#[test]
#[ignore = "proof: 8 s: all contacts of the plan instead of a third"]
fn a_pad_whose_zeros_nobody_read_is_calibrated_all_the_same_with_all_contacts() {
    zeros_that_nobody_read_are_found([(20, 25.0), (ALL, 8.0)]);
}

/// What the twin measures at these temperatures, one after the other.
fn warmed(device: &Device, plan: &Table, temperatures: &[f64], seed: u64) -> Measured {
    let mut plan = plan.clone();
    let length = plan.rows.len().div_ceil(temperatures.len());
    for (rows, temp_c) in plan.rows.chunks_mut(length).zip(temperatures) {
        rows.iter_mut().for_each(|row| row.temp_c = Some(*temp_c));
    }
    Measured::of(device, &plan, seed)
}

#[test]
fn creep_is_found_where_there_is_some() {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    let contacts = 100;
    let plan = plans::recommended::plan(&device.contact, 9);
    let creep_of =
        |device: &Device, seed| Measured::of(device, &plan, seed).inverse(contacts).compensation.creep;
    assert_eq!(creep_of(&device, 2), Relaxation::NONE);
    device.behaviour.creep = vec![OnChannels::all(Relaxation { time_s: 8.0, share: 0.008 })];
    // What 20 s add to 2 s, the plan's dwells, over what they truly do: of one recording two relaxation times may be as likely.
    let grown =
        |creep: Relaxation| creep.share * ((-2.0 / creep.time_s).exp() - (-20.0 / creep.time_s).exp());
    let truly = grown(Relaxation { time_s: 8.0, share: 0.008 });
    let mut found = [2, 3, 4].map(|seed| grown(creep_of(&device, seed)) / truly);
    found.sort_by(f64::total_cmp);
    assert!((found[1] - 1.0).abs() < 0.3, "{found:?}");
}

#[test]
fn two_recordings_tell_how_it_follows_the_temperature() {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    let thermal = &mut device.behaviour.thermal;
    thermal.zero_uv_per_c = std::array::from_fn(|k| 30.0 + 10.0 * k as f64);
    thermal.gain_per_c = std::array::from_fn(|k| 2e-4 + 1e-4 * k as f64);
    let truly = *thermal;
    let plan = plans::paper::plan(&device.contact);
    let [cool, warm] = [25.0, 40.0].map(|temp_c| warmed(&device, &plan, &[temp_c], 1).recording);
    let once = fit(&cool, &cool.contacts(), &Device::nominal(), field(), None).unwrap();
    assert!(once.thermal.is_none());
    let both = cool.then(warm);
    let calibration = fit(&both, &both.contacts(), &Device::nominal(), field(), None).unwrap();
    let found = calibration.thermal.unwrap();
    let near = |found: &[f64], deviations: [f64; CHANNELS], truly: [f64; CHANNELS], allowed: f64| {
        let numbers = found.iter().zip(deviations).zip(truly);
        numbers
            .into_iter()
            .all(|((found, deviation), truly)| (found - truly).abs() < 4.0 * deviation && deviation < allowed)
    };
    assert!(near(&found.coefficients.zero_uv_per_c, found.zero_deviation.unwrap(), truly.zero_uv_per_c, 2.0));
    assert!(near(&found.coefficients.gain_per_c, found.gain_deviation.unwrap(), truly.gain_per_c, 1e-4));
    // Other temperatures, and the untouched pad is read at the first of them alone.
    let mut plan = plans::paper::plan(&device.contact);
    let mut at = 0..;
    plan.rows.retain(|row| at.next() == Some(0) || row.label.fz_n > 0.0);
    let unseen = warmed(&device, &plan, &[20.0, 32.0, 45.0], 5);
    let places = unseen.recording.contacts();
    let errors_with = |decoder: &Decoder| {
        let rows = unseen.recording.taken(decoder).rows_at(&places);
        let truths: Vec<Label> = places.iter().map(|at| unseen.truths[*at]).collect();
        errors(&decoded(decoder, &rows), &truths)
    };
    let [with, without] = [&calibration, &once].map(|it| errors_with(&it.decoder()));
    println!("with {with:?}\nwithout {without:?}");
    assert!(with.position_mae_mm < 0.3 && with.force_mae_n < 0.04);
    assert!(without.position_mae_mm > 1.0 && without.force_mae_n > 0.2);
}
