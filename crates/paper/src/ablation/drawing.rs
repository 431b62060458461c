//! Error against calibration samples and against force, and the six regions of Figure 11 in time.

use super::entries::{AblationEntry, Method, Samples};
use super::regions::{REGIONS, TOUCH_S, TouchMoment};
use super::unseen::{Unseen, UnseenContacts};
use crate::metrology::table3::PublishedErrors;
use tactpad_core::network::numbers;
use tactpad_core::quantity::Contact;
use tactpad_core::tables::measured::Label;
use tactpad_numeric::statistics::mean;
use tactpad_plot::chart::{Chart, GuideLine, GuidePlace, Series, SeriesLook, Side, Value};
use tactpad_plot::figure::Figure;
use tactpad_plot::scale::Scale;

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 420.0;
const STRIP_WIDTH: f64 = 1040.0;
const STRIP_HEIGHT: f64 = 150.0;
/// The first strip has title and legend besides.
const HEAD: f64 = 40.0;

/// Width of the bins of force over which errors are averaged.
const FORCE_BIN_N: f64 = 0.5;

/// A decoder with what it made of the unseen contacts.
pub type DecoderContacts<'j> = (&'j AblationEntry, &'j UnseenContacts);

/// One of the two errors that are drawn.
#[derive(Clone, Copy)]
pub(super) struct Quantity {
    pub(super) label: &'static str,
    pub(super) of: fn(&Contact, &Label) -> f64,
    judged: fn(&UnseenContacts) -> f64,
    paper: fn(&PublishedErrors) -> f64,
    least: fn(&Unseen, &[Label]) -> f64,
}

pub(super) const QUANTITIES: [Quantity; 2] = [
    Quantity {
        label: "position MAE in mm",
        of: |found, truth| 0.5 * (off(found.x_mm, truth.x_mm) + off(found.y_mm, truth.y_mm)),
        judged: |judged| judged.by_truth.position_mae_mm,
        paper: |paper| paper.position_mae_mm,
        least: |unseen, truths| unseen.least(truths).position_mae_mm,
    },
    Quantity {
        label: "force MAE in N",
        of: |found, truth| {
            let axes = [(found.fx_n, truth.fx_n), (found.fy_n, truth.fy_n), (found.fz_n, truth.fz_n)];
            mean(axes.map(|(found, truth)| off(found, truth)))
        },
        judged: |judged| judged.by_truth.force_mae_n,
        paper: |paper| paper.force_mae_n,
        least: |unseen, truths| unseen.least(truths).force_mae_n,
    },
];

fn off(found: f32, truth: f64) -> f64 {
    (f64::from(found) - truth).abs()
}

