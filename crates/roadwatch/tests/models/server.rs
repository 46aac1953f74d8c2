//! An HTTP server that does to one client after another what its script says.

use std::{
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

/// What is done with one request.
#[derive(Debug, Clone)]
pub(crate) enum Turn {
    /// Answer as a good server does: the rest where that is asked for and nothing changed, else everything.
    Serve,
    /// The same, without an ETag.
    ServeUnversioned,
    /// The same, with another ETag.
    ServeVersion(&'static str),
    /// Answer with the rest of another version, as servers do that do not know `If-Range`.
    RestOf(&'static str),
    /// Answer with everything, whatever was asked for.
    IgnoreRange,
    /// Announce everything that is left, send so many bytes of it, and close.
    Die(usize),
    /// The same, without an ETag.
    DieUnversioned(usize),
    /// Announce everything that is left, send so many bytes of it, and keep silent until the client goes.
    Stall(usize),
    /// Announce so many bytes, send everything, and close.
    Claim(usize),
    /// Announce nothing, send everything, and close.
    Unannounced,
    /// Answer with this status line.
    Status(&'static str),
    /// Send the client to this path.
    Redirect(&'static str),
}

/// A request as it came.
#[derive(Debug, Clone, Default)]
pub(crate) struct Request {
    pub(crate) path: String,
    pub(crate) range: Option<String>,
    pub(crate) if_range: Option<String>,
}

pub(crate) struct Server {
    address: SocketAddr,
    requests: Arc<Mutex<Vec<Request>>>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Serves `content` at every path. After the last turn nobody listens any more.
    pub(crate) fn start(content: &[u8], script: &[Turn]) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address");
        let requests = Arc::new(Mutex::new(Vec::new()));
        let ends = Arc::new(AtomicBool::new(false));
        let serving = Serving {
            content: content.to_vec(),
            requests: Arc::clone(&requests),
            ends: Arc::clone(&ends),
        };
        let script = script.to_vec();
        let thread = thread::Builder::new()
            .name("model server".to_owned())
            .spawn(move || serving.run(&listener, script))
            .expect("a thread");
        Self {
            address,
            requests,
            ends,
            thread: Some(thread),
        }
    }

    pub(crate) fn url(&self) -> String {
        format!("http://{}/model.onnx", self.address)
    }

    /// What was asked so far.
    pub(crate) fn requests(&self) -> Vec<Request> {
        self.requests.lock().expect("no panic").clone()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::SeqCst);
        // Wakes the server where it waits for a client; where it has ended already nobody listens.
        drop(TcpStream::connect(self.address));
        if let Some(thread) = self.thread.take() {
            assert!(
                thread.join().is_ok() || thread::panicking(),
                "the server panicked"
            );
        }
    }
}

struct Serving {
    content: Vec<u8>,
    requests: Arc<Mutex<Vec<Request>>>,
    ends: Arc<AtomicBool>,
}

impl Serving {
    fn run(&self, listener: &TcpListener, script: Vec<Turn>) {
        for turn in script {
            let (mut stream, _) = listener.accept().expect("a client");
            if self.ends.load(Ordering::SeqCst) {
                return;
            }
            let request = read_request(&stream);
            self.requests
                .lock()
                .expect("no panic")
                .push(request.clone());
            // A client may go as soon as it has heard enough.
            drop(self.answer(&mut stream, &request, &turn));
        }
    }

    fn answer(
        &self,
        stream: &mut TcpStream,
        request: &Request,
        turn: &Turn,
    ) -> std::io::Result<()> {
        let all = self.content.len();
        match *turn {
            Turn::Serve => self.send(stream, request, Some("\"1\""), all),
            Turn::ServeUnversioned => self.send(stream, request, None, all),
            Turn::ServeVersion(etag) => self.send(stream, request, Some(etag), all),
            Turn::RestOf(etag) => {
                let unconditional = Request {
                    if_range: None,
                    ..request.clone()
                };
                self.send(stream, &unconditional, Some(etag), all)
            }
            Turn::IgnoreRange => self.send(stream, &Request::default(), Some("\"1\""), all),
            Turn::Die(bytes) => self.send(stream, request, Some("\"1\""), bytes),
            Turn::DieUnversioned(bytes) => self.send(stream, request, None, bytes),
            Turn::Stall(bytes) => {
                self.send(stream, request, Some("\"1\""), bytes)?;
                // Ends when the client has closed its side.
                stream.read(&mut [0]).map(|_| ())
            }
            Turn::Claim(bytes) => {
                write!(
                    stream,
                    "HTTP/1.1 200 OK\r\nContent-Length: {bytes}\r\nConnection: close\r\n\r\n"
                )?;
                stream.write_all(&self.content)
            }
            Turn::Unannounced => {
                write!(stream, "HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n")?;
                stream.write_all(&self.content)
            }
            Turn::Status(status) => write!(
                stream,
                "HTTP/1.1 {status}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
            ),
            Turn::Redirect(path) => write!(
                stream,
                "HTTP/1.1 302 Found\r\nLocation: {path}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
            ),
        }
    }

    /// Announces what `request` asks for and sends `most` bytes of it.
    fn send(
        &self,
        stream: &mut TcpStream,
        request: &Request,
        etag: Option<&str>,
        most: usize,
    ) -> std::io::Result<()> {
        let all = self.content.len();
        let unchanged = request.if_range.is_none() || request.if_range.as_deref() == etag;
        let first = request.range.as_ref().filter(|_| unchanged).map(|range| {
            let first = range
                .strip_prefix("bytes=")
                .and_then(|range| range.strip_suffix('-'));
            first
                .and_then(|first| first.parse().ok())
                .expect("one open range")
        });
        let version = etag
            .map(|etag| format!("ETag: {etag}\r\n"))
            .unwrap_or_default();
        let head = match first {
            Some(first) if first >= all => {
                format!(
                    "416 Range Not Satisfiable\r\nContent-Range: bytes */{all}\r\nContent-Length: 0"
                )
            }
            Some(first) => format!(
                "206 Partial Content\r\nContent-Range: bytes {first}-{}/{all}\r\nContent-Length: {}",
                all - 1,
                all - first
            ),
            None => format!("200 OK\r\nContent-Length: {all}"),
        };
        write!(
            stream,
            "HTTP/1.1 {head}\r\n{version}Connection: close\r\n\r\n"
        )?;
        let rest = &self.content[first.unwrap_or(0).min(all)..];
        stream.write_all(&rest[..most.min(rest.len())])
    }
}

fn read_request(stream: &TcpStream) -> Request {
    let mut request = Request::default();
    for line in BufReader::new(stream).lines() {
        let line = line.expect("a line");
        if line.is_empty() {
            break;
        }
        if let Some(rest) = line.strip_prefix("GET ") {
            request.path = rest.split(' ').next().unwrap_or_default().to_owned();
        }
        let Some((name, value)) = line.split_once(": ") else {
            continue;
        };
        match name.to_lowercase().as_str() {
            "range" => request.range = Some(value.to_owned()),
            "if-range" => request.if_range = Some(value.to_owned()),
            _ => {}
        }
    }
    request
}
