//! One module per command.

pub mod calibrate;
pub mod check;
pub mod collect;
pub mod evaluate;
pub mod export;
pub mod graph;
pub mod models;
mod output;
mod progress;
pub mod rotation;
pub mod run;
mod scoring;
mod signals;
pub mod study;
pub mod table;
