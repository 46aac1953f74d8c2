//! Offline work: datasets, tables, evaluation.
