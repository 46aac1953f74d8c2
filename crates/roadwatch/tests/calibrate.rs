//! `roadwatch calibrate`, as somebody types it.

mod support;

use roadwatch_camera::read_rig_file;
use roadwatch_core::Mount;
use serde_json::Value;
use std::{fmt::Write as _, fs, os::unix::fs::symlink, path::Path};
use support::{root, run_well, stdout, write};

/// What the rig of the drive is set wrong by.
const PITCH_OFF_DEG: f64 = 1.5;
const HEIGHT_OFF: f64 = 0.08;

/// The project's simulated drive with every camera's mount set wrong; the clips are those of `demo/`.
fn misaligned_drive(folder: &Path) {
    let demo = root().join("demo");
    for entry in fs::read_dir(&demo).expect("the demo") {
        let file = entry.expect("an entry").path();
        let name = file.file_name().expect("a name");
        if name != "rig.toml" {
            symlink(&file, folder.join(name)).expect("linked");
        }
    }
    let mut text = String::new();
    for camera in read_rig_file(&demo.join("rig.toml")).expect("the demo's rig") {
        let mut mount = Mount::of(&camera.base_from_optical);
        mount.pitch_rad += PITCH_OFF_DEG.to_radians();
        mount.position_m[2] *= 1.0 + HEIGHT_OFF;
        let q = mount.base_from_optical().isometry.rotation;
        let (k, size, at) = (camera.model.intrinsics, camera.model.size, mount.position_m);
        writeln!(
            text,
            "[[camera]]\nname = \"{}\"\nwidth = {}\nheight = {}\nfx = {:?}\nfy = {:?}\ncx = {:?}\ncy = {:?}\n\
             position_m = {at:?}\norientation_wxyz = [{:?}, {:?}, {:?}, {:?}]",
            camera.name, size.width_px, size.height_px, k.fx, k.fy, k.cx, k.cy, q.w, q.i, q.j, q.k
        )
        .expect("text");
    }
    fs::write(folder.join("rig.toml"), text).expect("written");
}

fn mounts(drive: &Path, more: &[&str]) -> Vec<Value> {
    let drive = drive.display().to_string();
    let always = [
        "calibrate",
        "mount",
        "--json",
        "--config",
        "config/demo.toml",
        "--drive",
        &drive,
    ];
    let output = run_well(&[&always, more].concat());
    serde_json::from_str(&stdout(&output)).expect("JSON")
}

#[test]
fn a_mount_set_wrong_comes_back_from_a_simulated_drive() {
    let folder = tempfile::tempdir().expect("a folder");
    misaligned_drive(folder.path());
    let picture = folder.path().join("mount.png").display().to_string();
    for name in ["front", "front_left"] {
        let more = ["--boxes", "truth", "--camera", name, "--picture", &picture];
        let found = &mounts(folder.path(), &more)[0];
        let truth = read_rig_file(&root().join("demo/rig.toml")).expect("the demo's rig");
        let truth = truth
            .iter()
            .find(|c| c.name.as_str() == name)
            .expect("the camera");
        let truth = Mount::of(&truth.base_from_optical);
        let number = |key: &str| found["after"][key].as_f64().expect("a number");
        let pitch_off = number("pitch_deg") - truth.pitch_rad.to_degrees();
        let height_off = number("height_m") / truth.position_m[2] - 1.0;
        assert!(
            pitch_off.abs() < 0.2,
            "{name}: pitch {pitch_off} degrees off"
        );
        assert!(height_off.abs() < 0.02, "{name}: height {height_off} off");
        let std = found["std"]["height_m"].as_f64().expect("a deviation");
        assert!((0.005..0.2).contains(&std), "{std}");
        assert!(fs::metadata(&picture).expect("the picture").len() > 10_000);
    }
}

#[test]
fn a_trusted_height_stays_and_the_pitch_is_found_all_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    misaligned_drive(folder.path());
    let more = ["--boxes", "truth", "--camera", "front", "--trust", "height"];
    let found = &mounts(folder.path(), &more)[0];
    let number = |key: &str| found["after"][key].as_f64().expect("a number");
    assert!((number("height_m") / (2.1 * (1.0 + HEIGHT_OFF)) - 1.0).abs() < 1e-9);
    assert!(number("pitch_deg").abs() < 0.2, "{}", number("pitch_deg"));
    // A camera believed too high sees everything too large.
    let ratio = found["drive"]["size_ratio"].as_f64().expect("a ratio");
    assert!((ratio / (1.0 + HEIGHT_OFF) - 1.0).abs() < 0.03, "{ratio}");
}

fn refusal(arguments: &[&str]) -> String {
    support::refusal(&[&["calibrate"], arguments].concat())
}

#[test]
fn bad_input_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let points = write(folder.path(), "points.csv", "u,v,x\n1,2,3\n");
    let mount = ["mount", "--rig", "demo/rig.toml", "--camera", "front"];
    let said = refusal(&[&mount[..], &["--points", &points]].concat());
    assert!(
        said.contains("points.csv:1: column `y` is missing; expected u,v,x,y[,z]"),
        "{said}"
    );
    let points = write(folder.path(), "points.csv", "u,v,x,y\n480,400,10,0\n");
    let said = refusal(&[&mount[..], &["--points", &points]].concat());
    assert!(
        said.contains("1 points are too few: 3 are needed"),
        "{said}"
    );
    let said = refusal(&[
        "mount",
        "--rig",
        "demo/rig.toml",
        "--camera",
        "roof",
        "--points",
        &points,
    ]);
    assert!(
        said.contains("no camera is called `roof`; the rig has front_left, front"),
        "{said}"
    );
    let rig = fs::read_to_string(root().join("demo/rig.toml")).expect("the rig");
    let bad = write(
        folder.path(),
        "rig.toml",
        &rig.replace("0.676209578, -0.676209578", "0.9, -0.676209578"),
    );
    let said = refusal(&[
        "mount", "--rig", &bad, "--camera", "front", "--points", &points,
    ]);
    assert!(said.contains("orientation_wxyz has length"), "{said}");
    let said = refusal(&[
        "focal",
        "--measurement",
        "55,-50,1.4",
        "--image-height-px",
        "1080",
    ]);
    assert!(
        said.contains("measurement 1: the distance is -50"),
        "{said}"
    );
}

#[test]
fn a_focal_value_is_measured_and_ready_to_paste() {
    let said = stdout(&run_well(&[
        "calibrate",
        "focal",
        "--measurement",
        "55,50,1.4",
        "--measurement",
        "92,30,1.4",
        "--image-height-px",
        "1080",
    ]));
    for expected in [
        "F = 1964.29 px",
        "F = 1971.43 px",
        "spread 5.05 px",
        "measured_focal_px = 1967.86",
    ] {
        assert!(said.contains(expected), "{said}");
    }
}
