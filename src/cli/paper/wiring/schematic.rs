//! The schematic from a module's half-bridges down to the pins of its converter and of the controller.

use super::drawing::{
    DARK, INK, MARGIN, NOTE_LINE, QUIET, TEXT_SIZE, TITLE_SIZE, WIRE, divider, node, terminal,
};
use super::pins::{
    DIGITAL, MIDPOINT_CAPACITOR, MIDPOINT_RESISTOR, REFERENCES, SUPPLIES, TAP_RESISTOR, inputs, limits,
};
use tactpad::pad::device::Device;
use tactpad::pad::wiring::HALF_BRIDGES;
use tactpad::pad::wiring::front_end::{ANALOGUE_SUPPLY_V, CONVERTER, EXCITATION_V};
use tactpad::plot::figure::{Anchor, Figure, Ink, Path, Point, Stroke, Text};

/// Places, in pixels: columns from the bridges to the controller, rows from the first bridge down.
const BRIDGE_X: f64 = 74.0;
const PULL_X: f64 = 196.0;
const BUS_X: f64 = 268.0;
const CHIP: [f64; 2] = [330.0, 470.0];
const CAPACITOR_X: f64 = 560.0;
const PICO: [f64; 2] = [760.0, 900.0];
const TOP: f64 = 52.0;
const FIRST_ROW: f64 = 140.0;
const ROW: f64 = 170.0;
/// Bridge z and the mid-point stand lower than their rows: above z there are two gauges, and its tap is at the second input.
const LOWER: [f64; 4] = [0.0, 0.0, 14.0, 38.0];
/// Between the two inputs of a bridge.
const PAIR: f64 = 26.0;
/// From a tap to either end of its bridge, and what a second gauge takes.
const HALF: f64 = 62.0;
const SECOND: f64 = 44.0;
const FIRST_PIN: f64 = 84.0;
const PIN: f64 = 34.0;
const SUPPLY_PIN: f64 = 64.0;
const WIDTH: f64 = 930.0;
const BODY: Stroke = Stroke::solid(DARK, 1.6);

/// One module with its converter; the others are the same but for their selects.
pub(super) fn schematic(device: &Device) -> Figure {
    let title = format!("A module’s half-bridges at its {CONVERTER} and the Pico");
    let bottom = rows(HALF_BRIDGES.len())[0] + HALF + 30.0;
    let limits = limits(device);
    let height = bottom + 28.0 + limits.len() as f64 * NOTE_LINE;
    let mut figure = Figure::new(WIDTH, height, title.clone());
    figure.text(Text::new(title, [MARGIN, MARGIN + TITLE_SIZE], TITLE_SIZE, INK).semi_bold());
    body(&mut figure, CHIP, bottom, &format!("{CONVERTER} of module 0"));
    body(&mut figure, PICO, bottom, "Raspberry Pi Pico");
    bridges(&mut figure, device);
    mid_point(&mut figure);
    digital(&mut figure);
    supplies(&mut figure);
    references(&mut figure);
    for (line, note) in (1_u32..).zip(limits) {
        figure.text(Text::new(note, [MARGIN, bottom + 10.0 + f64::from(line) * NOTE_LINE], TEXT_SIZE, INK));
    }
    figure
}

fn body(figure: &mut Figure, [left, right]: [f64; 2], bottom: f64, name: &str) {
    figure.path(Path { stroke: Some(BODY), ..Path::rectangle([left, TOP], [right - left, bottom - TOP]) });
    let at = [0.5 * (left + right), TOP - 7.0];
    figure.text(Text::new(name, at, TEXT_SIZE, INK).anchored(Anchor::Middle).semi_bold());
}

fn wire(figure: &mut Figure, points: &[Point]) {
    figure.path(Path::strokes(vec![points.to_vec()], WIRE));
}

/// A pin's name inside a body, whose edge is at this x; the wire comes from the left or from the right.
fn pin(figure: &mut Figure, x: f64, y: f64, name: &str, is_left: bool) {
    let (at, anchor) = if is_left { (x + 7.0, Anchor::Start) } else { (x - 7.0, Anchor::End) };
    figure.text(Text::new(name, [at, y + 0.36 * TEXT_SIZE], TEXT_SIZE, INK).anchored(anchor));
}

/// The places of a bridge's tap and of the two inputs.
fn rows(number: usize) -> [f64; 2] {
    let middle = FIRST_ROW + ROW * number as f64 + LOWER[number];
    [middle, middle + PAIR]
}

