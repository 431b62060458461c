//! The icons: light shapes with a dark rim, so that light and dark panels show them, and each of another shape.

use tiny_skia::{Color, FillRule, LineCap, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};
use tray_icon::Icon;

use crate::tray::icon_state::IconState;

/// Twice the usual height of a panel's icons.
pub(super) const SIDE_PX: u32 = 44;

const CENTRE_PX: f32 = 22.0;
const RADIUS_PX: f32 = 15.5;
const LINE_PX: f32 = 5.0;
const RIM_PX: f32 = 3.0;

/// A part of an icon.
enum Shape {
    Line(Path),
    Area(Path),
}

/// The icon for `icon_state`; `None` only where there is no memory for it.
pub(super) fn draw(icon_state: IconState) -> Option<Icon> {
    Icon::from_rgba(pixels(icon_state)?, SIDE_PX, SIDE_PX).ok()
}

/// Its pixels: red, green, blue and opacity, from the top left.
fn pixels(icon_state: IconState) -> Option<Vec<u8>> {
    let mut picture = Pixmap::new(SIDE_PX, SIDE_PX)?;
    let parts = parts(icon_state)?;
    parts.iter().for_each(|part| part.draw(&mut picture, Color::from_rgba8(24, 28, 34, 255), RIM_PX));
    parts.iter().for_each(|part| part.draw(&mut picture, colour(icon_state), 0.0));
    let straight = picture.pixels().iter().map(|pixel| pixel.demultiply());
    Some(straight.flat_map(|it| [it.red(), it.green(), it.blue(), it.alpha()]).collect())
}

/// The colour says again what the shape says.
fn colour(icon_state: IconState) -> Color {
    match icon_state {
        IconState::NoPad | IconState::Paused => Color::from_rgba8(205, 210, 216, 255),
        IconState::Idle | IconState::Contact => Color::WHITE,
        IconState::Pressed => Color::from_rgba8(126, 222, 140, 255),
        IconState::Fault => Color::from_rgba8(255, 186, 48, 255),
    }
}

/// The pad is a disc, seen from above.
fn parts(icon_state: IconState) -> Option<Vec<Shape>> {
    let disc = |radius_px| PathBuilder::from_circle(CENTRE_PX, CENTRE_PX, radius_px);
    let bar = |left: f32, top: f32, width: f32, height: f32| {
        Some(Shape::Area(PathBuilder::from_rect(Rect::from_xywh(left, top, width, height)?)))
    };
    Some(match icon_state {
        IconState::NoPad => vec![Shape::Line(disc(RADIUS_PX)?), Shape::Line(slash()?)],
        IconState::Idle => vec![Shape::Line(disc(RADIUS_PX)?)],
        IconState::Contact => vec![Shape::Line(disc(RADIUS_PX)?), Shape::Area(disc(5.5)?)],
        IconState::Pressed => vec![Shape::Area(disc(RADIUS_PX + LINE_PX / 2.0)?)],
        IconState::Paused => vec![bar(10.0, 6.0, 8.0, 32.0)?, bar(26.0, 6.0, 8.0, 32.0)?],
        IconState::Fault => vec![bar(18.0, 4.0, 8.0, 23.0)?, bar(18.0, 32.0, 8.0, 8.0)?],
    })
}

fn slash() -> Option<Path> {
    let mut path = PathBuilder::new();
    path.move_to(CENTRE_PX - 11.0, CENTRE_PX + 11.0);
    path.line_to(CENTRE_PX + 11.0, CENTRE_PX - 11.0);
    path.finish()
}

impl Shape {
    /// Draws it, and `rim_px` around it.
    fn draw(&self, picture: &mut Pixmap, colour: Color, rim_px: f32) {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(colour);
        let width =
            |line_px| Stroke { width: line_px + 2.0 * rim_px, line_cap: LineCap::Round, ..Stroke::default() };
        let here = Transform::identity();
        match self {
            Self::Line(path) => picture.stroke_path(path, &paint, &width(LINE_PX), here, None),
            Self::Area(path) => {
                picture.fill_path(path, &paint, FillRule::Winding, here, None);
                if rim_px > 0.0 {
                    picture.stroke_path(path, &paint, &width(0.0), here, None);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACES: [IconState; 6] = [
        IconState::NoPad,
        IconState::Idle,
        IconState::Contact,
        IconState::Pressed,
        IconState::Paused,
        IconState::Fault,
    ];

    /// The light parts alone at half the size, as a panel of 22 px shows them, without their colours.
    fn shape(state: IconState) -> Vec<bool> {
        let pixels = pixels(state).unwrap();
        let side = SIDE_PX as usize;
        let is_light = |x: usize, y: usize| pixels[4 * (y * side + x)] > 100;
        (0..side / 2)
            .flat_map(|y| (0..side / 2).map(move |x| (2 * x, 2 * y)))
            .map(|(x, y)| {
                [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)]
                    .iter()
                    .filter(|(x, y)| is_light(*x, *y))
                    .count()
                    > 2
            })
            .collect()
    }

    #[test]
    fn each_icon_has_a_shape_of_its_own_at_the_size_of_a_panel() {
        for (k, state) in FACES.iter().enumerate() {
            for other in &FACES[..k] {
                let differing = shape(*state).iter().zip(shape(*other)).filter(|(a, b)| **a != *b).count();
                assert!(differing >= 20, "{state:?} and {other:?} differ in {differing} of 484 pixels");
            }
        }
    }

    #[test]
    fn each_icon_stands_out_from_light_and_from_dark() {
        for state in FACES {
            let pixels = pixels(state).unwrap();
            let opaque: Vec<_> = pixels.chunks(4).filter(|pixel| pixel[3] == 255).collect();
            let count = |holds: &dyn Fn(u8) -> bool| opaque.iter().filter(|pixel| holds(pixel[1])).count();
            let (light, dark) = (count(&|green| green > 180), count(&|green| green < 60));
            assert!(light > 200 && dark > 200, "{state:?}: {light} light and {dark} dark pixels");
            // Nothing is cut off at the rim of the picture.
            let side = SIDE_PX as usize;
            assert!(
                (0..side).all(|k| [k, side * (side - 1) + k, side * k, side * k + side - 1]
                    .iter()
                    .all(|at| pixels[4 * at + 3] == 0)),
                "{state:?}"
            );
        }
    }
}
