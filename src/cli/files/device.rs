//! `--device` and `--imperfections`: the pad that a verb computes with.

use std::path::{Path, PathBuf};

use clap::Args;

use super::text_file;
use crate::cli::failure::Failure;
use crate::cli::printing::written::{is_same, written_over};
use tactpad::pad::device::Device;
use tactpad::toml_text::diag::Diagnostic;

const PAPER: &str = include_str!("../../../models/imperfections/paper.toml");

/// Which pad; flattened into the arguments of each verb that simulates or decodes.
#[derive(Debug, Args)]
pub(crate) struct PadOptions {
    /// A device file; without it the nominal pad, whose file is models/sstid.toml.
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    /// A file of tables that say how this pad differs from the device (models/README.md), or the word paper: those
    /// that reproduce the paper's figures.
    #[arg(long, value_name = "FILE")]
    imperfections: Option<PathBuf>,
}

impl PadOptions {
    /// Refuses to write over a file that is read.
    pub(crate) fn spare(&self, written: &Path) -> Result<(), Failure> {
        let files = [(&self.device, "is the device"), (&self.imperfections, "is the file of imperfections")];
        match files.iter().find(|(file, _)| file.as_ref().is_some_and(|file| is_same(file, written))) {
            Some((_, what)) => Err(written_over(written, what)),
            None => Ok(()),
        }
    }

    /// Whether a file says which pad it is.
    pub(crate) const fn is_given(&self) -> bool {
        self.device.is_some() || self.imperfections.is_some()
    }

    /// The pad of the twin: where no file says which, the nominal one with the paper's imperfections.
    pub(crate) fn read_imperfect(&self) -> Result<Device, Failure> {
        if self.is_given() { self.read() } else { Ok(paper()) }
    }

    /// Whether the twin's pad is the one of `models/imperfections/paper.toml`.
    pub(crate) fn is_papers(&self) -> Result<bool, Failure> {
        Ok(self.read_imperfect()? == paper())
    }

    /// Reads the device alone, without imperfections.
    pub(crate) fn designed(&self) -> Result<Device, Failure> {
        self.device
            .as_ref()
            .map_or_else(|| Ok(Device::nominal()), |path| read(path, "device", Device::from_toml))
    }

    /// Reads the files. What is wrong with them makes them unusable, and all of it is told.
    pub(crate) fn read(&self) -> Result<Device, Failure> {
        let device = self.designed()?;
        match &self.imperfections {
            Some(name) if name.as_os_str() == "paper" => {
                read_text("imperfections", "paper", PAPER, |text| device.with_imperfections(text))
            }
            Some(path) => read(path, "imperfections", |text| device.with_imperfections(text)),
            None => Ok(device),
        }
    }
}

/// The nominal pad with the imperfections in `models/imperfections/paper.toml`.
#[expect(clippy::expect_used, reason = "the file is part of the program and a test reads it")]
fn paper() -> Device {
    Device::nominal()
        .with_imperfections(PAPER)
        .0
        .expect("models/imperfections/paper.toml fits the nominal pad")
}

fn read(
    path: &Path,
    what: &str,
    device: impl Fn(&str) -> (Option<Device>, Vec<Diagnostic>),
) -> Result<Device, Failure> {
    let file = path.display().to_string();
    let text = text_file::read(path).map_err(|why| {
        Failure::Unusable(format!("{what} {file} cannot be read: {why}; name another file"))
    })?;
    read_text(what, &file, &text, device)
}

/// Reads a text, which people call `file`.
fn read_text(
    what: &str,
    file: &str,
    text: &str,
    device: impl Fn(&str) -> (Option<Device>, Vec<Diagnostic>),
) -> Result<Device, Failure> {
    let (device, found) = device(text);
    device.ok_or_else(|| {
        let told: Vec<_> = found.iter().map(|finding| finding.render(file)).collect();
        Failure::Unusable(format!("{what} {file} cannot be used\n{}", told.join("\n")))
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Verb {
        #[command(flatten)]
        pad: PadOptions,
    }

    /// The device for these texts under `--device` and `--imperfections`, or the error message.
    fn given(device: Option<&str>, imperfections: Option<&str>) -> Result<Device, String> {
        let folder = tempfile::tempdir().unwrap();
        let mut arguments = vec!["verb".into()];
        for (name, text) in [("device", device), ("imperfections", imperfections)] {
            if let Some(text) = text {
                let path = folder.path().join(name);
                fs::write(&path, text).unwrap();
                arguments.extend([format!("--{name}").into(), path.into_os_string()]);
            }
        }
        Verb::parse_from(arguments).pad.read().map_err(|failure| match failure {
            Failure::Unusable(told) => told.replace(&format!("{}/", folder.path().display()), ""),
            other => panic!("{other:?}"),
        })
    }

    #[test]
    fn the_pad_is_the_nominal_one_unless_files_say_otherwise() {
        let nominal = Device::nominal();
        assert_eq!(given(None, None), Ok(nominal.clone()));
        let thicker = nominal.to_toml().replace("thickness_mm = 1.0 ", "thickness_mm = 1.15 ");
        let moved = "[[module]]\nindex = 0\nradial_mm = -0.7\n";
        let both = given(Some(&thicker), Some(moved)).unwrap();
        assert_eq!((both.plate.thickness_mm, both.modules[0].radial_mm), (1.15, -0.7));
        assert_eq!(given(None, Some(moved)).unwrap().plate, nominal.plate);
    }

    #[test]
    fn the_twin_is_the_papers_unless_files_say_otherwise() {
        let pad = |arguments: &[&str]| Verb::parse_from(arguments).pad.read_imperfect().unwrap();
        assert_eq!(pad(&["verb"]), paper());
        assert_ne!(paper(), Device::nominal());
        assert_eq!(pad(&["verb", "--device", "models/sstid.toml"]), Device::nominal());
        assert_eq!(Verb::parse_from(["verb", "--imperfections", "paper"]).pad.read().unwrap(), paper());
    }

    #[test]
    fn what_is_wrong_is_told_with_file_line_and_column() {
        let broken = Device::nominal().to_toml().replace("diameter_mm = 60.0", "diameter_mm = -60");
        let told = given(Some(&broken), None).unwrap_err();
        let lines: Vec<_> = told.lines().collect();
        assert_eq!(lines[0], "device device cannot be used");
        assert_eq!(lines[1], "device:10:15: error: \"diameter_mm\" is -60; it must be 10 to 500 mm");
        let told = given(None, Some("[[module]]\nindex = 0\nradial_mm = 9\n[[modul]]\n")).unwrap_err();
        assert!(told.contains("imperfections:3:13: error: module 0 leaves the plate"), "{told}");
        assert!(told.contains("imperfections:4:3: error: unknown key \"modul\""), "{told}");
    }

    #[test]
    fn a_file_that_is_none_is_refused() {
        let refused = Verb::parse_from(["verb", "--device", "/no-such-file.toml"]).pad.read();
        let Err(Failure::Unusable(told)) = refused else { panic!("{refused:?}") };
        assert!(told.contains("/no-such-file.toml cannot be read: No such file"), "{told}");
    }
}
