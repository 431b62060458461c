//! The influence field of the nominal pad: nine channels per newton at any contact point.
//!
//! It says what an ideal pad would report for a given contact. The virtual pad and the tests use it; the way
//! from bytes to events does not. The values come from a finite-element solution of the pad in
//! `models/sstid.toml`.

use std::f32::consts::TAU;
use std::fmt;

use crate::quantity::{CHANNELS, Contact, Strain};

/// Contacts farther from the centre than this are taken at this radius, on the same ray.
pub const RADIUS_MAX_MM: f32 = 29.0;

const RINGS: usize = 30;
const RAYS: usize = 72;
const COLUMNS: usize = 3 * CHANNELS;
const GRID_TOLERANCE_MM: f32 = 1e-3;
const NOMINAL: &str = include_str!("../models/influence.csv");

/// Microvolts per newton at one place: Fx, Fy, Fz of the first channel, then of the next one.
type Node = [f32; COLUMNS];

/// Channel readings per newton of contact force, on a polar grid, with interpolation between its nodes.
///
/// The interpolation is bicubic (Catmull and Rom's cubic): periodic in angle, and in radius along whole
/// diameters, so that it is smooth across the centre. At a node it returns the node. With every second ring
/// or ray left out, what was left out is recovered within 2.4 µV/N of a field that reaches 2,400 µV/N (over
/// the edges of the posts; 0.1 µV/N nearer the centre); the whole grid is closer still.
#[derive(Clone, Debug)]
pub struct InfluenceField {
    /// `RINGS` × `RAYS` nodes; the first ring holds the centre node in every ray.
    nodes: Vec<Node>,
}

/// A field file that does not hold the polar grid.
#[derive(Debug, PartialEq, Eq)]
pub struct FieldError {
    /// Line of the file, from 1.
    pub line: usize,
    /// What is wrong there.
    pub problem: FieldProblem,
}

/// What can be wrong with a line of a field file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldProblem {
    /// The line is not 29 finite numbers.
    Numbers,
    /// The place is not the next one of the grid.
    Place,
    /// The file ends here or goes on after the last place.
    Length,
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let problem = match self.problem {
            FieldProblem::Numbers => "expected x_mm, y_mm and 27 readings per newton, all finite numbers",
            FieldProblem::Place => "expected the centre, then rings at 1 to 29 mm with a place every 5°",
            FieldProblem::Length => "expected 2,089 places in all",
        };
        write!(f, "influence field, line {}: {problem}", self.line)
    }
}

impl std::error::Error for FieldError {}

impl InfluenceField {
    /// The field of the pad in `models/sstid.toml`.
    #[expect(clippy::expect_used, reason = "the file is part of the program and a test reads it")]
    pub fn nominal() -> Self {
        Self::from_csv(NOMINAL).expect("models/influence.csv holds the grid")
    }

    /// Reads a field: a header line, the centre, then rings at 1, 2, … 29 mm with a place every 5° from +x,
    /// counter-clockwise. Columns: `x_mm`, `y_mm`, then for each channel the microvolts per newton of Fx, Fy,
    /// Fz.
    ///
    /// # Errors
    /// The first line that is not as described.
    pub fn from_csv(text: &str) -> Result<Self, FieldError> {
        let mut lines = text.lines().enumerate().skip(1);
        let mut nodes = Vec::with_capacity(RINGS * RAYS);
        for ring in 0..RINGS {
            let places = if ring == 0 { 1 } else { RAYS };
            for ray in 0..places {
                let (index, line) = lines.next().ok_or_else(|| length_error(text))?;
                let node = parse_node(line, ring, ray);
                nodes.push(node.map_err(|problem| FieldError { line: index + 1, problem })?);
            }
            while let (0, Some(&centre)) = (ring, nodes.last())
                && nodes.len() < RAYS
            {
                nodes.push(centre);
            }
        }
        if lines.next().is_some() { Err(length_error(text)) } else { Ok(Self { nodes }) }
    }

    /// What the nominal pad reports for `contact`, in microvolts. Linear in the forces.
    ///
    /// A contact beyond [`RADIUS_MAX_MM`] reads as one at that radius on the same ray: the field ends where a
    /// finger would reach over the rim. A contact that is not finite reads zero.
    pub fn strain_uv(&self, contact: &Contact) -> Strain {
        let mut strain = Strain::default();
        let forces_n = [contact.fx_n, contact.fy_n, contact.fz_n];
        if !(contact.x_mm.is_finite() && contact.y_mm.is_finite() && forces_n.iter().all(|f| f.is_finite())) {
            return strain;
        }
        let gains = self.per_newton(contact.x_mm, contact.y_mm);
        for (uv, gain) in strain.uv.iter_mut().zip(gains.as_chunks::<3>().0) {
            *uv = gain.iter().zip(forces_n).map(|(gain, force_n)| gain * force_n).sum();
        }
        strain
    }

