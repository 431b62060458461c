//! `tactpad ctl`: talks to the running bridge.

pub(super) mod answer;
mod weigh;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::Value;

use self::answer::{answered, no_answer};
use super::left_keys;
use super::runtime::{self, BridgeName, socket_path};
use super::sound::{Sounds, Which};
use crate::cli::failure::Failure;
use crate::cli::number;
use crate::cli::playing::profile;
use crate::cli::printing::written::{printable, stdout};
use tactpad::bridge::control::{is_there, watch};
use tactpad::bridge::weighing::gain_sentence;

/// Arguments of `tactpad ctl`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad ctl profile tetris")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,
    /// Print the bridge's answer, one JSON document.
    #[arg(long, global = true)]
    json: bool,
    /// The bridge of this name; without it the one without a name, else the only one that plays.
    #[arg(long = "name", id = "bridge", value_name = "NAME", global = true)]
    bridge: Option<BridgeName>,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Say what the bridge is doing.
    #[command(after_help = "Example: tactpad ctl status --json")]
    Status,
    /// Print one line of JSON for each press that is accepted or rejected, until the bridge ends.
    #[command(after_help = "Example: tactpad ctl watch --sound")]
    Watch {
        /// Play a sound for each rejected press, or with "all" for accepted ones, too.
        #[arg(long, value_name = "WHICH", num_args = 0..=1, default_missing_value = "rejected")]
        sound: Option<Which>,
    },
    /// Release everything and ignore the pad.
    #[command(after_help = "Example: tactpad ctl pause")]
    Pause,
    /// Go on after a pause.
    #[command(after_help = "Example: tactpad ctl resume")]
    Resume,
    /// Release everything at once, and go on; also keys that a killed bridge left down on an X server.
    #[command(after_help = "Example: tactpad ctl panic")]
    Panic,
    /// Measure the zero again; leave the pad untouched.
    #[command(after_help = "Example: tactpad ctl tare")]
    Tare,
    /// Put a known weight on the plate: it tells what gain the pad has lost, and forces are corrected by it.
    ///
    /// Begin with nothing on the plate. Then let the weight rest for three seconds, anywhere on the plate; nothing is
    /// pressed in the game meanwhile. It counts until the pad is unplugged, and at the end it says how to keep it for good.
    #[command(after_help = "Example: tactpad ctl weigh 200")]
    Weigh {
        /// The weight, in grams.
        #[arg(value_name = "GRAMS", value_parser = number::grams, allow_hyphen_values = true)]
        grams: f64,
    },
    /// Go over to another profile.
    #[command(after_help = "Example: tactpad ctl profile tetris")]
    Profile {
        /// A profile's name or file.
        name: String,
    },
    /// Go over to the next profile of `profile list` that a press can leave again.
    #[command(after_help = "Example: tactpad ctl next-profile")]
    NextProfile,
    /// Read the profile in use again, after it was changed.
    #[command(after_help = "Example: tactpad ctl reload")]
    Reload,
    /// Print the address of the page that shows the bridge; whoever has it can use the bridge.
    #[command(after_help = "Example: tactpad ctl dashboard")]
    Dashboard,
    /// End the bridge.
    #[command(after_help = "Example: tactpad ctl quit")]
    Quit,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = reached(arguments.bridge.as_ref())?;
    let request = match &arguments.action {
        Action::Watch { sound } => return watch_presses(&path, *sound),
        Action::Weigh { grams } => return weigh::run(&path, *grams, arguments.json),
        Action::Status => "status".to_owned(),
        Action::Pause => "pause".to_owned(),
        Action::Resume => "resume".to_owned(),
        Action::Panic => "panic".to_owned(),
        Action::Tare => "tare".to_owned(),
        Action::NextProfile => "next-profile".to_owned(),
        Action::Reload => "reload".to_owned(),
        Action::Dashboard => "dashboard".to_owned(),
        Action::Quit => "quit".to_owned(),
        Action::Profile { name } => format!("profile {}", absolute(name)?),
    };
    let is_lifted = matches!(arguments.action, Action::Panic) && left_keys::lift();
    if is_lifted && !arguments.json && !is_there(&path) {
        // What was to be released is released.
        return Ok(());
    }
    let (answer, document) = answered(&path, &request)?;
    match arguments.action {
        _ if arguments.json => Ok(writeln!(stdout(), "{answer}")?),
        Action::Status => Ok(print_status(&document)?),
        Action::Dashboard => {
            let url = document.get("url").and_then(Value::as_str).map_or_else(String::new, printable);
            Ok(writeln!(stdout(), "{url}")?)
        }
        _ => Ok(()),
    }
}

/// Where the bridge listens that is meant: without a name the one that has none, else the only one there is.
pub(super) fn reached(name: Option<&BridgeName>) -> Result<PathBuf, Failure> {
    let path = socket_path(name)?;
    if name.is_some() || is_there(&path) {
        return Ok(path);
    }
    let mut there = Vec::new();
    for name in runtime::named()? {
        let path = socket_path(Some(&name))?;
        if is_there(&path) {
            there.push((name, path));
        }
    }
    if there.len() > 1 {
        let names: Vec<_> = there.iter().map(|(name, _)| format!("`--name {name}`")).collect();
        return Err(Failure::Unusable(format!(
            "several bridges play, and none of them is without a name: say which one by {}",
            names.join(" or ")
        )));
    }
    Ok(there.pop().map_or(path, |(_, path)| path))
}

