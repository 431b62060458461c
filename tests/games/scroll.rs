//! How far the ground under a window has moved, from one picture to the next: by as many pixels to the right and down as most
//! points of it are the same.
//!
//! This is exact where the ground is drawn from above, moves by whole pixels and is not scaled.

use crate::framebuffer::Picture;

/// The ground is looked for so far away at first; and where it is not found there, so far.
const NEAR_PX: i64 = 32;
const FAR_PX: i64 = 96;
/// Points of the picture that are compared: every so many columns and lines, so that tiles of 64 do not fall in step.
const COLUMNS_PX: usize = 27;
const LINES_PX: usize = 23;
/// At least this share of them must be the same. What moves by itself is not.
const LEAST_SHARE: f64 = 0.4;

/// A picture and where on the ground it was.
pub(crate) struct Scroll {
    pub(crate) picture: Picture,
    points: Vec<[usize; 2]>,
    /// How far to the right and down the window has moved since the first picture.
    pub(crate) at_px: [i64; 2],
}

impl Scroll {
    /// Of a window that shows ground between `from` and `to`, each as column and line.
    pub(crate) fn new(picture: Picture, from: [usize; 2], to: [usize; 2]) -> Self {
        let margin = FAR_PX as usize;
        let columns = || (from[0] + margin..to[0] - margin).step_by(COLUMNS_PX);
        let lines = (from[1] + margin..to[1] - margin).step_by(LINES_PX);
        let points = lines.flat_map(|y| columns().map(move |x| [x, y])).collect();
        Self { picture, points, at_px: [0, 0] }
    }

    /// Says whether the ground was found again in a later picture, and goes on from there if so.
    pub(crate) fn follow(&mut self, picture: Picture) -> bool {
        let found = [0, NEAR_PX, FAR_PX].into_iter().find_map(|reach| self.found(&picture, reach));
        let Some([right, down]) = found else { return false };
        // The window goes where the ground comes from.
        self.at_px = [self.at_px[0] - right, self.at_px[1] - down];
        self.picture = picture;
        true
    }

    /// By how much the ground has moved on the picture, if that is at most `reach` along each axis.
    fn found(&self, picture: &Picture, reach: i64) -> Option<[i64; 2]> {
        let allowed = (self.points.len() as f64 * (1.0 - LEAST_SHARE)) as usize;
        let (mut least, mut found) = (allowed + 1, None);
        for down in -reach..=reach {
            for right in -reach..=reach {
                let others = self.others(picture, [right, down], least);
                if others < least {
                    (least, found) = (others, Some([right, down]));
                }
            }
        }
        found
    }

    /// How many points are other ones after such a move; counted up to `limit`.
    fn others(&self, picture: &Picture, [right, down]: [i64; 2], limit: usize) -> usize {
        let differs = |[x, y]: &&[usize; 2]| {
            let [moved_x, moved_y] = [*x as i64 + right, *y as i64 + down].map(|at| at as usize);
            self.picture.at(*x, *y) != picture.at(moved_x, moved_y)
        };
        self.points.iter().filter(differs).take(limit).count()
    }
}

#[test]
fn ground_is_found_again_near_and_far_and_no_other_ground() {
    use tactpad::numeric::random::SplitMix64;
    const SIZE: [usize; 2] = [300, 280];
    let ground = |name: &str| {
        let mut random = SplitMix64::named(1, name);
        (0..600 * 600).map(|_| [(255.0 * random.fraction()) as u8; 3]).collect::<Vec<_>>()
    };
    let [field, sea] = ["field", "sea"].map(ground);
    let seen = |ground: &[[u8; 3]], [left, top]: [usize; 2]| {
        let line = |y: usize| ground[(top + y) * 600 + left..][..SIZE[0]].to_vec();
        Picture { width: SIZE[0], height: SIZE[1], rgb: (0..SIZE[1]).flat_map(line).collect() }
    };
    let mut scroll = Scroll::new(seen(&field, [150, 150]), [0, 0], SIZE);
    for (place, moved) in [([170, 143], [20, -7]), ([90, 230], [-60, 80]), ([90, 230], [-60, 80])] {
        assert!(scroll.follow(seen(&field, place)));
        assert_eq!(scroll.at_px, moved);
    }
    assert!(!scroll.follow(seen(&sea, [90, 230])), "another ground");
    // A third of the picture is covered.
    let mut covered = seen(&field, [100, 230]);
    covered.rgb[..SIZE[0] * 130].fill([0; 3]);
    assert!(scroll.follow(covered));
    assert_eq!(scroll.at_px, [-50, 80]);
}
