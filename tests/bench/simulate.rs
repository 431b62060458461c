//! What the paper's dataset costs, from starting the program to the table on the disk: `cargo bench --bench simulate`.

use std::process::Command;

use criterion::{Criterion, criterion_group, criterion_main};

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

criterion_group!(benches, dataset);
criterion_main!(benches);
