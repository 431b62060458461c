//! One hidden case for each cause, nulls, several causes at once, causes of no catalogue, and confounded pairs.
//!
//! Seeds are 1, 2, 3 …, whatever comes of them: gates are on the whole set.

use serde_json::Value;

use crate::case::{Case, Outside};
use crate::plan::{Plan, Room};
use crate::random::Random;
use crate::score::{Found, Score};
use crate::sizes::{CAUSES, best_plan, drawn};
use crate::truth::Truth;

fn run(case: &Case) -> (Value, Score) {
    let diagnosis = case.diagnosed(&[]).unwrap_or_else(|said| panic!("{}: {said}", case.key));
    let score = Score::of(&diagnosis, &case.truths);
    println!("{}: {} {}", case.key, case.truth(), score.json());
    (diagnosis, score)
}

fn truth(effect: &str, seed: u64) -> Truth {
    drawn(effect, 1.0, &mut Random::new(seed, effect))
}

/// Each cause, once for each of so many seeds. Of a dozen cases one may go astray: 95 % and 2 % are the campaign's gates.
fn are_found<'c>(causes: impl Iterator<Item = &'c &'c str> + Clone, rounds: u64, may: usize) {
    let (mut missed, mut wrong) = (Vec::new(), Vec::new());
    for seed in 1..=rounds {
        for effect in causes.clone() {
            let truths = vec![truth(effect, seed)];
            let case = Case::new(&format!("one-{effect}-{seed}"), seed, best_plan(effect), truths);
            let (_, score) = run(&case);
            if !score.complete() {
                missed.push(case.key.clone());
            }
            wrong.extend(score.wrong.iter().map(|wrong| format!("{}: {wrong}", case.key)));
        }
    }
    assert!(missed.len() <= may, "missed: {missed:#?}");
    assert!(wrong.len() <= may, "wrong names: {wrong:#?}");
}

/// In a channel, in a module, in the rig, and one that needs time. (The gain that this seed hides is the one case that goes astray;
/// gains are found below.)
#[test]
fn a_hidden_effect_of_each_kind_is_found() {
    are_found(
        ["channel_offset", "channel_intermittent", "module_rotated", "stage_offset", "thermal_zero"].iter(),
        1,
        0,
    );
}

#[test]
#[ignore = "proof: 50 s: every other cause of the catalogue"]
fn hidden_effects_are_found() {
    are_found(CAUSES.iter().step_by(2), 1, 1);
}

#[test]
#[ignore = "proof: 50 s: every other cause of the catalogue"]
fn more_hidden_effects_are_found() {
    are_found(CAUSES.iter().skip(1).step_by(2), 1, 1);
}

#[test]
#[ignore = "proof: 200 s: every cause with two seeds"]
fn hidden_effects_are_found_twice() {
    are_found(CAUSES.iter(), 2, 4);
}

/// How many of so many sound pads alarm; two plans take turns.
fn alarms(count: u64) -> Vec<String> {
    let null = |seed: u64| {
        let plan = Plan::BOTH[seed as usize % 2];
        Case::new(&format!("null-{seed}"), seed, plan, Vec::new())
    };
    (1..=count).map(null).filter(|case| run(case).1.alarm).map(|case| case.key).collect()
}

#[test]
fn a_pad_without_a_fault_does_not_alarm() {
    assert_eq!(alarms(1), Vec::<String>::new());
}

#[test]
#[ignore = "proof: 25 s: ten sound pads instead of one"]
fn pads_without_a_fault_seldom_alarm() {
    let alarms = alarms(10);
    assert!(alarms.len() <= 2, "{alarms:?}");
}

#[test]
#[ignore = "proof: 100 s: forty sound pads instead of one"]
fn many_pads_without_a_fault_seldom_alarm() {
    let alarms = alarms(40);
    assert!(alarms.len() <= 5, "{alarms:?}");
}

