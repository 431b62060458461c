//! A figure as PNG, drawn by tiny-skia from the same marks and outlines as the SVG.

use std::fmt;

use tiny_skia::{FillRule, LineJoin, Paint, PathBuilder, Pixmap, StrokeDash, Transform};

use super::figure::{Circle, Ends, Figure, Ink, Mark, Path, Stroke, Text};
use super::font;

/// The letters of a glyph's outline.
const COMMANDS: [char; 4] = ['m', 'l', 'q', 'z'];
/// Pixels along a side of the largest picture.
const SIDE_MAX: f64 = 20_000.0;

/// A figure that no PNG can hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PngError {
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
}

impl fmt::Display for PngError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { width, height } = self;
        write!(f, "a picture of {width} × {height} pixels: each side must have 1 to {SIDE_MAX} pixels")
    }
}

impl std::error::Error for PngError {}

/// The figure as a PNG file with `scale` picture elements per CSS pixel (1 for a screen, 3 for print).
///
/// # Errors
/// A side of less than one or more than 20,000 picture elements, or more of them than memory holds.
pub fn bytes(figure: &Figure, scale: f64) -> Result<Vec<u8>, PngError> {
    let [width, height] = figure.size().map(|side| (side * scale).round());
    let error = PngError { width, height };
    if ![width, height].iter().all(|side| (1.0..=SIDE_MAX).contains(side)) {
        return Err(error);
    }
    let mut canvas = Canvas {
        pixmap: Pixmap::new(width as u32, height as u32).ok_or(error)?,
        page: Transform::from_scale(scale as f32, scale as f32),
    };
    canvas.pixmap.fill(tiny_skia::Color::WHITE);
    figure.marks().iter().for_each(|mark| canvas.draw(mark));
    canvas.pixmap.encode_png().map_err(|_| error)
}

struct Canvas {
    pixmap: Pixmap,
    /// From CSS pixels to picture elements.
    page: Transform,
}

impl Canvas {
    fn draw(&mut self, mark: &Mark) {
        match mark {
            Mark::Path(path) => self.paint(path_of(path), path.fill, path.stroke),
            Mark::Circle(circle) => self.paint(circle_of(circle), circle.fill, circle.stroke),
            Mark::Text(text) => self.write(text),
        }
    }

    fn paint(&mut self, path: Option<tiny_skia::Path>, fill: Option<Ink>, stroke: Option<Stroke>) {
        let Some(path) = path else { return };
        if let Some(ink) = fill {
            self.pixmap.fill_path(&path, &paint_of(ink), FillRule::EvenOdd, self.page, None);
        }
        if let Some(stroke) = stroke {
            self.pixmap.stroke_path(&path, &paint_of(stroke.ink), &stroke_of(stroke), self.page, None);
        }
    }

    fn write(&mut self, text: &Text) {
        let [x, y] = text.at.map(|coordinate| coordinate as f32);
        let size = text.size as f32;
        let line = self.page.pre_translate(x, y).pre_rotate(text.turn_deg as f32).pre_scale(size, size);
        let start = (text.offset() / text.size) as f32;
        for placed in font::lay_out(&text.text, text.weight).0 {
            let Some(outline) = outline(placed.glyph.outline) else { continue };
            let scale = (placed.scale / font::UNITS) as f32;
            let place = line.pre_translate(start + placed.x as f32, -placed.rise as f32);
            let place = place.pre_scale(scale, scale);
            self.pixmap.fill_path(&outline, &paint_of(text.ink), FillRule::Winding, place, None);
        }
    }
}

fn paint_of(ink: Ink) -> Paint<'static> {
    let [r, g, b] = ink.colour.levels;
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, (ink.opacity * 255.0).round() as u8);
    paint
}

fn stroke_of(stroke: Stroke) -> tiny_skia::Stroke {
    tiny_skia::Stroke {
        width: stroke.width as f32,
        line_join: LineJoin::Round,
        dash: stroke.dash.and_then(|[dash, gap]| StrokeDash::new(vec![dash as f32, gap as f32], 0.0)),
        ..tiny_skia::Stroke::default()
    }
}

fn path_of(path: &Path) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for line in &path.lines {
        for (index, point) in line.iter().enumerate() {
            let [x, y] = point.map(|coordinate| coordinate as f32);
            if index == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        if path.ends == Ends::Closed {
            builder.close();
        }
    }
    builder.finish()
}

fn circle_of(circle: &Circle) -> Option<tiny_skia::Path> {
    let [x, y] = circle.centre;
    PathBuilder::from_circle(x as f32, y as f32, circle.radius as f32)
}

