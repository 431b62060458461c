//! A figure as SVG 1.1: text with one root element, no style sheet, no script, no font.
//!
//! Every glyph is defined once and used where it stands. The identifiers come from weight and character, so
//! several figures may stand in one HTML page: what is defined twice is the same.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::figure::{Circle, Ends, Figure, Ink, Mark, Path, Point, Stroke, Text, Weight};
use super::font::{self, PositionedGlyph};

/// Coordinates are written in hundredths of a pixel.
const STEPS_PER_PX: f64 = 100.0;

/// The figure as an SVG document. Equal figures give equal bytes.
pub fn text(figure: &Figure) -> String {
    let mut svg = String::new();
    let [width, height] = figure.size().map(number);
    let description = escaped(&font::plain(figure.description()));
    push(
        &mut svg,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{description}</title>\n"
        ),
    );
    define_glyphs(&mut svg, figure);
    push(&mut svg, format_args!("<path d=\"M0 0h{width}v{height}h-{width}z\" fill=\"#fff\"/>\n"));
    for mark in figure.marks() {
        match mark {
            Mark::Path(path) => write_path(&mut svg, path),
            Mark::Circle(circle) => write_circle(&mut svg, circle),
            Mark::Text(text) => write_text(&mut svg, text),
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Writing to a string cannot fail.
fn push(svg: &mut String, text: std::fmt::Arguments) {
    let _ = svg.write_fmt(text);
}

fn define_glyphs(svg: &mut String, figure: &Figure) {
    let texts = figure.marks().iter().filter_map(|mark| match mark {
        Mark::Text(text) => Some(text),
        _ => None,
    });
    let glyphs = texts.flat_map(|text| font::lay_out(&text.text, text.weight).0).map(|placed| placed.glyph);
    let used: BTreeSet<_> = glyphs.map(|glyph| (glyph.weight, glyph.code, glyph.outline)).collect();
    svg.push_str("<defs>\n");
    for (weight, code, outline) in used.into_iter().filter(|(_, _, outline)| !outline.is_empty()) {
        let id = glyph_id(weight, code);
        push(svg, format_args!("<path id=\"{id}\" d=\"{outline}\"/>\n"));
    }
    svg.push_str("</defs>\n");
}

fn glyph_id(weight: Weight, code: char) -> String {
    let weight = match weight {
        Weight::Regular => 'r',
        Weight::SemiBold => 's',
    };
    format!("{weight}{:x}", u32::from(code))
}

fn write_path(svg: &mut String, path: &Path) {
    svg.push_str("<path d=\"");
    for line in &path.lines {
        write_line(svg, line);
        if path.ends == Ends::Closed {
            svg.push('z');
        }
    }
    svg.push('"');
    write_paint(svg, path.fill, path.stroke);
    if path.fill.is_some() && path.lines.len() > 1 {
        svg.push_str(" fill-rule=\"evenodd\"");
    }
    svg.push_str("/>\n");
}

/// One absolute move, then steps. They are whole hundredths, so that rounding does not add up.
fn write_line(svg: &mut String, line: &[Point]) {
    let mut at = [0_i64; 2];
    for (index, point) in line.iter().enumerate() {
        let next = point.map(|coordinate| (coordinate * STEPS_PER_PX).round() as i64);
        let step = [next[0] - at[0], next[1] - at[1]];
        match index {
            0 => svg.push('M'),
            _ if step == [0, 0] && line.len() > 2 => continue,
            1 => svg.push('l'),
            _ if step[0] >= 0 => svg.push(' '),
            _ => {}
        }
        write_hundredths(svg, step[0]);
        if step[1] >= 0 {
            svg.push(' ');
        }
        write_hundredths(svg, step[1]);
        at = next;
    }
}

/// 1234 as `12.34`, −50 as `-.5`.
fn write_hundredths(svg: &mut String, value: i64) {
    let (whole, part) = (value.unsigned_abs() / 100, value.unsigned_abs() % 100);
    if value < 0 {
        svg.push('-');
    }
    if whole > 0 || part == 0 {
        push(svg, format_args!("{whole}"));
    }
    match part {
        0 => {}
        _ if part % 10 == 0 => push(svg, format_args!(".{}", part / 10)),
        _ => push(svg, format_args!(".{part:02}")),
    }
}

fn write_circle(svg: &mut String, circle: &Circle) {
    let [x, y, radius] = [circle.centre[0], circle.centre[1], circle.radius].map(number);
    push(svg, format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\""));
    write_paint(svg, circle.fill, circle.stroke);
    svg.push_str("/>\n");
}

fn write_paint(svg: &mut String, fill: Option<Ink>, stroke: Option<Stroke>) {
    match fill {
        Some(ink) => write_ink(svg, "fill", ink),
        None => svg.push_str(" fill=\"none\""),
    }
    let Some(stroke) = stroke else { return };
    write_ink(svg, "stroke", stroke.ink);
    push(svg, format_args!(" stroke-width=\"{}\" stroke-linejoin=\"round\"", number(stroke.width)));
    if let Some([dash, gap]) = stroke.dash {
        push(svg, format_args!(" stroke-dasharray=\"{} {}\"", number(dash), number(gap)));
    }
}

fn write_ink(svg: &mut String, what: &str, ink: Ink) {
    let [r, g, b] = ink.colour.levels;
    push(svg, format_args!(" {what}=\"#{r:02x}{g:02x}{b:02x}\""));
    if ink.opacity < 1.0 {
        push(svg, format_args!(" {what}-opacity=\"{}\"", number(ink.opacity)));
    }
}

fn write_text(svg: &mut String, text: &Text) {
    let label = escaped(&font::plain(&text.text));
    let [x, y] = text.at.map(number);
    push(svg, format_args!("<g aria-label=\"{label}\" transform=\"translate({x} {y})"));
    if text.turn_deg != 0.0 {
        push(svg, format_args!("rotate({})", number(text.turn_deg)));
    }
    let scale = text.size / font::UNITS;
    push(svg, format_args!("scale({})\"", fine(scale)));
    write_ink(svg, "fill", text.ink);
    svg.push('>');
    let start = text.offset() / scale;
    for placed in font::lay_out(&text.text, text.weight).0 {
        write_glyph(svg, &placed, start);
    }
    svg.push_str("</g>\n");
}

fn write_glyph(svg: &mut String, placed: &PositionedGlyph, start: f64) {
    if placed.glyph.outline.is_empty() {
        return;
    }
    let id = glyph_id(placed.glyph.weight, placed.glyph.code);
    let (x, y) = (number((start + placed.x * font::UNITS).round()), -placed.rise * font::UNITS);
    if placed.scale == 1.0 {
        push(svg, format_args!("<use href=\"#{id}\" x=\"{x}\"/>"));
    } else {
        let (y, scale) = (number(y), number(placed.scale));
        push(svg, format_args!("<use href=\"#{id}\" transform=\"translate({x} {y})scale({scale})\"/>"));
    }
}

/// At most two decimals; 0 for what is no number, which no mark holds.
fn number(value: f64) -> String {
    let mut text = String::new();
    write_hundredths(&mut text, (value * STEPS_PER_PX).round() as i64);
    text
}

/// A scale: a font unit is about a hundredth of a pixel, a line of text a thousand units.
fn fine(value: f64) -> String {
    if value.is_finite() { format!("{value:.5}") } else { "0".to_owned() }
}

/// Text for XML: no markup, and none of the control characters that XML forbids.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for code in text.chars() {
        match code {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            _ if code.is_control() || matches!(code, '\u{fffe}' | '\u{ffff}') => escaped.push(' '),
            _ => escaped.push(code),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::{AXIS, TEXT};

    #[test]
    fn numbers_are_short() {
        let cases = [(0.0, "0"), (12.34, "12.34"), (-0.5, "-.5"), (0.05, ".05"), (-3.0, "-3"), (7.996, "8")];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
        assert_eq!(number(f64::NAN), "0");
    }

    #[test]
    fn steps_lead_from_corner_to_corner() {
        let mut line = String::new();
        write_line(&mut line, &[[1.0, 2.0], [1.5, 2.0], [1.5, 2.0], [1.25, -2.0], [1.24, 0.0]]);
        assert_eq!(line, "M1 2l.5 0-.25-4-.01 2");
    }

    #[test]
    fn a_line_of_one_place_is_kept() {
        let mut line = String::new();
        write_line(&mut line, &[[1.0, 2.0], [1.0, 2.0]]);
        assert_eq!(line, "M1 2l0 0");
    }

    #[test]
    fn text_is_escaped_and_described() {
        let mut figure = Figure::new(40.0, 20.0, "a < b");
        figure.text(Text::new("R & D\u{1}\"", [3.0, 12.0], 10.0, TEXT));
        figure.path(Path::rectangle([0.0, 0.0], [1.0, 1.0]));
        figure.path(Path::strokes(vec![vec![[0.0, 0.0], [1.0, 1.0]]], AXIS));
        let svg = text(&figure);
        assert!(svg.contains("<title>a &lt; b</title>"));
        assert!(svg.contains("aria-label=\"R &amp; D &quot;\""));
        assert_eq!(svg.matches("<use").count(), 5, "a space needs no glyph: {svg}");
    }
}
