//! Hidden cases as files, for people to look at and for the engine's development.
//!
//! `TACTPAD_HIDDEN_FILES=FOLDER cargo test --release --test hidden files:: -- --nocapture` writes them, with the truth
//! beside each. `TACTPAD_HIDDEN_SEEDS=A-B` says which seeds, `TACTPAD_HIDDEN_EFFECTS=a,b` which causes (`null` for none),
//! `TACTPAD_HIDDEN_TIMES=F` how large, `TACTPAD_HIDDEN_PLAN=paper|recommended|stream` on which plan, and
//! `TACTPAD_HIDDEN_QUALITY=drawn` draws background and noise, too.

use std::env;
use std::fs;
use std::path::Path;

use crate::case::Case;
use crate::measured::Quality;
use crate::plan::Plan;
use crate::random::Random;
use crate::sizes;

#[test]
fn cases_as_files() {
    let Ok(folder) = env::var("TACTPAD_HIDDEN_FILES") else {
        return;
    };
    let setting = |name: &str, normal: &str| {
        env::var(format!("TACTPAD_HIDDEN_{name}")).unwrap_or_else(|_| normal.to_owned())
    };
    fs::create_dir_all(&folder).unwrap();
    let seeds = setting("SEEDS", "1-3");
    let (first, last) = seeds.split_once('-').unwrap_or((&seeds, &seeds));
    let times: f64 = setting("TIMES", "1").parse().unwrap();
    let plan = match setting("PLAN", "paper").as_str() {
        "recommended" => Plan::Recommended,
        "stream" => Plan::Stream,
        _ => Plan::Paper,
    };
    let causes = setting("EFFECTS", "null");
    for effect in causes.split(',') {
        for seed in first.parse().unwrap()..=last.parse().unwrap() {
            let truth = (effect != "null")
                .then(|| sizes::drawn(effect, times, &mut Random::new(seed, &format!("size {effect}"))));
            let mut case = Case::new(&format!("{effect}_{seed}"), seed, plan, truth.into_iter().collect());
            if setting("QUALITY", "stated") == "stated" {
                case.quality = Quality::STATED;
            }
            write(Path::new(&folder), &case);
        }
    }
}

fn write(folder: &Path, case: &Case) {
    fs::write(folder.join(format!("{}.csv", case.key)), case.table(0).csv()).unwrap();
    let mut document = case.truth();
    if let [truth] = case.truths.as_slice() {
        for (key, value) in truth.json().as_object().unwrap() {
            document[key] = value.clone();
        }
        fs::write(folder.join(format!("{}.truth.json", case.key)), format!("{document}\n")).unwrap();
    }
}
