//! How fast a table of about 100,000 rows answers, against the scan.
//!
//! Percentiles of single queries come first (divan reports means of many); the clock's own reading time,
//! about 20 ns, is part of them.

use roadwatch_core::{
    BoxPx, CameraModel, CameraName, Distortion, ImageSize, Intrinsics, Mount, ObjectClass,
    RigCamera, SizeLwh, camera_model::Pixel,
};
use roadwatch_locate::{
    BoxNoise, ClassSizes, GridSpec, HullSpec, LocationTable, SizeGroup, TableIndex, TableLocator,
    TableOptions, TableQuery, build_table, table::Split,
};
use std::{
    hint::black_box,
    sync::{Arc, LazyLock},
    time::Instant,
};

const QUERIES: usize = 100_000;
/// A scan takes a thousand times as long, so fewer are enough.
const SCANS: usize = 500;
/// With the camera below, this step makes about 100,000 rows.
const STEP_M: f64 = 0.68;

static CAMERA: LazyLock<RigCamera> = LazyLock::new(camera);
static TABLE: LazyLock<Arc<LocationTable>> = LazyLock::new(table);
static INDEX: LazyLock<TableIndex> =
    LazyLock::new(|| TableIndex::new(TABLE.clone(), Split::axis(&CAMERA)));

fn main() {
    println!("rows {}", TABLE.rows().len());
    let index = &*INDEX;
    let like_a_detector = queries(Spread::Detector, 20.0);
    let nearest = report("detector-like, 20 px/m", &like_a_detector, |query| {
        black_box(index.nearest(query));
    });
    let scan = report("scan", &like_a_detector[..SCANS], |query| {
        black_box(index.scan(query));
    });
    println!("{:<28} {:.0}", "scan / index, median", scan / nearest);
    let wide = queries(Spread::Detector, 120.0);
    report("detector-like, box width", &wide, |query| {
        black_box(index.nearest(query));
    });
    let off_table = queries(Spread::OffTable, 20.0);
    report("off the table", &off_table, |query| {
        black_box(index.nearest(query));
    });
    report("16 nearest", &like_a_detector, |query| {
        black_box(index.nearest_rows::<16>(query));
    });
    report_locator(&like_a_detector);
    divan::main();
}

/// Prints percentiles and gives back the median, nanoseconds.
fn report<T>(what: &str, queries: &[T], mut ask: impl FnMut(&T)) -> f64 {
    let mut nanos: Vec<u128> = queries
        .iter()
        .map(|query| {
            let begun = Instant::now();
            ask(black_box(query));
            begun.elapsed().as_nanos()
        })
        .collect();
    nanos.sort_unstable();
    let at = |share: f64| nanos[((nanos.len() - 1) as f64 * share) as usize];
    let (median, p99) = (at(0.5), at(0.99));
    println!(
        "{what:<28} median {median} ns, p90 {} ns, p99 {p99} ns",
        at(0.9)
    );
    median as f64
}

/// The whole location with its covariance, which asks ten times.
fn report_locator(queries: &[TableQuery]) {
    let options = TableOptions::default();
    let locator = match TableLocator::new(&CAMERA, 0.0, TABLE.clone(), options) {
        Ok(locator) => locator,
        Err(error) => return println!("no locator: {error}"),
    };
    let sizes = ClassSizes::default();
    let boxes: Vec<BoxPx> = queries.iter().filter_map(box_of).collect();
    if let Some(class) = sizes.get(&ObjectClass::new("car")) {
        report("location with covariance", &boxes, |box_px| {
            black_box(locator.locate(class, box_px, &BoxNoise::default()));
        });
    }
}

fn box_of(query: &TableQuery) -> Option<BoxPx> {
    let height_px = 1.5 * 465.0 / f64::from(query.distance_m);
    let middle = Pixel::new(query.center_x_px.into(), query.center_y_px.into());
    let half = Pixel::new(height_px, height_px / 2.0);
    BoxPx::between(middle - half, middle + half)
}

#[derive(Clone, Copy)]
enum Spread {
    /// Three pixels on the middle, a tenth on the distance.
    Detector,
    /// Anywhere in the image at any distance.
    OffTable,
}

fn queries(spread: Spread, px_per_metre: f32) -> Vec<TableQuery> {
    let mut random = Random(11);
    let rows = TABLE.rows();
    let one = || {
        let row = rows[(random.unit() * rows.len() as f64) as usize];
        let (x, y, d) = match spread {
            Spread::Detector => (
                row.center_x_px + 3.0 * random.normal(),
                row.center_y_px + 3.0 * random.normal(),
                row.distance_m * (1.0 + 0.1 * random.normal()),
            ),
            Spread::OffTable => (
                960.0 * random.unit() as f32,
                540.0 * random.unit() as f32,
                100.0 * random.unit() as f32,
            ),
        };
        TableQuery {
            center_x_px: x,
            center_y_px: y,
            distance_m: d,
            px_per_metre,
        }
    };
    std::iter::repeat_with(one).take(QUERIES).collect()
}

#[divan::bench(sample_size = 1000)]
fn nearest(bencher: divan::Bencher<'_, '_>) {
    let queries = queries(Spread::Detector, 20.0);
    let mut next = queries.iter().cycle();
    bencher.bench_local(|| next.next().map(|query| INDEX.nearest(black_box(query))));
}

#[divan::bench(sample_count = 20, sample_size = 1)]
fn scan(bencher: divan::Bencher<'_, '_>) {
    let queries = queries(Spread::Detector, 20.0);
    let mut next = queries.iter().cycle();
    bencher.bench_local(|| next.next().map(|query| INDEX.scan(black_box(query))));
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn build() -> Arc<LocationTable> {
    table()
}

#[expect(
    clippy::expect_used,
    reason = "a bench without a table has nothing to measure"
)]
fn table() -> Arc<LocationTable> {
    let group = SizeGroup {
        classes: vec![ObjectClass::new("car")],
        size: SizeLwh {
            length_m: 5.1,
            width_m: 1.9,
            height_m: 1.5,
        },
    };
    let spec = GridSpec {
        step_m: STEP_M,
        ..GridSpec::default()
    };
    let hull = HullSpec::for_class(&group.classes[0]);
    let built = build_table(&CAMERA, 0.0, &spec, (group, &hull), |_| ());
    Arc::new(built.expect("the camera sees ground"))
}

/// A 92-degree camera 1.9 m above the ground, as on PandaSet's sides.
#[expect(clippy::expect_used, reason = "a literal")]
fn camera() -> RigCamera {
    RigCamera {
        name: CameraName::new("front").expect("a name"),
        model: CameraModel {
            size: ImageSize {
                width_px: 960,
                height_px: 540,
            },
            intrinsics: Intrinsics {
                fx: 465.0,
                fy: 465.0,
                cx: 486.0,
                cy: 254.0,
            },
            distortion: Distortion::None,
        },
        base_from_optical: Mount::ahead([1.5, 0.0, 1.9]).base_from_optical(),
        measured_focal: None,
    }
}

/// SplitMix64: the same queries on every machine.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f32 {
        ((0..12).map(|_| self.unit()).sum::<f64>() - 6.0) as f32
    }
}
