//! What came of the cases, one line of JSON each, kept between runs.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Mutex;

use serde_json::{Value, json};

use super::parts::Job;
use crate::program::folder;

/// The file, and what it holds by key.
#[derive(Debug)]
pub(super) struct Lines {
    file: Mutex<File>,
    known: Mutex<BTreeMap<String, Value>>,
}

/// One file for each program, generator and first seed: what another one found is not taken over.
fn place(first: u64) -> PathBuf {
    let programs = [PathBuf::from(env!("CARGO_BIN_EXE_tactpad")), std::env::current_exe().unwrap()];
    let bytes = programs.into_iter().flat_map(|program| fs::read(program).unwrap());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    folder("").join(format!("campaign-{hash:016x}-{first}.jsonl"))
}

impl Lines {
    /// Takes up the file where it was left. A line that was broken off in writing is not one.
    pub(super) fn open(first: u64) -> Self {
        let place = place(first);
        let text = fs::read_to_string(&place).unwrap_or_default();
        let line = |line: &str| {
            let value: Value = serde_json::from_str(line).ok()?;
            Some((value["key"].as_str()?.to_owned(), value))
        };
        let known: BTreeMap<String, Value> = text.lines().filter_map(line).collect();
        let mut file = OpenOptions::new().create(true).append(true).open(place).unwrap();
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").unwrap();
        }
        Self { file: Mutex::new(file), known: Mutex::new(known) }
    }

    pub(super) fn get(&self, key: &str) -> Option<Value> {
        self.known.lock().unwrap().get(key).cloned()
    }

    pub(super) fn add(&self, mut line: Value, job: &Job) {
        line["key"] = json!(job.key);
        line["part"] = json!(job.part);
        line["plan"] = json!(job.plan.name());
        line["effect"] = json!(job.effect);
        self.file.lock().unwrap().write_all(format!("{line}\n").as_bytes()).unwrap();
        self.known.lock().unwrap().insert(job.key.clone(), line);
    }

    pub(super) fn all(&self) -> Vec<Value> {
        self.known.lock().unwrap().values().cloned().collect()
    }
}
