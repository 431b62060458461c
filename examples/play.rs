//! Pad bytes in, events out: the loop that any program of one's own has around the pipeline.
//!
//! ```sh
//! cargo run --release --example play -- contra
//! ```
//!
//! A pad made of software plays the profile's controls for eight seconds of its own time. With a real pad `bytes` come
//! from a port, and `now` from a clock that does not go backwards.

use std::error::Error;
use std::io;

use tactpad::pipeline::call::Call;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::mapping::read::shipped as profiles;
use tactpad::pipeline::output::event_log;
use tactpad::pipeline::{NoProbe, Pipeline, shipped};
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::Script;

const PLAYED_US: u64 = 8_000_000;
/// So often the port is read.
const READ_EVERY_US: u64 = 1_000;

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "super-mario".into());
    let text = profiles::text(&name).ok_or_else(|| format!("there is no profile {name}"))?;
    let (profile, findings) = ReadProfile::read(text, OutputChoice::AsWritten);
    let profile = profile.ok_or_else(|| format!("{findings:?}"))?.profile().clone();

    let mut pad = VirtualPad::new(Script::for_profile(&profile, PLAYED_US), 1);
    let mut pipeline = Pipeline::new(shipped::decoder(), profile);
    let mut bytes = Vec::new();
    for now_us in (0..PLAYED_US).step_by(READ_EVERY_US as usize) {
        let now = HostInstant::from_ns(1_000 * now_us);
        // A deadline may pass while no byte comes: what was held must then be let go.
        if pipeline.poll_timeout().is_some_and(|due| due <= now) {
            make(&mut pipeline, now, Call::Timeout)?;
        }
        bytes.clear();
        pad.emit(now_us, &mut bytes);
        make(&mut pipeline, now, Call::Bytes(&bytes))?;
    }
    // Before the end nothing may stay held.
    make(&mut pipeline, HostInstant::from_ns(1_000 * PLAYED_US), Call::ReleaseAll)
}

/// Makes a call, and prints its events, one line of JSON each.
fn make(pipeline: &mut Pipeline, now: HostInstant, call: Call<'_>) -> Result<(), Box<dyn Error>> {
    let mut left = Some(call);
    while let Some(call) = left {
        left = pipeline.apply(now, call, &mut NoProbe);
        event_log::write(&mut io::stdout(), pipeline.events())?;
    }
    Ok(())
}
