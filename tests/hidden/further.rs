//! Causes that one measurement does not tell apart, and the further measurement that the program asks for: carried out by the generator,
//! both tables together must tell.

use std::fs;
use std::path::PathBuf;

use crate::case::Case;
use crate::measured::{Measured, Seeds, measured};
use crate::plan::{Plan, Row, read};
use crate::program::diagnosed_together;
use crate::random::Random;
use crate::score::{Found, Score};
use crate::truth::Truth;
use crate::two;

/// What came of a pad: after the first measurement and after the further one, and how long that took.
struct Outcome {
    name: String,
    first: Score,
    both: Score,
    minutes: f64,
}

/// The first rows of a table, and the others.
fn split(table: Measured, first: usize) -> [Measured; 2] {
    let Measured { mut rows, mut labels, mut channels, columns } = table;
    let further = Measured {
        rows: rows.split_off(first),
        labels: labels.split_off(first),
        channels: channels.split_off(first),
        columns,
    };
    [Measured { rows, labels, channels, columns }, further]
}

/// Measures a pad with these faults, then what is asked for, until nothing is: three times at most.
fn told(name: &str, plan: Plan, seed: u64, truths: &[Truth]) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let case = Case::new(name, seed, plan, truths.to_vec());
    let mut rows: Vec<Row> = case.rows();
    // How many rows each measurement has.
    let mut counts = vec![rows.len()];
    let mut minutes = 0.0;
    let mut scores: Vec<Score> = Vec::new();
    loop {
        let seeds = Seeds { pad: seed, recording: seed };
        // One pad, with its background in all rows.
        let mut rest = measured(rows.clone(), truths, &case.quality, &|_, _| (), seeds);
        rest.columns = case.columns;
        let files: Vec<PathBuf> =
            (0..counts.len()).map(|at| folder.path().join(format!("measured-{at}.csv"))).collect();
        for (at, (count, file)) in counts.iter().zip(&files).enumerate() {
            let [mut own, others] = split(rest, *count);
            rest = others;
            let random = &mut Random::new(seed, &format!("zeros {at}"));
            let zeros: [f64; 9] = std::array::from_fn(|_| if at == 0 { 0.0 } else { 8.0 * random.normal() });
            for row in &mut own.channels {
                row.iter_mut().zip(zeros).for_each(|(uv, zero)| *uv += zero);
            }
            fs::write(file, own.csv()).unwrap();
        }
        let plan = folder.path().join(format!("next-{}.csv", files.len()));
        let (diagnosis, next) = diagnosed_together(&files, &plan);
        scores.push(Score::of(&diagnosis, truths));
        let Some(next) = next.filter(|_| scores.len() < 3) else { break };
        minutes += diagnosis["next"]["minutes"].as_f64().unwrap();
        let further = read(&next);
        counts.push(further.len());
        rows.extend(further);
    }
    let both = scores.last().unwrap().clone();
    println!("{name}: {} -> {} in {minutes:.0} min", scores[0].json(), both.json());
    Outcome { name: name.to_owned(), first: scores.remove(0), both, minutes }
}

fn is_named(score: &Score) -> bool {
    score.found.iter().all(|found| *found == Found::Named)
}

fn gain(effect: &str, target: &str, gain: f64) -> Truth {
    Truth::new(effect, target, &[("gain", gain)])
}

/// The gain of the force sensor, which contacts do not tell from that of the supply; weights do.
#[test]
fn weights_that_the_program_asks_for_tell_whose_a_gain_is() {
    let found = told("further", Plan::Recommended, 1, &[gain("reference_gain", "rig", 1.05)]);
    assert!(!is_named(&found.first), "{}: nothing is open", found.name);
    assert!(is_named(&found.both) && found.both.wrong.is_empty(), "{}", found.both.json());
    assert!(found.minutes <= 30.0, "{} minutes", found.minutes);
    assert_eq!(found.both.intervals[0], found.both.intervals[1]);
}

/// Seeds were fixed before the first run.
#[test]
#[ignore = "proof: 600 s: gains of force sensor and supply alone and beside a stage that is off, on both plans"]
fn what_is_open_is_told_by_what_the_program_asks_for() {
    let jobs: Vec<(Plan, u64, &str)> = Plan::BOTH
        .into_iter()
        .flat_map(|plan| (2001..=2004).map(move |seed| (plan, seed)))
        .flat_map(|(plan, seed)| ["reference_gain", "excitation_gain"].map(|effect| (plan, seed, effect)))
        .collect();
    let outcomes = two::at_a_time(&jobs, |(plan, seed, effect)| {
        let random = &mut Random::new(*seed, effect);
        let size = random.between(0.03, 0.06);
        let size = if random.below(2) == 0 { size } else { -size };
        let target = if *effect == "reference_gain" { "rig" } else { "pad" };
        let mut truths = vec![gain(effect, target, 1.0 + size)];
        if seed % 2 == 0 {
            let angle = random.between(0.0, 360.0).to_radians();
            let [x_mm, y_mm] = [0.4 * angle.cos(), 0.4 * angle.sin()];
            truths.push(Truth::new("stage_offset", "rig", &[("x_mm", x_mm), ("y_mm", y_mm)]));
        }
        told(&format!("{}-{effect}-{seed}", plan.name()), *plan, *seed, &truths)
    });
    let named = outcomes.iter().filter(|it| is_named(&it.both)).count();
    let wrong: Vec<&String> = outcomes.iter().flat_map(|it| &it.both.wrong).collect();
    let open = outcomes.iter().filter(|it| !is_named(&it.first)).count();
    let [stated, held] = [0, 1].map(|at| outcomes.iter().map(|it| it.both.intervals[at]).sum::<usize>());
    println!(
        "{open} open at first; then {named} of {} named, wrong {wrong:?}, {held} of {stated} intervals",
        outcomes.len()
    );
    assert!(named * 10 >= 9 * outcomes.len() && wrong.is_empty(), "{named} named, wrong: {wrong:?}");
}
