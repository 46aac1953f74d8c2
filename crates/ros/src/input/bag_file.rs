//! MCAP files, message by message, without reading more of them than one needs.

use mcap::{
    McapError, Summary,
    sans_io::{
        SummaryReadEvent, SummaryReader, SummaryReaderOptions,
        indexed_reader::{IndexedReadEvent, IndexedReader, IndexedReaderOptions, ReadOrder},
    },
};
use std::{
    fs::File,
    io::{Read as _, Seek as _, SeekFrom},
    path::Path,
};

/// The index at a file's end; `None` where there is none.
pub(super) fn summary(path: &Path) -> Result<Option<Summary>, McapError> {
    let mut file = File::open(path)?;
    let size = file.metadata()?.len();
    let options = SummaryReaderOptions::default().with_file_size(size);
    let mut reader = SummaryReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            SummaryReadEvent::ReadRequest(wanted) => {
                let read = file.read(reader.insert(wanted))?;
                reader.notify_read(read);
            }
            SummaryReadEvent::SeekRequest(to) => reader.notify_seeked(file.seek(to)?),
        }
    }
    Ok(reader
        .finish()
        .filter(|summary| !summary.chunk_indexes.is_empty()))
}

/// The messages of one topic of one file, in order of their log times.
pub(super) struct TopicReader {
    file: File,
    reader: IndexedReader,
    chunk: Vec<u8>,
}

impl TopicReader {
    pub(super) fn open(
        path: &Path,
        summary: &Summary,
        topic: &str,
        order: ReadOrder,
    ) -> Result<Self, McapError> {
        let options = IndexedReaderOptions::new()
            .with_order(order)
            .include_topics([topic]);
        Ok(Self {
            file: File::open(path)?,
            reader: IndexedReader::new_with_options(summary, options)?,
            chunk: Vec::new(),
        })
    }

    /// The next message's bytes; `None` behind the last.
    pub(super) fn next(&mut self) -> Result<Option<Vec<u8>>, McapError> {
        while let Some(event) = self.reader.next_event() {
            match event? {
                IndexedReadEvent::ReadChunkRequest { offset, length } => {
                    self.file.seek(SeekFrom::Start(offset))?;
                    self.chunk.resize(length, 0);
                    self.file.read_exact(&mut self.chunk)?;
                    self.reader.insert_chunk_record_data(offset, &self.chunk)?;
                }
                IndexedReadEvent::Message { data, .. } => return Ok(Some(data.to_vec())),
            }
        }
        Ok(None)
    }
}
