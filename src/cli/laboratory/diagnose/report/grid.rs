//! Small pictures side by side, one card for each channel.

use super::drawing::escaped;
use super::subject::Subject;

/// So many channels are shown at once; of more, those that the model misses most, and the others on request.
const CHANNELS_MAX: usize = 12;
/// Dots on a page at most, and on each map at least.
const DOTS_MAX: usize = 12_000;
const DOTS_MIN: usize = 150;
/// No more dots than this can be told apart on one map.
const DOTS_OF_MAP: usize = 600;

/// The channels of a page, in the order of the file.
pub(super) struct Grid<'s> {
    subject: &'s Subject<'s>,
    first: Vec<usize>,
    others: Vec<usize>,
}

impl<'s> Grid<'s> {
    pub(super) fn of(subject: &'s Subject<'s>) -> Self {
        let mut channels = subject.alive();
        channels.sort_by(|one, other| subject.excess(*other).total_cmp(&subject.excess(*one)));
        let mut others = channels.split_off(channels.len().min(CHANNELS_MAX));
        channels.sort_unstable();
        others.sort_unstable();
        Self { subject, first: channels, others }
    }

    /// A card for each channel, with what `inside` draws of it.
    pub(super) fn html(&self, inside: impl Fn(usize) -> String) -> String {
        let cards = |channels: &[usize]| -> String {
            let card = |channel: &usize| {
                format!(
                    "<figure class=\"card\">{}<div class=\"pictures\">{}</div></figure>",
                    self.caption(*channel),
                    inside(*channel)
                )
            };
            channels.iter().map(card).collect()
        };
        let first = format!("<div class=\"grid\">{}</div>", cards(&self.first));
        if self.others.is_empty() {
            return first;
        }
        let count = self.others.len();
        format!(
            "{first}<details><summary>{count} more channels, which the model misses less</summary><div class=\"grid\">{}</div></details>",
            cards(&self.others)
        )
    }

    fn caption(&self, channel: usize) -> String {
        let Subject { diagnosis, unit, .. } = self.subject;
        let [before, after] = self.subject.errors(channel);
        let digits = if before >= 100.0 { 0 } else { 1 };
        let name = escaped(&diagnosis.channels[channel]);
        let sizes = if self.subject.is_extended() {
            format!("{before:.digits$} → {after:.digits$} {unit}")
        } else {
            format!("{before:.digits$} {unit}")
        };
        format!("<figcaption><strong>{name}</strong> <span>{sizes} rms</span></figcaption>")
    }
}

impl Subject<'_> {
    /// How many dots a map may have.
    pub(super) fn dots_of_map(&self) -> usize {
        let maps = 2 * self.diagnosis.residuals.nominal.len().max(1);
        (DOTS_MAX / maps).clamp(DOTS_MIN, DOTS_OF_MAP)
    }
}
