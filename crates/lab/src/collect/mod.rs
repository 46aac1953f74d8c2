//! The field loop (section III-C): what cameras saw in operation becomes a rig dataset, with what the daemon said of it.
//!
//! The folder is a rig dataset like any other, without labels: when truth arrives it goes in as `truth.jsonl`, and
//! `evaluate`, `table build` and `rotation rows` take the folder.

mod estimates;
mod trigger;

pub use trigger::{SecondOpinion, Triggers};

use roadwatch_camera::{DatasetWriter, NewFrame};
use roadwatch_core::{EgoKnowledge, Image, Output, Perceived, Rig, Scene, Sink, SinkError};
use std::{
    collections::BTreeSet,
    error::Error,
    fs::{File, OpenOptions},
    io::{self, Write as _},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

const ESTIMATES_FILE: &str = "estimates.jsonl";

/// Makes a JPEG file of an image.
pub type AsJpeg = Box<dyn Fn(&Image) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> + Send>;

/// What is kept, and how much of it.
pub struct CollectOptions {
    /// Which rounds.
    pub triggers: Triggers,
    /// Other methods that are asked beside.
    pub others: Vec<SecondOpinion>,
    /// No more than this is written, bytes.
    pub budget_bytes: u64,
    /// How images become files.
    pub as_jpeg: AsJpeg,
}

/// How far a collection is; shared with who watches it.
#[derive(Debug, Default)]
pub struct Collected {
    rounds: AtomicU64,
    frames: AtomicU64,
    bytes: AtomicU64,
    ended: AtomicBool,
    failed: AtomicBool,
}

impl Collected {
    /// Rounds of the rig that were looked at.
    pub fn rounds(&self) -> u64 {
        self.rounds.load(Ordering::Relaxed)
    }

    /// Rounds that were kept.
    pub fn frames(&self) -> u64 {
        self.frames.load(Ordering::Relaxed)
    }

    /// Bytes written.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Whether something could not be written, which ended it.
    pub fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// Whether nothing more is taken: the budget is used up, or the disk takes no more.
    pub fn is_ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }
}

/// The sink that writes the dataset.
pub struct Collector {
    rig: Arc<Rig>,
    options: CollectOptions,
    writer: DatasetWriter,
    estimates: File,
    estimate_bytes: u64,
    /// Of each camera, its frame of the round that is not complete yet.
    round: Vec<Option<Arc<Perceived>>>,
    known: BTreeSet<u64>,
    collected: Arc<Collected>,
}

impl Collector {
    /// Begins a dataset in `folder`, which must be empty or not exist.
    ///
    /// # Errors
    /// When the folder holds something, or cannot be written to.
    pub fn create(folder: &Path, rig: Arc<Rig>, options: CollectOptions) -> io::Result<Self> {
        let writer = DatasetWriter::create(folder, rig.cameras())?;
        let estimates = OpenOptions::new()
            .create_new(true)
            .append(true)
            .open(folder.join(ESTIMATES_FILE))?;
        Ok(Self {
            round: vec![None; rig.cameras().len()],
            rig,
            options,
            writer,
            estimates,
            estimate_bytes: 0,
            known: BTreeSet::new(),
            collected: Arc::default(),
        })
    }

    /// How far it is, now and later.
    #[must_use]
    pub fn collected(&self) -> Arc<Collected> {
        Arc::clone(&self.collected)
    }

    fn take(&mut self, scene: &Scene) -> Result<(), Box<dyn Error + Send + Sync>> {
        let round = std::mem::replace(&mut self.round, vec![None; self.rig.cameras().len()]);
        let count = self.collected.rounds.fetch_add(1, Ordering::Relaxed);
        if self.collected.is_ended() {
            return Ok(());
        }
        let ask = |perceived: &Arc<Perceived>| trigger::opinions(perceived, &self.options.others);
        let opinions: Vec<_> = round.iter().map(|one| one.as_ref().map(ask)).collect();
        let asked = round
            .iter()
            .zip(&opinions)
            .filter_map(|(one, said)| one.as_ref().zip(said.as_ref()));
        let apart = asked
            .clone()
            .filter_map(|(one, said)| trigger::disagreement(one, said))
            .reduce(f64::max);
        let newcomers = trigger::identities(scene).any(|id| !self.known.contains(&id));
        if asked.clone().next().is_none() || !self.options.triggers.keep(count, newcomers, apart) {
            return Ok(());
        }
        self.known.extend(trigger::identities(scene));
        let number = self.writer.frames();
        let lines = asked.map(|(one, said)| estimates::line(&self.rig, number, one, said));
        let lines: String = lines.collect();
        let frame = self.frame(&round, scene)?;
        self.write(&frame, &lines)
    }

    fn frame(
        &self,
        round: &[Option<Arc<Perceived>>],
        scene: &Scene,
    ) -> Result<NewFrame, Box<dyn Error + Send + Sync>> {
        let image = |one: &Option<Arc<Perceived>>| {
            let Some(perceived) = one else {
                return Ok(None);
            };
            let frame = &perceived.tracks.frame;
            Ok(Some((
                frame.captured_at,
                (self.options.as_jpeg)(&frame.image)?,
            )))
        };
        let told = scene.ego.knowledge != EgoKnowledge::None;
        Ok(NewFrame {
            images: round
                .iter()
                .map(image)
                .collect::<Result<_, Box<dyn Error + Send + Sync>>>()?,
            ego: told.then_some((scene.stamp, scene.ego.odom_from_base.isometry)),
        })
    }

    /// Writes what the daemon said first: a line of an image that is not there is harmless, the other way round is not.
    fn write(&mut self, frame: &NewFrame, lines: &str) -> Result<(), Box<dyn Error + Send + Sync>> {
        let images = frame
            .images
            .iter()
            .flatten()
            .map(|(_, file)| file.len() as u64);
        let more = images.sum::<u64>() + lines.len() as u64;
        let used = self.writer.bytes() + self.estimate_bytes;
        if used + more > self.options.budget_bytes {
            self.collected.ended.store(true, Ordering::Relaxed);
            return Ok(());
        }
        let before = self.estimates.metadata()?.len();
        let written = self
            .estimates
            .write_all(lines.as_bytes())
            .and_then(|()| self.writer.push(frame));
        if let Err(error) = written {
            self.collected.failed.store(true, Ordering::Relaxed);
            self.collected.ended.store(true, Ordering::Relaxed);
            self.estimates.set_len(before)?;
            return Err(error.into());
        }
        self.estimate_bytes += lines.len() as u64;
        self.collected
            .frames
            .store(self.writer.frames(), Ordering::Relaxed);
        self.collected.bytes.store(used + more, Ordering::Relaxed);
        Ok(())
    }
}

impl Sink for Collector {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        match output {
            Output::Camera(perceived) => {
                let camera = perceived.tracks.frame.camera.index();
                self.round[camera] = Some(Arc::clone(perceived));
                Ok(())
            }
            Output::Scene(scene) => self.take(scene).map_err(|error| {
                SinkError::new("a round was not collected; those before are whole", error)
            }),
        }
    }
}
