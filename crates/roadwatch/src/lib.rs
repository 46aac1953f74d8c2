//! The daemon: configuration, wiring, command line. `main.rs` only hands over its arguments.

pub mod cli;
pub mod clock;
pub mod commands;
pub mod config;
pub mod failure;
pub mod models;
pub mod node;
pub mod open;
pub mod session;
pub mod status;
pub mod switches;

pub use cli::main_with;
