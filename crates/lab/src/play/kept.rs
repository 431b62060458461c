//! Ordinary play that is kept to say later what changed in the pad: the newest minutes, in a file of the program's own.
//!
//! What the equations need of play is its windows ([`Window`]): raw channels as means of a tenth of a second, and about where they were
//! pressed. No key, no profile and no time of day is among them.

use std::fmt;

use firmware_proto::identity::SerialNumber;

use super::windows::{WINDOW_S, Window};
use tactpad_core::bytes::{FormatError, Reader, fnv1a, push_doubles, push_text, sealed, unsealed};
use tactpad_core::quantity::{CHANNELS, Contact};

/// First bytes of a file; the number grows with every change of the form.
pub const MAGIC: &[u8] = b"tactpad play 1\n";
/// What files of all versions begin with.
pub const KIND: &[u8] = b"tactpad play ";
/// Ten minutes in which something presses.
const PRESSED_MAX: usize = (600.0 / WINDOW_S) as usize;
/// Windows in all.
pub const WINDOWS_MAX: usize = 2 * PRESSED_MAX;
/// Of a rest so many windows are kept at its begin and at its end: they read the zero, and no load is between them.
const REST_ENDS: usize = 5;
/// Between two sittings so long passes that no noise lasts.
const APART_S: f64 = 86_400.0;
/// Floats of a window: channels, temperature, contact, travel.
const FLOATS: usize = CHANNELS + 1 + 5 + 1;
const WINDOW_BYTES: usize = 2 * size_of::<f64>() + FLOATS * size_of::<f32>() + size_of::<u32>() + 1;
/// No file is larger.
pub const BYTES_MAX: usize = MAGIC.len() + 64 + WINDOWS_MAX * WINDOW_BYTES;
/// What a window has.
const TOUCHED: u8 = 1;
const FULL: u8 = 2;
const WARM: u8 = 4;
/// No pad reads more, and no hand presses so.
const NUMBER_MAX: f32 = 1e7;

/// Kept play of one pad, decoded by one decoder.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptPlay {
    /// The pad that was played on.
    pub pad: SerialNumber,
    /// The mark of the decoder that played.
    pub decoder: u64,
    windows: Vec<Window>,
    /// What is added to the times and the stretches of the sitting that goes on.
    shift: (f64, usize),
}

/// Why bytes are no kept play.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptError {
    /// They are another kind of file, or of another version.
    Version,
    /// They are damaged.
    Damaged,
}

impl fmt::Display for KeptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Version => "is no kept play of this version; delete it, and tactpad run begins a new one",
            Self::Damaged => "is damaged; delete it, and tactpad run begins a new one",
        })
    }
}

impl std::error::Error for KeptError {}

/// What tells a decoder from others, by the bytes of its file.
pub fn mark(decoder: &[u8]) -> u64 {
    fnv1a(decoder)
}

impl KeptPlay {
    /// Nothing yet.
    pub const fn new(pad: SerialNumber, decoder: u64) -> Self {
        Self { pad, decoder, windows: Vec::new(), shift: (0.0, 0) }
    }

    /// The windows, in order of time.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// How many of them are pressed.
    pub fn pressed(&self) -> usize {
        pressed(&self.windows)
    }

    /// A new sitting begins: its times begin anew, and so do its stretches.
    pub fn sit_down(&mut self) {
        self.shift = self.windows.last().map_or((0.0, 0), |last| (last.end_s + APART_S, last.stretch + 1));
    }

    /// Adds what came next in this sitting. The oldest windows give way.
    pub fn add(&mut self, windows: &[Window]) {
        let (later_s, stretches) = self.shift;
        self.windows.extend(windows.iter().map(|it| Window {
            begin_s: it.begin_s + later_s,
            end_s: it.end_s + later_s,
            stretch: it.stretch + stretches,
            ..*it
        }));
        self.shorten_rests();
        self.forget_oldest();
    }

    /// Leaves of each rest its ends.
    fn shorten_rests(&mut self) {
        let mut kept = Vec::with_capacity(self.windows.len());
        for stretch in self.windows.chunk_by(|one, next| one.stretch == next.stretch) {
            let end = stretch.len().saturating_sub(REST_ENDS);
            let is_wanted = |at: usize| stretch[at].contact.is_some() || at < REST_ENDS || at >= end;
            kept.extend((0..stretch.len()).filter(|at| is_wanted(*at)).map(|at| stretch[at]));
        }
        self.windows = kept;
    }

