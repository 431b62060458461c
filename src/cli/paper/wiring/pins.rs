//! Where each pin of the front end goes, from bridge to controller, and what stands on the way.

use std::fmt;

use serde::Serialize;

use tactpad::pad::device::Device;
use tactpad::pad::wiring::HALF_BRIDGES;
use tactpad::pad::wiring::front_end::{
    ANALOGUE_SUPPLY_V, CONVERTER, EXCITATION_V, GAIN, HEADROOM_V, input_max_v, range_mv, tap_range_mv,
};

/// The Pico's pins of what all converters share, or of those of module 0, 1 and 2.
pub(super) const DIGITAL: [[&str; 3]; 7] = [
    ["SCLK", "GP2", "of all three converters"],
    ["DIN", "GP3", "of all three"],
    ["DOUT", "GP4", "of all three"],
    ["CS", "GP5, GP6, GP7", "of module 0, 1, 2"],
    ["DRDY", "GP8", "of module 0; of the others it stays open"],
    ["SYNC/RESET", "GP9", "of all three; 10 kΩ to DVDD"],
    ["CLKIN", "GP10", "of all three, by traces of one length"],
];
/// Supplies of a converter: pin, net, capacitor to ground.
pub(super) const SUPPLIES: [[&str; 3]; 3] =
    [["AVDD", "3.3 V analogue", "1 µF"], ["DVDD", "3V3 of the Pico", "1 µF"], ["CAP", "", "220 nF"]];
/// The Pico's own: pin, net, purpose.
pub(super) const REFERENCES: [[&str; 3]; 2] = [
    ["GP26", "2.5 V excitation", "reads it, so that counts follow it"],
    ["ADC_VREF", "3.0 V", "shunt reference"],
];
pub(super) const MIDPOINT_RESISTOR: &str = "1 kΩ, 0.1 %";
pub(super) const MIDPOINT_CAPACITOR: &str = "100 nF";
pub(super) const TAP_RESISTOR: &str = "10 MΩ";

/// Inputs of a converter, and the numbers that they must keep to.
#[derive(Serialize)]
pub(super) struct FrontEnd {
    converter: &'static str,
    gain: f64,
    excitation_v: f64,
    analogue_supply_v: f64,
    /// Voltage of a tap without load, against ground.
    tap_v: f64,
    /// The largest that an input may have at this gain.
    input_max_v: f64,
    /// Full scale between a tap and the mid-point.
    tap_range_mv: f64,
    /// The same of a channel.
    range_mv: f64,
    inputs: Vec<Input>,
}

/// A pin of an input.
#[derive(Serialize)]
pub(super) struct Input {
    pub(super) pin: String,
    /// The tap's channel without its module; nothing for the mid-point.
    pub(super) tap: Option<&'static str>,
}

impl FrontEnd {
    pub(super) fn of(device: &Device) -> Self {
        Self {
            converter: CONVERTER,
            gain: GAIN,
            excitation_v: EXCITATION_V,
            analogue_supply_v: ANALOGUE_SUPPLY_V,
            tap_v: 0.5 * EXCITATION_V,
            input_max_v: input_max_v(),
            tap_range_mv: tap_range_mv(),
            range_mv: range_mv(device),
            inputs: inputs(),
        }
    }
}

/// The inputs of a module's converter: a channel that grows with its tap's voltage has it at the positive input.
pub(super) fn inputs() -> Vec<Input> {
    let of_bridge = |(number, bridge): (usize, &tactpad::pad::wiring::HalfBridge)| {
        let (tap, middle) = (Some(bridge.axis), None);
        let [positive, negative] = if bridge.polarity > 0.0 { [tap, middle] } else { [middle, tap] };
        [("P", positive), ("N", negative)].map(|(side, tap)| Input { pin: format!("AIN{number}{side}"), tap })
    };
    HALF_BRIDGES.iter().enumerate().flat_map(of_bridge).collect()
}

/// What limits the voltages, in a sentence each.
pub(super) fn limits(device: &Device) -> [String; 3] {
    let FrontEnd { gain, excitation_v, tap_v, input_max_v, tap_range_mv, range_mv, .. } =
        FrontEnd::of(device);
    [
        format!(
            "Common mode: at gains of 8 and above an input stays below AVDD − {HEADROOM_V} V = {input_max_v:.1} V; a tap lies at {tap_v} V."
        ),
        format!(
            "Range: gain {gain}, ±{tap_range_mv} mV between tap and mid-point, which is ±{range_mv:.0} mV of a channel."
        ),
        format!(
            "Channels are told as of the device file’s {} V, whatever the {excitation_v} V are: the controller reads them.",
            device.circuit.excitation_v
        ),
    ]
}

impl fmt::Display for FrontEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { converter, excitation_v, inputs, .. } = self;
        writeln!(f, "Each module's {converter}")?;
        for Input { pin, tap } in inputs {
            let to = tap.map_or_else(
                || format!("mid-point: two of {MIDPOINT_RESISTOR}, from {excitation_v} V to ground, {MIDPOINT_CAPACITOR} across the lower"),
                |axis| format!("tap of {axis}, {TAP_RESISTOR} to AVDD"),
            );
            writeln!(f, "{pin:<11} {to}")?;
        }
        for [pin, net, capacitor] in SUPPLIES {
            let net = if net.is_empty() { String::new() } else { format!("{net}, ") };
            writeln!(f, "{pin:<11} {net}{capacitor} to ground")?;
        }
        writeln!(f, "{:<11} ground, one plane", "AGND, DGND")?;
        writeln!(f, "\nThe Pico")?;
        for [pin, pico, which] in DIGITAL {
            writeln!(f, "{pico:<14} {pin} {which}")?;
        }
        for (at, [pin, net, what]) in REFERENCES.iter().enumerate() {
            write!(f, "{}{pin:<14} {net}: {what}", if at > 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}
