//! Where a pad is, as people write it.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use firmware_proto::DEFAULT_BAUD;
use tactpad_core::source::shipped;

/// Where a pad is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PadAddress {
    /// The only pad attached, or the one with this serial number.
    Auto {
        /// The serial number, where one is asked for.
        serial_number: Option<String>,
    },
    /// A pad made of software.
    Virtual,
    /// A pad on a serial port.
    Serial {
        /// The port's path.
        path: String,
        /// Bits per second, not 0.
        baud: u32,
    },
    /// A pad that is a HID device.
    Hid {
        /// USB vendor number.
        vendor: u16,
        /// USB product number.
        product: u16,
        /// The serial number, where one is asked for.
        serial_number: Option<String>,
    },
    /// What is plugged in at a place: a pad, or a serial port.
    Usb {
        /// The kernel's name of the USB port, such as `1-1.2`, or of an interface there, such as `1-1.2:1.0`.
        place: String,
        /// Bits per second of a serial port, not 0.
        baud: u32,
    },
    /// A pad that a description tells of.
    Described {
        /// The description's name.
        name: String,
        /// Where it is: the path of a serial port or an input device; without it the only one that fits.
        path: Option<String>,
        /// Bits per second, not 0; without it those of the description.
        baud: Option<u32>,
    },
    /// A recording in place of a pad.
    Capture {
        /// The recording's file.
        file: PathBuf,
    },
}

/// Why a text names no pad.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AddressError {
    /// It begins with none of the known words.
    UnknownKind {
        /// The whole text.
        text: String,
    },
    /// The part that must follow the word is missing.
    Incomplete {
        /// The word before the colon.
        kind: &'static str,
        /// The part that is missing.
        wanted: &'static str,
    },
    /// The text after `@` is no rate.
    BadBaud {
        /// The word before the colon.
        kind: &'static str,
        /// The text before `@`.
        path: String,
        /// The text behind it.
        baud: String,
    },
    /// A USB number is not four hexadecimal digits.
    BadUsbNumber {
        /// The text in its place.
        number: String,
    },
}

impl FromStr for PadAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let (kind, rest) = text.split_once(':').map_or((text, None), |(kind, rest)| (kind, Some(rest)));
        match (kind, rest) {
            ("auto", None) => Ok(Self::Auto { serial_number: None }),
            ("auto", Some(rest)) => {
                Ok(Self::Auto { serial_number: Some(wanted("auto", "a serial number", rest)?.into()) })
            }
            ("virtual", None) => Ok(Self::Virtual),
            ("serial", rest) => {
                let (path, baud) =
                    with_baud("serial", wanted("serial", PORT_WANTED, rest.unwrap_or(""))?, PORT_WANTED)?;
                Ok(Self::Serial { path, baud })
            }
            ("usb", rest) => {
                let (place, baud) =
                    with_baud("usb", wanted("usb", PLACE_WANTED, rest.unwrap_or(""))?, PLACE_WANTED)?;
                Ok(Self::Usb { place, baud })
            }
            ("hid", rest) => {
                hid(wanted("hid", "vendor and product, as in hid:1209:0001", rest.unwrap_or(""))?)
            }
            ("capture", rest) => {
                let file = wanted("capture", "the recording's file", rest.unwrap_or(""))?.into();
                Ok(Self::Capture { file })
            }
            (name, Some(rest)) if is_name(name) && !rest.is_empty() => described(name, rest),
            (name, None) if shipped::text(name).is_some() => {
                Ok(Self::Described { name: name.into(), path: None, baud: None })
            }
            _ => Err(AddressError::UnknownKind { text: text.into() }),
        }
    }
}

const PORT_WANTED: &str = "the port's path, as in serial:/dev/ttyACM0";
const PLACE_WANTED: &str = "the USB port, as in usb:1-1.2; `tactpad devices` lists them";

fn wanted<'a>(kind: &'static str, wanted: &'static str, rest: &'a str) -> Result<&'a str, AddressError> {
    if rest.is_empty() { Err(AddressError::Incomplete { kind, wanted }) } else { Ok(rest) }
}

