//! The sheet as PDF 1.4 (ISO 32000-1, the parts that a page of lines needs): a catalogue, one page, its drawing, a standard font.

use std::fmt::Write;

use super::mark::{Mark, number};

/// Points of 1/72 inch.
const POINTS_PER_MM: f64 = 72.0 / 25.4;
/// A quarter of a circle of radius 1 as a Bézier curve: its control points lie so far along the tangents, 4/3 (√2 − 1).
const QUARTER: f64 = 0.552_284_749_830_793_6;

/// The document.
pub(super) fn written(page_mm: [f64; 2], marks: &[Mark]) -> Vec<u8> {
    let [width_pt, height_pt] = page_mm.map(|mm| number(POINTS_PER_MM * mm));
    let drawing = drawing(marks, height_pt);
    let objects = [
        "<< /Type /Catalog /Pages 2 0 R >>".to_owned(),
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
        format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width_pt} {height_pt}] /Contents 4 0 R /Resources << /Font << /F1 5 0 R >> >> >>"
        ),
        format!("<< /Length {} >>\nstream\n{drawing}endstream", drawing.len()),
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>".to_owned(),
    ];
    document(&objects).into_bytes()
}

/// The objects, numbered from 1, and the table of where each begins.
fn document(objects: &[String]) -> String {
    let mut pdf = "%PDF-1.4\n".to_owned();
    let mut begins = Vec::new();
    // Writing into a string never fails.
    for (number, object) in (1..).zip(objects) {
        begins.push(pdf.len());
        let _ = write!(pdf, "{number} 0 obj\n{object}\nendobj\n");
    }
    let (table, count) = (pdf.len(), objects.len() + 1);
    // Each entry is 20 bytes long, its line's end among them.
    let _ = write!(pdf, "xref\n0 {count}\n0000000000 65535 f \n");
    for begin in begins {
        let _ = writeln!(pdf, "{begin:010} 00000 n ");
    }
    let _ = write!(pdf, "trailer\n<< /Size {count} /Root 1 0 R >>\nstartxref\n{table}\n%%EOF\n");
    pdf
}

/// The page's content. Its unit is the millimetre, y downwards from the page's upper left corner.
fn drawing(marks: &[Mark], height_pt: f64) -> String {
    let mut content = format!("{POINTS_PER_MM:.6} 0 0 -{POINTS_PER_MM:.6} 0 {height_pt} cm\n");
    for mark in marks {
        let _ = writeln!(content, "{}", operators(mark));
    }
    content
}

fn operators(mark: &Mark) -> String {
    match mark {
        Mark::Line { from_mm, to_mm, width_mm } => {
            let [[x1, y1], [x2, y2]] = [from_mm, to_mm].map(|place_mm| place_mm.map(number));
            format!("{width_mm} w {x1} {y1} m {x2} {y2} l S")
        }
        Mark::Circle { centre_mm, radius_mm, width_mm } => circle(*centre_mm, *radius_mm, *width_mm),
        Mark::Text { at_mm, size_mm, text } => {
            let [x, y] = at_mm.map(number);
            let text: String = text.chars().map(escaped).collect();
            // The page is upside down, letters are not.
            format!("BT /F1 {size_mm} Tf 1 0 0 -1 {x} {y} Tm ({text}) Tj ET")
        }
    }
}

/// Four quarters, from the right end on.
fn circle([x_mm, y_mm]: [f64; 2], radius_mm: f64, width_mm: f64) -> String {
    let mut path = format!("{width_mm} w {} {} m", number(x_mm + radius_mm), number(y_mm));
    let mut towards = [1.0, 0.0];
    for _ in 0..4 {
        let [cos, sin] = towards;
        let turned = [-sin, cos];
        let control = [
            [cos + QUARTER * turned[0], sin + QUARTER * turned[1]],
            [turned[0] + QUARTER * cos, turned[1] + QUARTER * sin],
            turned,
        ];
        path.push('\n');
        for [x, y] in control {
            let _ = write!(path, "{} {} ", number(x_mm + radius_mm * x), number(y_mm + radius_mm * y));
        }
        path.push('c');
        towards = turned;
    }
    path + " S"
}

/// A letter of a text in parentheses. The standard font has the letters of Latin-1; for others stands a question mark.
fn escaped(letter: char) -> String {
    match letter {
        '(' | ')' | '\\' => format!("\\{letter}"),
        ' '..='~' => letter.into(),
        '\u{a0}'..='\u{ff}' => format!("\\{:03o}", u32::from(letter)),
        _ => '?'.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::play::sheet::mark::A4_MM;

    #[test]
    fn the_table_says_where_each_object_begins() {
        let marks = [
            Mark::Text { at_mm: [10.0, 20.0], size_mm: 3.0, text: "a (b) \\".into() },
            Mark::Circle { centre_mm: [50.0, 60.0], radius_mm: 10.0, width_mm: 0.2 },
        ];
        let pdf = String::from_utf8(written(A4_MM, &marks)).unwrap();
        assert!(pdf.starts_with("%PDF-1.4\n") && pdf.ends_with("%%EOF\n"));
        let table: usize = pdf.rsplit("startxref\n").next().unwrap().lines().next().unwrap().parse().unwrap();
        let mut lines = pdf[table..].split_inclusive('\n');
        assert_eq!((lines.next(), lines.next()), (Some("xref\n"), Some("0 6\n")));
        assert_eq!(lines.next(), Some("0000000000 65535 f \n"));
        for (number, entry) in (1..6).zip(lines) {
            assert_eq!(entry.len(), 20, "{entry}");
            let begin: usize = entry[..10].parse().unwrap();
            assert!(pdf[begin..].starts_with(&format!("{number} 0 obj\n")), "{entry}");
        }
        assert!(pdf.contains("(a \\(b\\) \\\\) Tj"));
        let stream = pdf.split("stream\n").nth(1).unwrap();
        let length: usize = pdf.split("/Length ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert_eq!(stream.strip_suffix("end").unwrap().len(), length);
    }

    #[test]
    fn four_curves_are_a_circle() {
        let path = circle([50.0, 60.0], 10.0, 0.2);
        assert!(path.starts_with("0.2 w 60 60 m\n60 65.523 55.523 70 50 70 c\n"), "{path}");
        assert!(path.ends_with("\n50 50 c\n55.523 50 60 54.477 60 60 c S") || path.ends_with(" 60 60 c S"));
        assert_eq!(path.matches(" c").count(), 4);
    }
}
