//! Environment variables that make SDL, and games by it, pass over or change our gamepad.

use std::fs;
use std::path::Path;

use super::check::Check;

/// The virtual gamepad's USB numbers in SDL's list of devices, and in its identifiers of mappings.
const LISTED: &str = "0x045e/0x028e";
const MAPPED: &str = "5e0400008e020000";

/// The variables that are looked at.
const NAMES: [&str; 4] = [
    "SDL_GAMECONTROLLERCONFIG",
    "SDL_GAMECONTROLLER_IGNORE_DEVICES",
    "SDL_GAMECONTROLLER_IGNORE_DEVICES_EXCEPT",
    "SDL_JOYSTICK_BLACKLIST_DEVICES",
];

/// The value of a variable, where it is set, and the command that takes it back.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct SetVariable {
    name: &'static str,
    value: String,
    place: String,
    mend: String,
}

/// Where these variables are set: in this environment, in what sessions begin with, and for games that run.
pub(super) fn places(
    root: &Path,
    home: Option<&Path>,
    variable: impl Fn(&str) -> Option<String>,
) -> Vec<SetVariable> {
    let mut set: Vec<SetVariable> = NAMES
        .into_iter()
        .filter_map(|name| {
            let (place, mend) = ("this environment".to_owned(), format!("unset {name}"));
            Some(SetVariable { name, value: variable(name)?, place, mend })
        })
        .collect();
    set.extend(of_sessions(root, home));
    set.extend(of_processes(root));
    set
}

/// What is set in the files that sessions begin with.
fn of_sessions(root: &Path, home: Option<&Path>) -> Vec<SetVariable> {
    let in_folder = |folder: &Path| {
        let mut files: Vec<_> =
            fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
        files.sort();
        files
    };
    let mut files = vec![root.join("etc/environment")];
    files.extend(in_folder(&root.join("etc/environment.d")));
    files.extend(home.into_iter().flat_map(|home| in_folder(&home.join(".config/environment.d"))));
    let mut set = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap_or_default();
        let sudo = if home.is_some_and(|home| file.starts_with(home)) { "" } else { "sudo " };
        for name in NAMES {
            let of_line = |line: &str| {
                let line = line.trim().trim_start_matches("export ");
                let value = line.strip_prefix(name)?.strip_prefix('=')?;
                Some(value.trim_matches(['"', '\'']).to_owned())
            };
            set.extend(text.lines().filter_map(of_line).map(|value| SetVariable {
                name,
                value,
                place: file.display().to_string(),
                mend: format!("{sudo}sed -i '/{name}=/d' {}   (and log in anew)", file.display()),
            }));
        }
    }
    set
}

/// What is set for programs that run; those of other users are not told.
fn of_processes(root: &Path) -> Vec<SetVariable> {
    let processes = fs::read_dir(root.join("proc")).into_iter().flatten().flatten();
    let mut set = Vec::new();
    for process in processes {
        let Ok(environment) = fs::read(process.path().join("environ")) else { continue };
        let program = fs::read_to_string(process.path().join("comm")).unwrap_or_default();
        let program = program.trim_end();
        for entry in environment.split(|byte| *byte == 0).map(String::from_utf8_lossy) {
            let Some((name, value)) =
                NAMES.iter().find_map(|name| Some((*name, entry.strip_prefix(name)?.strip_prefix('=')?)))
            else {
                continue;
            };
            set.push(SetVariable {
                name,
                value: value.to_owned(),
                place: format!("the environment of {program}"),
                mend: format!(
                    "env -u {name} {program}   (in Steam: its properties, Controller, Disable Steam Input)"
                ),
            });
        }
    }
    set.sort_by(|one, other| (&one.place, one.name).cmp(&(&other.place, other.name)));
    set.dedup();
    set
}

