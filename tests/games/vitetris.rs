//! vitetris, a terminal's falling blocks: the first five pieces of a game.
//!
//! The terminal is xterm, so that keys come from the X server. `script` keeps what the game writes to it, and a second terminal
//! shows that here, cell by cell. The game draws its pieces by chance: where each must come to lie follows from how it looks in
//! the preview, what lies already, and the commands.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::desk::{Desk, Process, await_some};
use crate::segment::Segment;
use crate::support::leave_out;
use crate::trial::{Game, Progress};

/// The shipped profile for it.
pub(crate) const PROFILE: &str = "vitetris";
/// Its window's class.
const CLASS: &str = "xterm";

/// The screen.
pub(crate) const WIDTH_PX: u32 = 640;
pub(crate) const HEIGHT_PX: u32 = 480;
/// The terminal, in cells; its window is smaller than the desk.
const LINES: u16 = 24;
const COLUMNS: u16 = 80;
/// Where the board begins on it, and how many blocks it holds. A block is two cells wide.
const BOARD_LINE: usize = 4;
const BOARD_CELL: usize = 29;
const DEPTH: usize = 20;
const WIDTH: usize = 10;
/// The preview stands above the board.
const PREVIEW_LINES: usize = 3;
/// Line, first cell and cells of the score, and of how many pieces have come.
const SCORE: [u16; 3] = [6, 20, 6];
const COME: [u16; 3] = [23, 57, 4];

/// A key's name in the profile.
const TURN: &str = "button 1 tap";
const DROP: &str = "button 1 hold";

/// Where a piece must come to lie.
#[derive(Clone, Copy, Debug)]
enum Aim {
    LeftWall,
    RightWall,
    /// So many columns from where it comes: the middle, or half a block to the left of it.
    Aside(isize),
}

/// What is meant to become of each piece: how often it is turned to the right, and where it goes.
const AIMS: [(usize, Aim); 5] =
    [(1, Aim::LeftWall), (0, Aim::Aside(2)), (2, Aim::RightWall), (0, Aim::LeftWall), (0, Aim::Aside(-2))];

/// The commands for these aims. The first press begins the game, which waits for any key.
pub(crate) fn segment() -> Segment {
    let begin = Segment::default().tap(TURN, 0, 150);
    let first = steps(begin.tap(TURN, 450, 600), "left", 750, 4).tap(DROP, 1_700, 2_250);
    let second = steps(first, "right", 2_500, 2).tap(DROP, 3_000, 3_550);
    let turned = second.tap(TURN, 3_800, 3_950).tap(TURN, 4_100, 4_250);
    let third = steps(turned, "right", 4_400, 5).tap(DROP, 5_600, 6_150);
    // Held, so that the key repeats: to the wall, and down to the ground.
    let fourth = third.steer("left", 6_400, 7_500).tap(DROP, 7_700, 8_250);
    steps(fourth, "left", 8_500, 2).steer("down", 9_000, 11_500)
}

/// Short touches, a column each.
fn steps(segment: Segment, towards: &'static str, begin_ms: u64, count: u64) -> Segment {
    let begins = (0..count).map(|number| begin_ms + 230 * number);
    begins.fold(segment, |segment, begin_ms| segment.steer(towards, begin_ms, begin_ms + 120))
}

/// Whether this machine has the game.
pub(crate) fn is_there() -> bool {
    let wants = [
        ("/usr/games/vitetris", "apt-get install vitetris"),
        ("/usr/bin/xterm", "apt-get install xterm"),
        ("/usr/bin/script", "apt-get install bsdutils"),
    ];
    let missing = wants.into_iter().find(|(program, _)| !Path::new(program).is_file());
    if let Some((program, install)) = missing {
        leave_out(program, install);
    }
    missing.is_none()
}

/// Blocks: line from the top of the board, column from its left.
type Blocks = BTreeSet<[usize; 2]>;

/// The game, before its first key.
pub(crate) struct Vitetris {
    _program: Process,
    desk: Desk,
    /// What the game writes, and a terminal that shows it.
    written: File,
    terminal: vt100::Parser,
    /// How many pieces have come, as the game counts them.
    come: Option<u32>,
    score: u32,
    /// What the preview showed when the last piece came to lie: the piece that came then.
    coming: Blocks,
    pile: Blocks,
    /// How many of the pieces lie where they were meant to.
    lain: usize,
    wrong: Option<String>,
}

impl Vitetris {
    /// Starts the game, which then waits for a key.
    pub(crate) fn start() -> Self {
        Self::start_on(Desk::new(WIDTH_PX, HEIGHT_PX))
    }

    /// The same in the upper left corner of a larger desk.
    pub(crate) fn start_on(desk: Desk) -> Self {
        let path = desk.home.path().join("written");
        File::create(&path).unwrap();
        let mut command = desk.command("xterm");
        command.args(["-geometry", &format!("{COLUMNS}x{LINES}"), "-bg", "black", "-fg", "white"]);
        command.args(["-e", "script", "-qfc", "vitetris -nomenu -mode 1 -level 0"]).arg(&path);
        let program = Process(command.spawn().unwrap());
        let mut game = Self {
            _program: program,
            written: File::open(&path).unwrap(),
            desk,
            terminal: vt100::Parser::new(LINES, COLUMNS, 0),
            come: None,
            score: 0,
            coming: Blocks::new(),
            pile: Blocks::new(),
            lain: 0,
            wrong: None,
        };
        let waits = await_some(20_000, || {
            game.read();
            game.terminal.screen().contents().contains("PRESS KEY").then_some(())
        });
        assert!(waits.is_some(), "the game");
        game.desk.focus(CLASS);
        game
    }

