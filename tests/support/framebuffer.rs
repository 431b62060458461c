//! The screen of an Xvfb that keeps it in a file (`-fbdir`): what a player would see, read without an X client.
//!
//! The file is an X window dump: a header of big-endian words and the screen's name, a colour map, then the lines
//! from top to bottom. Source: `X11/XWDFile.h`.
#![allow(
    clippy::expect_used,
    dead_code,
    reason = "a test may stop at what it did not expect; each uses a part"
)]

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;

/// Words of the header, before the name.
const WORDS: usize = 25;
/// Bytes of an entry of the colour map.
const COLOUR_LEN: u64 = 12;
/// Of this kind the file must be: version 7, whole pixels.
const VERSION: u32 = 7;
const WHOLE_PIXELS: u32 = 2;

/// A screen that is being drawn on.
pub(crate) struct Framebuffer {
    file: File,
    width: usize,
    height: usize,
    /// Where the first line begins.
    start: u64,
    line_len: usize,
    pixel_len: usize,
    most_significant_first: bool,
    /// Which bits of a pixel are red, green and blue.
    masks: [u32; 3],
}

impl Framebuffer {
    /// Opens the file that the server made, `Xvfb_screen0` in its folder. The server has written the header before it
    /// names its display.
    pub(crate) fn open(path: &Path) -> Self {
        let file = File::open(path).expect("a screen's file");
        let mut bytes = [0; 4 * WORDS];
        file.read_exact_at(&mut bytes, 0).expect("a whole header");
        let mut words = bytes.chunks(4).map(|word| u32::from_be_bytes(word.try_into().expect("four bytes")));
        let words: [u32; WORDS] = std::array::from_fn(|_| words.next().expect("as many as there are"));
        let size = |index: usize| usize::try_from(words[index]).expect("a size that fits");
        assert_eq!((words[1], words[2]), (VERSION, WHOLE_PIXELS), "version and format of {}", path.display());
        assert!([16, 24, 32].contains(&words[11]), "{} bits to a pixel", words[11]);
        let screen = Self {
            file,
            width: size(4),
            height: size(5),
            start: u64::from(words[0]) + u64::from(words[19]) * COLOUR_LEN,
            line_len: size(12),
            pixel_len: size(11) / 8,
            most_significant_first: words[7] != 0,
            masks: [words[14], words[15], words[16]],
        };
        assert!(screen.line_len >= screen.width * screen.pixel_len, "lines of {} bytes", screen.line_len);
        screen
    }

    /// In pixels.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// In pixels.
    pub(crate) fn height(&self) -> usize {
        self.height
    }

    /// What the screen shows now. A client that draws meanwhile may leave the lower part older than the upper.
    pub(crate) fn picture(&self) -> Picture {
        let mut bytes = vec![0; self.line_len * self.height];
        self.file.read_exact_at(&mut bytes, self.start).expect("all lines");
        let used = self.width * self.pixel_len;
        let mut rgb = Vec::with_capacity(self.width * self.height);
        for line in bytes.chunks_exact(self.line_len) {
            let pixels = line[..used].chunks_exact(self.pixel_len).map(|bytes| self.pixel(bytes));
            rgb.extend(pixels.map(|pixel| self.masks.map(|mask| channel(pixel, mask))));
        }
        Picture { width: self.width, height: self.height, rgb }
    }

    /// What a part of it shows now: less work than the whole.
    pub(crate) fn picture_of(&self, area: &Area) -> Vec<[u8; 3]> {
        let mut bytes = vec![0; self.line_len * area.height_px];
        let from = self.start + (area.top_px * self.line_len) as u64;
        self.file.read_exact_at(&mut bytes, from).expect("these lines");
        let columns = area.left_px * self.pixel_len..(area.left_px + area.width_px) * self.pixel_len;
        let pixels =
            bytes.chunks(self.line_len).flat_map(|line| line[columns.clone()].chunks(self.pixel_len));
        pixels.map(|bytes| self.masks.map(|mask| channel(self.pixel(bytes), mask))).collect()
    }

    fn pixel(&self, bytes: &[u8]) -> u32 {
        let join = |pixel: u32, byte: &u8| pixel << 8 | u32::from(*byte);
        if self.most_significant_first {
            bytes.iter().fold(0, join)
        } else {
            bytes.iter().rev().fold(0, join)
        }
    }
}

/// A pixel's bits below `mask` as a share of 255.
fn channel(pixel: u32, mask: u32) -> u8 {
    let [level, most] = [pixel & mask, mask].map(|bits| u64::from(bits) >> mask.trailing_zeros());
    // The usual case, without a division: a picture has half a million pixels.
    if most == 255 {
        return level as u8;
    }
    u8::try_from((level * 255 + most / 2) / most).expect("a share of 255")
}

/// What a screen showed at one moment.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Picture {
    /// In pixels.
    pub(crate) width: usize,
    /// In pixels.
    pub(crate) height: usize,
    /// Red, green and blue of each pixel, line by line from the top.
    pub(crate) rgb: Vec<[u8; 3]>,
}

impl Picture {
    /// The pixel in column `x` from the left and line `y` from the top.
    pub(crate) fn at(&self, x: usize, y: usize) -> [u8; 3] {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.rgb[y * self.width + x]
    }

    /// The pixels of a part, line by line.
    pub(crate) fn part(&self, area: &Area) -> Vec<[u8; 3]> {
        let line = |y: usize| (y * self.width + area.left_px, y * self.width + area.left_px + area.width_px);
        let lines = (area.top_px..area.top_px + area.height_px).map(line);
        lines.flat_map(|(from, to)| self.rgb[from..to].iter().copied()).collect()
    }
}

/// A part of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Area {
    /// Columns to the left of it.
    pub(crate) left_px: usize,
    /// Lines above it.
    pub(crate) top_px: usize,
    /// In pixels.
    pub(crate) width_px: usize,
    /// In pixels.
    pub(crate) height_px: usize,
}
