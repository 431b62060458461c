//! Where contradictions of a text are told.

use crate::pad::device::reading::DeviceText;

/// What does not fit together, told once for each place of the text.
pub(super) struct Finding<'r, 't> {
    reading: &'r mut DeviceText<'t>,
    /// Places that already have their reason.
    told: Vec<usize>,
}

impl<'r, 't> Finding<'r, 't> {
    pub(super) const fn new(reading: &'r mut DeviceText<'t>) -> Self {
        Self { reading, told: Vec::new() }
    }

    /// Reports at the first of these parameters that the text writes; one number is refused only once.
    pub(super) fn refuse(&mut self, suspects: &[&str], message: String, help: impl Into<String>) {
        let at = self.reading.place_of(suspects.iter().copied());
        if !self.told.contains(&at) {
            self.told.push(at);
            self.reading.findings.error(at, message, help);
        }
    }
}
