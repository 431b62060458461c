//! The pad as files tell of it and as the twin plays it: devices, plans and measured tables, imperfections.

mod device;
mod measured;
mod twin;
#[cfg(target_os = "linux")]
#[path = "../../../../tests/support/worked.rs"]
mod worked;
