//! What was found of a mount, for people, programs and files.

use roadwatch_calibrate::{DriveFit, DriveOptions, MountEstimate, Trust};
use roadwatch_core::{Mount, RigCamera};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A camera's mount, before and after.
pub(super) struct MountReport {
    camera: RigCamera,
    ground_z_m: f64,
    estimate: MountEstimate,
    notes: Vec<String>,
    drive: Option<Value>,
    /// Sizes of what the fit leaves unexplained, pixels.
    pub(super) residuals_px: Vec<f64>,
}

impl MountReport {
    pub(super) fn new(camera: &RigCamera, ground_z_m: f64, estimate: MountEstimate) -> Self {
        Self {
            camera: camera.clone(),
            ground_z_m,
            estimate,
            notes: Vec::new(),
            drive: None,
            residuals_px: Vec::new(),
        }
    }

    pub(super) fn note(&mut self, line: String) {
        self.notes.push(line);
    }

    pub(super) fn ground_z_m(&self) -> f64 {
        self.ground_z_m
    }

    /// What a drive said, and what had to be believed.
    pub(super) fn describe_drive(&mut self, fit: &DriveFit, options: &DriveOptions) {
        let [before, after] = fit.disagreement.map(|share| 100.0 * share);
        self.note(format!("{} boxes of {} objects", fit.boxes, fit.tracks));
        self.note(format!(
            "distances by height and by bottom edge disagree by {after:.1} % (median), {before:.1} % before"
        ));
        self.note(match options.trust {
            Trust::Sizes => format!(
                "height is as good as the mean size of classes, which is trusted to {:.1} %",
                100.0 * options.mean_size_std
            ),
            Trust::Height => format!(
                "height was trusted; objects are {:.3} times as high as their classes, give or take {:.3}",
                fit.size_ratio.0,
                fit.size_ratio.1.unwrap_or(0.0)
            ),
        });
        if self.estimate.std.roll_rad.is_none() {
            self.note("roll was held: objects on both sides of the image would tell it".to_owned());
        }
        self.drive = Some(json!({
            "boxes": fit.boxes,
            "objects": fit.tracks,
            "size_ratio": fit.size_ratio.0,
            "size_ratio_std": fit.size_ratio.1,
            "disagreement_before": fit.disagreement[0],
            "disagreement_after": fit.disagreement[1],
        }));
    }

    /// The camera with the mount that was found.
    pub(super) fn camera_after(&self) -> RigCamera {
        RigCamera {
            base_from_optical: self.estimate.mount.base_from_optical(),
            ..self.camera.clone()
        }
    }

    fn before(&self) -> Mount {
        Mount::of(&self.camera.base_from_optical)
    }

    fn rms_px(&self) -> Option<f64> {
        let count = self.residuals_px.len();
        let squares: f64 = self.residuals_px.iter().map(|r| r * r).sum();
        (count > 0).then(|| (squares / count as f64).sqrt())
    }

    pub(super) fn to_text(&self) -> String {
        let (before, after) = (self.before(), self.estimate.mount);
        let std = &self.estimate.std;
        let mut text = format!("camera {}\n", self.camera.name);
        let mut line = |name: &str, [was, is]: [f64; 2], std: Option<f64>, (unit, digits)| {
            let sure = std.map_or_else(
                || "held".to_owned(),
                |std| format!("+- {std:.digits$} {unit}"),
            );
            // Writing into a text cannot fail.
            let written = writeln!(
                text,
                "  {name:<7}{is:>9.digits$} {unit:<4} {sure:<14} was {was:.digits$}"
            );
            debug_assert!(written.is_ok());
        };
        let metres = ("m", 3);
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let both = [before.position_m[axis], after.position_m[axis]];
            line(name, both, std.position_m[axis], metres);
        }
        let heights = [before, after].map(|mount| mount.position_m[2] - self.ground_z_m);
        line("height", heights, std.position_m[2], metres);
        for (name, was, is, std) in [
            ("yaw", before.yaw_rad, after.yaw_rad, std.yaw_rad),
            ("pitch", before.pitch_rad, after.pitch_rad, std.pitch_rad),
            ("roll", before.roll_rad, after.roll_rad, std.roll_rad),
        ] {
            let degrees = [was, is].map(f64::to_degrees);
            line(name, degrees, std.map(f64::to_degrees), ("deg", 3));
        }
        let rms = self
            .rms_px()
            .map(|rms| format!("residuals {rms:.2} px (RMS)"));
        for note in rms.iter().chain(&self.notes) {
            text.push_str("  ");
            text.push_str(note);
            text.push('\n');
        }
        text
    }

    /// The camera's keys in `rig.toml`.
    pub(super) fn to_toml(&self) -> String {
        let [x, y, z] = self.estimate.mount.position_m;
        let [w, i, j, k] = self.wxyz();
        format!(
            "[[camera]]\nname = \"{}\"\nposition_m = [{x:.4}, {y:.4}, {z:.4}]\n\
             orientation_wxyz = [{w:.7}, {i:.7}, {j:.7}, {k:.7}]\n",
            self.camera.name
        )
    }

    fn wxyz(&self) -> [f64; 4] {
        let base_from_optical = self.estimate.mount.base_from_optical();
        let q = base_from_optical.isometry.rotation;
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        [q.w, q.i, q.j, q.k].map(|part| sign * part)
    }

    pub(super) fn to_json(&self) -> Value {
        let (before, after) = (self.before(), self.estimate.mount);
        let std = &self.estimate.std;
        let angles = |mount: &Mount| {
            json!({
                "height_m": mount.position_m[2] - self.ground_z_m,
                "pitch_deg": mount.pitch_rad.to_degrees(),
                "roll_deg": mount.roll_rad.to_degrees(),
                "yaw_deg": mount.yaw_rad.to_degrees(),
            })
        };
        json!({
            "camera": self.camera.name.as_str(),
            "before": angles(&before),
            "after": angles(&after),
            "std": {
                "position_m": std.position_m,
                "height_m": std.position_m[2],
                "pitch_deg": std.pitch_rad.map(f64::to_degrees),
                "roll_deg": std.roll_rad.map(f64::to_degrees),
                "yaw_deg": std.yaw_rad.map(f64::to_degrees),
            },
            "position_m": after.position_m,
            "orientation_wxyz": self.wxyz(),
            "residual_rms_px": self.rms_px(),
            "residuals_px": self.residuals_px,
            "drive": self.drive,
        })
    }
}