    fn per_newton(&self, x_mm: f32, y_mm: f32) -> Node {
        let radius = libm::hypotf(x_mm, y_mm).min(RADIUS_MAX_MM);
        let angle = libm::atan2f(y_mm, x_mm) / TAU * RAYS as f32;
        let (ring, along) = (libm::floorf(radius), libm::floorf(angle));
        let ring_weights = cubic_weights(radius - ring);
        let ray_weights = cubic_weights(angle - along);
        let mut sum = [0.0; COLUMNS];
        for (ring, ring_weight) in (ring as i32 - 1..).zip(ring_weights) {
            for (ray, ray_weight) in (along as i32 - 1..).zip(ray_weights) {
                let node = self.node(ring, ray);
                for (sum, value) in sum.iter_mut().zip(node) {
                    *sum += ring_weight * ray_weight * value;
                }
            }
        }
        sum
    }

    /// The node at signed radius `ring` mm of ray `ray`; beyond the last ring the parabola through the last
    /// three.
    fn node(&self, ring: i32, ray: i32) -> Node {
        let last = RINGS as i32 - 1;
        if ring <= last {
            return self.grid_node(ring, ray);
        }
        let [a, b, c] = [0, 1, 2].map(|inward| self.grid_node(last - inward, ray));
        std::array::from_fn(|k| match (a.get(k), b.get(k), c.get(k)) {
            (Some(a), Some(b), Some(c)) => 3.0 * (a - b) + c,
            _ => 0.0,
        })
    }

    /// A negative radius lies on the opposite ray.
    fn grid_node(&self, ring: i32, ray: i32) -> Node {
        let opposite = if ring < 0 { RAYS as i32 / 2 } else { 0 };
        let ray = (ray + opposite).rem_euclid(RAYS as i32) as usize;
        let index = ring.unsigned_abs() as usize * RAYS + ray;
        self.nodes.get(index).copied().unwrap_or([0.0; COLUMNS])
    }
}

fn length_error(text: &str) -> FieldError {
    FieldError { line: text.lines().count(), problem: FieldProblem::Length }
}

fn parse_node(line: &str, ring: usize, ray: usize) -> Result<Node, FieldProblem> {
    let mut numbers = [0.0; 2 + COLUMNS];
    let mut fields = line.split(',');
    for number in &mut numbers {
        let parsed = fields.next().and_then(|field| field.trim().parse::<f32>().ok());
        *number = parsed.filter(|value| value.is_finite()).ok_or(FieldProblem::Numbers)?;
    }
    if fields.next().is_some() {
        return Err(FieldProblem::Numbers);
    }
    let [x_mm, y_mm, node @ ..] = numbers;
    let (sin, cos) = libm::sincosf(ray as f32 / RAYS as f32 * TAU);
    let off_mm = libm::hypotf(x_mm - ring as f32 * cos, y_mm - ring as f32 * sin);
    if off_mm <= GRID_TOLERANCE_MM { Ok(node) } else { Err(FieldProblem::Place) }
}

