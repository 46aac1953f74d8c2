//! The scene on a TCP socket, as [`scene_lines`](crate::scene_lines): readers come and go, and none is waited for.

use crate::{
    convert::Messages,
    scene_lines::{rig_line, scene_line},
};
use roadwatch_core::{Output, Sink, SinkError};
use std::{
    io::{self, Write as _},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// Scenes that wait for a slow reader; six seconds at ten a second, beside what its socket holds.
pub const QUEUED_SCENES: usize = 64;
/// More readers are sent away: each costs a thread and its queue.
pub const MOST_READERS: usize = 32;
/// How soon a new reader, or the end of the stream, is noticed.
const LOOK: Duration = Duration::from_millis(50);

/// Offers scenes to whoever connects.
///
/// A reader gets the first line at once and then every scene. One whose queue is full when a scene comes is
/// disconnected and may connect again.
#[derive(Debug)]
pub struct SceneStream {
    messages: Messages,
    readers: Readers,
    address: SocketAddr,
    stopped: Arc<AtomicBool>,
    door: Option<JoinHandle<()>>,
}

type Readers = Arc<Mutex<Vec<Reader>>>;

/// One connection, with a thread that writes to it.
#[derive(Debug)]
struct Reader {
    address: SocketAddr,
    queue: SyncSender<Arc<str>>,
    line: Leaving,
}

/// A connection that gets what is in its queue and nothing more. Dropped, it is closed.
#[derive(Debug)]
struct Leaving {
    socket: TcpStream,
    writer: JoinHandle<()>,
}

impl SceneStream {
    /// Begins to listen.
    ///
    /// # Errors
    /// When the address cannot be listened on: taken, not this machine's, or not allowed.
    pub fn listen(address: SocketAddr, messages: Messages) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let readers = Readers::default();
        let stopped = Arc::new(AtomicBool::new(false));
        let first: Arc<str> = rig_line(&messages.line_rig()).into();
        let door = thread::Builder::new().name("scene-stream".to_owned());
        let (to, until) = (Arc::clone(&readers), Arc::clone(&stopped));
        let door = door.spawn(move || take_in(&listener, &first, &to, &until))?;
        Ok(Self {
            messages,
            readers,
            address,
            stopped,
            door: Some(door),
        })
    }

    /// Where it listens, with the port that was given when 0 was asked for.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// How many are connected, as far as it is known.
    #[must_use]
    pub fn readers(&self) -> usize {
        locked(&self.readers).len()
    }
}

impl Sink for SceneStream {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let Output::Scene(scene) = output else {
            return Ok(());
        };
        let mut readers = locked(&self.readers);
        if readers.is_empty() {
            return Ok(());
        }
        let line: Arc<str> = scene_line(scene.seq, &self.messages.scene_objects(scene)).into();
        readers.retain_mut(|reader| reader.give(&line));
        Ok(())
    }

    /// Everybody gets what waits for them, but for no longer than a second.
    fn finish(&mut self) -> Result<(), SinkError> {
        /// Time for the last lines.
        const FAREWELL: Duration = Duration::from_secs(1);
        self.stopped.store(true, Ordering::Relaxed);
        let until = Instant::now() + FAREWELL;
        let readers = std::mem::take(&mut *locked(&self.readers));
        let leaving: Vec<Leaving> = readers.into_iter().map(Reader::leave).collect();
        while leaving.iter().any(Leaving::is_writing) && Instant::now() < until {
            thread::park_timeout(LOOK);
        }
        Ok(())
    }
}

impl Drop for SceneStream {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
        locked(&self.readers).clear();
        if let Some(door) = self.door.take() {
            // It panics only by a bug, which its own message tells.
            let _told = door.join();
        }
    }
}

impl Reader {
    fn new(socket: TcpStream, address: SocketAddr, first: &Arc<str>) -> io::Result<Self> {
        socket.set_nonblocking(false)?;
        // A scene is worth more now than together with the next.
        socket.set_nodelay(true)?;
        let (queue, lines) = sync_channel(QUEUED_SCENES);
        let own = socket.try_clone()?;
        let first = Arc::clone(first);
        let thread = thread::Builder::new().name("scene-reader".to_owned());
        let writer = thread.spawn(move || write_lines(own, &first, &lines))?;
        Ok(Self {
            address,
            queue,
            line: Leaving { socket, writer },
        })
    }

    /// Whether it stays.
    fn give(&mut self, line: &Arc<str>) -> bool {
        match self.queue.try_send(Arc::clone(line)) {
            Ok(()) => true,
            Err(TrySendError::Disconnected(_)) => {
                tracing::info!(reader = %self.address, "a reader of the scene stream is gone");
                false
            }
            Err(TrySendError::Full(_)) => {
                tracing::warn!(
                    reader = %self.address,
                    "a reader of the scene stream is {QUEUED_SCENES} scenes behind and was disconnected"
                );
                false
            }
        }
    }

    fn leave(self) -> Leaving {
        self.line
    }
}

impl Leaving {
    fn is_writing(&self) -> bool {
        !self.writer.is_finished()
    }
}

impl Drop for Leaving {
    /// Wakes a writer that waits for its socket.
    fn drop(&mut self) {
        let _gone = self.socket.shutdown(Shutdown::Both);
    }
}

fn take_in(listener: &TcpListener, first: &Arc<str>, readers: &Readers, stopped: &AtomicBool) {
    while !stopped.load(Ordering::Relaxed) {
        match listener.accept() {
            Ok((socket, address)) => admit(socket, address, first, readers),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => thread::park_timeout(LOOK),
            Err(error) => {
                tracing::warn!(%error, "a reader of the scene stream could not connect");
                thread::park_timeout(LOOK);
            }
        }
    }
}

fn admit(socket: TcpStream, address: SocketAddr, first: &Arc<str>, readers: &Readers) {
    let mut readers = locked(readers);
    if readers.len() >= MOST_READERS {
        tracing::warn!(reader = %address, "{MOST_READERS} read the scene stream already");
        return;
    }
    match Reader::new(socket, address, first) {
        Ok(reader) => {
            tracing::info!(reader = %address, "reads the scene stream");
            readers.push(reader);
        }
        Err(error) => {
            tracing::warn!(reader = %address, %error, "cannot read the scene stream");
        }
    }
}

fn write_lines(mut socket: TcpStream, first: &str, lines: &Receiver<Arc<str>>) {
    if socket.write_all(first.as_bytes()).is_err() {
        return;
    }
    while let Ok(line) = lines.recv() {
        if socket.write_all(line.as_bytes()).is_err() {
            return;
        }
    }
}

fn locked(readers: &Readers) -> std::sync::MutexGuard<'_, Vec<Reader>> {
    readers
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}
