//! The wire protocol as a stranger meets it: golden frames, damage, reports, the README's own examples, and the
//! C code for firmware.

#[cfg(test)]
#[path = "../../../tests/support/c_compiler.rs"]
mod c_compiler;
#[cfg(test)]
mod c_encoder;
#[cfg(test)]
mod c_firmware;
#[cfg(test)]
mod damage;
#[cfg(test)]
mod random;
#[cfg(test)]
mod readme;
#[cfg(test)]
mod report;
#[cfg(test)]
mod sanitized;
#[cfg(test)]
#[path = "../../../tests/support/mod.rs"]
mod support;
#[cfg(test)]
mod vectors;
