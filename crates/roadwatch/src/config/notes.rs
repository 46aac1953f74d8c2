//! Where every key of a configuration stands, and what is wrong so far.

use super::mistake::{Mistake, Mistakes};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use toml::de::{DeTable, DeValue};

/// Lines of all keys, and the mistakes noted. Reading the file and opening what it names both add to it,
/// so that everything wrong is said at once.
#[derive(Debug, Clone)]
pub struct Notes {
    file: PathBuf,
    lines: BTreeMap<String, usize>,
    mistakes: Vec<Mistake>,
}

impl Notes {
    /// Notes on a parsed document.
    #[must_use]
    pub fn new(file: &Path, text: &str, root: &DeTable<'_>) -> Self {
        let mut lines = BTreeMap::new();
        find_lines(text, root, "", &mut lines);
        Self {
            file: file.to_owned(),
            lines,
            mistakes: Vec::new(),
        }
    }

    /// Adds mistakes found elsewhere.
    pub fn extend(&mut self, mistakes: Vec<Mistake>) {
        self.mistakes.extend(mistakes);
    }

    /// Notes a mistake about a dotted key. A key that is absent counts as standing at its nearest parent.
    pub fn note(&mut self, key: &str, what: impl Into<String>) {
        self.mistakes.push(Mistake {
            file: self.file.clone(),
            line: self.line(key),
            key: key.to_owned(),
            what: what.into(),
        });
    }

    /// # Errors
    /// The mistakes in order of their lines, when there are any.
    pub fn finish(mut self) -> Result<(), Mistakes> {
        if self.mistakes.is_empty() {
            return Ok(());
        }
        self.mistakes.sort_by_key(|mistake| mistake.line);
        Err(Mistakes(self.mistakes))
    }

    fn line(&self, key: &str) -> Option<usize> {
        let found = self.lines.get(key).copied();
        found.or_else(|| self.line(key.rsplit_once('.')?.0))
    }
}

fn find_lines(text: &str, table: &DeTable<'_>, path: &str, lines: &mut BTreeMap<String, usize>) {
    for (name, value) in table {
        let key = if path.is_empty() {
            name.get_ref().to_string()
        } else {
            format!("{path}.{}", name.get_ref())
        };
        lines.insert(key.clone(), line_at(text, name.span().start));
        match value.get_ref() {
            DeValue::Table(inner) => find_lines(text, inner, &key, lines),
            DeValue::Array(items) => {
                for (at, item) in items.iter().enumerate() {
                    let key = format!("{key}[{at}]");
                    lines.insert(key.clone(), line_at(text, item.span().start));
                    if let DeValue::Table(inner) = item.get_ref() {
                        find_lines(text, inner, &key, lines);
                    }
                }
            }
            _ => {}
        }
    }
}

/// The line of a byte, from 1.
pub(super) fn line_at(text: &str, byte: usize) -> usize {
    text.get(..byte).unwrap_or(text).matches('\n').count() + 1
}
