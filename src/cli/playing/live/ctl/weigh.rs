//! `tactpad ctl weigh`: a known weight, from the asking to what came of it.

use std::io::Write;
use std::path::Path;

use rustix::event::{PollFd, Timespec, poll};
use serde_json::Value;

use super::answer::answered;
use crate::cli::failure::Failure;
use crate::cli::printing::written::{print_json, quoted, say, stdout};
use tactpad::bridge::weighing::gain_sentence;
use tactpad::pad::weight::check_weight;

/// How often the bridge is asked how far it is.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };

/// Where a decoder is kept that has no file yet.
const OWN: &str = "my.decoder";

pub(super) fn run(path: &Path, grams: f64, json: bool) -> Result<(), Failure> {
    check_weight(grams).map_err(Failure::Unusable)?;
    let (_, begun) = answered(path, &format!("weigh {grams}"))?;
    let number = begun.get("weighing").and_then(Value::as_u64);
    say(format_args!("put the {grams} g on the plate and take the hand away"));
    let mut told = String::new();
    let (status, weighing) = loop {
        let (_, status) = answered(path, "status")?;
        let weighing = status.get("weighing").cloned().unwrap_or_default();
        if weighing.get("number").and_then(Value::as_u64) != number {
            return Err(Failure::Failed("another weighing was begun meanwhile: look at its answer".into()));
        }
        match text(&weighing, "state") {
            "waiting" | "resting" => tell(&mut told, text(&weighing, "state")),
            _ => break (status, weighing),
        }
        // A signal only lets it look earlier.
        let _ = poll(&mut [] as &mut [PollFd<'_>; 0], Some(&LOOK));
    };
    if let Some(error) = weighing.get("error").and_then(Value::as_str) {
        return Err(Failure::Failed(error.to_owned()));
    }
    if json { print_json(&weighing) } else { print(&status, &weighing) }
}

/// Says that the load rests, or that it does not any more.
fn tell(told: &mut String, state: &str) {
    if *told != state {
        if state == "resting" {
            say("it rests: leave it for two seconds");
        } else if !told.is_empty() {
            say("it moved: leave it alone for two seconds");
        }
        state.clone_into(told);
    }
}

fn print(status: &Value, weighing: &Value) -> Result<(), Failure> {
    let number = |key: &str| weighing.get(key).and_then(Value::as_f64).unwrap_or_default();
    let (factor, deviation) = (number("factor"), number("deviation"));
    let mut out = stdout();
    let unchanged = || "the pad reads what it read when it was calibrated".into();
    let sentence = gain_sentence(factor).unwrap_or_else(unchanged);
    writeln!(out, "{sentence} (factor {factor:.4}, ± {:.1} %)", 100.0 * deviation)?;
    writeln!(out, "Take the weight away. It counts until the pad is unplugged or weighed again.")?;
    writeln!(out, "{}", how_to_keep(status, factor, deviation))?;
    Ok(())
}

/// How it is kept for good.
fn how_to_keep(status: &Value, factor: f64, deviation: f64) -> String {
    let is_inverse = text(status, "decoder").starts_with("inverse");
    match status.get("decoder_file").and_then(Value::as_str).filter(|_| is_inverse) {
        Some(file) => {
            let out = if file.starts_with('/') { file } else { OWN };
            format!(
                "To keep it: tactpad weigh --decoder {} --factor {factor:.4} --deviation {deviation:.4} --out {}",
                quoted(file),
                quoted(out)
            )
        }
        None => "Only inverse decoders keep it: make one with `tactpad calibrate`.".into(),
    }
}

fn text<'v>(of: &'v Value, key: &str) -> &'v str {
    of.get(key).and_then(Value::as_str).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_that_keeps_it_can_be_pasted() {
        let status =
            |decoder: &str, file: &str| serde_json::json!({"decoder": decoder, "decoder_file": file});
        let own = how_to_keep(&status("inverse (my pad's)", "/pads/my pad's"), 0.911, 0.0061);
        assert_eq!(
            own,
            r"To keep it: tactpad weigh --decoder '/pads/my pad'\''s' --factor 0.9110 --deviation 0.0061 --out '/pads/my pad'\''s'"
        );
        let shipped = how_to_keep(&status("inverse", "inverse"), 0.911, 0.0061);
        assert!(shipped.contains("--decoder inverse ") && shipped.ends_with("--out my.decoder"), "{shipped}");
        assert!(how_to_keep(&status("statics", "statics"), 0.911, 0.0061).starts_with("Only inverse"));
    }
}
