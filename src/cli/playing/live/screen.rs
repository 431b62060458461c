//! The live state on a terminal: where the finger is, how hard it presses, what is held.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::os::fd::AsFd;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use rustix::termios::tcgetwinsize;

use crate::cli::printing::wrapped::lines;
use tactpad::bridge::sink::recording::RecordedEvents;
use tactpad::bridge::snapshot::{BridgeHealth, Snapshot, Status};
use tactpad::bridge::state::State;
use tactpad::counted::counted;
use tactpad::pipeline::control::names::HAT_AXES;
use tactpad::pipeline::control::{Code, OutputEvent};
use tactpad::pipeline::mapping::plain::named;
use tactpad::quantity::Contact;

/// The picture of the plate: a character is about twice as high as wide.
const COLUMNS: usize = 25;
const ROWS: usize = 13;

/// A terminal with less has no room for the plate beside the facts, or for all of it.
const COLUMNS_WITH_PLATE: usize = 64;
const ROWS_WITH_PLATE: usize = ROWS + 2;

/// What has room beside the plate on a usual terminal.
const FACT_COLUMNS: usize = 80 - COLUMNS - 4;

/// Radius of the plate.
const PLATE_MM: f32 = 30.0;

/// The force bar's full length.
const FULL_SCALE_N: f32 = 5.0;

const REFRESH: Duration = Duration::from_millis(50);

/// The picture that is being drawn at the end may take so long.
const LAST_PICTURE: Duration = Duration::from_millis(200);

/// A screen that redraws itself until it is dropped.
pub(super) struct Screen {
    stop: Option<Sender<()>>,
    /// Ends with the drawing.
    drawing: Receiver<()>,
}

impl Screen {
    /// Starts drawing on stdout, which must be a terminal; the newest of the recorded events stand beside the plate.
    pub(super) fn start(
        title: String,
        snapshot: Arc<Mutex<Snapshot>>,
        recorded: Arc<Mutex<RecordedEvents>>,
    ) -> Self {
        let (stop, stopped) = channel::<()>();
        let (draws, drawing) = channel::<()>();
        thread::spawn(move || {
            let _draws = draws;
            let mut last = None;
            while stopped.recv_timeout(REFRESH) == Err(RecvTimeoutError::Timeout) {
                let Ok(seen) = snapshot.lock().map(|seen| seen.clone()) else { return };
                let events: Vec<_> =
                    recorded.lock().map(|it| it.newest.iter().copied().collect()).unwrap_or_default();
                let size = Size::of(&io::stdout());
                let picture = Picture {
                    size,
                    lines: picture(&title, facts(&seen, &events), seen.status.contact.as_ref(), size),
                };
                if draw(&picture.over(last.as_ref())).is_err() {
                    return;
                }
                last = Some(picture);
            }
        });
        Self { stop: Some(stop), drawing }
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.stop.take();
        // A terminal that is held with Ctrl-S takes nothing: the picture is left as it is.
        let _ = self.drawing.recv_timeout(LAST_PICTURE);
    }
}

fn draw(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()
}

/// Characters of the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    columns: usize,
    rows: usize,
}

impl Size {
    /// Some terminals do not know theirs: they are taken for the usual ones.
    pub(super) fn of(terminal: &impl AsFd) -> Self {
        let told = tcgetwinsize(terminal).ok().filter(|told| told.ws_col > 0 && told.ws_row > 0);
        told.map_or(Self { columns: 80, rows: 24 }, |told| Self {
            columns: usize::from(told.ws_col),
            rows: usize::from(told.ws_row),
        })
    }

    const fn has_room_for_the_plate(self) -> bool {
        self.columns >= COLUMNS_WITH_PLATE && self.rows >= ROWS_WITH_PLATE
    }
}

/// The lines of the screen, for a terminal of this size.
pub(super) struct Picture {
    size: Size,
    lines: Vec<String>,
}

impl Picture {
    /// These lines, as far as the terminal has room; one row stays for the cursor.
    pub(super) fn of(lines: &[String], size: Size) -> Self {
        let rows = size.rows.saturating_sub(1).max(1);
        Self { size, lines: lines.iter().take(rows).map(|line| cut(line, size.columns)).collect() }
    }

