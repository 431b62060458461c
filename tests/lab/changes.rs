//! What changed since an earlier play, or since a calibration: twins whose change is known, and twins that did not change but were
//! played by another hand.
//!
//! Pads are those of `home`, with their friction, creep, restless finger and lasting noise. The later play goes on with the state
//! that an earlier one left; after a calibration the pad begins anew.
//!
//! With `TACTPAD_CHANGES=N` N pads of each kind are played, from the seed `TACTPAD_CHANGES_FROM` on, for ten minutes each, and the
//! tables of docs/diagnosis.md are printed; `TACTPAD_CHANGES_SINCE=play`, `home` or `rig` asks for one of them.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use std::sync::LazyLock;

use tactpad::lab::diagnosis::data::target::Target;
use tactpad::lab::diagnosis::report::Finding;
use tactpad::lab::effect::Effect;
use tactpad::lab::play::change::{Before, DetectedChanges, changed};
use tactpad::lab::play::reader::Reader;
use tactpad::lab::play::windows::Window;
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::simulator::{PLATE_DEGREE, Simulator};
use tactpad::numeric::zernike::jets;
use tactpad::pad::changes::{FieldChange, FieldChanges, Flaw};
use tactpad::pad::device::{Device, Side};
use tactpad::pad::field::PadField;
use tactpad::pad::influence::{InfluenceField, MAPS};
use tactpad::pad::twin::life::Life;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::reader::CaptureReader;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::mapping::read::shipped as profiles;
use tactpad::pipeline::shipped;
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::freehand::{play, presses};
use tactpad::virtual_pad::recording::record;
use tactpad::virtual_pad::script::Script;

use super::home::Pad;

const GAIN: f64 = 0.92;
/// None of the shares that [`FieldChanges`] keep: what looks for it interpolates, and the pad does not.
const LOST_SHARE: f64 = 0.3;
/// Half the mean square of the distance at which a wider finger's force acts from its place, beyond that of the first one.
const WIDER_MM2: f64 = 1.5;
const WITHIN_MM: f32 = 26.0;

/// What the pad's channels lose by the bond that has come off, solved anew.
static LOST: LazyLock<FieldChange> = LazyLock::new(|| {
    let mut simulator = Simulator::new(Fineness::STANDARD);
    let device = Device::nominal();
    let whole = simulator.pad(&device).unwrap().signals();
    simulator.change(&device, &whole, Flaw::Debonded(Side::PlusX, LOST_SHARE)).unwrap()
});

/// What happens between the plays.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    ModuleGain,
    Debonded,
    Nothing,
    /// Another player, another game, a wider finger.
    OtherHand,
}

impl Kind {
    const ALL: [Self; 4] = [Self::ModuleGain, Self::Debonded, Self::Nothing, Self::OtherHand];

    /// The cause that should be named.
    fn cause(self) -> Option<(Effect, Target)> {
        match self {
            Self::ModuleGain => Some((Effect::ModuleGain, Target::Module(1))),
            Self::Debonded => Some((Effect::ModuleDebonded, Target::ModuleSide(0, Side::PlusX))),
            Self::Nothing | Self::OtherHand => None,
        }
    }

    /// The later pad.
    fn pad(self, Pad { device, field, .. }: &Pad) -> (Device, PadField) {
        let mut device = device.clone();
        if self == Self::ModuleGain {
            device.modules[1].gain = device.modules[1].gain.map(|gain| GAIN * gain);
        }
        let signals = &field.signals;
        let (spacing_mm, reach_mm) = (f64::from(signals.spacing_mm()), f64::from(signals.radius_mm()));
        let plate_mm = device.plate.radius_mm();
        let maps = |place_mm: [f64; 2]| {
            let gains = signals.gains(place_mm[0] as f32, place_mm[1] as f32).value;
            let (laplacian, jets) =
                (signals.laplacian(place_mm), jets(PLATE_DEGREE, place_mm.map(|mm| mm / plate_mm)));
            std::array::from_fn::<f64, MAPS, _>(|map| {
                let (channel, axis) = (map / 3, map % 3);
                gains[channel][axis]
                    + match self {
                        Self::Debonded => LOST.maps[channel][axis].value(&jets),
                        Self::OtherHand => WIDER_MM2 * laplacian[channel][axis],
                        Self::ModuleGain | Self::Nothing => 0.0,
                    }
            })
        };
        let signals = InfluenceField::sampled(spacing_mm, reach_mm, reach_mm, maps);
        (device, PadField { signals, ..field.clone() })
    }

    fn script(self, is_later: bool, duration_us: u64, seed: u64) -> Script {
        match (self, is_later) {
            (Self::OtherHand, true) if seed.is_multiple_of(2) => presses(duration_us, WITHIN_MM, seed + 500),
            (Self::OtherHand, true) => {
                play(profile("vitetris").profile(), duration_us, WITHIN_MM, seed + 500)
            }
            (_, true) => play(profile("super-mario").profile(), duration_us, WITHIN_MM, seed + 1_000),
            (_, false) => play(profile("super-mario").profile(), duration_us, WITHIN_MM, seed),
        }
    }
}

fn profile(name: &str) -> ReadProfile {
    ReadProfile::read(profiles::text(name).unwrap(), OutputChoice::AsWritten).0.unwrap()
}

/// The pad as it was.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Since {
    Play,
    /// Two minutes of play at home and a weight.
    Home,
    /// Sixty labels of a rig.
    Rig,
}

impl Since {
    const ALL: [(&str, Self); 3] = [("play", Self::Play), ("home", Self::Home), ("rig", Self::Rig)];
}

