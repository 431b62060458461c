//! Sounds for presses: two short tones of our own, played by a program that is there already.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use clap::ValueEnum;
use serde_json::Value;
use tempfile::{NamedTempFile, TempDir};

use crate::cli::failure::Failure;
use crate::cli::printing::written::{reason, say};

/// Programs that play a sound file, the best first, each with its package in Debian.
const PLAYERS: [(&str, &str); 3] =
    [("pw-play", "pipewire-bin"), ("paplay", "pulseaudio-utils"), ("aplay", "alsa-utils")];

const RATE_HZ: u32 = 44_100;
/// Of full scale.
const LOUDNESS: f64 = 0.4;
/// A tone begins and ends so softly, else it clicks.
const FADE_MS: u32 = 5;

/// Which presses sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Which {
    /// Those that are rejected.
    Rejected,
    /// Accepted ones, too, with a sound of their own.
    All,
}

/// A sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tone {
    Accepted,
    Rejected,
}

/// Plays sounds, one at a time, beside whoever asks for them.
pub(super) struct Sounds {
    which: Which,
    tones: Tones,
    to: SyncSender<PathBuf>,
    is_busy: Arc<AtomicBool>,
}

/// The files of the tones.
struct Tones {
    folder: PathBuf,
    /// Kept as long as the sounds are, where the user has no folder for such files.
    _own: Option<TempDir>,
}

impl Sounds {
    /// Finds a player and writes the tones.
    pub(super) fn start(which: Which) -> Result<Self, Failure> {
        let path = env::var_os("PATH").unwrap_or_default();
        let player = find_player(&path).ok_or_else(|| Failure::Unusable(no_player()))?;
        let tones = Tones::write().map_err(|error| {
            Failure::Failed(format!("the sounds cannot be written: {}; make room for them", reason(&error)))
        })?;
        let (to, from) = sync_channel(1);
        let is_busy = Arc::new(AtomicBool::new(false));
        let freed = Arc::clone(&is_busy);
        thread::Builder::new().name("sound".into()).spawn(move || play_all(&player, &from, &freed))?;
        Ok(Self { which, tones, to, is_busy })
    }

    /// Plays what belongs to a line of the bridge, unless something plays already. It never waits.
    pub(super) fn play(&self, line: &str) {
        let Some(tone) = tone_for(self.which, line) else { return };
        if !self.is_busy.swap(true, Ordering::AcqRel) {
            // It is empty: the one before was taken when it began to play.
            let _ = self.to.try_send(self.tones.folder.join(tone.file_name()));
        }
    }
}

/// The sound of a press. A hand that rests has none: it means to.
fn tone_for(which: Which, line: &str) -> Option<Tone> {
    let line: Value = serde_json::from_str(line).ok()?;
    match (line.get("press")?.as_str()?, which) {
        ("rejected", _) => Some(Tone::Rejected),
        ("accepted", Which::All) => Some(Tone::Accepted),
        _ => None,
    }
}

/// Plays one file after the other and waits for each, so that no player is left behind. What is wrong is said once.
fn play_all(player: &Path, from: &Receiver<PathBuf>, is_busy: &AtomicBool) {
    let mut is_said = false;
    for tone in from {
        let mut command = Command::new(player);
        // What a player says does not belong among the lines.
        command.arg(tone).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let wrong = match command.status() {
            Ok(status) if status.success() => None,
            Ok(status) => Some(status.to_string()),
            Err(error) => Some(reason(&error)),
        };
        if let Some(wrong) = wrong.filter(|_| !std::mem::replace(&mut is_said, true)) {
            let player = player.display();
            say(format_args!("{player} plays no sound ({wrong}): try it with a file of yours"));
        }
        is_busy.store(false, Ordering::Release);
    }
}

/// The first player that is in one of the folders of `path`.
fn find_player(path: &OsStr) -> Option<PathBuf> {
    let is_program = |file: &PathBuf| {
        fs::metadata(file).is_ok_and(|it| it.is_file() && it.permissions().mode() & 0o111 != 0)
    };
    PLAYERS.iter().find_map(|(name, _)| {
        let mut files = env::split_paths(path).filter(|folder| folder.is_absolute()).map(|it| it.join(name));
        files.find(is_program)
    })
}

fn no_player() -> String {
    let all: Vec<_> = PLAYERS.iter().map(|(name, package)| format!("{name} ({package})")).collect();
    format!("there is nothing that plays sounds: install one of {}, or leave --sound out", all.join(", "))
}

impl Tones {
    /// Writes both into the user's runtime folder, else into one of their own that goes when they do.
    fn write() -> io::Result<Self> {
        let runtime = env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from).filter(|folder| folder.is_dir());
        let (folder, own) = match runtime {
            Some(folder) => (folder, None),
            None => {
                let own = TempDir::with_prefix("tactpad-")?;
                (own.path().to_owned(), Some(own))
            }
        };
        for tone in [Tone::Accepted, Tone::Rejected] {
            // Another one may be playing it: the old file stays until the new one is whole.
            let mut file = NamedTempFile::new_in(&folder)?;
            file.write_all(&tone.wave())?;
            file.persist(folder.join(tone.file_name())).map_err(|error| error.error)?;
        }
        Ok(Self { folder, _own: own })
    }
}

