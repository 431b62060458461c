//! The thread that writes to an X server, and keeps the record of what it holds there.

use std::fmt;
use std::io;

use enigo::{Axis, Button, Coordinate, Direction, Enigo, InputResult, Mouse};
use x11rb::connection::{Connection, RequestConnection, SequenceNumber};
use x11rb::errors::ReplyError;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{ConnectionExt as _, KEY_PRESS_EVENT, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use super::held_record::{Down, HeldRecord};
use tactpad_core::pipeline::control::names::POINTER_PLACE_MAX;

/// The thread that writes to the server.
pub(super) struct X11Writer {
    connection: RustConnection,
    /// Moves the pointer.
    enigo: Option<Enigo>,
    display: String,
    record: Option<HeldRecord>,
    /// What is down once the server has done all that was written.
    down: Down,
    /// A question behind all that was written; its answer shows that releases are done.
    question: Option<SequenceNumber>,
}

/// One thing for the X server to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum X11Action {
    /// The key of this number, on its way down or up.
    Key(u8, Direction),
    /// A button of the pointer, on its way down or up.
    Button(Button, Direction),
    /// The pointer by so many counts to the right and down.
    Move(i32, i32),
    /// The pointer to this share of the screen's width.
    Across(i32),
    /// The pointer to this share of the screen's height.
    Down(i32),
    /// The wheel by so many notches towards the hand.
    Scroll(i32),
    /// Nothing, once all before it is done: a server forgets what it has not read of a client that is gone.
    Sync,
    /// The same, and the record goes: nothing comes after it.
    End,
}

impl X11Action {
    /// The number of the key or button that it presses or releases, and whether it presses it.
    const fn pressed(self) -> Option<(u8, bool)> {
        match self {
            Self::Key(number, direction) => Some((number, matches!(direction, Direction::Press))),
            Self::Button(button, direction) => {
                let number = match button {
                    Button::Left => 1,
                    Button::Middle => 2,
                    _ => 3,
                };
                Some((number, matches!(direction, Direction::Press)))
            }
            _ => None,
        }
    }
}

impl X11Writer {
    /// A writer on this connection. Without a record nobody knows what it holds when it is killed.
    pub(super) const fn new(
        connection: RustConnection,
        enigo: Option<Enigo>,
        display: String,
        record: Option<HeldRecord>,
    ) -> Self {
        Self { connection, enigo, display, record, down: Down::new(), question: None }
    }

    /// Writes one action after the other: the X server knows no groups. Keys are out when they are on their way: a server that is
    /// busy takes them in their order.
    pub(super) fn write(&mut self, actions: &[X11Action]) -> io::Result<()> {
        self.record_presses(actions)?;
        actions.iter().try_for_each(|action| self.perform(*action))?;
        self.ask_for_releases()?;
        self.connection.flush().map_err(|error| lost(&self.display, &error))?;
        while let Some(event) =
            self.connection.poll_for_event().map_err(|error| lost(&self.display, &error))?
        {
            if let Event::Error(error) = event {
                return Err(lost(&self.display, &ReplyError::X11Error(error)));
            }
        }
        Ok(())
    }

    /// Writes down what goes down before it does: there is no moment in which a key is down and in no record.
    fn record_presses(&mut self, actions: &[X11Action]) -> io::Result<()> {
        let Some(record) = &mut self.record else { return Ok(()) };
        if let Some(question) = self.question.take() {
            // A hand is slower than a server: the answer is there.
            self.connection.wait_for_reply(question).map_err(|error| lost(&self.display, &error))?;
        }
        let mut may_be_down = self.down.clone();
        for (number, is_pressed) in actions.iter().filter_map(|action| action.pressed()) {
            if is_pressed {
                may_be_down.insert(number);
                self.down.insert(number);
            } else {
                self.down.remove(&number);
            }
        }
        record.write(&may_be_down)
    }

    /// Asks a question behind releases: they stay in the record until they are done, as a server forgets what it has not read of
    /// a client that is gone.
    fn ask_for_releases(&mut self) -> io::Result<()> {
        if self.record.as_ref().is_some_and(|record| *record.written() != self.down) {
            let asked = self.connection.get_input_focus().map_err(|error| lost(&self.display, &error))?;
            self.question = Some(asked.sequence_number());
            // Dropped, it would take the answer away.
            std::mem::forget(asked);
        }
        Ok(())
    }

    fn perform(&mut self, action: X11Action) -> io::Result<()> {
        if let X11Action::Key(key, direction) = action {
            let kind = if direction == Direction::Press { KEY_PRESS_EVENT } else { KEY_RELEASE_EVENT };
            // Its errors come as events.
            return match self.connection.xtest_fake_input(
                kind,
                key,
                x11rb::CURRENT_TIME,
                x11rb::NONE,
                0,
                0,
                0,
            ) {
                Ok(_) => Ok(()),
                Err(error) => Err(lost(&self.display, &error)),
            };
        }
        if matches!(action, X11Action::Sync | X11Action::End) {
            self.connection.sync().map_err(|error| lost(&self.display, &error))?;
            if action == X11Action::End
                && let Some(record) = self.record.take()
            {
                record.remove();
            }
            return Ok(());
        }
        // Who has no pointer was refused before.
        let Some(enigo) = &mut self.enigo else { return Ok(()) };
        let done = match action {
            X11Action::Button(button, direction) => enigo.button(button, direction),
            X11Action::Across(share) => go_to(enigo, share, true),
            X11Action::Down(share) => go_to(enigo, share, false),
            X11Action::Move(right, down) => enigo.move_mouse(right, down, Coordinate::Rel),
            X11Action::Scroll(notches) => enigo.scroll(notches, Axis::Vertical),
            X11Action::Key(..) | X11Action::Sync | X11Action::End => Ok(()),
        };
        done.map_err(|error| lost(&self.display, &error))
    }
}

/// Puts the pointer to a share of the screen, across it or down; along the other side it stays where it is.
fn go_to(enigo: &mut Enigo, share: i32, is_across: bool) -> InputResult<()> {
    let ((width, height), (x, y)) = (enigo.main_display()?, enigo.location()?);
    // Share 1 is the first pixel, the last share is the last one.
    let pixel = |size: i32| {
        let way = i64::from(share - 1) * i64::from(size - 1) / i64::from(POINTER_PLACE_MAX - 1);
        i32::try_from(way).unwrap_or(0)
    };
    let (x, y) = if is_across { (pixel(width), y) } else { (x, pixel(height)) };
    enigo.move_mouse(x, y, Coordinate::Abs)
}

fn lost(place: &str, error: &impl fmt::Display) -> io::Error {
    io::Error::other(format!("X display {place} takes no events any more ({error}): start again"))
}