    /// The characters that draw it over the last picture.
    ///
    /// No line wraps and the terminal never scrolls, else the way up to the first line would not be known. It is not known,
    /// either, once the terminal has another size: then all that is seen is wiped.
    pub(super) fn over(&self, last: Option<&Self>) -> String {
        const NO_WRAP: &str = "\x1b[?7l";
        const WRAP: &str = "\x1b[?7h";
        let mut text = match last {
            Some(last) if last.size == self.size => format!("\x1b[{}A", last.lines.len()),
            Some(_) => "\x1b[2J\x1b[H".to_owned(),
            None => String::new(),
        };
        text.push_str(NO_WRAP);
        for line in &self.lines {
            let _ = write!(text, "\r{line}\x1b[K\r\n");
        }
        text.push_str(WRAP);
        text
    }
}

/// The lines of the picture that have room; one row stays for the cursor.
fn picture(title: &str, beside: Vec<String>, contact: Option<&Contact>, size: Size) -> Vec<String> {
    let lines: Vec<String> = if size.has_room_for_the_plate() {
        let fact = |row: usize| beside.get(row).map_or("", String::as_str);
        let plate = plate(contact);
        plate.iter().enumerate().map(|(row, line)| format!("{line}   {}", fact(row))).collect()
    } else {
        beside
    };
    let all = std::iter::once(title).chain(lines.iter().map(String::as_str));
    all.take(size.rows.saturating_sub(1).max(1)).map(|line| cut(line, size.columns)).collect()
}

/// The line without its end, if that has no room, and without what would move the cursor.
fn cut(line: &str, columns: usize) -> String {
    let plain = line.chars().map(|letter| if letter.is_control() { '\u{fffd}' } else { letter });
    // Wiping the rest of a full line would take its last letter.
    plain.take(columns.saturating_sub(1)).collect()
}

fn facts(seen: &Snapshot, events: &[OutputEvent]) -> Vec<String> {
    let Status { state, contact, held_names, labels, warning, health, latency_us, profile_error, .. } =
        &seen.status;
    let BridgeHealth { pipeline, drops } = health;
    let forces = contact.unwrap_or_default();
    let mut facts = vec![format!("{:<9} {:6.1} s", state.word(), seen.at.as_ns() as f64 * 1e-9)];
    if !matches!(state, State::Playing | State::Paused) {
        facts.extend(lines(state.sentence(), FACT_COLUMNS));
    }
    facts.extend([
        match contact {
            Some(Contact { x_mm, y_mm, .. }) => format!("x {x_mm:+6.1} mm   y {y_mm:+6.1} mm"),
            None => "no contact".into(),
        },
        format!("Fx {:+5.2} N   Fy {:+5.2} N", forces.fx_n, forces.fy_n),
        format!("Fz {:5.2} N  {}", forces.fz_n, bar(forces.fz_n)),
        format!("held   {}", held_names.join("   ")),
        format!(
            "frames {}   lost {}   damaged {}",
            pipeline.samples, pipeline.frames_lost, pipeline.frames_damaged
        ),
        format!("read to written  p50 {:.0} µs   p99 {:.0} µs", latency_us.p50, latency_us.p99),
    ]);
    let unusable = profile_error.as_ref().and_then(|error| error.lines().next());
    facts.extend(unusable.map(|error| format!("! {error}: see `tactpad ctl status`")));
    facts.extend(warning.map(|warning| format!("! {warning}")));
    facts.extend(
        (drops.groups_dropped > 0)
            .then(|| format!("! {} not logged", counted(drops.groups_dropped, "group"))),
    );
    facts.extend(events.iter().rev().take(ROWS.saturating_sub(facts.len())).map(|event| line(event, labels)));
    facts
}

/// An event: `3.214 s  A: jump, pressed`.
fn line(event: &OutputEvent, labels: &BTreeMap<String, String>) -> String {
    let OutputEvent { at, device, code, value } = *event;
    let called = |value| named::control(labels, device, code, value);
    let told = match code {
        Code::Key(_) => format!("{}, {}", called(1), if value == 0 { "let go" } else { "pressed" }),
        Code::Axis(_) if HAT_AXES.contains(&code) && value == 0 => {
            format!("{} or {}, let go", called(-1), called(1))
        }
        Code::Axis(_) if HAT_AXES.contains(&code) => format!("{}, pressed", called(value)),
        Code::Axis(_) | Code::Relative(_) => format!("{} {value:+}", called(value)),
    };
    format!("  {:8.3} s  {told}", at.as_us() as f64 * 1e-6)
}