/// Windows of a play, as of a capture, and the pad's life after it.
fn played(
    script: Script,
    (device, field): (&Device, &PadField),
    life: Life,
    (end_us, seed): (u64, u64),
) -> (Vec<Window>, Life) {
    let mut pad = VirtualPad::going_on(script, device, field, life, seed);
    let head = Head {
        decoder: shipped::bytes(shipped::INVERSE).map(Into::into),
        profile: Some(profile("super-mario")),
    };
    let mut capture = CaptureWriter::begin(Vec::new(), HostInstant::default(), &head).unwrap();
    pad.introduce();
    record(&mut pad, end_us, &mut capture, |_, _| Ok(())).unwrap();
    let bytes = std::mem::take(capture.get_mut());
    let mut capture = CaptureReader::new(bytes.as_slice()).unwrap();
    let decoder = capture.head().read_decoder().unwrap();
    let mut reader = Reader::new(decoder, profile("super-mario").profile().clone());
    while let Some(call) = capture.next_call() {
        let (now, call) = call.unwrap();
        reader.apply(now, call);
    }
    (reader.finish(), pad.into_life())
}

fn compared(kind: Kind, since: Since, seconds: u64, seed: u64) -> DetectedChanges {
    let pad = Pad::drawn(seed);
    let end_us = 1_000_000 * seconds;
    let mut life = Life::new(&pad.device, seed);
    let (mut earlier, mut decoder) = (Vec::new(), None);
    match since {
        Since::Play => {
            let first = (kind.script(false, end_us, seed), (&pad.device, &pad.field));
            (earlier, life) = played(first.0, first.1, life, (end_us, seed));
        }
        Since::Home => decoder = Some(pad.by_play(120.0)),
        Since::Rig => decoder = Some(pad.by_rig(60)),
    }
    let (device, field) = kind.pad(&pad);
    let script = kind.script(true, end_us, seed);
    let (later, _) = played(script, (&device, &field), life, (end_us, seed + 1_000));
    let before = decoder.as_ref().map_or(Before::Play(&earlier), Before::Decoder);
    let (device, field) = (Device::nominal(), PadField::nominal());
    let found = changed(before, &later, &device, &field, &FieldChanges::nominal().0, &|_, _| ()).unwrap();
    let told: Vec<String> = found.findings.iter().map(told).collect();
    println!(
        "pad {seed:3}  {kind:?} since {since:?}: {:?} presses, inflation {:.2}, least gain {:.4}; {}",
        found.presses,
        found.inflation,
        found.least_module_gain,
        told.join("; ")
    );
    found
}

fn told(it: &Finding) -> String {
    let numbers: Vec<String> = it
        .parameters
        .iter()
        .map(|it| format!("{} {:.3} ({:.3} to {:.3})", it.name, it.value, it.interval95[0], it.interval95[1]))
        .collect();
    let side = it.target.side().map(|side| side.name()).unwrap_or_default();
    let others: Vec<String> =
        it.confounded_with.iter().map(|(effect, target)| format!("{effect} {target}")).collect();
    format!("{} {}{side} {} p {:.0e} or {others:?}", it.effect, it.target, numbers.join(", "), it.p_value)
}

/// How often a kind's cause was named, was in a set, was missed, and how often something else was named.
#[derive(Debug, Default)]
struct Rates {
    named: usize,
    in_set: usize,
    missed: usize,
    wrong: usize,
}

fn rates(kind: Kind, since: Since, seconds: u64, seeds: std::ops::Range<u64>) -> Rates {
    let mut rates = Rates::default();
    for seed in seeds {
        let DetectedChanges { findings, .. } = compared(kind, since, seconds, seed);
        let is_right = |it: &Finding| Some((it.effect, it.target)) == kind.cause();
        let is_in =
            |it: &Finding| is_right(it) || it.confounded_with.iter().any(|it| Some(*it) == kind.cause());
        let is_named = |it: &Finding| it.confounded_with.is_empty();
        rates.named += usize::from(findings.iter().any(|it| is_right(it) && is_named(it)));
        rates.in_set += usize::from(findings.iter().any(|it| is_in(it) && !is_named(it)));
        rates.missed += usize::from(!findings.iter().any(is_in));
        rates.wrong += usize::from(findings.iter().any(|it| !is_right(it) && is_named(it)));
    }
    println!("{kind:?} since {since:?}: {rates:?}");
    rates
}

#[test]
fn what_did_not_change_is_not_named() {
    let asked = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    if let Some(pads) = asked("TACTPAD_CHANGES") {
        let from = asked("TACTPAD_CHANGES_FROM").unwrap_or(1);
        let only = std::env::var("TACTPAD_CHANGES_SINCE").ok();
        let wanted = Since::ALL.into_iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name));
        for (_, since) in wanted {
            for kind in Kind::ALL {
                rates(kind, since, 600, from..from + pads);
            }
        }
        return;
    }
    is_named(Since::Play, &[Kind::OtherHand]);
}

/// What changed, and nothing else.
fn is_named(since: Since, kinds: &[Kind]) {
    for kind in kinds {
        let rates = rates(*kind, since, 150, 1..2);
        assert_eq!(rates.wrong, 0, "{kind:?}");
        assert!(kind.cause().is_none() || rates.missed == 0, "{kind:?}");
    }
}

#[test]
#[ignore = "proof: 100 s: all kinds of changes since a play, a calibration at home and one by a rig, instead of another hand alone; the program's own tests have a module that lost gain since a play, and since a rig"]
fn whatever_changed_is_named_and_what_did_not_is_not() {
    is_named(Since::Play, &Kind::ALL);
    is_named(Since::Home, &Kind::ALL);
    is_named(Since::Rig, &[Kind::ModuleGain, Kind::Nothing]);
}
