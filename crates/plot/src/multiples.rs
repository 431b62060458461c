//! Many small plans in rows and columns.

use super::colour_bar::ColourBar;
use super::figure::{Anchor, Figure, Text};
use super::plan::{Field, Plan};
use super::style::{HALF_DIGIT, LABEL_SIZE, MARGIN, NUMBER_SIZE, QUIET, SMALL_SIZE, TEXT, TITLE_SIZE};

/// Plans side by side, all of the size of the first one.
#[derive(Clone, Debug)]
pub struct Multiples {
    /// What they show.
    pub title: String,
    /// What the reader must know besides, under the plans. May be empty.
    pub note: String,
    /// One for each column; tells how many there are.
    pub column_titles: Vec<String>,
    /// One for each row.
    pub row_titles: Vec<String>,
    /// Row by row. Their own titles and axes are not drawn.
    pub plans: Vec<Plan>,
    /// Width of a plan in pixels.
    pub plan_width: f64,
    /// Where the colours are explained.
    pub bars: Bars,
}

/// Where the colours are explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bars {
    /// Once, for all: the plans share the bands of the first one.
    Shared,
    /// Beside each plan.
    Each,
}

const GAP: f64 = 10.0;
const BAR_WIDTH: f64 = 12.0;
const SMALL_BAR_WIDTH: f64 = 6.0;
const BAR_HEIGHT_MAX: f64 = 360.0;

/// Lengths of the table.
struct Layout {
    columns: usize,
    rows: usize,
    /// From one plan's corner to the next one's.
    pitch: [f64; 2],
    /// Upper left corner of the first plan.
    corner: [f64; 2],
    plan_height: f64,
}

impl Multiples {
    /// The table. Without plans it is a page with a title.
    pub fn figure(&self) -> Figure {
        let layout = self.layout();
        let shared = self.field().filter(|_| self.bars == Bars::Shared);
        let bar =
            shared.map_or(0.0, |field| 2.0 * GAP + ColourBar::taken(&field.bands, BAR_WIDTH, NUMBER_SIZE));
        let width = layout.corner[0] + layout.columns as f64 * layout.pitch[0] - GAP + bar + MARGIN;
        let foot = MARGIN + if self.note.is_empty() { 0.0 } else { 2.0 * NUMBER_SIZE };
        let plans_end = layout.corner[1] + layout.rows as f64 * layout.pitch[1] - GAP;
        let mut figure = Figure::new(width, plans_end + foot, self.title.clone());
        self.write_titles(&mut figure, &layout);
        for (index, plan) in self.plans.iter().enumerate() {
            self.draw_plan(&mut figure, plan, layout.place(index), layout.plan_height);
        }
        if let Some(field) = shared {
            let at = [width - bar - MARGIN + 2.0 * GAP, layout.corner[1] + GAP];
            let height = (plans_end - at[1]).min(BAR_HEIGHT_MAX);
            bar_of(field, at, height).draw(&mut figure);
        }
        let note = [layout.corner[0], plans_end + foot - MARGIN];
        figure.text(Text::new(&self.note, note, NUMBER_SIZE, QUIET));
        figure
    }

    fn field(&self) -> Option<&Field> {
        self.plans.first().and_then(|plan| plan.field.as_ref())
    }

    fn layout(&self) -> Layout {
        let columns = self.column_titles.len().max(1);
        let plan_height = self.plans.first().map_or(0.0, |plan| plan.height(self.plan_width));
        let row_title = self.row_titles.iter().map(|title| row_text(title).width()).fold(0.0, f64::max);
        let bars = self.plans.iter().filter_map(|plan| plan.field.as_ref());
        let bars = bars.map(|field| GAP + ColourBar::taken(&field.bands, SMALL_BAR_WIDTH, SMALL_SIZE));
        let bar = if self.bars == Bars::Each { bars.fold(0.0, f64::max) } else { 0.0 };
        Layout {
            columns,
            rows: self.plans.len().div_ceil(columns),
            pitch: [self.plan_width + bar + GAP, plan_height + GAP],
            corner: [MARGIN + row_title + GAP, MARGIN + 2.0 * TITLE_SIZE + 2.2 * LABEL_SIZE],
            plan_height,
        }
    }

    fn write_titles(&self, figure: &mut Figure, layout: &Layout) {
        let at = [MARGIN, MARGIN + TITLE_SIZE];
        figure.text(Text::new(&self.title, at, TITLE_SIZE, TEXT).semi_bold());
        for (column, title) in self.column_titles.iter().enumerate() {
            let [x, y] = layout.place(column);
            let above = [x + 0.5 * self.plan_width, y - 0.7 * LABEL_SIZE];
            figure.text(Text::new(title, above, LABEL_SIZE, TEXT).anchored(Anchor::Middle));
        }
        for (row, title) in self.row_titles.iter().enumerate() {
            let [x, y] = layout.place(row * layout.columns);
            let mut text = row_text(title);
            text.at = [x - GAP, y + 0.5 * layout.plan_height + HALF_DIGIT * LABEL_SIZE];
            figure.text(text);
        }
    }

    fn draw_plan(&self, figure: &mut Figure, plan: &Plan, at: [f64; 2], height: f64) {
        plan.draw(figure, &plan.window(at, self.plan_width));
        if let (Some(field), Bars::Each) = (&plan.field, self.bars) {
            let corner = [at[0] + self.plan_width + GAP, at[1] + 0.05 * height];
            let small = ColourBar {
                label: "",
                width: SMALL_BAR_WIDTH,
                size: SMALL_SIZE,
                ..bar_of(field, corner, 0.9 * height)
            };
            small.draw(figure);
        }
    }
}

fn row_text(title: &str) -> Text {
    Text::new(title, [0.0; 2], LABEL_SIZE, TEXT).anchored(Anchor::End)
}

fn bar_of(field: &Field, at: [f64; 2], height: f64) -> ColourBar<'_> {
    ColourBar { bands: &field.bands, label: &field.label, at, width: BAR_WIDTH, height, size: NUMBER_SIZE }
}

impl Layout {
    fn place(&self, index: usize) -> [f64; 2] {
        let [column, row] = [index % self.columns, index / self.columns];
        [self.corner[0] + column as f64 * self.pitch[0], self.corner[1] + row as f64 * self.pitch[1]]
    }
}
