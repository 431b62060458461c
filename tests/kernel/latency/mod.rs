//! How long an event takes from what causes it to a game's read: by the bridge, by the least that there can be, and by other programs.
//!
//! Writer, reader and processor are the same for all. All take turns in blocks of edges, in a drawn order, and each is alone while it
//! has its turn: whatever the machine does meanwhile happens to all. Only ratios mean anything outside this machine.

pub(crate) mod peers;
pub(crate) mod report;
mod way;

use tactpad::numeric::random::SplitMix64;

use crate::clock::MS;
use crate::program::Running;
use report::{Load, Measured, Row};
use way::{Contender, Way};

/// Edges of each in each load, where `TACTPAD_LATENCY_EDGES` names no other number.
const EDGES: usize = 1_000;

/// Edges in a turn.
const EDGES_PER_TURN: usize = 200;

/// Edges at the start of a turn that are not measured: a new program's pages come as it needs them.
const WARM_UP_EDGES: usize = 20;

/// What order and phases are drawn from.
const SEED: u64 = 20_261_129;

/// Before an edge nothing changes for at least so long, and for up to `PHASE_NS` longer. That is drawn, so edges have any phase to what
/// programs do periodically: frames come each millisecond, a device's state is repeated after five, the kernel's tick is ten.
const REST_NS: u64 = 2 * MS;
const PHASE_NS: u64 = 10 * MS;

/// In virtual time work takes none: only reading a clock does, a quarter of a microsecond. An edge that takes longer than
/// this was waiting for something.
const WAITED_NS: u64 = 100_000;

/// Between the pad's write and the game's read of an edge the bridge waits for nothing.
pub(crate) fn waits_for_nothing() {
    let mut bridge = Way::bridge();
    let edge_ns = |number| {
        let took_ns = bridge.edge(5 * MS);
        took_ns.unwrap_or_else(|_| panic!("edge {number} comes a millisecond after a frame"))
    };
    let longest_ns = (0..EDGES).map(edge_ns).max().expect("edges");
    println!("{EDGES} edges; the longest took {longest_ns} ns of virtual time");
    assert!(longest_ns <= WAITED_NS, "an edge took {longest_ns} ns, in which nobody worked");
}

/// Measures all, and prints what was seen for [`report::judge`].
pub(crate) fn measure() {
    let contenders: Vec<Contender> = way::ours_and_echoes().into_iter().chain(peers::contenders()).collect();
    let edges = std::env::var("TACTPAD_LATENCY_EDGES");
    let edges = edges.map_or(EDGES, |edges| edges.parse().expect("TACTPAD_LATENCY_EDGES is a number"));
    let mut random = SplitMix64::named(SEED, "latency");
    let mut took_ns = vec![[const { Vec::new() }; 2]; contenders.len()];
    let mut order: Vec<usize> = (0..contenders.len()).collect();
    let mut repeated = 0;
    for _ in 0..edges.div_ceil(EDGES_PER_TURN) {
        random.shuffle(&mut order);
        for place in &order {
            repeated += turn(&contenders[*place], &mut random, &mut took_ns[*place]);
        }
    }
    let rows = contenders.iter().zip(took_ns).flat_map(|(contender, took_ns)| {
        let of_load = move |(load, took_ns)| Row::new(contender.cause, contender.name, load, took_ns);
        Load::BOTH.into_iter().zip(took_ns).map(of_load)
    });
    let measured = Measured { seed: SEED, repeated, rows: rows.collect(), left_out: peers::left_out() };
    measured.say();
}

/// A turn of one: edges while nobody else has work, then as many while somebody does. How many had to be repeated, since the machine
/// stood still.
fn turn(contender: &Contender, random: &mut SplitMix64, took_ns: &mut [Vec<u64>; 2]) -> usize {
    let mut way = contender.start();
    let mut repeated = 0;
    for (load, took_ns) in Load::BOTH.into_iter().zip(took_ns) {
        let _spinner = (load == Load::Loaded).then(spin);
        let mut left = WARM_UP_EDGES + EDGES_PER_TURN;
        while left > 0 {
            let rest_ns = REST_NS + (f64::from(random.fraction()) * PHASE_NS as f64) as u64;
            match way.edge(rest_ns) {
                Ok(edge_ns) => {
                    took_ns.extend((left <= EDGES_PER_TURN).then_some(edge_ns));
                    left -= 1;
                }
                Err(way::Stalled) => {
                    repeated += 1;
                    drop(way);
                    way = contender.start();
                }
            }
        }
    }
    repeated
}

/// A process that always has work, with the same right to the processor as all others.
fn spin() -> Running {
    Running::start("sh", &["-c", "while :; do :; done"])
}
