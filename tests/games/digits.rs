//! Reads a line of text that a game writes over its picture, by glyphs that the same game has shown before.
//!
//! A glyph is bright with a dark rim, so it stands out on any ground. Which pixels are bright is learned on black ground.

use crate::framebuffer::{Area, Picture};

/// A pixel of a glyph is at least so bright,
const BRIGHT: u8 = 160;
/// and one of its rim at most so.
const DARK: u8 = 150;
/// Glyphs stand at most so many columns apart,
const GAP_MAX_PX: usize = 4;
/// and words so many.
const SPACE_MAX_PX: usize = 14;
/// So many of a glyph's pixels must be as they should.
const LEAST_SHARE: f64 = 0.85;

/// One character and how it looks.
#[derive(Clone, Debug)]
struct Glyph {
    character: char,
    width_px: usize,
    /// Columns from the left, lines from the area's top.
    bright: Vec<[usize; 2]>,
    dark: Vec<[usize; 2]>,
}

/// The glyphs of a font, all of them on one line of the same height.
#[derive(Clone, Debug, Default)]
pub(crate) struct Font(Vec<Glyph>);

fn level(picture: &Picture, area: &Area, [x, y]: [usize; 2]) -> u8 {
    let [red, green, blue] = picture.at(area.left_px + x, area.top_px + y);
    red.min(green).min(blue)
}

impl Font {
    /// Learns the glyphs of `text`, which stands in `area` on black ground. Whether there were as many as the text has.
    pub(crate) fn learn(&mut self, picture: &Picture, area: &Area, text: &str) -> bool {
        let is_bright = |x: usize, y: usize| level(picture, area, [x, y]) >= BRIGHT;
        let has_light = |x: usize| (0..area.height_px).any(|y| level(picture, area, [x, y]) >= BRIGHT / 2);
        let mut spans: Vec<[usize; 2]> = Vec::new();
        for x in (0..area.width_px).filter(|x| has_light(*x)) {
            match spans.last_mut() {
                Some([_, end]) if *end == x => *end = x + 1,
                _ => spans.push([x, x + 1]),
            }
        }
        let characters: Vec<char> = text.chars().filter(|character| *character != ' ').collect();
        if spans.len() != characters.len() {
            return false;
        }
        for (character, [from, to]) in characters.into_iter().zip(spans) {
            if self.0.iter().any(|known| known.character == character) {
                continue;
            }
            let all = || (from..to).flat_map(|x| (1..area.height_px - 1).map(move |y| [x, y]));
            let bright: Vec<_> = all().filter(|[x, y]| is_bright(*x, *y)).collect();
            let beside = |[x, y]: &[usize; 2]| {
                bright.iter().any(|[bx, by]| bx.abs_diff(*x) <= 1 && by.abs_diff(*y) <= 1)
            };
            let dark: Vec<_> =
                all().filter(|at| level(picture, area, *at) < BRIGHT / 4 && beside(at)).collect();
            let moved = |pixels: Vec<[usize; 2]>| pixels.into_iter().map(|[x, y]| [x - from, y]).collect();
            self.0.push(Glyph { character, width_px: to - from, dark: moved(dark), bright: moved(bright) });
        }
        true
    }

    /// The text that begins in the first columns of `area`; what cannot be read ends it.
    pub(crate) fn read(&self, picture: &Picture, area: &Area) -> String {
        let mut text = String::new();
        let mut at = 0;
        loop {
            let reach = if text.is_empty() { GAP_MAX_PX } else { SPACE_MAX_PX };
            let Some((character, from, end)) = self.next(picture, area, at, reach) else { return text };
            if !text.is_empty() && from > at + GAP_MAX_PX {
                text.push(' ');
            }
            text.push(character);
            at = end;
        }
    }

    /// The glyph that fits best among the next columns, and from where to where it reaches.
    fn next(&self, picture: &Picture, area: &Area, at: usize, reach: usize) -> Option<(char, usize, usize)> {
        let fits = |from: usize| {
            let best = self.0.iter().map(|glyph| (glyph.share(picture, area, from), glyph));
            best.max_by(|one, other| one.0.total_cmp(&other.0)).filter(|(share, _)| *share >= LEAST_SHARE)
        };
        let mut found = (at..=at + reach).filter_map(|from| Some((from, fits(from)?)));
        let (first, mut best) = found.next()?;
        let mut from = first;
        // The next columns may fit better: a narrow glyph is a part of a broad one.
        for (later, other) in found.take_while(|(later, _)| *later <= first + 2) {
            if other.0 > best.0 {
                (from, best) = (later, other);
            }
        }
        Some((best.1.character, from, from + best.1.width_px))
    }
}

impl Glyph {
    /// The share of its pixels that are as they should be, if it stood there.
    fn share(&self, picture: &Picture, area: &Area, from: usize) -> f64 {
        if from + self.width_px > area.width_px {
            return 0.0;
        }
        let at = |[x, y]: &[usize; 2]| level(picture, area, [from + x, *y]);
        let bright = self.bright.iter().filter(|pixel| at(pixel) >= BRIGHT - 30).count();
        let dark = self.dark.iter().filter(|pixel| at(pixel) <= DARK).count();
        (bright + dark) as f64 / (self.bright.len() + self.dark.len()).max(1) as f64
    }
}

/// A picture with these lines, in which `#` is white and `.` black, on ground of this brightness.
#[cfg(test)]
fn drawn(lines: &[&str], ground: u8) -> Picture {
    let level = |mark: char| match mark {
        '#' => 255,
        '.' => 0,
        _ => ground,
    };
    let rgb: Vec<_> = lines.iter().flat_map(|line| line.chars().map(|mark| [level(mark); 3])).collect();
    Picture { width: lines[0].len(), height: lines.len(), rgb }
}

#[test]
fn text_is_read_where_it_stands_and_nowhere_else() {
    let mut font = Font::default();
    let shown = [
        "................",
        "..###...#...#...",
        "..#.#..##...#...",
        "..#.#...#.......",
        "..###...#...#...",
        "................",
    ];
    let area = Area { left_px: 0, top_px: 0, width_px: 16, height_px: 6 };
    assert!(!font.learn(&drawn(&shown, 0), &area, "01"), "there are three");
    assert!(font.learn(&drawn(&shown, 0), &area, "01!"));
    let ground = drawn(&[" ".repeat(16).as_str(); 6], 250);
    assert_eq!(font.read(&ground, &area), "", "bright ground is no text");
    let written = [
        "                ",
        "....      ..... ",
        "..#..     .###. ",
        ".##.      .#.#. ",
        "..#.      .#.#. ",
        "..#.      .###. ",
    ];
    assert_eq!(font.read(&drawn(&written, 250), &area), "", "it stands a line lower");
    let written = [
        "....      ..... ",
        "..#.      .###. ",
        ".##.      .#.#. ",
        "..#.      .#.#. ",
        "..#.      .###. ",
        "....      ..... ",
    ];
    for ground in [0, 60, 128] {
        assert_eq!(font.read(&drawn(&written, ground), &area), "1 0", "on {ground}");
    }
}
