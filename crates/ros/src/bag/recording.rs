//! One MCAP file in the profile `ros2`.

use super::metadata::{self, Summary};
use crate::{
    cdr::{self, EncodeError},
    convert::Outgoing,
    definitions,
    topics::Topic,
    type_hash::type_hash,
};
use mcap::{
    McapError, WriteOptions, Writer,
    records::{MessageHeader, Metadata},
};
use roadwatch_core::Timestamp;
use std::{
    collections::BTreeMap,
    fmt,
    io::{self, Seek, Write},
};

/// Small enough that a crash loses less than a second of a busy rig, large enough to compress.
const CHUNK_BYTES: u64 = 256 * 1024;
/// Fixed, so that two versions of a library do not make two bags differ.
const LIBRARY: &str = "roadwatch";

/// Why nothing, or nothing more, is recorded.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file could not be written.
    #[error("bag not written: {0}")]
    Write(#[from] McapError),
    /// The last bytes could not be written.
    #[error("bag not written: {0}")]
    Flush(#[from] io::Error),
    /// A message could not be encoded.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// An earlier write failed.
    #[error(
        "recording stopped after {messages} messages (those of the last second may be lost), \
         {lost_outputs} outputs lost since: {reason}"
    )]
    Stopped {
        /// Messages taken before.
        messages: u64,
        /// Outputs that came since.
        lost_outputs: u64,
        /// What the first failure was.
        reason: String,
    },
    /// The recording was finished already.
    #[error("the recording is finished")]
    Finished,
    /// A topic's type has no definition.
    #[error("no definition of {0}")]
    NoDefinition(&'static str),
}

/// An MCAP file being written to `W`.
///
/// The first failure ends the writing; from then on every call says so.
pub(crate) struct Recording<W: Write + Seek> {
    writer: Option<Writer<W>>,
    /// Per topic, by its place: the channel's id and the number of messages.
    channels: Vec<Channel>,
    bytes: u64,
    span: Option<(Timestamp, Timestamp)>,
    failure: Option<Failure>,
}

#[derive(Clone, Copy)]
struct Channel {
    id: u16,
    messages: u64,
}

struct Failure {
    reason: String,
    messages: u64,
    lost_outputs: u64,
}

impl Failure {
    fn as_error(&self) -> RecordingError {
        RecordingError::Stopped {
            messages: self.messages,
            lost_outputs: self.lost_outputs,
            reason: self.reason.clone(),
        }
    }
}

impl<W: Write + Seek> fmt::Debug for Recording<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Recording({:?})", self.summary())
    }
}

