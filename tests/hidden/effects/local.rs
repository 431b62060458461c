//! One module by itself: what it reads per newton on its own post, found from the tables alone.

use std::sync::LazyLock;

use crate::fields::{Influence, NOMINAL, turned};
use crate::truth::Truth;

/// A module's signals x, y, z per newton along its own x, y and into the plate on its post.
///
/// The three posts carry the contact's whole force. So a matrix takes the signals of each module to its force, the same
/// for all, and their sum in the pad's frame is 1 N wherever the contact is: least squares over the plate. By its mirror
/// a module keeps x apart from y and z. What a post carries in moments stays in the residual, some percent.
#[derive(Debug)]
pub(crate) struct Sensitivity {
    pub(crate) x: f64,
    /// Rows: signals y, z. Columns: forces along y, into the plate.
    pub(crate) yz: [[f64; 2]; 2],
}

pub(crate) static LOCAL: LazyLock<Sensitivity> = LazyLock::new(sensitivity);

fn sensitivity() -> Sensitivity {
    // Unknown: force x per signal x; force y per signals y, z; force z per signals y, z.
    let mut normal = [[0.0; 5]; 5];
    let mut right = [0.0; 5];
    for ring in 0..28 {
        for angle in 0..72 {
            let field = NOMINAL.point(ring, angle);
            for force in 0..3 {
                for (row, target) in balance(field, force) {
                    for i in 0..5 {
                        right[i] += row[i] * target * f64::from(ring);
                        for j in 0..5 {
                            normal[i][j] += row[i] * row[j] * f64::from(ring);
                        }
                    }
                }
            }
        }
    }
    let [x, yy, yz, zy, zz] = solved(normal, right);
    let determinant = yy * zz - yz * zy;
    let yz = [[zz / determinant, -yz / determinant], [-zy / determinant, yy / determinant]];
    Sensitivity { x: 1.0 / x, yz }
}

/// The balance of forces along x, y and z under a unit force: coefficients of the unknowns, and the sum.
fn balance(field: &Influence, force: usize) -> [([f64; 5], f64); 3] {
    let mut rows = [([0.0; 5], 0.0); 3];
    for module in 0..3 {
        let [tangent, radius] = [[0.0, 1.0], [1.0, 0.0]].map(|axis| turned(axis, module));
        let [x, y, z] = [0, 1, 2].map(|axis| field[3 * module + axis][force]);
        for axis in 0..2 {
            rows[axis].0[0] += tangent[axis] * x;
            rows[axis].0[1] += radius[axis] * y;
            rows[axis].0[2] += radius[axis] * z;
        }
        rows[2].0[3] += y;
        rows[2].0[4] += z;
    }
    rows[force].1 = 1.0;
    rows
}

/// Gauss's elimination with pivots on the diagonal: the matrix is positive definite.
fn solved(mut matrix: [[f64; 5]; 5], mut right: [f64; 5]) -> [f64; 5] {
    for pivot in 0..5 {
        let (row, value) = (matrix[pivot], right[pivot]);
        for other in (0..5).filter(|other| *other != pivot) {
            let share = matrix[other][pivot] / row[pivot];
            matrix[other].iter_mut().zip(row).for_each(|(cell, above)| *cell -= share * above);
            right[other] -= share * value;
        }
    }
    std::array::from_fn(|index| right[index] / matrix[index][index])
}

/// A module that stands askew reads the force on its post along its own axes.
///
/// Right-handed about the tangential axis (which points along x_local) and about the radial one; the triad of x, y and z
/// is left-handed, so about +x_local y goes to -z and about +y_local z goes to -x, seen in the triad's own order.
pub(crate) fn tilt(field: &mut Influence, truth: &Truth) {
    let [about_x, about_y] =
        ["tangential_deg", "radial_deg"].map(|name| truth.value_or_zero(name).to_radians());
    let first = 3 * truth.module();
    let local = &*LOCAL;
    let determinant = local.yz[0][0] * local.yz[1][1] - local.yz[0][1] * local.yz[1][0];
    for force in 0..3 {
        let [x, y, z] = [0, 1, 2].map(|axis| field[first + axis][force]);
        let along_x = x / local.x;
        let along_y = (local.yz[1][1] * y - local.yz[0][1] * z) / determinant;
        let pressing = (local.yz[0][0] * z - local.yz[1][0] * y) / determinant;
        // The vector's own third component is -pressing. Turning the module by a turns what it reads by -a.
        let turned_x = along_x + about_y * pressing * TILT_SIGN[1];
        let turned_y = along_y + about_x * pressing * TILT_SIGN[0];
        let turned_pressing = pressing - about_y * along_x * TILT_SIGN[1] - about_x * along_y * TILT_SIGN[0];
        field[first][force] = local.x * turned_x;
        field[first + 1][force] = local.yz[0][0] * turned_y + local.yz[0][1] * turned_pressing;
        field[first + 2][force] = local.yz[1][0] * turned_y + local.yz[1][1] * turned_pressing;
    }
}

/// Outwards is down about +x: then a pressing force pulls the post outwards along the film. Counter-clockwise is up about
/// +y: then it pulls it clockwise.
const TILT_SIGN: [f64; 2] = [1.0, -1.0];
