//! What is wrong is said clearly and all at once, or skipped and counted; never a panic, never silence.

mod support;

use serde_json::Value;
use std::{fs, io::Write as _, path::Path, process::Output};
use support::{
    daemon, pandaset_config, run, run_well, runtime_library, shared, stderr, stdout, write,
};

/// `EX_CONFIG`.
const EXIT_CONFIG: i32 = 78;

fn expect_mistakes(output: &Output, expected: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(EXIT_CONFIG), "{text}");
    for part in expected {
        assert!(text.contains(part), "expected `{part}` in:\n{text}");
    }
    assert!(!text.contains("panicked"), "{text}");
}

/// A rig dataset of two small cameras with four frames each, made of the drive's own images.
fn small_dataset(shared: &Path, folder: &Path) {
    let drive = shared.join("data/pandaset-dev");
    for file in ["rig.toml", "frames.jsonl", "truth.jsonl"] {
        fs::copy(drive.join(file), folder.join(file)).expect("copied");
    }
    let frames = fs::read_to_string(folder.join("frames.jsonl")).expect("frames");
    let four: Vec<_> = frames.lines().take(4).collect();
    fs::write(folder.join("frames.jsonl"), four.join("\n")).expect("written");
    for camera in [
        "front_left",
        "front",
        "front_right",
        "right",
        "back",
        "left",
    ] {
        fs::create_dir(folder.join(camera)).expect("a folder");
        for frame in 0..4 {
            let name = format!("{camera}/{frame:04}.jpg");
            fs::copy(drive.join(&name), folder.join(&name)).expect("copied");
        }
    }
}

#[test]
fn five_mistakes_are_five_lines_each_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "\
[node]
domain_id = 300
nmae = \"x\"

[detector]
model = \"none.onnx\"
score_threshold = 1.5

[rig]
dataset = \"nowhere\"

[locate]
method = \"tabel\"
";
    let config = write(folder.path(), "five.toml", text);
    let output = daemon(&["check", &config]).output().expect("starts");
    // The missing dataset is both unreadable and leaves the rig without a camera.
    let expected = [
        "five.toml:2: node.domain_id: 300 is out of range; expected 0 to 232",
        "five.toml:3: node.nmae: unknown key; did you mean `name`?",
        "five.toml:6: detector.model: model `",
        "five.toml:7: detector.score_threshold: 1.5 is out of range; expected 0 to 1",
        "five.toml:10: rig.dataset: ",
        "five.toml:13: locate.method: `tabel` is unknown; choose ",
    ];
    expect_mistakes(&output, &expected);
    let lines = stderr(&output)
        .lines()
        .filter(|line| line.contains("five.toml:"))
        .count();
    assert_eq!(lines, expected.len(), "{}", stderr(&output));
}

#[test]
fn text_that_is_not_toml_is_named_with_its_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = write(folder.path(), "bad.toml", "[node]\nname = \n");
    expect_mistakes(&run(&["check", &config]), &["bad.toml:2: not valid TOML"]);
    expect_mistakes(
        &run(&["check", "/no/such/file.toml"]),
        &["/no/such/file.toml: cannot be read"],
    );
}

#[test]
fn models_that_are_none_are_refused_before_the_first_frame() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let whole = fs::read(shared.join("models/yolox_nano.onnx")).expect("the model");
    fs::write(folder.path().join("cut.onnx"), &whole[..whole.len() / 2]).expect("written");
    fs::write(folder.path().join("text.onnx"), "I am no model").expect("written");
    fs::write(folder.path().join("empty.onnx"), "").expect("written");
    let config = pandaset_config(&shared, "publish = false");
    let model = shared.join("models/yolov5n_640.onnx").display().to_string();
    for (name, expected) in [
        ("absent.onnx", "does not exist"),
        ("cut.onnx", "is not an ONNX model"),
        ("text.onnx", "is not an ONNX model"),
        ("empty.onnx", "is not an ONNX model"),
    ] {
        let path = folder.path().join(name).display().to_string();
        let config = write(folder.path(), "config.toml", &config.replace(&model, &path));
        expect_mistakes(&run(&["run", &config]), &[expected, "detector.model"]);
    }
    let wrong_family = config.replace("family = \"yolov5\"", "family = \"yolov8\"");
    let wrong_family = write(folder.path(), "config.toml", &wrong_family);
    expect_mistakes(
        &run(&["check", &wrong_family]),
        &["has a yolov5 head; detector.family says yolov8"],
    );
    let unknown = config.replace("\"person\", \"bicycle\"", "\"persn\", \"bycicle\"");
    let unknown = write(folder.path(), "config.toml", &unknown);
    expect_mistakes(
        &run(&["check", &unknown]),
        &["detector.classes: `persn`, `bycicle` are no classes of the model"],
    );
}

