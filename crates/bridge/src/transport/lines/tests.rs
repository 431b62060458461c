//! Load cells that print lines, from their text to held keys, in virtual time.

use std::fmt::Write;

use proptest::prelude::{
    Just, ProptestConfig, Strategy, any, prop_assert, prop_assert_eq, prop_oneof, proptest,
};

use super::frames::{LINE_BYTES_MAX, LineFrames};
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::contact::read::playing;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad_core::pipeline::mapping::read::shipped as profiles;
use tactpad_core::pipeline::{NoProbe, Phase, Pipeline};
use tactpad_core::quantity::{Contact, WEIGHT_N_PER_G};
use tactpad_core::source::read as sources;
use tactpad_core::source::{Origin, shipped};
use tactpad_core::time::HostInstant;

/// Half the board's width and height, and where its cells are, mm.
const CORNERS_MM: [[f64; 2]; 4] = [[-100.0, 100.0], [100.0, 100.0], [-100.0, -100.0], [100.0, -100.0]];

/// A force at a place of the board: newtons, mm.
type Load = (f64, [f64; 2]);

const NOTHING: Load = (0.0, [0.0; 2]);

/// 20 N, which is 2 N for a profile, half way to the right edge, 15 mm there.
const RIGHT: Load = (20.0, [50.0, 0.0]);

/// A board that prints lines, the port and the pipeline behind it.
struct Board {
    period_us: u64,
    frames: LineFrames,
    pipeline: Pipeline,
    now_us: u64,
    next_line_us: u64,
    /// What is read without load, g.
    offset_g: [f64; 4],
    /// The cells that print no number.
    dead: [bool; 4],
    /// What a cell prints line after line, once it stands still.
    standing: [Option<f64>; 4],
    lines: u32,
    /// The most that was held at once.
    held_most: usize,
}

impl Board {
    fn of(lines_per_s: u64) -> Self {
        let text = shipped::text("load-cells").unwrap();
        let profile = read(profiles::text("super-mario").unwrap(), OutputChoice::AsWritten).0.unwrap();
        Self {
            period_us: 1_000_000 / lines_per_s,
            frames: frames(),
            pipeline: Pipeline::new(playing(text.as_bytes()).unwrap(), profile),
            now_us: 1_000_000,
            next_line_us: 0,
            offset_g: [120.0, -75.5, 3_000.25, 0.0],
            dead: [false; 4],
            standing: [None; 4],
            lines: 0,
            held_most: 0,
        }
    }

    /// What it prints under a load: numbers with a noise of a gram, and a line's end.
    fn line(&mut self, (force_n, [x_mm, y_mm]): Load) -> String {
        let mut line = String::new();
        self.lines += 1;
        for (k, [cell_x, cell_y]) in CORNERS_MM.into_iter().enumerate() {
            let share = (1.0 + x_mm * cell_x / 1e4 + y_mm * cell_y / 1e4) / 4.0;
            let noise_g = f64::from((self.lines * 7 + k as u32 * 3) % 11) / 5.0 - 1.0;
            let g = self.offset_g[k] + share * force_n / WEIGHT_N_PER_G + noise_g;
            let separator = if k == 0 { "" } else { ", " };
            let g = self.standing[k].unwrap_or(g);
            if self.dead[k] {
                write!(line, "{separator}nan").unwrap();
            } else {
                write!(line, "{separator}{g:.2}").unwrap();
            }
        }
        line + "\r\n"
    }

    /// Hands over bytes now.
    fn bytes(&mut self, bytes: &[u8]) {
        let mut out = Vec::new();
        self.frames.take(self.now_us, bytes, &mut out);
        self.play(&out);
    }

    fn play(&mut self, frames: &[u8]) {
        let now = HostInstant::default().plus_us(self.now_us);
        let mut call = Some(Call::Bytes(frames));
        while let Some(next) = call {
            call = self.pipeline.apply(now, next, &mut NoProbe);
        }
        self.held_most = self.held_most.max(self.pipeline.held().count());
    }