    fn forget_oldest(&mut self) {
        let mut left = pressed(&self.windows);
        let is_over = |at: usize, left: usize| self.windows.len() - at > WINDOWS_MAX || left > PRESSED_MAX;
        let mut first = 0;
        while is_over(first, left) {
            left -= usize::from(self.windows[first].contact.is_some());
            first += 1;
        }
        self.windows.drain(..first);
    }

    /// The file's bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut body = Vec::new();
        push_text(&mut body, self.pad.as_str().as_bytes());
        body.extend(self.decoder.to_le_bytes());
        body.extend((self.windows.len() as u32).to_le_bytes());
        self.windows.iter().for_each(|window| push_window(&mut body, window));
        sealed(MAGIC, &body)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Bytes that [`Self::to_bytes`] did not write.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, KeptError> {
        let body = unsealed(MAGIC, bytes).map_err(|broken| match broken {
            FormatError::Magic => KeptError::Version,
            FormatError::Damaged => KeptError::Damaged,
        })?;
        read(&mut Reader::new(body)).ok_or(KeptError::Damaged)
    }
}

fn pressed(windows: &[Window]) -> usize {
    windows.iter().filter(|window| window.contact.is_some()).count()
}

fn push_window(to: &mut Vec<u8>, window: &Window) {
    push_doubles(to, &[window.begin_s, window.end_s]);
    to.extend((window.stretch as u32).to_le_bytes());
    let flag = |has: bool, flag: u8| if has { flag } else { 0 };
    let (is_touched, is_warm) = (window.contact.is_some(), window.temp_c.is_some());
    to.push(flag(is_touched, TOUCHED) | flag(window.is_full, FULL) | flag(is_warm, WARM));
    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = window.contact.unwrap_or_default();
    let rest = [window.temp_c.unwrap_or_default() as f32, x_mm, y_mm, fx_n, fy_n, fz_n, window.travel_mm];
    let floats = window.uv.iter().map(|uv| *uv as f32).chain(rest);
    to.extend(floats.flat_map(f32::to_le_bytes));
}

/// `None` for damaged bytes.
fn read(from: &mut Reader<'_>) -> Option<KeptPlay> {
    let pad = SerialNumber::from_ascii(std::str::from_utf8(from.text()?).ok()?)?;
    let decoder = from.bits()?;
    let count = from.length().filter(|count| *count <= WINDOWS_MAX)?;
    let windows: Vec<Window> = (0..count).map(|_| read_window(from)).collect::<Option<_>>()?;
    let goes_on = |pair: &[Window]| pair[0].end_s <= pair[1].begin_s && pair[0].stretch <= pair[1].stretch;
    let is_sound = from.is_at_end() && windows.windows(2).all(goes_on);
    let mut kept = KeptPlay { windows, ..KeptPlay::new(pad, decoder) };
    kept.sit_down();
    is_sound.then_some(kept)
}

