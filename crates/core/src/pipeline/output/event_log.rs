//! The event log: one line of JSON for each event.

use std::fmt;
use std::io::{self, Write};

use crate::pipeline::control::OutputEvent;

/// An event as a line of the log, without the line's end.
///
/// `{"t_us":123,"device":"gamepad","code":"BTN_SOUTH","value":1}`: stream time in microseconds, the device,
/// the kernel's name of the control, its new value or, for a movement, its counts.
#[derive(Clone, Copy, Debug)]
pub struct LogLine<'a>(pub &'a OutputEvent);

impl fmt::Display for LogLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OutputEvent { at, device, code, value } = self.0;
        let (t_us, device) = (at.as_us(), device.name());
        // Names of devices and controls hold nothing that JSON would have to escape.
        write!(f, r#"{{"t_us":{t_us},"device":"{device}","code":"{code}","value":{value}}}"#)
    }
}

/// Writes a line for each event.
///
/// # Errors
/// What `out` says.
pub fn write(out: &mut impl Write, events: &[OutputEvent]) -> io::Result<()> {
    events.iter().try_for_each(|event| writeln!(out, "{}", LogLine(event)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::{Code, OutputDevice};
    use crate::time::StreamInstant;

    fn line(t_us: u64, device: OutputDevice, code: Code, value: i32) -> String {
        LogLine(&OutputEvent { at: StreamInstant::from_us(t_us), device, code, value }).to_string()
    }

    #[test]
    fn lines_are_the_agreed_ones() {
        assert_eq!(
            line(123, OutputDevice::Gamepad, Code::Key(0x130), 1),
            r#"{"t_us":123,"device":"gamepad","code":"BTN_SOUTH","value":1}"#
        );
        assert_eq!(
            line(u64::MAX, OutputDevice::Gamepad, Code::Axis(0x11), -1),
            r#"{"t_us":18446744073709551615,"device":"gamepad","code":"ABS_HAT0Y","value":-1}"#
        );
        assert_eq!(
            line(0, OutputDevice::Keyboard, Code::Key(44), 0),
            r#"{"t_us":0,"device":"keyboard","code":"KEY_Z","value":0}"#
        );
        assert_eq!(
            line(4_000, OutputDevice::Pointer, Code::Relative(0), -3),
            r#"{"t_us":4000,"device":"pointer","code":"REL_X","value":-3}"#
        );
    }

    #[test]
    fn every_code_gives_a_line_that_reads_back() {
        for number in 0..=u16::MAX {
            for code in [Code::Key(number), Code::Axis(number), Code::Relative(number)] {
                let text = line(7, OutputDevice::Gamepad, code, -3);
                let value: serde_json::Value = serde_json::from_str(&text).unwrap();
                assert_eq!(value["t_us"], 7);
                assert_eq!(value["value"], -3);
                assert_eq!(value["code"], code.to_string());
            }
        }
    }
}
