//! `roadwatch calibrate mount`.

use super::{drive_boxes, mount_report::MountReport, still};
use crate::{
    cli::{BoxesFrom, CalibrateMountArgs, SolvedPart, TrustedPart},
    commands::output::say,
    config::{Changes, Config, Environment},
    failure::Failure,
};
use anyhow::{Context as _, anyhow};
use roadwatch_calibrate::{
    DriveOptions, GroundPoint, LineSegment, Solve, Trust, mount_from_drive, mount_from_lines,
    mount_from_points, read_lines, read_points,
};
use roadwatch_camera::read_rig_file;
use roadwatch_core::{Mount, Pixels, RigCamera};
use roadwatch_locate::BoxNoise;
use roadwatch_picture::{MountEvidence, SeenAndPut, mount_view};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// How far the mean of hulls may be from that of bodies whose size is labelled, as a share.
const LABEL_SHAPE_STD: f64 = 0.015;
/// Labels are exact to about a pixel; what remains is how well a hull stands for a car.
const LABEL_NOISE: BoxNoise = BoxNoise {
    edge_px: 0.7,
    edge_share_of_height: 0.01,
};

/// Finds mounts and prints the keys to paste.
///
/// # Errors
/// Mistakes in files and configuration, or evidence that determines no mount.
pub fn run(args: &CalibrateMountArgs) -> Result<(), Failure> {
    let reports = if let Some(drive) = &args.drive {
        from_drive(args, drive)?
    } else {
        let (camera, ground_z_m) = camera(args)?;
        let report = if let Some(file) = &args.points {
            from_points(args, (&camera, ground_z_m), file)
        } else {
            let file = args.lines.as_deref().context("--lines is missing")?;
            from_lines(args, (&camera, ground_z_m), file)
        };
        vec![report?]
    };
    if args.json {
        let all: Vec<Value> = reports.iter().map(MountReport::to_json).collect();
        say!("{:#}", Value::Array(all));
        return Ok(());
    }
    for report in &reports {
        say!("{}", report.to_text());
    }
    say!("to paste into rig.toml, or into [[camera]] tables with intrinsics:\n");
    for report in &reports {
        say!("{}", report.to_toml());
    }
    Ok(())
}

/// The camera as it is set now, and the ground's height.
fn camera(args: &CalibrateMountArgs) -> Result<(RigCamera, f64), Failure> {
    let name = args.camera.as_deref().context("--camera is missing")?;
    let (cameras, ground_z_m) = match (&args.rig, &args.config) {
        (Some(rig), _) => (read_rig_file(rig).map_err(anyhow::Error::from)?, 0.0),
        (None, Some(config)) => {
            let config = Config::load(config, &Changes::default(), &Environment::of_process())?;
            config.notes.clone().finish()?;
            let rig = config.rig.context("the configuration has no rig")?.rig;
            (rig.cameras().to_vec(), rig.ground_z_m)
        }
        (None, None) => return Err(anyhow!("--rig or --config is missing").into()),
    };
    let known: Vec<_> = cameras.iter().map(|c| c.name.to_string()).collect();
    let found = cameras.into_iter().find(|c| c.name.as_str() == name);
    let found = found.ok_or_else(|| {
        anyhow!(
            "no camera is called `{name}`; the rig has {}",
            known.join(", ")
        )
    })?;
    Ok((found, args.ground_z_m.unwrap_or(ground_z_m)))
}

fn from_points(
    args: &CalibrateMountArgs,
    (camera, ground_z_m): (&RigCamera, f64),
    file: &Path,
) -> Result<MountReport, anyhow::Error> {
    let points = read_points(file, ground_z_m)?;
    let solve = match args.solve {
        SolvedPart::Angles => Solve::Angles,
        SolvedPart::Height => Solve::Height,
        SolvedPart::Position => Solve::Position,
    };
    let start = Mount::of(&camera.base_from_optical);
    let fit = mount_from_points(&camera.model, &start, &points, solve)
        .with_context(|| file.display().to_string())?;
    let mut report = MountReport::new(camera, ground_z_m, fit.estimate);
    let residuals = points.iter().zip(&fit.residuals_px);
    for (point, residual) in residuals.clone() {
        report.note(format!(
            "line {}: ({:.1}, {:.1}) is put {:.2} px off",
            point.line,
            point.pixel.x,
            point.pixel.y,
            residual.norm()
        ));
    }
    report.residuals_px = fit.residuals_px.iter().map(|r| r.norm()).collect();
    let put = |(point, by): (&GroundPoint, &nalgebra::Vector2<f64>)| SeenAndPut {
        seen: point.pixel,
        put: point.pixel + by,
    };
    let evidence = MountEvidence {
        points: residuals.map(put).collect(),
        ..MountEvidence::default()
    };
    draw_still(args, camera, &report, &evidence)?;
    Ok(report)
}

