//! `roadwatch calibrate camera` from moving pictures: a video, a drive, and a camera that runs.

#[path = "support/photographed.rs"]
mod photographed;
mod support;

use opencv::{
    core::{Size, Vector},
    imgcodecs::{IMREAD_COLOR, imencode_def, imread, imwrite_def},
    prelude::*,
    videoio::{CAP_FFMPEG, VideoWriter},
};
use photographed::{BOARD, photograph};
use serde_json::Value;
use std::{
    fs,
    io::{Read as _, Write as _},
    net::{Shutdown, TcpListener},
    path::{Path, PathBuf},
    thread,
};
use support::{run_well, stderr, stdout, write};

/// Every picture is shown so often, as a hand holds a board still; the command looks at every fifth frame.
const REPEATS: usize = 5;
/// What compression may do to a focal length.
const NEAR: f64 = 0.01;

fn pictures(folder: &Path) -> Vec<PathBuf> {
    let found = fs::read_dir(folder).expect("a folder");
    let mut files: Vec<_> = found.map(|entry| entry.expect("a file").path()).collect();
    files.sort();
    files
}

/// Runs the command on a source, checks its lens, and gives its report and what it said.
fn calibrated(source: &[&str], true_fx: f64) -> (Value, String) {
    let output = run_well(&[&BOARD[..], source].concat());
    let found: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let fx = found["fx"].as_f64().expect("a number");
    assert!((fx / true_fx - 1.0).abs() < NEAR, "fx {fx}");
    (found, stderr(&output))
}

fn used(report: &Value) -> usize {
    report["views"].as_array().expect("views").len()
}

#[test]
fn a_video_gives_one_view_for_each_place_of_the_board() {
    let folder = tempfile::tempdir().expect("a folder");
    let truth = photograph(folder.path());
    let files = pictures(folder.path());
    let video = folder.path().join("board.avi");
    let size = Size::new(640, 400);
    let code = VideoWriter::fourcc('M', 'J', 'P', 'G').expect("a code");
    let writer = VideoWriter::new_with_backend(&video, CAP_FFMPEG, code, 30.0, size, true);
    let mut writer = writer.expect("a writer");
    for file in &files {
        let picture = imread(file, IMREAD_COLOR).expect("a picture");
        for _ in 0..2 * REPEATS {
            writer.write(&picture).expect("written");
        }
    }
    writer.release().expect("closed");
    let video = video.display().to_string();
    let (report, said) = calibrated(&["--video", &video], truth.intrinsics.fx);
    assert!(used(&report) <= files.len(), "{report:#}");
    assert!(
        said.contains(&format!(
            "{} frames that show what another shows",
            files.len()
        )),
        "{said}"
    );
}

#[test]
fn a_camera_of_a_drive_is_calibrated_from_its_images() {
    let folder = tempfile::tempdir().expect("a folder");
    let images = folder.path().join("front");
    fs::create_dir(&images).expect("a folder");
    let truth = photograph(&images);
    let mut frames = String::new();
    for (at, file) in pictures(&images).iter().enumerate() {
        let picture = imread(file, IMREAD_COLOR).expect("a picture");
        let named = images.join(format!("{at:04}.jpg"));
        assert!(imwrite_def(named, &picture).expect("written"));
        frames +=
            &format!("{{\"frame\": {at}, \"stamp\": {{\"front\": 1557539956.{at:02}0000}}}}\n");
    }
    write(folder.path(), "frames.jsonl", &frames);
    // The lens that stands there is a guess; it is not looked at.
    write(
        folder.path(),
        "rig.toml",
        "[[camera]]\nname = \"front\"\nwidth = 640\nheight = 400\nfx = 900.0\nfy = 900.0\ncx = 320.0\n\
         cy = 200.0\nposition_m = [0, 0, 1.5]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\n",
    );
    let drive = folder.path().display().to_string();
    let source = ["--drive", &drive, "--camera", "front", "--every", "1"];
    let (report, _) = calibrated(&source, truth.intrinsics.fx);
    assert!(used(&report) >= 12, "{report:#}");
    let said = support::refusal(&[&BOARD[..], &["--drive", &drive, "--camera", "rear"]].concat());
    assert!(
        said.contains("no camera is called `rear`; the dataset has front"),
        "{said}"
    );
}

/// Serves each picture some times to one viewer, as network cameras do: one HTTP answer that goes on and on.
fn network_camera(pictures: Vec<Vec<u8>>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound");
    let camera = move || {
        let (mut viewer, _) = listener.accept().expect("a viewer");
        let mut request = [0; 4096];
        assert!(viewer.read(&mut request).expect("a request") > 0);
        let header =
            "HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n";
        let mut sent = viewer.write_all(header.as_bytes());
        for picture in pictures.iter().flat_map(|picture| [picture; REPEATS]) {
            let part = format!(
                "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n",
                picture.len()
            );
            sent = sent.and_then(|()| viewer.write_all(part.as_bytes()));
            sent = sent.and_then(|()| viewer.write_all(picture));
            sent = sent.and_then(|()| viewer.write_all(b"\r\n"));
        }
        // A viewer that has seen enough hangs up; one that has not gets to read what is on its way.
        if sent.and_then(|()| viewer.shutdown(Shutdown::Write)).is_ok() {
            let _hung_up = viewer.read(&mut request);
        }
    };
    let thread = thread::Builder::new().name("network camera".to_owned());
    thread.spawn(camera).expect("a thread");
    format!("http://{address}/video.mjpg")
}

#[test]
fn a_running_camera_is_looked_at_until_there_are_enough_views() {
    let folder = tempfile::tempdir().expect("a folder");
    let truth = photograph(folder.path());
    let jpeg = |file: &PathBuf| {
        let picture = imread(file, IMREAD_COLOR).expect("a picture");
        let mut bytes = Vector::new();
        let done = imencode_def(".jpg", &picture, &mut bytes);
        assert!(done.expect("encoded"));
        bytes.to_vec()
    };
    let seen: Vec<_> = pictures(folder.path()).iter().map(jpeg).collect();
    let live = network_camera(seen.clone());
    let (report, said) = calibrated(&["--live", &live, "--views", "12"], truth.intrinsics.fx);
    assert_eq!(used(&report), 12, "{said}");
    assert!(said.contains("move the board"), "{said}");
    // One that goes away is used as far as it went.
    let short = network_camera(seen);
    let (report, said) = calibrated(&["--live", &short, "--views", "40"], truth.intrinsics.fx);
    assert!(used(&report) >= 12, "{report:#}");
    assert!(said.contains("delivers no more images; going on"), "{said}");
}

#[test]
fn a_camera_that_is_not_there_is_said_at_once() {
    let refused = |live| support::refusal(&[&BOARD[..], &["--live", live]].concat());
    assert!(refused("front").contains("expected a device such as /dev/video0"));
    let said = refused("/dev/video-that-is-not-there");
    assert!(
        said.contains("`/dev/video-that-is-not-there` cannot be opened"),
        "{said}"
    );
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let closed = port.local_addr().expect("bound");
    drop(port);
    let said = refused(&format!("http://{closed}/video.mjpg"));
    assert!(said.contains("cannot be opened"), "{said}");
}
