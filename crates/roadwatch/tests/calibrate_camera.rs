//! `roadwatch calibrate camera`, as somebody types it, and the YAML that it writes, as the daemon reads it.

#[path = "support/photographed.rs"]
mod photographed;
mod support;

use photographed::{BOARD, photograph};
use serde_json::Value;
use std::{fs, path::Path};
use support::{run, run_well, stderr, stdout, write};

/// The lens that the command finds, and the YAML that it writes.
fn calibrated(folder: &Path) -> (Value, String) {
    let file = |name: &str| folder.join(name).display().to_string();
    let (images, yaml, picture) = (file("*.png"), file("cam.yaml"), file("corners.jpeg"));
    let files = [
        "--images",
        &images,
        "-o",
        &yaml,
        "--picture",
        &picture,
        "--camera",
        "front",
    ];
    let output = run_well(&[&BOARD[..], &files[..]].concat());
    assert!(fs::metadata(picture).expect("the picture").len() > 10_000);
    (serde_json::from_str(&stdout(&output)).expect("JSON"), yaml)
}

/// A configuration whose only camera has the named lens, and a video that is not there.
fn config_with(folder: &Path, camera_info: &str, more: &str) -> String {
    let text = format!(
        "[detector]\nmodel = \"absent.onnx\"\n[[camera]]\nname = \"front\"\ncamera_info = \"{camera_info}\"\n\
         position_m = [0, 0, 1.5]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\nvideo = \"absent.mp4\"\n{more}"
    );
    write(folder, "config.toml", &text)
}

#[test]
fn a_lens_from_pictures_is_found_to_half_a_percent() {
    let folder = tempfile::tempdir().expect("a folder");
    let truth = photograph(folder.path());
    let (found, _) = calibrated(folder.path());
    let number = |key: &str| found[key].as_f64().expect("a number");
    for (key, truth) in [("fx", truth.intrinsics.fx), ("fy", truth.intrinsics.fy)] {
        assert!(
            (number(key) / truth - 1.0).abs() < 0.005,
            "{key} {}",
            number(key)
        );
    }
    assert!(number("rms_px") < 0.3 && found["views"].as_array().expect("views").len() >= 12);
}

#[test]
fn a_lens_that_was_written_is_read_back_by_the_daemon() {
    let folder = tempfile::tempdir().expect("a folder");
    photograph(folder.path());
    let (_, yaml) = calibrated(folder.path());
    for named in [format!("file://{yaml}").as_str(), "cam.yaml"] {
        let config = config_with(folder.path(), named, "");
        let said = stderr(&run(&["check", &config]));
        assert!(
            said.contains("camera[0].video") && !said.contains("camera_info"),
            "{said}"
        );
    }
    let share = folder.path().join("install/share/my_robot");
    fs::create_dir_all(&share).expect("a package");
    fs::copy(&yaml, share.join("cam.yaml")).expect("copied");
    let config = config_with(folder.path(), "package://my_robot/cam.yaml", "");
    let prefixes = format!("/nowhere:{}", folder.path().join("install").display());
    for (prefixes, expected) in [
        (prefixes.as_str(), None),
        ("", Some("AMENT_PREFIX_PATH, which is not set")),
        (
            "/nowhere",
            Some("no package `my_robot` in AMENT_PREFIX_PATH (/nowhere)"),
        ),
    ] {
        let mut command = support::daemon(&["check", &config]);
        let said = stderr(
            &command
                .env("AMENT_PREFIX_PATH", prefixes)
                .output()
                .expect("it starts"),
        );
        assert_eq!(said.contains("camera_info"), expected.is_some(), "{said}");
        assert!(
            expected.is_none_or(|expected| said.contains(expected)),
            "{said}"
        );
    }
}

fn refusal(arguments: &[&str]) -> String {
    support::refusal(&[&["calibrate"], arguments].concat())
}

#[test]
fn a_board_that_is_not_there_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let empty = folder.path().display().to_string();
    let camera = ["camera", "--square-m", "0.1", "--images", &empty, "--board"];
    let refused = |board| refusal(&[&camera[..], &[board]].concat());
    assert!(refused("8x6").contains("no picture there"));
    assert!(refused("8").contains("expected columns x rows, like 8x6"));
    photograph(folder.path());
    let said = refused("9x7");
    assert!(
        said.contains("not used: 00.png: no board of this size is found"),
        "{said}"
    );
    let none = "none of 14 pictures shows a chessboard with inner corners 9 x 7";
    assert!(said.contains(none), "{said}");
}

#[test]
fn a_camera_info_that_cannot_be_is_named_with_its_line_and_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = "image_width: 640\nimage_height: 400\ncamera_name: front\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
                data: [500, 0, 320, 0, 500, 200, 0, 0, 1]\ndistortion_model: plumb_bob\n\
                distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n\
                rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
    let complaint = |yaml: &str, more: &str| {
        write(folder.path(), "cam.yaml", yaml);
        let config = config_with(folder.path(), "cam.yaml", more);
        stderr(&run(&["check", &config]))
    };
    for (from, to, expected) in [
        (
            "[500,",
            "[-500,",
            "cam.yaml:4: camera_matrix: fx is -500: expected a focal length above 0",
        ),
        (
            "0, 1]\n",
            "0, 1.5]\n",
            "cam.yaml:4: camera_matrix: expected the form",
        ),
        (
            "[1, 0, 0, 0, 1",
            "[1, 0, 0, 0, 2",
            "cam.yaml:13: rectification_matrix: not a rotation",
        ),
        (
            "plumb_bob",
            "barrel",
            "cam.yaml:8: distortion_model: distortion model `barrel`",
        ),
        ("image_width: 640\n", "", "missing field `image_width`"),
    ] {
        let said = complaint(&good.replacen(from, to, 1), "");
        assert!(
            said.contains("config.toml:5: camera[0].camera_info: ") && said.contains(expected),
            "{said}"
        );
    }
    let said = complaint(good, "width = 960\nheight = 540\n");
    assert!(
        said.contains("is for images of 640x400, the camera's are 960x540"),
        "{said}"
    );
    let said = complaint(good, "fx = 500.0\n");
    assert!(
        said.contains("camera[0].fx: is in the camera_info already"),
        "{said}"
    );
}
