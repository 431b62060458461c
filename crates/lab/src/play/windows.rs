//! Samples as means over windows, and which of them a calibration is fitted to.

use crate::calibration::data::contacts::{Fitted, Knowledge};
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_core::tables::recording::Recording;

/// Length of a window: whole periods of 50 and of 60 Hz.
pub const WINDOW_S: f64 = 0.1;
/// A finger comes and goes: so long after a lift, and before a touch, the pad may not be untouched.
const SETTLE_S: f64 = 0.05;
/// A lighter press tells little.
const FORCE_MIN_N: f32 = 0.3;
/// Within a window the finger moves less: the mean of a field is else not the field of the mean.
const TRAVEL_MAX_MM: f32 = 3.0;
/// More contacts than these tell hardly more, as noise lasts: of more, every second one or fewer is taken.
const CONTACTS_MAX: usize = 1200;

/// Context of a sample beside its channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SampleContext {
    /// Nothing touches the pad.
    Nothing,
    /// A finger, or a weight, about there.
    Contact(Contact),
    /// Nothing that can be believed.
    Doubt,
}

/// A window of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its first sample, in seconds on the pad's clock.
    pub begin_s: f64,
    /// Its last one.
    pub end_s: f64,
    /// Means of the raw channels.
    pub uv: [f64; CHANNELS],
    /// Mean temperature of the pad's board, where it is known.
    pub temp_c: Option<f64>,
    /// The mean contact, as it was decoded; none where nothing touched the pad.
    pub contact: Option<Contact>,
    /// How far the contact went.
    pub travel_mm: f32,
    /// Whether it is as long as a window can be.
    pub is_full: bool,
    /// Counts the touches and the rests between them.
    pub stretch: usize,
}

/// Gathers samples into windows.
#[derive(Clone, Debug, Default)]
pub struct WindowCollector {
    windows: Vec<Window>,
    open: Option<Open>,
    stretch: usize,
    was_touched: bool,
}

/// A window that samples are added to.
#[derive(Clone, Debug)]
struct Open {
    begin_s: f64,
    end_s: f64,
    samples: f64,
    sum_uv: [f64; CHANNELS],
    sum_c: f64,
    temperatures: f64,
    is_touched: bool,
    sum: [f64; 5],
    /// Least and largest x and y.
    span_mm: [[f32; 2]; 2],
}

impl WindowCollector {
    /// Takes a sample; times go on.
    pub fn push(&mut self, at_s: f64, raw_uv: &[f64; CHANNELS], temp_c: Option<f64>, seen: SampleContext) {
        let contact = match seen {
            SampleContext::Doubt => {
                self.close(false);
                self.stretch += 1;
                return;
            }
            SampleContext::Nothing => None,
            SampleContext::Contact(contact) => Some(contact),
        };
        if self.was_touched != contact.is_some() {
            self.close(false);
            self.stretch += 1;
            self.was_touched = contact.is_some();
        }
        let open = self.open.get_or_insert_with(|| Open::new(at_s, contact.is_some()));
        open.add(at_s, raw_uv, temp_c, contact);
        // The sample after the last would be beyond.
        let period_s = (at_s - open.begin_s) / (open.samples - 1.0).max(1.0);
        if at_s - open.begin_s + period_s >= WINDOW_S - 0.5 * period_s {
            self.close(true);
        }
    }

    fn close(&mut self, is_full: bool) {
        let stretch = self.stretch;
        self.windows.extend(self.open.take().map(|open| open.closed(is_full, stretch)));
    }

    /// The windows that are closed.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// Takes out the windows that are closed.
    pub fn take(&mut self) -> Vec<Window> {
        std::mem::take(&mut self.windows)
    }

    /// All windows, in order of time.
    pub fn finish(mut self) -> Vec<Window> {
        self.close(false);
        self.windows
    }
}

impl Open {
    const fn new(begin_s: f64, is_touched: bool) -> Self {
        Self {
            begin_s,
            end_s: begin_s,
            samples: 0.0,
            sum_uv: [0.0; CHANNELS],
            sum_c: 0.0,
            temperatures: 0.0,
            is_touched,
            sum: [0.0; 5],
            span_mm: [[f32::INFINITY, f32::NEG_INFINITY]; 2],
        }
    }

