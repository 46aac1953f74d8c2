//! How a camera was since the last look.

use super::pair;
use crate::config::DiagnosticLimits;
use roadwatch_pipeline::{CameraCounts, DropReason};
use roadwatch_ros::msg::diagnostic_msgs::{DiagnosticStatus, KeyValue};

/// What was counted of one camera between two looks.
pub(super) struct CameraPeriod {
    pub(super) now: CameraCounts,
    pub(super) before: CameraCounts,
    /// Length of the period; 0 at the first look.
    pub(super) secs: f64,
    /// Time since its last image.
    pub(super) silent_secs: f64,
    /// It is silent for too long.
    pub(super) gone: bool,
}

impl CameraPeriod {
    /// Level and message.
    pub(super) fn verdict(&self, limits: &DiagnosticLimits) -> (u8, String) {
        let captured_hz = self.captured_hz();
        let warn = |message: String| (DiagnosticStatus::WARN, message);
        if self.now.disconnected > self.before.disconnected {
            (
                DiagnosticStatus::ERROR,
                "disconnected, trying again".to_owned(),
            )
        } else if self.gone {
            (
                DiagnosticStatus::STALE,
                format!("no image for {:.0} s", self.silent_secs),
            )
        } else if self.now.lost > self.before.lost {
            warn("images are lost in the source".to_owned())
        } else if self.secs > 0.0 && captured_hz < limits.min_rate_hz {
            warn(format!("only {captured_hz:.1} images per second"))
        } else if self.drop_share() > limits.max_drop_share {
            warn(format!(
                "{:.0} % of images dropped",
                self.drop_share() * 100.0
            ))
        } else {
            (
                DiagnosticStatus::OK,
                format!("{captured_hz:.1} images per second"),
            )
        }
    }

    pub(super) fn values(&self) -> Vec<KeyValue> {
        let now = &self.now;
        let published_hz = self.rate(now.published, self.before.published);
        let mut values = vec![
            pair("captured_hz", format!("{:.2}", self.captured_hz())),
            pair("published_hz", format!("{published_hz:.2}")),
            pair("silent_s", format!("{:.1}", self.silent_secs)),
            pair("captured", now.captured),
            pair("published", now.published),
            pair("objects", now.objects),
            pair("lost_in_source", now.lost),
            pair("disconnected", now.disconnected),
            pair("without_headings", now.unrotated),
        ];
        let dropped = DropReason::ALL.iter();
        values.extend(dropped.map(|&reason| {
            let count = now.dropped[reason as usize];
            pair(&format!("dropped_{reason}"), count)
        }));
        values
    }

    fn captured_hz(&self) -> f64 {
        self.rate(self.now.captured, self.before.captured)
    }

    fn rate(&self, now: u64, before: u64) -> f64 {
        match self.secs > 0.0 {
            true => (now - before) as f64 / self.secs,
            false => 0.0,
        }
    }

    fn drop_share(&self) -> f64 {
        let taken = self.now.captured - self.before.captured;
        let dropped = self.now.dropped_total() - self.before.dropped_total();
        match taken {
            0 => 0.0,
            taken => dropped as f64 / taken as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    const LIMITS: DiagnosticLimits = DiagnosticLimits {
        stale_after: Duration::from_secs(1),
        min_rate_hz: 5.0,
        max_drop_share: 0.5,
        max_latency: Duration::from_millis(500),
    };

    /// One second with ten images.
    fn good() -> CameraPeriod {
        CameraPeriod {
            now: CameraCounts {
                captured: 30,
                published: 28,
                ..CameraCounts::default()
            },
            before: CameraCounts {
                captured: 20,
                published: 19,
                ..CameraCounts::default()
            },
            secs: 1.0,
            silent_secs: 0.1,
            gone: false,
        }
    }

    #[test]
    fn each_trouble_has_its_level_and_says_what_it_is() {
        let ok = (DiagnosticStatus::OK, "10.0 images per second".to_owned());
        assert_eq!(good().verdict(&LIMITS), ok);
        let verdict = |change: fn(&mut CameraPeriod)| {
            let mut period = good();
            change(&mut period);
            period.verdict(&LIMITS)
        };
        let (level, said) = verdict(|period| period.now.captured = 23);
        assert_eq!(
            (level, said.as_str()),
            (DiagnosticStatus::WARN, "only 3.0 images per second")
        );
        let (level, said) = verdict(|period| period.now.dropped[0] = 6);
        assert_eq!(
            (level, said.as_str()),
            (DiagnosticStatus::WARN, "60 % of images dropped")
        );
        assert_eq!(
            verdict(|period| period.now.lost = 1).0,
            DiagnosticStatus::WARN
        );
        assert_eq!(
            verdict(|period| period.gone = true).0,
            DiagnosticStatus::STALE
        );
        assert_eq!(
            verdict(|period| period.now.disconnected = 1).0,
            DiagnosticStatus::ERROR
        );
    }

    #[test]
    fn what_is_told_is_what_was_counted() {
        let values = good().values();
        let value = |key: &str| {
            values
                .iter()
                .find(|pair| pair.key == key)
                .map(|pair| pair.value.as_str())
        };
        assert_eq!(value("captured_hz"), Some("10.00"));
        assert_eq!(value("published_hz"), Some("9.00"));
        assert_eq!(value("dropped_replaced"), Some("0"));
        assert_eq!(value("captured"), Some("30"));
    }
}