/// Prints what becomes of each press, and plays a sound for it if that is asked for.
fn watch_presses(path: &Path, sound: Option<Which>) -> Result<(), Failure> {
    let sounds = sound.map(Sounds::start).transpose()?;
    let mut is_answered = false;
    let mut out = stdout();
    let mut printed: Result<(), Failure> = Ok(());
    let watched = watch(path, |line| {
        if !std::mem::replace(&mut is_answered, true) {
            let refused =
                serde_json::from_str(line).ok().and_then(|it: Value| Some(it.get("error")?.to_string()));
            printed = refused.map_or(Ok(()), |error| Err(Failure::Failed(error)));
        } else {
            printed = writeln!(out, "{line}").and_then(|()| out.flush()).map_err(Failure::from);
            sounds.iter().for_each(|sounds| sounds.play(line));
        }
        // What is wrong here is told by whoever reads `printed`.
        if printed.is_ok() { Ok(()) } else { Err(io::ErrorKind::Other.into()) }
    });
    printed?;
    watched.map_err(|error| Failure::Failed(no_answer(path, &error)))
}

/// The bridge has a working folder of its own: a file is named by its whole path. A profile's name is the bridge's to
/// find, whatever lies here under that name.
fn absolute(name: &str) -> Result<String, Failure> {
    if name.contains('\n') {
        return Err(Failure::Unusable("a profile's name has one line".into()));
    }
    if profile::is_known(name) || !Path::new(name).is_file() {
        return Ok(name.to_owned());
    }
    let path = std::path::absolute(name)?;
    path.into_os_string()
        .into_string()
        .map_err(|name| Failure::Unusable(format!("{} is no text", name.display())))
}

fn print_status(status: &Value) -> io::Result<()> {
    let mut out = stdout();
    let text = |key: &str| status.get(key).and_then(Value::as_str).map_or("unknown".into(), printable);
    writeln!(out, "state    {}", text("state"))?;
    let serial = status.get("pad").and_then(Value::as_str);
    writeln!(out, "pad      {}", serial.map_or("tells no serial number".into(), printable))?;
    writeln!(out, "profile  {}: {}", text("profile"), text("profile_reason"))?;
    if status.get("preview").and_then(Value::as_bool) == Some(true) {
        writeln!(out, "         changed for a try in the dashboard; it is not kept")?;
    }
    if let Some(layer) = status.get("layer").and_then(Value::as_str) {
        writeln!(out, "layer    {}", printable(layer))?;
    }
    for line in status.get("profile_error").and_then(Value::as_str).into_iter().flat_map(str::lines) {
        writeln!(out, "         {}", printable(line))?;
    }
    writeln!(out, "decoder  {}", text("decoder"))?;
    writeln!(out, "output   {}", text("output"))?;
    let held = status.get("held_names").and_then(Value::as_array).into_iter().flatten();
    let held: Vec<_> = held.filter_map(Value::as_str).map(printable).collect();
    writeln!(out, "held     {}", held.join("   "))?;
    if let Some(warning) = warning(status) {
        writeln!(out, "warning  {warning}")?;
    }
    if let Some(sentence) = status.pointer("/line/sentence").and_then(Value::as_str) {
        writeln!(out, "line     {}", printable(sentence))?;
    }
    if let Some(sentence) = status.get("gain").and_then(Value::as_f64).and_then(gain_sentence) {
        writeln!(out, "gain     {sentence}")?;
    }
    if let Some(changes) = status.get("changes").and_then(|it| it.get("text")).and_then(Value::as_str) {
        writeln!(out, "changes  {}", printable(changes))?;
    }
    let presses =
        |key: &str| status.get("presses").and_then(|it| it.get(key)).and_then(Value::as_u64).unwrap_or(0);
    writeln!(out, "presses  {} accepted, {} rejected", presses("accepted"), presses("rejected"))?;
    for (name, count) in status.get("health").and_then(Value::as_object).into_iter().flatten() {
        if count.as_u64() != Some(0) {
            writeln!(out, "{name:<18} {count}")?;
        }
    }
    Ok(())
}

/// The warning of a status, in a few words.
pub(super) fn warning(status: &Value) -> Option<String> {
    let warning = status.get("warning")?;
    let text = |key: &str| warning.get(key).and_then(Value::as_str);
    Some(match (text("kind")?, text("channel")) {
        ("silent_channel", Some(channel)) => format!("channel {channel} does not answer to the load"),
        ("stray_channel", Some(channel)) => {
            format!("channel {channel} reads what no finger makes it read: it drifts, or its wires are loose")
        }
        ("other_pad", _) => "most touches do not fit the decoder: it may be another pad's".into(),
        ("second_finger", _) => "the last touch was not one finger, or a channel is off".into(),
        (kind, _) => kind.to_owned(),
    })
}
