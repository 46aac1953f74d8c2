//! A fetch that breaks off goes on where it was, and never joins what does not belong together.

use crate::{
    bench::{BROKEN_AT, Bench, REST, SIZE, ranges},
    server::{Server, Turn},
};
use roadwatch::models::{FetchError, News};
use std::fs;

#[test]
fn a_good_server_is_asked_once() {
    let mut bench = Bench::new();
    let requests = bench.expect_well(&[Turn::Serve]);
    assert_eq!(ranges(&requests), [None]);
    let done = News::Has {
        bytes: SIZE as u64,
        total: Some(SIZE as u64),
    };
    assert_eq!(bench.news.last(), Some(&done));
}

#[test]
fn a_server_that_stalls_is_left_and_asked_for_the_rest() {
    let mut bench = Bench::new();
    let requests = bench.expect_well(&[Turn::Stall(BROKEN_AT), Turn::Serve]);
    assert_eq!(ranges(&requests), [None, REST]);
    assert_eq!(requests[1].if_range.as_deref(), Some("\"1\""));
    assert_eq!(bench.breaks(), 1);
}

#[test]
fn a_server_that_never_answers_is_given_up() {
    let mut bench = Bench::new().sized(None);
    let silent = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let url = format!("http://{}/", silent.local_addr().expect("its address"));
    let error = bench.fetch(&url, 2).expect_err("it fails");
    let FetchError::GaveUp {
        tries: 2,
        reason,
        kept_bytes: 0,
        ..
    } = &error
    else {
        panic!("{error}");
    };
    assert!(reason.contains("timeout"), "{reason}");
    assert_eq!(bench.left(), [""; 0]);
}

#[test]
fn a_file_that_comes_in_three_pieces_is_joined() {
    let mut bench = Bench::new();
    let script = [Turn::Die(BROKEN_AT), Turn::Die(BROKEN_AT), Turn::Serve];
    let requests = bench.expect_well(&script);
    assert_eq!(ranges(&requests), [None, REST, Some("bytes=200000-")]);
}

#[test]
fn as_long_as_something_comes_nothing_is_given_up() {
    let mut bench = Bench::new();
    let mut script = vec![Turn::Die(BROKEN_AT / 5); 8];
    script.push(Turn::Serve);
    assert_eq!(bench.expect_well(&script).len(), 9);
}

#[test]
fn what_a_dead_server_sent_is_gone_on_with_in_the_next_run() {
    let mut bench = Bench::new();
    let server = bench.server(&[Turn::Die(BROKEN_AT), Turn::Serve]);
    let error = bench.fetch(&server.url(), 1).expect_err("it dies");
    let text = error.to_string();
    assert!(
        text.contains("the 100000 bytes that came are kept"),
        "{text}"
    );
    assert!(!bench.path().exists());
    bench.fetch(&server.url(), 1).expect("it is fetched");
    bench.expect_whole();
    assert_eq!(ranges(&server.requests()), [None, REST]);
}

#[test]
fn a_server_that_ignores_ranges_sends_it_all_once_more() {
    let mut bench = Bench::new();
    let requests = bench.expect_well(&[Turn::Die(BROKEN_AT), Turn::IgnoreRange]);
    assert_eq!(ranges(&requests), [None, REST]);
    assert!(bench.news.contains(&News::Anew));
}

#[test]
fn a_server_that_always_dies_at_the_same_byte_is_given_up() {
    let mut bench = Bench::new();
    let dying = vec![Turn::Claim(SIZE + 1); 9];
    let mut bench_unsized = Bench::new().sized(None);
    let (error, requests) = bench_unsized.expect_failure(&dying);
    assert!(
        matches!(error, FetchError::GaveUp { tries: 3, .. }),
        "{error}"
    );
    assert_eq!(requests.len(), 3);
    let (error, requests) = bench.expect_failure(&dying);
    assert!(matches!(error, FetchError::WrongLength { .. }), "{error}");
    assert_eq!(requests.len(), 1);
}

#[test]
fn halves_of_two_versions_are_never_joined() {
    for second in [Turn::ServeVersion("\"2\""), Turn::RestOf("\"2\"")] {
        let mut bench = Bench::new().unchecked();
        let older = Server::start(&vec![0; SIZE], &[Turn::Die(BROKEN_AT)]);
        let url = older.url();
        bench.fetch(&url, 1).expect_err("it dies");
        drop(older);
        // The same address, so that only the version tells.
        let newer = bench.server(&[second, Turn::ServeVersion("\"2\"")]);
        let from = bench.folder.path().join("models/model.onnx.part.from");
        let text = fs::read_to_string(&from).expect("where it is from");
        fs::write(&from, text.replace(&url, &newer.url())).expect("written");
        bench.fetch(&newer.url(), 3).expect("it is fetched");
        bench.expect_whole();
        assert_eq!(newer.requests()[0].range.as_deref(), REST);
    }
}

#[test]
fn without_hash_and_version_a_broken_fetch_begins_anew() {
    let mut bench = Bench::new().unchecked();
    let requests = bench.expect_well(&[Turn::DieUnversioned(BROKEN_AT), Turn::ServeUnversioned]);
    assert_eq!(ranges(&requests), [None, None]);
}

#[test]
fn what_came_from_another_address_is_not_gone_on_with() {
    let mut bench = Bench::new();
    let dying = bench.server(&[Turn::Die(BROKEN_AT)]);
    bench.fetch(&dying.url(), 1).expect_err("it dies");
    assert_eq!(ranges(&bench.expect_well(&[Turn::Serve])), [None]);
}

#[test]
fn a_server_that_announces_too_much_gave_everything_all_the_same() {
    let mut bench = Bench::new().sized(None);
    let requests = bench.expect_well(&[Turn::Claim(SIZE + 1000), Turn::Serve]);
    assert_eq!(ranges(&requests), [None, Some("bytes=300000-")]);
}

#[test]
fn a_server_in_trouble_is_asked_again() {
    let busy = Turn::Status("503 Service Unavailable");
    let mut bench = Bench::new();
    bench.expect_well(&[busy.clone(), busy.clone(), Turn::Serve]);
    let (error, _) = Bench::new().expect_failure(&[busy.clone(), busy.clone(), busy]);
    assert!(error.to_string().contains("the server says 503"), "{error}");
}

#[test]
fn redirects_are_followed_also_for_the_rest() {
    let mut bench = Bench::new();
    let moved = Turn::Redirect("/elsewhere");
    let requests = bench.expect_well(&[moved.clone(), Turn::Die(BROKEN_AT), moved, Turn::Serve]);
    let paths: Vec<_> = requests.iter().map(|request| &*request.path).collect();
    assert_eq!(
        paths,
        ["/model.onnx", "/elsewhere", "/model.onnx", "/elsewhere"]
    );
    assert_eq!(requests[3].range.as_deref(), REST);
}
