//! The detector against an independent reference, image by image, and batches against single frames.

mod support;

use roadwatch_camera::StillImage;
use roadwatch_core::{BoxPx, CameraId, Detection, Detector, Frame, Image, ImageSize, Timestamp};
use roadwatch_detect::{
    COCO_CLASSES, ClassFilter, DetectorOptions, NetworkOptions, Runtime, YoloDetector,
};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};
use support::{python, root, runtime_library, shared, stderr};

const SIZE: ImageSize = ImageSize {
    width_px: 960,
    height_px: 540,
};

fn open(library: PathBuf, model: &Path, max_batch: usize) -> YoloDetector {
    let runtime = Runtime::load(&[library]).expect("ONNX Runtime");
    let options = DetectorOptions {
        model: model.to_owned(),
        family: None,
        class_names: None,
        network: NetworkOptions {
            threads: 2,
            spinning: false,
            input_size: None,
            max_batch,
        },
        filter: ClassFilter {
            score_threshold: 0.25,
            class_thresholds: Vec::new(),
            allowed: None,
        },
        iou_threshold: 0.45,
        exclusive_classes: Vec::new(),
        max_detections: 300,
    };
    YoloDetector::open(&runtime, &options).expect("opens")
}

fn frame(path: &Path) -> Frame {
    let bytes = fs::read(path).expect("an image");
    Frame {
        camera: CameraId(0),
        seq: 0,
        captured_at: Timestamp::from_nanos(0),
        received_at: Instant::now(),
        image: Image::encoded(Box::new(StillImage::new(
            bytes,
            SIZE,
            path.display().to_string(),
        ))),
    }
}

fn detect(detector: &YoloDetector, paths: &[PathBuf]) -> Vec<Vec<Detection>> {
    let frames = paths.iter().map(|path| frame(path)).collect();
    let found = detector.detect(frames).into_iter();
    found.map(|found| found.expect("detected").items).collect()
}

fn all_images(shared: &Path) -> Vec<PathBuf> {
    let cameras = [
        "front_left",
        "front",
        "front_right",
        "right",
        "back",
        "left",
    ];
    let names = cameras
        .iter()
        .flat_map(|camera| (0..40).map(move |frame| format!("{camera}/{frame:04}.jpg")));
    names
        .map(|name| shared.join("data/pandaset-dev").join(name))
        .collect()
}

/// A box of the reference.
struct Expected {
    box_px: BoxPx,
    score: f32,
    class: &'static str,
}

fn reference(python: &Path, model: &Path, family: &str, images: &[PathBuf]) -> Vec<Vec<Expected>> {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("boxes.json");
    let output = Command::new(python)
        .arg("-B")
        .arg(root().join("tests/peers/reference_detector.py"))
        .args([model, Path::new(family)])
        .args(images)
        .args(["--score", "0.25", "--iou", "0.45", "--out"])
        .arg(&out)
        .output()
        .expect("python starts");
    assert!(output.status.success(), "{}", stderr(&output));
    let boxes: serde_json::Value =
        serde_json::from_slice(&fs::read(out).expect("boxes")).expect("JSON");
    let expected = |row: &serde_json::Value| {
        let number = |at: usize| row[at].as_f64().expect("a number") as f32;
        Expected {
            box_px: BoxPx::new(number(0), number(1), number(2), number(3)).expect("a box"),
            score: number(4),
            class: COCO_CLASSES[row[5].as_u64().expect("a class") as usize],
        }
    };
    let rows = images
        .iter()
        .map(|image| &boxes[image.display().to_string()]);
    rows.map(|rows| {
        rows.as_array()
            .expect("boxes")
            .iter()
            .map(expected)
            .collect()
    })
    .collect()
}

/// Boxes of the reference that ours has too: same class, IoU 0.98, score within 0.01, one to one.
fn matched(ours: &[Detection], theirs: &[Expected]) -> usize {
    let mut free: Vec<_> = ours.iter().collect();
    let found = theirs.iter().filter(|expected| {
        let same = |ours: &&Detection| {
            ours.class.as_str() == expected.class
                && ours.box_px.iou(&expected.box_px) >= 0.98
                && (ours.score.get() - expected.score).abs() <= 0.01
        };
        let place = free.iter().position(same);
        place.map(|place| free.swap_remove(place)).is_some()
    });
    found.count()
}

fn agrees(model: &str, family: &str) {
    let (Some(shared), Some(python), Some(library)) = (shared(), python(), runtime_library())
    else {
        return;
    };
    let model = shared.join("models").join(model);
    let images = all_images(&shared);
    let detector = open(library, &model, 1);
    let ours = detect(&detector, &images);
    let theirs = reference(&python, &model, family, &images);
    let count = |sizes: &mut dyn Iterator<Item = usize>| sizes.sum::<usize>();
    let (our_boxes, their_boxes) = (
        count(&mut ours.iter().map(Vec::len)),
        count(&mut theirs.iter().map(Vec::len)),
    );
    let both = count(
        &mut ours
            .iter()
            .zip(&theirs)
            .map(|(ours, theirs)| matched(ours, theirs)),
    );
    eprintln!("{family}: {our_boxes} boxes, the reference has {their_boxes}, {both} agree");
    assert!(
        their_boxes > 1000,
        "the drive has more to see than {their_boxes} boxes"
    );
    assert!(both as f64 >= 0.995 * our_boxes.max(their_boxes) as f64);
}

#[test]
fn yolov5_boxes_agree_with_the_reference_on_every_image() {
    agrees("yolov5n_640.onnx", "yolov5");
}

#[test]
fn yolox_boxes_agree_with_the_reference_on_every_image() {
    agrees("yolox_nano.onnx", "yolox");
}

#[test]
fn a_batch_gives_what_its_frames_give_alone() {
    let (Some(shared), Some(python), Some(library)) = (shared(), python(), runtime_library())
    else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let fixed = shared.join("models/yolov5n_640.onnx");
    let free = folder.path().join("free.onnx");
    let made = Command::new(python)
        .arg("-B")
        .arg(root().join("tests/peers/free_batch.py"))
        .args([&fixed, &free])
        .output()
        .expect("python starts");
    assert!(made.status.success(), "{}", stderr(&made));
    let images: Vec<_> = all_images(&shared).into_iter().step_by(30).collect();
    let detector = open(library.clone(), &free, 3);
    assert_eq!(detector.max_batch(), 3);
    let (together, alone) = (
        detect(&detector, &images),
        detect(&open(library, &fixed, 3), &images),
    );
    for (together, alone) in together.iter().zip(&alone) {
        assert_eq!(together.len(), alone.len());
        for (a, b) in together.iter().zip(alone) {
            assert!(a.class == b.class && a.box_px.iou(&b.box_px) > 0.999);
        }
    }
}
