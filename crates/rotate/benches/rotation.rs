//! What a heading costs per object: normalisation, the network, the forest. Uses the shipped models.

use divan::{Bencher, black_box};
use roadwatch_core::{BoxPx, ImageSize, Pixels};
use roadwatch_onnx::{Runtime, SessionOptions};
use roadwatch_rotate::{
    ComponentNetwork, Crop, Forest, Row,
    crop::{ChannelOrder, Scratch, Values},
    estimator::RowReader,
};
use std::path::{Path, PathBuf};

const IMAGE: ImageSize = ImageSize {
    width_px: 960,
    height_px: 540,
};
const CROP: ImageSize = ImageSize {
    width_px: 192,
    height_px: 192,
};

fn main() {
    divan::main();
}

fn image() -> Pixels {
    let bytes = (0..960 * 540 * 3).map(|at: u32| (at.wrapping_mul(2_654_435_761) >> 24) as u8);
    Pixels::new(IMAGE, bytes.collect()).expect("pixels")
}

fn car() -> BoxPx {
    BoxPx::new(400.0, 250.0, 560.0, 350.0).expect("a box")
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models")
}

#[divan::bench]
fn normalisation(bencher: Bencher<'_, '_>) {
    let (pixels, crop) = (image(), Crop::new(&car(), IMAGE, CROP).expect("a crop"));
    let mut input = vec![0.0; Crop::input_len(CROP)];
    let mut scratch = Scratch::default();
    let values = Values {
        order: ChannelOrder::Rgb,
        scale: 1.0 / 255.0,
    };
    bencher.bench_local(|| crop.fill(black_box(&pixels), values, &mut input, &mut scratch));
}

#[divan::bench]
fn forest_all_outputs(bencher: Bencher<'_, '_>) {
    let forest = Forest::read(&models().join("roadwatch_rotation.forest")).expect("shipped");
    let row = Row {
        aspect: 0.7,
        components: vec![(Some(0.4), 0.6); forest.components().len()],
        facing: vec![1.0 / forest.facing_bins() as f32; forest.facing_bins()],
    };
    let mut features = Vec::new();
    bencher.bench_local(|| forest.turn(black_box(&row), &mut features));
}

/// Normalisation and network, on one thread; per object where several come at once.
#[divan::bench(args = [1, 4])]
fn rows_of_objects(bencher: Bencher<'_, '_>, objects: usize) {
    #[expect(
        clippy::disallowed_methods,
        reason = "a benchmark has no configuration"
    )]
    let library = std::env::var("ORT_DYLIB_PATH").map(PathBuf::from);
    let Ok(runtime) = Runtime::load(&library.into_iter().collect::<Vec<_>>()) else {
        println!("SKIPPED: no ONNX Runtime; `./dev bench` sets ORT_DYLIB_PATH");
        return;
    };
    let files = (
        models().join("roadwatch_parts.onnx"),
        models().join("roadwatch_detector.onnx"),
    );
    let options = SessionOptions {
        threads: 1,
        spinning: false,
    };
    let network = ComponentNetwork::open(&runtime, (&files.0, &files.1), options);
    let mut reader = RowReader::new(network.expect("shipped"));
    let (pixels, boxes) = (image(), vec![car(); objects]);
    bencher
        .counter(divan::counter::ItemsCount::new(objects))
        .bench_local(|| reader.read(black_box(&pixels), &boxes));
}