/// Error against calibration samples: position beside force.
pub fn by_samples(unseen: &Unseen, outcomes: &[DecoderContacts<'_>]) -> Figure {
    // What learnt from no measured contact has no place on a logarithmic axis.
    let measured: Vec<DecoderContacts<'_>> =
        outcomes.iter().copied().filter(|(entry, _)| entry.samples.measured() > 0).collect();
    let title = format!("Error by calibration samples, unseen contacts of the {} plan", unseen.plan);
    beside(&title, |quantity| {
        let axes = chart("measured contacts that it learnt from", quantity.label, Scale::Log10);
        Chart {
            series: curves(&measured, quantity),
            guides: guides(unseen, outcomes, quantity),
            x: Side { also: vec![10.0, 1000.0], ..axes.x },
            ..axes
        }
    })
}

/// A curve for each method, the network's by kinds of load, and the paper's points.
fn curves(measured: &[DecoderContacts<'_>], quantity: &Quantity) -> Vec<Series> {
    let curve = |name: &str, is_in: &dyn Fn(&AblationEntry) -> bool| {
        let values = measured.iter().filter(|(entry, _)| is_in(entry));
        let values = values.map(|(entry, judged)| [samples(entry), (quantity.judged)(judged)]);
        series(name, SeriesLook::LineAndPoints, values)
    };
    let of = |method: Method| curve(method.name(), &|entry| entry.method == method && entry.is_drawn());
    let by_load =
        |entry: &AblationEntry| entry.method == Method::Network && (!entry.is_drawn() || entry.has_all());
    let papers = measured.iter().filter_map(|(entry, _)| Some((entry, entry.paper.as_ref()?)));
    let papers = papers.map(|(entry, paper)| [samples(entry), (quantity.paper)(paper)]);
    let methods = [Method::Network, Method::Knn, Method::Linear, Method::Wrench, Method::Inverse];
    let mut curves = methods.map(of).to_vec();
    curves.push(curve("network, normal loads first", &by_load));
    curves.push(series("the paper: network; at 648 also knn and linear", SeriesLook::Points, papers));
    curves
}

fn samples(entry: &AblationEntry) -> f64 {
    entry.samples.measured() as f64
}

/// The bound, and the network that knows the simulation only.
fn guides(unseen: &Unseen, outcomes: &[DecoderContacts<'_>], quantity: &Quantity) -> Vec<GuideLine> {
    let guide = |value: f64, label: &str| GuideLine { at: GuidePlace::Y(value), label: label.to_owned() };
    let is_simulated =
        |entry: &AblationEntry| entry.method == Method::Network && entry.samples == Samples::Simulated;
    let simulated = outcomes.iter().find(|(entry, _)| is_simulated(entry));
    let simulated = simulated.map(|(_, judged)| guide((quantity.judged)(judged), "network, simulation only"));
    let least = guide((quantity.least)(unseen, unseen.truths()), "least that the noise allows");
    [least].into_iter().chain(simulated).collect()
}

/// Error against the contact's force, of the decoders that learnt from the whole plan: position beside force.
pub fn by_force(unseen: &Unseen, outcomes: &[DecoderContacts<'_>]) -> Figure {
    let order = in_order_of_force(unseen.truths());
    let bin = |index: &usize| (unseen.truths()[*index].resultant_n() / FORCE_BIN_N).round();
    let parts: Vec<&[usize]> = order.chunk_by(|one, next| bin(one) == bin(next)).collect();
    let truths = |part: &[usize]| part.iter().map(|index| unseen.truths()[*index]).collect::<Vec<_>>();
    let force_n = |part: &[usize]| mean(part.iter().map(|index| unseen.truths()[*index].resultant_n()));
    beside(&format!("Error by force, unseen contacts of the {} plan", unseen.plan), |quantity| {
        let line = |(entry, judged): &DecoderContacts<'_>| {
            let error = |index: &usize| (quantity.of)(&judged.found[*index], &unseen.truths()[*index]);
            let values = parts.iter().map(|part| [force_n(part), mean(part.iter().map(error))]);
            series(&entry.to_string(), SeriesLook::LineAndPoints, values)
        };
        let least = parts.iter().map(|part| [force_n(part), (quantity.least)(unseen, &truths(part))]);
        let least = series("least that the noise allows", SeriesLook::Dashes, least);
        let learnt = outcomes.iter().filter(|(entry, _)| entry.has_all());
        Chart {
            series: learnt.map(line).chain([least]).collect(),
            ..chart("resultant force in N", quantity.label, Scale::Linear)
        }
    })
}

fn in_order_of_force(truths: &[Label]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..truths.len()).collect();
    order.sort_by(|one, other| truths[*one].resultant_n().total_cmp(&truths[*other].resultant_n()));
    order
}

/// The touches of the regions, number by number over the time: true, and as each decoder has it. Where nothing touches, a
/// decoder has no place.
pub fn by_region(decoded: &[(String, Vec<TouchMoment>)]) -> Figure {
    let names = ["x in mm", "y in mm", "Fx in N", "Fy in N", "Fz in N"];
    let title = title();
    let mut page = Figure::new(STRIP_WIDTH, names.len() as f64 * STRIP_HEIGHT + HEAD, title.clone());
    let mut top = 0.0;
    for (number, name) in names.into_iter().enumerate() {
        let strip = strip(decoded, number, name);
        let (head, title) = if number == 0 { (HEAD, title.clone()) } else { (0.0, String::new()) };
        let strip = Chart { title, height: STRIP_HEIGHT + head, ..strip };
        page.place(strip.figure(), [0.0, top]);
        top += strip.height;
    }
    page
}

fn title() -> String {
    let names: Vec<&str> = REGIONS.iter().map(|(name, _)| *name).collect();
    format!("Pressed in turn: {}; shear turns once round", names.join(", "))
}

fn strip(decoded: &[(String, Vec<TouchMoment>)], number: usize, name: &str) -> Chart {
    let value = |moment: &TouchMoment, contact: [f64; 5]| {
        let touches = moment.truth.fz_n > 0.0 || number > 1;
        [moment.t_s, if touches { contact[number] } else { f64::NAN }]
    };
    let named = |name: &str| if number == 0 { name.to_owned() } else { String::new() };
    let truth = decoded.first().map(|(_, moments)| {
        let values = moments.iter().map(|moment| value(moment, moment.truth.numbers()));
        series(&named("true"), SeriesLook::Broad, values)
    });
    let found = decoded.iter().map(|(name, moments)| {
        let values = moments.iter().map(|moment| value(moment, numbers(&moment.found).map(f64::from)));
        series(&named(name), SeriesLook::ThinDashes, values)
    });
    let starts = (1_u32..).take(REGIONS.len() - 1).map(|index| TOUCH_S * f64::from(index));
    let guides = starts.map(|t_s| GuideLine { at: GuidePlace::X(t_s), label: String::new() });
    Chart {
        width: STRIP_WIDTH,
        // The truth lies below, so that what covers it is seen.
        series: truth.into_iter().chain(found).collect(),
        guides: guides.collect(),
        y: Side { label: name.to_owned(), scale: Scale::Linear, also: vec![] },
        ..chart(if number == 4 { "time in s" } else { "" }, "", Scale::Linear)
    }
}

/// A chart for each of the two errors, side by side, under one title.
fn beside(title: &str, chart: impl Fn(&Quantity) -> Chart) -> Figure {
    let mut page = Figure::new(2.0 * WIDTH, HEIGHT, title);
    for (column, quantity) in QUANTITIES.iter().enumerate() {
        let title = if column == 0 { title.to_owned() } else { " ".to_owned() };
        let chart = Chart { title, ..chart(quantity) };
        page.place(chart.figure(), [column as f64 * WIDTH, 0.0]);
    }
    page
}

fn series(name: &str, look: SeriesLook, values: impl Iterator<Item = [f64; 2]>) -> Series {
    Series { name: name.to_owned(), values: values.map(|[x, y]| Value::new(x, y)).collect(), look }
}

/// Errors are drawn by their logarithm.
fn chart(x: &str, y: &str, x_scale: Scale) -> Chart {
    let side = |label: &str, scale| Side { label: label.to_owned(), scale, also: vec![] };
    Chart {
        title: String::new(),
        width: WIDTH,
        height: HEIGHT,
        x: side(x, x_scale),
        y: side(y, Scale::Log10),
        series: vec![],
        guides: vec![],
    }
}
