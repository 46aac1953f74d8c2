//! `roadwatch calibrate rotation`.

use crate::{
    cli::CalibrateRotationArgs,
    commands::{output::say, rotation::read_forest},
    failure::Failure,
};
use anyhow::Context as _;
use roadwatch_lab::draw_position_curve;
use roadwatch_rotate::{PositionCurve, RowTable};
use serde_json::json;

/// Fits the paper's position curve.
///
/// # Errors
/// Files that cannot be used or written, too few rows at that distance.
pub fn run(args: &CalibrateRotationArgs) -> Result<(), Failure> {
    let table = RowTable::read(&args.rows)
        .with_context(|| format!("`{}` cannot be used", args.rows.display()))?;
    let forest = read_forest(&args.forest, &table)?;
    let fitted = PositionCurve::fit(&table, &forest, (args.loc_y_m, args.within_m));
    let (curve, biases) = fitted.context("no curve")?;
    if args.json {
        say!("{:#}", json!(curve));
    } else {
        say!("{}", text(&curve));
    }
    if let Some(file) = &args.out {
        curve.write(file).map_err(anyhow::Error::from)?;
        eprintln!("written: {}", file.display());
    }
    if let Some(file) = &args.picture {
        draw_position_curve(&curve, &biases, file).map_err(anyhow::Error::from)?;
        eprintln!("written: {}", file.display());
    }
    Ok(())
}

fn text(curve: &PositionCurve) -> String {
    let [least, greatest] = curve.loc_x_m;
    let bias = |loc_x_m: f64| -curve.ray(loc_x_m).radians().to_degrees();
    let exact = |loc_x_m: f64| (loc_x_m / curve.loc_y_m).atan().to_degrees();
    let mut lines = vec![
        format!(
            "{} rows {} m ahead, LocX {least:.1} to {greatest:.1} m; {} more turned round and left out",
            curve.rows, curve.loc_y_m, curve.turned_round
        ),
        format!(
            "rows stray by {:.1} degrees (RMS, outliers weighted down)",
            curve.rms_deg
        ),
        "LocX, m   bias   atan(LocX / LocY), degrees".to_owned(),
    ];
    for at in [least, least / 2.0, 0.0, greatest / 2.0, greatest] {
        lines.push(format!("{at:>7.1} {:>6.1} {:>6.1}", bias(at), exact(at)));
    }
    lines.join("\n")
}
