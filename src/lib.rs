//! Turns a tactile disc with nine strain channels into a game controller.
//!
//! The way of the data is one line: bytes → sample → raw channels → strain → contact → intents → output events.
//! [`pipeline`] is that way, as a state machine without I/O and without a clock: the caller says what happened and when.
//! Here a pad made of software plays; a real one's bytes come from a port, as they come.
//!
//! ```
//! use tactpad::pipeline::call::Call;
//! use tactpad::pipeline::mapping::read::{ReadProfile, check::OutputChoice, shipped as profiles};
//! use tactpad::pipeline::{NoProbe, Pipeline, shipped};
//! use tactpad::time::HostInstant;
//! use tactpad::virtual_pad::{firmware::VirtualPad, script::Script};
//!
//! let text = profiles::text("super-mario").expect("a profile inside the program");
//! let (profile, findings) = ReadProfile::read(text, OutputChoice::AsWritten);
//! let profile = profile.ok_or(findings).expect("a profile without errors").profile().clone();
//! let mut pad = VirtualPad::new(Script::for_profile(&profile, 4_000_000), 1);
//! let mut pipeline = Pipeline::new(shipped::decoder(), profile);
//! let (mut bytes, mut events) = (Vec::new(), Vec::new());
//! for ms in 0..4_000 {
//!     bytes.clear();
//!     pad.emit(1_000 * ms, &mut bytes);
//!     let mut call = Some(Call::Bytes(&bytes));
//!     while let Some(next) = call {
//!         call = pipeline.apply(HostInstant::from_ns(1_000_000 * ms), next, &mut NoProbe);
//!         events.extend_from_slice(pipeline.events());
//!     }
//! }
//! assert!(events.len() > 1 && pipeline.health().frames_lost == 0);
//! ```
//!
//! # What there is
//!
//! Each part is a crate of its own; here stand all of them under one name.
//!
//! | module | what it does | feature |
//! |---|---|---|
//! | [`pipeline`] | the live core, captures and replay | |
//! | [`pad`], [`tables`], [`virtual_pad`] | device files, influence fields, the twin; measured tables; a pad made of software | |
//! | [`network`], [`numeric`], [`toml_text`] | perceptrons; numerical methods; texts that people write | |
//! | `lab` | calibration, diagnosis and its inference (`lab::inference`), evaluation, tuning | `lab` |
//! | `mechanics`, `plot` | the finite-element simulator; figures | `simulator` |
//! | `lab::{layout, metrology, ablation, scdf}` | the paper's studies | `simulator` |
//! | `bridge` | ports, virtual devices and the loop between them (Linux) | `live` |
//! | `dashboard` | the page that shows a running bridge (Linux) | `dashboard` |
//! | `tray` | the icon on the desktop (Linux) | `tray` |
//!
//! The program `tactpad` itself is the feature `cli`. Without features five small dependencies are left.
//! `examples/` has whole programs. `ARCHITECTURE.md` says which rules hold between the crates.

pub use tactpad_core::{
    counted, firmware_proto, network, pad, pipeline, quantity, source, tables, time, toml_text, virtual_pad,
};
#[cfg(feature = "simulator")]
pub use tactpad_mechanics as mechanics;
pub use tactpad_numeric as numeric;
#[cfg(feature = "simulator")]
pub use tactpad_plot as plot;

#[cfg(all(feature = "live", target_os = "linux"))]
pub use tactpad_bridge as bridge;
#[cfg(all(feature = "dashboard", target_os = "linux"))]
pub use tactpad_desktop::dashboard;
#[cfg(all(feature = "tray", target_os = "linux"))]
pub use tactpad_desktop::tray;

/// Studies: of what a pad has measured, and of the paper's pad.
#[cfg(feature = "lab")]
pub mod lab {
    pub use tactpad_inference as inference;
    pub use tactpad_lab::*;
    #[cfg(feature = "simulator")]
    pub use tactpad_mechanics::field_cache;
    #[cfg(feature = "simulator")]
    pub use tactpad_paper::*;
}
