//! What every frame pays before and after the network.

use divan::{Bencher, black_box};
use roadwatch_core::{BoxPx, ImageSize, Pixels};
use roadwatch_detect::{
    Head,
    letterbox::{Letterbox, Placement, Scratch, Values},
    nms::{Candidate, suppress},
};

const IMAGE: ImageSize = ImageSize {
    width_px: 960,
    height_px: 540,
};
const INPUT: ImageSize = ImageSize {
    width_px: 640,
    height_px: 640,
};
/// YOLOv5 at 640x640, COCO.
const OUTPUT: [i64; 3] = [1, 25_200, 85];

fn main() {
    divan::main();
}

#[divan::bench]
fn letterbox_960x540_to_640(bencher: Bencher<'_, '_>) {
    let bytes = (0..960 * 540 * 3).map(|at| (at * 7 % 251) as u8).collect();
    let image = Pixels::new(IMAGE, bytes).expect("pixels");
    let letterbox = Letterbox::new(IMAGE, INPUT, Placement::Centred, Values::RgbUnit);
    let mut input = vec![0.0; Letterbox::input_len(INPUT)];
    let mut scratch = Scratch::default();
    bencher.bench_local(|| letterbox.fill(black_box(&image), &mut input, &mut scratch));
}

#[divan::bench]
fn decode_yolov5_with_20_boxes(bencher: Bencher<'_, '_>) {
    let head = Head::recognise(&OUTPUT, INPUT).expect("yolov5");
    let mut output = vec![0.001_f32; head.output_len()];
    for at in 0..20 {
        output[at * 1000 * 85 + 4] = 0.9;
        output[at * 1000 * 85 + 7] = 0.9;
    }
    let thresholds = vec![0.25; 80];
    let (mut best, mut found) = (Vec::new(), Vec::new());
    bencher.bench_local(|| {
        found.clear();
        head.decode(black_box(&output), &thresholds, &mut best, &mut found);
        found.len()
    });
}

#[divan::bench]
fn suppress_200_boxes(bencher: Bencher<'_, '_>) {
    let candidate = |at: u16| {
        let (x, y) = (f32::from(at % 20) * 10.0, f32::from(at / 20) * 9.0);
        Candidate {
            box_px: BoxPx::new(x, y, x + 30.0, y + 20.0).expect("a box"),
            score: f32::from(at * 37 % 200) / 200.0,
            class: at % 3,
            kind: at % 3,
        }
    };
    let all: Vec<_> = (0..200).map(candidate).collect();
    bencher
        .with_inputs(|| all.clone())
        .bench_local_values(|mut candidates| suppress(black_box(&mut candidates), 0.45, 300));
}
