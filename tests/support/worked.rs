//! How long a thread has worked: what others do on the machine meanwhile does not count.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::time::Duration;

/// Time that this thread has had a processor.
pub(crate) fn worked() -> Duration {
    let text = fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    Duration::from_nanos(text.split(' ').next().unwrap().parse().unwrap())
}
