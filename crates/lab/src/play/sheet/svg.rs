//! The sheet as SVG.

use std::fmt::Write;

use super::mark::{Mark, number};

/// The document; its user unit is the millimetre.
pub(super) fn written([width, height]: [f64; 2], marks: &[Mark]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
         <g fill=\"none\" stroke=\"black\" font-family=\"Helvetica, Arial, sans-serif\">\n"
    );
    for mark in marks {
        // Writing into a string never fails.
        let _ = writeln!(svg, "{}", element(mark));
    }
    svg.push_str("</g>\n</svg>\n");
    svg
}

fn element(mark: &Mark) -> String {
    match mark {
        Mark::Line { from_mm, to_mm, width_mm } => {
            let [[x1, y1], [x2, y2]] = [from_mm, to_mm].map(|place_mm| place_mm.map(number));
            format!("<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" stroke-width=\"{width_mm}\"/>")
        }
        Mark::Circle { centre_mm, radius_mm, width_mm } => {
            let [cx, cy] = centre_mm.map(number);
            let r = number(*radius_mm);
            format!("<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{r}\" stroke-width=\"{width_mm}\"/>")
        }
        Mark::Text { at_mm, size_mm, text } => {
            let [x, y] = at_mm.map(number);
            let text = escaped(text);
            format!(
                "<text x=\"{x}\" y=\"{y}\" font-size=\"{size_mm}\" fill=\"black\" stroke=\"none\">{text}</text>"
            )
        }
    }
}

/// A text between tags.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
