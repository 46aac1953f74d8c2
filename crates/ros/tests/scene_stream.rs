//! The scene stream, read over real sockets.

mod common;

use roadwatch_core::{Output, Rig, Sink as _};
use roadwatch_ros::{
    Messages, SceneStream, Surface,
    scene_stream::{MOST_READERS, QUEUED_SCENES},
};
use serde_json::Value;
use std::{
    io::{BufRead as _, BufReader, Read as _},
    net::{SocketAddr, TcpStream},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

const PATIENCE: Duration = Duration::from_secs(10);

fn stream() -> SceneStream {
    let rig: Arc<Rig> = Arc::new(common::two_cameras());
    let messages = Messages::new(rig, &Surface::default()).expect("legal names");
    SceneStream::listen(SocketAddr::from(([127, 0, 0, 1], 0)), messages).expect("a free port")
}

struct Lines(BufReader<TcpStream>);

impl Lines {
    fn of(stream: &SceneStream) -> Self {
        let socket = TcpStream::connect(stream.address()).expect("connected");
        socket.set_read_timeout(Some(PATIENCE)).expect("set");
        Self(BufReader::new(socket))
    }

    fn next(&mut self) -> Option<Value> {
        let mut line = String::new();
        self.0.read_line(&mut line).expect("a line in time");
        (!line.is_empty()).then(|| serde_json::from_str(&line).expect("JSON"))
    }
}

fn scene(seq: u64, copies: usize) -> Output {
    let outputs = common::outputs(0);
    let scene = outputs.iter().find_map(|output| match output {
        Output::Scene(scene) => Some(scene),
        Output::Camera(_) => None,
    });
    let mut scene = scene.expect("a scene").as_ref().clone();
    scene.seq = seq;
    let objects = scene.objects.clone();
    scene.objects = objects
        .iter()
        .cycle()
        .take(objects.len() * copies)
        .cloned()
        .collect();
    Output::Scene(Arc::new(scene))
}

fn until(what: &str, holds: impl Fn() -> bool) {
    let began = Instant::now();
    while !holds() {
        assert!(began.elapsed() < PATIENCE, "in vain: {what}");
        thread::park_timeout(Duration::from_millis(5));
    }
}

#[test]
fn a_reader_gets_the_rig_and_then_every_scene_to_the_last() {
    let mut stream = stream();
    let mut lines = Lines::of(&stream);
    until("connected", || stream.readers() == 1);
    for output in common::outputs(0) {
        stream.publish(&output).expect("published");
    }
    stream.finish().expect("finished");
    let rig = lines.next().expect("the rig");
    assert_eq!(rig["type"], "rig");
    assert_eq!(rig["cameras"].as_array().map(Vec::len), Some(2));
    let scene = lines.next().expect("the scene");
    assert_eq!(scene["type"], "scene");
    let objects = scene["scene"]["objects"].as_array().expect("objects");
    assert!(!objects.is_empty());
    assert_eq!(lines.next(), None, "closed behind the last line");
}

#[test]
fn a_slow_reader_is_sent_away_and_a_free_one_gets_everything() {
    /// Enough that no socket's buffers hold a queue of them: some megabyte each.
    const COPIES: usize = 1000;
    let mut stream = stream();
    let slow = TcpStream::connect(stream.address()).expect("connected");
    let mut free = Lines::of(&stream);
    until("both connected", || stream.readers() == 2);
    let output = scene(0, COPIES);
    let mut given = 0;
    let mut slowest = Duration::ZERO;
    free.next().expect("the rig");
    while stream.readers() == 2 {
        assert!(given < 10 * QUEUED_SCENES, "never sent away");
        let began = Instant::now();
        stream.publish(&output).expect("published");
        slowest = slowest.max(began.elapsed());
        given += 1;
        assert_eq!(free.next().expect("a scene")["type"], "scene");
    }
    assert!(given > QUEUED_SCENES, "had its queue: {given}");
    assert!(
        slowest < PATIENCE / 5,
        "publishing waits for nobody: {slowest:?}"
    );
    drop(slow);
    stream.publish(&scene(1, 1)).expect("published");
    assert_eq!(free.next().expect("a scene")["seq"], 1);
}

#[test]
fn who_went_away_is_forgotten_and_who_comes_late_gets_what_is_new() {
    let mut stream = stream();
    drop(TcpStream::connect(stream.address()).expect("connected"));
    until("connected", || stream.readers() == 1);
    let mut seq = 0;
    while stream.readers() == 1 {
        assert!(seq < 1000, "never forgotten");
        stream.publish(&scene(seq, 1)).expect("published");
        seq += 1;
        thread::park_timeout(Duration::from_millis(1));
    }
    let mut late = Lines::of(&stream);
    until("connected again", || stream.readers() == 1);
    stream.publish(&scene(4000, 1)).expect("published");
    assert_eq!(late.next().expect("the rig")["type"], "rig");
    assert_eq!(late.next().expect("a scene")["seq"], 4000);
}

#[test]
fn there_is_room_for_so_many_and_one_more_is_closed() {
    let stream = stream();
    let readers: Vec<_> = (0..MOST_READERS).map(|_| Lines::of(&stream)).collect();
    until("all connected", || stream.readers() == MOST_READERS);
    let mut one_more = TcpStream::connect(stream.address()).expect("connected");
    one_more.set_read_timeout(Some(PATIENCE)).expect("set");
    let mut nothing = Vec::new();
    let closed = one_more.read_to_end(&mut nothing);
    assert!(closed.is_err() || nothing.is_empty(), "{nothing:?}");
    drop(readers);
}

#[test]
fn the_end_does_not_wait_for_a_reader_that_takes_nothing() {
    let mut stream = stream();
    let stuck = TcpStream::connect(stream.address()).expect("connected");
    until("connected", || stream.readers() == 1);
    let output = scene(0, 1000);
    for _ in 0..QUEUED_SCENES / 2 {
        stream.publish(&output).expect("published");
    }
    let began = Instant::now();
    stream.finish().expect("finished");
    drop(stream);
    assert!(began.elapsed() < PATIENCE / 2, "{:?}", began.elapsed());
    drop(stuck);
}