#[test]
fn a_model_that_is_no_detector_is_refused() {
    let (Some(python), Some(_)) = (support::python(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("sum.onnx");
    let script = format!(
        "import onnx\nfrom onnx import helper as h, TensorProto as T\n\
         x=h.make_tensor_value_info('x',T.FLOAT,[1,3,64,64])\ny=h.make_tensor_value_info('y',T.FLOAT,[1,3,64,64])\n\
         m=h.make_model(h.make_graph([h.make_node('Relu',['x'],['y'])],'g',[x],[y]),opset_imports=[h.make_opsetid('',13)],ir_version=8)\n\
         onnx.save(m,{:?})",
        model.display().to_string()
    );
    let made = std::process::Command::new(python)
        .args(["-c", &script])
        .output()
        .expect("python starts");
    assert!(made.status.success(), "{}", stderr(&made));
    let output = run(&["models", "verify", &model.display().to_string()]);
    assert!(!output.status.success());
    assert!(
        stderr(&output).contains("is no YOLO head known here"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn without_onnx_runtime_one_line_says_how_to_get_it() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("libonnxruntime.so"), "not a library").expect("written");
    for (library, expected) in [
        ("/no/such/libonnxruntime.so".to_owned(), "./dev setup"),
        (
            folder
                .path()
                .join("libonnxruntime.so")
                .display()
                .to_string(),
            "is not a usable ONNX Runtime library",
        ),
    ] {
        let output = daemon(&["models", "verify", "x.onnx"])
            .env("ORT_DYLIB_PATH", library)
            .output()
            .expect("starts");
        assert!(!output.status.success());
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
        assert!(!stderr(&output).contains("panicked"));
    }
}

#[test]
fn damaged_images_are_skipped_and_counted_and_the_rest_goes_on() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    small_dataset(&shared, folder.path());
    let image = |name: &str| folder.path().join(name);
    let whole = fs::read(image("front/0001.jpg")).expect("an image");
    fs::write(image("front/0001.jpg"), &whole[..whole.len() / 2]).expect("cut");
    fs::write(image("front/0002.jpg"), "").expect("emptied");
    fs::write(image("left/0000.jpg"), "I am no image").expect("replaced");
    fs::remove_file(image("back/0003.jpg")).expect("removed");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let dataset = folder.path().display().to_string();
    let output = run_well(&[
        "run",
        &config,
        "--dataset",
        &dataset,
        "--pace",
        "lossless",
        "--json",
    ]);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let camera = |name: &str| {
        let cameras = report["cameras"].as_array().expect("cameras").iter();
        cameras
            .clone()
            .find(|camera| camera["name"] == name)
            .expect(name)
            .clone()
    };
    assert_eq!(
        (&camera("front")["published"], &camera("front")["dropped"]),
        (&2.into(), &2.into())
    );
    assert_eq!(camera("front")["dropped_by_reason"]["undecodable"], 2);
    assert_eq!(
        (&camera("left")["published"], &camera("left")["dropped"]),
        (&3.into(), &1.into())
    );
    assert_eq!(
        (&camera("back")["published"], &camera("back")["lost"]),
        (&3.into(), &1.into())
    );
    assert_eq!(camera("right")["published"], 4);
    assert!(
        stderr(&output).contains("frame dropped"),
        "{}",
        stderr(&output)
    );
    assert_eq!(report["scenes"], 4);
}

#[test]
fn images_of_another_size_than_the_rig_says_are_not_used() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    small_dataset(&shared, folder.path());
    let rig = fs::read_to_string(folder.path().join("rig.toml")).expect("rig");
    fs::write(
        folder.path().join("rig.toml"),
        rig.replacen("width = 960", "width = 640", 1),
    )
    .expect("written");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let dataset = folder.path().display().to_string();
    let output = run_well(&["run", &config, "--dataset", &dataset, "--pace", "lossless"]);
    assert!(
        stderr(&output).contains("image is 960x540, the rig says 640x540"),
        "{}",
        stderr(&output)
    );
}

/// Builds the left camera's table, coarse and quick.
fn build_left_table(shared: &Path, folder: &Path) -> (String, String) {
    let table = folder.join("left.rwtable").display().to_string();
    let rig = shared
        .join("data/pandaset-dev/rig.toml")
        .display()
        .to_string();
    run_well(&[
        "table", "build", "--rig", &rig, "--camera", "left", "-o", &table, "--step-m", "4",
    ]);
    (table, rig)
}

#[test]
fn tables_go_out_as_csv_and_come_back_and_broken_csv_is_refused() {
    let Some(shared) = shared() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let (table, rig) = build_left_table(&shared, folder.path());
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (csv, again) = (path("left.csv"), path("again.rwtable"));
    let inspected = stdout(&run_well(&["table", "inspect", &table, "--export", &csv]));
    assert!(inspected.contains("camera    left, 960x540"), "{inspected}");
    let import = [
        "table", "build", "--rig", &rig, "--camera", "left", "--import", &csv, "-o", &again,
    ];
    run_well(&import);
    let asked = [
        "table",
        "query",
        &again,
        "--box",
        "400,260,520,320",
        "--distance-m",
        "12",
    ];
    assert!(stdout(&run_well(&asked)).contains("LocY"));

    let rows = fs::read_to_string(&csv).expect("CSV");
    let (head, first) = (
        rows.lines().next().expect("a head"),
        rows.lines().nth(1).expect("a row"),
    );
    let not_a_number = rows.replacen(first, "1,2,3,NaN,5,6,7", 1);
    for (text, expected) in [
        (head, "the table is empty"),
        (&not_a_number, "Distance"),
        ("x\n1\n", "column"),
    ] {
        fs::write(&csv, text).expect("written");
        let output = run(&import);
        let text = stderr(&output);
        assert!(
            !output.status.success() && text.contains(expected) && !text.contains("panicked"),
            "{text}"
        );
    }
    let unknown = run(&[
        "table", "build", "--rig", &rig, "--camera", "frnt", "-o", &again,
    ]);
    assert!(
        stderr(&unknown).contains("no camera `frnt`; the rig has front_left, front"),
        "{}",
        stderr(&unknown)
    );
}

#[test]
fn tables_of_other_cameras_and_cut_tables_are_refused() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let (table, _) = build_left_table(&shared, folder.path());
    let config = pandaset_config(&shared, "publish = false");
    let with_table =
        |path: &str| format!("{config}\n[[camera]]\nname = \"front\"\ntable = \"{path}\"\n");
    let other = write(folder.path(), "other.toml", &with_table(&table));
    expect_mistakes(
        &run(&["check", &other]),
        &["camera[0].table", "left", "front"],
    );
    let bytes = fs::read(&table).expect("the table");
    fs::write(&table, &bytes[..bytes.len() - 10]).expect("cut");
    let cut = write(folder.path(), "cut.toml", &with_table(&table));
    expect_mistakes(&run(&["check", &cut]), &["camera[0].table"]);
}