/// Whether a word may be a description's name.
fn is_name(word: &str) -> bool {
    let is_plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-';
    word.starts_with(|letter: char| letter.is_ascii_lowercase())
        && word.chars().all(is_plain)
        && word != "virtual"
}

fn described(name: &str, rest: &str) -> Result<PadAddress, AddressError> {
    const WANTED: &str = "the port's path, as in load-cells:/dev/ttyUSB0";
    let (path, baud) = with_rate("load-cells", rest, WANTED)?;
    Ok(PadAddress::Described { name: name.into(), path: Some(path), baud })
}

/// A path or place, and the rate that follows the last `@` of its last part.
fn with_baud(kind: &'static str, rest: &str, what: &'static str) -> Result<(String, u32), AddressError> {
    let (path, baud) = with_rate(kind, rest, what)?;
    Ok((path, baud.unwrap_or(DEFAULT_BAUD)))
}

/// The same; no rate where none is written.
fn with_rate(
    kind: &'static str,
    rest: &str,
    what: &'static str,
) -> Result<(String, Option<u32>), AddressError> {
    let Some((path, baud)) = rest.rsplit_once('@').filter(|(_, baud)| !baud.contains('/')) else {
        return Ok((rest.into(), None));
    };
    let path = wanted(kind, what, path)?;
    // Digits only: `parse` would also take a sign.
    let digits = baud.bytes().all(|byte| byte.is_ascii_digit());
    match baud.parse() {
        Ok(number) if digits && number != 0 => Ok((path.into(), Some(number))),
        _ => Err(AddressError::BadBaud { kind, path: path.into(), baud: baud.into() }),
    }
}

fn hid(rest: &str) -> Result<PadAddress, AddressError> {
    let mut parts = rest.splitn(3, ':');
    let mut number = || usb_number(parts.next().unwrap_or(""));
    let (vendor, product) = (number()?, number()?);
    let serial_number = parts.next().map(|text| wanted("hid", "a serial number after the last colon", text));
    Ok(PadAddress::Hid { vendor, product, serial_number: serial_number.transpose()?.map(Into::into) })
}

fn usb_number(text: &str) -> Result<u16, AddressError> {
    let four_digits = text.len() == 4 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    let number = u16::from_str_radix(text, 16).ok().filter(|_| four_digits);
    number.ok_or_else(|| AddressError::BadUsbNumber { number: text.into() })
}

impl fmt::Display for PadAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto { serial_number: None } => f.write_str("auto"),
            Self::Auto { serial_number: Some(number) } => write!(f, "auto:{number}"),
            Self::Virtual => f.write_str("virtual"),
            Self::Serial { path, baud } => write!(f, "serial:{path}@{baud}"),
            Self::Usb { place, baud } => write!(f, "usb:{place}@{baud}"),
            Self::Hid { vendor, product, serial_number: None } => write!(f, "hid:{vendor:04x}:{product:04x}"),
            Self::Hid { vendor, product, serial_number: Some(number) } => {
                write!(f, "hid:{vendor:04x}:{product:04x}:{number}")
            }
            Self::Described { name, path: None, .. } => f.write_str(name),
            Self::Described { name, path: Some(path), baud: None } => write!(f, "{name}:{path}"),
            Self::Described { name, path: Some(path), baud: Some(baud) } => write!(f, "{name}:{path}@{baud}"),
            Self::Capture { file } => write!(f, "capture:{}", file.display()),
        }
    }
}

impl fmt::Display for AddressError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownKind { text } => write!(
                f,
                "`{text}` names no pad: write auto[:SERIAL], virtual, serial:PATH[@BAUD], \
                 hid:VID:PID[:SERIAL], usb:PORT[@BAUD], load-cells:PATH[@BAUD], capture:FILE, or a name from `tactpad source list`"
            ),
            Self::Incomplete { kind, wanted } => write!(f, "`{kind}:` lacks {wanted}"),
            Self::BadBaud { kind, path, baud } => write!(
                f,
                "`{baud}` is not a rate in bits per second: write a positive whole number, as in \
                 {kind}:{path}@{DEFAULT_BAUD}, also where the path itself contains `@`"
            ),
            Self::BadUsbNumber { number } => write!(
                f,
                "`{number}` is not a USB number: write vendor and product with four hexadecimal digits each, \
                 as in hid:1209:0001"
            ),
        }
    }
}

