//! From the fingertip: how long after the true force crosses a button's threshold its event comes, and how often one comes that nobody meant.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]
#![allow(clippy::disallowed_methods, reason = "a force may differ in its last bit from platform to platform")]
#![allow(clippy::print_stdout, reason = "the figures are what one looks for")]

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::{MessageReceiver, encode_message};
use firmware_proto::sample::Sample;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::contact::read;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::{NoProbe, Pipeline, shipped};
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::{Keyframe, Script};
use tactpad_numeric::random::SplitMix64;

const DURATION_US: u64 = 600_000_000;
const RELEASE_SHARE: f32 = 0.7;

/// How somebody presses: times are drawn evenly between two, forces about a median.
#[derive(Clone, Copy, Debug)]
struct Player {
    name: &'static str,
    /// The button's threshold, N.
    press_n: f32,
    /// Median of presses and of touches that are no press, as a share of the threshold.
    press_share: f32,
    touch_share: f32,
    /// The standard deviation of the logarithm of a force.
    spread: f32,
    /// The way of the force up or down, how long it stays, and what is between two, ms.
    ramp_ms: [f32; 2],
    stay_ms: [f32; 2],
    pause_ms: [f32; 2],
    /// The standard deviation of a held force, drawn anew every 50 ms, as a share of itself.
    tremor_share: f32,
}

const PLAYERS: [Player; 3] = [
    Player {
        name: "fast",
        press_n: 2.0,
        press_share: 1.5,
        touch_share: 0.6,
        spread: 0.2,
        ramp_ms: [15.0, 40.0],
        stay_ms: [40.0, 120.0],
        pause_ms: [50.0, 250.0],
        tremor_share: 0.02,
    },
    Player {
        name: "weak",
        press_n: 0.6,
        press_share: 1.4,
        touch_share: 0.6,
        spread: 0.2,
        ramp_ms: [60.0, 140.0],
        stay_ms: [100.0, 600.0],
        pause_ms: [150.0, 900.0],
        tremor_share: 0.03,
    },
    Player {
        name: "trembling",
        press_n: 1.5,
        press_share: 1.6,
        touch_share: 0.6,
        spread: 0.2,
        ramp_ms: [40.0, 120.0],
        stay_ms: [100.0, 800.0],
        pause_ms: [100.0, 600.0],
        tremor_share: 0.2,
    },
];

/// A press that is meant: well above the threshold.
struct Press {
    begin_us: u64,
    end_us: u64,
}

fn script(player: &Player, seed: u64) -> (Script, Vec<Press>) {
    let mut random = SplitMix64::named(seed, player.name);
    let (mut keyframes, mut meant) = (Vec::new(), Vec::new());
    let mut now_us = 1_000_000_u64;
    let mut put = |at_us: u64, fz_n: f32, place: [f32; 2]| {
        keyframes.push(Keyframe {
            at_us,
            contact: Contact { x_mm: place[0], y_mm: place[1], fz_n, ..Contact::default() },
        });
    };
    let us = |random: &mut SplitMix64, [a, b]: [f32; 2]| (1e3 * (a + (b - a) * random.fraction())) as u64;
    put(0, 0.0, [0.0; 2]);
    while now_us < DURATION_US - 3_000_000 {
        let place = [3.0 * random.normal(), 3.0 * random.normal()];
        let is_press = random.fraction() < 0.5;
        let share = if is_press { player.press_share } else { player.touch_share };
        let force = |random: &mut SplitMix64, share: f32| {
            (player.press_n * share * (player.spread * random.normal()).exp()).min(5.0)
        };
        // A touch that presses later, or only a touch.
        let force_n = force(&mut random, share);
        now_us += us(&mut random, player.pause_ms);
        put(now_us, 0.0, place);
        let begin_us = now_us;
        now_us += us(&mut random, player.ramp_ms);
        put(now_us, force_n, place);
        let stay_us = us(&mut random, player.stay_ms);
        let end_us = now_us + stay_us;
        while now_us + 50_000 < end_us {
            now_us += 50_000;
            put(now_us, force_n * (1.0 + player.tremor_share * random.normal()).max(0.2), place);
        }
        if is_press && force_n > 1.1 * player.press_n {
            meant.push(Press { begin_us, end_us: now_us });
        }
        now_us += us(&mut random, player.ramp_ms);
        put(now_us, 0.0, place);
    }
    (Script::of(keyframes), meant)
}

/// A filter of a profile: its window, and whether it adapts.
type Filter = (usize, bool);

/// A plain binding to the force.
fn profile(press_n: f32, (filter_samples, filter_adapts): Filter) -> Profile {
    let text = format!(
        "schema = 1\nname = \"fingertip\"\noutput = \"gamepad\"\nfilter_samples = {filter_samples}\nfilter_adapts = {filter_adapts}\nmin_press_ms = 0\n[[button]]\nforce = \"fz\"\npress_n = {press_n}\nrelease_n = {}\nout = {{ gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }}\n",
        press_n * RELEASE_SHARE
    );
    let (read, findings) = ReadProfile::read(&text, OutputChoice::AsWritten);
    read.unwrap_or_else(|| panic!("{findings:?}")).profile().clone()
}

/// Samples of a pad, and the true force at each.
fn samples(script: Script, seed: u64) -> (Message, Vec<(u64, Sample, f32)>) {
    let mut pad = VirtualPad::new(script, seed);
    pad.introduce();
    let mut identity = None;
    let (mut receiver, mut all) = (MessageReceiver::new(), Vec::new());
    let mut bytes = Vec::new();
    while pad.due_us() < DURATION_US {
        let at_us = pad.due_us();
        bytes.clear();
        pad.emit(at_us, &mut bytes);
        for byte in &bytes {
            match receiver.push(*byte) {
                Some(Ok(Message::Sample(sample))) => all.push((at_us, sample, pad.contact().fz_n)),
                Some(Ok(message)) => identity = Some(message),
                _ => {}
            }
        }
    }
    (identity.unwrap(), all)
}

