//! Whether it is known where the vehicle is.

use super::pair;
use crate::session::Session;
use roadwatch_core::{EgoMotion, Timestamp, ego::EgoCounts};
use roadwatch_ros::msg::diagnostic_msgs::{DiagnosticStatus, KeyValue};
use std::sync::Arc;

/// Who tells where the vehicle is, and what was told when it was looked at last.
#[derive(Debug)]
pub(super) struct EgoWatch {
    motion: Arc<EgoMotion>,
    before: EgoCounts,
    /// `None` when nobody tells.
    told_by: Option<String>,
    /// Whether that is a topic, which may fall silent.
    is_live: bool,
}

impl EgoWatch {
    pub(super) fn of(session: &Session) -> Self {
        let (config, counts) = (&session.config.ego, session.ego.counts());
        Self {
            motion: Arc::clone(&session.ego),
            // What was recorded was told before anybody looks, its mistakes with it.
            before: counts,
            told_by: config.told_by(counts.taken > 0),
            is_live: config.is_live(),
        }
    }

    /// Level, message and values. To be asked once a second, so that odometry that stops is noticed.
    pub(super) fn look(&mut self, now: Timestamp) -> (u8, String, Vec<KeyValue>) {
        let counts = self.motion.counts();
        let before = std::mem::replace(&mut self.before, counts);
        let by = self.told_by.as_deref();
        let (level, message) = verdict(by, self.is_live, (before, counts));
        let mut values = vec![
            pair("source", by.unwrap_or("nobody")),
            pair("taken", counts.taken),
            pair("refused", counts.refused),
            pair("jumps", counts.jumps),
            pair("restarts", counts.restarts),
        ];
        let newest = self.motion.newest().filter(|_| self.is_live);
        values.extend(newest.map(|newest| pair("age_s", format!("{:.3}", secs(newest, now)))));
        (level, message, values)
    }
}

/// From one moment to another; below zero when that was earlier.
fn secs(from: Timestamp, to: Timestamp) -> f64 {
    match to >= from {
        true => to.saturating_since(from).as_secs_f64(),
        false => -from.saturating_since(to).as_secs_f64(),
    }
}

fn verdict(
    told_by: Option<&str>,
    is_live: bool,
    (before, now): (EgoCounts, EgoCounts),
) -> (u8, String) {
    let Some(by) = told_by else {
        return (DiagnosticStatus::OK, "nobody tells it".to_owned());
    };
    let odd = |counts: EgoCounts| counts.refused + counts.jumps;
    if odd(now) > odd(before) {
        return (DiagnosticStatus::WARN, format!("{by} tells what cannot be"));
    }
    if is_live && now.taken == before.taken {
        let message = match now.taken {
            0 => format!("{by} has told nothing yet"),
            _ => format!("{by} tells nothing any more"),
        };
        return (DiagnosticStatus::WARN, message);
    }
    (DiagnosticStatus::OK, format!("told by {by}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(taken: u64, refused: u64) -> EgoCounts {
        EgoCounts {
            taken,
            refused,
            ..EgoCounts::default()
        }
    }

    #[test]
    fn what_is_silent_or_tells_what_cannot_be_is_warned_of() {
        let (ok, warn) = (DiagnosticStatus::OK, DiagnosticStatus::WARN);
        let expected = [
            (
                true,
                counts(0, 0),
                counts(0, 0),
                warn,
                "has told nothing yet",
            ),
            (true, counts(0, 0), counts(9, 0), ok, "told by the topic"),
            (
                true,
                counts(9, 0),
                counts(9, 0),
                warn,
                "tells nothing any more",
            ),
            (
                true,
                counts(9, 0),
                counts(9, 9),
                warn,
                "tells what cannot be",
            ),
            (
                true,
                counts(9, 0),
                counts(18, 1),
                warn,
                "tells what cannot be",
            ),
            (true, counts(9, 9), counts(18, 9), ok, "told by the topic"),
            (false, counts(9, 0), counts(9, 0), ok, "told by the topic"),
        ];
        for (is_live, before, now, level, words) in expected {
            let (found, message) = verdict(Some("the topic /odom"), is_live, (before, now));
            assert!(found == level && message.contains(words), "{message}");
        }
        let (level, message) = verdict(None, false, (counts(0, 0), counts(0, 0)));
        assert!(level == ok && message == "nobody tells it");
    }
}
