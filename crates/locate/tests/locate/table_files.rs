//! A table's files: there and back, and every way they can be wrong.

use crate::common::{camera, car_hull, cars};
use roadwatch_locate::{
    GridSpec, LocationTable, build_table,
    table::{CsvOrigin, TableFormatError},
};
use sha2::{Digest, Sha256};

fn small_table() -> LocationTable {
    let spec = GridSpec {
        farthest_m: 20.0,
        lateral_m: 5.0,
        headings: 2,
        ..GridSpec::default()
    };
    let group = (cars(), &car_hull());
    build_table(&camera(985.0, 1.0, 0.0), 0.0, &spec, group, |_| ()).expect("a table")
}

/// The bytes with what the checksum covers changed and the checksum made right again.
fn forged(mut bytes: Vec<u8>, change: impl FnOnce(&mut [u8])) -> Vec<u8> {
    let content = bytes.len() - 32;
    change(&mut bytes[..content]);
    let checksum = Sha256::digest(&bytes[..content]);
    bytes[content..].copy_from_slice(&checksum);
    bytes
}

fn why(bytes: &[u8]) -> String {
    LocationTable::from_bytes(bytes)
        .expect_err("not a table")
        .to_string()
}

#[test]
fn a_table_comes_back_from_its_file_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("front.table");
    let table = small_table();
    for _ in 0..2 {
        table.write(&path).expect("written");
        assert_eq!(LocationTable::read(&path).expect("read"), table);
    }
    let files = std::fs::read_dir(folder.path()).expect("listed").count();
    assert_eq!(files, 1, "no part is left behind");
}

#[test]
fn a_file_that_is_cut_anywhere_is_no_table() {
    let bytes = small_table().to_bytes();
    for length in (0..bytes.len()).step_by(61).chain([bytes.len() - 1]) {
        let error = LocationTable::from_bytes(&bytes[..length]).expect_err("cut");
        match error {
            TableFormatError::NotATable => assert!(length < 8),
            TableFormatError::Truncated { found, .. } => assert_eq!(found, length as u64),
            other => panic!("{length}: {other}"),
        }
    }
}

#[test]
fn a_file_of_another_kind_a_newer_version_and_damage_are_told_apart() {
    let bytes = small_table().to_bytes();
    assert!(why(b"Area,Center_x\n1,2\n").starts_with("not a table"));
    assert!(why(&[]).starts_with("not a table"));
    let newer = forged(bytes.clone(), |content| content[8] = 2);
    assert_eq!(
        why(&newer),
        "a table of version 2; this program reads versions up to 1"
    );
    let mut flipped = bytes.clone();
    flipped[200] ^= 1;
    assert_eq!(why(&flipped), "damaged: the checksum does not match");
    let longer = [bytes, vec![0]].concat();
    assert_eq!(why(&longer), "damaged: bytes follow its end");
}

#[test]
fn a_nan_is_found_by_row_and_column() {
    let table = small_table();
    let rows = table.rows().len();
    // Third row from the end, fourth column, counted back from the checksum.
    let spoiled = forged(table.to_bytes(), |content| {
        let at = content.len() - 3 * 28 + 3 * 4;
        content[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    });
    let expected = format!("row {}, column Distance: not a finite number", rows - 2);
    assert_eq!(why(&spoiled), expected);
}

#[test]
fn a_table_without_rows_is_no_table() {
    let table = small_table();
    let bytes = table.to_bytes();
    let rows_at = bytes.len() - 32 - table.rows().len() * 28;
    let mut empty = bytes[..rows_at].to_vec();
    empty[16..24].fill(0);
    empty.extend([0; 32]);
    let empty = forged(empty, |_| ());
    assert_eq!(
        why(&empty),
        "the table is empty: it has a header but no row"
    );
}

#[test]
fn a_file_error_names_the_file() {
    let missing = std::path::Path::new("/no/such/folder/front.table");
    let read = LocationTable::read(missing)
        .expect_err("missing")
        .to_string();
    let written = small_table()
        .write(missing)
        .expect_err("no folder")
        .to_string();
    for message in [read, written] {
        assert!(
            message.starts_with("/no/such/folder/front.table: "),
            "{message}"
        );
    }
}

#[test]
fn a_table_of_another_camera_is_refused_with_both_names() {
    let mut other = camera(985.0, 1.5, 0.0);
    other.name = roadwatch_core::CameraName::new("back").expect("a name");
    let table = small_table();
    let error = table
        .check_camera(&other, 0.0)
        .expect_err("another mount")
        .to_string();
    assert!(
        error.contains("`front`") && error.contains("`back`"),
        "{error}"
    );
    assert!(table.check_camera(&camera(985.0, 1.0, 0.0), 0.0).is_ok());
    assert!(table.check_camera(&camera(985.0, 1.0, 0.0), 0.1).is_err());
}

#[test]
fn rows_come_back_from_csv_digit_by_digit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("front.csv");
    let table = small_table();
    table.write_csv(&path).expect("written");
    let text = std::fs::read_to_string(&path).expect("text");
    assert!(text.starts_with("Area,Center_x,Center_y,Distance,LocX,LocY,Loc\n"));
    let camera = camera(985.0, 1.0, 0.0);
    let imported = LocationTable::read_csv(&path, origin(&camera)).expect("read");
    assert_eq!(imported.rows(), table.rows());
    assert!((imported.header().grid.step_m - 1.0).abs() < 1e-6);
    assert!(imported.check_camera(&camera, 0.0).is_ok());
    assert_eq!(imported.header().expected.height_m, 1.5);
}