fn bridges(figure: &mut Figure, device: &Device) {
    let inputs = inputs();
    for (number, bridge) in HALF_BRIDGES.iter().enumerate() {
        let [first_y, second_y] = rows(number);
        let pair = [(&inputs[2 * number], first_y), (&inputs[2 * number + 1], second_y)];
        for (input, y) in pair {
            pin(figure, CHIP[0], y, &input.pin, true);
            if input.tap.is_none() {
                node(figure, [BUS_X, y]);
                wire(figure, &[[BUS_X, y], [CHIP[0], y]]);
                continue;
            }
            let top_y = y - HALF - SECOND * (bridge.to_supply.len() - 1) as f64;
            divider(figure, device, bridge, BRIDGE_X, [top_y, y, y + HALF]);
            node(figure, [BRIDGE_X, y]);
            supply(figure, [BRIDGE_X, top_y], &format!("{EXCITATION_V} V"));
            ground(figure, [BRIDGE_X, y + HALF]);
            wire(figure, &[[BRIDGE_X, y], [CHIP[0], y]]);
            let at = [BRIDGE_X + 34.0, y - 6.0];
            figure.text(Text::new(format!("m0{}", bridge.axis), at, TEXT_SIZE, INK).semi_bold());
            node(figure, [PULL_X, y]);
            resistor(figure, PULL_X, [y - 58.0, y], TAP_RESISTOR);
            supply(figure, [PULL_X, y - 58.0], &format!("{ANALOGUE_SUPPLY_V} V"));
        }
    }
}

/// The second mid-point, which all inputs without a tap share.
fn mid_point(figure: &mut Figure) {
    let y = rows(HALF_BRIDGES.len())[0];
    resistor(figure, BRIDGE_X, [y - HALF, y], MIDPOINT_RESISTOR);
    resistor(figure, BRIDGE_X, [y, y + HALF], MIDPOINT_RESISTOR);
    supply(figure, [BRIDGE_X, y - HALF], &format!("{EXCITATION_V} V"));
    ground(figure, [BRIDGE_X, y + HALF]);
    node(figure, [BRIDGE_X, y]);
    let last = rows(2);
    let first_of_bus = rows(0)[1];
    let inputs = inputs();
    let last_of_bus = if inputs[4].tap.is_none() { last[0] } else { last[1] };
    wire(figure, &[[BRIDGE_X, y], [BUS_X, y], [BUS_X, first_of_bus.min(last_of_bus)]]);
    let at = [BUS_X + 6.0, y + 0.36 * TEXT_SIZE];
    figure.text(Text::new("mid-point", at, TEXT_SIZE, INK).semi_bold());
    node(figure, [PULL_X, y]);
    capacitor(figure, [PULL_X, y], MIDPOINT_CAPACITOR);
}

fn digital(figure: &mut Figure) {
    for (number, [name, pico, which]) in DIGITAL.iter().enumerate() {
        let y = FIRST_PIN + PIN * number as f64;
        pin(figure, CHIP[1], y, name, false);
        pin(figure, PICO[0], y, pico, true);
        wire(figure, &[[CHIP[1], y], [PICO[0], y]]);
        let at = [0.5 * (CHIP[1] + PICO[0]), y - 5.0];
        figure.text(Text::new(*which, at, TEXT_SIZE, Ink::opaque(QUIET)).anchored(Anchor::Middle));
    }
}

fn supplies(figure: &mut Figure) {
    let first = FIRST_PIN + PIN * DIGITAL.len() as f64 + 8.0;
    for (number, [name, net, farads]) in SUPPLIES.iter().enumerate() {
        let y = first + SUPPLY_PIN * number as f64;
        pin(figure, CHIP[1], y, name, false);
        wire(figure, &[[CHIP[1], y], [CAPACITOR_X, y]]);
        capacitor(figure, [CAPACITOR_X, y], farads);
        if !net.is_empty() {
            node(figure, [CAPACITOR_X, y]);
            let end = [CAPACITOR_X + 42.0, y];
            wire(figure, &[[CAPACITOR_X, y], end]);
            terminal(figure, end);
            figure.text(Text::new(*net, [end[0] + 8.0, y + 0.36 * TEXT_SIZE], TEXT_SIZE, INK));
        }
    }
    let y = first + SUPPLY_PIN * SUPPLIES.len() as f64 + 8.0;
    pin(figure, CHIP[1], y, "AGND, DGND", false);
    wire(figure, &[[CHIP[1], y], [CAPACITOR_X, y], [CAPACITOR_X, y + 8.0]]);
    ground(figure, [CAPACITOR_X, y + 8.0]);
}

