//! For which programs a profile is.

/// A program, by what its windows and its process say of it. What is not named may be anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// A word of the window's class (`WM_CLASS`), in any case.
    pub class: Option<String>,
    /// The name of the executable, or its whole path.
    pub executable: Option<String>,
}

impl Program {
    /// Whether a window with these words for its class is this program's, whose process runs the executable with this path, if that is
    /// known.
    pub fn is(&self, classes: &[&str], executable: Option<&str>) -> bool {
        let has_class =
            |wanted: &String| classes.iter().any(|class| class.to_lowercase() == wanted.to_lowercase());
        let runs = |wanted: &String| {
            let name = executable.map(|path| path.rsplit('/').next().unwrap_or(path));
            if wanted.contains('/') { executable == Some(wanted) } else { name == Some(wanted) }
        };
        self.class.as_ref().is_none_or(has_class) && self.executable.as_ref().is_none_or(runs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(class: &str, executable: &str) -> Program {
        let named = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        Program { class: named(class), executable: named(executable) }
    }

    #[test]
    fn all_that_is_named_must_fit() {
        let tetris = (["quadra", "Quadrapassel"], Some("/usr/games/quadrapassel"));
        for (class, executable, fits) in [
            ("quadrapassel", "", true),
            ("QUADRA", "", true),
            ("quad", "", false),
            ("", "quadrapassel", true),
            ("", "/usr/games/quadrapassel", true),
            ("", "/opt/quadrapassel", false),
            ("", "Quadrapassel", false),
            ("Quadrapassel", "quadrapassel", true),
            ("Quadrapassel", "other", false),
            ("Other", "quadrapassel", false),
        ] {
            assert_eq!(program(class, executable).is(&tetris.0, tetris.1), fits, "{class:?} {executable:?}");
        }
        assert!(!program("", "x").is(&["x"], None), "an executable that is not known is none");
        assert!(program("x", "").is(&["x"], None));
    }
}
