//! A recording, opened: what it says, message by message, also where it ends abruptly.

use crate::text;
use crate::walk::{Walk, walk};
use crate::{CHECKSUM, Ending, FRAME, Header, RESULT, SQUALL, checksum};
use game::codec::{self, DecodeError};
use game::message::{Frame, GameInfo, Message};
use game::{Scenario, SimTime};
use mcap::records::{MessageHeader, Record};
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file cannot be opened as a recording.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// There is no such file, or it cannot be read.
    #[error("cannot read the recording {path}: {reason}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// It is no recording of a game.
    #[error("not a recording of a game: {0}")]
    Foreign(String),
    /// It was made by another version, whose messages may mean something else.
    #[error("recorded by Squall {found}, this is {ours}", ours = game::VERSION)]
    Version {
        /// The recorder's.
        found: String,
    },
    /// Something in it is not what it should be.
    #[error("message {number} of {topic} is damaged: {reason}")]
    Damaged {
        /// The topic.
        topic: String,
        /// Which, from 0.
        number: u32,
        /// What is wrong.
        reason: DecodeError,
    },
}

/// A recording.
#[derive(Debug)]
pub struct Recording {
    bytes: Vec<u8>,
    header: Header,
    ending: Option<Ending>,
    is_cut: bool,
    damage: Vec<Range<usize>>,
    channels: BTreeMap<u16, Channel>,
    pieces: Vec<Piece>,
    /// The pieces that are frames.
    frames: Vec<usize>,
}

#[derive(Debug)]
struct Channel {
    topic: String,
    /// None for JSON.
    schema: Option<String>,
    /// Whether that is the text of a message.
    is_text: bool,
}

/// Where a message is.
#[derive(Debug)]
struct Piece {
    channel: u16,
    number: u32,
    at: SimTime,
    utc_ns: u64,
    place: Range<usize>,
}

/// A message of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said<'a> {
    /// The topic.
    pub topic: &'a str,
    /// The schema, for CDR; none for JSON.
    pub schema: Option<&'a str>,
    /// Which of the topic, from 0.
    pub number: u32,
    /// Simulated time.
    pub at: SimTime,
    /// UTC when it was recorded, ns since 1970.
    pub utc_ns: u64,
    /// The message.
    pub bytes: &'a [u8],
}

impl Said<'_> {
    /// The message, as what it is.
    ///
    /// # Errors
    /// [`RecordingError::Damaged`] if it is something else.
    pub fn read<M: Message + DeserializeOwned>(&self) -> Result<M, RecordingError> {
        let damaged = |reason| RecordingError::Damaged { topic: self.topic.to_owned(), number: self.number, reason };
        codec::decode(self.bytes).map_err(damaged)
    }
}

impl Recording {
    /// Opens the recording in a file.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read, is none, or is of another version.
    pub fn open(path: &Path) -> Result<Recording, RecordingError> {
        let file = |reason| RecordingError::File { path: path.to_owned(), reason };
        Recording::of(std::fs::read(path).map_err(file)?)
    }

    /// Opens the recording that these bytes are.
    ///
    /// # Errors
    /// [`RecordingError`] if they are none, or of another version.
    pub fn of(bytes: Vec<u8>) -> Result<Recording, RecordingError> {
        let mut found = Found::default();
        let Walk { is_cut, damage } =
            walk(&bytes, |record, place| found.take(record, place)).map_err(RecordingError::Foreign)?;
        let header = header_of(found.metadata.get(SQUALL))?;
        let ending = found.metadata.get(RESULT).and_then(ending_of);
        let began = header.began_utc_ns;
        let piece = |(message, place): (MessageHeader, Range<usize>)| Piece {
            channel: message.channel_id,
            number: message.sequence,
            at: SimTime(i64::try_from(message.log_time.saturating_sub(began)).unwrap_or(i64::MAX)),
            utc_ns: message.publish_time,
            place,
        };
        let pieces: Vec<Piece> = found.messages.into_iter().map(piece).collect();
        let is_frame = |piece: &Piece| found.channels.get(&piece.channel).is_some_and(|channel| channel.topic == FRAME);
        let frames = (0..pieces.len()).filter(|i| is_frame(&pieces[*i])).collect();
        let is_cut = is_cut || ending.is_none();
        Ok(Recording { header, ending, is_cut, damage, channels: found.channels, pieces, frames, bytes })
    }

    /// What it says of its game.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// How the game ended; none where the file ends before.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// Whether the file ends before the game did.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Which of its bytes are not what was written, as far as checksums tell: what is said there may be wrong or missing.
    #[must_use]
    pub fn damage(&self) -> &[Range<usize>] {
        &self.damage
    }

    /// Its size, bytes.
    #[must_use]
    pub fn size(&self) -> usize {
        self.bytes.len()
    }

