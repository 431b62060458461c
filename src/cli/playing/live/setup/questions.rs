//! Questions on a terminal, or to whatever writes the answers.

use std::io::{self, BufRead, IsTerminal, Read, Write};

use crate::cli::failure::Failure;
use crate::cli::printing::wrapped::{COLUMNS, hanging, lines};
use crate::cli::printing::written::{printable, stdout};

/// More bytes make no answer.
const ANSWER_MAX: u64 = 4096;

/// The questions so far.
pub(super) struct Questions {
    asked: usize,
    /// Whether the answer in brackets is taken everywhere.
    takes_usual: bool,
}

/// Says something, each line of it on lines that are short enough.
pub(super) fn say(text: &str) -> Result<(), Failure> {
    let wrapped: Vec<String> = text.lines().map(|line| lines(&printable(line), COLUMNS).join("\n")).collect();
    Ok(writeln!(stdout(), "{}", wrapped.join("\n"))?)
}

/// A command to be typed, on one line however long it is.
pub(super) fn command(line: &str) -> Result<(), Failure> {
    Ok(writeln!(stdout(), "\n  {}\n", printable(line))?)
}

/// Things to choose from, each with its number.
pub(super) fn list(things: &[String]) -> Result<(), Failure> {
    list_from(1, things).map(|_| ())
}

/// The same, where the first has this number; gives the number after the last.
pub(super) fn list_from(first: usize, things: &[String]) -> Result<usize, Failure> {
    for (number, thing) in (first..).zip(things) {
        writeln!(stdout(), "{}", hanging(&format!("  {number:2}  "), &printable(thing)))?;
    }
    Ok(first + things.len())
}

impl Questions {
    pub(super) const fn new(takes_usual: bool) -> Self {
        Self { asked: 0, takes_usual }
    }

    /// A question, with the number that it has.
    pub(super) fn ask(&mut self, text: &str) -> Result<(), Failure> {
        self.asked += 1;
        Ok(writeln!(stdout(), "\n{}", hanging(&format!("{}. ", self.asked), text))?)
    }

    /// The answer to it: what is typed, and `usual` where that is nothing.
    ///
    /// # Errors
    /// The answers have ended.
    pub(super) fn answer(&self, usual: &str) -> Result<String, Failure> {
        write!(stdout(), "[{usual}]: ")?;
        stdout().flush()?;
        if self.takes_usual {
            writeln!(stdout(), "{usual}")?;
            return Ok(usual.to_owned());
        }
        let typed = read_line(&mut io::stdin().lock())?;
        if !io::stdin().is_terminal() {
            // No terminal has shown it.
            writeln!(stdout(), "{}", printable(&typed))?;
        }
        Ok(if typed.is_empty() { usual.to_owned() } else { typed })
    }

    /// Whether somebody wants to, which is usual.
    pub(super) fn is_wanted(&mut self, text: &str) -> Result<bool, Failure> {
        self.ask(text)?;
        loop {
            match self.answer("yes")?.to_lowercase().as_str() {
                "yes" | "y" => return Ok(true),
                "no" | "n" => return Ok(false),
                _ => say("Answer yes or no.")?,
            }
        }
    }
}

/// A line without the blanks around it.
fn read_line(from: &mut impl BufRead) -> Result<String, Failure> {
    let mut bytes = Vec::new();
    from.take(ANSWER_MAX).read_until(b'\n', &mut bytes)?;
    if bytes.last() != Some(&b'\n') {
        return Err(Failure::Failed(
            "the answers ended before the last question, so nothing was kept: start `tactpad setup` again, or have the usual answers taken \
             with --yes"
                .into(),
        ));
    }
    Ok(String::from_utf8_lossy(&bytes).trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_an_answer_once_it_has_ended() {
        let read = |mut bytes: &[u8]| read_line(&mut bytes).ok();
        assert_eq!(read(b" tetris \nmore").as_deref(), Some("tetris"));
        assert_eq!(read(b"\n").as_deref(), Some(""));
        assert_eq!([read(b""), read(b"tet"), read(&[b'a'; 5000])], [None, None, None]);
        assert_eq!(read(b"\xff\n").as_deref(), Some("\u{fffd}"));
    }
}
