//! Real-time multi-camera perception daemon.
