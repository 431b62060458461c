//! Stories: whatever happens to a bridge, in whatever order, nothing stays down and a sound pad plays.
//!
//! A seed draws a story of fifty events and more around the real loop and the real pipeline, which have their clock, port and sink from
//! outside. What an event begins lasts until another one ends it, so that they overlap as they may. [`judge`] says what must hold.

mod cause;
mod event;
mod judge;
mod page;
mod past;
mod shrink;
mod world;

use std::panic::{AssertUnwindSafe, catch_unwind};

pub(super) use event::{AWAY, RIGHT};
use event::{Step, story};
use judge::{Broken, broken};
use shrink::shortest;
use world::{Played, World};

/// One story in so many is watched by a page.
const WATCHED: u64 = 16;

/// A story that broke an invariant.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Failure {
    step: usize,
    broken: Broken,
}

/// Plays a story; what it comes to, or by which step an invariant broke.
fn play(seed: u64, steps: &[Step], skips: bool) -> Result<Played, Failure> {
    let (mut world, mut step) = (World::new(seed, seed.is_multiple_of(WATCHED), skips), 0);
    let played = catch_unwind(AssertUnwindSafe(|| {
        steps.iter().enumerate().try_for_each(|(number, it)| {
            step = number;
            world.step(it)
        })
    }));
    let played = played.unwrap_or_else(|panic| {
        let text =
            panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        broken("nothing panics", text.unwrap_or_default())
    });
    played.map(|()| world.played()).map_err(|broken| Failure { step, broken })
}

/// A story that failed, and its shortest form, as a test has it.
fn told(seed: u64, steps: &[Step], failure: &Failure) -> String {
    let breaks =
        |steps: &[Step]| play(seed, steps, true).is_err_and(|it| it.broken.rule == failure.broken.rule);
    let shortest = shortest(&steps[..=failure.step], breaks);
    let shortly = play(seed, &shortest, true).unwrap_err();
    let lines: Vec<String> =
        shortest.iter().map(|step| format!("    ({}, {:?}),", step.after_ms, step.event)).collect();
    format!(
        "seed {seed}, step {}: {}: {}\nits shortest form, {}:\n{}",
        failure.step,
        failure.broken.rule,
        failure.broken.seen,
        shortly.broken.seen,
        lines.join("\n")
    )
}

/// Those of these stories that broke: the seed, and what is told of it.
fn broken_ones(seeds: impl Iterator<Item = u64>) -> Vec<(u64, String)> {
    let failure = |seed| {
        let steps = story(seed);
        play(seed, &steps, true).err().map(|failure| (seed, told(seed, &steps, &failure)))
    };
    seeds.filter_map(failure).collect()
}

#[test]
fn whatever_happens_nothing_stays_down_and_a_sound_pad_plays() {
    let broken = broken_ones(0..300);
    let told: Vec<&str> = broken.iter().map(|(_, told)| told.as_str()).collect();
    assert!(told.is_empty(), "{}", told.join("\n\n"));
}

#[test]
fn a_story_whose_quiet_stretches_are_skipped_goes_as_one_that_is_played_through() {
    let mut skipped = 0;
    for seed in 0..12 {
        let steps = story(seed);
        let outcome = |skips| play(seed, &steps, skips).map(|played| (played.edges, played.skipped_us));
        let (short, long) = (outcome(true).unwrap(), outcome(false).unwrap());
        assert_eq!(short.0, long.0, "seed {seed}");
        assert_eq!(long.1, 0);
        skipped += usize::from(short.1 > 0);
    }
    assert!(skipped > 0, "nothing was skipped");
}

#[test]
fn the_same_story_goes_the_same_way() {
    for seed in 0..4 {
        let steps = story(seed);
        assert_eq!(play(seed, &steps, true), play(seed, &steps, true), "seed {seed}");
    }
}

/// Goes on where this very program was broken off: `TACTPAD_STORIES` says how many, `TACTPAD_STORIES_FROM` from which seed.
#[test]
fn campaign() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let Some(count) = number("TACTPAD_STORIES") else { return };
    let from = number("TACTPAD_STORIES_FROM").unwrap_or(0);
    let program = std::env::current_exe().unwrap();
    let built = std::fs::metadata(&program).and_then(|it| it.modified()).unwrap();
    let built_s = built.duration_since(std::time::UNIX_EPOCH).unwrap().as_secs();
    // How many were played, and the seeds that broke.
    let place = program.parent().unwrap().join(format!("stories-from-{from}-{built_s}"));
    let text = std::fs::read_to_string(&place).unwrap_or_default();
    let mut numbers = text.split_whitespace().map(|word| word.parse::<u64>().unwrap());
    let done = numbers.next().unwrap_or(0);
    let mut seeds: Vec<u64> = numbers.collect();
    let threads = std::thread::available_parallelism().map_or(1, |threads| threads.get() as u64);
    for begin in (done..count).step_by(BLOCK) {
        let end = count.min(begin + BLOCK as u64);
        let broken: Vec<(u64, String)> = std::thread::scope(|scope| {
            let part =
                |part| broken_ones((from + begin..from + end).filter(move |seed| seed % threads == part));
            let parts: Vec<_> = (0..threads).map(|number| scope.spawn(move || part(number))).collect();
            parts.into_iter().flat_map(|part| part.join().unwrap()).collect()
        });
        for (seed, told) in broken {
            println!("{told}\n");
            seeds.push(seed);
        }
        let words: Vec<String> =
            std::iter::once(end).chain(seeds.iter().copied()).map(|it| it.to_string()).collect();
        std::fs::write(&place, words.join(" ")).unwrap();
        println!("{end} of {count} stories are played, {} broke", seeds.len());
    }
    assert!(seeds.is_empty(), "these stories broke: {seeds:?}");
}

/// So many stories are played before it is noted how far the campaign is.
const BLOCK: usize = 200;