    fn add(&mut self, at_s: f64, raw_uv: &[f64; CHANNELS], temp_c: Option<f64>, contact: Option<Contact>) {
        self.end_s = at_s;
        self.samples += 1.0;
        self.sum_uv.iter_mut().zip(raw_uv).for_each(|(sum, uv)| *sum += uv);
        if let Some(temp_c) = temp_c {
            self.sum_c += temp_c;
            self.temperatures += 1.0;
        }
        if let Some(Contact { x_mm, y_mm, fx_n, fy_n, fz_n }) = contact {
            let numbers = [x_mm, y_mm, fx_n, fy_n, fz_n];
            self.sum.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += f64::from(number));
            for (span, mm) in self.span_mm.iter_mut().zip([x_mm, y_mm]) {
                *span = [span[0].min(mm), span[1].max(mm)];
            }
        }
    }

    fn closed(&self, is_full: bool, stretch: usize) -> Window {
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = self.sum.map(|sum| (sum / self.samples) as f32);
        let [x, y] = self.span_mm.map(|[least, largest]| largest - least);
        Window {
            begin_s: self.begin_s,
            end_s: self.end_s,
            uv: self.sum_uv.map(|sum| sum / self.samples),
            temp_c: (self.temperatures > 0.0).then(|| self.sum_c / self.temperatures),
            contact: self.is_touched.then_some(Contact { x_mm, y_mm, fx_n, fy_n, fz_n }),
            travel_mm: if self.is_touched { libm::hypotf(x, y) } else { 0.0 },
            is_full,
            stretch,
        }
    }
}

impl Window {
    /// Its middle.
    pub fn at_s(&self) -> f64 {
        0.5 * (self.begin_s + self.end_s)
    }

    fn row(&self) -> Row {
        let contact = self.contact.unwrap_or_default();
        let [x_mm, y_mm, fx_n, fy_n, fz_n] =
            [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n].map(f64::from);
        Row {
            trial: Some(0),
            t_s: Some(self.at_s()),
            temp_c: self.temp_c,
            uv: Some(self.uv),
            ..Row::of(Label { x_mm, y_mm, fx_n, fy_n, fz_n })
        }
    }

    /// Whether something presses so that it tells enough.
    pub(super) fn is_firm(&self) -> bool {
        self.contact.is_some_and(|contact| contact.fz_n >= FORCE_MIN_N)
    }

    /// Whether a fit can take it as a press.
    pub(super) fn is_press(&self) -> bool {
        self.is_full && self.is_firm() && self.travel_mm <= TRAVEL_MAX_MM
    }
}

/// Play, ready to be fitted to.
#[derive(Clone, Debug)]
pub struct PlayWindows {
    /// One row for each window, relative to the untouched pad.
    pub recording: Recording,
    /// What the fit takes.
    pub fitted: Vec<Fitted>,
}

impl PlayWindows {
    /// `placed` are windows that a weight rests in, each with what it is; other windows of their touches are left out.
    /// `None` if the pad is never untouched for a moment.
    pub fn of(windows: &[Window], placed: &[(usize, Label, Knowledge)], full_scale_n: f64) -> Option<Self> {
        let mut rows: Vec<Row> = windows.iter().map(Window::row).collect();
        let mut weighed: Vec<usize> = Vec::new();
        for (at, label, _) in placed {
            rows[*at].label = *label;
            weighed.push(windows[*at].stretch);
        }
        let presses: Vec<usize> = (0..windows.len())
            .filter(|at| windows[*at].is_press() && !weighed.contains(&windows[*at].stretch))
            .collect();
        let stride = presses.len().div_ceil(CONTACTS_MAX).max(1);
        let presses = presses.into_iter().step_by(stride);
        let mut fitted: Vec<Fitted> =
            presses.map(|row| Fitted { row, knowledge: Knowledge::Unlabelled }).collect();
        fitted.extend(placed.iter().map(|(row, _, knowledge)| Fitted { row: *row, knowledge: *knowledge }));
        fitted.sort_by_key(|it| it.row);
        let table = Table { rows, trials: vec!["play".into()], ..Table::default() };
        let recording = Recording::series(table, rests(windows), full_scale_n)?;
        Some(Self { recording, fitted })
    }
}