impl<W: Write + Seek> Recording<W> {
    /// Begins a file with a channel for every topic, those that will stay empty included.
    ///
    /// # Errors
    /// When the first bytes cannot be written.
    pub(crate) fn begin(file: W, topics: &[Topic]) -> Result<Self, RecordingError> {
        let mut writer = WriteOptions::new()
            .profile("ros2")
            .library(LIBRARY)
            .chunk_size(Some(CHUNK_BYTES))
            // A chunk goes to the file whole, so that a killed recording ends between two chunks.
            .disable_seeking(true)
            // Threads of its own would change the compressed bytes with the machine.
            .compression_threads(0)
            .create(file)?;
        let channels = topics
            .iter()
            .map(|topic| add_channel(&mut writer, topic))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            writer: Some(writer),
            channels,
            bytes: 0,
            span: None,
            failure: None,
        })
    }

    /// Records the messages of one output.
    ///
    /// # Errors
    /// When a message cannot be written, now or before.
    pub(crate) fn write(
        &mut self,
        outgoing: &[Outgoing],
        logged_at: Timestamp,
    ) -> Result<(), RecordingError> {
        if let Some(failure) = &mut self.failure {
            failure.lost_outputs += 1;
            return Err(failure.as_error());
        }
        for one in outgoing {
            if let Err(error) = self.write_one(one, logged_at) {
                self.stop(&error);
                return Err(error);
            }
        }
        Ok(())
    }

    /// Writes the metadata record and the summary, and hands the file back.
    ///
    /// # Errors
    /// When they cannot be written, or an earlier write failed.
    pub(crate) fn finish(&mut self, metadata: &str) -> Result<W, RecordingError> {
        if let Some(failure) = &self.failure {
            return Err(failure.as_error());
        }
        self.note(metadata)?;
        let mut writer = self.writer.take().ok_or(RecordingError::Finished)?;
        writer.finish()?;
        Ok(writer.into_inner())
    }

    /// Says what the bag holds, as `rosbag2` does: the last word counts.
    ///
    /// # Errors
    /// When it cannot be written, or the recording is finished.
    pub(crate) fn note(&mut self, metadata: &str) -> Result<(), RecordingError> {
        let writer = self.writer.as_mut().ok_or(RecordingError::Finished)?;
        writer.write_metadata(&Metadata {
            name: "rosbag2".to_owned(),
            metadata: [("serialized_metadata".to_owned(), metadata.to_owned())].into(),
        })?;
        Ok(())
    }

    /// Puts what was taken into the file: a chunk of its own, which a killed recording keeps.
    ///
    /// # Errors
    /// When it cannot be written; then the recording ends.
    pub(crate) fn flush(&mut self) -> Result<(), RecordingError> {
        let Some(writer) = &mut self.writer else {
            return Ok(());
        };
        let flushed = writer.flush().map_err(RecordingError::from);
        flushed.inspect_err(|error| self.stop(error))
    }

    /// Bytes of messages taken, before compression.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// What is recorded so far.
    pub(crate) fn summary(&self) -> Summary {
        Summary {
            messages: self
                .channels
                .iter()
                .map(|channel| channel.messages)
                .collect(),
            span: self.span,
        }
    }

    fn write_one(&mut self, one: &Outgoing, logged_at: Timestamp) -> Result<(), RecordingError> {
        let writer = self.writer.as_mut().ok_or(RecordingError::Finished)?;
        let channel = &mut self.channels[one.topic];
        // MCAP has no times before 1970.
        let time_ns = u64::try_from(logged_at.as_nanos()).unwrap_or(0);
        let header = MessageHeader {
            channel_id: channel.id,
            // Wraps after four billion messages, as the format allows.
            sequence: channel.messages as u32,
            log_time: time_ns,
            publish_time: time_ns,
        };
        let bytes = cdr::encode(&one.message)?;
        writer.write_to_known_channel(&header, &bytes)?;
        self.bytes += bytes.len() as u64;
        channel.messages += 1;
        self.span = Some(match self.span {
            None => (logged_at, logged_at),
            Some((first, last)) => (first.min(logged_at), last.max(logged_at)),
        });
        Ok(())
    }

    /// Ends the recording for a reason of its own; gives that reason.
    pub(crate) fn give_up(&mut self, cause: io::Error) -> RecordingError {
        let error = RecordingError::Flush(cause);
        self.stop(&error);
        error
    }

    /// Closes the file where it is. Bytes still buffered are dropped with it.
    fn stop(&mut self, error: &RecordingError) {
        self.writer = None;
        self.failure = Some(Failure {
            reason: error.to_string(),
            messages: self.summary().total(),
            lost_outputs: 1,
        });
    }
}

