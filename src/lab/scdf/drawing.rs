//! The paper's Figures 6 and 7: how the loss falls, and predicted against true.

use super::simulation::Pretrained;
use crate::network::training::Epoch;
use crate::plot::chart::{Chart, Series, SeriesLook, Side, Value};
use crate::plot::figure::Figure;
use crate::plot::scale::Scale;

/// The five numbers of a contact, as figures and tables call them.
pub const NAMES: [&str; 5] = ["x", "y", "Fx", "Fy", "Fz"];

const WIDTH: f64 = 520.0;

/// Dots of a scatter plot: more would be one blot.
const DOTS_MAX: usize = 400;

fn side(label: &str, scale: Scale) -> Side {
    Side { label: label.into(), scale, also: Vec::new() }
}

fn series(name: &str, look: SeriesLook, values: impl Iterator<Item = [f64; 2]>) -> Series {
    Series { name: name.into(), values: values.map(|[x, y]| Value::new(x, y)).collect(), look }
}

/// The loss of each epoch.
pub fn loss(curve: &[Epoch]) -> Figure {
    let line = |name: &str, of: fn(&Epoch) -> f64| {
        series(name, SeriesLook::Line, curve.iter().map(|epoch| [epoch.number as f64, of(epoch)]))
    };
    let chart = Chart {
        title: "Loss of stage I".into(),
        width: WIDTH,
        height: 0.7 * WIDTH,
        x: side("epoch", Scale::Linear),
        y: side("mean squared error, standardised", Scale::Log10),
        series: vec![
            line("training", |epoch| epoch.training_mse),
            line("validation", |epoch| epoch.validation_mse),
        ],
        guides: Vec::new(),
    };
    chart.figure()
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