impl std::error::Error for AddressError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<PadAddress, AddressError> {
        text.parse()
    }

    #[test]
    fn every_form_is_understood_and_written_back() {
        let default = format!("serial:/dev/ttyACM0@{DEFAULT_BAUD}");
        for (text, written) in [
            ("auto", "auto"),
            ("auto:TP-0001", "auto:TP-0001"),
            ("virtual", "virtual"),
            ("serial:/dev/ttyACM0", default.as_str()),
            ("serial:/dev/ttyACM0@1", "serial:/dev/ttyACM0@1"),
            ("serial:/dev/a@b/c@4294967295", "serial:/dev/a@b/c@4294967295"),
            ("serial:a:b@9600", "serial:a:b@9600"),
            ("hid:1209:0001", "hid:1209:0001"),
            ("hid:ABCD:ffff:a:b", "hid:abcd:ffff:a:b"),
            ("usb:1-1.2@9600", "usb:1-1.2@9600"),
            ("usb:1-1.2:1.0@9600", "usb:1-1.2:1.0@9600"),
            ("tablet", "tablet"),
            ("tablet:/dev/input/event5", "tablet:/dev/input/event5"),
            ("load-cells:/dev/ttyUSB0", "load-cells:/dev/ttyUSB0"),
            ("my-board:/dev/ttyUSB0@57600", "my-board:/dev/ttyUSB0@57600"),
            ("capture:run:1.tpc", "capture:run:1.tpc"),
        ] {
            let address = parse(text).unwrap();
            assert_eq!(address.to_string(), written);
            assert_eq!(parse(written).unwrap(), address);
        }
    }

    #[test]
    fn at_in_a_folder_is_no_rate() {
        let address = PadAddress::Serial { path: "/dev/a@1/port".into(), baud: DEFAULT_BAUD };
        assert_eq!(parse("serial:/dev/a@1/port").unwrap(), address);
    }

    #[test]
    fn rates_that_are_none_are_refused() {
        for baud in ["", "0", "-1", "+9600", "4294967296", "fast", "1e6"] {
            let error = AddressError::BadBaud { kind: "serial", path: "/dev/x".into(), baud: baud.into() };
            assert_eq!(parse(&format!("serial:/dev/x@{baud}")).unwrap_err(), error);
        }
    }

    #[test]
    fn missing_parts_are_named() {
        for (text, word) in [
            ("serial", "path"),
            ("serial:", "path"),
            ("serial:@9600", "path"),
            ("hid", "vendor"),
            ("hid:", "vendor"),
            ("hid:1209:0001:", "serial number"),
            ("usb:", "USB port"),
            ("usb:@9600", "USB port"),
            ("capture", "file"),
            ("auto:", "serial number"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(matches!(error, AddressError::Incomplete { .. }), "{text}");
            assert!(error.to_string().contains(word), "{text}: {error}");
        }
    }

    #[test]
    fn usb_numbers_have_four_hexadecimal_digits() {
        for text in
            ["hid:1209", "hid:1209:", "hid:120:0001", "hid:1209:00001", "hid:+209:0001", "hid:12g9:0001"]
        {
            assert!(matches!(parse(text), Err(AddressError::BadUsbNumber { .. })), "{text}");
        }
    }

    #[test]
    fn other_words_are_answered_with_all_forms() {
        for text in ["", "plug", "Auto", "virtual:", "/dev/ttyACM0", "serial /dev/x"] {
            let message = parse(text).unwrap_err().to_string();
            for form in ["auto", "virtual", "serial:PATH", "hid:", "usb:PORT", "capture:FILE"] {
                assert!(message.contains(form), "{text}: {message}");
            }
        }
    }
}