/// What is said of those that hide or change our gamepad; each once, where the first place is.
pub(super) fn check_variables(set: &[SetVariable]) -> Vec<Check> {
    let mut told: Vec<(&str, &str)> = Vec::new();
    let mut checks = Vec::new();
    for SetVariable { name, value, place, mend } in set {
        let Some(does) = effect(name, value) else { continue };
        // A variable of a session is one of each of its programs, too.
        if told.contains(&(name, value)) {
            continue;
        }
        told.push((name, value));
        checks.push(Check::bad("SDL", format!("{name} in {place} {does}"), mend.clone()));
    }
    checks
}

/// What a value does to our gamepad; `None` where that is nothing.
fn effect(name: &str, value: &str) -> Option<&'static str> {
    let value = value.to_lowercase();
    match name {
        "SDL_GAMECONTROLLERCONFIG" => {
            value.contains(MAPPED).then_some("maps Xbox 360 pads anew; ours needs no mapping")
        }
        "SDL_GAMECONTROLLER_IGNORE_DEVICES_EXCEPT" => (!value.is_empty() && !value.contains(LISTED))
            .then_some("hides all gamepads but those that it names, and so ours"),
        _ => value.contains(LISTED).then_some("hides Xbox 360 pads, and so ours"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(root: &Path, home: Option<&Path>, variable: impl Fn(&str) -> Option<String>) -> Vec<Check> {
        check_variables(&places(root, home, variable))
    }

    #[test]
    fn an_environment_that_hides_our_pad_is_found() {
        let nowhere = Path::new("/nowhere");
        let with = |set: &'static str, value: &'static str| {
            told(nowhere, None, move |name| (name == set).then(|| value.to_owned())).len()
        };
        assert_eq!(with("SDL_GAMECONTROLLERCONFIG", "030000005e0400008e02000014010000,X,a:b1"), 1);
        assert_eq!(with("SDL_GAMECONTROLLERCONFIG", "030000004c050000cc09000000000000,Y,a:b1"), 0);
        assert_eq!(with("SDL_GAMECONTROLLER_IGNORE_DEVICES", "0x045E/0x028E"), 1);
        assert_eq!(with("SDL_GAMECONTROLLER_IGNORE_DEVICES_EXCEPT", "0x054C/0x09CC"), 1);
        assert_eq!(with("SDL_GAMECONTROLLER_IGNORE_DEVICES_EXCEPT", "0x045E/0x028E"), 0);
        assert_eq!(with("SDL_GAMECONTROLLER_IGNORE_DEVICES_EXCEPT", ""), 0);
    }

    #[test]
    fn files_of_sessions_and_running_games_are_read_and_each_is_told_once() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let set = "SDL_JOYSTICK_BLACKLIST_DEVICES=0x045e/0x028e";
        write("proc/7/comm", "supertux2\n");
        write("proc/7/environ", &format!("HOME=/h\0{set}\0"));
        write("proc/8/comm", "shell\n");
        write("proc/8/environ", "HOME=/h\0SDL_JOYSTICK_BLACKLIST_DEVICES=0x1234/0x5678\0");
        let home = root.path().join("home");
        let checks = told(root.path(), Some(&home), |_| None);
        assert_eq!(checks.len(), 1, "{checks:?}");
        assert!(checks[0].message.contains("in the environment of supertux2 hides"), "{checks:?}");
        write("etc/environment", &format!("PATH=/bin\n{set}\n"));
        write(
            "home/.config/environment.d/games.conf",
            "SDL_GAMECONTROLLER_IGNORE_DEVICES=\"0x045e/0x028e\"\n",
        );
        let checks = told(root.path(), Some(&home), |_| None);
        let places: Vec<_> = checks.iter().map(|check| check.mend.clone().unwrap()).collect();
        assert_eq!(places.len(), 2, "{places:?}");
        assert!(places[0].starts_with("sudo sed -i '/SDL_JOYSTICK_BLACKLIST_DEVICES=/d' "), "{places:?}");
        assert!(places[1].starts_with("sed -i ") && places[1].contains("games.conf"), "{places:?}");
    }
}
