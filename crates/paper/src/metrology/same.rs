//! Loads that are the same contact, found among many: place by place, force by force.

use std::collections::BTreeMap;

use super::rows::is_same_place;
use tactpad_core::tables::measured::Label;

/// Largest difference of forces that count as the same contact.
const SAME_FORCE_N: f64 = 0.15;

/// Contacts of one place, none of which is the same as one before it.
#[derive(Clone, Debug, Default)]
pub(super) struct DistinctContacts {
    /// By the cube of forces, as wide as those that are the same, in which they lie.
    cubes: BTreeMap<[i64; 3], Vec<(usize, Label)>>,
    count: usize,
}

impl DistinctContacts {
    /// Takes a contact, unless it is the same as an earlier one.
    pub(super) fn take(&mut self, label: &Label) -> bool {
        let is_new = self.find(label).is_none();
        if is_new {
            self.cubes.entry(cube(label)).or_default().push((self.count, *label));
            self.count += 1;
        }
        is_new
    }

    /// The number, from 0, of the first contact taken that is the same.
    pub(super) fn find(&self, label: &Label) -> Option<usize> {
        let [x, y, z] = cube(label);
        let around = (x - 1..=x + 1)
            .flat_map(|x| (y - 1..=y + 1).flat_map(move |y| (z - 1..=z + 1).map(move |z| [x, y, z])));
        let near = around.filter_map(|cube| self.cubes.get(&cube)).flatten();
        near.filter(|(_, known)| is_same_contact(known, label)).map(|(number, _)| *number).min()
    }
}

fn is_same_contact(one: &Label, other: &Label) -> bool {
    let apart_n = (one.fx_n - other.fx_n).hypot(one.fy_n - other.fy_n).hypot(one.fz_n - other.fz_n);
    is_same_place(one, other) && apart_n <= SAME_FORCE_N
}

fn cube(label: &Label) -> [i64; 3] {
    // Far from the ends of the integers, so that its neighbours are some, too.
    [label.fx_n, label.fy_n, label.fz_n].map(|n| (n / SAME_FORCE_N).floor().clamp(-1e15, 1e15) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_that_comes_again_is_none() {
        let label = |x_mm, fz_n| Label { x_mm, fz_n, ..Label::default() };
        let mut different = DistinctContacts::default();
        let taken = [label(0.0, 1.0), label(0.05, 1.1), label(0.0, 1.16), label(0.09, 2.0), label(0.2, 1.0)]
            .map(|label| different.take(&label));
        assert_eq!(taken, [true, false, true, true, true]);
        // Of two that are the same the first one, though the other is nearer.
        assert_eq!(different.find(&label(0.0, 1.14)), Some(0));
        assert_eq!((different.find(&label(0.0, 1.2)), different.find(&label(0.0, 3.0))), (Some(1), None));
    }
}
