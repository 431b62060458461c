//! The bar that tells which colour is which value.

use super::bands::Bands;
use super::figure::{Anchor, Figure, Ink, Path, Point, Text};
use super::style::{AXIS, HALF_DIGIT, LABEL_SIZE, QUIET, TEXT};

const LABEL_GAP: f64 = 5.0;

/// Where a bar stands and how large it is.
pub(super) struct ColourBar<'a> {
    pub(super) bands: &'a Bands,
    /// What is written above it; may be empty.
    pub(super) label: &'a str,
    /// Upper left corner.
    pub(super) at: Point,
    pub(super) width: f64,
    pub(super) height: f64,
    /// Size of the numbers.
    pub(super) size: f64,
}

impl ColourBar<'_> {
    pub(super) fn draw(&self, figure: &mut Figure) {
        let [x, _] = self.at;
        let band = self.height / self.bands.colours.len() as f64;
        for (index, &colour) in self.bands.colours.iter().enumerate() {
            // From here to the top, so that no gap shows between bands.
            let height = self.height - index as f64 * band;
            let corner = Path::rectangle(self.at, [self.width, height]);
            figure.path(Path { fill: Some(Ink::opaque(colour)), ..corner });
        }
        figure.path(Path { stroke: Some(AXIS), ..Path::rectangle(self.at, [self.width, self.height]) });
        for (index, label) in self.shown_labels() {
            let middle = self.edge(index) + HALF_DIGIT * self.size;
            figure.text(Text::new(label, [x + self.width + LABEL_GAP, middle], self.size, QUIET));
        }
        let above = [x + self.width, self.at[1] - LABEL_SIZE];
        figure.text(Text::new(self.label, above, LABEL_SIZE, TEXT).anchored(Anchor::End));
    }

    /// Space that the bar and its numbers take to the right of its corner.
    pub(super) fn taken(bands: &Bands, width: f64, size: f64) -> f64 {
        let longest = bands.labels.iter().map(|label| Text::new(label, [0.0; 2], size, TEXT).width());
        width + LABEL_GAP + longest.fold(0.0, f64::max)
    }

    fn edge(&self, index: usize) -> f64 {
        self.at[1] + self.height * (1.0 - index as f64 / self.bands.colours.len() as f64)
    }

    /// As many labels as fit above each other, the same on both sides of the middle.
    fn shown_labels(&self) -> impl Iterator<Item = (usize, &str)> {
        let band = self.height / self.bands.colours.len() as f64;
        let every = (1.15 * self.size / band).ceil().max(1.0) as usize;
        let last = self.bands.labels.len() - 1;
        let is_shown = move |index: usize| {
            let from_end = index.min(last - index);
            // Without a middle edge both sides count from the ends, else from the middle.
            let steps = if last % 2 == 1 { from_end } else { last / 2 - from_end };
            steps.is_multiple_of(every)
        };
        let labels = self.bands.labels.iter().enumerate();
        labels.filter(move |(index, _)| is_shown(*index)).map(|(index, label)| (index, label.as_str()))
    }
}
