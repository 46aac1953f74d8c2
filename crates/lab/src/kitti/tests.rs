use super::*;
use crate::dataset_format::DatasetFormat;
use std::f64::consts::FRAC_PI_2;
use tempfile::TempDir;

/// A calibration as KITTI has them: camera 2 sits 6 cm to the left of the rectified frame's origin.
const CALIBRATION: &str = "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n\
     P2: 7.0e+02 0 6.0e+02 4.2e+01 0 7.0e+02 1.8e+02 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n";
/// A car 20 m ahead and 2 m to the right, 1.5 m high, that drives away.
const CAR: &str =
    "Car 0.02 1 -1.5 600.0 170.0 700.0 210.0 1.5 1.6 4.0 2.0 1.65 20.0 -1.5707963267948966";
const REGION: &str = "DontCare -1 -1 -10 10.0 20.0 60.0 90.0 -1 -1 -1 -1000 -1000 -1000 -10";

/// A folder with images 3 and 7.
fn folder(calibrations: [&str; 2], labels: [&str; 2]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for part in [IMAGES, CALIBRATIONS, LABELS] {
        fs::create_dir(folder.path().join(part)).expect("a folder");
    }
    let write = |part: &str, name: &str, bytes: &[u8]| {
        fs::write(folder.path().join(part).join(name), bytes).expect("written");
    };
    for (at, stem) in ["000003", "000007"].into_iter().enumerate() {
        write(IMAGES, &format!("{stem}.png"), &png_header(1242, 375));
        write(
            CALIBRATIONS,
            &format!("{stem}.txt"),
            calibrations[at].as_bytes(),
        );
        write(LABELS, &format!("{stem}.txt"), labels[at].as_bytes());
    }
    folder
}

/// As much of a PNG file as says its size.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR".to_vec();
    bytes.extend(width.to_be_bytes());
    bytes.extend(height.to_be_bytes());
    bytes.extend([8, 2, 0, 0, 0, 0, 0, 0, 0]);
    bytes
}

fn complaint(calibration: &str, label: &str) -> String {
    let folder = folder([CALIBRATION, calibration], [CAR, label]);
    let opened = DatasetFormat::Kitti.open(folder.path());
    let read = opened.and_then(|dataset| DatasetFormat::Kitti.read_truth(&dataset));
    let error = read.expect_err("a mistake").to_string();
    error.replace(&folder.path().display().to_string(), "")
}

#[test]
fn a_label_becomes_a_place_in_base_link() {
    let folder = folder([CALIBRATION; 2], [CAR, &format!("{REGION}\n{CAR}")]);
    let dataset = open(folder.path()).expect("a dataset");
    let truth = read_truth(&dataset).expect("labels");
    let [car] = truth.objects(3, "image_2") else {
        panic!("{:?}", truth.objects(3, "image_2"));
    };
    let expected = nalgebra::Point3::new(20.0, -2.0, -0.9);
    assert!(
        (car.center.coords - expected).norm() < 1e-12,
        "{:?}",
        car.center
    );
    assert!(car.yaw_rad.is_some_and(|yaw| yaw.abs() < 1e-12));
    assert_eq!(car.size.map(|size| size.length_m), Some(4.0));
    assert_eq!(
        (car.class.as_str(), car.label.as_deref()),
        ("car", Some("Car"))
    );
    assert_eq!((car.occluded, car.truncated), (0.4, 0.02));
    let labels = truth.labels(7, "image_2");
    assert_eq!(labels.objects[0].id, "000007/2");
    assert_eq!(labels.unlabelled_px[0].x_max, 60.5);
}

#[test]
fn camera_2_sits_where_its_matrix_puts_it() {
    let folder = folder([CALIBRATION; 2], [CAR; 2]);
    let dataset = open(folder.path()).expect("a dataset");
    let [camera] = dataset.cameras() else {
        panic!("{:?}", dataset.cameras());
    };
    let center = camera.base_from_optical.origin();
    assert!((center.coords - nalgebra::Point3::new(0.0, 0.06, 0.0)).norm() < 1e-12);
    // As the development kit projects it: P2 * (x, y, z, 1).
    let truth = read_truth(&dataset).expect("labels");
    let car = &truth.objects(3, "image_2")[0];
    let pixel = camera
        .model
        .project(camera.base_from_optical.inverse() * car.center);
    let pixel = pixel.expect("ahead");
    assert!((pixel.x - (700.0 * 2.0 + 600.0 * 20.0 + 42.0) / 20.0).abs() < 1e-9);
    assert!((pixel.y - (700.0 * 0.9 + 180.0 * 20.0) / 20.0).abs() < 1e-9);
}

