//! Models by name: a fetched one is whole and the right one, or it is not there, whatever the server does.

mod bench;
mod command;
mod refusal;
mod resume;
mod server;
#[path = "../support/mod.rs"]
mod support;