#[test]
fn cameras_of_one_name_are_refused() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let images = shared.join("data/pandaset-dev/front").display().to_string();
    let camera = format!(
        "[[camera]]\nname = \"mast\"\nimages = {images:?}\nrate_hz = 10\nwidth = 960\nheight = 540\n\
         fx = 985\nfy = 985\ncx = 485\ncy = 241\nposition_m = [0, 0, 2]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\n"
    );
    let drive = shared.join("data/pandaset-dev").display().to_string();
    let alone =
        pandaset_config(&shared, "publish = false").replace(&format!("dataset = {drive:?}"), "");
    let one = write(folder.path(), "one.toml", &format!("{alone}\n{camera}"));
    run_well(&["check", &one]);
    let two = write(
        folder.path(),
        "two.toml",
        &format!("{alone}\n{camera}\n{camera}"),
    );
    expect_mistakes(
        &run(&["check", &two]),
        &["camera[1].name: another camera has this name"],
    );
}

#[test]
fn bags_that_cannot_be_written_are_refused_before_the_first_frame() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let full = folder.path().display().to_string();
    for (bag, expected) in [
        (full.as_str(), "is not empty"),
        ("/proc/no/bag", "/proc/no/bag"),
    ] {
        let output = run(&["run", &config, "--bag", bag]);
        assert!(!output.status.success());
        let text = stderr(&output);
        assert!(
            text.contains("nothing can be recorded") && text.contains(expected),
            "{text}"
        );
    }
}

