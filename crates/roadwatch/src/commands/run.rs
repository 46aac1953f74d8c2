//! `roadwatch run`.

use super::{output::say, scoring::Scoring, signals::stop_on_signals};
use crate::{
    cli::{Pace, RunArgs},
    clock::wall_time,
    config::{Changes, DatasetChoice},
    failure::Failure,
    node::{DaemonNode, RosoutTap},
    open::encoded,
    session::{Session, watch},
    status::{self, StatusLine},
};
use anyhow::{Context as _, anyhow};
use roadwatch_camera::{Pace as PlaybackPace, PlaybackOptions, Repeat, Speed};
use roadwatch_core::Sink;
use roadwatch_picture::{PictureSink, SCENE_FILE, VIEWS_FILE};
use roadwatch_pipeline::{Metrics, NamedSink, Overload, PipelineOptions};
use roadwatch_ros::{BagOptions, BagSink, LogTime, Messages, SceneStream, bag::EncodeImage};
use std::{
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

/// The recording's name among the sinks.
const BAG: &str = "bag";
/// The drawer's name among the sinks.
const PICTURES: &str = "pictures";
/// The scene stream's name among the sinks.
const SCENE_STREAM: &str = "scene stream";
/// One status line per second.
const STATUS_PERIOD: Duration = Duration::from_secs(1);

/// Runs the daemon until its sources end or a signal comes.
///
/// # Errors
/// Mistakes in the configuration, a bag or node that cannot be made, a bug in a stage.
pub fn run(args: &RunArgs, rosout: &RosoutTap) -> Result<(), Failure> {
    run_with(args, rosout, |_| Ok(None))
}

/// Another sink, beside those that the arguments ask for.
pub(super) struct Beside {
    /// It.
    pub(super) sink: NamedSink,
    /// Whether the run may end for its part.
    pub(super) is_done: Box<dyn Fn() -> bool>,
}

/// The same with another sink, made once everything else is open.
pub(super) fn run_beside(
    args: &RunArgs,
    rosout: &RosoutTap,
    beside: impl FnOnce(&Session) -> Result<Beside, Failure>,
) -> Result<(), Failure> {
    run_with(args, rosout, |session| beside(session).map(Some))
}

fn run_with(
    args: &RunArgs,
    rosout: &RosoutTap,
    beside: impl FnOnce(&Session) -> Result<Option<Beside>, Failure>,
) -> Result<(), Failure> {
    let stop = stop_on_signals()?;
    let changes = Changes {
        dataset: args.dataset.clone().map(DatasetChoice::from),
        ros: args.ros.read(),
    };
    let session = Session::open(&args.config, &changes, playback(args)?)?;
    let mut node = start_node(args, &session, rosout, &stop)?;
    let mut sinks = sinks(args, &session, node.as_ref())?;
    let (beside, is_done) = beside(&session)?.map(|one| (one.sink, one.is_done)).unzip();
    sinks.extend(beside);
    let is_done = || is_done.as_ref().is_some_and(|is_done| is_done());
    let stop_requested = || stop.load(Ordering::Relaxed) || is_done();
    let scoring = if args.score {
        let scoring = Scoring::prepare(&session)?;
        sinks.push(scoring.sink());
        Some(scoring)
    } else {
        None
    };
    let options = PipelineOptions {
        scene_timeout: session.config.scene_timeout,
        ..PipelineOptions::new(overload(args.pace))
    };
    let (rig, decodes) = (Arc::clone(&session.rig), session.decodes.clone());
    let ego_listener = node.as_ref().map(|node| session.ego_listener(node.node()));
    let _ego_listener = ego_listener
        .transpose()
        .context("the vehicle's motion cannot be listened to")?;
    let session = listening(session, node.as_ref(), stop_requested)?;
    let began = Instant::now();
    let running = session.start(sinks, options)?;
    let mut line = StatusLine::new(rig.cameras().len(), began);
    let report = |running: &roadwatch_pipeline::Running| {
        eprintln!("{}", line.next(&rig, running.metrics(), Instant::now()));
        if let Some(node) = &mut node {
            node.report(running.metrics());
        }
    };
    watch(&running, STATUS_PERIOD, stop_requested, report)?;
    let took = began.elapsed();
    eprintln!("{}", status::summary(&rig, running.metrics(), took));
    if let Some(scoring) = scoring {
        eprintln!("{}", scoring.report(args.frames).summary());
    }
    say_what_was_written(args);
    if args.json {
        say!(
            "{:#}",
            status::to_json(&rig, running.metrics(), took, decodes.get())
        );
    }
    recording_is_whole(running.metrics())
}

/// The node, where something is published or a topic feeds a camera.
fn start_node(
    args: &RunArgs,
    session: &Session,
    rosout: &RosoutTap,
    stop: &Arc<AtomicBool>,
) -> Result<Option<DaemonNode>, Failure> {
    let listens = session.has_topics();
    if listens && args.pace == Pace::Lossless {
        let what = anyhow!("topics do not wait: what they feed runs at --pace realtime");
        return Err(what.into());
    }
    if !listens && !session.config.node.publish {
        return Ok(None);
    }
    let started = DaemonNode::start(session, rosout, stop);
    Ok(Some(started.context("the ROS 2 node cannot be started")?))
}

/// With its cameras' topics listened to, once the node is active.
fn listening(
    session: Session,
    node: Option<&DaemonNode>,
    stop_requested: impl Fn() -> bool,
) -> Result<Session, Failure> {
    let Some(node) = node else {
        return Ok(session);
    };
    let listening = session.listening(node.node());
    let session = listening.context("the cameras' topics cannot be listened to")?;
    hold_back(node, session.config.node.autostart, stop_requested);
    Ok(session)
}

/// Returns when the node is active, or shall not be any more.
fn hold_back(node: &DaemonNode, autostart: bool, stop_requested: impl Fn() -> bool) {
    /// Often enough that nobody notices the wait.
    const LOOK: Duration = Duration::from_millis(50);
    if autostart {
        node.autostart();
        return;
    }
    eprintln!("waiting to be configured and activated (node.autostart is false)");
    let mut next_report = Instant::now();
    while !node.is_active() && !stop_requested() {
        if Instant::now() >= next_report {
            next_report += STATUS_PERIOD;
            node.report_waiting();
        }
        thread::park_timeout(LOOK);
    }
}

fn say_what_was_written(args: &RunArgs) {
    if let Some(folder) = &args.pictures {
        let folder = folder.display();
        eprintln!("pictures: {folder}/{VIEWS_FILE}, {folder}/{SCENE_FILE}");
    }
    if let Some(folder) = &args.bag {
        eprintln!("bag: {}", folder.display());
    }
}

/// A run whose recording lost something is no success, whoever watched it.
fn recording_is_whole(metrics: &Metrics) -> Result<(), Failure> {
    let Some(at) = metrics.sink_names().position(|name| name == BAG) else {
        return Ok(());
    };
    let counts = metrics.sink(at);
    let lost = counts.failed + counts.dropped;
    if lost == 0 {
        return Ok(());
    }
    Err(
        anyhow!("the bag is not complete: {lost} outputs were not recorded; the log says why")
            .into(),
    )
}

/// What a pace means to the pipeline.
#[must_use]
pub fn overload(pace: Pace) -> Overload {
    match pace {
        Pace::Realtime => Overload::NewestWins,
        Pace::Lossless => Overload::Wait,
    }
}

fn playback(args: &RunArgs) -> Result<PlaybackOptions, Failure> {
    let speed = Speed::new(args.speed)
        .with_context(|| format!("--speed {}: expected a number above zero", args.speed))?;
    Ok(PlaybackOptions {
        pace: match args.pace {
            Pace::Realtime => PlaybackPace::Recorded { speed },
            Pace::Lossless => PlaybackPace::AsFastAsPossible,
        },
        repeat: if args.repeat {
            Repeat::Loop
        } else {
            Repeat::Once
        },
        frame_limit: args.frames,
    })
}

fn sinks(
    args: &RunArgs,
    session: &Session,
    node: Option<&DaemonNode>,
) -> Result<Vec<NamedSink>, Failure> {
    let mut sinks = Vec::new();
    let mut add = |name: &str, sink: Box<dyn Sink>| {
        sinks.push(NamedSink {
            name: name.to_owned(),
            sink,
        });
    };
    if let Some(node) = node {
        let switches = &session.controls.switches;
        if let Some(sink) = node.sink() {
            add("ros2", switches.put_behind(Box::new(sink)));
        }
        let annotated = node.annotated_images(session);
        if let Some(sink) = annotated.context("no annotated images can be published")? {
            add("annotated", switches.put_behind(Box::new(sink)));
        }
    }
    if let Some(folder) = &args.bag {
        let log_time = match args.pace {
            Pace::Realtime => LogTime::WallClock(Box::new(wall_time)),
            Pace::Lossless => LogTime::Stamp,
        };
        let bytes = |megabytes: u64| megabytes.saturating_mul(1_000_000);
        let bag = BagSink::create(
            folder,
            Arc::clone(&session.rig),
            &session.config.node.options.surface,
            BagOptions {
                split_bytes: args.bag_split_mb.map(bytes),
                split_after: args.bag_split_secs.map(Duration::from_secs),
                images: args.bag_images.then(|| Box::new(encoded) as EncodeImage),
                ..BagOptions::new(log_time)
            },
        );
        add(BAG, Box::new(bag.context("nothing can be recorded")?));
    }
    if let Some(address) = args.scene_stream.or(session.config.scene_stream) {
        add(SCENE_STREAM, Box::new(scene_stream(address, session)?));
    }
    if let Some(folder) = &args.pictures {
        let sink = PictureSink::create(folder, Arc::clone(&session.rig));
        let sink =
            sink.with_context(|| format!("no pictures can be put into `{}`", folder.display()))?;
        add(PICTURES, Box::new(sink));
    }
    Ok(sinks)
}

fn scene_stream(address: SocketAddr, session: &Session) -> Result<SceneStream, Failure> {
    let surface = &session.config.node.options.surface;
    let messages = Messages::new(Arc::clone(&session.rig), surface);
    let messages = messages.context("no scene can be offered")?;
    let stream = SceneStream::listen(address, messages).with_context(|| {
        format!(
            "the scene cannot be offered on {address}: is another daemon there, or is it not an address of this \
             machine? Change `listen` in [scene_stream], or --scene-stream"
        )
    })?;
    eprintln!("scene stream: {}", stream.address());
    Ok(stream)
}
