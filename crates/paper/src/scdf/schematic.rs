//! The paper's Figure 6: the network layer by layer, and the two stages that its weights go through.

use tactpad_core::network::Network;
use tactpad_core::quantity::CHANNEL_NAMES;
use tactpad_plot::colour::Rgb;
use tactpad_plot::figure::{Anchor, Circle, Ends, Figure, Ink, Mark, Path, Point, Stroke, Text};

use super::adaptation::BETAS;
use super::drawing::NAMES;
use super::{BATCH, EPOCHS_MAX, RATE, VALIDATION_PART};

const DARK: Ink = Ink::opaque(Rgb::new(0x1f, 0x24, 0x2b));
const QUIET: Ink = Ink::opaque(Rgb::new(0x52, 0x5b, 0x66));
const EDGE: Stroke = Stroke::solid(Rgb::new(0xd4, 0xd8, 0xdd), 0.5);
const FRAME: Stroke = Stroke::solid(Rgb::new(0x7b, 0x84, 0x8f), 1.0);
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 520.0;
const TOP: f64 = 70.0;
const BOTTOM: f64 = 350.0;
const TITLE_SIZE: f64 = 13.0;
const TEXT_SIZE: f64 = 11.0;

/// Neurons of a layer that are drawn; of a wider one, the first and the last.
const DRAWN: usize = 11;

/// The network's layers with all connections between the neurons that are drawn, and its training below.
pub fn network(network: &Network) -> Figure {
    let widths = network.widths();
    let title = format!("The network: {} weights and biases", network.parameters());
    let mut figure = Figure::new(WIDTH, HEIGHT, title.clone());
    figure.text(Text::new(title, [14.0, 14.0 + TITLE_SIZE], TITLE_SIZE, DARK).semi_bold());
    let [left, right] = [190.0, WIDTH - 190.0];
    let pitch = (right - left) / (widths.len().max(2) - 1) as f64;
    let columns: Vec<Vec<Point>> =
        widths.iter().enumerate().map(|(k, width)| neurons(left + k as f64 * pitch, *width)).collect();
    for pair in columns.windows(2) {
        let lines = pair[0].iter().flat_map(|from| pair[1].iter().map(|to| vec![*from, *to]));
        figure.path(Path::strokes(lines.collect(), EDGE));
    }
    for (index, (column, width)) in columns.iter().zip(&widths).enumerate() {
        layer(&mut figure, column, *width, [index, widths.len() - 1]);
    }
    if let [first, .., last] = columns.as_slice() {
        names(&mut figure, first, &CHANNEL_NAMES, -1.0);
        names(&mut figure, last, &NAMES, 1.0);
    }
    scaler(&mut figure, left - 92.0, "z-score of µV");
    scaler(&mut figure, right + 92.0, "to mm, N");
    stages(&mut figure);
    figure
}

/// Places of the neurons of a layer that are drawn, one above the other.
fn neurons(x: f64, width: usize) -> Vec<Point> {
    let drawn = width.min(DRAWN);
    let pitch = (BOTTOM - TOP) / DRAWN as f64;
    let middle = 0.5 * (TOP + BOTTOM);
    (0..drawn)
        // In the middle of a wider layer one is left out, for the dots.
        .filter(|k| width <= DRAWN || *k != DRAWN / 2)
        .map(|k| [x, middle + (k as f64 - 0.5 * (drawn as f64 - 1.0)) * pitch])
        .collect()
}

fn layer(figure: &mut Figure, column: &[Point], width: usize, [index, last]: [usize; 2]) {
    let colour = Rgb::of_series(if index == 0 {
        0
    } else if index == last {
        2
    } else {
        1
    });
    for &centre in column {
        let (fill, stroke) = (Some(Ink::opaque(colour)), Some(Stroke::solid(Rgb::WHITE, 1.0)));
        figure.add(Mark::Circle(Circle { centre, radius: 7.0, fill, stroke }));
    }
    let Some(&[x, _]) = column.first() else { return };
    if width > DRAWN {
        let dots = [-6.0, 0.0, 6.0].map(|dy| [x, 0.5 * (TOP + BOTTOM) + dy]);
        let dot = |centre| Mark::Circle(Circle { centre, radius: 1.6, fill: Some(DARK), stroke: None });
        dots.into_iter().for_each(|centre| figure.add(dot(centre)));
    }
    let kind = match index {
        0 => "channels",
        index if index == last => "linear",
        _ => "ReLU",
    };
    let middle = |text: String, y| Text::new(text, [x, y], TEXT_SIZE, DARK).anchored(Anchor::Middle);
    figure.text(middle(width.to_string(), TOP - 12.0).semi_bold());
    figure.text(middle(kind.to_owned(), BOTTOM + 16.0));
}

