//! The boxes of a drive, from the detector or from labels, camera by camera.

use crate::{
    cli::{BoxesFrom, CalibrateMountArgs},
    commands::{evaluate::perceive, progress::Progress},
    config::{Config, DatasetChoice, Environment, Mistakes},
    failure::Failure,
    session::Session,
};
use anyhow::{Context as _, anyhow};
use roadwatch_calibrate::{SeenBox, Sightings};
use roadwatch_camera::{Pace, PlaybackOptions, Recording as _, Repeat, RigDataset};
use roadwatch_core::{BoxPx, CameraId, ObjectClass, Pixels, RigCamera, SizeLwh};
use roadwatch_lab::{Truth, TruthObject};
use roadwatch_locate::{BoxNoise, ClassSize, ClassSizes};
use std::{path::Path, sync::Arc};

/// Lower boxes are mostly noise, pixels.
const MIN_HEIGHT_PX: f32 = 20.0;
/// Labels of objects hidden by more than this say more than a detector would see.
const MAX_OCCLUDED: f64 = 0.05;
/// A labelled size is exact, but a hull stands for a body only so well, as a share.
const SHAPE_SPREAD: f64 = 0.03;

/// Every camera's boxes.
pub(super) struct DriveBoxes {
    pub(super) cameras: Vec<CameraBoxes>,
    pub(super) ground_z_m: f64,
    pub(super) box_noise: BoxNoise,
}

/// One camera's boxes, frame by frame.
pub(super) struct CameraBoxes {
    pub(super) camera: RigCamera,
    pub(super) sightings: Sightings,
    dataset: Arc<RigDataset>,
    index: usize,
    fullest: Option<(usize, Vec<BoxPx>)>,
}

/// Boxes of one camera, one list per frame.
type Frames = Vec<Vec<SeenBox>>;

/// Runs the detector over the drive, or reads its labels.
pub(super) fn collect(
    args: &CalibrateMountArgs,
    drive: &Path,
    config_file: &Path,
) -> Result<DriveBoxes, Failure> {
    let config = Config::load(
        config_file,
        &DatasetChoice::from(drive.to_owned()).into(),
        &Environment::of_process(),
    )?;
    config.notes.clone().finish()?;
    let rig = config
        .rig
        .as_ref()
        .context("the configuration has no rig")?;
    let dataset = rig.dataset.clone().ok_or_else(|| {
        Mistakes::about_file(
            config_file,
            "no dataset can be played: give --drive DATASET",
        )
    })?;
    let mut wanted = rig.rig.ids().collect::<Vec<_>>();
    if let Some(name) = &args.camera {
        let known = rig.rig.cameras().iter().map(|c| c.name.as_str());
        let known = known.collect::<Vec<_>>().join(", ");
        let found = rig.rig.find(name);
        wanted = vec![
            found.ok_or_else(|| anyhow!("no camera is called `{name}`; the rig has {known}"))?,
        ];
    }
    let frames = match args.boxes {
        BoxesFrom::Detector => detected(args, drive, config_file)?,
        BoxesFrom::Truth => labelled(args, &config, &dataset)?,
    };
    // Cameras that the configuration adds to the drive's have no boxes in it.
    wanted.retain(|id| id.index() < frames.len());
    if wanted.is_empty() {
        return Err(anyhow!("the drive has no images of that camera").into());
    }
    let cameras = wanted.into_iter().map(|id| {
        let camera = rig.rig.camera(id).clone();
        CameraBoxes::new(camera, id, (&frames[id.index()], Arc::clone(&dataset)))
    });
    Ok(DriveBoxes {
        cameras: cameras.collect(),
        ground_z_m: rig.rig.ground_z_m,
        box_noise: config.locate.options.box_noise,
    })
}

impl CameraBoxes {
    fn new(camera: RigCamera, id: CameraId, (frames, dataset): (&Frames, Arc<RigDataset>)) -> Self {
        let mut sightings = Sightings::new(camera.model.size, MIN_HEIGHT_PX);
        let mut fullest: Option<(usize, Vec<BoxPx>)> = None;
        for (at, boxes) in frames.iter().enumerate() {
            let before = sightings.boxes().len();
            sightings.push_frame(boxes);
            let usable = &sightings.boxes()[before..];
            if usable.len() > fullest.as_ref().map_or(0, |(_, boxes)| boxes.len()) {
                fullest = Some((at, usable.iter().map(|s| s.seen.box_px).collect()));
            }
        }
        Self {
            camera,
            sightings,
            dataset,
            index: id.index(),
            fullest,
        }
    }

