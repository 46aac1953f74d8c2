//! Shared set-up of the whole-daemon tests.
