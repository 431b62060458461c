//! An influence field: nine channels per newton at any contact point, with their slopes.
//!
//! It gives what an ideal pad reports for a given contact. It is a bicubic spline on a square grid, made once from
//! the simulator's solution: twice continuously differentiable, the same on every machine, and quick to evaluate.

use std::f64::consts::SQRT_2;

use crate::bytes::{Reader, push_floats};
use crate::quantity::{CHANNELS, Contact, Strain};

/// Step of the differences that make second derivatives.
const STEP_MM: f64 = 0.5;

/// Maps of a field: for each channel one for Fx, Fy and Fz.
pub const MAPS: usize = 3 * CHANNELS;

/// Microvolts per newton at one place, for Fx, Fy (along +x, +y) and Fz (pressing) of each channel, and how they change
/// per millimetre along +x and +y. A pad has nine channels; studies have other numbers of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<Rows = [[f64; 3]; CHANNELS]> {
    /// µV/N.
    pub value: Rows,
    /// µV/N per mm along +x.
    pub dx: Rows,
    /// µV/N per mm along +y.
    pub dy: Rows,
}

/// One grid point's spline coefficients: Fx, Fy, Fz of the first channel, then of the next one.
type Node = [f32; MAPS];

/// Channel readings per newton of contact force, anywhere on the plate.
///
/// Cubic B-splines in x and y on a square grid, M. Unser, IEEE Signal Processing Magazine 16 (1999) 22.
#[derive(Clone, Debug, PartialEq)]
pub struct InfluenceField {
    /// Distance of the grid's lines.
    spacing_mm: f32,
    /// Contacts farther from the centre are taken at this radius.
    radius_mm: f32,
    /// Grid points on each side of the centre.
    half: usize,
    /// (2 half + 1)² points, line by line from −y to +y, each from −x to +x; zero beyond the reach.
    nodes: Vec<Node>,
}

impl InfluenceField {
    /// The field that takes the values of `maps` (µV/N at a place in millimetres), which are asked for up to
    /// `rim_mm` from the centre. Contacts reach up to `radius_mm`, which is at most the rim.
    pub fn sampled(
        spacing_mm: f64,
        radius_mm: f64,
        rim_mm: f64,
        maps: impl Fn([f64; 2]) -> [f64; MAPS],
    ) -> Self {
        let half = half(spacing_mm, radius_mm);
        let side = 2 * half + 1;
        let place = |k: usize| (k as f64 - half as f64) * spacing_mm;
        let samples: Vec<[f64; MAPS]> = (0..side * side)
            .map(|index| continued([place(index % side), place(index / side)], spacing_mm, rim_mm, &maps))
            .collect();
        let mut field = Self {
            spacing_mm: spacing_mm as f32,
            radius_mm: radius_mm as f32,
            half,
            nodes: spline_coefficients(samples, side),
        };
        field.forget_what_nobody_reaches();
        field
    }

    /// The field with the given coefficients: those of all grid points that a contact can reach, line by line. `None`
    /// if their number is wrong, or a number is not finite or not positive where it must be.
    pub fn from_coefficients(spacing_mm: f32, radius_mm: f32, coefficients: &[f32]) -> Option<Self> {
        let usable = spacing_mm > 0.0 && radius_mm > 0.0 && radius_mm < 1e3 * spacing_mm;
        if !usable || !coefficients.iter().all(|c| c.is_finite()) {
            return None;
        }
        let half = half(spacing_mm.into(), radius_mm.into());
        let side = 2 * half + 1;
        let mut field = Self { spacing_mm, radius_mm, half, nodes: vec![[0.0; MAPS]; side * side] };
        let reached: Vec<usize> = field.reached().collect();
        let (given, rest) = coefficients.as_chunks::<MAPS>();
        if !rest.is_empty() || given.len() != reached.len() {
            return None;
        }
        for (index, node) in reached.into_iter().zip(given) {
            field.nodes[index] = *node;
        }
        Some(field)
    }