/// Names beside the neurons of an outer layer; `side` is −1 on the left, 1 on the right.
fn names(figure: &mut Figure, column: &[Point], names: &[&str], side: f64) {
    let anchor = if side < 0.0 { Anchor::End } else { Anchor::Start };
    for ([x, y], name) in column.iter().zip(names) {
        let at = [x + side * 14.0, y + 0.36 * TEXT_SIZE];
        figure.text(Text::new(*name, at, TEXT_SIZE, QUIET).anchored(anchor));
    }
}

/// The standardisation before the first layer, or after the last.
fn scaler(figure: &mut Figure, x: f64, text: &str) {
    let size = [30.0, BOTTOM - TOP];
    let corner = [x - 0.5 * size[0], TOP];
    figure.path(Path { stroke: Some(FRAME), ..Path::rectangle(corner, size) });
    let at = [x + 0.36 * TEXT_SIZE, 0.5 * (TOP + BOTTOM)];
    figure.text(Text::new(text, at, TEXT_SIZE, DARK).anchored(Anchor::Middle).turned(-90.0));
}

/// The two stages, one after the other.
fn stages(figure: &mut Figure) {
    let held = 100 / VALIDATION_PART;
    let first = [
        "Stage I: simulated contacts".to_owned(),
        format!("{} / {held} / {held} %: learnt from, validation, test", 100 - 2 * held),
        format!("Adam, rate {RATE}, batches of {BATCH}, {EPOCHS_MAX} epochs"),
        "loss: |found − true|² of the five standardised numbers".to_owned(),
    ];
    let [low, .., high] = BETAS;
    let second = [
        "Stage II: measured contacts of one pad".to_owned(),
        format!("{} / {held} %: learnt from, validation; the scalers stay", 100 - held),
        format!(
            "Adam, rate {}, until {} epochs are no better",
            super::adaptation::RATE,
            super::adaptation::PATIENCE
        ),
        format!("loss: the same + β |θ − θ_{{0}}|², β from {low} to {high}"),
    ];
    let (size, top) = ([400.0, 88.0], BOTTOM + 52.0);
    let corners = [[40.0, top], [WIDTH - 40.0 - size[0], top]];
    for (corner, lines) in corners.into_iter().zip([first, second]) {
        figure.path(Path { stroke: Some(FRAME), ..Path::rectangle(corner, size) });
        for (number, line) in (1_u32..).zip(lines) {
            let at = [corner[0] + 12.0, corner[1] + 20.0 * f64::from(number) - 1.0];
            let text = Text::new(line, at, TEXT_SIZE, DARK);
            figure.text(if number == 1 { text.semi_bold() } else { text });
        }
    }
    let (from, to, y) = (corners[0][0] + size[0], corners[1][0], top + 0.5 * size[1]);
    figure.path(Path::strokes(
        vec![vec![[from, y], [to - 8.0, y]]],
        Stroke { ink: DARK, width: 1.2, dash: None },
    ));
    let head = vec![vec![[to, y], [to - 9.0, y - 4.0], [to - 9.0, y + 4.0]]];
    figure.path(Path { ends: Ends::Closed, ..Path::area(head, DARK) });
    let above = [0.5 * (from + to), y - 8.0];
    figure.text(Text::new("θ_{0}", above, TEXT_SIZE, DARK).anchored(Anchor::Middle));
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::network::Zero;

    #[test]
    fn the_layers_are_the_networks() {
        let untrained = Network::untrained(&[64, 7], Zero::Tared, &[], 1);
        let figure = network(&untrained);
        let has = |wanted: &str| {
            figure
                .marks()
                .iter()
                .filter(|mark| matches!(mark, Mark::Text(text) if text.text == wanted))
                .count()
        };
        assert_eq!(["9", "64", "7", "5"].map(has), [1; 4]);
        assert_eq!((has("ReLU"), has("m2z"), has("Fz")), (2, 1, 1));
        let neurons = |mark: &&Mark| matches!(mark, Mark::Circle(circle) if circle.radius > 5.0);
        // Of the wide layer ten are drawn.
        assert_eq!(figure.marks().iter().filter(neurons).count(), 9 + 10 + 7 + 5);
        let title = format!("The network: {} weights and biases", 9 * 64 + 64 + 64 * 7 + 7 + 7 * 5 + 5);
        assert_eq!(figure.description(), title);
    }
}
