//! `tactpad wiring`: half-bridges, channels and gauges of a device file, so that a module can be wired from it.

mod drawing;
mod pins;
mod schematic;

use std::fmt;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use self::pins::FrontEnd;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::files::device::PadOptions;
use crate::cli::printing::pictures;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::pad::device::{Device, Direction, GAUGES, Gauge};
use tactpad::pad::wiring::{HALF_BRIDGES, HalfBridge, gauge_name};
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};

/// Arguments of `tactpad wiring`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad wiring --figures figures")]
#[group(skip)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pad: PadOptions,
    /// Print where the pins of the converters and of the controller go, instead of bridges, gauges and modules.
    #[arg(long, conflicts_with = "json")]
    pins: bool,
    /// Write the figures wiring-bridges, wiring-film, wiring-plate and wiring-converter into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// The wiring, for a builder.
#[derive(Serialize)]
struct Wiring {
    excitation_v: f64,
    channels: [Channel; CHANNELS],
    gauges: [Placed; GAUGES],
    modules: [Site; MODULES],
    front_end: FrontEnd,
}

/// A channel with its half-bridge.
#[derive(Serialize)]
struct Channel {
    name: &'static str,
    /// In series between the excitation and the tap.
    to_supply: Vec<String>,
    /// In series between the tap and ground.
    to_ground: Vec<String>,
    /// The channel is four times the tap's departure from half the excitation, with this sign.
    polarity: f64,
}

/// A gauge on the film's underside, in the module's frame.
#[derive(Serialize)]
struct Placed {
    name: String,
    x_mm: f64,
    y_mm: f64,
    length_mm: f64,
    width_mm: f64,
    grid_along: &'static str,
    resistance_ratio: f64,
    half_bridge: &'static str,
}

/// Where a module stands, in the pad's frame.
#[derive(Serialize)]
struct Site {
    centre_mm: [f64; 2],
    along_x: [f64; 2],
    along_y: [f64; 2],
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let device = arguments.pad.read()?;
    let folder = arguments.figures.as_deref().map(Folder::of).transpose()?;
    if let Some(folder) = &folder {
        let converter = ("wiring-converter", schematic::schematic(&device));
        for (name, figure) in drawing::of(&device).into_iter().chain([converter]) {
            pictures::write(folder, name, &figure)?;
        }
    }
    if arguments.pins {
        return Ok(writeln!(stdout(), "{}", FrontEnd::of(&device))?);
    }
    let wiring = Wiring::of(&device);
    if arguments.json { print_json(&wiring) } else { Ok(writeln!(stdout(), "{wiring}")?) }
}

impl Wiring {
    fn of(device: &Device) -> Self {
        let poses = device.poses();
        Self {
            excitation_v: device.circuit.excitation_v,
            channels: std::array::from_fn(|channel| {
                let HalfBridge { to_supply, to_ground, polarity, .. } = HALF_BRIDGES[channel % 3];
                let [to_supply, to_ground] =
                    [to_supply, to_ground].map(|side| side.iter().map(|gauge| gauge_name(*gauge)).collect());
                Channel { name: CHANNEL_NAMES[channel], to_supply, to_ground, polarity }
            }),
            gauges: std::array::from_fn(|gauge| Placed::of(gauge, &device.gauges[gauge])),
            modules: poses.map(|pose| Site {
                centre_mm: pose.centre_mm,
                along_x: pose.along_x,
                along_y: pose.along_y,
            }),
            front_end: FrontEnd::of(device),
        }
    }
}

impl Placed {
    fn of(number: usize, gauge: &Gauge) -> Self {
        let Gauge { x_mm, y_mm, length_mm, width_mm, direction, resistance_ratio } = *gauge;
        let bridge = HALF_BRIDGES.iter().find(|bridge| bridge.has(number));
        Self {
            name: gauge_name(number),
            x_mm,
            y_mm,
            length_mm,
            width_mm,
            grid_along: match direction {
                Direction::X => "x",
                Direction::Y => "y",
            },
            resistance_ratio,
            half_bridge: bridge.map_or("", |bridge| bridge.axis),
        }
    }
}

impl fmt::Display for Wiring {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let half_v = 0.5 * self.excitation_v;
        writeln!(
            f,
            "Half-bridges between {} V and ground; V is a tap's voltage against ground",
            self.excitation_v
        )?;
        writeln!(f, "{:<8} {:<14} {:<14} reads", "channel", "supply to tap", "tap to ground")?;
        for Channel { name, to_supply, to_ground, polarity } in &self.channels {
            let [above, below] = [to_supply, to_ground].map(|side| side.join(" + "));
            let factor = 4.0 * polarity;
            writeln!(f, "{name:<8} {above:<14} {below:<14} {factor:>2} (V − {half_v} V)")?;
        }
        writeln!(
            f,
            "\nGauges on the film's underside, in the module's frame: x along the tangent, counter-clockwise, y outwards"
        )?;
        writeln!(
            f,
            "{:<6} {:>7} {:>7} {:>10} {:>9}  {:<10} {:>10}  half-bridge",
            "gauge", "x mm", "y mm", "length mm", "width mm", "grid along", "resistance"
        )?;
        for gauge in &self.gauges {
            let Placed { name, x_mm, y_mm, length_mm, width_mm, grid_along, resistance_ratio, half_bridge } =
                gauge;
            let ratio = format!("{resistance_ratio} R");
            writeln!(
                f,
                "{name:<6} {x_mm:>7.2} {y_mm:>7.2} {length_mm:>10.2} {width_mm:>9.2}  {grid_along:<10} {ratio:>10}  {half_bridge}"
            )?;
        }
        write!(
            f,
            "\nModules under the plate, seen from above\n{:<8} {:>7} {:>7}  {:>14}",
            "module", "x mm", "y mm", "its x points"
        )?;
        for (index, Site { centre_mm: [x_mm, y_mm], along_x: [along, up], .. }) in
            self.modules.iter().enumerate()
        {
            let to_deg = up.atan2(*along).to_degrees().rem_euclid(360.0);
            write!(f, "\n{index:<8} {x_mm:>7.2} {y_mm:>7.2}  {:>14}", format!("to {to_deg:.1}°"))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nominal_pad_is_told_gauge_by_gauge() {
        let told = Wiring::of(&Device::nominal()).to_string();
        for line in [
            "m0x      R2             R1              4 (V − 1.4 V)",
            "m2z      R5 + R6        R7             -4 (V − 1.4 V)",
            "R5       -1.10    0.00       0.80      0.80  x               0.5 R  z",
            "1         -10.00   17.32       to 210.0°",
        ] {
            assert!(told.contains(line), "{line}:\n{told}");
        }
        assert_eq!(told.lines().count(), 2 + CHANNELS + 2 + 1 + GAUGES + 2 + 1 + MODULES);
    }

    #[test]
    fn another_device_is_told_as_its_file_has_it() {
        let text = Device::nominal().to_toml().replace("excitation_v = 2.8", "excitation_v = 3.3");
        let device = Device::from_toml(&text).0.unwrap();
        let document = serde_json::to_value(Wiring::of(&device)).unwrap();
        assert_eq!(document["excitation_v"], 3.3);
        assert_eq!(document["channels"][5]["to_supply"], serde_json::json!(["R5", "R6"]));
        assert_eq!(document["gauges"][2]["grid_along"], "y");
        assert_eq!(document["front_end"]["inputs"][5], serde_json::json!({"pin": "AIN2N", "tap": "z"}));
    }
}
