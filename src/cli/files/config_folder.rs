//! Folders of the user's own files: `$XDG_CONFIG_HOME/tactpad/NAME`, else `~/.config/tactpad/NAME`.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;

/// The folder of this name, which need not be there; `None` where the user has no home.
pub(crate) fn folder(name: &str) -> Option<PathBuf> {
    folder_in(env::var_os("XDG_CONFIG_HOME"), env::var_os("HOME")).map(|folder| folder.join(name))
}

fn folder_in(config: Option<OsString>, home: Option<OsString>) -> Option<PathBuf> {
    // A relative path would be another folder for each bridge and each shell.
    let whole = |path: Option<OsString>| path.map(PathBuf::from).filter(|path| path.is_absolute());
    let config = whole(config).or_else(|| Some(whole(home)?.join(".config")))?;
    Some(config.join("tactpad"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_is_where_the_desktop_keeps_settings() {
        let folder = |config: &str, home: &str| {
            let given = |text: &str| (!text.is_empty()).then(|| OsString::from(text));
            folder_in(given(config), given(home)).map(|path| path.display().to_string())
        };
        assert_eq!(folder("/c", "/home/me").as_deref(), Some("/c/tactpad"));
        for config in ["", "relative"] {
            assert_eq!(folder(config, "/home/me").as_deref(), Some("/home/me/.config/tactpad"));
            assert_eq!([folder(config, ""), folder(config, "here")], [None, None]);
        }
    }
}
