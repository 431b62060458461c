//! Decodes a table of measured channels: CSV in, contacts out.
//!
//! ```sh
//! tactpad twin --plan recommended --seed 1 --out measured.csv
//! cargo run --release --example decode -- measured.csv > contacts.csv
//! ```
//!
//! The decoder is the one of the nominal pad. `pipeline::contact::read::decoder` reads one that `tactpad adapt` wrote.

use std::error::Error;
use std::fs::File;
use std::io::{self, BufReader, Write};

use tactpad::pad::device::Device;
use tactpad::pipeline::shipped;
use tactpad::quantity::{Contact, Strain};
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::read;
use tactpad::tables::recording::Recording;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("name a measured file")?;
    let (device, decoder) = (Device::nominal(), shipped::decoder());
    let table =
        read::table(BufReader::new(File::open(&path)?), TableKind::Measured, device.plate.radius_mm())?;

    // Raw channels carry offsets: the rows in which nothing touched the pad say which.
    let recording = Recording::of(table, device.contact.full_scale_n)
        .ok_or_else(|| format!("{path}: no row without force says what the untouched pad reads"))?;
    let mut out = io::stdout().lock();
    writeln!(out, "x_mm,y_mm,fx_n,fy_n,fz_n")?;
    for row in recording.taken(&decoder).rows {
        let Some(uv) = row.uv else { continue };
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = decoder.decode(&Strain { uv: uv.map(|uv| uv as f32) });
        writeln!(out, "{x_mm:.3},{y_mm:.3},{fx_n:.4},{fy_n:.4},{fz_n:.4}")?;
    }
    Ok(())
}
