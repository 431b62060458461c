//! The bridge holds as much memory after a day as after its first minutes, whatever happened.

use tactpad_numeric::random::SplitMix64;

use super::stories::{AWAY, RIGHT};
use super::virtual_time::Play;

/// What it may hold more at some moment than at another: a list that was never as long before, a sentence that is to be told.
const BYTES_MAX: i64 = 4_096;
const ALLOCATIONS_MAX: i64 = 8;

/// A minute of play in which one thing goes wrong, which one is drawn.
fn minute(play: &mut Play, random: &mut SplitMix64) {
    let mut below = |end: u64| random.next_bits() % end;
    for _ in 0..12 {
        play.touch(&RIGHT, 50 + below(600));
        play.touch(&AWAY, 50 + below(1_000));
    }
    match below(7) {
        0 => {
            play.pull_out();
            play.wait(below(3_000));
            play.plug_in();
            (play.sequence, play.time_us) = (0, 0);
        }
        1 => play.stall(&AWAY, below(2_000)),
        2 => drop(play.starve(&RIGHT, below(2_000), None)),
        3 => drop(play.wait(below(20_000))),
        4 => {
            let noise: Vec<u8> = (0..below(5_000)).map(|_| below(256) as u8).collect();
            play.send_bytes(play.now, &noise);
        }
        5 => play.offset[below(9) as usize] += 100 * below(400_000) as i32 - 20_000_000,
        _ => play.offset = [0; 9],
    }
    // Longer than a fault is believed.
    play.touch(&AWAY, 15_000 + below(30_000));
    play.messages.0.lock().unwrap().clear();
}

/// `TACTPAD_MEMORY_MINUTES` says for how many minutes of virtual time, else it is twenty: 1440 are a day.
#[test]
fn memory_is_fixed_after_the_start() {
    let asked = std::env::var("TACTPAD_MEMORY_MINUTES").ok().and_then(|text| text.parse::<u32>().ok());
    let minutes = asked.unwrap_or(20);
    let (mut play, mut random) = (Play::start(), SplitMix64::named(1, "memory"));
    // Long enough for each list to have been as long as it gets.
    (0..20).for_each(|_| minute(&mut play, &mut random));
    let held = allocation_counter::measure(|| (0..minutes).for_each(|_| minute(&mut play, &mut random)));
    assert!(held.bytes_current <= BYTES_MAX && held.count_current <= ALLOCATIONS_MAX, "{held:?}");
    let health = play.bridge.driver.pipeline.health();
    assert!(health.samples > 1_000_000 && health.contacts > 100 && health.links_lost > 5, "{health:?}");
}
