//! People who step on and off, lean, jump, and take the board up, in any order: nobody on it is nothing held, and who stands still plays.

use proptest::prelude::{ProptestConfig, Strategy, any, prop, prop_assert, prop_oneof, proptest};

use super::{Act, Board, Person, SHOWN};

/// Who stands still plays after so long, ms.
const PLAYS_MS: u64 = 4_000;

/// A zero that has jumped by less than a light touch weighs is put right after ten seconds, and once more where that was measured under a
/// load. Who steps on in the very moment when it is put right may be taken for it, and has to step on once more.
const ZERO_MS: u64 = 25_000;

/// What happens to a board.
#[derive(Clone, Debug)]
enum Happening {
    /// Somebody of so many kg is the next who steps on it.
    Other(f64),
    Act(Act),
    /// Nobody does anything for so long.
    Rest(u64),
    /// Whoever is on it steps off so far, and back: a foot is put beside it.
    Foot(f64, u64),
    /// It is taken up for so long, and put down with other zeros, N.
    Lift(u64, [f64; 4]),
    /// Something that is nobody is put on it for so long, N.
    Thing(f64, [f64; 2], u64),
    /// It says nothing for so long.
    Stall(u64),
}

fn acts() -> impl Strategy<Value = Act> {
    prop_oneof![
        4 => prop_oneof![2 => any::<bool>().prop_map(|is_on| if is_on { Act::StepOn } else { Act::StepOff })],
        2 => any::<()>().prop_map(|()| Act::Stand),
        3 => (0..8_u32).prop_map(Act::Lean),
        1 => (0..8_u32).prop_map(Act::LeanAndStamp),
        1 => any::<()>().prop_map(|()| Act::Bounce),
        1 => any::<()>().prop_map(|()| Act::Stamp),
        1 => any::<()>().prop_map(|()| Act::Jump),
    ]
}

fn happenings() -> impl Strategy<Value = Happening> {
    let place = || [-150.0..150.0, -80.0..80.0_f64];
    let rest = prop_oneof![0..300_u64, 0..3_000_u64];
    prop_oneof![
        8 => acts().prop_map(Happening::Act),
        1 => (31.0..131.0).prop_map(Happening::Other),
        2 => rest.prop_map(Happening::Rest),
        1 => (0.1..0.9, 20..1_500_u64).prop_map(|(share, ms)| Happening::Foot(share, ms)),
        1 => (20..3_000_u64, [-15.0..15.0, -15.0..15.0, -15.0..15.0, -15.0..15.0_f64])
            .prop_map(|(ms, zeros_n)| Happening::Lift(ms, zeros_n)),
        1 => (5.0..60.0, place(), 20..3_000_u64).prop_map(|(n, at_mm, ms)| Happening::Thing(n, at_mm, ms)),
        1 => (5..1_500_u64).prop_map(Happening::Stall),
    ]
}

/// A board, who is to step on it, and whether they are on it.
struct Play {
    board: Board,
    person: Person,
    is_on: bool,
}

impl Play {
    fn stands(&mut self, share: f64, ms: u64) {
        let force_n = if self.is_on { share * self.person.weight_n() } else { 0.0 };
        self.board.load(force_n, self.person.at_mm, ms);
    }

    fn act(&mut self, act: Act) {
        let fits = matches!(act, Act::StepOn) != self.is_on;
        if fits {
            self.board.play(&self.person, act);
            self.is_on = !matches!(act, Act::StepOff);
        }
    }

    fn happen(&mut self, happening: &Happening) {
        match *happening {
            Happening::Other(mass_kg) if !self.is_on => self.person.mass_kg = mass_kg,
            Happening::Other(_) => {}
            Happening::Act(act) => self.act(act),
            Happening::Rest(ms) => self.stands(1.0, ms),
            Happening::Foot(share, ms) => self.stands(share, ms),
            Happening::Lift(ms, zeros_n) => {
                self.is_on = false;
                self.board.zeros_n = [-1e3; 4];
                self.board.load(0.0, [0.0; 2], ms);
                self.board.zeros_n = zeros_n;
            }
            Happening::Thing(force_n, at_mm, ms) if !self.is_on => self.board.load(force_n, at_mm, ms),
            Happening::Thing(..) => {}
            Happening::Stall(ms) => self.board.stall(ms),
        }
    }

    /// Whether nothing is held once everybody has gone, as late as a zero of a board that was taken up and put down is known anew.
    fn is_let_go(&mut self) -> bool {
        self.act(Act::StepOff);
        self.board.load(0.0, [0.0; 2], PLAYS_MS);
        self.board.rig.is_neutral()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happened_nobody_holds_nothing_and_who_stands_still_plays(
        history in prop::collection::vec(happenings(), 0..25),
        mass_kg in 31.0..131.0,
    ) {
        let mut play = Play { board: Board::new(), person: SHOWN[1], is_on: false };
        for happening in &history {
            play.happen(happening);
            if matches!(happening, Happening::Act(Act::StepOff)) {
                prop_assert!(play.is_let_go(), "held after {happening:?}");
            }
        }
        prop_assert!(play.is_let_go(), "held at the end");
        play.board.load(0.0, [0.0; 2], ZERO_MS);
        play.person.mass_kg = mass_kg;
        play.act(Act::StepOn);
        play.stands(1.0, PLAYS_MS - 1_000);
        play.board.rig.take_events();
        prop_assert!(!play.board.rig.pipeline.awaits_weight(), "{:?}", play.board.rig.pipeline.phase());
        let person = play.person;
        let events = play.board.play(&person, Act::Lean(0));
        prop_assert!(events == Act::Lean(0).events(), "{events:?}");
        prop_assert!(play.is_let_go(), "held after the lean");
        play.board.load(0.0, [0.0; 2], ZERO_MS);
        prop_assert!(play.board.rig.pipeline.awaits_weight(), "{:?}", play.board.rig.pipeline.phase());
    }
}