    /// Time passes under a load, and lines come; what the last of it is.
    fn rest(&mut self, ms: u64, load: Load) {
        self.pass(ms, Some(load));
    }

    /// Time passes, and lines come if there is a load.
    fn pass(&mut self, ms: u64, load: Option<Load>) {
        for _ in 0..ms {
            self.now_us += 1_000;
            if let Some(load) = load.filter(|_| self.next_line_us <= self.now_us) {
                self.next_line_us = self.now_us + self.period_us;
                let line = self.line(load);
                self.bytes(line.as_bytes());
            }
            if self.frames.due_us().is_some_and(|due_us| due_us <= self.now_us) {
                let mut out = Vec::new();
                self.frames.repeat(self.now_us, &mut out);
                self.play(&out);
            }
            let now = HostInstant::default().plus_us(self.now_us);
            if self.pipeline.poll_timeout().is_some_and(|due| due <= now) {
                let _ = self.pipeline.apply(now, Call::Timeout, &mut NoProbe);
            }
        }
    }

    fn held(&self) -> usize {
        self.pipeline.held().count()
    }

    /// How many milliseconds of a load it takes until something is held, of so many at most.
    fn pressed_after_ms(&mut self, load: Load, most_ms: u64) -> Option<u64> {
        (0..most_ms).find(|_| {
            self.rest(1, load);
            self.held() > 0
        })
    }
}

fn frames() -> LineFrames {
    let source = sources::read(shipped::text("load-cells").unwrap()).0.unwrap();
    let Origin::Lines(lines) = source.origin else { panic!("it prints lines") };
    LineFrames::new(&lines)
}

const RATES: [u64; 3] = [10, 80, 1_000];

#[test]
fn a_press_is_where_it_is_at_every_rate() {
    for rate in RATES {
        let mut board = Board::of(rate);
        board.rest(1_500, NOTHING);
        assert_eq!((board.pipeline.phase(), board.held_most), (Phase::Playing, 0), "{rate}");
        board.rest(700, RIGHT);
        let Some(Contact { x_mm, y_mm, fz_n, .. }) = board.pipeline.contact().copied() else {
            panic!("{rate}: no contact")
        };
        // A cell is off by up to a gram, 0.001 N on the plate: by four of them over 2 N, 0.06 mm.
        assert!(
            (x_mm - 15.0).abs() < 0.1 && y_mm.abs() < 0.1 && (fz_n - 2.0).abs() < 0.01,
            "{rate}: {x_mm} {y_mm} {fz_n}"
        );
        let deviation_mm = board.pipeline.estimate().unwrap().covariance[0][0].sqrt();
        assert!((0.01..0.1).contains(&deviation_mm), "{deviation_mm}");
        assert!(board.held() > 0, "{rate}");
        board.rest(400, NOTHING);
        assert_eq!(board.held(), 0, "{rate}");
        assert_eq!(board.frames.finding(), None, "{rate}");
        assert_eq!(board.pipeline.health().frames_lost, 0);
    }
}

#[test]
fn a_still_press_has_time_though_lines_are_slow() {
    for rate in RATES {
        let mut board = Board::of(rate);
        board.rest(1_500, NOTHING);
        // The long press of the profile holds after 400 ms.
        board.rest(300, (32.0, [50.0, 0.0]));
        let before = board.held();
        board.rest(400, (32.0, [50.0, 0.0]));
        assert!(board.held() > before, "{rate}: {before}");
    }
}

#[test]
fn what_stops_printing_lets_go() {
    for (rate, most_ms) in [(10, 400), (80, 130), (1_000, 105)] {
        let mut board = Board::of(rate);
        board.rest(1_500, NOTHING);
        board.rest(500, RIGHT);
        assert!(board.held() > 0);
        board.pass(most_ms, None);
        assert_eq!((board.held(), board.pipeline.phase()), (0, Phase::Waiting), "{rate}");
        board.rest(1_000, NOTHING);
        assert!(board.pressed_after_ms(RIGHT, 500).is_some(), "{rate}: it plays on");
    }
}

