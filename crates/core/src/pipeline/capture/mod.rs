//! The capture: every call made on the pipeline, so that a replay makes the same calls and gets the same events.
//!
//! Form, integers little-endian: the line `tactpad capture 1\n`, then one entry per call:
//!
//! | bytes | field |
//! |---|---|
//! | 1 | kind |
//! | 8 | host time in nanoseconds |
//! | 4 | length n of the payload, up to 16 MiB |
//! | 4 | checksum of the previous entry's payload checksum (0 for the first entry) and of the fields above |
//! | n | payload: the pad's bytes, a profile's text, a decoder's file, or a weight in grams (f64) |
//! | 4 | checksum of the head's checksum and of the payload |
//!
//! A capture begins with its decoder, if it was another one than statics as it is inside the program, and its profile.
//!
//! Checksums are the wire's CRC-32. Each covers the one before it, so an entry that is missing, doubled or moved is
//! damage, too. The head has its own, so that a damaged length is not taken for the end of the file. A recorder that
//! was killed leaves a file whose last entry may be cut off; everything before it is sound. One whose file does not take
//! calls in time ends the capture with an entry that says so.

mod entry;
pub mod head;
pub mod reader;
pub mod writer;