fn references(figure: &mut Figure) {
    let first = rows(HALF_BRIDGES.len())[0];
    for (number, [name, net, what]) in REFERENCES.iter().enumerate() {
        let y = first + 44.0 * number as f64;
        pin(figure, PICO[0], y, name, true);
        let end = [PICO[0] - 30.0, y];
        wire(figure, &[end, [PICO[0], y]]);
        terminal(figure, end);
        let text = |text: &str, y: f64, ink: Ink| {
            Text::new(text, [end[0] - 8.0, y], TEXT_SIZE, ink).anchored(Anchor::End)
        };
        figure.text(text(net, y + 0.36 * TEXT_SIZE, INK));
        figure.text(text(what, y + 0.36 * TEXT_SIZE + 14.0, Ink::opaque(QUIET)));
    }
}

/// A resistor between two heights, its value on the right.
fn resistor(figure: &mut Figure, x: f64, [top, bottom]: [f64; 2], ohms: &str) {
    let [width, height] = [12.0, 30.0];
    let middle = 0.5 * (top + bottom);
    wire(figure, &[[x, top], [x, middle - 0.5 * height]]);
    wire(figure, &[[x, middle + 0.5 * height], [x, bottom]]);
    let corner = [x - 0.5 * width, middle - 0.5 * height];
    figure.path(Path { stroke: Some(WIRE), ..Path::rectangle(corner, [width, height]) });
    let at = [x + 0.5 * width + 5.0, middle + 0.36 * TEXT_SIZE];
    figure.text(Text::new(ohms, at, TEXT_SIZE, Ink::opaque(QUIET)));
}

/// A capacitor from here down to ground, its value on the right.
fn capacitor(figure: &mut Figure, [x, y]: Point, farads: &str) {
    let plates = [y + 15.0, y + 20.0];
    wire(figure, &[[x, y], [x, plates[0]]]);
    for plate in plates {
        wire(figure, &[[x - 9.0, plate], [x + 9.0, plate]]);
    }
    wire(figure, &[[x, plates[1]], [x, y + 32.0]]);
    ground(figure, [x, y + 32.0]);
    let at = [x + 14.0, y + 17.5 + 0.36 * TEXT_SIZE];
    figure.text(Text::new(farads, at, TEXT_SIZE, Ink::opaque(QUIET)));
}

fn supply(figure: &mut Figure, at: Point, name: &str) {
    terminal(figure, at);
    let above = [at[0], at[1] - 8.0];
    figure.text(Text::new(name, above, TEXT_SIZE, INK).anchored(Anchor::Middle));
}

fn ground(figure: &mut Figure, [x, y]: Point) {
    for (step, half) in [(0.0, 9.0), (4.0, 6.0), (8.0, 3.0)] {
        wire(figure, &[[x - half, y + step], [x + half, y + step]]);
    }
}

#[cfg(test)]
mod tests {
    use tactpad::plot::figure::Mark;

    use super::*;

    #[test]
    fn every_pin_is_drawn_once_and_a_falling_channel_has_its_tap_at_the_negative_input() {
        let figure = schematic(&Device::nominal());
        let texts: Vec<&Text> = figure
            .marks()
            .iter()
            .filter_map(|mark| if let Mark::Text(text) = mark { Some(text) } else { None })
            .collect();
        let count = |wanted: &str| texts.iter().filter(|text| text.text == wanted).count();
        let pins = inputs().into_iter().map(|input| input.pin);
        let named = DIGITAL.iter().chain(&SUPPLIES).chain(&REFERENCES).map(|it| it[0].to_owned());
        for pin in pins.chain(named) {
            assert_eq!(count(&pin), 1, "{pin}");
        }
        assert_eq!((count("3.3 V"), count("2.5 V"), count(TAP_RESISTOR), count("m0z")), (3, 4, 3, 1));
        let z = inputs().into_iter().find(|input| input.tap == Some("z")).map(|input| input.pin);
        assert_eq!(z.as_deref(), Some("AIN2N"));
    }
}
