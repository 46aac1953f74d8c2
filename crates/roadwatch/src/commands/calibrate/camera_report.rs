//! What was found of a lens, for people and programs.

use roadwatch_calibrate::{BoardViews, CameraCalibration};
use serde_json::{Value, json};

/// A share of the image below which a calibration says little about the rest.
const POOR_COVERAGE: f64 = 0.5;

pub(super) fn to_text(name: &str, found: &CameraCalibration, views: &BoardViews) -> String {
    let k = &found.model.intrinsics;
    let (lens, coefficients) = found.model.distortion.to_ros();
    let mut lines = vec![format!(
        "{} of {} pictures used",
        found.views.len(),
        found.views.len() + views.unused.len()
    )];
    for view in &found.views {
        lines.push(format!("  {:<24} {:.3} px", view.name, view.rms_px));
    }
    let named = [("fx", k.fx), ("fy", k.fy), ("cx", k.cx), ("cy", k.cy)];
    for (at, (key, value)) in named.into_iter().enumerate() {
        let std = found.std_px.map(|std| format!(" +- {:.3}", std[at]));
        lines.push(format!("{key}  {value:.3}{} px", std.unwrap_or_default()));
    }
    lines.push(format!("{lens}  {}", list(&coefficients)));
    lines.push(format!("reprojection error  {:.3} px (RMS)", found.rms_px));
    let coverage = 100.0 * found.coverage;
    let advice = if found.coverage < POOR_COVERAGE {
        ": show the board in the empty parts of the image too"
    } else {
        ""
    };
    lines.push(format!(
        "corners cover {coverage:.0} % of the image{advice}"
    ));
    let size = found.model.size;
    lines.push(format!(
        "\nto paste into a configuration or rig.toml, instead of camera_info:\n\n[[camera]]\nname = \"{name}\"\n\
         width = {}\nheight = {}\nfx = {:.4}\nfy = {:.4}\ncx = {:.4}\ncy = {:.4}\n\
         distortion_model = \"{lens}\"\ndistortion = [{}]",
        size.width_px,
        size.height_px,
        k.fx,
        k.fy,
        k.cx,
        k.cy,
        list(&coefficients)
    ));
    lines.join("\n")
}

fn list(numbers: &[f64]) -> String {
    let numbers: Vec<_> = numbers
        .iter()
        .map(|number| format!("{number:.6}"))
        .collect();
    numbers.join(", ")
}

pub(super) fn to_json(found: &CameraCalibration, views: &BoardViews) -> Value {
    let k = &found.model.intrinsics;
    let (lens, coefficients) = found.model.distortion.to_ros();
    let used = found.views.iter();
    let unused = views.unused.iter();
    json!({
        "width": found.model.size.width_px,
        "height": found.model.size.height_px,
        "fx": k.fx, "fy": k.fy, "cx": k.cx, "cy": k.cy,
        "std_px": found.std_px,
        "distortion_model": lens,
        "distortion": coefficients,
        "rms_px": found.rms_px,
        "coverage": found.coverage,
        "views": used.map(|v| json!({"name": v.name, "rms_px": v.rms_px})).collect::<Vec<_>>(),
        "unused": unused.map(|v| json!({"name": v.name, "why": v.why.to_string()})).collect::<Vec<_>>(),
    })
}
