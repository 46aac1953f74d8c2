//! `roadwatch calibrate camera`.

use super::{board_pictures, camera_report};
use crate::{cli::CalibrateCameraArgs, commands::output::say, failure::Failure};
use anyhow::{Context as _, anyhow};
use roadwatch_calibrate::{Board, BoardKind, BoardViews, CameraCalibration, Lens, calibrate};
use roadwatch_camera::CameraInfo;
use roadwatch_picture::{SeenAndPut, corners_view};
use std::{collections::BTreeMap, fs, path::Path};

const DEFAULT_NAME: &str = "camera";

/// Calibrates a camera from pictures of a board.
///
/// # Errors
/// When pictures cannot be read, show no board, or give no possible camera.
pub fn run(args: &CalibrateCameraArgs) -> Result<(), Failure> {
    let board = board(args)?;
    let (mut views, shown) = board_pictures::look(args, board)?;
    let lens = if args.fisheye {
        Lens::Equidistant
    } else {
        Lens::PlumbBob
    };
    let found = calibrate(board, &mut views, lens);
    say_unused(args, &views);
    let found = found.map_err(anyhow::Error::from)?;
    let name = args.camera.as_deref().unwrap_or(DEFAULT_NAME);
    if args.json {
        say!("{:#}", camera_report::to_json(&found, &views));
    } else {
        say!("{}", camera_report::to_text(name, &found, &views));
    }
    if let Some(file) = &args.out {
        write(file, name, &found)?;
    }
    if let (Some(file), Some(image)) = (&args.picture, shown) {
        let corners = found.views.iter().flat_map(|view| &view.corners);
        let corners: Vec<_> = corners
            .map(|&[seen, put]| SeenAndPut { seen, put })
            .collect();
        let text = format!(
            "{} views, {:.2} px RMS, {:.0} % of the image covered",
            found.views.len(),
            found.rms_px,
            100.0 * found.coverage
        );
        let view = corners_view(&image, &corners, &text).map_err(anyhow::Error::from)?;
        view.write(file).map_err(anyhow::Error::from)?;
        eprintln!("written: {}", file.display());
    }
    Ok(())
}

/// Chosen pictures one by one; frames, of which most are alike, by how many there are of each kind.
fn say_unused(args: &CalibrateCameraArgs, views: &BoardViews) {
    if args.images.is_some() {
        for view in &views.unused {
            eprintln!("not used: {}: {}", view.name, view.why);
        }
        return;
    }
    let mut kinds = BTreeMap::new();
    for view in &views.unused {
        *kinds.entry(view.why.kind()).or_insert(0) += 1;
    }
    for (kind, count) in kinds {
        eprintln!("not used: {count} frames that {kind}");
    }
}

fn board(args: &CalibrateCameraArgs) -> Result<Board, anyhow::Error> {
    let (columns, rows) = args.board.or(args.charuco).context("--board is missing")?;
    let kind = match (args.charuco, args.marker_m) {
        (Some(_), Some(marker_m)) if marker_m < args.square_m => BoardKind::Charuco {
            marker_m,
            dictionary: Board::dictionary(&args.dictionary).ok_or_else(|| {
                anyhow!(
                    "--dictionary {}: expected 4x4, 5x5, 6x6 or 7x7 with _50, _100, _250 or _1000",
                    args.dictionary
                )
            })?,
        },
        (Some(_), _) => return Err(anyhow!("--marker-m: a marker is smaller than its square")),
        (None, _) => BoardKind::Chessboard,
    };
    Ok(Board {
        kind,
        columns,
        rows,
        square_m: args.square_m,
    })
}

fn write(file: &Path, name: &str, found: &CameraCalibration) -> Result<(), anyhow::Error> {
    let info = CameraInfo {
        name: name.to_owned(),
        model: found.model,
        projection: found.projection,
    };
    fs::write(file, info.to_yaml())
        .with_context(|| format!("cannot write `{}`", file.display()))?;
    eprintln!("written: {}", file.display());
    Ok(())
}

/// The views, and one of the pictures.
pub(super) type Looked = (BoardViews, Option<roadwatch_core::Pixels>);
