//! The paper's Figure 7: how errors fall and R² rises in both stages, and predicted against true.

use super::simulation::Pretrained;
use tactpad_core::network::training::Epoch;
use tactpad_core::network::training::score::Score;
use tactpad_plot::chart::{Chart, GuideLine, GuidePlace, Series, SeriesLook, Side, Value};
use tactpad_plot::figure::Figure;
use tactpad_plot::scale::Scale;

/// The five numbers of a contact, as figures and tables call them.
pub const NAMES: [&str; 5] = ["x", "y", "Fx", "Fy", "Fz"];

const WIDTH: f64 = 520.0;
/// A panel of a training's figure.
const PANEL: f64 = 360.0;

/// Dots of a scatter plot: more would be one blot.
const DOTS_MAX: usize = 400;

fn side(label: &str, scale: Scale) -> Side {
    Side { label: label.into(), scale, also: Vec::new() }
}

fn series(name: &str, look: SeriesLook, values: impl Iterator<Item = [f64; 2]>) -> Series {
    Series { name: name.into(), values: values.map(|[x, y]| Value::new(x, y)).collect(), look }
}

/// Errors and R² of each epoch, standardised, side by side; `paper` is what the paper reports of this stage.
pub fn training(stage: &str, curve: &[Epoch], paper: Option<Score>) -> Figure {
    let line = |name: &str, of: fn(&Epoch) -> f64| {
        series(name, SeriesLook::Line, curve.iter().map(|epoch| [epoch.number as f64, of(epoch)]))
    };
    let guide = |of: fn(&Score) -> f64| {
        let at =
            |score: &Score| GuideLine { at: GuidePlace::Y(of(score)), label: "the paper’s test".into() };
        paper.as_ref().map(at).into_iter().collect::<Vec<_>>()
    };
    let validation = |of| line("validation", of);
    let panels = [
        (
            format!("{stage}: mean squared error"),
            side("MSE, standardised", Scale::Log10),
            vec![line("training", |epoch| epoch.training_mse), validation(|epoch| epoch.validation_mse)],
            guide(|score| score.mse),
        ),
        (
            "Mean absolute error".into(),
            side("MAE, standardised", Scale::Log10),
            vec![validation(|epoch| epoch.validation_mae)],
            guide(|score| score.mae),
        ),
        (
            "Explained variance".into(),
            side("R²", Scale::Linear),
            vec![validation(|epoch| epoch.validation_r2)],
            guide(|score| score.r2),
        ),
    ];
    let mut page = Figure::new(panels.len() as f64 * PANEL, PANEL, format!("Training, {stage}"));
    for (column, (title, y, series, guides)) in panels.into_iter().enumerate() {
        let x = side("epoch", Scale::Linear);
        let chart = Chart { title, width: PANEL, height: PANEL, x, y, series, guides };
        page.place(chart.figure(), [column as f64 * PANEL, 0.0]);
    }
    page
}

/// Predicted against true for each number of a contact, standardised, with the numbers' names.
pub fn scatters(pretrained: &Pretrained) -> Vec<(String, Figure)> {
    let network = &pretrained.trained.network;
    let pairs: Vec<_> = pretrained
        .test
        .iter()
        .take(DOTS_MAX)
        .map(|example| {
            [example.contact, network.decode(&example.uv)].map(|contact| network.standardised(&contact))
        })
        .collect();
    let scatter = |(index, name): (usize, &str)| {
        let dots = pairs.iter().map(|[wanted, found]| [wanted[index], found[index]].map(f64::from));
        let chart = Chart {
            title: format!("{name} of contacts that the network has not seen"),
            width: WIDTH,
            height: WIDTH,
            x: side("true, standardised", Scale::Linear),
            y: side("predicted, standardised", Scale::Linear),
            series: vec![
                series("predicted", SeriesLook::Points, dots),
                series("true", SeriesLook::Line, [[-2.0; 2], [2.0; 2]].into_iter()),
            ],
            guides: Vec::new(),
        };
        (name.to_lowercase(), chart.figure())
    };
    NAMES.into_iter().enumerate().map(scatter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_plot::figure::Mark;

    #[test]
    fn both_losses_and_the_papers_figures_are_drawn() {
        let epoch = |number: usize| {
            let falling = 1.0 / number as f64;
            Epoch {
                number,
                training_mse: falling,
                validation_mse: 2.0 * falling,
                validation_mae: falling,
                validation_r2: 1.0 - falling,
            }
        };
        let curve: Vec<Epoch> = (1..9).map(epoch).collect();
        let longest = |figure: &Figure| {
            let lines = figure.marks().iter().filter_map(|mark| match mark {
                Mark::Path(path) if path.lines.iter().any(|line| line.len() == curve.len()) => Some(()),
                _ => None,
            });
            lines.count()
        };
        let papers = |figure: &Figure| {
            let is_papers = |mark: &&Mark| matches!(mark, Mark::Text(text) if text.text.contains("paper"));
            figure.marks().iter().filter(is_papers).count()
        };
        let paper = Some(super::super::simulation::PAPER);
        let [first, second] = [paper, None].map(|paper| training("stage", &curve, paper));
        assert_eq!((longest(&first), papers(&first)), (4, 3));
        assert_eq!((longest(&second), papers(&second)), (4, 0));
    }
}
