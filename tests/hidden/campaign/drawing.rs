//! How often each cause was found, as bars.

use serde_json::Value;
use tactpad::plot::colour::Rgb;
use tactpad::plot::figure::{Anchor, Figure, Ink, Path, Stroke, Text};

use crate::sizes::CAUSES;

const DARK: Ink = Ink::opaque(Rgb::new(0x1f, 0x24, 0x2b));
const QUIET: Ink = Ink::opaque(Rgb::new(0xc9, 0xce, 0xd6));
const NAMED: Ink = Ink::opaque(Rgb::new(0x1f, 0x6f, 0xb4));
const IN_SET: Ink = Ink::opaque(Rgb::new(0x9d, 0xc6, 0xe8));

const LEFT: f64 = 150.0;
const TOP: f64 = 74.0;
const ROW: f64 = 17.0;
const BAR: f64 = 190.0;
const GAP: f64 = 30.0;

/// Bars of both sizes for each cause: named alone, and in a confounded set.
pub(super) fn figure(lines: &[Value]) -> Figure {
    let height = TOP + ROW * CAUSES.len() as f64 + 16.0;
    let mut figure = Figure::new(LEFT + 2.0 * BAR + GAP + 16.0, height, "Hidden causes that were found");
    figure.text(Text::new("Hidden causes that were found", [12.0, 24.0], 15.0, DARK).semi_bold());
    legend(&mut figure);
    for (column, times) in [1.0, 3.0].into_iter().enumerate() {
        let left = LEFT + column as f64 * (BAR + GAP);
        let title = format!("{times} × the least detectable");
        figure.text(Text::new(title, [left, TOP - 8.0], 11.0, DARK));
        scale(&mut figure, left, height);
        for (row, effect) in CAUSES.iter().enumerate() {
            bar(&mut figure, [left, TOP + ROW * row as f64], shares(lines, effect, times));
        }
    }
    for (row, effect) in CAUSES.iter().enumerate() {
        let at = [LEFT - 8.0, TOP + ROW * (row as f64 + 0.7)];
        figure.text(Text::new(effect.replace('_', " "), at, 11.0, DARK).anchored(Anchor::End));
    }
    figure
}

fn legend(figure: &mut Figure) {
    for (index, (ink, name)) in [(NAMED, "named"), (IN_SET, "in a confounded set")].into_iter().enumerate() {
        let left = 12.0 + 80.0 * index as f64;
        figure.path(filled([left, 38.0], [12.0, 10.0], ink));
        figure.text(Text::new(name, [left + 17.0, 47.0], 11.0, DARK));
    }
}

/// Lines at 0, 50 and 100 %.
fn scale(figure: &mut Figure, left: f64, height: f64) {
    for half in 0..3 {
        let x = left + BAR * f64::from(half) / 2.0;
        figure.path(Path::strokes(
            vec![vec![[x, TOP - 2.0], [x, height - 14.0]]],
            Stroke { ink: QUIET, width: 0.8, dash: None },
        ));
        let label = format!("{} %", 50 * half);
        figure.text(Text::new(label, [x, height - 3.0], 9.0, DARK).anchored(Anchor::Middle));
    }
}

fn bar(figure: &mut Figure, [left, top]: [f64; 2], shares: Option<[f64; 2]>) {
    match shares {
        Some([named, found]) => {
            figure.path(filled([left, top + 3.0], [BAR * found, ROW - 6.0], IN_SET));
            figure.path(filled([left, top + 3.0], [BAR * named, ROW - 6.0], NAMED));
        }
        None => figure.text(Text::new("no size in these plans", [left + 6.0, top + 12.0], 10.0, QUIET)),
    }
}

fn filled(at: [f64; 2], size: [f64; 2], ink: Ink) -> Path {
    Path { fill: Some(ink), ..Path::rectangle(at, size) }
}

/// Shares of the runs that named a cause, and that had it in a set or named it.
fn shares(lines: &[Value], effect: &str, times: f64) -> Option<[f64; 2]> {
    let own = |line: &&Value| line["part"] == "sizes" && line["effect"] == effect && line["times"] == times;
    let sizes: Vec<u64> =
        lines.iter().filter(own).filter_map(|line| line["score"]["set_sizes"][0].as_u64()).collect();
    let share =
        |hit: fn(&u64) -> bool| sizes.iter().filter(|size| hit(size)).count() as f64 / sizes.len() as f64;
    (!sizes.is_empty()).then(|| [share(|size| *size == 1), share(|size| *size > 0)])
}