#[test]
fn domain_ids_of_the_environment_are_checked() {
    let Some(shared) = shared() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let config = write(folder.path(), "config.toml", &pandaset_config(&shared, ""));
    for id in ["233", "-1", "one"] {
        let output = daemon(&["check", &config])
            .env("ROS_DOMAIN_ID", id)
            .output()
            .expect("starts");
        expect_mistakes(&output, &["ROS_DOMAIN_ID is `"]);
    }
}

#[test]
fn a_camera_may_not_take_the_scenes_name() {
    let Some(shared) = shared() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let config = pandaset_config(&shared, "publish = false") + "\n[[camera]]\nname = \"scene\"\n";
    let config = write(folder.path(), "config.toml", &config);
    expect_mistakes(
        &run(&["check", &config]),
        &["camera[0].name: `scene` cannot name a camera"],
    );
}

#[test]
fn recordings_that_share_no_moment_are_refused() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let images = shared.join("data/pandaset-dev/front").display().to_string();
    let camera = |start: &str| {
        format!(
            "\n[[camera]]\nname = \"mast\"\nimages = {images:?}\nrate_hz = 10\n{start}\nwidth = 960\nheight = 540\n\
             fx = 985\nfy = 985\ncx = 485\ncy = 241\nposition_m = [0, 0, 2]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\n"
        )
    };
    let config = pandaset_config(&shared, "publish = false");
    let beside = write(
        folder.path(),
        "beside.toml",
        &format!("{config}{}", camera("")),
    );
    run_well(&["check", &beside]);
    let long_ago = write(
        folder.path(),
        "ago.toml",
        &format!("{config}{}", camera("start_stamp = \"5.0\"")),
    );
    expect_mistakes(
        &run(&["check", &long_ago]),
        &["begins after another of the rig has ended"],
    );
}

#[test]
fn filters_that_score_nothing_are_refused() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let carr = run(&["evaluate", "--config", &config, "--class", "carr"]);
    assert!(
        stderr(&carr).contains("--class carr: nothing is labelled so; labelled are"),
        "{}",
        stderr(&carr)
    );
    let share = run(&["evaluate", "--config", &config, "--max-occluded", "30"]);
    assert!(
        stderr(&share).contains("expected a share, 0 to 1"),
        "{}",
        stderr(&share)
    );
}

/// A disk of a few pages; `None` where this user may not mount one.
fn small_disk(folder: &Path) -> Option<()> {
    let mounted = std::process::Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
        .arg(folder)
        .output();
    mounted.ok()?.status.success().then_some(())
}

#[test]
fn a_disk_that_fills_up_fails_the_run_and_not_perception() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let disk = folder.path().join("disk");
    fs::create_dir(&disk).expect("a folder");
    if small_disk(&disk).is_none() {
        writeln!(
            std::io::stderr(),
            "SKIPPED: this user cannot mount a small disk to fill"
        )
        .expect("standard error");
        return;
    }
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let bag = disk.join("bag").display().to_string();
    let output = run(&[
        "run", &config, "--pace", "lossless", "--frames", "12", "--bag", &bag, "--json",
    ]);
    let unmounted = std::process::Command::new("umount").arg(&disk).status();
    assert!(unmounted.expect("umount starts").success());
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("the bag is not complete") && !text.contains("panicked"),
        "{text}"
    );
    let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(report["scenes"], 12);
}
