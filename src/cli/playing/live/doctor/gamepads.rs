//! Gamepads beside ours, and what makes games and browsers pass ours over.

use std::fs;
use std::path::Path;

use super::check::Check;

/// Steam's own virtual gamepad, which it makes of each pad that Steam Input takes.
const OF_STEAM: &str = "Vendor=28de Product=11ff";

/// Xbox 360 pads that are there already, but for those of a running bridge, which has these nodes. One of version 1 is a trap: SDL's database turns its D-pad upside
/// down.
pub(super) fn check_other_gamepads(devices: &str, own_nodes: &[String]) -> Vec<Check> {
    let name = "other gamepads";
    let is_own = |device: &str| {
        let handlers = device.lines().find_map(|line| line.strip_prefix("H: Handlers="));
        handlers.is_some_and(|it| it.split_whitespace().any(|node| own_nodes.iter().any(|own| own == node)))
    };
    let others = devices.split("\n\n").filter(|device| !is_own(device));
    let lines = others.flat_map(str::lines).filter(|line| line.starts_with("I:"));
    let pads: Vec<_> = lines.filter(|line| line.contains("Vendor=045e Product=028e")).collect();
    let mut checks = Vec::new();
    if pads.iter().any(|line| line.contains("Version=0001")) {
        checks.push(Check::note(
            name,
            "an Xbox 360 pad of version 0001 is there: SDL turns its D-pad upside down. Ours has version 0114",
        ));
    }
    if !pads.is_empty() {
        checks.push(Check::note(
            name,
            "an Xbox 360 pad is there already: games may give it the first place, and browsers may merge two virtual \
             ones",
        ));
    }
    if devices.lines().any(|line| line.starts_with("I:") && line.contains(OF_STEAM)) {
        checks.push(Check {
            mend: Some("SDL_GAMECONTROLLER_IGNORE_DEVICES=0x28de/0x11ff %command%".into()),
            ..Check::note(
                name,
                "Steam Input has made a second gamepad of a first one, and a game that sees both plays for two; in Steam the game's \
                 properties, Controller, Disable Steam Input, or as its launch options:",
            )
        });
    }
    checks
}

/// Releases of Proton that may pass over a wired Xbox 360 pad, as ours is one, where Steam Input is switched off.
pub(super) fn check_proton(home: Option<&Path>) -> Option<Check> {
    let steam = [".local/share/Steam", ".steam/steam", ".var/app/com.valvesoftware.Steam/.local/share/Steam"];
    let folders = steam.iter().map(|folder| home.map(|home| home.join(folder).join("steamapps/common")));
    let entries = folders.flatten().flat_map(|folder| fs::read_dir(folder).into_iter().flatten().flatten());
    let mut names: Vec<_> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.retain(|name| name.strip_prefix("Proton ").is_some_and(passes_over));
    names.sort();
    let release = names.last()?;
    let message = format!(
        "{release} may pass over a wired Xbox 360 pad, as the virtual gamepad is one; where a game does not see it, as its launch options:"
    );
    Some(Check { mend: Some("PROTON_PREFER_SDL=1 %command%".into()), ..Check::note("Proton", message) })
}

/// Whether a release has this fault: it came with 10.
fn passes_over(release: &str) -> bool {
    let number = release.split('.').next().and_then(|number| number.parse::<u32>().ok());
    number.map_or_else(|| release.contains("Experimental"), |number| number >= 10)
}

pub(super) fn check_joydev(root: &Path) -> Check {
    let name = "browsers";
    if root.join("sys/module/joydev").exists() || root.join("dev/input/js0").exists() {
        Check::good(name, "the kernel's module joydev is loaded: Chromium reads gamepads through it")
    } else {
        let mend = Some("sudo modprobe joydev".into());
        Check {
            mend,
            ..Check::note(
                name,
                "the kernel's module joydev is not loaded, and Chromium reads gamepads through it",
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bridge::RunningBridge;
    use super::*;

    #[test]
    fn a_pad_with_the_trap_version_is_told_from_one_without() {
        let device =
            |version| format!("I: Bus=0003 Vendor=045e Product=028e Version={version}\nN: Name=\"X\"\n");
        assert_eq!(check_other_gamepads("", &[]).len(), 0);
        assert_eq!(check_other_gamepads(&device("0114"), &[]).len(), 1);
        assert_eq!(check_other_gamepads(&device("0001"), &[]).len(), 2);
    }

    #[test]
    fn our_own_pad_is_no_other_one() {
        let device = |node| {
            format!(
                "I: Bus=0003 Vendor=045e Product=028e Version=0114\nN: Name=\"Microsoft X-Box 360 pad\"\n\
                 S: Sysfs=/devices/virtual/input/input9\nH: Handlers={node} js0 \n\n"
            )
        };
        let own = RunningBridge::of(
            r#"{"output":"virtual gamepad at /dev/input/event7, virtual pointer at /dev/input/event8"}"#,
        )
        .nodes();
        assert_eq!(own, ["event7", "event8"]);
        assert_eq!(check_other_gamepads(&device("event7"), &own).len(), 0);
        assert_eq!(check_other_gamepads(&device("event70"), &own).len(), 1);
        assert_eq!(check_other_gamepads(&(device("event7") + &device("event3")), &own).len(), 1);
    }

    #[test]
    fn the_second_gamepad_of_steam_is_told_of() {
        let steam =
            "I: Bus=0003 Vendor=28de Product=11ff Version=0001\nN: Name=\"Microsoft X-Box 360 pad 0\"\n";
        let checks = check_other_gamepads(steam, &[]);
        assert_eq!(checks.len(), 1, "{checks:?}");
        assert!(checks[0].mend.as_deref().unwrap().ends_with("0x28de/0x11ff %command%"));
    }

    #[test]
    fn proton_that_passes_over_our_pad_is_named_where_it_is_installed() {
        let home = tempfile::tempdir().unwrap();
        let told = || check_proton(Some(home.path())).map(|check| check.message);
        let install = |name: &str| {
            fs::create_dir_all(home.path().join(".local/share/Steam/steamapps/common").join(name)).unwrap();
        };
        install("Proton 9.0 (Beta)");
        install("SuperTux");
        assert_eq!(told(), None);
        install("Proton 10.0");
        assert!(told().unwrap().starts_with("Proton 10.0 may pass over"));
        install("Proton - Experimental");
        assert!(told().unwrap().contains("virtual gamepad"));
        assert_eq!(check_proton(None), None);
    }
}
