//! The engine, which plays a profile sample by sample.
//!
//! `contact` says what the contact means: whether it is a touch, and where (`rest` → `tremor` → `heading`, `zone`, `pointer`, `axes`). `button` is
//! what goes on at one button. Slow Keys and Bounce Keys for directions are in `directions`; `interrupt` says what presses make of each
//! other. All that a step comes to is collected in
//! [`stated`], where macros have the last word; [`verdict`] is what people are told of presses. [`engine`] puts it all together.

mod button;
mod contact;
mod directions;
pub mod engine;
pub mod intent;
mod interrupt;
mod macros;
pub mod stated;
pub mod verdict;

pub use self::button::accept::Presses;
