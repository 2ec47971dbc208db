//! An open recording of any kind: its header and its messages, even if the file is truncated.

use crate::compressed;
use crate::index::{Index, IndexEntry};
use crate::json_string;
use crate::records::{Extent, Record, for_each_record};
use crate::source::Source;
use crate::{BEGAN, CHECKSUM, Facts, Kind, RESULT, VERSION, checksum};
use messages::Message;
use primitives::SimTime;
use primitives::codec::{self, DecodeError};
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file cannot be opened or read as a recording.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The file does not exist or cannot be read.
    #[error("cannot read the recording {path}: {reason}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        reason: std::io::Error,
    },
    /// An invalid MOOS log, with file and line.
    #[error("{0}")]
    Log(String),
    /// The file can no longer be read.
    #[error("cannot read the rest of the recording: {0}")]
    Unread(#[from] std::io::Error),
    /// The file is not a Squall recording.
    #[error("not a recording of a game or a gateway: {0}")]
    Foreign(String),
    /// The recording is of a different kind.
    #[error("not a recording of a {wanted}: it is a recording of a {found}")]
    Kind {
        /// The expected kind.
        wanted: Kind,
        /// The kind found.
        found: Kind,
    },
    /// The recording was made by a different version, whose messages may differ in meaning.
    #[error("recorded by Squall {found}; this program is {ours}", ours = primitives::VERSION)]
    Version {
        /// The recorder's version.
        found: String,
    },
    /// A message does not decode.
    #[error("message {number} of {topic} is damaged: {reason}")]
    Damaged {
        /// The topic.
        topic: String,
        /// Number of the message within the topic, from 0.
        number: u32,
        /// The decoding error.
        reason: DecodeError,
    },
    /// A message does not contain the expected JSON.
    #[error("message {number} of {topic} is not JSON: {reason}")]
    Json {
        /// The topic.
        topic: String,
        /// Number of the message within the topic, from 0.
        number: u32,
        /// The parsing error.
        reason: serde_json::Error,
    },
}

impl RecordingError {
    pub(crate) fn not_understood(what: &str, reason: impl std::fmt::Display) -> RecordingError {
        RecordingError::Foreign(format!("its {what} cannot be parsed: {reason}"))
    }
}

/// A recording of any kind.
#[derive(Debug)]
pub struct Bag {
    source: Source,
    /// The kind of recording.
    pub kind: Kind,
    facts: Facts,
    /// Start of the recording: UTC, ns since 1970.
    pub began_utc_ns: u64,
    /// The facts written at the end of the recording; `None` if the file is truncated.
    pub result: Option<Facts>,
    /// Whether the file is truncated.
    pub is_cut: bool,
    /// Byte ranges whose checksums do not match: their content may be wrong or missing.
    pub damage: Vec<Range<u64>>,
    channels: BTreeMap<u16, Channel>,
    index: Index,
}

#[derive(Debug)]
struct Channel {
    topic: String,
    /// The schema of CDR messages; `None` for JSON.
    schema: Option<String>,
    /// Whether the messages are JSON wrapped in string messages.
    is_json: bool,
}

/// A message of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedMessage<'a> {
    /// The topic.
    pub topic: &'a str,
    /// The schema, for CDR; `None` for JSON.
    pub schema: Option<&'a str>,
    /// Its number within the topic, from 0.
    pub number: u32,
    /// Time since the recording began, by the game's clock or the gateway's.
    pub at: SimTime,
    /// UTC when the message was recorded, ns since 1970.
    pub utc_ns: u64,
    /// The message; empty if the file can no longer be read (no real message is empty).
    pub bytes: Vec<u8>,
}

impl RecordedMessage<'_> {
    /// Decodes the message.
    ///
    /// # Errors
    /// [`RecordingError::Damaged`] if it does not decode.
    pub fn read<M: Message + DeserializeOwned>(&self) -> Result<M, RecordingError> {
        let damaged = |reason| RecordingError::Damaged {
            topic: self.topic.to_owned(),
            number: self.number,
            reason,
        };
        codec::decode(&self.bytes).map_err(damaged)
    }

    /// Parses the JSON.
    ///
    /// # Errors
    /// [`RecordingError::Json`] if it does not parse.
    pub fn read_json<T: DeserializeOwned>(&self) -> Result<T, RecordingError> {
        let strange = |reason| RecordingError::Json {
            topic: self.topic.to_owned(),
            number: self.number,
            reason,
        };
        serde_json::from_slice(&self.bytes).map_err(strange)
    }
}