/// Weights of the nodes at −1, 0, 1, 2 for the place `t` in 0..=1.
///
/// Source: E. Catmull and R. Rom, "A class of local interpolating splines", 1974.
fn cubic_weights(t: f32) -> [f32; 4] {
    [
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (-2.5 + 1.5 * t),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (-0.5 + 0.5 * t),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_loads() -> [[f32; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    }

    fn at_polar(radius_mm: f32, angle_deg: f32, [fx_n, fy_n, fz_n]: [f32; 3]) -> Contact {
        let (sin, cos) = libm::sincosf(angle_deg.to_radians());
        Contact { x_mm: radius_mm * cos, y_mm: radius_mm * sin, fx_n, fy_n, fz_n }
    }

    fn worst_difference_uv(a: &Strain, b: &Strain) -> f32 {
        a.uv.iter().zip(b.uv).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }

    #[test]
    fn nodes_read_as_the_file_says() {
        let field = InfluenceField::nominal();
        for line in NOMINAL.lines().skip(1) {
            let row: Vec<f32> = line.split(',').map(|number| number.parse().unwrap()).collect();
            for (axis, [fx_n, fy_n, fz_n]) in unit_loads().into_iter().enumerate() {
                let contact = Contact { x_mm: row[0], y_mm: row[1], fx_n, fy_n, fz_n };
                let strain = field.strain_uv(&contact);
                for (channel, uv) in strain.uv.iter().enumerate() {
                    let wanted = row[2 + 3 * channel + axis];
                    // The file's places are rounded to 0.1 µm, the steepest slope is 300 µV/N per mm.
                    assert!((uv - wanted).abs() < 0.04, "{contact:?}, channel {channel}: {uv} for {wanted}");
                }
            }
        }
    }

    /// Interpolates nodes from a grid that has only every second ray or ring; the worst error in µV/N.
    fn worst_left_out(rings: std::ops::Range<i32>, ray_step: i32, ring_step: i32) -> f32 {
        let field = InfluenceField::nominal();
        let weights = cubic_weights(0.5);
        let mut worst: f32 = 0.0;
        for ring in rings.step_by(ring_step.max(1) as usize) {
            for ray in (0..RAYS as i32).map(|ray| if ray_step > 0 { ray | 1 } else { ray }) {
                let wanted = field.grid_node(ring, ray);
                let around = [-3, -1, 1, 3]
                    .map(|step| field.grid_node(ring + step * (ring_step / 2), ray + step * ray_step));
                for column in 0..COLUMNS {
                    let guess: f32 =
                        around.iter().zip(weights).map(|(node, weight)| node[column] * weight).sum();
                    worst = worst.max((guess - wanted[column]).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn left_out_rays_are_recovered() {
        let worst = worst_left_out(1..30, 1, 0);
        println!("worst left-out ray: {worst:.2} uV/N");
        assert!(worst < 1.7, "{worst}");
    }

    #[test]
    fn left_out_rings_are_recovered() {
        let inner = worst_left_out(1..16, 0, 2);
        let outer = worst_left_out(17..26, 0, 2);
        println!("worst left-out ring: {inner:.3} uV/N inside the posts, {outer:.2} uV/N over them");
        assert!(inner < 0.1 && outer < 2.5, "{inner} {outer}");
    }

    #[test]
    fn a_third_of_a_turn_moves_the_modules_on() {
        let field = InfluenceField::nominal();
        let (sin, cos) = libm::sincosf(TAU / 3.0);
        for step in 0..300 {
            let (radius, angle) = (step as f32 * 0.0963, (step * 73 % 360) as f32);
            for [fx, fy, fz] in unit_loads() {
                let here = field.strain_uv(&at_polar(radius, angle, [fx, fy, fz]));
                let turned = [cos * fx - sin * fy, sin * fx + cos * fy, fz];
                let there = field.strain_uv(&at_polar(radius, angle + 120.0, turned));
                let moved = Strain { uv: std::array::from_fn(|k| here.uv[(k + 6) % CHANNELS]) };
                // The file's own nodes keep the symmetry to 0.17 µV/N.
                assert!(worst_difference_uv(&there, &moved) < 0.25, "{radius} mm, {angle}°");
            }
        }
    }

    #[test]
    fn the_field_is_smooth_across_the_centre_and_the_zero_angle() {
        let field = InfluenceField::nominal();
        let small = 1e-3;
        for load in unit_loads() {
            let centre = field.strain_uv(&at_polar(0.0, 0.0, load));
            for ray in 0..40 {
                let near = field.strain_uv(&at_polar(small, ray as f32 * 9.0, load));
                assert!(worst_difference_uv(&centre, &near) < 0.1);
            }
            let below = field.strain_uv(&at_polar(17.5, -0.001, load));
            let above = field.strain_uv(&at_polar(17.5, 0.001, load));
            assert!(worst_difference_uv(&below, &above) < 0.1);
        }
    }

    #[test]
    fn beyond_the_grid_the_rim_counts() {
        let field = InfluenceField::nominal();
        let rim = field.strain_uv(&at_polar(29.0, 37.0, [0.3, -0.4, 2.0]));
        let beyond = field.strain_uv(&at_polar(1e9, 37.0, [0.3, -0.4, 2.0]));
        assert!(worst_difference_uv(&rim, &beyond) < 0.05);
        assert!(rim.uv.iter().any(|uv| uv.abs() > 100.0));
    }

    #[test]
    fn a_contact_that_is_not_finite_reads_zero() {
        let field = InfluenceField::nominal();
        for bad in [f32::NAN, f32::INFINITY] {
            let place = Contact { x_mm: bad, fz_n: 1.0, ..Contact::default() };
            let force = Contact { fx_n: bad, ..Contact::default() };
            assert_eq!(field.strain_uv(&place), Strain::default());
            assert_eq!(field.strain_uv(&force), Strain::default());
        }
    }

    #[test]
    fn a_bad_file_is_refused_with_its_line() {
        let refused = |text: &str| InfluenceField::from_csv(text).unwrap_err();
        let cut: Vec<&str> = NOMINAL.lines().take(2000).collect();
        assert_eq!(refused(&cut.join("\n")), FieldError { line: 2000, problem: FieldProblem::Length });
        assert_eq!(refused(&format!("{NOMINAL}0,0\n")).problem, FieldProblem::Length);
        let word = NOMINAL.replacen("242.49", "many", 1);
        assert_eq!(refused(&word), FieldError { line: 2, problem: FieldProblem::Numbers });
        let moved = NOMINAL.replacen("0.9962,0.0872", "0.9962,0.0900", 1);
        assert_eq!(refused(&moved), FieldError { line: 4, problem: FieldProblem::Place });
        assert!(refused(&moved).to_string().contains("line 4"));
    }
}
