//! Units in which the columns of a table are written.

use std::fmt;
use std::str::FromStr;

/// Units that people write, each with its name.
pub type UnitTable = &'static [(&'static str, f64)];

/// Names of places' units, mm.
pub const PLACE_UNITS: UnitTable =
    &[("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("um", 1e-3), ("in", 25.4), ("mil", 0.0254)];
/// Names of forces' units, N.
pub const FORCE_UNITS: UnitTable = &[
    ("N", 1.0),
    ("mN", 1e-3),
    ("kN", 1e3),
    ("kgf", 9.806_65),
    ("kg", 9.806_65),
    ("gf", 9.806_65e-3),
    ("g", 9.806_65e-3),
    ("lbf", 4.448_222),
    ("lb", 4.448_222),
    ("ozf", 0.278_013_9),
    ("oz", 0.278_013_9),
];
/// Names of channels' units, µV.
pub const CHANNEL_UNITS: UnitTable = &[("uV", 1.0), ("nV", 1e-3), ("mV", 1e3), ("V", 1e6)];

/// Sizes of the units of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Of places.
    pub mm: f64,
    /// Of forces.
    pub n: f64,
    /// Of channels.
    pub uv: f64,
}

impl Default for Units {
    fn default() -> Self {
        Self { mm: 1.0, n: 1.0, uv: 1.0 }
    }
}

/// The unit's size: by its name, or a number.
fn size(text: &str, names: UnitTable) -> Option<f64> {
    let text = text.trim();
    let by_name = names.iter().find(|(name, _)| *name == text).map(|(_, size)| *size);
    by_name.or_else(|| text.parse().ok().filter(|size: &f64| size.is_finite() && *size > 0.0))
}

fn unit_name(size: f64, names: UnitTable) -> String {
    let by_size = names.iter().find(|(_, known)| *known == size);
    by_size.map_or_else(|| format!("{size}"), |(name, _)| (*name).to_owned())
}

impl FromStr for Units {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(',').collect();
        let parsed = || {
            let [mm, n, uv] = match *parts.as_slice() {
                [mm, n] => [mm, n, "uV"],
                [mm, n, uv] => [mm, n, uv],
                _ => return None,
            };
            Some(Self { mm: size(mm, PLACE_UNITS)?, n: size(n, FORCE_UNITS)?, uv: size(uv, CHANNEL_UNITS)? })
        };
        let names = |names: UnitTable| names.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        parsed().ok_or_else(|| {
            format!(
                "write the units of places, forces and channels, as \"in,lbf,mV\"; places: {}; forces: {}; channels: {}; a number is a unit of \
                 so many mm, N or uV",
                names(PLACE_UNITS),
                names(FORCE_UNITS),
                names(CHANNEL_UNITS)
            )
        })
    }
}

impl fmt::Display for Units {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [mm, n] = [unit_name(self.mm, PLACE_UNITS), unit_name(self.n, FORCE_UNITS)];
        write!(f, "{mm},{n},{}", unit_name(self.uv, CHANNEL_UNITS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_names_or_numbers() {
        let units: Units = "cm,kgf".parse().unwrap();
        assert_eq!(units, Units { mm: 10.0, n: 9.806_65, uv: 1.0 });
        assert_eq!("2.5,N,V".parse::<Units>().unwrap().to_string(), "2.5,N,V");
        for text in ["mm", "mm,mm", "mm,N,uV,s", "0,N", "-1,N", "nan,N"] {
            assert!(text.parse::<Units>().is_err(), "{text}");
        }
    }
}
