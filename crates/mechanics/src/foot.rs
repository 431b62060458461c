//! Where a module's foot meets the plate.

use faer::Mat;

use tactpad_core::pad::device::pose::Pose;
use tactpad_core::pad::device::{Device, Module, Stack};
use tactpad_numeric::zernike::{count, jets};

use super::plate::FIELDS;
use super::superelement::{FOOT_SHAPES, MODES, foot_shapes};

/// Gauss-Legendre rule with 8 points on [−1, 1], one half (M. Abramowitz, I. A. Stegun, table 25.4): places, weights.
/// Exact for a parabola times a polynomial of degree 13: over a foot the plate's fields are no rougher than that.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// A module's foot on the plate's underside, in the pad frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    /// Its centre.
    pub(super) centre_mm: [f64; 2],
    /// Where its edges point: the module's x and y before any tilt, unit vectors in the pad's plane.
    edges: [[f64; 2]; 2],
    /// Half its sizes along these edges.
    half_mm: [f64; 2],
    /// The module's axes x, y, z in the pad frame, tilted with the module.
    pub(super) axes: [[f64; 3]; 3],
}

impl Foot {
    /// The foot of a module of the device.
    pub(super) fn of(device: &Device, module: usize) -> Self {
        Self::at(&device.poses()[module], &device.modules[module], &device.stack)
    }

    /// The foot of a module that stands there.
    ///
    /// A tilted module's axes turn, its foot stays where it is: the bond fills the wedge.
    pub(super) fn at(pose: &Pose, state: &Module, stack: &Stack) -> Self {
        let edges = [pose.along_x, pose.along_y];
        let [x, y] = edges.map(|[x, y]| [x, y, 0.0]);
        let tilted =
            |axis: [f64; 3]| rotated(rotated(axis, y, state.tilt_radial_deg), x, state.tilt_tangential_deg);
        let half_mm = [stack.post_length_x_mm / 2.0, stack.post_width_y_mm / 2.0];
        Self { centre_mm: pose.centre_mm, edges, half_mm, axes: [x, y, [0.0, 0.0, 1.0]].map(tilted) }
    }

    /// The matrix from the plate's unknowns to the foot's modes (along the module's axes): the underside's
    /// displacement over the foot, projected on the foot's polynomials. Shape `MODES` × unknowns.
    pub(super) fn modes(&self, degree: usize, radius_mm: f64, thickness_mm: f64) -> Mat<f64> {
        let means = self.means(degree, radius_mm);
        let size = count(degree);
        // The underside lies half the thickness below the middle plane.
        let lever = thickness_mm / (2.0 * radius_mm);
        Mat::from_fn(MODES, FIELDS * size, |mode, unknown| {
            let (shape, axis) = (mode / 3, self.axes[mode % 3]);
            let (field, k) = (unknown / size, unknown % size);
            let share = if field < 3 { axis[field] } else { -lever * axis[field - 3] };
            share * means[shape][k]
        })
    }

    /// Each circle polynomial projected on each of the foot's: `[foot polynomial][circle polynomial]`.
    fn means(&self, degree: usize, radius_mm: f64) -> [Vec<f64>; FOOT_SHAPES.len()] {
        let mut means = FOOT_SHAPES.map(|_| vec![0.0; count(degree)]);
        let rule = GAUSS.iter().flat_map(|(x, w)| [(-x, *w), (*x, *w)]);
        for (s, s_weight) in rule.clone() {
            for (t, t_weight) in rule.clone() {
                let values = jets(degree, self.place_mm([s, t]).map(|mm| mm / radius_mm));
                for (mean, (shape, [a, b])) in
                    means.iter_mut().zip(foot_shapes([s, t]).iter().zip(FOOT_SHAPES))
                {
                    // Legendre polynomials have the norm 2/(2a+1) on [−1, 1].
                    let weight = ((2 * a + 1) * (2 * b + 1)) as f64 / 4.0 * s_weight * t_weight * shape;
                    mean.iter_mut().zip(&values).for_each(|(mean, jet)| *mean += weight * jet.value);
                }
            }
        }
        means
    }

    fn place_mm(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        let Self { centre_mm, edges, half_mm, .. } = self;
        [0, 1].map(|a| centre_mm[a] + s * half_mm[0] * edges[0][a] + t * half_mm[1] * edges[1][a])
    }
}

/// Turns a vector about a unit axis by an angle in degrees, right-handed (Rodrigues's formula).
fn rotated(v: [f64; 3], axis: [f64; 3], deg: f64) -> [f64; 3] {
    let (sin, cos) = deg.to_radians().sin_cos();
    let along: f64 = v.iter().zip(axis).map(|(v, axis)| v * axis).sum();
    let cross: [f64; 3] = std::array::from_fn(|a| {
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        axis[b] * v[c] - axis[c] * v[b]
    });
    std::array::from_fn(|a| cos * v[a] + sin * cross[a] + (1.0 - cos) * along * axis[a])
}