fn add_channel<W: Write + Seek>(
    writer: &mut Writer<W>,
    topic: &Topic,
) -> Result<Channel, RecordingError> {
    let ros_type = topic.kind.ros_type();
    let schema = definitions::schema(ros_type).ok_or(RecordingError::NoDefinition(ros_type))?;
    let name = metadata::long_type_name(ros_type);
    let schema_id = writer.add_schema(&name, "ros2msg", schema.as_bytes())?;
    let hash = type_hash(ros_type).ok_or(RecordingError::NoDefinition(ros_type))?;
    // The keys that `rosbag2_storage_mcap` reads.
    let about = BTreeMap::from([
        (
            "offered_qos_profiles".to_owned(),
            metadata::offered_qos(topic),
        ),
        ("topic_type_hash".to_owned(), hash),
    ]);
    let id = writer.add_channel(schema_id, &topic.name, "cdr", &about)?;
    Ok(Channel { id, messages: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{convert::Messages, surface::Surface, testing};
    use std::{
        cell::RefCell,
        io::{ErrorKind, SeekFrom},
        rc::Rc,
        sync::Arc,
    };

    /// A disk with room for `room` bytes; what it holds can be looked at from outside.
    #[derive(Debug)]
    struct Disk {
        held: Rc<RefCell<Vec<u8>>>,
        room: usize,
    }

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let mut held = self.held.borrow_mut();
            let taken = bytes.len().min(self.room - held.len());
            if taken == 0 && !bytes.is_empty() {
                return Err(ErrorKind::StorageFull.into());
            }
            held.extend(&bytes[..taken]);
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Disk {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            match to {
                SeekFrom::Current(0) => Ok(self.held.borrow().len() as u64),
                _ => Err(ErrorKind::Unsupported.into()),
            }
        }
    }

    fn messages() -> Messages {
        Messages::new(Arc::new(testing::two_cameras()), &Surface::default()).expect("legal names")
    }

    /// Records rounds until one fails; the recording and the number of outputs that went well.
    fn fill(held: &Rc<RefCell<Vec<u8>>>, room: usize) -> (Recording<Disk>, usize) {
        let messages = messages();
        let disk = Disk {
            held: held.clone(),
            room,
        };
        let mut recording = Recording::begin(disk, messages.topics()).expect("begun");
        for (recorded, output) in (0..).flat_map(testing::outputs).enumerate() {
            if recording
                .write(&messages.of(&output), output.stamp())
                .is_err()
            {
                return (recording, recorded);
            }
        }
        unreachable!("the disk has an end")
    }

    #[test]
    fn a_full_disk_is_an_error_each_time_and_in_the_end() {
        let held = Rc::default();
        let (mut recording, recorded) = fill(&held, 200_000);
        assert!(recorded > 10);
        let messages = messages();
        for lost in 2..5 {
            let output = &testing::outputs(0)[0];
            let error = recording.write(&messages.of(output), output.stamp());
            assert!(
                matches!(error, Err(RecordingError::Stopped { lost_outputs, .. }) if lost_outputs == lost)
            );
        }
        let error = recording.finish("").expect_err("incomplete");
        assert!(
            error.to_string().starts_with("recording stopped after"),
            "{error}"
        );
        assert!(error.to_string().contains("4 outputs lost"), "{error}");
    }

    #[test]
    fn what_was_written_before_the_disk_was_full_stays_readable() {
        let held = Rc::default();
        fill(&held, 200_000);
        let bytes = held.borrow();
        let stream = mcap::MessageStream::new_with_options(
            &bytes,
            mcap::read::Options::IgnoreEndMagic.into(),
        );
        let readable = stream
            .expect("the beginning")
            .take_while(Result::is_ok)
            .count();
        assert!(readable > 1000, "{readable}");
    }

    #[test]
    fn wherever_the_disk_ends_the_recording_ends_with_an_error_not_a_panic() {
        let messages = messages();
        let finished_with = |room| {
            let held = Rc::default();
            let mut recording = Recording::begin(Disk { held, room }, messages.topics())?;
            for output in (0..3).flat_map(testing::outputs) {
                recording.write(&messages.of(&output), output.stamp())?;
            }
            recording.finish("metadata").map(|_| ())
        };
        let (small, large) = (0..20_000, 200_000);
        assert!(finished_with(large).is_ok());
        let failed = small
            .step_by(61)
            .filter(|&room| finished_with(room).is_err());
        assert!(failed.count() > 50);
    }

    #[test]
    fn a_disk_without_room_for_the_beginning_is_an_error_at_once() {
        let disk = Disk {
            held: Rc::default(),
            room: 3,
        };
        assert!(Recording::begin(disk, messages().topics()).is_err());
    }
}
