//! The independent influence fields, and how they are read between their points.
//!
//! The tables come from a finite-element program that shares no code with this project (second-order bricks, the whole
//! pad in 3-D): rings 1 mm apart, 72 angles, µV/N. Between the points a polynomial of the fifth degree goes through six
//! rings and six angles; across the centre the rings go on at the opposite angle.

use std::sync::LazyLock;

/// Channels per unit of Fx, Fy, Fz, in µV/N.
pub(crate) type Influence = [[f64; 3]; 9];

const RINGS: i32 = 29;
const ANGLES: i32 = 72;
const STENCIL: usize = 6;

/// One pad's influence field.
#[derive(Debug)]
pub(crate) struct Table(Vec<Influence>);

pub(crate) static NOMINAL: LazyLock<Table> = LazyLock::new(|| {
    Table::read(include_str!("../../crates/mechanics/tests/mechanics/reference/nominal.csv"))
});
/// The plate 1.15 mm thick instead of 1 mm.
pub(crate) static THICK_PLATE: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("fields/plate_1p15.csv")));
/// Module 0 moved by -0.7 mm radially and 0.9 mm tangentially.
pub(crate) static MOVED: LazyLock<Table> = LazyLock::new(|| Table::read(include_str!("fields/m0_moved.csv")));
/// Module 1 turned by -5 degrees.
pub(crate) static TURNED: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("fields/m1_turned.csv")));
/// The modulus of module 2's frame times 0.6.
pub(crate) static SOFT_FRAME: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("fields/m2_soft_frame.csv")));
/// Module 0's frame missing on its -x side.
pub(crate) static OPEN_FRAME: LazyLock<Table> =
    LazyLock::new(|| Table::read(include_str!("fields/m0_open_frame.csv")));

impl Table {
    fn read(text: &str) -> Self {
        let point = |line: &str| {
            let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            std::array::from_fn(|channel| std::array::from_fn(|axis| numbers[2 + 3 * channel + axis]))
        };
        let points: Vec<Influence> = text.lines().skip(1).map(point).collect();
        assert_eq!(points.len() as i32, 1 + RINGS * ANGLES);
        Self(points)
    }

    /// The point of a ring; rings below zero lie on the other side of the centre.
    pub(crate) fn point(&self, ring: i32, angle: i32) -> &Influence {
        let angle = if ring < 0 { angle + ANGLES / 2 } else { angle };
        match ring.abs() {
            0 => &self.0[0],
            ring => &self.0[(1 + (ring - 1) * ANGLES + angle.rem_euclid(ANGLES)) as usize],
        }
    }

    /// The field at a place in mm. Beyond the last ring the polynomial goes on, which holds for a millimetre.
    pub(crate) fn at(&self, place: [f64; 2]) -> Influence {
        let radius = place[0].hypot(place[1]);
        let angle = place[1].atan2(place[0]).to_degrees() * f64::from(ANGLES) / 360.0;
        let (ring, along) = stencil(radius, RINGS - STENCIL as i32 + 1);
        let (turn, across) = stencil(angle, i32::MAX);
        let mut field = Influence::default();
        for (i, u) in (ring..).zip(along) {
            for (j, v) in (turn..).zip(across) {
                let point = self.point(i, j);
                for (sum, value) in field.iter_mut().flatten().zip(point.iter().flatten()) {
                    *sum += u * v * value;
                }
            }
        }
        field
    }
}

/// The first of six whole numbers around a place, at most `last`, and their weights.
fn stencil(at: f64, last: i32) -> (i32, [f64; STENCIL]) {
    let first = (at.floor() as i32 - STENCIL as i32 / 2 + 1).min(last);
    let at = at - f64::from(first);
    let weight = |node: usize| -> f64 {
        let others = (0..STENCIL).filter(|other| *other != node);
        others.map(|other| (at - other as f64) / (node as f64 - other as f64)).product()
    };
    (first, std::array::from_fn(weight))
}

/// A table as it is for a module other than the one it was made for, and seen in a mirror if so wished.
///
/// The pad is the same after a turn by 120 degrees, which takes module k to k + 1, and in a mirror through a module's
/// radius. The modules' axes turn and are mirrored with them, but in the mirror the tangents point the other way, so the
/// x channels change their sign.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) table: &'a Table,
    /// The module that the table changes.
    pub(crate) home: usize,
    /// The module that shall be changed.
    pub(crate) target: usize,
    pub(crate) mirrored: bool,
}

impl View<'_> {
    pub(crate) fn at(&self, place: [f64; 2]) -> Influence {
        let place = mirrored(self.mirrored, turned(place, 3 - self.target));
        let seen = self.table.at(turned(place, self.home));
        let mut field = Influence::default();
        for (channel, row) in field.iter_mut().enumerate() {
            let (module, axis) = (channel / 3, channel % 3);
            let from_target = (module + 3 - self.target) % 3;
            let from_target = if self.mirrored { (3 - from_target) % 3 } else { from_target };
            let source = 3 * ((from_target + self.home) % 3) + axis;
            let sign = if self.mirrored && axis == 0 { -1.0 } else { 1.0 };
            // A force of the target's frame, taken to the table's; so the row is taken back.
            let [along_x, along_y] = turned([seen[source][0], seen[source][1]], 3 - self.home);
            let [along_x, along_y] = turned(mirrored(self.mirrored, [along_x, along_y]), self.target);
            *row = [sign * along_x, sign * along_y, sign * seen[source][2]];
        }
        field
    }
}

/// A vector turned counter-clockwise by so many thirds.
pub(crate) fn turned(vector: [f64; 2], thirds: usize) -> [f64; 2] {
    let (sin, cos) = (f64::from((thirds % 3) as u32) * 120.0).to_radians().sin_cos();
    [cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1]]
}

fn mirrored(really: bool, vector: [f64; 2]) -> [f64; 2] {
    if really { [vector[0], -vector[1]] } else { vector }
}

/// What a contact of this force reads.
pub(crate) fn signals(field: &Influence, force: [f64; 3]) -> [f64; 9] {
    field.map(|row| row.iter().zip(force).map(|(influence, force)| influence * force).sum())
}
