//! What the desktop's session allows: keys without virtual devices, and profiles that follow the program in front.

use super::check::Check;
use crate::cli::playing::live::output::window_of_keys;

/// Whether profiles can follow the program in front, where there is a desktop; `open` asks it.
pub(super) fn check_foreground(
    variable: impl Fn(&str) -> Option<String>,
    open: impl FnOnce() -> Result<(), String>,
) -> Option<Check> {
    let name = "profiles by program";
    variable("WAYLAND_DISPLAY").or_else(|| variable("DISPLAY"))?;
    Some(match open() {
        Ok(()) => Check::good(
            name,
            "the desktop tells which program is in front: `tactpad run --profile auto` follows it",
        ),
        Err(why) => Check {
            mend: Some("tactpad ctl profile NAME".into()),
            ..Check::note(name, format!("{why}; by hand:"))
        },
    })
}

/// Keys of the X server, where there is one.
pub(super) fn check_keys(variable: impl Fn(&str) -> Option<String>) -> Option<Check> {
    let window = window_of_keys(variable)?;
    let message = format!("keys of the X server reach {window}");
    Some(Check {
        mend: Some("tactpad run --output x11".into()),
        ..Check::note("keys without uinput", message)
    })
}

#[cfg(test)]
mod tests {
    use super::super::check::Finding;
    use super::*;

    #[test]
    fn what_the_desktop_tells_of_the_program_in_front_is_said_where_there_is_one() {
        let on = |name: &'static str| move |asked: &str| (asked == name).then(|| "0".to_owned());
        let found = |name, told: Result<(), &str>| {
            check_foreground(on(name), || told.map_err(str::to_owned))
                .map(|check| (check.finding, check.mend.is_some()))
        };
        assert_eq!(found("HOME", Err("no")), None);
        assert_eq!(found("WAYLAND_DISPLAY", Ok(())), Some((Finding::Good, false)));
        assert_eq!(found("DISPLAY", Err("no")), Some((Finding::Note, true)));
    }
}