fn origin(camera: &roadwatch_core::RigCamera) -> CsvOrigin<'_> {
    static CARS: std::sync::OnceLock<roadwatch_locate::SizeGroup> = std::sync::OnceLock::new();
    CsvOrigin {
        camera,
        ground_z_m: 0.0,
        group: CARS.get_or_init(cars),
    }
}

#[test]
fn a_csv_says_what_is_wrong_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("front.csv");
    let camera = camera(985.0, 1.0, 0.0);
    let read = |text: &str| {
        std::fs::write(&path, text).expect("written");
        let refused = LocationTable::read_csv(&path, origin(&camera));
        refused.expect_err(text).to_string()
    };
    let titles = "Area,Center_x,Center_y,Distance,LocX,LocY,Loc\n";
    assert!(read("Area,Center_x,Center_y,LocX,LocY,Loc\n").contains("`Distance` is missing"));
    assert!(read(titles).contains("empty"));
    let nan = read(&format!("{titles}1,2,3,4,5,6,7\n1,2,3,NaN,5,6,7\n"));
    assert_eq!(nan, "row 2, column Distance: not a finite number");
    let word = read(&format!("{titles}1,2,3,far,5,6,7\n"));
    assert_eq!(word, "row 1, column Distance: `far` is not a number");
    let cell = read(&format!("{titles}1,2,3,4,5,6,7.5\n"));
    assert_eq!(cell, "row 1, column Loc: `7.5` is not a number");
    assert!(read(&format!("{titles}1,2,3\n")).contains("not readable as CSV"));
    let endless = read(&format!("{titles}1,2,3,4,inf,6,7\n"));
    assert_eq!(endless, "row 1, column LocX: not a finite number");
}

#[test]
fn places_on_no_possible_grid_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("front.csv");
    let camera = camera(985.0, 1.0, 0.0);
    let import = |places: &[&str]| {
        let rows = places.iter().map(|place| format!("1,2,3,4,{place},6,7\n"));
        let titles = "Area,Center_x,Center_y,Distance,LocX,LocY,Loc\n".to_owned();
        std::fs::write(&path, titles + &rows.collect::<String>()).expect("written");
        let refused = LocationTable::read_csv(&path, origin(&camera));
        refused.expect_err("no grid").to_string()
    };
    let columns =
        "the grid of places is impossible: 1 to 10000000 columns a step apart are possible";
    assert_eq!(import(&["0", "1", "2", "1e30"]), columns);
    assert_eq!(import(&["-3e38", "0", "1", "2", "3", "3e38"]), columns);
    let step = "the grid of places is impossible: its step must be more than 0 and at most 1000 m";
    assert_eq!(import(&["0", "1e30"]), step);
    assert_eq!(import(&["-3e38", "3e38"]), step);

    let table = small_table();
    let columns_at = |bytes: &[u8]| bytes.len() - table.rows().len() * 28 - 4;
    let none = forged(table.to_bytes(), |content| {
        let at = columns_at(content);
        content[at..at + 4].fill(0);
    });
    assert_eq!(why(&none), columns);
}

#[test]
fn a_csv_may_have_more_columns_in_any_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("front.csv");
    let text = ",Loc,LocY,LocX,Distance,Center_y,Center_x,Area\n0, 7.0,6,5,4,3,2,1\n";
    std::fs::write(&path, text).expect("written");
    let camera = camera(985.0, 1.0, 0.0);
    let table = LocationTable::read_csv(&path, origin(&camera)).expect("read");
    let row = table.rows()[0];
    assert_eq!(
        (row.area_px2, row.center_x_px, row.loc_y_m, row.loc),
        (1.0, 2.0, 6.0, 7)
    );
}