/// The windows that read the untouched pad: of each rest the first and the last one that no finger is near.
fn rests(windows: &[Window]) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    let mut first = 0;
    for stretch in windows.chunk_by(|one, next| one.stretch == next.stretch) {
        let (begin_s, end_s) = (stretch[0].begin_s + SETTLE_S, stretch[stretch.len() - 1].end_s - SETTLE_S);
        let is_quiet = |window: &Window| {
            window.contact.is_none() && window.is_full && window.begin_s >= begin_s && window.end_s <= end_s
        };
        let quiet = || (first..first + stretch.len()).filter(|at| is_quiet(&windows[*at]));
        found.extend(quiet().next());
        found.extend(quiet().next_back());
        first += stretch.len();
    }
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand samples a second: the pad untouched, touched, untouched, … for so many milliseconds each.
    fn gathered(milliseconds: &[u32]) -> Vec<Window> {
        let mut gatherer = WindowCollector::default();
        let mut at_ms = 0;
        for (stretch, length_ms) in milliseconds.iter().enumerate() {
            for _ in 0..*length_ms {
                at_ms += 1;
                let contact = Contact { x_mm: 4.0, fz_n: 2.0, ..Contact::default() };
                let seen =
                    if stretch % 2 == 1 { SampleContext::Contact(contact) } else { SampleContext::Nothing };
                let uv = if stretch % 2 == 1 { 1000.0 } else { 10.0 };
                gatherer.push(1e-3 * f64::from(at_ms), &[uv; CHANNELS], Some(25.0), seen);
            }
        }
        gatherer.finish()
    }

    #[test]
    fn windows_end_after_a_tenth_of_a_second_and_with_a_touch() {
        let windows = gathered(&[250, 130, 70]);
        let lengths: Vec<(bool, bool)> =
            windows.iter().map(|it| (it.is_full, it.contact.is_some())).collect();
        assert_eq!(
            lengths,
            [(true, false), (true, false), (false, false), (true, true), (false, true), (false, false)]
        );
        assert!(windows.iter().all(|it| it.uv[0] == if it.contact.is_some() { 1000.0 } else { 10.0 }));
        assert_eq!(windows.iter().map(|it| it.stretch).collect::<Vec<_>>(), [0, 0, 0, 1, 1, 2]);
        assert!((windows[3].end_s - windows[3].begin_s - 0.099).abs() < 1e-9, "a hundred samples");
    }

    #[test]
    fn doubt_ends_a_window_and_belongs_to_none() {
        let mut gatherer = WindowCollector::default();
        for ms in 0..40 {
            let seen = if ms == 20 { SampleContext::Doubt } else { SampleContext::Nothing };
            gatherer.push(1e-3 * f64::from(ms), &[if ms == 20 { 1e6 } else { 1.0 }; CHANNELS], None, seen);
        }
        let windows = gatherer.finish();
        assert!(
            windows.len() == 2 && windows.iter().all(|it| it.uv[0] == 1.0 && it.temp_c.is_none()),
            "{windows:?}"
        );
    }

    #[test]
    fn presses_and_quiet_rests_are_taken() {
        let windows = gathered(&[500, 350, 600, 350, 120, 200]);
        let play = PlayWindows::of(&windows, &[], 5.0).unwrap();
        assert_eq!(play.fitted.len(), 3 + 3 + 2);
        assert!(play.fitted.iter().all(|it| windows[it.row].contact.is_some()));
        // Two rests are long enough for two readings each; the short one has none that no finger is near.
        assert_eq!(play.recording.zeros().map(|zeros| zeros.len()).sum::<usize>(), 4);
        let uv = play.recording.tared().rows[play.fitted[0].row].uv.unwrap();
        assert_eq!(uv, [990.0; CHANNELS]);
        assert!(PlayWindows::of(&gathered(&[0, 500]), &[], 5.0).is_none(), "never untouched");
    }

    #[test]
    fn of_a_touch_that_is_a_weight_only_one_window_is_taken() {
        let windows = gathered(&[500, 900, 500, 300, 300]);
        let weight = Label { fz_n: 1.96, ..Label::default() };
        let at = windows.iter().position(|it| it.contact.is_some()).unwrap() + 4;
        let play = PlayWindows::of(&windows, &[(at, weight, Knowledge::Placed([0.4; 5]))], 5.0).unwrap();
        assert_eq!(play.fitted.len(), 1 + 3);
        assert_eq!((play.fitted[0].row, play.recording.tared().rows[at].label), (at, weight));
    }
}
