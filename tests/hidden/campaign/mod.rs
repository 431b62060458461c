//! The campaign: how often the program is right, over causes, sizes, plans and seeds.
//!
//! `TACTPAD_HIDDEN_CAMPAIGN=1 cargo test --release --test hidden campaign:: -- --nocapture` runs it, two cases at a time, and
//! shows how far it is. What came of each case is a line of `target/tmp/hidden/campaign-….jsonl`: broken off, it goes on where
//! it stopped, as long as program and generator are the same. At the end it prints the gates and writes a table and a
//! figure, `campaign.md` and `campaign.svg`, beside the lines.
//! `TACTPAD_HIDDEN_CAMPAIGN_SEEDS=N` makes it longer (5 otherwise), `TACTPAD_HIDDEN_CAMPAIGN_NULLS=N` has other than 400 nulls,
//! `TACTPAD_HIDDEN_CAMPAIGN_PARTS=nulls,sizes` runs only some parts. `TACTPAD_HIDDEN_CAMPAIGN_FIRST=N` begins at another seed than 1:
//! whatever is chosen by looking at results is chosen on seeds above 100, and published figures are of those from 1.

mod drawing;
mod gates;
mod lines;
mod parts;
mod report;

use std::env;
use std::ops::RangeInclusive;
use std::sync::Mutex;

use lines::Lines;
use parts::Job;

use crate::two;

/// How long the campaign is.
#[derive(Debug, Clone, Copy)]
struct Length {
    first: u64,
    seeds: u64,
    nulls: u64,
}

impl Length {
    /// So many seeds.
    fn seeds(self, count: u64) -> RangeInclusive<u64> {
        self.first..=self.first + count - 1
    }
}

fn number(name: &str, usual: u64) -> u64 {
    env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

#[test]
fn campaign() {
    if env::var_os("TACTPAD_HIDDEN_CAMPAIGN").is_none() {
        return;
    }
    let length = Length {
        first: number("TACTPAD_HIDDEN_CAMPAIGN_FIRST", 1),
        seeds: number("TACTPAD_HIDDEN_CAMPAIGN_SEEDS", 5),
        nulls: number("TACTPAD_HIDDEN_CAMPAIGN_NULLS", 400),
    };
    let wanted = env::var("TACTPAD_HIDDEN_CAMPAIGN_PARTS").unwrap_or_default();
    let lines = Lines::open(length.first);
    // Sizes come from the tables without a fault, so those are first.
    for part in parts::ALL {
        if wanted.is_empty() || wanted.split(',').any(|wanted| wanted == part.name || part.name == "least") {
            run(part.name, &(part.jobs)(length), &lines);
        }
    }
    let all = lines.all();
    let gates = gates::of(&all);
    println!("{}", report::written(&all, &gates));
    let failed: Vec<&gates::Gate> = gates.iter().filter(|gate| !gate.held).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Runs what has no line yet, two at a time.
fn run(part: &str, jobs: &[Job], lines: &Lines) {
    let open: Vec<&Job> = jobs.iter().filter(|job| lines.get(&job.key).is_none()).collect();
    println!("{part}: {} runs, {} of them still to do", jobs.len(), open.len());
    let progress = Mutex::new(0_usize);
    two::at_a_time(&open, |job| {
        lines.add((job.run)(lines), job);
        let mut done = progress.lock().unwrap();
        *done += 1;
        if done.is_multiple_of(10) || *done == open.len() {
            println!("{part}: {done} of {}", open.len());
        }
    });
}