impl Bag {
    /// Opens a recording file.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read, is not a recording, or is from a different version.
    pub fn open(path: &Path) -> Result<Bag, RecordingError> {
        Bag::of_source(source_of(path)?)
    }

    /// Opens a recording in memory.
    ///
    /// # Errors
    /// [`RecordingError`] if the bytes are not a recording, or are from a different version.
    pub fn of(bytes: Vec<u8>) -> Result<Bag, RecordingError> {
        Bag::of_source(Source::of(bytes))
    }

    fn of_source(source: Source) -> Result<Bag, RecordingError> {
        let (source, mut found, Extent { is_cut, damage }) = Found::in_source(source)?;
        let (kind, facts) = found.header()?;
        let began_utc_ns = facts.get(BEGAN).map_or("", String::as_str).parse();
        let began_utc_ns =
            began_utc_ns.map_err(|e| RecordingError::not_understood("beginning", e))?;
        let result = found.metadata.remove(RESULT);
        let Found {
            channels, index, ..
        } = found;
        Ok(Bag {
            source,
            kind,
            facts,
            began_utc_ns,
            result,
            is_cut,
            damage,
            channels,
            index,
        })
    }

    /// Calls `take` with the topic, schema, recording time (ns) and content of every ROS 2 message
    /// in an MCAP file from another program, such as rosbag2.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read or is not an MCAP file.
    pub fn for_each_foreign_message(
        path: &Path,
        mut take: impl FnMut(&str, &str, u64, Vec<u8>),
    ) -> Result<(), RecordingError> {
        let (source, found, _) = Found::in_source(source_of(path)?)?;
        for place in 0..found.index.count {
            let Some(entry) = found.index.entry(&source, place) else {
                continue;
            };
            let Some(channel) = found.channels.get(&entry.channel) else {
                continue;
            };
            if let Some(schema) = &channel.schema {
                let bytes = source.read(entry.from..entry.from + u64::from(entry.length))?;
                take(&channel.topic, schema, entry.log_ns, bytes);
            }
        }
        Ok(())
    }

    /// A fact of the header; empty if missing.
    pub fn fact(&self, key: &str) -> &str {
        self.facts.get(key).map_or("", String::as_str)
    }

    /// The size of the recording, bytes.
    pub fn size(&self) -> u64 {
        self.source.length
    }

    /// All messages, in recording order.
    pub fn messages(&self) -> impl ExactSizeIterator<Item = RecordedMessage<'_>> {
        (0..self.index.count).map(|place| self.message(place))
    }

    /// The messages of one topic.
    pub fn on<'a>(&'a self, topic: &'a str) -> impl Iterator<Item = RecordedMessage<'a>> {
        self.places(topic).map(|place| self.message(place))
    }

    /// The positions of the messages of one topic, for [`Bag::message`].
    pub fn places(&self, topic: &str) -> impl Iterator<Item = usize> {
        let wanted = self
            .channels
            .iter()
            .find(|(_, channel)| channel.topic == topic)
            .map(|(id, _)| *id);
        let is_wanted = move |place: &usize| {
            wanted.is_some()
                && self
                    .index
                    .entry(&self.source, *place)
                    .map(|entry| entry.channel)
                    == wanted
        };
        (0..self.index.count).filter(is_wanted)
    }

    /// The message at a position among all messages.
    ///
    /// # Panics
    /// If `place` is out of range.
    pub fn message(&self, place: usize) -> RecordedMessage<'_> {
        let entry = self.index.entry(&self.source, place);
        let channel = entry.and_then(|entry| self.channels.get(&entry.channel));
        let read = |entry: IndexEntry| {
            self.source
                .read(entry.from..entry.from + u64::from(entry.length))
                .ok()
        };
        let bytes = entry.and_then(read).unwrap_or_default();
        let (number, log_ns, utc_ns) = entry.map_or((0, 0, 0), |entry| {
            (entry.number, entry.log_ns, entry.utc_ns)
        });
        let is_json = channel.is_some_and(|channel| channel.is_json);
        RecordedMessage {
            topic: channel.map_or("", |channel| &channel.topic),
            schema: channel.and_then(|channel| channel.schema.as_deref()),
            number,
            at: SimTime(
                i64::try_from(log_ns.saturating_sub(self.began_utc_ns)).unwrap_or(i64::MAX),
            ),
            utc_ns,
            bytes: if is_json {
                json_string::text_of(bytes)
            } else {
                bytes
            },
        }
    }

    /// Wall-clock time from the first to the last message, ns.
    pub fn span_utc_ns(&self) -> u64 {
        self.index.span_utc_ns()
    }

    /// The topics with messages, by name, with their message counts.
    pub fn topics(&self) -> BTreeMap<&str, usize> {
        let mut topics = BTreeMap::new();
        for (channel, count) in &self.index.counts {
            let topic = self
                .channels
                .get(channel)
                .map_or("", |channel| channel.topic.as_str());
            *topics.entry(topic).or_insert(0) += count;
        }
        topics
    }
}

