//! Sheets of paper: the marks that a weight is put on, in true size; and what a profile does, for the wall.
//!
//! One description of the drawing, in millimetres, and two writers: SVG and PDF.

mod mark;
mod pdf;
mod profile;
mod svg;
mod weights;

use self::mark::Mark;

/// The drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    page_mm: [f64; 2],
    /// Where the plate's centre lies on the page, from its upper left corner.
    centre_mm: [f64; 2],
    /// Millimetres of the page to one of the plate.
    scale: f64,
    marks: Vec<Mark>,
}

impl Sheet {
    /// As an SVG document.
    pub fn svg(&self) -> String {
        svg::written(self.page_mm, &self.marks)
    }

    /// As a page for a browser, which prints it.
    pub fn html(&self, title: &str) -> String {
        let title = svg::escaped(title);
        let head = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n";
        let style =
            "<style>@page { margin: 0 } body { margin: 0 } svg { display: block; margin: 0 auto }</style>\n";
        format!("{head}<title>{title}</title>\n{style}{}</html>\n", self.svg())
    }

    /// As a PDF document.
    pub fn pdf(&self) -> Vec<u8> {
        pdf::written(self.page_mm, &self.marks)
    }

    /// A line between two places of the plate.
    fn line(&mut self, from_mm: [f64; 2], to_mm: [f64; 2], width_mm: f64) {
        let [from_mm, to_mm] = [from_mm, to_mm].map(|place_mm| self.on_page(place_mm));
        self.marks.push(Mark::Line { from_mm, to_mm, width_mm });
    }

    /// A circle around a place of the plate.
    fn circle(&mut self, centre_mm: [f64; 2], radius_mm: f64, width_mm: f64) {
        let (centre_mm, radius_mm) = (self.on_page(centre_mm), self.scale * radius_mm);
        self.marks.push(Mark::Circle { centre_mm, radius_mm, width_mm });
    }

    /// A text at a place of the page.
    fn text(&mut self, at_mm: [f64; 2], size_mm: f64, text: &str) {
        self.marks.push(Mark::Text { at_mm, size_mm, text: text.into() });
    }

    /// Where a place of the plate lies on the page: y is upwards there, and downwards here.
    fn on_page(&self, [x_mm, y_mm]: [f64; 2]) -> [f64; 2] {
        [self.centre_mm[0] + self.scale * x_mm, self.centre_mm[1] - self.scale * y_mm]
    }
}
