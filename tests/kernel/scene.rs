//! What a picture of SuperTux's first level shows: where Tux is, and where the world is.
//!
//! Nothing in the level stands as still as its three wooden crates, so they tell how far the picture has scrolled. Tux
//! is the only large dark thing there.

use crate::framebuffer::Picture;

/// Below this in all three colours a pixel is dark.
const DARK_BELOW: u8 = 70;
/// Side of the square that Tux fills best; a third of it is dark whatever he does.
const TUX_PX: usize = 30;
const TUX_DARK_MIN: usize = TUX_PX * TUX_PX / 3;
/// A level has less darkness than one part in so many; the pages before it are black.
const DARK_PART: usize = 10;
/// A crate is so wide and high; a line across it has so many pixels of wood, and nothing else has.
const CRATE_PX: usize = 30;
const WOOD_MIN: usize = 12;

/// Places on the screen, in pixels from the left and from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scene {
    /// Of the first crate.
    pub(crate) crates: [i32; 2],
    /// Of Tux.
    pub(crate) tux: [i32; 2],
}

impl Scene {
    /// What `picture` shows, unless it is no picture of that place in the level.
    pub(crate) fn seen(picture: &Picture) -> Option<Self> {
        let [crates, tux] = [crates(picture)?, tux(picture)?];
        let whole = |place: [usize; 2]| place.map(|px| i32::try_from(px).expect("a place on a screen"));
        Some(Self { crates: whole(crates), tux: whole(tux) })
    }

    /// Where Tux is in the world, whatever part of it the screen shows.
    pub(crate) fn tux_in_world(&self) -> [i32; 2] {
        [self.tux[0] - self.crates[0], self.tux[1] - self.crates[1]]
    }
}

/// The left upper corner of what is seen of the crates.
fn crates(picture: &Picture) -> Option<[usize; 2]> {
    let wood = |x: usize, y: usize| {
        let [red, green, blue] = picture.at(x, y);
        (60..=200).contains(&red) && red > green && green > blue && red - blue >= 40
    };
    let column = |x: &usize| (0..picture.height).filter(|y| wood(*x, *y)).count() >= WOOD_MIN;
    let x = (0..picture.width).find(column)?;
    let end = picture.width.min(x + CRATE_PX);
    let y = (0..picture.height).find(|y| (x..end).filter(|x| wood(*x, *y)).count() >= WOOD_MIN)?;
    Some([x, y])
}

/// The left upper corner of the darkest square.
fn tux(picture: &Picture) -> Option<[usize; 2]> {
    let dark = DarkPixels::of(picture);
    let (width, height) = (picture.width, picture.height);
    if dark.within([0, 0], [width, height]) * DARK_PART > width * height {
        return None;
    }
    let places = (0..=height - TUX_PX).flat_map(|y| (0..=width - TUX_PX).map(move |x| [x, y]));
    let counted = places.map(|from| (dark.within(from, [from[0] + TUX_PX, from[1] + TUX_PX]), from));
    let (most, place) = counted.max_by_key(|(count, _)| *count)?;
    (most >= TUX_DARK_MIN).then_some(place)
}

/// How many dark pixels lie above and to the left of each.
struct DarkPixels {
    sums: Vec<usize>,
    line: usize,
}

impl DarkPixels {
    fn of(picture: &Picture) -> Self {
        let line = picture.width + 1;
        let mut sums = vec![0; line * (picture.height + 1)];
        for y in 0..picture.height {
            let mut so_far = 0;
            for x in 0..picture.width {
                so_far += usize::from(picture.at(x, y).iter().all(|level| *level < DARK_BELOW));
                sums[(y + 1) * line + x + 1] = sums[y * line + x + 1] + so_far;
            }
        }
        Self { sums, line }
    }

    /// Between a corner and the one before which it ends.
    fn within(&self, [left, top]: [usize; 2], [right, bottom]: [usize; 2]) -> usize {
        let sum = |x: usize, y: usize| self.sums[y * self.line + x];
        sum(right, bottom) + sum(left, top) - sum(right, top) - sum(left, bottom)
    }
}

/// Scenes are found where they were painted, and none where there is none.
pub(crate) fn scenes_are_found_where_they_are() {
    const SNOW: [u8; 3] = [230, 240, 255];
    const WOOD: [u8; 3] = [120, 80, 40];
    const COAT: [u8; 3] = [20, 20, 25];
    let paint = |picture: &mut Picture, [left, top]: [usize; 2], [width, height]: [usize; 2], colour| {
        for y in top..top + height {
            picture.rgb[y * picture.width + left..][..width].fill(colour);
        }
    };
    let empty = Picture { width: 320, height: 240, rgb: vec![SNOW; 320 * 240] };
    assert_eq!(Scene::seen(&empty), None);
    let mut level = empty.clone();
    for left in [201, 265] {
        paint(&mut level, [left, 77], [CRATE_PX, CRATE_PX], WOOD);
    }
    assert_eq!(Scene::seen(&level), None, "no Tux");
    // His beak is as brown as wood.
    paint(&mut level, [70, 130], [11, 8], WOOD);
    paint(&mut level, [40, 120], [TUX_PX, TUX_PX], COAT);
    let scene = Scene::seen(&level);
    assert_eq!(scene, Some(Scene { crates: [201, 77], tux: [40, 120] }));
    assert_eq!(scene.map(|scene| scene.tux_in_world()), Some([-161, 43]));
    paint(&mut level, [0, 160], [320, 80], [0, 0, 0]);
    assert_eq!(Scene::seen(&level), None, "too dark for a level");
    let mut without = empty;
    paint(&mut without, [40, 120], [TUX_PX, TUX_PX], COAT);
    assert_eq!(Scene::seen(&without), None, "no crates");
}
