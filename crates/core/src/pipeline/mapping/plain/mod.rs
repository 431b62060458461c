//! Plain words: what people read of controls, of a profile's settings, and of a profile as a whole. The kernel's names and the keys of
//! the TOML stand behind them, for who asks.

pub mod controls;
pub mod named;
pub mod settings;
pub mod summary;
pub mod values;
