//! The live state on a terminal: where the finger is, how hard it presses, what is held.

use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use tactpad::bridge::snapshot::{BridgeHealth, Snapshot, Status};
use tactpad::pipeline::control::Code;
use tactpad::pipeline::mapping::intent::Level;
use tactpad::quantity::Contact;

/// The picture of the plate: a character is about twice as high as wide.
const COLUMNS: usize = 25;
const ROWS: usize = 13;

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
    /// Starts drawing if stdout is a terminal. `events` gives the newest events, one line each.
    pub(super) fn start(
        title: String,
        snapshot: Arc<Mutex<Snapshot>>,
        events: impl Fn() -> Vec<String> + Send + 'static,
    ) -> Option<Self> {
        if !io::stdout().is_terminal() {
            return None;
        }
        let (stop, stopped) = channel::<()>();
        let (draws, drawing) = channel::<()>();
        thread::spawn(move || {
            let _draws = draws;
            let mut drawn_lines = 0;
            while stopped.recv_timeout(REFRESH) == Err(RecvTimeoutError::Timeout) {
                let Ok(seen) = snapshot.lock().map(|seen| seen.clone()) else { return };
                let picture = picture(&title, &seen, &events());
                if redraw(&picture, drawn_lines).is_err() {
                    return;
                }
                drawn_lines = picture.lines().count();
            }
        });
        Some(Self { stop: Some(stop), drawing })
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.stop.take();
        // A terminal that is held with Ctrl-S takes nothing: the picture is left as it is.
        let _ = self.drawing.recv_timeout(LAST_PICTURE);
    }
}

/// Writes over the last picture.
fn redraw(picture: &str, drawn_lines: usize) -> io::Result<()> {
    let mut text = String::new();
    if drawn_lines > 0 {
        let _ = write!(text, "\x1b[{drawn_lines}A");
    }
    for line in picture.lines() {
        let _ = write!(text, "{line}\x1b[K\r\n");
    }
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()
}

fn picture(title: &str, seen: &Snapshot, events: &[String]) -> String {
    let beside = facts(seen, events);
    let mut text = format!("{title}\n");
    for (row, line) in plate(seen.status.contact.as_ref()).iter().enumerate() {
        let fact = beside.get(row).map_or("", String::as_str);
        let _ = writeln!(text, "{line}   {fact}");
    }
    text
}

fn facts(seen: &Snapshot, events: &[String]) -> Vec<String> {
    let Status { state, contact, held, warning, health, latency_us, .. } = &seen.status;
    let BridgeHealth { pipeline, drops } = health;
    let forces = contact.unwrap_or_default();
    let mut facts = vec![
        format!("{:<9} {:6.1} s", state.word(), seen.at.as_ns() as f64 * 1e-9),
        match contact {
            Some(Contact { x_mm, y_mm, .. }) => format!("x {x_mm:+6.1} mm   y {y_mm:+6.1} mm"),
            None => "no contact".into(),
        },
        format!("Fx {:+5.2} N   Fy {:+5.2} N", forces.fx_n, forces.fy_n),
        format!("Fz {:5.2} N  {}", forces.fz_n, bar(forces.fz_n)),
        format!("held   {}", held.iter().map(level).collect::<Vec<_>>().join("  ")),
        format!(
            "frames {}   lost {}   damaged {}",
            pipeline.samples, pipeline.frames_lost, pipeline.frames_damaged
        ),
        format!("read to written  p50 {:.0} µs   p99 {:.0} µs", latency_us.p50, latency_us.p99),
    ];
    facts.extend(warning.map(|warning| format!("! {warning}")));
    facts.extend((drops.groups_dropped > 0).then(|| format!("! {} groups not logged", drops.groups_dropped)));
    facts
        .extend(events.iter().rev().take(ROWS.saturating_sub(facts.len())).map(|event| format!("  {event}")));
    facts
}

fn level(level: &Level) -> String {
    match level.code {
        Code::Key(_) => format!("{}", level.code),
        Code::Axis(_) => format!("{}={:+}", level.code, level.value),
        Code::Relative(_) => format!("{}{:+}/s", level.code, level.value),
    }
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

    #[test]
    fn the_force_bar_is_full_at_full_scale_and_never_longer() {
        assert_eq!(bar(5.0).matches('█').count(), 20);
        assert_eq!(bar(50.0).chars().count(), 20);
        assert_eq!(bar(-1.0).matches('█').count(), 0);
    }
}
