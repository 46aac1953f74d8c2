//! The text of a configuration, what stands in the place of its values, and what is wrong with it.

use super::{
    environment::Environment,
    mistake::{Mistake, Mistakes},
    notes::line_at,
};
use std::{cell::RefCell, ops::Range, path::Path};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// Where values stand that are not in the text.
const ELSEWHERE: Range<usize> = usize::MAX..usize::MAX;

/// One document: its text, its place, and the mistakes found in it so far.
pub(super) struct Document<'a> {
    file: &'a Path,
    text: &'a str,
    /// More TOML, whose values stand in the place of the text's.
    overrides: &'a str,
    environment: &'a Environment,
    mistakes: RefCell<Vec<Mistake>>,
}

impl<'a> Document<'a> {
    /// A document without mistakes yet.
    #[must_use]
    pub(super) fn new(
        file: &'a Path,
        (text, overrides): (&'a str, &'a str),
        environment: &'a Environment,
    ) -> Self {
        Self {
            file,
            text,
            overrides,
            environment,
            mistakes: RefCell::default(),
        }
    }

    /// The parsed document, with the overrides in it.
    ///
    /// # Errors
    /// When the text is not TOML: nothing further can be said then.
    pub(super) fn parse(&self) -> Result<Spanned<DeTable<'a>>, Mistakes> {
        let mut table = self.parse_text(self.text)?;
        let overrides = self.parse_text(self.overrides)?.into_inner();
        put_over(table.get_mut(), overrides);
        Ok(table)
    }

    fn parse_text(&self, text: &'a str) -> Result<Spanned<DeTable<'a>>, Mistakes> {
        DeTable::parse(text).map_err(|error| {
            Mistakes(vec![Mistake {
                file: self.file.to_owned(),
                line: error.span().map(|span| line_at(text, span.start)),
                key: String::new(),
                what: format!("not valid TOML: {}", error.message()),
            }])
        })
    }

    /// Where the environment can be asked.
    #[must_use]
    pub(super) fn environment(&self) -> &'a Environment {
        self.environment
    }

    /// Notes a mistake at a place in the text, or about the whole file with `None`.
    pub(super) fn note(&self, at: Option<&Range<usize>>, key: &str, what: impl Into<String>) {
        self.mistakes.borrow_mut().push(Mistake {
            file: self.file.to_owned(),
            line: at
                .filter(|span| **span != ELSEWHERE)
                .map(|span| self.line(span)),
            key: key.to_owned(),
            what: what.into(),
        });
    }

    /// The mistakes, in the order they were found.
    #[must_use]
    pub(super) fn into_mistakes(self) -> Vec<Mistake> {
        self.mistakes.into_inner()
    }

    fn line(&self, span: &Range<usize>) -> usize {
        line_at(self.text, span.start)
    }

    pub(super) fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }
}

/// Puts `values` in the place of those of `table`, table by table.
fn put_over<'a>(table: &mut DeTable<'a>, values: DeTable<'a>) {
    for (key, value) in values {
        let mut value = Spanned::new(ELSEWHERE, value.into_inner());
        if let DeValue::Table(inner) = value.get_mut() {
            let inner = std::mem::take(inner);
            let known = table.get_mut(key.get_ref().as_ref()).map(Spanned::get_mut);
            let mut merged = match known {
                Some(DeValue::Table(known)) => std::mem::take(known),
                _ => DeTable::new(),
            };
            put_over(&mut merged, inner);
            *value.get_mut() = DeValue::Table(merged);
        }
        table.insert(Spanned::new(ELSEWHERE, key.into_inner()), value);
    }
}
