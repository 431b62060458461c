//! The shortest story that still breaks an invariant.

use super::event::Step;

/// Leaves out of a story whatever it can do without: first long stretches, then single events, then the waits between them.
pub(super) fn shortest(story: &[Step], is_broken: impl Fn(&[Step]) -> bool) -> Vec<Step> {
    let mut story = story.to_vec();
    let mut length = story.len().div_ceil(2);
    while length > 0 {
        let mut at = 0;
        while at < story.len() {
            let mut shorter = story.clone();
            shorter.drain(at..(at + length).min(story.len()));
            if is_broken(&shorter) {
                story = shorter;
            } else {
                at += length;
            }
        }
        length /= 2;
    }
    for at in 0..story.len() {
        for after_ms in [0, 1, 10, 100, 1_000, 3_000] {
            let mut sooner = story.clone();
            if after_ms < sooner[at].after_ms {
                sooner[at].after_ms = after_ms;
                if is_broken(&sooner) {
                    story = sooner;
                    break;
                }
            }
        }
    }
    story
}
