//! The sheet with the marks that a weight is put on.

use super::Sheet;
use super::mark::A4_MM;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::marks::MARKS_MM;

/// Where the plate's centre lies on the page, from its upper left corner.
const CENTRE_MM: [f64; 2] = [105.0, 125.0];
/// A weight's foot is centred by a circle so wide.
const FOOT_RADIUS_MM: f64 = 10.0;
/// Half the length of a cross's lines.
const CROSS_MM: f64 = 3.0;
/// The bar that shows whether the printer kept the size.
const BAR_MM: f64 = 50.0;
const BAR_TOP_MM: f64 = 185.0;
/// The page's left margin.
const MARGIN_MM: f64 = 20.0;
/// Strokes.
const THIN_MM: f64 = 0.15;
const THICK_MM: f64 = 0.4;
/// Heights of letters, as fonts count them.
const TITLE_MM: f64 = 6.0;
const TEXT_MM: f64 = 3.6;

const TITLE: &str = "tactpad: marks for a known weight";
const INSTRUCTIONS: [&str; 3] = [
    "1. Print it at 100 %, not fitted to the page, and measure the bar below the plate.",
    "2. Cut the plate's outline out and tape it onto the plate, its arrow to the pad's right.",
    "3. Run tactpad calibrate --weight-g GRAMS --out my.decoder, and do what it says.",
];

impl Sheet {
    /// The marks for this pad, in true size.
    pub fn of(device: &Device) -> Self {
        let mut sheet = Self { page_mm: A4_MM, centre_mm: CENTRE_MM, scale: 1.0, marks: Vec::new() };
        sheet.words();
        sheet.circle([0.0; 2], device.plate.radius_mm(), THICK_MM);
        for (number, mark_mm) in (1..).zip(MARKS_MM) {
            sheet.mark(number, mark_mm);
        }
        sheet.arrow(device.plate.radius_mm());
        sheet.module(device);
        sheet.bar();
        sheet
    }

    fn words(&mut self) {
        self.text([MARGIN_MM, 28.0], TITLE_MM, TITLE);
        for (line, text) in INSTRUCTIONS.iter().enumerate() {
            self.text([MARGIN_MM, 42.0 + 7.0 * line as f64], TEXT_MM, text);
        }
    }

    fn mark(&mut self, number: usize, [x_mm, y_mm]: [f64; 2]) {
        self.line([x_mm - CROSS_MM, y_mm], [x_mm + CROSS_MM, y_mm], THIN_MM);
        self.line([x_mm, y_mm - CROSS_MM], [x_mm, y_mm + CROSS_MM], THIN_MM);
        self.circle([x_mm, y_mm], FOOT_RADIUS_MM, THIN_MM);
        self.text(self.on_page([x_mm - 2.8, y_mm + 0.8]), TEXT_MM, &number.to_string());
    }

    /// To the pad's right; a piece of it stays on the plate when that is cut out.
    fn arrow(&mut self, radius_mm: f64) {
        let tip_mm = radius_mm + 16.0;
        for [head_x_mm, tip_x_mm] in [[radius_mm - 1.5, radius_mm - 0.4], [tip_mm - 3.0, tip_mm]] {
            let half_mm = 0.5 * (tip_x_mm - head_x_mm);
            self.line([head_x_mm, half_mm], [tip_x_mm, 0.0], THICK_MM);
            self.line([head_x_mm, -half_mm], [tip_x_mm, 0.0], THICK_MM);
        }
        self.line([radius_mm - 4.5, 0.0], [tip_mm, 0.0], THICK_MM);
        self.text(self.on_page([tip_mm + 2.0, -1.2]), TEXT_MM, "right (+x)");
    }

