//! Samples that come late, and frames from the past, as often as one likes.

use proptest::prelude::{ProptestConfig, Strategy, any, prop, prop_assert, prop_oneof, proptest};

use firmware_proto::frame::Message;

use super::stories::{AWAY, RIGHT};
use super::virtual_time::Play;

/// How old a frame from the past is, in frames.
fn ages() -> impl Strategy<Value = u32> {
    prop_oneof![0..4_u32, 60..70_u32, 0..2_000_u32, 0..=u32::MAX / 2]
}

/// Sends frames again that are so old: those that were sent, or where that is too long ago such as they may have been.
fn repeat(play: &mut Play, age: u32, frames: u32) {
    let (sequence, time_us) = (play.sequence, play.time_us);
    let sent = play.sent.clone();
    play.sequence = sequence.wrapping_sub(age);
    play.time_us = time_us.saturating_sub(1_000 * u64::from(age));
    for _ in 0..frames {
        let number = play.sequence;
        let made = play.sample(&AWAY);
        let sample = sent.iter().rev().find(|it| it.sequence == number).copied().unwrap_or(made);
        play.send(play.now, &Message::Sample(sample));
        play.time_us += 1_000;
    }
    (play.sequence, play.time_us, play.sent) = (sequence, time_us, sent);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_finger_that_stays_while_its_samples_come_late_counts_again(
        delays in prop::collection::vec((any::<bool>(), 0..3_000_u64), 1..8),
    ) {
        let mut play = Play::start();
        for (is_starved, ms) in delays {
            play.touch(&RIGHT, 100);
            if is_starved {
                play.starve(&RIGHT, ms, None);
            } else {
                play.stall(&RIGHT, ms);
            }
            // In doubt for 50 ms.
            play.touch(&RIGHT, 60);
            prop_assert!(play.bridge.driver.pipeline.held().next().is_some(), "{is_starved} {ms} ms");
        }
        prop_assert!(play.touch(&RIGHT, 2_500).is_empty(), "it is let go of later");
        prop_assert!(play.bridge.driver.pipeline.health().restarts == 0, "a restart");
    }

    #[test]
    fn frames_from_the_past_lose_no_press(
        past in prop::collection::vec((ages(), 1..3_u32, 0..100_u64), 1..8),
        is_begun in any::<bool>(),
    ) {
        let mut play = Play::start();
        // Numbers that have begun at zero again, or not.
        play.sequence = if is_begun { play.sequence } else { 3_000_000_000 };
        play.touch(&AWAY, 1_000);
        let restarts = play.bridge.driver.pipeline.health().restarts;
        for (age, frames, wait_ms) in past {
            play.touch(&AWAY, wait_ms);
            // The frame that is sent next is none from the past.
            repeat(&mut play, age.max(frames), frames);
            // In doubt for 50 ms.
            play.touch(&AWAY, 60);
            let pressed = play.touch(&RIGHT, 100);
            prop_assert!(pressed.iter().any(|(_, value, _)| *value != 0), "{age} {frames}: {pressed:?}");
        }
        prop_assert!(play.bridge.driver.pipeline.health().restarts == restarts, "a restart");
    }
}
