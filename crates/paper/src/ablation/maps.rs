//! Where on the plate decoders are wrong.

use super::drawing::{DecoderContacts, QUANTITIES, Quantity};
use super::unseen::Unseen;
use tactpad_plot::bands::Bands;
use tactpad_plot::figure::Figure;
use tactpad_plot::grid::Grid;
use tactpad_plot::isoline::Isolines;
use tactpad_plot::multiples::{Bars, Multiples};
use tactpad_plot::plan::{Field, Plan};

const PLAN_WIDTH: f64 = 170.0;
const NODES: usize = 61;
/// Scale over which errors are averaged: some twenty contacts of a plan.
const SPREAD_MM: f64 = 4.0;

/// Mean errors around each place: a column for each decoder, position above force.
pub fn over_plate(unseen: &Unseen, outcomes: &[DecoderContacts<'_>], reach_mm: f64) -> Figure {
    let rows = QUANTITIES.map(|quantity| row(unseen, outcomes, reach_mm, &quantity).figure());
    let [width, height] = rows[0].size();
    let mut page =
        Figure::new(width.max(rows[1].size()[0]), height + rows[1].size()[1], "Errors over the plate");
    for (figure, top) in rows.into_iter().zip([0.0, height]) {
        page.place(figure, [0.0, top]);
    }
    page
}

fn row(unseen: &Unseen, outcomes: &[DecoderContacts<'_>], reach_mm: f64, quantity: &Quantity) -> Multiples {
    let grids: Vec<Grid> = outcomes.iter().map(|outcome| grid(unseen, outcome, reach_mm, quantity)).collect();
    let spans = grids.iter().filter_map(Grid::span);
    let span = spans.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])]);
    let bands = Bands::sequential_decades(span);
    let plan = |grid: Grid| Plan {
        title: String::new(),
        x: [-reach_mm, reach_mm],
        y: [-reach_mm, reach_mm],
        x_label: String::new(),
        y_label: String::new(),
        field: Some(Field { grid, bands: bands.clone(), isolines: Isolines::None, label: String::new() }),
        shapes: vec![],
    };
    Multiples {
        title: format!("{}, unseen contacts of the {} plan", quantity.label, unseen.plan),
        note: String::new(),
        column_titles: outcomes.iter().map(|(entry, _)| entry.to_string()).collect(),
        row_titles: vec![],
        plans: grids.into_iter().map(plan).collect(),
        plan_width: PLAN_WIDTH,
        bars: Bars::Shared,
    }
}

/// Means around each place, the nearer contacts counting more.
fn grid(unseen: &Unseen, (_, judged): &DecoderContacts<'_>, reach_mm: f64, quantity: &Quantity) -> Grid {
    let pairs = || judged.found.iter().zip(unseen.truths());
    let errors: Vec<_> =
        pairs().map(|(found, truth)| ([truth.x_mm, truth.y_mm], (quantity.of)(found, truth))).collect();
    Grid::over_disc(reach_mm, NODES, |x_mm, y_mm| {
        let weighted = errors.iter().map(|(place_mm, error)| {
            let square = (place_mm[0] - x_mm).powi(2) + (place_mm[1] - y_mm).powi(2);
            let weight = (-0.5 * square / (SPREAD_MM * SPREAD_MM)).exp();
            [weight, weight * error]
        });
        let [weight, sum] = weighted.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        sum / weight
    })
}
