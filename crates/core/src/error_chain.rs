//! An error with its causes, on one line.

use std::error::Error;

/// The error's text followed by its causes'. A cause that the text before it already ends with is not
/// said again.
#[must_use]
pub fn error_chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let said = error.to_string();
        if !text.ends_with(&said) {
            text = format!("{text}: {said}");
        }
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("{text}")]
    struct Layer {
        text: &'static str,
        source: Option<Box<Layer>>,
    }

    #[test]
    fn causes_follow_and_are_not_said_twice() {
        let layer = |text, source: Option<Layer>| Layer {
            text,
            source: source.map(Box::new),
        };
        let full = layer("disk full", None);
        let file = layer("a.csv: disk full", Some(full));
        let error = layer("not written", Some(file));
        assert_eq!(error_chain(&error), "not written: a.csv: disk full");
    }
}