    /// The coefficients for [`Self::from_coefficients`].
    pub fn coefficients(&self) -> Vec<f32> {
        self.reached().flat_map(|index| self.nodes[index]).collect()
    }

    /// The field of a pad all of whose channels read so many times what they read.
    #[must_use]
    pub fn scaled(&self, by: f64) -> Self {
        let scaled = |node: &Node| node.map(|coefficient| (by * f64::from(coefficient)) as f32);
        Self { nodes: self.nodes.iter().map(scaled).collect(), ..*self }
    }

    /// Writes spacing, radius and coefficients.
    pub(crate) fn write(&self, to: &mut Vec<u8>) {
        to.extend([self.spacing_mm, self.radius_mm].iter().flat_map(|mm| mm.to_le_bytes()));
        push_floats(to, &self.coefficients());
    }

    /// Reads what [`Self::write`] wrote.
    pub(crate) fn read(from: &mut Reader<'_>) -> Option<Self> {
        let (spacing_mm, radius_mm) = (from.float()?, from.float()?);
        Self::from_coefficients(spacing_mm, radius_mm, &from.floats()?)
    }

    /// Distance of the grid's lines.
    pub fn spacing_mm(&self) -> f32 {
        self.spacing_mm
    }

    /// Farthest contact from the centre.
    pub fn radius_mm(&self) -> f32 {
        self.radius_mm
    }

    /// Grid points whose splines reach a contact's place: a square of two lines around it, seen from the centre.
    fn reached(&self) -> impl Iterator<Item = usize> + use<> {
        let (side, half) = (2 * self.half + 1, self.half as f64);
        let reach = f64::from(self.radius_mm) / f64::from(self.spacing_mm) + 2.0 * SQRT_2;
        (0..side * side).filter(move |index| {
            let (x, y) = ((index % side) as f64 - half, (index / side) as f64 - half);
            x.hypot(y) <= reach
        })
    }

    fn forget_what_nobody_reaches(&mut self) {
        let mut kept = vec![[0.0; MAPS]; self.nodes.len()];
        for index in self.reached() {
            kept[index] = self.nodes[index];
        }
        self.nodes = kept;
    }

    /// Gains of each channel at a place, µV/N, and their slopes, µV/(N mm).
    ///
    /// A place beyond [`Self::radius_mm`] reads as the one at that radius on the same ray: the field ends where a
    /// finger would reach over the rim. A place that is not finite reads as the centre.
    pub fn gains(&self, x_mm: f32, y_mm: f32) -> Gains {
        let [x, y] = self.within([x_mm, y_mm]).map(|mm| mm / self.spacing_mm + self.half as f32);
        // G(x, y) = Σᵢⱼ cᵢⱼ β(x/h − i) β(y/h − j) over the sixteen grid points around the place, h being the spacing.
        let (column, row) = (libm::floorf(x), libm::floorf(y));
        let across = Weights::at(x - column);
        let along = Weights::at(y - row);
        let first =
            (row as usize).saturating_sub(1) * (2 * self.half + 1) + (column as usize).saturating_sub(1);
        let mut sums = Sums { value: [0.0; MAPS], dx: [0.0; MAPS], dy: [0.0; MAPS] };
        for line in 0..4 {
            let start = first + line * (2 * self.half + 1);
            if let Some(nodes) = self.nodes.get(start..).and_then(|rest| rest.first_chunk::<4>()) {
                sums.add(nodes, &across, along.value[line], along.slope[line]);
            }
        }
        sums.gains(1.0 / self.spacing_mm)
    }

