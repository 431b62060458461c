//! What the paper's dataset and a pad from the cache cost, from starting the program to the table on the disk:
//! `cargo bench --bench simulate`.
#![allow(clippy::unwrap_used, reason = "a bench that cannot set its scene fails")]

use std::fs;
use std::process::Command;

use criterion::{Criterion, criterion_group, criterion_main};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;

fn dataset(criterion: &mut Criterion) {
    let Ok(folder) = tempfile::tempdir() else { panic!("a temporary folder is needed") };
    let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    program.args(["simulate", "--dataset", "paper", "--json", "--out"]).arg(folder.path().join("paper.csv"));
    criterion.bench_function("14,400 contacts", |bencher| {
        bencher.iter(|| {
            let output = program.output();
            assert!(output.is_ok_and(|output| output.status.success()), "the program failed");
        });
    });
}

/// A device file, its field in the cache and one contact.
fn cached(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let text = Device::nominal().to_toml().replace("thickness_mm = 1.0 ", "thickness_mm = 1.15 ");
    let device = Device::from_toml(&text).0.unwrap();
    let bytes = PadField::nominal().to_bytes(&device);
    criterion.bench_function("a field's file, read and checked", |bencher| {
        bencher.iter(|| PadField::from_bytes(&bytes, &device).unwrap());
    });
    let cache = folder.path().join("tactpad");
    fs::create_dir_all(&cache).unwrap();
    fs::write(cache.join(format!("{:016x}.field", device.fingerprint())), &bytes).unwrap();
    fs::write(folder.path().join("d.toml"), text).unwrap();
    fs::write(folder.path().join("c.csv"), "x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,1\n").unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    program.args(["simulate", "--device", "d.toml", "--contacts", "c.csv", "--out", "o.csv"]);
    program.current_dir(folder.path()).env("XDG_CACHE_HOME", folder.path());
    criterion.bench_function("one contact, the field from the cache", |bencher| {
        bencher.iter(|| assert!(program.output().unwrap().status.success()));
    });
}

criterion_group!(benches, dataset, cached);
criterion_main!(benches);
