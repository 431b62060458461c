//! Verbs for who plays: a pad, its profile, its decoder and the bridge between them.

pub(super) mod completions;
#[cfg(target_os = "linux")]
pub(super) mod live;
pub(super) mod profile;
pub(super) mod replay;
pub(super) mod source;
pub(super) mod tune;
pub(super) mod weigh;

use clap::{Command, Subcommand};

use crate::cli::failure::Failure;

#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Begin here: a few questions lead to the first game.
    #[cfg(target_os = "linux")]
    Setup(live::setup::Arguments),
    /// Play with a virtual pad: nothing needs to be attached.
    #[cfg(target_os = "linux")]
    Demo(live::demo::Arguments),
    /// Play: turn what a pad feels into key and gamepad events.
    #[cfg(target_os = "linux")]
    Run(live::run::Arguments),
    /// Measure a new pad for the first time: noise, a known weight, and which channel is wired where.
    #[cfg(target_os = "linux")]
    Bench(live::bench::Arguments),
    /// Calibrate a pad at home: press it all over, and put a weight on five marks, which --sheet prints.
    #[cfg(target_os = "linux")]
    Calibrate(live::calibrate::Arguments),
    /// Find by one known weight what gain a pad has lost, and keep it in its decoder.
    Weigh(weigh::Arguments),
    /// Fit a profile to a hand, by a recording and a table of what was meant when.
    Tune(tune::Arguments),
    /// List, show and check profiles.
    Profile(profile::Arguments),
    /// List, show and check descriptions of pads that are no strain pads.
    Source(source::Arguments),
    /// Talk to the running bridge.
    #[cfg(target_os = "linux")]
    Ctl(live::ctl::Arguments),
    /// List what is attached.
    #[cfg(target_os = "linux")]
    Devices(live::devices::Arguments),
    /// Say what stands in the way here, and the command that mends it.
    #[cfg(target_os = "linux")]
    Doctor(live::doctor::Arguments),
    /// Record a pad, so that `replay` gives the same events again.
    #[cfg(target_os = "linux")]
    Record(live::record::Arguments),
    /// Print the events that a capture, or a list of contacts, leads to.
    Replay(replay::Arguments),
    /// Measure how long it takes from the pad's bytes to the written event, and where that time goes.
    #[cfg(target_os = "linux")]
    Latency(live::latency::Arguments),
    /// Print a shell's completions of verbs and options.
    Completions(completions::Arguments),
}

/// Runs one of them; `program` is the whole program's command line, for its completions.
pub(super) fn run(verb: &Verb, program: impl FnOnce() -> Command) -> Result<(), Failure> {
    match verb {
        #[cfg(target_os = "linux")]
        Verb::Setup(arguments) => live::setup::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Demo(arguments) => live::demo::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Run(arguments) => live::run::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Bench(arguments) => live::bench::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Calibrate(arguments) => live::calibrate::run(arguments),
        Verb::Weigh(arguments) => weigh::run(arguments),
        Verb::Tune(arguments) => tune::run(arguments),
        Verb::Profile(arguments) => profile::run(arguments),
        Verb::Source(arguments) => source::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Ctl(arguments) => live::ctl::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Devices(arguments) => live::devices::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Doctor(arguments) => live::doctor::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Record(arguments) => live::record::run(arguments),
        Verb::Replay(arguments) => replay::run(arguments),
        #[cfg(target_os = "linux")]
        Verb::Latency(arguments) => live::latency::run(arguments),
        Verb::Completions(arguments) => completions::run(arguments, &mut program()),
    }
}