    /// All messages, in the order in which they were recorded.
    pub fn messages(&self) -> impl ExactSizeIterator<Item = Said<'_>> {
        (0..self.pieces.len()).map(|place| self.message(place))
    }

    /// The messages of one topic.
    pub fn on<'a>(&'a self, topic: &'a str) -> impl Iterator<Item = Said<'a>> {
        self.places(topic).map(|place| self.message(place))
    }

    /// The places of the messages of one topic, for [`Recording::message`].
    pub fn places(&self, topic: &str) -> impl Iterator<Item = usize> {
        let wanted = self.channels.iter().find(|(_, channel)| channel.topic == topic).map(|(id, _)| *id);
        (0..self.pieces.len()).filter(move |place| Some(self.pieces[*place].channel) == wanted)
    }

    /// The message at a place.
    ///
    /// # Panics
    /// If there are fewer.
    #[must_use]
    pub fn message(&self, place: usize) -> Said<'_> {
        let Piece { channel, number, at, utc_ns, place } = &self.pieces[place];
        let channel = self.channels.get(channel);
        let is_text = channel.is_some_and(|channel| channel.is_text);
        let place = if is_text { text::place_in(&self.bytes, place.clone()) } else { place.clone() };
        Said {
            topic: channel.map_or("", |channel| &channel.topic),
            schema: channel.and_then(|channel| channel.schema.as_deref()),
            number: *number,
            at: *at,
            utc_ns: *utc_ns,
            bytes: &self.bytes[place],
        }
    }

    /// The topics that there are messages on, with their numbers of messages, by name.
    #[must_use]
    pub fn topics(&self) -> BTreeMap<&str, usize> {
        let mut topics = BTreeMap::new();
        self.messages().for_each(|said| *topics.entry(said.topic).or_insert(0) += 1);
        topics
    }

    /// How many frames there are.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frames.len()
    }

    /// A frame, as recorded.
    ///
    /// # Panics
    /// If there are fewer.
    #[must_use]
    pub fn frame(&self, i: usize) -> Said<'_> {
        self.message(self.frames[i])
    }

    /// All frames.
    ///
    /// # Errors
    /// [`RecordingError::Damaged`] names the first that is none.
    pub fn frames(&self) -> impl ExactSizeIterator<Item = Result<Frame, RecordingError>> {
        (0..self.frames.len()).map(|i| self.frame(i).read())
    }
}

/// What a walk through a file finds.
#[derive(Default)]
struct Found {
    schemas: BTreeMap<u16, (String, String)>,
    channels: BTreeMap<u16, Channel>,
    messages: Vec<(MessageHeader, Range<usize>)>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
}

impl Found {
    fn take(&mut self, record: Record<'_>, place: Range<usize>) -> Result<(), String> {
        match record {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, (header.name, header.encoding));
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).filter(|(_, encoding)| encoding == "ros2msg");
                let schema = schema.map(|(name, _)| name.clone());
                let is_text = schema.as_deref() == Some(text::SCHEMA);
                let schema = schema.filter(|_| !is_text);
                self.channels.insert(channel.id, Channel { topic: channel.topic, schema, is_text });
            }
            Record::Message { header, data } => {
                let data = place.end - data.len()..place.end;
                self.messages.push((header, data));
            }
            Record::Metadata(metadata) => drop(self.metadata.insert(metadata.name, metadata.metadata)),
            _ => {}
        }
        Ok(())
    }
}

fn header_of(facts: Option<&BTreeMap<String, String>>) -> Result<Header, RecordingError> {
    let foreign = |reason: &str| RecordingError::Foreign(reason.to_owned());
    let facts = facts.ok_or_else(|| foreign(&format!("there is no metadata {SQUALL:?} in it")))?;
    let text = |key: &str| facts.get(key).map_or("", String::as_str);
    if text("version") != game::VERSION {
        return Err(RecordingError::Version { found: text("version").to_owned() });
    }
    if facts.get(CHECKSUM).is_some_and(|written| *written != checksum(facts)) {
        return Err(foreign("its header is damaged"));
    }
    let strange = |what: &str, e: &dyn std::fmt::Display| foreign(&format!("its {what} is not understood: {e}"));
    let scenario: Scenario = serde_json::from_str(text("scenario")).map_err(|e| strange("scenario", &e))?;
    scenario.check_references().map_err(|e| strange("scenario", &e))?;
    Ok(Header {
        commit: text("commit").to_owned(),
        game: text("game").to_owned(),
        began_utc_ns: text("began_utc_ns").parse().map_err(|e| strange("beginning", &e))?,
        notice: GameInfo { version: text("version").to_owned(), pace: text("pace").to_owned(), scenario },
        water: serde_json::from_str(text("water")).map_err(|e| strange("water", &e))?,
    })
}

fn ending_of(facts: &BTreeMap<String, String>) -> Option<Ending> {
    Some(Ending {
        outcome: serde_json::from_str(facts.get("outcome")?).ok()?,
        run: serde_json::from_str(facts.get("run")?).ok()?,
        dropped: facts.get("dropped")?.parse().ok()?,
    })
}