    /// The film of module 0, and its name beside the plate.
    fn module(&mut self, device: &Device) {
        let (sin, cos) = device.sites.angles_deg[0].to_radians().sin_cos();
        let place = |radial_mm: f64, tangential_mm: f64| {
            let r_mm = device.sites.centre_radius_mm + radial_mm;
            [r_mm * cos - tangential_mm * sin, r_mm * sin + tangential_mm * cos]
        };
        let (radial_mm, tangential_mm) =
            (0.5 * device.stack.film_width_y_mm, 0.5 * device.stack.film_length_x_mm);
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)]
            .map(|(radial, tangential)| place(radial * radial_mm, tangential * tangential_mm));
        corners.windows(2).for_each(|side| self.line(side[0], side[1], THIN_MM));
        let beside_mm = device.plate.radius_mm() + 5.0;
        let label = [beside_mm * cos, beside_mm * sin - 12.0];
        self.line(place(radial_mm, -tangential_mm), [label[0] - 1.0, label[1] + 1.0], THIN_MM);
        self.text(self.on_page(label), TEXT_MM, "module 0 is below this frame");
    }

    fn bar(&mut self) {
        let [left_mm, right_mm] = [-0.5, 0.5].map(|share| share * BAR_MM);
        let y_mm = CENTRE_MM[1] - BAR_TOP_MM;
        self.line([left_mm, y_mm], [right_mm, y_mm], THICK_MM);
        for x_mm in [left_mm, right_mm] {
            self.line([x_mm, y_mm - 3.0], [x_mm, y_mm + 3.0], THIN_MM);
        }
        self.text(self.on_page([left_mm, y_mm - 8.0]), TEXT_MM, &format!("measure this: {BAR_MM} mm"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::play::sheet::mark::Mark;

    fn sheet() -> Sheet {
        Sheet::of(&Device::nominal())
    }

    #[test]
    fn all_of_it_lies_on_the_page_and_texts_are_plain() {
        let inside =
            |[x_mm, y_mm]: [f64; 2]| (10.0..=200.0).contains(&x_mm) && (10.0..=287.0).contains(&y_mm);
        for mark in sheet().marks {
            match mark {
                Mark::Line { from_mm, to_mm, .. } => assert!(inside(from_mm) && inside(to_mm), "{from_mm:?}"),
                Mark::Circle { centre_mm: [x_mm, y_mm], radius_mm, .. } => {
                    assert!(
                        inside([x_mm - radius_mm, y_mm - radius_mm])
                            && inside([x_mm + radius_mm, y_mm + radius_mm])
                    );
                }
                Mark::Text { at_mm: [x_mm, y_mm], size_mm, text } => {
                    // A letter of Helvetica is hardly wider than 0.56 of its size, on average over a line.
                    let end_mm = x_mm + 0.56 * size_mm * text.len() as f64;
                    assert!(text.is_ascii() && inside([x_mm, y_mm]) && inside([end_mm, y_mm]), "{text}");
                }
            }
        }
    }

    #[test]
    fn both_documents_have_the_marks_where_they_belong() {
        let (svg, pdf) = (sheet().svg(), String::from_utf8(sheet().pdf()).unwrap());
        assert!(svg.contains("width=\"210mm\" height=\"297mm\" viewBox=\"0 0 210 297\""), "{svg}");
        assert!(pdf.contains("/MediaBox [0 0 595.276 841.89]"));
        // Points per millimetre, y downwards from the upper edge.
        assert!(pdf.contains("2.834646 0 0 -2.834646 0 841.89 cm"));
        for [x_mm, y_mm] in [[105, 125], [120, 125], [90, 125], [105, 110], [105, 140]] {
            assert!(svg.contains(&format!("<circle cx=\"{x_mm}\" cy=\"{y_mm}\" r=\"10\"")), "{svg}");
            assert!(svg.contains(&format!("<line x1=\"{}\" y1=\"{y_mm}\" x2=\"{}\"", x_mm - 3, x_mm + 3)));
            // A circle begins at its right end.
            assert!(pdf.contains(&format!("{} {y_mm} m\n{} ", x_mm + 10, x_mm + 10)), "{pdf}");
            assert!(pdf.contains(&format!("{} {y_mm} m {} {y_mm} l S", x_mm - 3, x_mm + 3)), "{pdf}");
        }
        assert!(svg.contains("<circle cx=\"105\" cy=\"125\" r=\"30\"") && pdf.contains("135 125 m\n135 "));
        let bar = ("<line x1=\"80\" y1=\"185\" x2=\"130\" y2=\"185\"", "80 185 m 130 185 l S");
        assert!(svg.contains(bar.0) && pdf.contains(bar.1));
    }
}