fn from_lines(
    args: &CalibrateMountArgs,
    (camera, ground_z_m): (&RigCamera, f64),
    file: &Path,
) -> Result<MountReport, anyhow::Error> {
    let segments = read_lines(file)?;
    let start = Mount::of(&camera.base_from_optical);
    let lane = (args.lane_width_m, ground_z_m);
    let fit = mount_from_lines(&camera.model, &start, &segments, lane)
        .with_context(|| file.display().to_string())?;
    let mut report = MountReport::new(camera, ground_z_m, fit.estimate);
    if let Some(at) = fit.vanishing_point {
        report.note(format!("lines meet at ({:.1}, {:.1}) px", at.x, at.y));
    }
    report.note("roll was held: one vanishing point says nothing about it".to_owned());
    report.residuals_px = fit.residuals_px.iter().map(|r| r.abs()).collect();
    let evidence = MountEvidence {
        segments: segments
            .iter()
            .map(|LineSegment { ends, .. }| *ends)
            .collect(),
        ..MountEvidence::default()
    };
    draw_still(args, camera, &report, &evidence)?;
    Ok(report)
}

fn from_drive(args: &CalibrateMountArgs, drive: &Path) -> Result<Vec<MountReport>, Failure> {
    let config = args.config.as_deref().context("--config is missing")?;
    let seen = drive_boxes::collect(args, drive, config)?;
    let options = DriveOptions {
        trust: match args.trust {
            TrustedPart::Sizes => Trust::Sizes,
            TrustedPart::Height => Trust::Height,
        },
        noise: match args.boxes {
            BoxesFrom::Detector => seen.box_noise,
            BoxesFrom::Truth => LABEL_NOISE,
        },
        slope_std_rad: DriveOptions::SLOPE_STD_RAD,
        mean_size_std: match args.boxes {
            BoxesFrom::Detector => DriveOptions::MEAN_SIZE_STD,
            BoxesFrom::Truth => LABEL_SHAPE_STD,
        },
    };
    let ground_z_m = args.ground_z_m.unwrap_or(seen.ground_z_m);
    let mut reports = Vec::new();
    let mut refused = Vec::new();
    for camera in &seen.cameras {
        let sightings = &camera.sightings;
        eprintln!("{}: {}", camera.camera.name, sightings.left_out());
        match mount_from_drive(&camera.camera, ground_z_m, sightings, &options) {
            Ok(fit) => {
                let mut report = MountReport::new(&camera.camera, ground_z_m, fit.estimate);
                report.describe_drive(&fit, &options);
                draw_drive(args, camera, &report, seen.cameras.len())?;
                reports.push(report);
            }
            Err(error) => refused.push(format!("camera {}: {error}", camera.camera.name)),
        }
    }
    if reports.is_empty() {
        return Err(anyhow!("{}", refused.join("\n")).into());
    }
    for line in refused {
        eprintln!("{line}");
    }
    Ok(reports)
}

fn draw_still(
    args: &CalibrateMountArgs,
    before: &RigCamera,
    report: &MountReport,
    evidence: &MountEvidence,
) -> Result<(), anyhow::Error> {
    let Some(file) = &args.picture else {
        return Ok(());
    };
    let image = args.image.as_deref();
    let image = image.context("--picture needs --image FILE, an image of the camera")?;
    let image = still::read(image)?;
    let (found, expected) = (image.size(), before.model.size);
    if found != expected {
        return Err(anyhow!("--image is {found}, the camera's are {expected}"));
    }
    draw(file, &image, (before, report), evidence)
}

fn draw_drive(
    args: &CalibrateMountArgs,
    camera: &drive_boxes::CameraBoxes,
    report: &MountReport,
    cameras: usize,
) -> Result<(), anyhow::Error> {
    let Some(file) = &args.picture else {
        return Ok(());
    };
    let name = camera.camera.name.as_str();
    let file = if cameras > 1 {
        with_name(file, name)
    } else {
        file.clone()
    };
    let Some((image, boxes)) = camera.fullest_frame()? else {
        return Ok(());
    };
    let evidence = MountEvidence {
        boxes,
        ..MountEvidence::default()
    };
    draw(&file, &image, (&camera.camera, report), &evidence)
}

fn draw(
    file: &Path,
    image: &Pixels,
    (before, report): (&RigCamera, &MountReport),
    evidence: &MountEvidence,
) -> Result<(), anyhow::Error> {
    let after = report.camera_after();
    let view = mount_view(image, [before, &after], report.ground_z_m(), evidence)?;
    view.write(file)?;
    eprintln!("written: {}", file.display());
    Ok(())
}

/// `mount.png` of camera `left` is `mount_left.png`.
fn with_name(file: &Path, camera: &str) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let extension = file.extension().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}_{camera}.{extension}"))
}
