//! Headings in the daemon: the shipped models on the shipped clips, and what is said of models that do not fit.

mod support;

use opencv::{
    core::{CV_16U, Mat},
    imgcodecs::imwrite_def,
    imgproc::{COLOR_BGR2GRAY, cvt_color_def},
    prelude::*,
    videoio::{CAP_FFMPEG, VideoCapture},
};
use serde_json::Value;
use std::{fs, path::Path};
use support::{demo, refusal, root, run_well, stderr, stdout, write};

#[test]
fn the_shipped_clips_get_headings_that_are_mostly_right() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = demo(folder.path(), |text| text);
    let options = ["--pace", "lossless", "--frames", "6", "--score"];
    let output = run_well(&[&["run", config.as_str()][..], &options].concat());
    let said = [stdout(&output), stderr(&output)].concat();
    let line = said.lines().find(|line| line.contains("heading of"));
    let line = line.expect("a line of headings");
    let median = line
        .split("median ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let median: f64 = median
        .and_then(|number| number.parse().ok())
        .expect("a median");
    assert!(median < 10.0, "{line}");
}

#[test]
fn models_that_do_not_fit_are_named_with_their_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = write(folder.path(), "text.onnx", "no model");
    let detector = "/models/roadwatch_detector.onnx\"";
    let refused = |key: &str, file: &str| {
        let line = format!("{key} = \"{file}\"");
        let config = demo(folder.path(), |shipped| {
            let lines = shipped.lines().map(|old| {
                let in_rotation = old.starts_with(&format!("{key} =")) && !old.contains(detector);
                if in_rotation {
                    line.clone()
                } else {
                    old.to_owned()
                }
            });
            let lines: Vec<String> = lines.collect();
            let absent = !lines.contains(&line);
            let more = if absent {
                format!("\n{line}\n")
            } else {
                String::new()
            };
            lines.join("\n") + &more
        });
        refusal(&["check", &config])
    };
    let said = refused("model", &text);
    assert!(
        said.contains("rotation.model") && said.contains("no key-component model"),
        "{said}"
    );
    let said = refused("forest", &text);
    assert!(
        said.contains("rotation.forest") && said.contains("RWFOREST"),
        "{said}"
    );
    let said = refused("features", &text);
    assert!(
        said.contains("rotation.features") && said.contains("another detector"),
        "{said}"
    );
}

/// One image of the demo's front camera: as it is, grey, and of 16 bits a channel.
fn three_kinds_of_image(folder: &Path) {
    let clip = root().join("demo/front.mp4");
    let mut clip = VideoCapture::from_file(clip, CAP_FFMPEG).expect("a clip");
    let (mut image, mut grey, mut deep) = (Mat::default(), Mat::default(), Mat::default());
    assert!(clip.read(&mut image).expect("an image"));
    cvt_color_def(&image, &mut grey, COLOR_BGR2GRAY).expect("grey");
    // 255 * 257 is the greatest number of 16 bits.
    let deeper = image.convert_to(&mut deep, CV_16U, 257.0, 0.0);
    deeper.expect("16 bits");
    for (name, image) in [("0.png", &image), ("1.jpg", &grey), ("2.png", &deep)] {
        assert!(imwrite_def(folder.join(name), image).expect("written"));
    }
}

#[test]
fn grey_images_and_images_of_16_bits_get_headings_like_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let images = folder.path().join("images");
    fs::create_dir(&images).expect("a folder");
    three_kinds_of_image(&images);
    // A budget of two, so that one look is not enough for all.
    let config = demo(folder.path(), |text| {
        let camera = format!(
            "\n[[camera]]\nname = \"front\"\nwidth = 960\nheight = 540\nfx = 465.0\nfy = 465.0\ncx = 479.5\n\
             cy = 269.5\nposition_m = [1.9, 0.0, 1.9]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\n\
             images = \"{}\"\nrate_hz = 12\n",
            images.display()
        );
        let dataset = format!("dataset = \"{}/demo\"", root().display());
        text.replace(&dataset, "") + &camera
    });
    let output = run_well(&["run", &config, "--pace", "lossless", "--json"]);
    let summary: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let camera = &summary["cameras"][0];
    assert_eq!(
        (&camera["published"], &camera["unrotated"]),
        (&3.into(), &0.into()),
        "{summary:#}"
    );
    assert!(
        camera["objects"].as_u64().expect("a count") >= 3,
        "{summary:#}"
    );
}