fn read_window(from: &mut Reader<'_>) -> Option<Window> {
    let [begin_s, end_s] = from.finites()?;
    let stretch = from.length()?;
    let [flags] = from.number()?;
    let mut floats = [0.0; FLOATS];
    for float in &mut floats {
        *float = from.float().filter(|float| float.abs() <= NUMBER_MAX)?;
    }
    let (uv, rest) = floats.split_first_chunk::<CHANNELS>()?;
    let [temp_c, x_mm, y_mm, fx_n, fy_n, fz_n, travel_mm] = *rest.first_chunk()?;
    let has = |flag: u8| flags & flag != 0;
    let window = Window {
        begin_s,
        end_s,
        uv: uv.map(f64::from),
        temp_c: has(WARM).then_some(f64::from(temp_c)),
        contact: has(TOUCHED).then_some(Contact { x_mm, y_mm, fx_n, fy_n, fz_n }),
        travel_mm,
        is_full: has(FULL),
        stretch,
    };
    (begin_s <= end_s && flags <= TOUCHED | FULL | WARM).then_some(window)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pad() -> SerialNumber {
        SerialNumber::from_ascii("A-7").unwrap()
    }

    /// Touches and rests of so many windows each, one after the other.
    fn sitting(touches: usize, windows: usize) -> Vec<Window> {
        let window = |at: usize| {
            let stretch = at / windows;
            let contact = Contact { x_mm: 3.0, y_mm: -2.0, fz_n: 1.5, ..Contact::default() };
            Window {
                begin_s: 0.1 * at as f64,
                end_s: 0.1 * at as f64 + 0.099,
                uv: std::array::from_fn(|k| 100.0 * k as f64 + at as f64),
                temp_c: at.is_multiple_of(2).then_some(24.5),
                contact: (stretch % 2 == 1).then_some(contact),
                travel_mm: 0.25,
                is_full: !at.is_multiple_of(7),
                stretch,
            }
        };
        (0..2 * touches * windows).map(window).collect()
    }

    fn kept(touches: usize, windows: usize) -> KeptPlay {
        let mut kept = KeptPlay::new(pad(), 77);
        kept.add(&sitting(touches, windows));
        kept
    }

    #[test]
    fn what_is_kept_is_read_again() {
        let kept = kept(20, 6);
        let again = KeptPlay::from_bytes(&kept.to_bytes()).unwrap();
        assert_eq!((again.windows(), again.pad, again.decoder), (kept.windows(), kept.pad, 77));
        assert_eq!(kept.pressed(), 120);
    }

    #[test]
    fn however_long_somebody_plays_it_stays_small_and_the_newest_stays() {
        for (touches, windows) in [(2_000, 6), (3, 30_000), (9_000, 1)] {
            let mut kept = kept(touches, windows);
            kept.sit_down();
            kept.add(&sitting(touches, windows));
            assert!(kept.windows().len() <= WINDOWS_MAX && kept.pressed() <= PRESSED_MAX);
            let last = sitting(touches, windows).pop().unwrap();
            assert_eq!(kept.windows().last().unwrap().uv, last.uv);
            let bytes = kept.to_bytes();
            assert!(bytes.len() <= BYTES_MAX && BYTES_MAX < 1_200_000, "{}", bytes.len());
            assert!(KeptPlay::from_bytes(&bytes).is_ok());
        }
    }

    #[test]
    fn an_hour_without_a_press_is_its_two_ends() {
        let mut kept = kept(2, 3);
        kept.sit_down();
        let presses = kept.pressed();
        let rests: Vec<Window> = sitting(2, 36_000).into_iter().filter(|it| it.contact.is_none()).collect();
        rests.chunks(1_000).for_each(|some| kept.add(some));
        let long = kept.windows().iter().filter(|it| it.stretch >= 4).count();
        assert_eq!((long, kept.pressed()), (2 * 2 * REST_ENDS, presses));
    }

    #[test]
    fn sittings_lie_apart() {
        let mut kept = kept(2, 3);
        let end_s = kept.windows().last().unwrap().end_s;
        let stretches = kept.windows().last().unwrap().stretch;
        kept.sit_down();
        kept.add(&sitting(1, 3));
        let first = kept.windows().iter().find(|it| it.stretch > stretches).unwrap();
        assert!(first.begin_s >= end_s + APART_S);
    }

    #[test]
    fn damaged_and_hostile_bytes_are_refused() {
        let bytes = kept(3, 4).to_bytes();
        assert_eq!(KeptPlay::from_bytes(b"tactpad play 9\n").err(), Some(KeptError::Version));
        for length in [0, 5, MAGIC.len(), MAGIC.len() + 9, bytes.len() - 1] {
            assert!(KeptPlay::from_bytes(&bytes[..length]).is_err(), "{length}");
        }
        // Sound sums over what makes no sense.
        let body = &bytes[MAGIC.len()..bytes.len() - 8];
        let first = 4 + "A-7".len() + 8 + 4;
        let floats = first + 2 * 8 + 4 + 1;
        let hostile = |at: usize, with: &[u8]| {
            let mut body = body.to_vec();
            body[at..at + with.len()].copy_from_slice(with);
            KeptPlay::from_bytes(&sealed(MAGIC, &body)).err()
        };
        for (at, with) in [
            (0, &u32::MAX.to_le_bytes()[..]),
            (4, b" "),
            (first - 4, &u32::MAX.to_le_bytes()),
            (first - 4, &1_u32.to_le_bytes()),
            (first, &f64::NAN.to_le_bytes()),
            (first, &1e9_f64.to_le_bytes()),
            (first + 20, &[8]),
            (floats, &f32::INFINITY.to_le_bytes()),
            (floats, &1e30_f32.to_le_bytes()),
        ] {
            assert_eq!(hostile(at, with), Some(KeptError::Damaged), "{at}");
        }
        assert_eq!(hostile(0, &3_u32.to_le_bytes()), None);
    }
}
