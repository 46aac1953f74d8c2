//! Reads a TOML document key by key, collecting every mistake instead of stopping at the first.

use super::{
    document::Document,
    values::{as_integer, as_number, as_numbers, nearest},
};
use std::{
    cell::RefCell,
    collections::BTreeSet,
    ops::{Range, RangeInclusive},
    path::PathBuf,
};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// One table of a document.
///
/// Each `…` method reads a key: `None` when it is absent, or wrong (then the mistake is noted).
/// [`Reader::finish`] notes every key that nobody read.
pub(super) struct Reader<'d, 'a> {
    document: &'d Document<'a>,
    table: Option<&'d DeTable<'a>>,
    span: Option<Range<usize>>,
    path: String,
    read: RefCell<BTreeSet<String>>,
}

impl<'d, 'a> Reader<'d, 'a> {
    /// A reader of the document's root table.
    #[must_use]
    pub(super) fn root(document: &'d Document<'a>, table: &'d Spanned<DeTable<'a>>) -> Self {
        Self {
            document,
            table: Some(table.get_ref()),
            span: None,
            path: String::new(),
            read: RefCell::default(),
        }
    }

    /// The document this table is of.
    #[must_use]
    pub(super) fn document(&self) -> &'d Document<'a> {
        self.document
    }

    /// This table's dotted key; empty for the root.
    #[must_use]
    pub(super) fn path_in_file(&self) -> &str {
        &self.path
    }

    /// Whether the table is there at all.
    #[must_use]
    pub(super) fn is_present(&self) -> bool {
        self.table.is_some()
    }

    /// Whether the key is there.
    #[must_use]
    pub(super) fn has(&self, key: &str) -> bool {
        self.table.is_some_and(|table| table.contains_key(key))
    }

    /// Whether the key is there and a text.
    #[must_use]
    pub(super) fn is_text(&self, key: &str) -> bool {
        self.value(key)
            .is_some_and(|value| value.get_ref().is_str())
    }

    /// Counts a key as known, whatever its value.
    pub(super) fn mark_read(&self, key: &str) {
        self.read.borrow_mut().insert(key.to_owned());
    }

    /// Notes a mistake at a key's value, or at the table's head when the key is absent.
    pub(super) fn note(&self, key: &str, what: impl Into<String>) {
        let at = self.value(key).map(Spanned::span).or(self.span.clone());
        self.document.note(at.as_ref(), &self.key(key), what);
    }