    /// ∇²G of each channel and force axis, µV/N per mm²: the sum of the second derivatives by x and y.
    ///
    /// The field is held at its rim, where it has no curvature; so that is taken a little inwards.
    pub fn laplacian(&self, [x_mm, y_mm]: [f64; 2]) -> [[f64; 3]; CHANNELS] {
        let share = (f64::from(self.radius_mm) - STEP_MM) / libm::hypot(x_mm, y_mm);
        let [x_mm, y_mm] = [x_mm, y_mm].map(|mm| share.min(1.0) * mm);
        // ∇²G ≈ [∂ₓG(x + h) − ∂ₓG(x − h) + ∂ᵧG(y + h) − ∂ᵧG(y − h)]/2h, by the spline's own slopes.
        let at = |x_mm: f64, y_mm: f64| self.gains(x_mm as f32, y_mm as f32);
        let (right, left) = (at(x_mm + STEP_MM, y_mm), at(x_mm - STEP_MM, y_mm));
        let (above, below) = (at(x_mm, y_mm + STEP_MM), at(x_mm, y_mm - STEP_MM));
        std::array::from_fn(|channel| {
            std::array::from_fn(|axis| {
                let by_x = right.dx[channel][axis] - left.dx[channel][axis];
                let by_y = above.dy[channel][axis] - below.dy[channel][axis];
                (by_x + by_y) / (2.0 * STEP_MM)
            })
        })
    }

    /// Strain that an ideal pad reports for `contact`, µV. Linear in the forces.
    ///
    /// A contact that is not finite reads zero; for the place see [`Self::gains`].
    pub fn strain_uv(&self, contact: &Contact) -> Strain {
        let forces_n = [contact.fx_n, contact.fy_n, contact.fz_n];
        if !(contact.x_mm.is_finite() && contact.y_mm.is_finite() && forces_n.iter().all(|f| f.is_finite())) {
            return Strain::default();
        }
        let gains = self.gains(contact.x_mm, contact.y_mm);
        let read = |gain: [f64; 3]| {
            gain.iter().zip(forces_n).map(|(gain, force_n)| gain * f64::from(force_n)).sum::<f64>()
        };
        Strain { uv: gains.value.map(|gain| read(gain) as f32) }
    }

    /// The place, or the one at the largest radius on the same ray.
    fn within(&self, place: [f32; 2]) -> [f32; 2] {
        let radius = libm::hypotf(place[0], place[1]);
        if radius <= self.radius_mm {
            return place;
        }
        let factor = self.radius_mm / radius;
        if factor > 0.0 { place.map(|mm| mm * factor) } else { [0.0; 2] }
    }
}

/// Grid points on each side of the centre that a contact's place needs.
fn half(spacing_mm: f64, radius_mm: f64) -> usize {
    (radius_mm / spacing_mm).ceil() as usize + 3
}

/// Weights of the four grid points around a place, and their slopes per grid step.
struct Weights {
    value: [f32; 4],
    slope: [f32; 4],
}

impl Weights {
    /// Of the cubic B-spline β, `t` in 0..=1 after the second of the four points.
    fn at(t: f32) -> Self {
        // With s = 1 − t: s³/6, ⅔ − t² + t³/2, ⅔ − s² + s³/2, t³/6, and their derivatives by t.
        let (s, t2) = (1.0 - t, t * t);
        Self {
            value: [
                s * s * s / 6.0,
                2.0 / 3.0 - t2 * (2.0 - t) / 2.0,
                2.0 / 3.0 - s * s * (1.0 + t) / 2.0,
                t2 * t / 6.0,
            ],
            slope: [-s * s / 2.0, t * (1.5 * t - 2.0), s * (2.0 - 1.5 * s), t2 / 2.0],
        }
    }
}

/// The spline and its slopes while lines of grid points are added.
struct Sums {
    value: [f32; MAPS],
    dx: [f32; MAPS],
    dy: [f32; MAPS],
}

impl Sums {
    fn add(&mut self, nodes: &[Node; 4], across: &Weights, weight: f32, slope: f32) {
        let ([a, b, c, d], [p, q, r, s]) = (across.value, across.slope);
        let [n0, n1, n2, n3] = nodes;
        for map in 0..MAPS {
            // Along the line first, then with the line's own weight: value, ∂/∂x and ∂/∂y.
            let value = a * n0[map] + b * n1[map] + c * n2[map] + d * n3[map];
            let sloped = p * n0[map] + q * n1[map] + r * n2[map] + s * n3[map];
            self.value[map] += weight * value;
            self.dx[map] += weight * sloped;
            self.dy[map] += slope * value;
        }
    }

