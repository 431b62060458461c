//! Keys of macros and of fingers do not mix, whatever order they come in.

use std::collections::BTreeSet;

use proptest::prelude::{ProptestConfig, Strategy, prop, prop_assert, proptest};
use tactpad::pipeline::control::Code;
use tactpad::pipeline::mapping::live::engine::Engine;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::output::ledger::{Edges, Ledger};
use tactpad::quantity::Contact;
use tactpad::time::StreamInstant;

/// Keys that macros alone press, and the modifiers that they press them with. No finger has the right Alt.
const MACRO_KEYS: [&str; 3] = ["KEY_1", "KEY_2", "KEY_3"];
const MACRO_MODIFIERS: [&str; 3] = ["KEY_LEFTCTRL", "KEY_LEFTSHIFT", "KEY_RIGHTALT"];

/// What fingers press: chords that are held and tapped, a plain key, the mouse, modifiers that stay down.
const FINGERS: &str = r#"
[[button]]
force = "fz"
press_n = 1
out = { gamepad = "BTN_WEST", keyboard = "KEY_LEFTCTRL+KEY_C" }
[[button]]
force = "-fy"
press_n = 1
tap = { gamepad = "BTN_NORTH", keyboard = "KEY_V+KEY_LEFTSHIFT" }
[[button]]
force = "fz"
press_n = 2
tap = { gamepad = "BTN_TL", keyboard = "KEY_D" }
[[button]]
force = "-fy"
press_n = 2
out = { pointer = "BTN_LEFT" }
[[button]]
force = "fx"
press_n = 2
out = { gamepad = "BTN_START", keyboard = "KEY_LEFTMETA", toggle = true }
[[button]]
force = "-fx"
press_n = 2
out = { gamepad = "BTN_SELECT", keyboard = "KEY_LEFTSHIFT", sticky = true }
"#;

/// What fingers press a key with, of those that are no macro's.
const CHORDS: [(&str, Option<&str>); 4] =
    [("KEY_C", Some("KEY_LEFTCTRL")), ("KEY_V", Some("KEY_LEFTSHIFT")), ("KEY_D", None), ("BTN_LEFT", None)];

/// A step of a macro: a key and its modifiers, or a pause; and its time in milliseconds.
type Step = (Option<(usize, [bool; 3])>, u64);

/// A key that goes down, and the modifiers that are down then.
type Stroke = (String, BTreeSet<String>);

fn is_modifier(key: &str) -> bool {
    ["SHIFT", "CTRL", "ALT", "META"].iter().any(|kind| key.ends_with(kind))
}

fn keys((key, modifiers): (usize, [bool; 3])) -> (&'static str, impl Iterator<Item = &'static str>) {
    let held = MACRO_MODIFIERS.into_iter().zip(modifiers).filter(|(_, is_held)| *is_held);
    (MACRO_KEYS[key], held.map(|(modifier, _)| modifier))
}

fn written(macros: &[Vec<Step>]) -> String {
    let step = |(pressed, ms): &Step| match pressed {
        None => format!("{{ wait_ms = {ms} }}"),
        Some(pressed) => {
            let (key, modifiers) = keys(*pressed);
            let keys: Vec<_> = modifiers.chain([key]).collect();
            format!("{{ gamepad = \"BTN_SOUTH\", keyboard = \"{}\", for_ms = {ms} }}", keys.join("+"))
        }
    };
    let mut text = "schema = 1\nname = \"Mixed\"\noutput = \"keyboard\"\n".to_owned();
    for ((number, steps), press) in macros.iter().enumerate().zip(["fx", "-fx", "fy"]) {
        let steps: Vec<_> = steps.iter().map(step).collect();
        text += &format!("[[macro]]\nname = \"{number}\"\nsteps = [{}]\n", steps.join(", "));
        let press = format!("force = \"{press}\"\npress_n = 1");
        text += &format!("[[button]]\n{press}\nout = {{ macro = \"{number}\" }}\n");
    }
    text + FINGERS
}

/// What a macro lets go down, in its order. A key of two steps that follow each other stays down.
fn strokes(steps: &[Step]) -> Vec<Stroke> {
    let before = [None].into_iter().chain(steps.iter().map(|(pressed, _)| *pressed));
    let down = steps.iter().zip(before).filter_map(|((pressed, _), before)| {
        let (key, modifiers) = keys((*pressed)?);
        let is_new = before.is_none_or(|before| keys(before).0 != key);
        is_new.then(|| (key.to_owned(), modifiers.map(str::to_owned).collect()))
    });
    down.collect()
}

