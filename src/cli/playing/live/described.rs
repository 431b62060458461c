//! Pads that a description tells of, for the live verbs.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use crate::cli::failure::Failure;
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::playing::source;
use tactpad::bridge::bridge_parts::PlayingDecoder;
use tactpad::bridge::opening::{OpenError, OpenedPad, Patience};
use tactpad::bridge::transport::address::PadAddress;
use tactpad::bridge::transport::evdev::{EvdevOpener, leave};
use tactpad::firmware_proto::DEFAULT_BAUD;
use tactpad::source::{Measures, Origin, Source};

/// The description of a pad.
#[derive(Debug, Args)]
pub(super) struct SourceOption {
    /// What the pad is, where it is no strain pad of nine channels: a file as `tactpad source new` begins one, or a name from `source
    /// list`.
    #[arg(long, value_name = "NAME|FILE")]
    source: Option<String>,
    /// Let a tablet or touchpad go on moving the pointer while it plays.
    #[arg(long)]
    no_grab: bool,
}

/// A pad that is described.
pub(super) struct DescribedPad {
    source: Arc<Source>,
    text: String,
    /// Where it is to be opened.
    address: PadAddress,
    /// Whether it goes on moving the pointer.
    keeps_pointer: bool,
}

impl SourceOption {
    /// The same, with the description that was chosen before where none is given.
    pub(super) fn or(&self, chosen: Option<String>) -> Self {
        Self { source: self.source.clone().or(chosen), no_grab: self.no_grab }
    }

    /// Whether a description is named.
    pub(super) const fn is_given(&self) -> bool {
        self.source.is_some()
    }

    /// The described pad at `pad`, if it is one: by its own name or by --source.
    pub(super) fn read(
        &self,
        pad: &PadAddress,
        decoder: &DecoderChoice,
    ) -> Result<Option<DescribedPad>, Failure> {
        let found = match (&self.source, pad) {
            (Some(named), _) => source::find(named)?,
            (None, PadAddress::Described { name, .. }) if is_shipped(name) => source::find(name)?,
            (None, PadAddress::Described { name, .. }) => return Err(unknown(name)),
            (None, _) if self.no_grab => {
                return Err(Failure::Unusable(
                    "--no-grab is for tablets and touchpads, as in --pad tablet: a strain pad moves no pointer".into(),
                ));
            }
            (None, _) => return Ok(None),
        };
        if decoder.is_given() {
            return Err(Failure::Unusable(
                "--decoder is for strain pads of nine channels; this pad's description says how it is decoded: leave it out"
                    .into(),
            ));
        }
        let source = Arc::new(source::usable(&found)?);
        let address = address(pad, &source)?;
        Ok(Some(DescribedPad { source, text: found.text, address, keeps_pointer: self.no_grab }))
    }
}

/// The error for the first word of an address that is neither a kind of pad nor a description.
fn unknown(name: &str) -> Failure {
    let known = tactpad::source::shipped::names().collect::<Vec<_>>().join(", ");
    Failure::Unusable(format!(
        "`{name}` names no pad and no description: write auto, serial:PATH, hid:VID:PID or usb:PORT for a strain pad, one of \
         {known} with its port, or name a file of your own with --source"
    ))
}

fn is_shipped(name: &str) -> bool {
    tactpad::source::shipped::text(name).is_some()
}

/// Where the pad is to be opened, if such a pad can be there.
fn address(pad: &PadAddress, source: &Source) -> Result<PadAddress, Failure> {
    let name = &source.name;
    match (&source.origin, pad) {
        (_, PadAddress::Described { name: named, .. }) if named != name => Err(Failure::Unusable(format!(
            "--source describes {name}, and --pad names {named}: write --pad {name}:PATH"
        ))),
        (Origin::Lines(lines), PadAddress::Described { path: Some(path), baud, .. }) => {
            Ok(PadAddress::Serial { path: path.clone(), baud: baud.unwrap_or(lines.baud) })
        }
        (Origin::Wire, PadAddress::Described { path: Some(path), baud, .. }) => {
            Ok(PadAddress::Serial { path: path.clone(), baud: baud.unwrap_or(DEFAULT_BAUD) })
        }
        (Origin::Lines(_) | Origin::Wire, PadAddress::Described { path: None, .. }) => {
            Err(Failure::Unusable(format!(
                "{name} does not say who it is: name its port, as in --pad {name}:/dev/ttyUSB0 (`tactpad devices` lists them)"
            )))
        }
        (Origin::Evdev(_), PadAddress::Described { baud: Some(_), .. }) => Err(Failure::Unusable(format!(
            "{name} is an input device, which has no rate: write --pad {name}:/dev/input/eventN"
        ))),
        (
            Origin::Evdev(_),
            PadAddress::Serial { .. }
            | PadAddress::Hid { .. }
            | PadAddress::Usb { .. }
            | PadAddress::Auto { .. },
        ) => Err(Failure::Unusable(format!(
            "{name} is an input device: write --pad {name}, or --pad {name}:/dev/input/eventN"
        ))),
        (_, PadAddress::Virtual) => Err(Failure::Unusable(
            "--source describes a pad of your own, and the virtual pad is a strain pad: leave it out".into(),
        )),
        (
            Origin::Lines(_),
            PadAddress::Auto { .. }
            | PadAddress::Serial { .. }
            | PadAddress::Hid { .. }
            | PadAddress::Usb { .. },
        ) => {
            // The rate of lines is the description's, and serial: would take that of frames.
            Err(Failure::Unusable(format!(
                "{name} prints lines of text and does not say who it is: name its port, as in --pad {name}:/dev/ttyUSB0 \
                 (`tactpad devices` lists them)"
            )))
        }
        _ => Ok(pad.clone()),
    }
}

impl DescribedPad {
    /// What turns its numbers into contacts. A capture keeps the description.
    pub(super) fn decoder(&self) -> Result<PlayingDecoder, Failure> {
        let name = &self.source.name;
        let decoder = self.source.decoder();
        let decoder = decoder
            .ok_or_else(|| Failure::Unusable(format!("{name} describes no pad that can be played with")))?;
        let file = Some(self.text.clone().into_bytes());
        Ok(PlayingDecoder { name: format!("{} ({name})", decoder.name()), decoder, place: None, file })
    }

    /// Its description.
    pub(super) fn source(&self) -> Arc<Source> {
        Arc::clone(&self.source)
    }

    /// How the player gives it back to the desktop without a keyboard, if it is taken from it.
    pub(super) fn leave(&self) -> Option<&'static str> {
        let takes = matches!(&self.source.origin, Origin::Evdev(evdev) if evdev.grabs) && !self.keeps_pointer;
        match &self.source.measures {
            Measures::Contact(touching) if takes => Some(leave::how(touching)),
            _ => None,
        }
    }

    /// Opens it.
    pub(super) fn open(&self, patience: Patience) -> Result<OpenedPad, OpenError> {
        if let PadAddress::Capture { file } = &self.address {
            return OpenedPad::capture(file);
        }
        if let (Origin::Evdev(_), PadAddress::Described { path, .. }) = (&self.source.origin, &self.address) {
            let path = path.as_ref().map(PathBuf::from);
            return OpenedPad::input_device(
                EvdevOpener::new(self.source.as_ref().clone(), path, self.keeps_pointer),
                patience,
            );
        }
        let opened = OpenedPad::device(self.address.clone(), patience)?;
        match &self.source.origin {
            Origin::Lines(lines) => opened.with_lines(lines).map_err(OpenError::Io),
            Origin::Wire | Origin::Evdev(_) => Ok(opened),
        }
    }
}