    fn gains(&self, per_mm: f32) -> Gains {
        let shaped = |maps: &[f32; MAPS], factor: f32| {
            let mut rows = [[0.0; 3]; CHANNELS];
            rows.as_flattened_mut()
                .iter_mut()
                .zip(maps)
                .for_each(|(to, from)| *to = f64::from(factor * from));
            rows
        };
        Gains { value: shaped(&self.value, 1.0), dx: shaped(&self.dx, per_mm), dy: shaped(&self.dy, per_mm) }
    }
}

/// The maps' values at a place; beyond the rim, those of the polynomial along the ray through the last points one
/// spacing apart. There the splines need values, but no contact is.
fn continued(
    place: [f64; 2],
    spacing_mm: f64,
    rim_mm: f64,
    maps: &impl Fn([f64; 2]) -> [f64; MAPS],
) -> [f64; MAPS] {
    /// Places of the points, in spacings from the rim. Seven, so that slopes at the rim keep four digits.
    const STEPS: [f64; 7] = [0.0, -1.0, -2.0, -3.0, -4.0, -5.0, -6.0];
    let radius = place[0].hypot(place[1]);
    if radius <= rim_mm {
        return maps(place);
    }
    // Farther out a polynomial runs away. No contact feels that: what a spline takes falls to a quarter with each line.
    let t = ((radius - rim_mm) / spacing_mm).min(6.0);
    // Lagrange's polynomial: Σᵢ f(i) Πⱼ (t − j)/(i − j) over j ≠ i.
    let mut sum = [0.0; MAPS];
    for here in STEPS {
        let others = STEPS.iter().filter(|other| **other != here);
        let weight: f64 = others.map(|other| (t - other) / (here - other)).product();
        let values = maps(place.map(|mm| mm * (rim_mm + here * spacing_mm) / radius));
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
    }
    sum
}

/// Coefficients of the splines that take the given values, line by line and then column by column.
fn spline_coefficients(mut values: Vec<[f64; MAPS]>, side: usize) -> Vec<Node> {
    for line in 0..side {
        interpolate(&mut values, line * side, 1, side);
    }
    for column in 0..side {
        interpolate(&mut values, column, side, side);
    }
    values.into_iter().map(|node| node.map(|c| c as f32)).collect()
}

