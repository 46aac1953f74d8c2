//! `[diagnostics]`: from when on the daemon says that something is wrong.

use super::reader::Reader;
use std::time::Duration;

/// As long as the pipeline waits before it takes a camera for gone.
const DEFAULT_STALE_AFTER_SECS: f64 = 1.0;
/// Of a camera that loses every second image the objects are still seen; beyond that it is worth a look.
const DEFAULT_MAX_DROP_SHARE: f64 = 0.5;
/// Half a second at 50 km/h is seven metres.
const DEFAULT_MAX_LATENCY_MS: f64 = 500.0;

/// From when on something is wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnosticLimits {
    /// A camera without an image for this long is stale.
    pub stale_after: Duration,
    /// A camera with fewer images per second is warned of; 0 for none.
    pub min_rate_hz: f64,
    /// A camera of whose images a larger share is dropped is warned of.
    pub max_drop_share: f64,
    /// A pipeline whose slowest hundredth takes longer is warned of.
    pub max_latency: Duration,
}

pub(super) fn read(limits: &Reader<'_, '_>) -> DiagnosticLimits {
    let number = |key, range, default| limits.number(key, range).unwrap_or(default);
    let stale = number("stale_after_secs", 0.1..=3600.0, DEFAULT_STALE_AFTER_SECS);
    let latency = number("max_latency_ms", 1.0..=60_000.0, DEFAULT_MAX_LATENCY_MS);
    DiagnosticLimits {
        stale_after: Duration::from_secs_f64(stale),
        min_rate_hz: number("min_rate_hz", 0.0..=1000.0, 0.0),
        max_drop_share: number("max_drop_share", 0.0..=1.0, DEFAULT_MAX_DROP_SHARE),
        max_latency: Duration::from_secs_f64(latency / 1e3),
    }
}
