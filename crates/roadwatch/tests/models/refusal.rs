//! What is not the right file, or cannot be had, leaves nothing under the final name and says why.

use crate::{
    bench::{Bench, SIZE},
    server::Turn,
};
use roadwatch::models::{Arrival, FetchError, Sha256};
use std::{
    fs::{self, File},
    io::ErrorKind,
    path::Path,
};

#[test]
fn another_length_than_the_registrys_is_refused_before_it_is_fetched() {
    for claimed in [SIZE - 1000, SIZE + 1000] {
        let mut bench = Bench::new();
        let (error, _) = bench.expect_failure(&[Turn::Claim(claimed)]);
        let text = error.to_string();
        let expected = format!("has {claimed} bytes, the registry says 300000");
        assert!(text.contains(&expected), "{text}");
        assert_eq!(bench.left(), [""; 0]);
    }
}

#[test]
fn a_server_that_announces_too_little_is_found_out_by_the_hash() {
    let mut bench = Bench::new().sized(None);
    let (error, _) = bench.expect_failure(&[Turn::Claim(SIZE - 1000)]);
    assert!(matches!(error, FetchError::WrongHash { .. }), "{error}");
    assert_eq!(bench.left(), [""; 0]);
}

#[test]
fn more_bytes_than_the_registry_says_are_not_taken() {
    let mut bench = Bench::new().sized(Some(SIZE as u64 - 1));
    let (error, _) = bench.expect_failure(&[Turn::Unannounced]);
    assert!(
        matches!(error, FetchError::WrongLength { found: None, .. }),
        "{error}"
    );
    assert_eq!(bench.left(), [""; 0]);
}

#[test]
fn wrong_bytes_leave_nothing() {
    let mut bench = Bench::new();
    bench.content[SIZE / 2] ^= 1;
    let (error, _) = bench.expect_failure(&[Turn::Serve]);
    let text = error.to_string();
    assert!(
        text.contains(&Sha256::of_bytes(&bench.content).to_string()),
        "{text}"
    );
    assert_eq!(bench.left(), [""; 0]);
}

#[test]
fn where_nothing_tells_whole_from_half_nothing_is_fetched() {
    let mut bench = Bench::new().unchecked().sized(None);
    let (error, _) = bench.expect_failure(&[Turn::Unannounced]);
    assert!(matches!(error, FetchError::Unmeasured { .. }), "{error}");
    // With the hash known, that tells.
    Bench::new().sized(None).expect_well(&[Turn::Unannounced]);
}

#[test]
fn an_absent_file_is_not_asked_for_twice() {
    let (error, requests) = Bench::new().expect_failure(&[Turn::Status("404 Not Found")]);
    let text = error.to_string();
    assert!(
        text.contains("404 Not Found: the file is not there"),
        "{text}"
    );
    assert_eq!(requests.len(), 1);
}

#[test]
fn endless_redirects_end() {
    let circle = vec![Turn::Redirect("/model.onnx"); 40];
    let (error, _) = Bench::new().expect_failure(&circle);
    assert!(matches!(error, FetchError::Unusable { .. }), "{error}");
}

#[test]
fn where_nobody_listens_the_address_and_the_reason_are_said() {
    let mut bench = Bench::new();
    let url = bench.server(&[]).url();
    let error = bench.fetch(&url, 2).expect_err("it fails");
    let text = error.to_string();
    assert!(text.contains(&url) && text.contains("refused"), "{text}");
}

#[test]
fn a_file_that_is_there_is_not_fetched_again() {
    let mut bench = Bench::new();
    bench.expect_well(&[Turn::Serve]);
    let again = bench.fetch("http://127.0.0.1:1/", 1).expect("it is there");
    assert_eq!(again.arrival, Arrival::Before);
    fs::write(bench.path(), "something else").expect("written");
    let error = bench
        .fetch("http://127.0.0.1:1/", 1)
        .expect_err("it is another");
    assert!(matches!(error, FetchError::Occupied { .. }), "{error}");
    assert_eq!(fs::read(bench.path()).expect("the file"), b"something else");
}

fn expect_disk(error: &FetchError, at: &Path, expected: &[ErrorKind]) {
    let FetchError::Disk { path, cause } = error else {
        panic!("{error}");
    };
    assert_eq!(path, at);
    assert!(expected.contains(&cause.kind()), "{cause}");
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let mut bench = Bench::new();
    let folder = bench.folder.path().join("models");
    fs::write(&folder, "a file").expect("written");
    let error = bench.fetch("http://127.0.0.1:1/", 1).expect_err("it fails");
    expect_disk(
        &error,
        &folder,
        &[ErrorKind::NotADirectory, ErrorKind::AlreadyExists],
    );
}

#[test]
fn two_fetches_of_one_file_do_not_meet() {
    let mut bench = Bench::new();
    let part = bench.folder.path().join("models/model.onnx.part");
    fs::create_dir(part.parent().expect("a folder")).expect("made");
    let other = File::create(&part).expect("made");
    other.lock().expect("locked");
    let error = bench.fetch("http://127.0.0.1:1/", 1).expect_err("it fails");
    expect_disk(&error, &part, &[ErrorKind::WouldBlock]);
}
