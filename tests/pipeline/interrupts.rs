//! `permissive_hold` and `hold_on_other_key_press`: whatever two presses do to each other, each is played once, and as what it is.

use proptest::prelude::{ProptestConfig, any, prop, prop_assert, prop_assert_eq, prop_assume, proptest};
use tactpad::pipeline::mapping::live::engine::Engine;
use tactpad::pipeline::mapping::live::intent::Intents;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::quantity::Contact;
use tactpad::time::StreamInstant;

const LONG_MS: usize = 400;

fn engine(option: &str) -> Engine {
    let text = format!(
        "schema = 1\nname = \"Interrupted\"\noutput = \"keyboard\"\n[[button]]\nforce = \"fz\"\npress_n = 1\n\
         tap = {{ gamepad = \"BTN_SOUTH\", keyboard = \"KEY_A\" }}\nhold = {{ gamepad = \"BTN_EAST\", keyboard = \
         \"KEY_LEFTSHIFT\" }}\nlong_press_ms = {LONG_MS}\n{option} = true\n[[button]]\nforce = \"fx\"\npress_n = 1\n\
         out = {{ gamepad = \"BTN_WEST\", keyboard = \"KEY_1\" }}\n"
    );
    let (profile, found) = read(&text, OutputChoice::AsWritten);
    Engine::new(profile.unwrap_or_else(|| panic!("{found:?}")))
}

/// A press, from its first millisecond to the first after it.
#[derive(Clone, Copy)]
struct Press {
    begin: usize,
    end: usize,
}

fn presses(is_on: &[bool]) -> Vec<Press> {
    let edges: Vec<usize> = (1..is_on.len()).filter(|ms| is_on.get(ms - 1) != is_on.get(*ms)).collect();
    edges.chunks_exact(2).map(|edge| Press { begin: edge[0], end: edge[1] }).collect()
}

/// When a key goes down.
fn downs(levels: &[Intents], key: &str) -> Vec<usize> {
    let is_down = |ms: &usize| levels[*ms].iter().any(|level| level.code.to_string() == key);
    (1..levels.len()).filter(|ms| is_down(ms) && !is_down(&(ms - 1))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    #[test]
    fn each_press_is_played_once_and_as_what_it_is(
        is_permissive in any::<bool>(),
        // Milliseconds, and which of the two forces are on meanwhile.
        history in prop::collection::vec((3..250_usize, any::<bool>(), any::<bool>()), 1..16),
    ) {
        let mut engine = engine(if is_permissive { "permissive_hold" } else { "hold_on_other_key_press" });
        let around = || [(3, false, false)].into_iter();
        let history: Vec<(bool, bool)> = around()
            .chain(history)
            .chain(around())
            .flat_map(|(ms, first, other)| std::iter::repeat_n((first, other), ms))
            .collect();
        let levels: Vec<Intents> = history
            .iter()
            .enumerate()
            .map(|(ms, (first, other))| {
                let force = |is_on: bool| if is_on { 2.0 } else { 0.0 };
                let contact = Contact { fz_n: force(*first), fx_n: force(*other), ..Contact::default() };
                let contact = Some(contact).filter(|_| *first || *other);
                engine.step(StreamInstant::from_us(1_000 * ms as u64), contact.as_ref())
            })
            .collect();
        let (firsts, others): (Vec<bool>, Vec<bool>) = history.into_iter().unzip();
        let (firsts, others) = (presses(&firsts), presses(&others));
        // One that is due in the very sample in which it ends holds for that sample.
        prop_assume!(firsts.iter().all(|it| it.end - it.begin != LONG_MS));
        let begins_in = |other: &Press, first: &Press| (first.begin + 1..first.end).contains(&other.begin);
        let is_hold = |first: &Press| {
            let interrupts = |it: &Press| begins_in(it, first) && (!is_permissive || it.end <= first.end);
            first.end - first.begin >= LONG_MS || others.iter().any(interrupts)
        };
        let (holds, taps): (Vec<Press>, Vec<Press>) = firsts.iter().copied().partition(is_hold);
        prop_assert_eq!(downs(&levels, "KEY_LEFTSHIFT").len(), holds.len());
        prop_assert_eq!(downs(&levels, "KEY_A"), taps.iter().map(|it| it.end).collect::<Vec<_>>());
        let played = downs(&levels, "KEY_1");
        prop_assert_eq!(played.len(), others.len());
        for (other, ms) in others.iter().zip(played) {
            let has_shift = levels[ms].iter().any(|level| level.code.to_string() == "KEY_LEFTSHIFT");
            prop_assert_eq!(has_shift, holds.iter().any(|first| begins_in(other, first)), "at {} ms", ms);
            let waited = taps.iter().find(|first| is_permissive && begins_in(other, first));
            prop_assert!(waited.is_none_or(|first| ms > first.end), "before the tap, at {ms} ms");
        }
    }
}
