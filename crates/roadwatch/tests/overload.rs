//! Realtime under overload, on real images and the real network: counts are exact. Latency is the
//! benchmark `overload`.

mod support;

use serde_json::Value;
use support::{pandaset_config, run_well, runtime_library, shared, stdout, write};

/// The drive's frame rate, over its six cameras, frames per second.
const RECORDED_FPS: f64 = 60.0;

fn report(arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout(&run_well(arguments))).expect("JSON")
}

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).expect(path)
}

#[test]
fn every_frame_is_published_or_counted_as_dropped_and_cameras_share_alike() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let lossless = report(&[
        "run", &config, "--pace", "lossless", "--frames", "10", "--json",
    ]);
    let machine_fps = 60.0 / number(&lossless, "/secs");
    for overload in [1.2, 2.0, 10.0] {
        let speed = overload * machine_fps / RECORDED_FPS;
        // About four seconds of playing at each speed.
        let frames = (40.0 * speed).max(10.0).round();
        let run = report(&[
            "run",
            &config,
            "--loop",
            "--json",
            "--speed",
            &speed.to_string(),
            "--frames",
            &frames.to_string(),
        ]);
        let cameras = run["cameras"].as_array().expect("cameras");
        let counts = |key: &str| -> Vec<u64> {
            cameras
                .iter()
                .map(|camera| camera[key].as_u64().expect(key))
                .collect()
        };
        let (captured, published, dropped) =
            (counts("captured"), counts("published"), counts("dropped"));
        for at in 0..cameras.len() {
            assert_eq!(captured[at] as f64, frames, "camera {at}");
            assert_eq!(published[at] + dropped[at], captured[at], "camera {at}");
            assert!(published[at] > 0, "camera {at} was never served");
        }
        let (least, most) = (
            published.iter().min().expect("some"),
            published.iter().max().expect("some"),
        );
        assert!(most - least <= 1, "{overload} x: {published:?}");
        // What is dropped is never decoded.
        assert_eq!(
            run["images_decoded"].as_u64(),
            Some(published.iter().sum()),
            "{overload} x"
        );
    }
}
