//! The live verbs: those that need ports, virtual devices and a clock.

#[cfg(feature = "tray")]
pub(super) mod alone;
mod calibrate;
#[cfg(feature = "dashboard")]
mod calibrated;
mod chosen;
mod ctl;
mod demo;
#[cfg(feature = "tray")]
mod desk;
mod devices;
mod doctor;
mod files;
mod follower;
mod keeping;
mod kept_play;
#[cfg(feature = "tray")]
mod last_profile;
mod latency;
mod newest;
mod output;
#[cfg(feature = "dashboard")]
mod page;
mod playing;
mod record;
#[cfg(feature = "dashboard")]
mod reported;
mod run;
mod screen;
mod shown;
mod sound;
mod wish;

use clap::Subcommand;

use crate::cli::failure::Failure;

#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Play with a virtual pad: nothing needs to be attached.
    Demo(demo::Arguments),
    /// Play: a pad in, key and gamepad events out.
    Run(run::Arguments),
    /// Talk to the running bridge.
    Ctl(ctl::Arguments),
    /// List what is attached.
    Devices(devices::Arguments),
    /// Say what stands in the way here, and the command that mends it.
    Doctor(doctor::Arguments),
    /// Record a pad, so that `replay` gives the same events again.
    Record(record::Arguments),
    /// Calibrate a pad at home: presses, a weight on five marks, and a sheet that shows them.
    Calibrate(calibrate::Arguments),
    /// Measure from pad bytes readable to event written, and where the time goes.
    Latency(latency::Arguments),
}

pub(super) fn run(verb: &Verb) -> Result<(), Failure> {
    match verb {
        Verb::Demo(arguments) => demo::run(arguments),
        Verb::Run(arguments) => run::run(arguments),
        Verb::Ctl(arguments) => ctl::run(arguments),
        Verb::Devices(arguments) => devices::run(arguments),
        Verb::Doctor(arguments) => doctor::run(arguments),
        Verb::Record(arguments) => record::run(arguments),
        Verb::Calibrate(arguments) => calibrate::run(arguments),
        Verb::Latency(arguments) => latency::run(arguments),
    }
}
