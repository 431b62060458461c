//! Output whose errors name where it was to go.

use std::io::{self, Stdout, Write};

/// Writes to `to`, which people call `place`.
pub(super) struct Named<W> {
    to: W,
    place: String,
}

/// Standard output.
pub(super) fn stdout() -> Named<Stdout> {
    Named::new(io::stdout(), "stdout".into())
}

impl<W: Write> Named<W> {
    /// Writes to `to` under this name.
    pub(super) const fn new(to: W, place: String) -> Self {
        Self { to, place }
    }

    /// The error with the place and without the system's number; its kind stays.
    fn placed(&self, error: &io::Error) -> io::Error {
        io::Error::new(error.kind(), format!("cannot write {}: {}", self.place, reason(error)))
    }
}

impl<W: Write> Write for Named<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.to.write(bytes).map_err(|error| self.placed(&error))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush().map_err(|error| self.placed(&error))
    }
}

/// What the system says, without its number.
pub(super) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Refusing(io::ErrorKind);

    impl Write for Refusing {
        fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Err(io::ErrorKind::StorageFull.into())
        }
    }

    #[test]
    fn errors_name_the_place_and_keep_their_kind() {
        let mut named = Named::new(Refusing(io::ErrorKind::BrokenPipe), "game.cap".into());
        assert_eq!(named.write(b"x").unwrap_err().kind(), io::ErrorKind::BrokenPipe);
        let error = named.flush().unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(error.to_string().starts_with("cannot write game.cap: "), "{error}");
        let mut named = Named::new(Refusing(io::ErrorKind::Interrupted), String::new());
        assert_eq!(named.write(b"x").unwrap_err().kind(), io::ErrorKind::Interrupted, "it is tried again");
    }
}
