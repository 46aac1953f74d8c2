//! Who listens to what the node publishes.

use rustdds::{
    DomainParticipant, DomainParticipantStatusEvent as Event, GUID, QosPolicies,
    discovery::DiscoveredReaderData,
    policy::{Durability, Reliability},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

/// Who asks is also found within this time; `rmw_fastrtps` waits for a tenth of a second.
const REPLY_PATIENCE: Duration = Duration::from_millis(300);
/// A reader under Cyclone DDS passes over what comes before the writer's first heartbeat, which follows the match.
const SETTLING: Duration = Duration::from_millis(50);
/// Between two looks.
const LOOK: Duration = Duration::from_millis(1);

/// Counts the readers of every topic, as discovery tells of them.
pub(super) struct Audience {
    participant: DomainParticipant,
    known: Mutex<Known>,
}

#[derive(Default)]
struct Known {
    /// Readers of each topic, by the name DDS has for it.
    topics: BTreeMap<String, Arc<AtomicUsize>>,
    /// Our endpoints and what ROS calls their topics.
    endpoints: BTreeMap<GUID, String>,
    /// Readers that our writers reach, and since when.
    matched: BTreeMap<GUID, Instant>,
    /// Readers and writers that were found not to fit, so that each is told of once.
    unfit: BTreeSet<GUID>,
}

impl Audience {
    pub(super) fn new(participant: DomainParticipant) -> Self {
        Self {
            participant,
            known: Mutex::default(),
        }
    }

    /// The number of readers of `topic`, kept up to date. Our endpoint on it is `endpoint`.
    pub(super) fn of(&self, topic: &str, endpoint: GUID) -> Arc<AtomicUsize> {
        let readers = {
            let mut known = self.lock();
            known.endpoints.insert(endpoint, topic.to_owned());
            Arc::clone(known.topics.entry(dds_name(topic)).or_default())
        };
        self.count();
        readers
    }

    /// Our endpoint `endpoint` listens to `topic`.
    pub(super) fn listens(&self, topic: &str, endpoint: GUID) {
        self.lock().endpoints.insert(endpoint, topic.to_owned());
    }

    pub(super) fn hear(&self, event: &Event) {
        match event {
            Event::RemoteReaderMatched { remote_reader, .. } => {
                let now = Instant::now();
                self.lock().matched.entry(*remote_reader).or_insert(now);
                self.count();
            }
            Event::ReaderLost { guid, .. } => {
                self.forget(|known| known == guid);
                self.count();
            }
            Event::WriterLost { guid, .. } => self.forget(|known| known == guid),
            Event::ParticipantLost { id, .. } => {
                self.forget(|known| known.prefix == *id);
                self.count();
            }
            Event::ReaderDetected { .. } => self.count(),
            Event::RemoteReaderQosIncompatible {
                local_writer,
                remote_reader,
                requested_qos,
                offered_qos,
            } => {
                let (ours, theirs) = (*local_writer, *remote_reader);
                self.warn(ours, theirs, "reader", misfits(requested_qos, offered_qos));
            }
            Event::RemoteWriterQosIncompatible {
                local_reader,
                remote_writer,
                requested_qos,
                offered_qos,
            } => {
                let (ours, theirs) = (*local_reader, *remote_writer);
                self.warn(
                    ours,
                    theirs,
                    "publisher",
                    misfits(requested_qos, offered_qos),
                );
            }
            _ => {}
        }
    }

    /// Waits until a reader of the DDS topic `topic` is reached in the process that the GUID `asker` is of, but not for
    /// ever: what is written before that, a volatile writer does not repeat.
    pub(super) fn wait_for(&self, topic: &str, asker: GUID) {
        let until = Instant::now() + REPLY_PATIENCE;
        while !self.is_reached(topic, asker) && Instant::now() < until {
            thread::park_timeout(LOOK);
        }
    }

    fn is_reached(&self, topic: &str, asker: GUID) -> bool {
        let known = self.lock();
        let readers = self.participant.discovered_readers();
        readers.iter().any(|reader| {
            let guid = reader.reader_proxy.remote_reader_guid;
            let is_settled = |since: &Instant| since.elapsed() >= SETTLING;
            guid.prefix == asker.prefix
                && known.matched.get(&guid).is_some_and(is_settled)
                && reader.subscription_topic_data.topic_name() == topic
        })
    }

    /// Who is gone is neither reached nor unfit any more.
    fn forget(&self, is_gone: impl Fn(&GUID) -> bool) {
        let mut known = self.lock();
        known.matched.retain(|guid, _| !is_gone(guid));
        known.unfit.retain(|guid| !is_gone(guid));
    }

    /// The number of readers of `topic` that have been discovered.
    pub(super) fn readers_of(&self, topic: &str) -> usize {
        count_of(&self.participant.discovered_readers(), &dds_name(topic))
    }

    fn count(&self) {
        let readers = self.participant.discovered_readers();
        for (name, count) in &self.lock().topics {
            count.store(count_of(&readers, name), Ordering::Relaxed);
        }
    }

    fn warn(&self, ours: GUID, theirs: GUID, what: &str, misfits: String) {
        let mut known = self.lock();
        if !known.unfit.insert(theirs) {
            return;
        }
        if let Some(topic) = known.endpoints.get(&ours) {
            tracing::warn!(%topic, endpoint = ?theirs, "a {what} does not fit and gets nothing: {misfits}");
        }
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Readers of a topic by the name DDS has for it.
fn count_of(readers: &[DiscoveredReaderData], name: &str) -> usize {
    let names = readers
        .iter()
        .map(|reader| reader.subscription_topic_data.topic_name());
    names.filter(|of| *of == name).count()
}

/// What ROS's topic is called in DDS (ROS 2 design, "Topic and Service name mapping to DDS").
fn dds_name(topic: &str) -> String {
    format!("rt{topic}")
}

/// Where what a reader asks for is more than what a writer offers.
fn misfits(requested: &QosPolicies, offered: &QosPolicies) -> String {
    let mut found = Vec::new();
    let is_reliable =
        |qos: &QosPolicies| matches!(qos.reliability(), Some(Reliability::Reliable { .. }));
    if is_reliable(requested) && !is_reliable(offered) {
        found.push("the reader asks for reliable, the writer offers best effort");
    }
    let keeps = |qos: &QosPolicies| qos.durability().unwrap_or(Durability::Volatile);
    if keeps(requested) > keeps(offered) {
        found.push("the reader asks for transient local, the writer offers volatile");
    }
    if found.is_empty() {
        found.push("deadline, liveliness, ownership or order of delivery differ");
    }
    found.join("; ")
}
