//! Progress of long work: a bar on a terminal, plain lines elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal as _, stderr};

/// A plain line comes each time this share more is done, percent.
const LINE_EVERY_PERCENT: u64 = 20;

pub(super) struct Progress {
    bar: ProgressBar,
    unit: &'static str,
    is_terminal: bool,
    said_percent: u64,
}

impl Progress {
    /// Nothing of `total` is done yet.
    pub(super) fn new(total: u64, unit: &'static str) -> Self {
        let template = format!("{{bar:40}} {{pos}}/{{len}} {unit}, {{eta}} left");
        let style = ProgressStyle::with_template(&template);
        Self {
            bar: ProgressBar::new(total)
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())),
            unit,
            is_terminal: stderr().is_terminal(),
            said_percent: 0,
        }
    }

    pub(super) fn set(&mut self, done: u64) {
        self.bar.set_position(done);
        let total = self.bar.length().unwrap_or_default().max(1);
        let percent = done * 100 / total;
        if !self.is_terminal && percent >= self.said_percent + LINE_EVERY_PERCENT {
            self.said_percent = percent - percent % LINE_EVERY_PERCENT;
            eprintln!("{done}/{total} {}", self.unit);
        }
    }

    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
    }
}
