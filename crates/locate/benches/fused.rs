//! What a fused estimate costs beside the other methods, per object.

use divan::{Bencher, black_box};
use roadwatch_core::{
    BoxPx, CameraModel, CameraName, Detection, Distortion, ImageSize, Intrinsics, Known,
    Locator as _, Method, Mount, ObjectClass, RigCamera, Score,
};
use roadwatch_locate::{CameraLocator, LocatorOptions};

fn main() {
    divan::main();
}

#[divan::bench(args = [Method::TriangleFy, Method::Ground, Method::Fused])]
fn per_object(bencher: Bencher<'_, '_>, method: Method) {
    let locator = CameraLocator::new(&camera(), 0.0, LocatorOptions::new(method));
    let locator = locator.expect("needs nothing else");
    let cars = [(300.0, 20.0), (500.0, 30.0), (700.0, 60.0), (200.0, 120.0)].map(car);
    let mut next = cars.iter().cycle();
    bencher.bench_local(|| locator.locate(black_box(next.next()?), &Known::default()));
}

/// A box `height_px` high whose left edge is at `x_min`, standing on flat ground.
fn car((x_min, height_px): (f32, f32)) -> Detection {
    let bottom = 254.0 + height_px * 1.3;
    let boxed = BoxPx::new(x_min, bottom - height_px, x_min + 1.9 * height_px, bottom);
    Detection {
        class: ObjectClass::new("car"),
        score: Score::new(0.8).expect("a share"),
        input_pixel_px: 1.0,
        box_px: boxed.expect("a box"),
    }
}

fn camera() -> RigCamera {
    RigCamera {
        name: CameraName::new("front").expect("a name"),
        model: CameraModel {
            size: ImageSize {
                width_px: 960,
                height_px: 540,
            },
            intrinsics: Intrinsics {
                fx: 985.0,
                fy: 985.0,
                cx: 485.0,
                cy: 254.0,
            },
            distortion: Distortion::None,
        },
        base_from_optical: Mount::ahead([1.5, 0.0, 1.9]).base_from_optical(),
        measured_focal: None,
    }
}
