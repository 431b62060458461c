//! A measured table: contacts, and what the nine channels read for them.

use std::io::{self, BufWriter, Write};

use super::contacts::{Row, Times};
use crate::quantity::{CHANNEL_NAMES, CHANNELS, Contact};

/// Writes a measured table as CSV: `t_s` where times are known, the contact, then the channels in microvolts.
///
/// Places and forces are written so that they read as the same numbers again; channels to 0.001 µV.
pub(super) struct Measured<W: Write> {
    to: BufWriter<W>,
    times: Times,
}

impl<W: Write> Measured<W> {
    /// Begins the table with the names of its columns.
    pub(super) fn begin(to: W, times: Times) -> io::Result<Self> {
        let mut to = BufWriter::new(to);
        if times == Times::Written {
            to.write_all(b"t_s,")?;
        }
        to.write_all(b"x_mm,y_mm,fx_n,fy_n,fz_n")?;
        for name in CHANNEL_NAMES {
            write!(to, ",{name}_uv")?;
        }
        to.write_all(b"\n")?;
        Ok(Self { to, times })
    }

    /// Writes one row: a contact and its channels in microvolts.
    pub(super) fn row(&mut self, row: &Row, channels_uv: &[f64; CHANNELS]) -> io::Result<()> {
        if self.times == Times::Written {
            // Whole microseconds, divided once, print as the shortest number that reads the same.
            write!(self.to, "{},", row.at.as_us() as f64 / 1e6)?;
        }
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = row.contact;
        write!(self.to, "{x_mm},{y_mm},{fx_n},{fy_n},{fz_n}")?;
        for uv in channels_uv {
            // The sum has no −0, which would print as -0.000.
            write!(self.to, ",{:.3}", (uv * 1e3).round() / 1e3 + 0.0)?;
        }
        self.to.write_all(b"\n")
    }

    /// Ends the table; without it rows may be lost.
    pub(super) fn end(mut self) -> io::Result<()> {
        self.to.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::StreamInstant;

    fn written(times: Times, at_us: u64, contact: Contact, uv: [f64; CHANNELS]) -> String {
        let mut text = Vec::new();
        let mut table = Measured::begin(&mut text, times).unwrap();
        table.row(&Row { line: 2, at: StreamInstant::from_us(at_us), contact }, &uv).unwrap();
        table.end().unwrap();
        String::from_utf8(text).unwrap().lines().nth(1).unwrap().to_owned()
    }

    #[test]
    fn numbers_are_as_long_as_they_need_to_be() {
        let contact = Contact { x_mm: 0.1, y_mm: -28.999_998, fx_n: 0.0, fy_n: 1e-7, fz_n: 5.0 };
        let uv = [0.0, -0.000_4, 0.000_6, 1_234.567_89, -1e5, 0.1 + 0.2, -0.000_5, 2.5, -7.25];
        assert_eq!(
            written(Times::Written, 1_100_000, contact, uv),
            "1.1,0.1,-28.999998,0,0.0000001,5,0.000,0.000,0.001,1234.568,-100000.000,0.300,-0.001,2.500,-7.250"
        );
        assert!(written(Times::Supposed, 7, contact, uv).starts_with("0.1,-28.999998,"));
    }

    #[test]
    fn times_are_whole_microseconds() {
        for (us, s) in [(0, "0"), (1, "0.000001"), (300_000, "0.3"), (999_999_999_999, "999999.999999")] {
            let row = written(Times::Written, us, Contact::default(), [0.0; CHANNELS]);
            assert_eq!(row.split(',').next(), Some(s));
        }
    }
}
