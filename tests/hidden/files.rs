//! Hidden cases as files, for people to look at and for the engine's development.
//!
//! `TACTPAD_HIDDEN_FILES=FOLDER cargo test --release --test hidden files:: -- --nocapture` writes them, with the truth
//! beside each. `TACTPAD_HIDDEN_SEEDS=A-B` says which seeds, `TACTPAD_HIDDEN_EFFECTS=a,b` which causes (`null` for none),
//! `TACTPAD_HIDDEN_TIMES=F` how large, `TACTPAD_HIDDEN_PLAN=paper|recommended|stream` on which plan, and
//! `TACTPAD_HIDDEN_QUALITY=drawn` draws background and noise, too.

use std::env;
use std::fs;
use std::path::Path;

use serde_json::json;

use crate::measured::{Quality, measured};
use crate::plan::{Plan, carry_out};
use crate::random::Random;
use crate::sizes;
use crate::truth::Truth;

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
            let quality = match setting("QUALITY", "stated").as_str() {
                "drawn" => Quality::drawn(&mut Random::new(seed, &format!("quality {effect}"))),
                _ => Quality::STATED,
            };
            let truth = (effect != "null")
                .then(|| sizes::drawn(effect, times, &mut Random::new(seed, &format!("size {effect}"))));
            write(Path::new(&folder), (effect, seed), plan, truth, &quality);
        }
    }
}

fn write(folder: &Path, (name, seed): (&str, u64), plan: Plan, truth: Option<Truth>, quality: &Quality) {
    let mut rows = plan.rows(seed, Path::new(env!("CARGO_TARGET_TMPDIR")));
    carry_out(&mut rows, &mut Random::new(seed, "course"));
    let truths: Vec<Truth> = truth.into_iter().collect();
    let own = seed.wrapping_mul(1000) + name.bytes().map(u64::from).sum::<u64>();
    let table = measured(rows, &truths, quality, &|_, _| {}, own);
    fs::write(folder.join(format!("{name}_{seed}.csv")), table.csv()).unwrap();
    if let [truth] = truths.as_slice() {
        let mut document = truth.json();
        document["plan"] = json!(plan.name());
        document["background"] = json!(quality.background);
        fs::write(folder.join(format!("{name}_{seed}.truth.json")), format!("{document}\n")).unwrap();
    }
}