/// What came of ten minutes of play.
struct Outcome {
    /// From the true crossing of the threshold to the sample whose event it is. What comes after is below 0.5 ms: docs/latency.md.
    delays_ms: Vec<f64>,
    /// Events with no crossing, and those of them at a force that never came within 5 % of the threshold.
    falses: usize,
    far: usize,
    missed: usize,
}

fn outcome(
    player: &Player,
    identity: &Message,
    samples: &[(u64, Sample, f32)],
    meant: &[Press],
    filter: Filter,
) -> Outcome {
    let decoder = read::playing(&shipped::bytes("inverse").unwrap()).unwrap();
    let mut pipeline = Pipeline::new(decoder, profile(player.press_n, filter));
    let (mut downs, mut frame) = (Vec::new(), [0; ENCODED_MAX]);
    let length = encode_message(identity, &mut frame);
    let _ = pipeline.apply(HostInstant::default(), Call::Bytes(&frame[..length]), &mut NoProbe);
    for (at_us, sample, _) in samples {
        let length = encode_message(&Message::Sample(*sample), &mut frame);
        let mut left = Some(Call::Bytes(&frame[..length]));
        while let Some(call) = left {
            left = pipeline.apply(HostInstant::default().plus_us(*at_us), call, &mut NoProbe);
            downs.extend(pipeline.events().iter().filter(|event| event.value == 1).map(|_| *at_us as f64));
        }
    }
    // True crossings.
    let (mut crossings, mut is_down) = (Vec::new(), false);
    for pair in samples.windows(2) {
        let ((t0, _, f0), (t1, _, f1)) = (pair[0], pair[1]);
        if !is_down && f1 >= player.press_n {
            is_down = true;
            crossings.push(t0 as f64 + (t1 - t0) as f64 * f64::from((player.press_n - f0) / (f1 - f0)));
        } else if is_down && f1 <= RELEASE_SHARE * player.press_n {
            is_down = false;
        }
    }
    let mut delays_ms = Vec::new();
    let mut used = vec![false; downs.len()];
    for crossing in &crossings {
        let near = downs
            .iter()
            .enumerate()
            .filter(|(i, down)| !used[*i] && **down - crossing > -10_000.0 && **down - crossing < 60_000.0)
            .min_by(|(_, a), (_, b)| (*a - crossing).abs().total_cmp(&(*b - crossing).abs()));
        if let Some((i, down)) = near {
            used[i] = true;
            delays_ms.push((down - crossing) / 1e3);
        }
    }
    let falses = used.iter().filter(|used| !**used).count();
    // One that nobody meant: the true force never came near.
    let far = downs
        .iter()
        .zip(&used)
        .filter(|(down, used)| {
            !**used && {
                let near = samples
                    .iter()
                    .filter(|(t, _, _)| (*t as f64 - **down).abs() < 30_000.0)
                    .map(|(_, _, f)| *f)
                    .fold(0.0, f32::max);
                near < 0.95 * player.press_n
            }
        })
        .count();
    let missed = meant
        .iter()
        .filter(|press| {
            !downs
                .iter()
                .any(|down| *down >= press.begin_us as f64 && *down <= press.end_us as f64 + 60_000.0)
        })
        .count();
    Outcome { delays_ms, falses, far, missed }
}

/// Filters that are shown, and that of the shipped profiles for such a player.
const SHOWN: [Filter; 9] = [
    (1, false),
    (2, false),
    (4, false),
    (6, false),
    (12, false),
    (3, true),
    (4, true),
    (6, true),
    (12, true),
];
const SHIPPED: [Filter; 3] = [(6, true), (3, true), (6, true)];

/// Windows were chosen on 1 to 3 and 11 to 13. What counts as a change was set anew after these were seen, against spikes.
const SEEDS: std::ops::RangeInclusive<u64> = 21..=23;

/// Half a percent of what was meant may be missed, and the event comes within so long of the crossing in 95 of 100, ms.
const MISSED_SHARE: f64 = 0.005;
const DELAY_MAX_MS: f64 = 4.0;

#[test]
#[ignore = "proof: 260 s: misses 4 ms at p95 for a trembling player by 0.3 ms: half an hour of three players, by each of nine filters"]
fn a_press_is_there_within_four_milliseconds_of_the_finger() {
    let mut unreached = Vec::new();
    for ((player, shipped), seed) in
        PLAYERS.iter().zip(SHIPPED).flat_map(|it| SEEDS.map(move |seed| (it, seed)))
    {
        let (script, meant) = script(player, seed);
        let (identity, samples) = samples(script, seed);
        for filter in SHOWN {
            let Outcome { mut delays_ms, falses, far, missed } =
                outcome(player, &identity, &samples, &meant, filter);
            delays_ms.sort_by(f64::total_cmp);
            let at = |share: f64| delays_ms[((delays_ms.len() - 1) as f64 * share) as usize];
            let [p50_ms, p95_ms, p99_ms] = [0.5, 0.95, 0.99].map(at);
            println!(
                "{} {seed}: {filter:?}: {p50_ms:.1} {p95_ms:.1} {p99_ms:.1} ms; {falses} not meant, {far} far from it; {missed} of {} missed",
                player.name,
                meant.len()
            );
            let is_reached =
                p95_ms <= DELAY_MAX_MS && missed as f64 <= MISSED_SHARE * meant.len() as f64 && far == 0;
            if filter == shipped && !is_reached {
                unreached.push((player.name, seed));
            }
        }
    }
    assert!(unreached.is_empty(), "{unreached:?}");
}
