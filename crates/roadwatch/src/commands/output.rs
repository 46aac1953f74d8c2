//! Standard output of the commands.

use crate::failure::Failure;
use anyhow::Context as _;
use std::io::{self, ErrorKind, Write as _};

/// Prints a text and a line's end. A reader that went away (`| head`) is no failure.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let written = writeln!(out, "{text}").and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written.context("standard output cannot be written")?),
    }
}

/// `println!`, but a reader that went away is no panic. For functions that return [`Failure`].
macro_rules! say {
    ($($text:tt)*) => {
        crate::commands::output::print(&format!($($text)*))?
    };
}

pub(super) use say;
