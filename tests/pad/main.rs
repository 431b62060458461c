//! The pad as files tell of it and as the twin plays it: devices, plans and measured tables, imperfections.

mod device;
mod measured;
mod protocol;
mod twin;
#[cfg(target_os = "linux")]
#[path = "../support/worked.rs"]
mod worked;