#[test]
fn a_cell_without_a_number_lets_go_at_once_and_is_named() {
    for rate in RATES {
        let mut board = Board::of(rate);
        board.rest(1_500, NOTHING);
        board.rest(500, RIGHT);
        assert!(board.held() > 0);
        board.dead[2] = true;
        board.rest(1_000 / rate + 2, RIGHT);
        assert_eq!((board.held(), board.pipeline.phase()), (0, Phase::Faulty), "{rate}");
        board.rest(1_900, NOTHING);
        assert_eq!(board.frames.finding(), Some(&LineFinding::NoNumber { channel: 2 }), "{rate}");
        board.dead[2] = false;
        board.rest(4_000, NOTHING);
        assert_eq!(board.frames.finding(), None, "{rate}");
        assert!(board.pressed_after_ms(RIGHT, 500).is_some(), "{rate}: it plays on");
    }
}

#[test]
fn a_cell_that_prints_the_same_all_the_time_lets_go_and_is_named() {
    for rate in RATES {
        let mut board = Board::of(rate);
        board.rest(8_000, NOTHING);
        board.rest(500, RIGHT);
        assert!(board.held() > 0, "{rate}");
        board.standing[1] = Some(900.0);
        // It is known after 32 lines.
        board.rest(1_000 * 34 / rate + 5, RIGHT);
        assert_eq!((board.held(), board.pipeline.phase()), (0, Phase::Faulty), "{rate}");
        board.rest(2_000, NOTHING);
        assert_eq!(board.frames.finding(), Some(&LineFinding::CellStands { channel: 1 }), "{rate}");
        board.standing[1] = None;
        board.rest(6_000, NOTHING);
        assert_eq!(board.frames.finding(), None, "{rate}");
        assert!(board.pressed_after_ms(RIGHT, 500).is_some(), "{rate}: it plays on");
    }
}

#[test]
fn text_that_is_no_numbers_is_no_pad_and_is_told() {
    for (text, finding) in [
        ("hello\r\n".to_owned(), LineFinding::NotNumbers),
        ("1.0, 2.0, 3.0\n".to_owned(), LineFinding::NotNumbers),
        (format!("{}\n", "7".repeat(LINE_BYTES_MAX + 1)), LineFinding::LineTooLong),
        ("nan, nan, nan, nan\n".to_owned(), LineFinding::NotNumbers),
    ] {
        let mut board = Board::of(80);
        for _ in 0..200 {
            board.pass(10, None);
            board.bytes(text.as_bytes());
        }
        assert_eq!(board.frames.finding(), Some(&finding), "{text}");
        assert_eq!((board.pipeline.health().samples, board.held_most), (0, 0), "{text}");
    }
}

#[test]
fn numbers_stand_between_whatever_people_print() {
    for line in ["1 2 3 4", "1,2,3,4", "1;2; 3 ;4", "\t1\t2\t3\t4", " 1.0 , 2e0,3.,+4 ", "1,2,3,4,5,x"] {
        let mut frames = frames();
        let mut out = Vec::new();
        frames.take(1_000, format!("half\n{line}\n{line}\n").as_bytes(), &mut out);
        let mut receiver = firmware_proto::link::MessageReceiver::new();
        let heard: Vec<_> = out.iter().filter_map(|byte| receiver.push(*byte)).collect();
        let [Ok(firmware_proto::frame::Message::Channels(sample))] = heard[..] else {
            panic!("{line}: {heard:?}")
        };
        assert_eq!(sample.counts(), [100, 200, 300, 400], "{line}");
    }
}