fn bar(force_n: f32) -> String {
    let cells = (force_n / FULL_SCALE_N * 20.0).clamp(0.0, 20.0) as usize;
    format!("{}{}", "█".repeat(cells), "░".repeat(20 - cells))
}

/// The plate seen from above, with the contact on it.
fn plate(contact: Option<&Contact>) -> Vec<String> {
    let touched = contact.map(|contact| cell(contact.x_mm, contact.y_mm));
    (0..ROWS)
        .map(|row| {
            let mark = |column| if touched == Some((column, row)) { '●' } else { ground(column, row) };
            (0..COLUMNS).map(mark).collect()
        })
        .collect()
}

/// The cell of a point of the plate.
fn cell(x_mm: f32, y_mm: f32) -> (usize, usize) {
    let column = (x_mm / PLATE_MM + 1.0) * 0.5 * (COLUMNS - 1) as f32;
    let row = (1.0 - y_mm / PLATE_MM) * 0.5 * (ROWS - 1) as f32;
    (
        (column + 0.5).clamp(0.0, (COLUMNS - 1) as f32) as usize,
        (row + 0.5).clamp(0.0, (ROWS - 1) as f32) as usize,
    )
}

/// Where the directions lie, and what marks them.
const DIRECTIONS: [(f32, f32, char); 4] =
    [(20.0, 0.0, '→'), (0.0, 20.0, '↑'), (-20.0, 0.0, '←'), (0.0, -20.0, '↓')];

/// The plate without a contact: its edge, its centre, the four directions.
fn ground(column: usize, row: usize) -> char {
    let mark = DIRECTIONS.iter().find(|&&(x_mm, y_mm, _)| cell(x_mm, y_mm) == (column, row));
    if let Some((_, _, mark)) = mark {
        return *mark;
    }
    let x = 2.0 * column as f32 / (COLUMNS - 1) as f32 - 1.0;
    let y = 2.0 * row as f32 / (ROWS - 1) as f32 - 1.0;
    match libm::hypotf(x, y) {
        radius if (0.94..1.06).contains(&radius) => '·',
        _ if cell(0.0, 0.0) == (column, row) => '+',
        _ => ' ',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contact_is_drawn_where_it_is() {
        for (x_mm, y_mm, column, row) in
            [(0.0, 0.0, 12, 6), (30.0, 0.0, 24, 6), (0.0, 30.0, 12, 0), (0.0, -25.0, 12, 11)]
        {
            let drawn = plate(Some(&Contact { x_mm, y_mm, ..Contact::default() }));
            assert_eq!(drawn[row].chars().nth(column), Some('●'), "{x_mm} {y_mm}");
        }
    }

    fn lines(columns: usize, rows: usize) -> Vec<String> {
        let title = format!("a title\n{}", "x".repeat(200));
        picture(&title, vec!["e".repeat(200), "no contact".into()], None, Size { columns, rows })
    }

    #[test]
    fn the_picture_has_room_in_any_terminal() {
        for (columns, rows) in [(80, 24), (40, 10), (64, 15), (200, 60), (1, 1), (5, 2)] {
            let lines = lines(columns, rows);
            assert!(lines.len() < rows.max(2), "{columns} x {rows}: {lines:#?}");
            let fits = |line: &String| line.chars().count() < columns && !line.contains(char::is_control);
            assert!(lines.iter().all(fits), "{columns} x {rows}: {lines:#?}");
        }
        assert!(lines(80, 24).iter().any(|line| line.contains('→')), "the plate");
        assert!(
            lines(40, 10).iter().any(|line| line.contains("no contact")),
            "the facts where the plate has no room"
        );
    }

    #[test]
    fn another_size_wipes_what_is_seen() {
        let picture =
            |columns| Picture { size: Size { columns, rows: 9 }, lines: vec!["a".into(), "b".into()] };
        let (first, wider) = (picture(40), picture(41));
        assert_eq!(first.over(None), "\x1b[?7l\ra\x1b[K\r\n\rb\x1b[K\r\n\x1b[?7h");
        assert!(first.over(Some(&first)).starts_with("\x1b[2A"));
        assert!(wider.over(Some(&first)).starts_with("\x1b[2J\x1b[H"));
    }

    #[test]
    fn the_force_bar_is_full_at_full_scale_and_never_longer() {
        assert_eq!(bar(5.0).matches('█').count(), 20);
        assert_eq!(bar(50.0).chars().count(), 20);
        assert_eq!(bar(-1.0).matches('█').count(), 0);
    }
}