fn macros() -> impl Strategy<Value = Vec<Vec<Step>>> {
    let pressed = prop::option::weighted(0.8, (0..MACRO_KEYS.len(), prop::array::uniform3(prop::bool::ANY)));
    let steps = prop::collection::vec((pressed, 40..100_u64), 1..4);
    prop::collection::vec(steps, 3)
}

/// Milliseconds and what the finger does meanwhile; or a fault, which takes none.
fn history() -> impl Strategy<Value = Vec<(u64, Option<[i8; 3]>)>> {
    prop::collection::vec((0..90_u64, prop::option::weighted(0.9, prop::array::uniform3(-2..3_i8))), 1..30)
}

/// The strokes of macros that may have been pressed so far: which macro is under way, up to where; none between two of them.
struct Grammar {
    macros: Vec<Vec<Stroke>>,
    under_way: BTreeSet<Option<(usize, usize)>>,
}

impl Grammar {
    fn new(macros: Vec<Vec<Stroke>>) -> Self {
        Self { macros, under_way: BTreeSet::from([None]) }
    }

    /// Whether this stroke may come now.
    fn takes(&mut self, stroke: &Stroke) -> bool {
        let begun = (0..self.macros.len()).map(|number| (number, 0));
        let next = self.under_way.iter().flat_map(|at| at.map_or(begun.clone().collect(), |at| vec![at]));
        let fits = next.filter(|(number, at)| self.macros[*number].get(*at) == Some(stroke));
        let after = fits.map(|(number, at)| (at + 1 < self.macros[number].len()).then_some((number, at + 1)));
        self.under_way = after.collect();
        !self.under_way.is_empty()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    #[test]
    fn every_key_goes_down_with_its_own_modifiers(macros in macros(), history in history()) {
        let (profile, found) = read(&written(&macros), OutputChoice::AsWritten);
        let Some(profile) = profile else { panic!("{found:?}") };
        let (mut ledger, mut engine) = (Ledger::new(&profile), Engine::new(profile));
        let mut grammar = Grammar::new(macros.iter().map(|steps| strokes(steps)).collect());
        let mut held = BTreeSet::new();
        let mut ms = 0;
        // In the end there is time for all macros.
        for (during_ms, does) in history.into_iter().chain([(2_000, Some([0; 3]))]) {
            let mut edges = Edges::new();
            let Some(forces) = does else {
                engine.cancel();
                ledger.release_all(StreamInstant::from_us(1_000 * ms), &mut edges);
                held.clear();
                grammar.under_way = BTreeSet::from([None]);
                continue;
            };
            let [fx_n, fy_n, fz_n] = forces.map(f32::from);
            let contact = Some(Contact { fx_n, fy_n, fz_n, ..Contact::default() }).filter(|_| forces != [0; 3]);
            for _ in 0..during_ms {
                ms += 1;
                let at = StreamInstant::from_us(1_000 * ms);
                edges.clear();
                ledger.settle(at, &mut edges);
                ledger.update(at, &engine.step(at, contact.as_ref()), &mut edges);
                for edge in &edges {
                    let key = edge.code.to_string();
                    if edge.value == 0 {
                        prop_assert!(held.remove(&key));
                        continue;
                    }
                    prop_assert!(matches!(edge.code, Code::Key(_)) && held.insert(key.clone()));
                    let modifiers: BTreeSet<_> = held.iter().filter(|key| is_modifier(key)).cloned().collect();
                    if let Some((_, chord)) = CHORDS.iter().find(|(name, _)| *name == key) {
                        let has_own = chord.is_none_or(|modifier| modifiers.contains(modifier));
                        prop_assert!(has_own && !modifiers.contains("KEY_RIGHTALT"), "{ms} ms: {key} {modifiers:?}");
                    } else if !modifiers.contains(&key) {
                        let stroke = (key, modifiers);
                        prop_assert!(grammar.takes(&stroke), "{ms} ms: {stroke:?} of {:?}", grammar.macros);
                    }
                }
            }
        }
        prop_assert!(grammar.under_way.contains(&None), "a macro is not at its end: {:?}", grammar.macros);
        let mut edges = Edges::new();
        ledger.release_all(StreamInstant::from_us(1_000 * ms), &mut edges);
        let stays = |key: &str| ["KEY_LEFTMETA", "KEY_LEFTSHIFT"].contains(&key);
        prop_assert!(edges.iter().all(|edge| stays(&edge.code.to_string())), "{edges:?}");
    }
}