/// Something that happens to a board or to its line.
#[derive(Clone, Debug)]
enum Happening {
    /// Nothing comes for so many milliseconds.
    Silence(u64),
    /// A force at a place for so many milliseconds.
    Load(Load, u64),
    /// Bytes that are no line. They do not end in what could be the beginning of a number: nobody can tell that from a number.
    Rubbish(Vec<u8>),
    /// The rest of a line is lost.
    Half(usize),
    /// A cell prints no number for so many milliseconds.
    Dead(usize, u64),
    /// Lines of so many milliseconds come all at once.
    Burst(Load, u64),
    /// A line that never ends.
    Endless,
    /// The cable is pulled, and plugged in again.
    Replug,
    /// Somebody has the zero measured.
    Retare,
}

fn loads() -> impl Strategy<Value = Load> {
    prop_oneof![
        Just(NOTHING),
        (0.0..60.0, -90.0..90.0, -90.0..90.0).prop_map(|(force_n, x_mm, y_mm)| (force_n, [x_mm, y_mm]))
    ]
}

fn happenings() -> impl Strategy<Value = Happening> {
    prop_oneof![
        2 => (0..1_500_u64).prop_map(Happening::Silence),
        4 => (loads(), 0..900_u64).prop_map(|(load, ms)| Happening::Load(load, ms)),
        2 => proptest::collection::vec(any::<u8>(), 0..80).prop_map(Happening::Rubbish),
        1 => (0..30_usize).prop_map(Happening::Half),
        1 => (0..4_usize, 0..1_200_u64).prop_map(|(cell, ms)| Happening::Dead(cell, ms)),
        1 => (loads(), 0..1_000_u64).prop_map(|(load, ms)| Happening::Burst(load, ms)),
        1 => Just(Happening::Endless),
        1 => Just(Happening::Replug),
        1 => Just(Happening::Retare),
    ]
}

impl Board {
    fn happen(&mut self, happening: &Happening) {
        let now = HostInstant::default().plus_us(self.now_us);
        match happening {
            Happening::Silence(ms) => self.pass(*ms, None),
            Happening::Load(load, ms) => self.rest(*ms, *load),
            Happening::Rubbish(bytes) => self.bytes(&[bytes, &b"x"[..]].concat()),
            Happening::Half(length) => {
                let line = self.line(NOTHING);
                self.bytes(&line.as_bytes()[..(*length).min(line.len())]);
            }
            Happening::Dead(cell, ms) => {
                self.dead[*cell] = true;
                self.rest(*ms, NOTHING);
                self.dead[*cell] = false;
            }
            Happening::Burst(load, ms) => {
                let count = 1_000 * ms / self.period_us;
                let lines: String = (0..count).map(|_| self.line(*load)).collect();
                self.now_us += 1_000 * ms;
                self.next_line_us = self.now_us + self.period_us;
                self.bytes(lines.as_bytes());
            }
            Happening::Endless => self.bytes(&[b'8'; 3 * LINE_BYTES_MAX]),
            Happening::Replug => {
                self.frames = frames();
                let _ = self.pipeline.apply(now, Call::Unplugged, &mut NoProbe);
            }
            Happening::Retare => {
                let _ = self.pipeline.apply(now, Call::Retare, &mut NoProbe);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happened_nothing_is_held_and_a_sound_board_plays(
        rate in prop_oneof![Just(10_u64), Just(80), Just(1_000)],
        history in proptest::collection::vec(happenings(), 0..12),
    ) {
        let mut board = Board::of(rate);
        for happening in &history {
            board.happen(happening);
        }
        // What lay there may have been taken for the zero: it takes a second to be seen.
        board.rest(2_000, NOTHING);
        prop_assert_eq!(board.held(), 0, "{:?}", board.pipeline.phase());
        let after_ms = board.pressed_after_ms(RIGHT, 500);
        prop_assert!(after_ms.is_some(), "{:?}", board.pipeline.phase());
        board.rest(400, NOTHING);
        prop_assert_eq!(board.held(), 0);
    }
}
