//! The live core in virtual time: bytes and contacts go in, events come out.

mod allocation;
mod calls;
#[path = "../support/decoders.rs"]
mod decoders;
mod diagnostics;
mod dither;
mod drift;
mod hysteresis;
mod interrupts;
mod loaded;
mod macro_keys;
mod mapping_properties;
mod other_forms;
#[path = "../support/played.rs"]
mod played;
mod player;
mod profile_reference;
mod profile_schema;
mod rig;
mod standing;
mod timeline;
mod validation;
mod warmth;
mod warnings;
mod weighing;
#[cfg(target_os = "linux")]
#[path = "../support/worked.rs"]
mod worked;
