//! The font: outlines and widths of the glyphs of Inter, in two weights.
//!
//! `font/inter.txt` was made by `font/make.py`; Inter's licence, `font/OFL.txt`, covers both that file and the
//! outlines in the figures' source. Characters it does not have are drawn as a box.

use std::sync::LazyLock;

use super::figure::{Anchor, Text, Weight};

/// Units of an outline per em.
pub(super) const UNITS: f64 = 1000.0;

const TABLE: &str = include_str!("font/inter.txt");
const FALLBACK: char = '□';
const RAISED: f64 = 0.36;
const LOWERED: f64 = -0.18;
const SHRUNK: f64 = 0.72;

static GLYPHS: LazyLock<Vec<Glyph>> = LazyLock::new(|| TABLE.lines().filter_map(parse).collect());

/// One character's shape.
#[derive(Debug)]
pub(super) struct Glyph {
    pub(super) weight: Weight,
    pub(super) code: char,
    /// Width, in units.
    pub(super) advance: f64,
    /// In the path language of SVG with the commands `m l q z`, in units, y down.
    pub(super) outline: &'static str,
}

/// A glyph in its place on a line that starts at 0, in multiples of the size.
#[derive(Debug)]
pub(super) struct PositionedGlyph {
    pub(super) glyph: &'static Glyph,
    pub(super) x: f64,
    /// Of the baseline, upwards.
    pub(super) rise: f64,
    /// Of the glyph, 1 but for indices and exponents.
    pub(super) scale: f64,
}

/// A text without the marks of indices and exponents.
pub(super) fn plain(text: &str) -> String {
    characters(text).map(|(code, _)| code).collect()
}

/// Places the glyphs of `text`, in which `_{…}` is an index and `^{…}` an exponent; also tells the width.
pub(super) fn lay_out(text: &str, weight: Weight) -> (Vec<PositionedGlyph>, f64) {
    let mut x = 0.0;
    let mut placed = Vec::new();
    for (code, rise) in characters(text) {
        let Some(glyph) = glyph(weight, code) else { continue };
        let scale = if rise == 0.0 { 1.0 } else { SHRUNK };
        placed.push(PositionedGlyph { glyph, x, rise, scale });
        x += glyph.advance / UNITS * scale;
    }
    (placed, x)
}

/// The width of `text` at this size.
pub(super) fn width(text: &str, size: f64, weight: Weight) -> f64 {
    size * lay_out(text, weight).1
}

impl Text {
    /// How long it is.
    pub fn width(&self) -> f64 {
        width(&self.text, self.size, self.weight)
    }

    /// How far its start is behind its place.
    pub(super) fn offset(&self) -> f64 {
        match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * self.width(),
            Anchor::End => -self.width(),
        }
    }
}

/// The characters that are drawn, each with its rise.
fn characters(text: &str) -> impl Iterator<Item = (char, f64)> {
    let mut rest = text.chars().peekable();
    let mut rise = 0.0;
    std::iter::from_fn(move || {
        loop {
            match (rest.next()?, rest.peek()) {
                ('_', Some('{')) => rise = LOWERED,
                ('^', Some('{')) => rise = RAISED,
                ('}', _) if rise != 0.0 => {
                    rise = 0.0;
                    continue;
                }
                (code, _) => return Some((code, rise)),
            }
            rest.next();
        }
    })
}

fn glyph(weight: Weight, code: char) -> Option<&'static Glyph> {
    let find = |code: char| {
        let index = GLYPHS.binary_search_by_key(&(weight, code), |glyph| (glyph.weight, glyph.code));
        index.ok().and_then(|index| GLYPHS.get(index))
    };
    find(code).or_else(|| find(FALLBACK))
}

fn parse(line: &'static str) -> Option<Glyph> {
    let (weight, rest) = line.split_once(' ')?;
    let (code, rest) = rest.split_once(' ')?;
    let (advance, outline) = rest.split_once(' ').unwrap_or((rest, ""));
    let weight = if weight == "r" { Weight::Regular } else { Weight::SemiBold };
    let code = char::from_u32(u32::from_str_radix(code, 16).ok()?)?;
    Some(Glyph { weight, code, advance: advance.parse().ok()?, outline })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_a_glyph_in_order() {
        assert_eq!(GLYPHS.len(), TABLE.lines().count());
        let keys: Vec<_> = GLYPHS.iter().map(|glyph| (glyph.weight, glyph.code)).collect();
        assert!(keys.is_sorted());
        for weight in [Weight::Regular, Weight::SemiBold] {
            for code in (' '..='~').chain("µ°²³⌀−·×±αβδεθλνρστω".chars()) {
                assert_eq!(glyph(weight, code).unwrap().code == code, code != '⌀', "{code}");
            }
        }
    }

    #[test]
    fn widths_add_up() {
        let [one, two] = ["Fx", "FxFx"].map(|text| width(text, 10.0, Weight::Regular));
        assert!((2.0 * one - two).abs() < 1e-9);
        // Inter's own table has advances of 1522, 1200 and 1794 units of 2048.
        let wanted = 10.0 * f64::from(1522 + 1200 + 1794) / 2048.0;
        assert!((width("Hµm", 10.0, Weight::Regular) - wanted).abs() < 0.02);
        assert_eq!(width("", 10.0, Weight::Regular), 0.0);
        assert!(width("i", 10.0, Weight::Regular) < width("m", 10.0, Weight::Regular));
        assert!(width("m", 10.0, Weight::Regular) < width("m", 10.0, Weight::SemiBold));
    }

    #[test]
    fn indices_and_exponents_need_braces() {
        assert_eq!(plain("F_{x}, 10^{−3} of m0_moved}"), "Fx, 10−3 of m0_moved}");
        assert_eq!(plain("F_{x"), "Fx");
        let (placed, _) = lay_out("F_{x}y", Weight::Regular);
        assert_eq!(placed.iter().map(|glyph| glyph.rise).collect::<Vec<_>>(), [0.0, LOWERED, 0.0]);
    }

    #[test]
    fn unknown_characters_are_boxes() {
        let (placed, _) = lay_out("漢\u{0}", Weight::Regular);
        assert!(placed.iter().all(|glyph| glyph.glyph.code == FALLBACK));
        assert_eq!(placed.len(), 2);
    }
}