    /// Shows what has been written since, and looks wherever another piece has come.
    fn read(&mut self) {
        let mut bytes = Vec::new();
        self.written.read_to_end(&mut bytes).unwrap();
        for byte in bytes {
            self.terminal.process(&[byte]);
            let come = self.number(COME);
            if come.is_some() && come != self.come {
                self.come = come;
                self.look();
            }
        }
    }

    /// A number that the game shows, once all of its digits stand there.
    fn number(&self, [line, cell, cells]: [u16; 3]) -> Option<u32> {
        let at = |cell| self.terminal.screen().cell(line, cell).map_or("", vt100::Cell::contents);
        let digits: String = (cell..cell + cells).map(at).collect();
        (digits.trim().len() == usize::from(cells)).then(|| digits.parse().ok())?
    }

    /// The blocks in some lines of the screen, counted from the first of them.
    fn blocks(&self, from: usize, count: usize) -> Blocks {
        let is_block = |[line, column]: &[usize; 2]| {
            let [line, cell] = [from + line, BOARD_CELL + 2 * column].map(|at| at as u16);
            self.terminal
                .screen()
                .cell(line, cell)
                .is_some_and(|cell| cell.bgcolor() != vt100::Color::Default)
        };
        (0..count).flat_map(|line| (0..WIDTH).map(move |column| [line, column])).filter(is_block).collect()
    }

    /// Judges the piece that came to lie: the game counts the next one when nothing falls, with the score of the last one.
    fn look(&mut self) {
        let pile = self.blocks(BOARD_LINE, DEPTH);
        let score = self.number(SCORE).unwrap_or(0);
        let aim = AIMS.get(self.lain).filter(|_| self.wrong.is_none() && !self.coming.is_empty());
        if let Some((turns, aim)) = aim {
            let (meant, fallen) = fallen(&self.pile, &placed(&self.coming, *turns, *aim));
            let lies: Blocks = pile.difference(&self.pile).copied().collect();
            // Each line that it was sent down counts a point, and those that it fell by itself none.
            let sent = score.saturating_sub(self.score);
            if lies == meant && 2 * sent as usize >= fallen {
                self.lain += 1;
            } else {
                let number = self.lain + 1;
                self.wrong =
                    Some(format!("piece {number}: {lies:?}, {sent} lines; meant {meant:?}, {fallen}"));
            }
        }
        // The board and the preview are empty before the game begins.
        (self.pile, self.score, self.coming) = (pile, score, self.blocks(0, PREVIEW_LINES));
    }
}

/// A piece turned and moved, at the top of the board.
fn placed(piece: &Blocks, turns: usize, aim: Aim) -> Blocks {
    let least = |blocks: &Blocks, axis: usize| blocks.iter().map(|block| block[axis]).min().unwrap_or(0);
    let most = |blocks: &Blocks, axis: usize| blocks.iter().map(|block| block[axis]).max().unwrap_or(0);
    let top = least(piece, 0);
    let mut blocks: Blocks = piece.iter().map(|[line, column]| [line - top, *column]).collect();
    for _ in 0..turns {
        let (left, bottom) = (least(&blocks, 1), most(&blocks, 0));
        blocks = blocks.iter().map(|[line, column]| [column - left, bottom - line]).collect();
    }
    let from = least(&blocks, 1);
    let free = WIDTH - (most(&blocks, 1) + 1 - from);
    let left = match aim {
        Aim::LeftWall => 0,
        Aim::RightWall => free,
        Aim::Aside(columns) => (free / 2).saturating_add_signed(columns),
    };
    blocks.iter().map(|[line, column]| [*line, column - from + left]).collect()
}

/// Where a piece comes to lie that falls from the top, and how many lines that is.
fn fallen(pile: &Blocks, piece: &Blocks) -> (Blocks, usize) {
    let lower = |lines: usize| piece.iter().map(|[line, column]| [line + lines, *column]).collect::<Blocks>();
    let is_free = |blocks: &Blocks| blocks.iter().all(|block| block[0] < DEPTH && !pile.contains(block));
    let lines = (0..DEPTH).take_while(|lines| is_free(&lower(*lines))).last().unwrap_or(0);
    (lower(lines), lines)
}

impl Game for Vitetris {
    fn desk(&self) -> &Desk {
        &self.desk
    }

    fn progress(&mut self) -> Progress {
        self.read();
        match &self.wrong {
            Some(wrong) => Progress::Lost(wrong.clone()),
            None if self.lain == AIMS.len() => Progress::Reached,
            None => Progress::Going(format!("{} pieces lie as they were meant to", self.lain)),
        }
    }
}

#[test]
fn a_piece_is_turned_moved_and_let_down() {
    let blocks = |lines: &[&str]| -> Blocks {
        let line = |(y, line): (usize, &&str)| {
            let marked = line.char_indices().filter(|(_, mark)| *mark == '#');
            marked.map(|(x, _)| [y, x]).collect::<Vec<_>>()
        };
        lines.iter().enumerate().flat_map(line).collect()
    };
    let coming = blocks(&["", "    ###", "    #"]);
    let once = placed(&coming, 1, Aim::LeftWall);
    assert_eq!(once, blocks(&["##", " #", " #"]));
    assert_eq!(placed(&coming, 2, Aim::RightWall), blocks(&["         #", "       ###"]));
    assert_eq!(placed(&coming, 0, Aim::Aside(2)), blocks(&["     ###", "     #"]));
    let mut pile = blocks(&[""; 0]);
    assert_eq!(fallen(&pile, &once).1, DEPTH - 3);
    pile.insert([10, 0]);
    let (lies, lines) = fallen(&pile, &once);
    assert_eq!((lies.first(), lines), (Some(&[9, 0]), 9), "it hangs on what lies below its left block");
}
