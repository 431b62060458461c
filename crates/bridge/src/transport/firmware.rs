//! The version of a pad's firmware, as its product's name on the USB tells it: `tactpad pad 0.1.0 (restarted: stood still)`.

use std::fmt;

/// What the product's name of our firmware begins with. Some systems write blanks as underscores.
const PRODUCT: &str = "tactpad pad ";

/// The oldest firmware of ours that speaks the wire as this program knows it: `firmware-proto/README.md`, all kinds and status bits. It
/// goes up with whatever is added there that a firmware has to send.
pub const OLDEST: [u16; 3] = [0, 1, 0];

/// A firmware of ours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Firmware {
    /// Major, minor, patch.
    pub version: [u16; 3],
    /// Why it restarted last, if it did by itself.
    pub restarted: Option<String>,
}

impl Firmware {
    /// By the product's name; `None` for another one.
    pub fn of(product: &str) -> Option<Self> {
        let product = product.replace('_', " ");
        let text = product.strip_prefix(PRODUCT)?;
        let (version, rest) = text.split_once(' ').unwrap_or((text, ""));
        let mut numbers = version.split('.').map(|number| number.parse().ok());
        let mut next = || numbers.next().flatten();
        let version = [next()?, next()?, next()?];
        let why = rest.trim().strip_prefix('(').and_then(|it| it.strip_suffix(')'));
        Some(Self { version, restarted: why.map(str::to_owned) })
    }

    /// Whether it lacks something of the wire as this program knows it.
    pub fn is_old(&self) -> bool {
        self.version < OLDEST
    }
}

impl fmt::Display for Firmware {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&dotted(self.version))?;
        self.restarted.as_ref().map_or(Ok(()), |why| write!(f, " ({why})"))
    }
}

/// A version as people write it.
pub fn dotted([major, minor, patch]: [u16; 3]) -> String {
    format!("{major}.{minor}.{patch}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_read_of_the_products_name() {
        let read = |product: &str| Firmware::of(product).map(|it| it.to_string());
        assert_eq!(read("tactpad pad 0.1.0").as_deref(), Some("0.1.0"));
        let restarted = "tactpad pad 1.20.3 (restarted: stood still)";
        assert_eq!(read(restarted).as_deref(), Some("1.20.3 (restarted: stood still)"));
        assert_eq!(Firmware::of(&restarted.replace(' ', "_")), Firmware::of(restarted));
        for other in
            ["", "Pico", "tactpad pad", "tactpad pad 0.1", "tactpad pad x.1.0", "my tactpad pad 0.1.0"]
        {
            assert_eq!(read(other), None, "{other}");
        }
        let of = |version| Firmware { version, restarted: None };
        assert!(of([0, 0, 9]).is_old() && !of(OLDEST).is_old() && !of([1, 0, 0]).is_old());
    }

    #[test]
    fn the_firmware_of_this_repository_is_not_old() {
        let workspace = include_str!("../../../../firmware-proto/pico/Cargo.toml");
        let version = workspace.lines().find_map(|line| line.strip_prefix("version = \"")?.strip_suffix('"'));
        let firmware = Firmware::of(&format!("{PRODUCT}{}", version.unwrap())).unwrap();
        assert!(!firmware.is_old(), "{firmware}");
    }
}
