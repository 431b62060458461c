//! A screen for games.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Command;

use crate::framebuffer::{Framebuffer, Picture};
use crate::program::Running;

/// Size of a screen, and bits of its pixels, as the server takes them.
const SCREEN: &str = "640x480x24";

/// A screen that a game can draw on and the test can see. It goes when this value goes.
pub(crate) struct Screen {
    _server: Running,
    framebuffer: Framebuffer,
    display: String,
}

impl Screen {
    /// Starts a server of its own.
    pub(crate) fn start() -> Self {
        let folder = std::env::temp_dir().join("screen");
        std::fs::create_dir(&folder).expect("a folder for the screen");
        let mut server = Running::start_command(
            Command::new("Xvfb")
                .args(["-displayfd", "1", "-screen", "0", SCREEN, "-nolisten", "tcp", "-noreset", "-fbdir"])
                .arg(&folder),
        );
        let mut number = String::new();
        // It names its display once it takes connections.
        BufReader::new(server.take_output()).read_line(&mut number).expect("a line");
        assert!(!number.trim().is_empty(), "Xvfb did not start");
        let framebuffer = Framebuffer::open(&folder.join("Xvfb_screen0"));
        Self { _server: server, framebuffer, display: format!(":{}", number.trim()) }
    }

    /// What the X server calls it.
    pub(crate) fn display(&self) -> &str {
        &self.display
    }

    /// What it shows now.
    pub(crate) fn look(&self) -> Picture {
        self.framebuffer.picture()
    }
}

/// A dump of `lines`, each of which holds two pixels of `bits` and is filled up to eight bytes.
fn write_dump(path: &Path, bits: u32, most_significant_first: bool, masks: [u32; 3], lines: &[[u8; 8]]) {
    let name = b"a name\0\0";
    let colours = 3;
    let height = u32::try_from(lines.len()).expect("a few lines");
    let mut words = [0_u32; 25];
    words[0] = 100 + 8;
    (words[1], words[2]) = (7, 2);
    (words[4], words[5]) = (2, height);
    words[7] = u32::from(most_significant_first);
    (words[11], words[12]) = (bits, 8);
    words[14..17].copy_from_slice(&masks);
    words[19] = colours;
    let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
    bytes.extend(name);
    bytes.extend([0xEE; 3 * 12]);
    bytes.extend(lines.as_flattened());
    std::fs::write(path, bytes).expect("a dump");
}

/// Depths, byte orders, a colour map and lines that are longer than their pixels.
pub(crate) fn dumps_are_read_as_they_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dump");
    let masks = [0x00FF_0000, 0x0000_FF00, 0x0000_00FF];
    write_dump(&path, 32, false, masks, &[[3, 2, 1, 0, 6, 5, 4, 0], [9, 8, 7, 0xFF, 12, 11, 10, 0xFF]]);
    let screen = Framebuffer::open(&path);
    assert_eq!((screen.width(), screen.height()), (2, 2));
    let picture = screen.picture();
    assert_eq!((picture.width, picture.height), (2, 2));
    assert_eq!(picture.rgb, [[1, 2, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12]]);
    assert_eq!(picture.at(1, 0), [4, 5, 6]);
    let masks = [0xF800, 0x07E0, 0x001F];
    write_dump(
        &path,
        16,
        true,
        masks,
        &[[0xF8, 0x00, 0x07, 0xE0, 1, 1, 1, 1], [0x80, 0x1F, 0, 0, 1, 1, 1, 1]],
    );
    assert_eq!(Framebuffer::open(&path).picture().rgb, [[255, 0, 0], [0, 255, 0], [132, 0, 255], [0, 0, 0]]);
}
