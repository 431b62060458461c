//! `tactpad profile new` and `tactpad profile edit`: a profile of one's own.

use std::env;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::Command;

use super::history::{edits, saves};
use super::{chosen, own, verdict};
use crate::cli::failure::Failure;
use crate::cli::printing::written::{reason, say, stdout};
use tactpad::pipeline::mapping::read::shipped;

/// A profile that says all defaults; its lines `#key = …` are what is not written.
const TEMPLATE: &str = include_str!("template.toml");

/// The line of the template with its profile's name.
const TEMPLATE_NAME: &str = "name = \"My game\"";

/// Prints a new profile, or writes it into the user's own folder.
pub(super) fn new(name: &str, is_saved: bool) -> Result<(), Failure> {
    own::check_name(name)?;
    let text = TEMPLATE.replacen(TEMPLATE_NAME, &format!("name = \"{name}\""), 1);
    if !is_saved {
        return Ok(stdout().write_all(text.as_bytes())?);
    }
    let path = edits::create(name, &text)?;
    if shipped::text(name).is_some() {
        say(format_args!("it stands before the {name} inside the program"));
    }
    Ok(writeln!(stdout(), "{}", path.display())?)
}

/// Makes a copy of a profile inside the program, if the user has none of its own under this name, prints its path,
/// and opens it where people look.
pub(super) fn edit(name: &str) -> Result<(), Failure> {
    let path = match (own::file(name), shipped::text(name)) {
        (Some(path), _) => path,
        (None, Some(text)) => {
            let path = edits::create(name, text)?;
            say(format_args!("this copy stands before the {name} inside the program"));
            path
        }
        (None, None) if !own::is_name(name) => {
            return Err(Failure::Unusable(format!(
                "{name} is a file: open it in an editor, or name one of {}",
                chosen::known().join(", ")
            )));
        }
        (None, None) => {
            return Err(Failure::Unusable(format!(
                "there is no profile {name:?}: choose one of {}, or begin it with `tactpad profile new --save {name:?}`",
                chosen::known().join(", ")
            )));
        }
    };
    writeln!(stdout(), "{}", path.display())?;
    saves::record_present(name)?;
    if io::stdin().is_terminal() && io::stdout().is_terminal() && opened(&path)? {
        saves::record_present(name)?;
        return verdict::run(name, false);
    }
    Ok(())
}

/// Opens a file in the user's editor and waits for its end; `false` where the user names no editor.
fn opened(path: &Path) -> Result<bool, Failure> {
    let named = ["VISUAL", "EDITOR"].into_iter().filter_map(env::var_os);
    let Some(editor) = named.filter_map(|editor| editor.into_string().ok()).find(|it| !it.trim().is_empty())
    else {
        return Ok(false);
    };
    // It may bring options of its own, as `code --wait`.
    let mut words = editor.split_whitespace();
    let mut command = Command::new(words.next().unwrap_or_default());
    let status = command.args(words).arg(path).status().map_err(|error| {
        Failure::Failed(format!(
            "the editor {editor:?} cannot be started: {}; set VISUAL or EDITOR to another one",
            reason(&error)
        ))
    })?;
    if status.success() { Ok(true) } else { Err(Failure::Failed(format!("{editor} ended with {status}"))) }
}

#[cfg(test)]
mod tests {
    use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad::pipeline::mapping::read::shipped::SCHEMA_LINE;

    use super::*;

    #[test]
    fn the_template_is_a_profile_and_what_it_leaves_out_are_the_defaults() {
        assert!(TEMPLATE.contains(TEMPLATE_NAME) && TEMPLATE.starts_with(SCHEMA_LINE));
        let (profile, found) = read(TEMPLATE, OutputChoice::AsWritten);
        assert_eq!((profile.is_some(), found), (true, vec![]));
        let out = |line: &str| match line.strip_prefix('#') {
            Some(key) if key.starts_with(|letter: char| letter.is_ascii_lowercase()) => key.to_owned(),
            _ => line.to_owned(),
        };
        let lines: Vec<_> = TEMPLATE.lines().map(out).collect();
        let left_out = lines.iter().zip(TEMPLATE.lines()).filter(|(line, was)| line != was).count();
        assert!(left_out >= 10, "{left_out}");
        let (whole, found) = read(&lines.join("\n"), OutputChoice::AsWritten);
        assert_eq!((whole, found), (profile, vec![]));
    }

    #[test]
    fn what_the_template_shows_as_possible_is_and_no_key_is_left_out() {
        let could_be: String =
            TEMPLATE.lines().map(|line| line.strip_prefix("#  ").unwrap_or(line).to_owned() + "\n").collect();
        let (profile, found) = read(&could_be, OutputChoice::AsWritten);
        assert_eq!((profile.map(|it| it.buttons.len()), found), (Some(8), vec![]));
        let schema: serde_json::Value = serde_json::from_str(shipped::schema()).unwrap();
        let tables = [
            "program", "access", "gain", "zone", "dpad", "button", "layer", "macro", "step", "stick",
            "trigger", "pointer",
        ];
        for table in tables {
            for key in schema["$defs"][table]["properties"].as_object().unwrap().keys() {
                // Names of devices stand in the bindings.
                let is_shown = TEMPLATE.contains(&format!("{key} ="));
                assert!(is_shown || (table, &**key) == ("dpad", "gamepad"), "{table}: {key}");
            }
        }
    }
}
