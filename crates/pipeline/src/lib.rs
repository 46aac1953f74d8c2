//! Mailbox, stage runner, topology, and counters and latencies per edge.
