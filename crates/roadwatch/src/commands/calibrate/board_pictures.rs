//! Pictures of a board: from files, a video, a camera of a rig dataset, or one that runs.

use super::{camera::Looked, still};
use crate::{
    cli::CalibrateCameraArgs,
    commands::{progress::Progress, signals::stop_on_signals},
    failure::Failure,
};
use anyhow::{Context as _, anyhow};
use roadwatch_calibrate::{Alike, Board, BoardViews, Unused};
use roadwatch_camera::{
    AnyRecording, LiveCamera, Recording as _, RigDataset, VideoFile, video_size,
};
use roadwatch_core::{Pixels, Timestamp};
use std::{
    path::{Path, PathBuf},
    sync::atomic::Ordering,
};

/// So many images of a running camera without a new view, and who holds the board is told why.
const HINT_AFTER: u32 = 100;
/// Which files are pictures.
const EXTENSIONS: [&str; 5] = ["jpg", "jpeg", "png", "bmp", "tiff"];

/// Looks for the board in every picture.
pub(super) fn look(args: &CalibrateCameraArgs, board: Board) -> Result<Looked, Failure> {
    let looked = match (&args.images, &args.video, &args.drive, &args.live) {
        (Some(pattern), ..) => look_at_files(&list(pattern)?, board),
        (_, Some(file), ..) => {
            let size = video_size(file).map_err(anyhow::Error::from)?;
            let video = VideoFile::open(file, size, Timestamp::from_nanos(0));
            let video = video.map_err(anyhow::Error::from)?;
            look_at_frames(args, AnyRecording::Video(video), board)
        }
        (_, _, Some(folder), _) => {
            let dataset = RigDataset::open(folder).map_err(anyhow::Error::from)?;
            look_at_frames(args, recording(&dataset, args.camera.as_deref())?, board)
        }
        (.., Some(name)) => return look_live(name, args.views as usize, board),
        (None, None, None, None) => Err(anyhow!("--images, --video, --drive or --live is missing")),
    };
    Ok(looked?)
}

fn recording(dataset: &RigDataset, name: Option<&str>) -> Result<AnyRecording, anyhow::Error> {
    let name = name.context("--camera is missing")?;
    let cameras = dataset.cameras();
    let index = cameras
        .iter()
        .position(|camera| camera.name.as_str() == name);
    let known: Vec<_> = cameras.iter().map(|camera| camera.name.as_str()).collect();
    let index = index.ok_or_else(|| {
        anyhow!(
            "no camera is called `{name}`; the dataset has {}",
            known.join(", ")
        )
    })?;
    let opened = dataset.recording(index);
    Ok(opened.context("the dataset has no images of this camera")??)
}

/// The pictures of a folder, or those that match a pattern, in order of their names.
fn list(pattern: &str) -> Result<Vec<PathBuf>, anyhow::Error> {
    let folder = Path::new(pattern);
    let matched = if folder.is_dir() {
        format!("{}/*", glob::Pattern::escape(pattern))
    } else {
        pattern.to_owned()
    };
    let found = glob::glob(&matched).with_context(|| format!("--images {pattern}"))?;
    let is_picture = |file: &PathBuf| {
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        EXTENSIONS.iter().any(|known| extension == *known)
    };
    let files: Vec<_> = found.filter_map(Result::ok).filter(is_picture).collect();
    if files.is_empty() {
        let kinds = EXTENSIONS.join(", .");
        return Err(anyhow!("--images {pattern}: no picture there (.{kinds})"));
    }
    Ok(files)
}

fn look_at_files(files: &[PathBuf], board: Board) -> Result<Looked, anyhow::Error> {
    let mut views = BoardViews::new(board, Alike::UseAll);
    let mut progress = Progress::new(files.len() as u64, "pictures");
    let mut shown = None;
    for (at, file) in files.iter().enumerate() {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        match still::read(file) {
            Ok(picture) => push(&mut views, &name, picture, &mut shown)?,
            Err(error) => views.skip(&name, Unused::Unreadable(format!("{error:#}"))),
        }
        progress.set(at as u64 + 1);
    }
    progress.finish();
    Ok((views, shown))
}

fn look_at_frames(
    args: &CalibrateCameraArgs,
    mut recording: AnyRecording,
    board: Board,
) -> Result<Looked, anyhow::Error> {
    let mut progress = Progress::new(length(&recording), "frames");
    let mut views = BoardViews::new(board, Alike::UseFirst);
    let mut shown = None;
    let mut frame = 0_u32;
    while recording.next_stamp()?.is_some() {
        let image = recording.take_image()?;
        if frame.is_multiple_of(args.every) {
            let name = format!("frame {frame}");
            match image.pixels() {
                Ok(picture) => push(&mut views, &name, picture.clone(), &mut shown)?,
                Err(error) => views.skip(&name, Unused::Unreadable(error.to_string())),
            }
        }
        frame += 1;
        progress.set(u64::from(frame));
    }
    progress.finish();
    Ok((views, shown))
}

/// Looks at what a camera sees now, until enough different views are there or somebody says stop.
fn look_live(name: &str, enough: usize, board: Board) -> Result<Looked, Failure> {
    let stop = stop_on_signals()?;
    let mut camera = LiveCamera::open(name).map_err(anyhow::Error::from)?;
    eprintln!("move the board in front of the camera; Ctrl-C ends with the views so far");
    let mut progress = Progress::new(enough as u64, "different views");
    let mut views = BoardViews::new(board, Alike::UseFirst);
    let mut shown = None;
    let mut since_last = 0_u32;
    for frame in 0_u64.. {
        if views.used.len() >= enough || stop.load(Ordering::Relaxed) {
            break;
        }
        let picture = match camera.next_image() {
            Ok(picture) => picture,
            Err(error) if views.used.is_empty() => return Err(anyhow::Error::from(error).into()),
            Err(error) => {
                eprintln!("{error}; going on with the views so far");
                break;
            }
        };
        let before = views.used.len();
        push(&mut views, &format!("frame {frame}"), picture, &mut shown)?;
        since_last = if views.used.len() > before {
            0
        } else {
            since_last + 1
        };
        if let (Some(last), true) = (views.unused.last(), since_last == HINT_AFTER) {
            eprintln!(
                "{HINT_AFTER} images without a new view: they {}",
                last.why.kind()
            );
            since_last = 0;
        }
        progress.set(views.used.len() as u64);
    }
    progress.finish();
    Ok((views, shown))
}

/// About how many frames there are.
fn length(recording: &AnyRecording) -> u64 {
    let span = recording.span();
    let nanos = span.last.as_nanos().saturating_sub(span.first.as_nanos());
    let frames = u128::from(nanos.unsigned_abs()) / span.interval.as_nanos().max(1) + 1;
    u64::try_from(frames).unwrap_or(u64::MAX)
}

/// Looks at a picture, and keeps the first that has the board to draw over.
fn push(
    views: &mut BoardViews,
    name: &str,
    picture: Pixels,
    shown: &mut Option<Pixels>,
) -> Result<(), anyhow::Error> {
    let before = views.used.len();
    views.push(name, &picture)?;
    if views.used.len() > before && shown.is_none() {
        *shown = Some(picture);
    }
    Ok(())
}