#[test]
#[ignore = "proof: 10 s: two causes beside those of each kind, which stay a test"]
fn two_effects_at_once_are_both_found() {
    for (seed, pair) in
        [["channel_gain", "stage_offset"], ["module_rotated", "channel_crosstalk"]].iter().enumerate()
    {
        let seed = seed as u64 + 1;
        let truths = pair.map(|effect| truth(effect, seed)).to_vec();
        let (diagnosis, score) = run(&Case::new(&format!("pair-{seed}"), seed, Plan::Recommended, truths));
        assert!(score.complete() && score.wrong.is_empty(), "{pair:?}: {score:?}");
        // Each finding's own worth stands under its own name.
        let gain = &diagnosis["gain"];
        for (finding, worth) in
            diagnosis["findings"].as_array().unwrap().iter().zip(gain["per_cause"].as_array().unwrap())
        {
            assert_eq!(
                (&finding["effect"], &finding["target"]),
                (&worth["effect"], &worth["target"]),
                "{gain}"
            );
        }
        for effect in pair {
            let of = |it: &&Value| it["effect"] == *effect;
            let worth = gain["per_cause"].as_array().unwrap().iter().find(of).unwrap();
            assert!(worth["rmse_ratio_without"].as_f64() > gain["rmse_ratio"].as_f64(), "{effect}: {gain}");
        }
    }
}

/// No pad creeps by a third. Where all loads are held equally long a common gain looks like creep, but not one that large.
#[test]
#[ignore = "proof: 5 s: a cause beside those of each kind, which stay a test"]
fn gains_beyond_what_creep_can_be_are_found() {
    let gain = |effect: &str, target: &str, value: f64| Truth::new(effect, target, &[("gain", value)]);
    let truths = vec![
        gain("excitation_gain", "pad", 1.35),
        gain("channel_gain", "m0z", 0.75),
        gain("channel_gain", "m2z", 0.76),
    ];
    let (_, score) = run(&Case::new("gains", 1, Plan::Paper, truths));
    assert!(score.complete() && score.wrong.is_empty(), "{score:?}");
    assert_eq!(score.found[1..], [Found::Named, Found::Named], "{score:?}");
    assert_eq!(score.verdict, "explained");
}

#[test]
fn what_no_catalogue_has_stays_unnamed() {
    for (seed, outside) in [(1, Outside::Dent), (2, Outside::Product)] {
        let case = Case { outside, ..Case::new(&format!("outside-{seed}"), seed, Plan::Paper, Vec::new()) };
        let (_, score) = run(&case);
        assert!(score.wrong.is_empty(), "{outside:?}: {:?}", score.wrong);
        assert!(score.unnamed_share > 0.0, "{outside:?}: {score:?}");
        assert!(
            ["unexplained", "partly_explained"].contains(&score.verdict.as_str()),
            "{outside:?}: {score:?}"
        );
    }
}

/// The truth is in a set, with the measurement that separates it.
fn confounded(case: &Case) {
    let (diagnosis, score) = run(case);
    assert!(matches!(score.found[0], Found::InSet(size) if size > 1), "{}: {score:?}", case.key);
    assert!(score.wrong.is_empty(), "{}: {score:?}", case.key);
    let separated =
        diagnosis["findings"].as_array().unwrap().iter().any(|finding| !finding["separate_by"].is_null());
    assert!(separated, "{}: {diagnosis}", case.key);
}

fn resolved(case: &Case) {
    let (_, score) = run(case);
    assert_eq!(score.found[0], Found::Named, "{}: {score:?}", case.key);
    assert!(score.wrong.is_empty(), "{}: {score:?}", case.key);
}

/// In a room that only gets warmer, drift in time and a zero that follows the temperature are the same.
#[test]
#[ignore = "proof: 8 s: two causes beside those of each kind, which stay a test"]
fn drift_and_warmth_are_told_apart_by_a_room_that_cools_again() {
    let mut case = Case::new("warming", 1, Plan::Recommended, vec![truth("thermal_zero", 1)]);
    case.room = Room::Warming;
    confounded(&case);
    case.room = Room::UpAndDown;
    resolved(&case);
}

/// Where every contact is held equally long, creep is a gain.
#[test]
#[ignore = "proof: 5 s: drift and warmth, a pair of the same kind, stay a test"]
fn creep_and_gain_are_told_apart_by_two_dwells() {
    // Three times the plain size: less does not show beside what the simulator and the reference may be off.
    let truth = drawn("creep", 3.0, &mut Random::new(2, "creep"));
    let mut case = Case::new("held", 2, Plan::Paper, vec![truth]);
    confounded(&case);
    case.plan = Plan::Recommended;
    resolved(&case);
}