/// Solves (c₋ + 4c + c₊)/6 = value along one line; at its ends the spline is straight. (Thomas's algorithm.)
fn interpolate(values: &mut [[f64; MAPS]], start: usize, step: usize, count: usize) {
    let at = |k: usize| start + k * step;
    // Rows 1 … count − 2 of the system; the ends' coefficients are the values themselves. Forward elimination with the
    // pivots qₖ = 4 − 1/qₖ₋₁: dₖ = 6 vₖ − dₖ₋₁/qₖ₋₁.
    let mut pivots = vec![1.0; count];
    for k in 1..count - 1 {
        let factor = if k == 1 { 0.0 } else { 1.0 / pivots[k - 1] };
        pivots[k] = 4.0 - factor;
        let previous = values[at(k - 1)];
        let share = if k == 1 { 1.0 } else { factor };
        for (value, previous) in values[at(k)].iter_mut().zip(previous) {
            *value = 6.0 * *value - share * previous;
        }
    }
    // Backward substitution: cₖ = (dₖ − cₖ₊₁)/qₖ.
    for k in (1..count - 1).rev() {
        let next = values[at(k + 1)];
        for (value, next) in values[at(k)].iter_mut().zip(next) {
            *value = (*value - next) / pivots[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Something smooth that no cubic is.
    fn waves([x, y]: [f64; 2]) -> [f64; MAPS] {
        std::array::from_fn(|map| (0.1 * x + map as f64).sin() * (0.13 * y).cos())
    }

    fn field() -> InfluenceField {
        InfluenceField::sampled(1.0, 29.0, 30.0, waves)
    }

    fn places() -> impl Iterator<Item = [f32; 2]> {
        (0..400).map(|k| {
            let (radius, angle) = (29.0 * (k as f32 / 400.0).sqrt(), 2.4 * k as f32);
            [radius * libm::cosf(angle), radius * libm::sinf(angle)]
        })
    }

    #[test]
    fn it_takes_the_values_of_the_maps() {
        let field = field();
        for [x, y] in places() {
            let wanted = waves([x.into(), y.into()]);
            let gains = field.gains(x, y);
            for (value, wanted) in gains.value.as_flattened().iter().zip(wanted) {
                assert!((value - wanted).abs() < 2e-5, "{x} {y}: {value} {wanted}");
            }
        }
    }

    #[test]
    fn slopes_are_those_of_the_maps() {
        let field = field();
        let step = 1e-5;
        for [x, y] in places() {
            let gains = field.gains(x, y);
            let at = |dx: f64, dy: f64| waves([f64::from(x) + dx, f64::from(y) + dy]);
            let (east, west, north, south) = (at(step, 0.0), at(-step, 0.0), at(0.0, step), at(0.0, -step));
            for map in 0..MAPS {
                let dx = (east[map] - west[map]) / (2.0 * step);
                let dy = (north[map] - south[map]) / (2.0 * step);
                assert!((gains.dx.as_flattened()[map] - dx).abs() < 1e-4, "{x} {y}");
                assert!((gains.dy.as_flattened()[map] - dy).abs() < 1e-4, "{x} {y}");
            }
        }
    }

    #[test]
    fn coefficients_make_the_same_field() {
        let field = field();
        let coefficients = field.coefficients();
        let again = InfluenceField::from_coefficients(1.0, 29.0, &coefficients);
        assert_eq!(again.as_ref(), Some(&field));
        assert_eq!(InfluenceField::from_coefficients(1.0, 29.0, &coefficients[1..]), None);
        assert_eq!(InfluenceField::from_coefficients(1.0, 29.0, &coefficients[MAPS..]), None);
        assert_eq!(InfluenceField::from_coefficients(1.0, 28.0, &coefficients), None);
        assert_eq!(InfluenceField::from_coefficients(0.0, 29.0, &coefficients), None);
        assert_eq!(InfluenceField::from_coefficients(1e-9, 29.0, &coefficients), None);
        let mut bad = coefficients;
        bad[7] = f32::NAN;
        assert_eq!(InfluenceField::from_coefficients(1.0, 29.0, &bad), None);
    }

    #[test]
    fn beyond_the_radius_the_rim_counts() {
        let field = field();
        for angle in 0..40 {
            let (sin, cos) = libm::sincosf(angle as f32 * 0.157);
            let (rim, beyond) =
                (field.gains(28.999_9 * cos, 28.999_9 * sin), field.gains(1e9 * cos, 1e9 * sin));
            for (rim, beyond) in rim.value.as_flattened().iter().zip(beyond.value.as_flattened()) {
                assert!((rim - beyond).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn a_contact_that_is_not_finite_reads_zero() {
        let field = field();
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let place = Contact { x_mm: bad, fz_n: 1.0, ..Contact::default() };
            let force = Contact { fx_n: bad, ..Contact::default() };
            assert_eq!(field.strain_uv(&place), Strain::default());
            assert_eq!(field.strain_uv(&force), Strain::default());
            assert!(field.gains(bad, bad).value.as_flattened().iter().all(|gain| gain.is_finite()));
        }
    }

    #[test]
    fn readings_are_linear_in_the_forces() {
        let field = field();
        let read = |fx_n, fy_n, fz_n| field.strain_uv(&Contact { x_mm: 7.0, y_mm: -3.0, fx_n, fy_n, fz_n });
        let (x, y, z, all) =
            (read(1.0, 0.0, 0.0), read(0.0, 1.0, 0.0), read(0.0, 0.0, 1.0), read(0.5, -2.0, 3.0));
        for channel in 0..CHANNELS {
            let sum = 0.5 * x.uv[channel] - 2.0 * y.uv[channel] + 3.0 * z.uv[channel];
            assert!((sum - all.uv[channel]).abs() < 1e-5);
        }
    }
}
