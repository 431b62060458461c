//! Where the modules stand.

use std::array;

use super::{Device, Module};
use crate::quantity::MODULES;

/// A module's place and axes in the pad frame, seen from above. The axes are left-handed: use these vectors,
/// never a rotation matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The module's centre.
    pub centre_mm: [f64; 2],
    /// Unit vector of the module's x, along the tangent.
    pub along_x: [f64; 2],
    /// Unit vector of the module's y, outwards.
    pub along_y: [f64; 2],
}

impl Device {
    /// Where each module stands, displaced and turned.
    pub fn poses(&self) -> [Pose; MODULES] {
        let Self { sites, modules, .. } = self;
        array::from_fn(|index| Pose::of(&modules[index], sites.angles_deg[index], sites.centre_radius_mm))
    }

    /// Where another number of modules stand at equal angles, from the first one's on and as far from the axis; they are
    /// displaced and turned as the device's are in turn.
    pub fn ring(&self, count: usize) -> Vec<Pose> {
        let Self { sites, modules, .. } = self;
        let of = |index: usize| {
            let angle_deg = sites.angles_deg[0] + 360.0 * index as f64 / count as f64;
            Pose::of(&modules[index % MODULES], angle_deg, sites.centre_radius_mm)
        };
        (0..count).map(of).collect()
    }

    /// Whether so many modules have room in such a ring: no film lies over another one.
    pub fn has_room_for(&self, count: usize) -> bool {
        let half_mm = [self.stack.film_length_x_mm, self.stack.film_width_y_mm].map(|side| 0.5 * side);
        let poses = self.ring(count);
        let is_free = |(later, pose): (usize, &Pose)| {
            poses.iter().take(later).all(|earlier| !pose.overlaps(earlier, half_mm))
        };
        poses.iter().enumerate().all(is_free)
    }
}

impl Pose {
    /// Where a module stands whose site is at this angle, counter-clockwise from +x, and this far from the pad's axis.
    ///
    /// A module is displaced along the axes that it would have if it were not turned. Tilt changes neither place nor
    /// axes.
    pub fn of(module: &Module, angle_deg: f64, centre_radius_mm: f64) -> Self {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let (out, along) = (centre_radius_mm + module.radial_mm, module.tangential_mm);
        let (turned_sin, turned_cos) = (angle_deg + module.rotation_deg).to_radians().sin_cos();
        Self {
            centre_mm: [out * cos - along * sin, out * sin + along * cos],
            along_x: [-turned_sin, turned_cos],
            along_y: [turned_cos, turned_sin],
        }
    }

    /// The corners of a rectangle around the module's centre, given its half size along the module's axes.
    pub fn corners_mm(&self, half_mm: [f64; 2]) -> [[f64; 2]; 4] {
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| {
            array::from_fn(|axis| {
                self.centre_mm[axis]
                    + x * half_mm[0] * self.along_x[axis]
                    + y * half_mm[1] * self.along_y[axis]
            })
        })
    }

    /// Whether the rectangles of this half size around two modules overlap; where they only touch, they do not.
    ///
    /// Two rectangles are apart exactly if they are so along a side of either (the separating axes).
    pub fn overlaps(&self, other: &Self, half_mm: [f64; 2]) -> bool {
        let apart = [other.centre_mm[0] - self.centre_mm[0], other.centre_mm[1] - self.centre_mm[1]];
        [self.along_x, self.along_y, other.along_x, other.along_y].into_iter().all(|axis| {
            let reach = |pose: &Self| {
                half_mm[0] * dot(pose.along_x, axis).abs() + half_mm[1] * dot(pose.along_y, axis).abs()
            };
            dot(apart, axis).abs() < reach(self) + reach(other)
        })
    }
}

fn dot(left: [f64; 2], right: [f64; 2]) -> f64 {
    left[0] * right[0] + left[1] * right[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::device::Module;

    fn near(left: [f64; 2], right: [f64; 2]) -> bool {
        left.iter().zip(right).all(|(left, right)| (left - right).abs() < 1e-12)
    }

    #[test]
    fn drawn_modules_stand_on_the_circle_with_left_handed_axes() {
        let [first, second, _] = Device::nominal().poses();
        assert!(near(first.centre_mm, [20.0, 0.0]));
        assert!(near(first.along_x, [0.0, 1.0]) && near(first.along_y, [1.0, 0.0]));
        let (sin, cos) = (0.75_f64.sqrt(), -0.5);
        assert!(near(second.centre_mm, [20.0 * cos, 20.0 * sin]));
        assert!(near(second.along_x, [-sin, cos]) && near(second.along_y, [cos, sin]));
    }

    #[test]
    fn a_module_moves_along_its_axes_and_turns_counter_clockwise() {
        let mut device = Device::nominal();
        device.modules[0] =
            Module { radial_mm: -0.7, tangential_mm: 0.9, rotation_deg: 90.0, ..Module::NOMINAL };
        let [pose, ..] = device.poses();
        assert!(near(pose.centre_mm, [19.3, 0.9]));
        assert!(near(pose.along_x, [-1.0, 0.0]) && near(pose.along_y, [0.0, 1.0]));
        assert!(near(pose.corners_mm([4.9, 2.7])[0], [19.3 - 4.9, 0.9 + 2.7]));
    }

    #[test]
    fn rectangles_overlap_by_their_sides_and_not_by_their_circles() {
        let pose = |x_mm: f64, y_mm: f64, turn_deg: f64| {
            let (sin, cos) = turn_deg.to_radians().sin_cos();
            Pose { centre_mm: [x_mm, y_mm], along_x: [-sin, cos], along_y: [cos, sin] }
        };
        let fixed = pose(0.0, 0.0, 0.0);
        // x is the pad's y here: each reaches 2 along the pad's y and 1 along its x.
        let overlaps = |x_mm, y_mm, turn_deg| {
            let other = pose(x_mm, y_mm, turn_deg);
            let both = [fixed.overlaps(&other, [2.0, 1.0]), other.overlaps(&fixed, [2.0, 1.0])];
            assert_eq!(both[0], both[1]);
            both[0]
        };
        assert!(overlaps(1.99, 0.0, 0.0) && !overlaps(2.01, 0.0, 0.0));
        assert!(overlaps(0.0, 3.99, 0.0) && !overlaps(0.0, 4.01, 0.0));
        assert!(overlaps(2.99, 0.0, 90.0) && !overlaps(3.01, 0.0, 90.0));
        // Corner to side: half the diagonal of a square would reach, the rectangle's corner does not.
        let reach = 1.0 + 3.0 / 2.0_f64.sqrt();
        assert!(overlaps(reach - 0.01, 0.0, 45.0) && !overlaps(reach + 0.01, 0.0, 45.0));
        assert!(!fixed.overlaps(&pose(f64::NAN, 0.0, 0.0), [2.0, 1.0]));
    }
}
