//! Games in Flatpak's sandboxes that see no gamepad.

use std::fs;
use std::path::{Path, PathBuf};

use super::check::Check;

/// Games below the installations of the system and of this user that may open no input device.
pub(super) fn check(root: &Path, home: Option<&Path>) -> Vec<Check> {
    let own = home.map(|home| home.join(".local/share/flatpak"));
    let installations: Vec<PathBuf> = [root.join("var/lib/flatpak")].into_iter().chain(own).collect();
    let mut games: Vec<String> = installations
        .iter()
        .flat_map(|installation| games_without_input(installation, &installations))
        .collect();
    games.sort();
    games.dedup();
    let check = |game: String| {
        let mend = format!(
            "flatpak override --user --device=input {game} || flatpak override --user --device=all {game}"
        );
        let message = format!("the game {game} may open no gamepad; this lets it, from its next start on");
        Check { mend: Some(mend), ..Check::note("Flatpak", message) }
    };
    games.into_iter().map(check).collect()
}

/// The names of an installation's games that see no gamepad, whichever installation says so.
fn games_without_input(installation: &Path, installations: &[PathBuf]) -> Vec<String> {
    let apps = fs::read_dir(installation.join("app")).into_iter().flatten().flatten();
    let sees_none = |app: &String| {
        let active = installation.join("app").join(app).join("current/active");
        let given = [active.join("metadata")].into_iter();
        // What is overridden later stands before.
        let overrides =
            installations.iter().flat_map(|it| [it.join("overrides/global"), it.join("overrides").join(app)]);
        is_game(&active, app) && !given.chain(overrides).fold(false, |sees, file| devices(&read(&file), sees))
    };
    apps.filter_map(|entry| entry.file_name().into_string().ok()).filter(sees_none).collect()
}

fn read(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_default()
}

/// Whether its entry in the desktop's menu is one of a game.
fn is_game(active: &Path, app: &str) -> bool {
    let entry = read(&active.join(format!("files/share/applications/{app}.desktop")));
    let categories = entry.lines().find_map(|line| line.strip_prefix("Categories="));
    categories.is_some_and(|list| list.split(';').any(|category| category == "Game"))
}

/// Whether a sandbox has input devices, after one that had them or had not.
fn devices(text: &str, before: bool) -> bool {
    let context = text.split("[Context]").nth(1).unwrap_or_default();
    let context = context.split("\n[").next().unwrap_or_default();
    let list = context.lines().find_map(|line| line.strip_prefix("devices=")).unwrap_or_default();
    let has = |name: &str| list.split(';').any(|device| device == name);
    if ["input", "all"].into_iter().any(has) {
        true
    } else {
        before && !["!input", "!all"].into_iter().any(has)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn games_that_see_no_gamepad_are_named_with_what_lets_them() {
        let root = tempfile::tempdir().unwrap();
        let home = root.path().join("home");
        let write = |path: String, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let install = |installation: &str, app: &str, categories: &str, devices: &str| {
            let active = format!("{installation}/app/{app}/current/active");
            write(
                format!("{active}/metadata"),
                &format!("[Application]\nname={app}\n\n[Context]\ndevices={devices}\n\n[Other]\n"),
            );
            write(
                format!("{active}/files/share/applications/{app}.desktop"),
                &format!("[Desktop Entry]\nCategories={categories}\n"),
            );
        };
        let system = "var/lib/flatpak";
        install(system, "org.a.Blind", "Game;ArcadeGame;", "dri;");
        install(system, "org.b.Sees", "Game;", "dri;input;");
        install(system, "org.c.All", "Game;", "all;");
        install(system, "org.d.Editor", "Graphics;", "dri;");
        install("home/.local/share/flatpak", "org.e.Own", "Game;", "");
        let named = || {
            let checks = check(root.path(), Some(&home));
            checks
                .into_iter()
                .map(|check| check.mend.unwrap().rsplit(' ').next().unwrap().to_owned())
                .collect::<Vec<_>>()
        };
        assert_eq!(named(), ["org.a.Blind", "org.e.Own"]);
        write("home/.local/share/flatpak/overrides/org.a.Blind".into(), "[Context]\ndevices=input;\n");
        write("home/.local/share/flatpak/overrides/org.c.All".into(), "[Context]\ndevices=!all;\n");
        assert_eq!(named(), ["org.c.All", "org.e.Own"]);
        assert_eq!(check(Path::new("/nowhere"), None), []);
    }
}
