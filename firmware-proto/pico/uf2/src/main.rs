//! Makes a UF2, the file that a Raspberry Pi Pico takes as a drive, of a linked program.
//!
//! The form of a block is that of Microsoft's specification of UF2.

mod blocks;
mod elf;

use std::process::ExitCode;
use std::{env, fs};

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [from, to] = &arguments[..] else {
        eprintln!("usage: uf2 PROGRAM.elf PROGRAM.uf2");
        return ExitCode::from(2);
    };
    match convert(from, to) {
        Ok(bytes) => {
            eprintln!("{to}: {bytes} bytes of flash");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn convert(from: &str, to: &str) -> Result<usize, String> {
    let program = fs::read(from).map_err(|error| format!("{from} cannot be read: {error}"))?;
    let image = elf::flash_image(&program)
        .ok_or_else(|| format!("{from} is no linked program for a Raspberry Pi Pico"))?;
    fs::write(to, blocks::of(&image)).map_err(|error| format!("{to} cannot be written: {error}"))?;
    Ok(image.len())
}