    /// A text.
    pub(super) fn text(&self, key: &str) -> Option<&'d str> {
        self.typed(key, "a text in quotes", DeValue::as_str)
    }

    /// A text that must be there.
    pub(super) fn required_text(&self, key: &str) -> Option<&'d str> {
        self.required(key, Self::text)
    }

    /// Yes or no.
    pub(super) fn flag(&self, key: &str) -> Option<bool> {
        self.typed(key, "true or false", DeValue::as_bool)
    }

    /// A number within a range.
    pub(super) fn number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let number = self.typed(key, "a number", as_number)?;
        self.in_range(key, number, &range)
    }

    /// A number that must be there.
    pub(super) fn required_number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        self.required(key, |reader, key| reader.number(key, range.clone()))
    }

    /// A whole number within a range.
    pub(super) fn integer(&self, key: &str, range: RangeInclusive<u32>) -> Option<u32> {
        let number = self.typed(key, "a whole number", as_integer)?;
        let range = f64::from(*range.start())..=f64::from(*range.end());
        // The range's ends fit `u32`, so what lies between does.
        self.in_range(key, number as f64, &range)
            .map(|number| number as u32)
    }

    /// A whole number that must be there.
    pub(super) fn required_integer(&self, key: &str, range: RangeInclusive<u32>) -> Option<u32> {
        self.required(key, |reader, key| reader.integer(key, range.clone()))
    }

    /// A list of `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Option<[f64; N]> {
        let what = format!("a list of {N} finite numbers");
        let list: Vec<f64> = self.typed(key, &what, as_numbers)?;
        let found = list.len();
        list.try_into()
            .map_err(|_| self.note(key, format!("expected {what}, found {found}")))
            .ok()
    }

    /// A list of any number of numbers.
    pub(super) fn number_list(&self, key: &str) -> Option<Vec<f64>> {
        self.typed(key, "a list of finite numbers", as_numbers)
    }

    /// A list of texts.
    pub(super) fn texts(&self, key: &str) -> Option<Vec<String>> {
        self.typed(key, "a list of texts in quotes", |value| {
            let texts = value.as_array()?.iter();
            texts
                .map(|text| text.get_ref().as_str().map(str::to_owned))
                .collect()
        })
    }

    /// One of a few words.
    pub(super) fn choice<T: Copy>(&self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        let text = self.text(key)?;
        let found = choices.iter().find(|(word, _)| *word == text);
        if found.is_none() {
            let words: Vec<_> = choices
                .iter()
                .map(|(word, _)| format!("`{word}`"))
                .collect();
            self.note(
                key,
                format!("`{text}` is unknown; choose {}", words.join(", ")),
            );
        }
        found.map(|&(_, value)| value)
    }

    /// A path, with its variable expanded; relative to the document's folder.
    pub(super) fn path(&self, key: &str) -> Option<PathBuf> {
        let text = self.text(key)?;
        let expanded = self
            .document
            .environment()
            .expand_path(text, self.document.folder());
        expanded.map_err(|what| self.note(key, what)).ok()
    }

    /// A path that must be there.
    pub(super) fn required_path(&self, key: &str) -> Option<PathBuf> {
        self.required(key, Self::path)
    }

    /// A table; one that is absent reads as empty.
    #[must_use]
    pub(super) fn table(&self, key: &str) -> Self {
        let table = self.typed(key, "a table", DeValue::as_table);
        self.inner(table, self.value(key).map(Spanned::span), self.key(key))
    }

    /// The tables of an array of tables, `[[key]]`; none when it is absent.
    pub(super) fn tables(&self, key: &str) -> Vec<Self> {
        let Some(list) = self.typed(key, "an array of tables, [[…]]", DeValue::as_array) else {
            return Vec::new();
        };
        let tables = list.iter().enumerate();
        tables
            .map(|(at, value)| {
                let path = format!("{}[{at}]", self.key(key));
                let table = value.get_ref().as_table();
                if table.is_none() {
                    self.document
                        .note(Some(&value.span()), &path, "expected a table");
                }
                self.inner(table, Some(value.span()), path)
            })
            .collect()
    }

    /// The keys of this table whose names are data, such as class names; they count as read.
    pub(super) fn keys(&self) -> Vec<&'d str> {
        let keys: Vec<&'d str> = match self.table {
            Some(table) => table.keys().map(|key| key.get_ref().as_ref()).collect(),
            None => Vec::new(),
        };
        self.read
            .borrow_mut()
            .extend(keys.iter().map(|&key| key.to_owned()));
        keys
    }

    /// Notes every key that nobody asked for.
    pub(super) fn finish(self) {
        let Some(table) = self.table else {
            return;
        };
        let read = self.read.borrow();
        for key in table.keys() {
            let name: &str = key.get_ref().as_ref();
            if !read.contains(name) {
                let what = match nearest(name, read.iter()) {
                    Some(near) => format!("unknown key; did you mean `{near}`?"),
                    None => {
                        let known: Vec<_> = read.iter().map(String::as_str).collect();
                        format!("unknown key; this table knows {}", known.join(", "))
                    }
                };
                self.document.note(Some(&key.span()), &self.key(name), what);
            }
        }
    }

    fn inner(
        &self,
        table: Option<&'d DeTable<'a>>,
        span: Option<Range<usize>>,
        path: String,
    ) -> Self {
        Self {
            document: self.document,
            table,
            span,
            path,
            read: RefCell::default(),
        }
    }

    fn value(&self, key: &str) -> Option<&'d Spanned<DeValue<'a>>> {
        self.table?.get(key)
    }

    fn key(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    fn typed<T>(
        &self,
        key: &str,
        expected: &str,
        read: impl FnOnce(&'d DeValue<'a>) -> Option<T>,
    ) -> Option<T> {
        self.read.borrow_mut().insert(key.to_owned());
        let value = self.value(key)?;
        let typed = read(value.get_ref());
        if typed.is_none() {
            let found = value.get_ref().type_str();
            self.note(key, format!("expected {expected}, found {found}"));
        }
        typed
    }

    fn required<T>(&self, key: &str, read: impl FnOnce(&Self, &str) -> Option<T>) -> Option<T> {
        if self.is_present() && !self.has(key) {
            self.read.borrow_mut().insert(key.to_owned());
            self.note(key, "missing");
            return None;
        }
        read(self, key)
    }

    fn in_range(&self, key: &str, number: f64, range: &RangeInclusive<f64>) -> Option<f64> {
        let fits = range.contains(&number);
        if !fits {
            let (least, most) = (range.start(), range.end());
            let what = if most.is_infinite() {
                format!("{number} is too small; the least is {least}")
            } else {
                format!("{number} is out of range; expected {least} to {most}")
            };
            self.note(key, what);
        }
        fits.then_some(number)
    }
}