fn source_of(path: &Path) -> Result<Source, RecordingError> {
    Source::open(path).map_err(|reason| RecordingError::File {
        path: path.to_owned(),
        reason,
    })
}

/// Collects the contents of a file.
#[derive(Default)]
struct Found {
    schemas: BTreeMap<u16, (String, String)>,
    channels: BTreeMap<u16, Channel>,
    index: Index,
    metadata: BTreeMap<String, Facts>,
}

impl Found {
    /// The decompressed file and its contents.
    fn in_source(source: Source) -> Result<(Source, Found, Extent), RecordingError> {
        let source = compressed::expanded(source)?;
        let mut found = Found::default();
        let extent = for_each_record(&source, |record, place, chunk| {
            found.take(record, &place, chunk)
        })?;
        Ok((source, found, extent))
    }

    /// Adds a record. `place` is the byte range of a message, `chunk` the start of its chunk.
    fn take(&mut self, record: Record<'_>, place: &Range<u64>, chunk: u64) {
        self.index.add(&record, place, chunk);
        match record {
            Record::Schema { header, .. } => {
                self.schemas
                    .insert(header.id, (header.name, header.encoding));
            }
            Record::Channel(channel) => {
                let schema = self
                    .schemas
                    .get(&channel.schema_id)
                    .filter(|(_, encoding)| encoding == "ros2msg");
                let schema = schema.map(|(name, _)| name.clone());
                let is_json = schema.as_deref() == Some(json_string::SCHEMA);
                let schema = schema.filter(|_| !is_json);
                self.channels.insert(
                    channel.id,
                    Channel {
                        topic: channel.topic,
                        schema,
                        is_json,
                    },
                );
            }
            Record::Metadata(metadata) => {
                drop(self.metadata.insert(metadata.name, metadata.metadata))
            }
            _ => {}
        }
    }

    /// The header, after checking its checksum and version.
    fn header(&mut self) -> Result<(Kind, Facts), RecordingError> {
        let foreign = |reason: &str| RecordingError::Foreign(reason.to_owned());
        let header = Kind::ALL
            .into_iter()
            .find_map(|kind| Some((kind, self.metadata.remove(kind.header())?)));
        let (kind, facts) = header
            .ok_or_else(|| foreign("it has neither the metadata \"squall\" nor \"gateway\""))?;
        let version = facts.get(VERSION).cloned().unwrap_or_default();
        if version != primitives::VERSION {
            return Err(RecordingError::Version { found: version });
        }
        match facts.get(CHECKSUM) {
            Some(written) if *written != checksum(&facts) => Err(foreign("its header is damaged")),
            None if kind == Kind::Gateway => Err(foreign(
                "it is a gateway's recording in an old format; replay it with the version that recorded it",
            )),
            _ => Ok((kind, facts)),
        }
    }
}
