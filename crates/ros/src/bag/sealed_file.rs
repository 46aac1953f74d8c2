//! A file that others can open while it is written, and after its writer was killed.

use std::{
    fs::File,
    io::{self, ErrorKind, Seek, SeekFrom, Write},
    os::unix::fs::FileExt as _,
};

/// How an MCAP file without an index ends: end of data, footer, magic (MCAP 1.0, "File Structure"). All numbers in them
/// are zero: no checksum, no summary.
const ENDING: [u8; 50] = {
    let mut bytes = [0; 50];
    // Opcode and length of the record.
    bytes[0] = 0x0F;
    bytes[1] = 4;
    bytes[13] = 0x02;
    bytes[14] = 20;
    let magic = *b"\x89MCAP0\r\n";
    let mut at = 0;
    while at < magic.len() {
        bytes[42 + at] = magic[at];
        at += 1;
    }
    bytes
};

/// Takes what is written, and puts it into the file when it is flushed, always with an ending behind it. What comes next
/// stands where that ending stood.
#[derive(Debug)]
pub(super) struct SealedFile {
    file: File,
    /// Where the ending stands.
    end: u64,
    pending: Vec<u8>,
}

impl SealedFile {
    pub(super) fn new(file: File) -> Self {
        Self {
            file,
            end: 0,
            pending: Vec::new(),
        }
    }

    /// Without the ending: what was written has its own.
    pub(super) fn close(mut self) -> io::Result<()> {
        self.write_pending(&[])?;
        self.file.set_len(self.end)?;
        self.file.sync_all()
    }

    /// In one write, so that the file is never without an ending for longer than that takes.
    fn write_pending(&mut self, ending: &[u8]) -> io::Result<()> {
        let written = self.pending.len();
        self.pending.extend(ending);
        self.file.write_all_at(&self.pending, self.end)?;
        self.end += written as u64;
        self.pending.clear();
        Ok(())
    }
}

impl Write for SealedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.pending.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.write_pending(&ENDING)
    }
}

impl Seek for SealedFile {
    /// Only says where it is.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) => Ok(self.end + self.pending.len() as u64),
            _ => Err(ErrorKind::Unsupported.into()),
        }
    }
}