impl Tone {
    const fn file_name(self) -> &'static str {
        match self {
            Self::Accepted => "tactpad-accepted.wav",
            Self::Rejected => "tactpad-rejected.wav",
        }
    }

    /// High and short, or low and longer: told apart by ear, also by those who hear little of high tones.
    fn wave(self) -> Vec<u8> {
        match self {
            Self::Accepted => wave(880.0, 60),
            Self::Rejected => wave(220.0, 160),
        }
    }
}

/// A sine as a WAV file of 16 bits and one channel.
fn wave(frequency_hz: f64, duration_ms: u32) -> Vec<u8> {
    let count = RATE_HZ * duration_ms / 1_000;
    let fade = f64::from(RATE_HZ * FADE_MS / 1_000);
    let (channels, sample_bytes) = (1_u16, 2_u16);
    let data_bytes = count * u32::from(sample_bytes);
    let mut file = Vec::new();
    file.extend(b"RIFF");
    file.extend((36 + data_bytes).to_le_bytes());
    file.extend(b"WAVEfmt ");
    file.extend(16_u32.to_le_bytes());
    // Plain samples.
    file.extend(1_u16.to_le_bytes());
    file.extend(channels.to_le_bytes());
    file.extend(RATE_HZ.to_le_bytes());
    file.extend((RATE_HZ * u32::from(sample_bytes)).to_le_bytes());
    file.extend(sample_bytes.to_le_bytes());
    file.extend((8 * sample_bytes).to_le_bytes());
    file.extend(b"data");
    file.extend(data_bytes.to_le_bytes());
    for k in 0..count {
        let soft = (f64::from(k.min(count - 1 - k)) / fade).min(1.0);
        let angle = std::f64::consts::TAU * frequency_hz * f64::from(k) / f64::from(RATE_HZ);
        let sample = LOUDNESS * soft * angle.sin() * f64::from(i16::MAX);
        file.extend((sample.round() as i16).to_le_bytes());
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tone_is_a_wave_file_that_begins_and_ends_softly() {
        let file = wave(440.0, 100);
        let header = [
            b"RIFF".as_slice(),
            &(36 + 8_820_u32).to_le_bytes(),
            b"WAVEfmt ",
            // 16 bytes of format: plain, one channel, 44,100 Hz, 88,200 bytes a second, 2 bytes a sample of 16 bits.
            &[16, 0, 0, 0, 1, 0, 1, 0, 0x44, 0xac, 0, 0, 0x88, 0x58, 1, 0, 2, 0, 16, 0],
            b"data",
            &8_820_u32.to_le_bytes(),
        ];
        assert_eq!(file[..44], header.concat());
        assert_eq!(file.len(), 44 + 8_820);
        let samples: Vec<i16> =
            file[44..].chunks(2).map(|bytes| i16::from_le_bytes([bytes[0], bytes[1]])).collect();
        assert_eq!([samples[0], samples[4_409]], [0, 0]);
        let loudest = samples.iter().map(|sample| sample.unsigned_abs()).max().unwrap();
        assert!((13_000..13_108).contains(&loudest), "{loudest}");
        // It rises to zero at the end of each of its 44 periods, of the last with the last sample.
        let rises = samples.windows(2).filter(|pair| pair[0] < 0 && pair[1] >= 0).count();
        assert_eq!(rises, 44);
        assert_ne!(Tone::Accepted.wave(), Tone::Rejected.wave());
    }

    #[test]
    fn rejected_presses_sound_and_accepted_ones_if_asked_for() {
        let told = |press: &str| format!(r#"{{"t_us":1,"button":1,"press":"{press}"}}"#);
        for (press, rejected, all) in [
            ("rejected", Some(Tone::Rejected), Some(Tone::Rejected)),
            ("accepted", None, Some(Tone::Accepted)),
            ("rest", None, None),
        ] {
            let tones = [Which::Rejected, Which::All].map(|which| tone_for(which, &told(press)));
            assert_eq!(tones, [rejected, all], "{press}");
        }
        assert_eq!(tone_for(Which::All, "no JSON"), None);
        assert_eq!(tone_for(Which::All, r#"{"ok":true}"#), None);
    }

    #[test]
    fn the_best_player_of_all_folders_is_taken() {
        let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let path = env::join_paths(folders.iter().map(TempDir::path)).unwrap();
        let put = |folder: usize, name: &str, mode: u32| {
            let file = folders[folder].path().join(name);
            fs::write(&file, "#!/bin/sh\n").unwrap();
            fs::set_permissions(&file, fs::Permissions::from_mode(mode)).unwrap();
            file
        };
        assert_eq!(find_player(&path), None);
        let aplay = put(0, "aplay", 0o755);
        assert_eq!(find_player(&path), Some(aplay));
        let paplay = put(1, "paplay", 0o755);
        put(0, "pw-play", 0o644);
        assert_eq!(find_player(&path), Some(paplay), "what cannot be run is no player");
        let best = put(1, "pw-play", 0o700);
        assert_eq!(find_player(&path), Some(best));
        assert_eq!(find_player(OsStr::new("")), None);
        assert!(
            no_player().contains("pw-play (pipewire-bin), paplay (pulseaudio-utils), aplay (alsa-utils)")
        );
    }
}