    /// The image with the most usable boxes, and those; `None` where there is none.
    pub(super) fn fullest_frame(&self) -> Result<Option<(Pixels, Vec<BoxPx>)>, anyhow::Error> {
        let Some((frame, boxes)) = &self.fullest else {
            return Ok(None);
        };
        let recording = self.dataset.recording(self.index);
        let mut recording = recording.context("the dataset has no images of this camera")??;
        for _ in 0..*frame {
            recording.next_stamp()?;
            recording.take_image()?;
        }
        recording.next_stamp()?;
        let image = recording.take_image()?;
        let pixels = image.pixels().map_err(Clone::clone)?.clone();
        Ok(Some((pixels, boxes.clone())))
    }
}

fn detected(
    args: &CalibrateMountArgs,
    drive: &Path,
    config_file: &Path,
) -> Result<Vec<Frames>, Failure> {
    let playback = PlaybackOptions {
        pace: Pace::AsFastAsPossible,
        repeat: Repeat::Once,
        frame_limit: args.frames,
    };
    let session = Session::open(
        config_file,
        &DatasetChoice::from(drive.to_owned()).into(),
        playback,
    )?;
    let rig = Arc::clone(&session.rig);
    let sizes = session.config.locate.options.sizes.clone();
    let dataset = session
        .config
        .rig
        .as_ref()
        .and_then(|rig| rig.dataset.clone());
    let frames = dataset.map_or(0, |dataset| dataset.frames().len() as u64);
    let per_camera = args.frames.map_or(frames, |limit| limit.min(frames));
    let progress = Progress::new(per_camera * rig.cameras().len() as u64, "images");
    let (perceived, _) = perceive(session, progress)?;
    let mut all = vec![Frames::new(); rig.cameras().len()];
    for recorded in perceived.frames {
        let boxes = recorded.detections();
        let boxes = boxes.filter_map(|detection| {
            let size = wanted_size(args, &detection.class, &sizes)?;
            Some(SeenBox {
                class: detection.class.clone(),
                box_px: detection.box_px,
                size,
            })
        });
        all[recorded.camera.index()].push(boxes.collect());
    }
    Ok(all)
}

fn labelled(
    args: &CalibrateMountArgs,
    config: &Config,
    dataset: &RigDataset,
) -> Result<Vec<Frames>, Failure> {
    let truth = Truth::read(dataset.folder()).map_err(anyhow::Error::from)?;
    let sizes = &config.locate.options.sizes;
    let limit = args.frames.map_or(usize::MAX, |limit| limit as usize);
    let of_camera = |(index, camera): (usize, &RigCamera)| -> Frames {
        let frames = dataset.frames().iter();
        let captured = frames.filter(|frame| frame.stamps[index].is_some());
        let boxes = captured.take(limit).map(|frame| {
            let objects = truth.objects(frame.number, camera.name.as_str());
            objects
                .iter()
                .filter_map(|o| label(args, o, sizes))
                .collect()
        });
        boxes.collect()
    };
    Ok(dataset
        .cameras()
        .iter()
        .enumerate()
        .map(of_camera)
        .collect())
}

/// A labelled object as if it had been detected, with its own size where the label says it.
fn label(args: &CalibrateMountArgs, object: &TruthObject, sizes: &ClassSizes) -> Option<SeenBox> {
    let class = ObjectClass::new(&object.class);
    let mut size = wanted_size(args, &class, sizes)?;
    if object.occluded > MAX_OCCLUDED {
        return None;
    }
    if let Some(own) = object.size {
        let share = |metres: f64| metres * SHAPE_SPREAD;
        size = ClassSize {
            size: own,
            std_dev: SizeLwh {
                length_m: share(own.length_m),
                width_m: share(own.width_m),
                height_m: share(own.height_m),
            },
            ..size
        };
    }
    Some(SeenBox {
        class,
        box_px: object.seen_px()?,
        size,
    })
}

fn wanted_size(
    args: &CalibrateMountArgs,
    class: &ObjectClass,
    sizes: &ClassSizes,
) -> Option<ClassSize> {
    let wanted = args.class.iter().any(|wanted| wanted == class.as_str());
    let size = sizes.get(class).copied();
    size.filter(|_| wanted)
}
