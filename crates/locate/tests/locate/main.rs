//! What this crate promises to its callers: one file per promise.

mod common;
mod contract;
mod fused;
mod table_accuracy;
mod table_answers;
mod table_files;
mod table_index;