#[test]
fn headings_turn_the_other_way_round_from_ahead() {
    for (rotation_y, yaw_rad) in [
        (0.0, -FRAC_PI_2),
        (FRAC_PI_2, -2.0 * FRAC_PI_2),
        (-2.0 * FRAC_PI_2, FRAC_PI_2),
    ] {
        let label = CAR.replace("-1.5707963267948966", &rotation_y.to_string());
        let folder = folder([CALIBRATION; 2], [&label, CAR]);
        let truth = read_truth(&open(folder.path()).expect("a dataset")).expect("labels");
        let found = truth.objects(3, "image_2")[0].yaw_rad.expect("a heading");
        assert!((found - yaw_rad).abs() < 1e-12, "{rotation_y}: {found}");
    }
}

#[test]
fn every_calibration_is_a_camera_of_its_own() {
    let other = CALIBRATION.replace("7.0e+02 0 6.0e+02", "7.1e+02 0 6.0e+02");
    let folder = folder([CALIBRATION, &other], [CAR; 2]);
    let dataset = open(folder.path()).expect("a dataset");
    let names = dataset.cameras().iter().map(|camera| camera.name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["image_2", "image_2_1"]);
    let seen = dataset
        .frames()
        .iter()
        .map(|frame| frame.stamps.iter().position(Option::is_some));
    assert_eq!(seen.collect::<Vec<_>>(), [Some(0), Some(1)]);
    let truth = read_truth(&dataset).expect("labels");
    assert_eq!(truth.objects(7, "image_2_1").len(), 1);
    assert!(truth.objects(7, "image_2").is_empty());
}

#[test]
fn each_mistake_of_a_calibration_is_said_with_file_and_line() {
    for (from, to, expected) in [
        ("P2:", "P3:", "/calib/000007.txt:3: no line `P2: ...`"),
        (
            "P2: 7.0e+02",
            "P2: -7.0e+02",
            "/calib/000007.txt:2: P2: fx is -700: expected a focal length above 0",
        ),
        (
            "7.0e+02 1.8e+02",
            "0 1.8e+02",
            "/calib/000007.txt:2: P2: fy is 0",
        ),
        (
            "4.2e+01",
            "wide",
            "/calib/000007.txt:2: P2: `wide` is not a number",
        ),
        ("4.2e+01", "", "/calib/000007.txt:2: P2 has 11 numbers"),
        (
            "P2: 7.0e+02 0",
            "P2: 7.0e+02 3",
            "/calib/000007.txt:2: P2 is not the matrix of a rectified camera",
        ),
    ] {
        let said = complaint(&CALIBRATION.replacen(from, to, 1), CAR);
        assert!(said.starts_with(expected), "{said}");
    }
}

#[test]
fn each_mistake_of_a_label_is_said_with_file_and_line() {
    for (from, to, expected) in [
        (
            " 20.0 -1.5707963267948966",
            "",
            "/label_2/000007.txt:2: a label has 15 fields, this line has 13: `z` and what",
        ),
        (
            " 20.0 ",
            " far ",
            "/label_2/000007.txt:2: z: `far` is not a number",
        ),
        (
            " 1.5 1.6 ",
            " 1.5 -1.6 ",
            "/label_2/000007.txt:2: width is -1.6: expected metres above 0",
        ),
        (
            "Car 0.02 1",
            "Car 2 1",
            "/label_2/000007.txt:2: truncated is 2: expected a share",
        ),
        (
            "Car 0.02 1",
            "Car 0.02 4",
            "/label_2/000007.txt:2: occluded is 4: expected 0 (visible)",
        ),
        (
            " 700.0 210.0",
            " 600.0 210.0",
            "/label_2/000007.txt:2: the box 600 170 600 210 has no area",
        ),
    ] {
        let said = complaint(
            CALIBRATION,
            &format!("{REGION}\n{}\n", CAR.replacen(from, to, 1)),
        );
        assert!(said.starts_with(expected), "{said}");
    }
}

#[test]
fn what_is_missing_is_named() {
    let labelled = folder([CALIBRATION; 2], [CAR; 2]);
    let file = labelled.path().join(LABELS).join("000007.txt");
    fs::remove_file(&file).expect("removed");
    let dataset = open(labelled.path()).expect("a dataset");
    let error = read_truth(&dataset).expect_err("no labels").to_string();
    assert!(error.contains("label_2/000007.txt"), "{error}");
    let empty = tempfile::tempdir().expect("a folder");
    let error = open(empty.path()).expect_err("nothing").to_string();
    assert!(
        error.contains("image_2") && error.contains("KITTI's object layout"),
        "{error}"
    );
}