/// A glyph's outline; `None` for a space. The language is `font/make.py`'s: `m l q z`, all relative.
fn outline(text: &str) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    let [mut x, mut y] = [0.0, 0.0];
    let mut start = [0.0, 0.0];
    for (letter, numbers) in text.matches(COMMANDS).zip(text.split(COMMANDS).skip(1)) {
        let numbers: Vec<f32> = numbers.split(' ').filter_map(|number| number.parse().ok()).collect();
        match (letter, numbers.as_slice()) {
            ("m", [dx, dy]) => {
                [x, y] = [x + dx, y + dy];
                start = [x, y];
                builder.move_to(x, y);
            }
            ("l", [dx, dy]) => {
                [x, y] = [x + dx, y + dy];
                builder.line_to(x, y);
            }
            ("q", [ax, ay, dx, dy]) => {
                builder.quad_to(x + ax, y + ay, x + dx, y + dy);
                [x, y] = [x + dx, y + dy];
            }
            _ => {
                builder.close();
                [x, y] = start;
            }
        }
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Rgb;
    use crate::figure::Weight;

    fn drawn(figure: &Figure, scale: f64) -> Pixmap {
        Pixmap::decode_png(&bytes(figure, scale).unwrap()).unwrap()
    }

    #[test]
    fn marks_are_where_they_were_put() {
        let mut figure = Figure::new(20.0, 10.0, "");
        let red = Ink::opaque(Rgb::new(200, 0, 0));
        figure.path(Path { fill: Some(red), ..Path::rectangle([10.0, 0.0], [10.0, 10.0]) });
        let picture = drawn(&figure, 2.0);
        assert_eq!((picture.width(), picture.height()), (40, 20));
        let colour = |x, y| picture.pixel(x, y).map(|pixel| [pixel.red(), pixel.green()]);
        assert_eq!([colour(19, 10), colour(20, 10)], [Some([255, 255]), Some([200, 0])]);
    }

    /// The rows and columns of the picture that are not white.
    fn inked(picture: &Pixmap) -> [std::ops::RangeInclusive<u32>; 2] {
        let dark = |x, y| picture.pixel(x, y).is_some_and(|pixel| pixel.red() < 128);
        let [mut xs, mut ys] = [vec![], vec![]];
        for (x, y) in (0..picture.height()).flat_map(|y| (0..picture.width()).map(move |x| (x, y))) {
            if dark(x, y) {
                xs.push(x);
                ys.push(y);
            }
        }
        [xs, ys].map(|all| *all.iter().min().unwrap()..=*all.iter().max().unwrap())
    }

    #[test]
    fn text_stands_on_its_baseline_as_wide_as_told() {
        let mut figure = Figure::new(200.0, 60.0, "");
        let text = Text::new("HHHHH", [20.0, 40.0], 30.0, Ink::opaque(Rgb::new(0, 0, 0)));
        let width = font::width("HHHHH", 30.0, Weight::Regular);
        figure.text(text);
        let [xs, ys] = inked(&drawn(&figure, 1.0));
        // A capital of Inter is 0.727 em high; H keeps 0.088 em clear at either side.
        assert!((39..=40).contains(ys.end()) && (17..=19).contains(ys.start()), "{ys:?}");
        assert!((f64::from(*xs.start()) - 20.0).abs() < 4.0 && *xs.start() >= 20, "{xs:?}");
        assert!((f64::from(*xs.end()) - 20.0 - width).abs() < 4.0, "{xs:?} {width}");
    }

    #[test]
    fn every_glyph_is_an_outline_inside_its_line() {
        for code in (' '..='~').chain('¡'..='ÿ').filter(|code| *code != '\u{ad}') {
            let (placed, _) = font::lay_out(&code.to_string(), Weight::SemiBold);
            let glyph = placed[0].glyph;
            assert_eq!(glyph.code, code);
            let Some(outline) = outline(glyph.outline) else {
                assert_eq!(code, ' ');
                continue;
            };
            let bounds = outline.bounds();
            assert!(bounds.top() > -1000.0 && bounds.bottom() < 300.0, "{code}: {bounds:?}");
            assert!(bounds.left() > -150.0 && f64::from(bounds.right()) < glyph.advance + 150.0, "{code}");
        }
    }

    #[test]
    fn impossible_sizes_are_refused() {
        for (width, scale) in
            [(0.0, 1.0), (f64::NAN, 1.0), (10.0, f64::INFINITY), (10.0, -1.0), (30_000.0, 1.0)]
        {
            let error = bytes(&Figure::new(width, 10.0, ""), scale).unwrap_err();
            assert!(error.to_string().contains("1 to 20000 pixels"), "{error}");
        }
    }
}
