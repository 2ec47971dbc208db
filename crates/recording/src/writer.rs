//! Encodes entries into a recording.

use crate::{
    BEGAN, CHECKSUM, FRAME, Facts, INPUTS, Kind, RESULT, RecordError, VERSION, checksum,
    json_string, picture,
};
use mcap::records::{MessageHeader, Metadata};
use messages::input::{Input, Inputs};
use messages::{Frame, Message, Picture, Stamp, ros};
use primitives::{SimTime, codec};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::sync::Arc;

/// The size at which a chunk is closed, bytes.
const CHUNK: u64 = 1 << 20;

/// The opening of a recording: everything known before the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// The kind of recording.
    pub kind: Kind,
    /// Start of the recording: UTC, ns since 1970.
    pub began_utc_ns: u64,
    /// The header facts; version, start and checksum are added.
    pub facts: Facts,
    /// Metadata that follows the header, by name.
    pub more: Vec<(&'static str, Facts)>,
    /// Names of the teams with recorded pictures, by team index.
    pub teams: Vec<String>,
}

/// An entry of a recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A decision of the game.
    Decision(Box<Decision>),
    /// An encoded message.
    Message {
        /// The topic, without the game's name.
        topic: String,
        /// The schema, for CDR; `None` for JSON.
        schema: Option<&'static str>,
        /// The encoded message.
        bytes: Vec<u8>,
        /// Time of the game, or of the gateway's clock.
        at: SimTime,
    },
}

impl Entry {
    /// Approximate memory use, bytes.
    pub(crate) fn size(&self) -> usize {
        match self {
            Entry::Decision(decision) => {
                let Decision {
                    frame,
                    pictures,
                    inputs,
                } = decision.as_ref();
                let boats = pictures
                    .iter()
                    .map(|picture| size_of_val(&*picture.own) + size_of_val(&*picture.contacts));
                size_of::<Decision>()
                    + size_of_val(&*frame.vehicles)
                    + size_of_val(&**inputs)
                    + boats.sum::<usize>()
            }
            Entry::Message { topic, bytes, .. } => size_of::<Entry>() + topic.len() + bytes.len(),
        }
    }
}

/// A decision of the game with its inputs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decision {
    /// The frame, with the events since the previous decision.
    pub frame: Arc<Frame>,
    /// The pictures shown since then, unless recorded as messages.
    pub pictures: Vec<Picture>,
    /// The game's inputs since then, in order.
    pub inputs: Vec<Input>,
}

/// Writes a recording.
pub struct Writer<W: Write + Seek> {
    mcap: mcap::Writer<W>,
    began_utc_ns: u64,
    /// The topics of pictures, by team index.
    pictures: Vec<String>,
    /// Channel number and message count, by topic.
    channels: BTreeMap<String, (u16, u32)>,
    /// Whether something has been written since the last flush.
    is_dirty: bool,
}

impl<W: Write + Seek> Writer<W> {
    /// Starts a recording.
    ///
    /// # Errors
    /// [`RecordError`] if the file cannot be written.
    pub fn begin(file: W, opening: &Opening) -> Result<Writer<W>, RecordError> {
        let options = mcap::WriteOptions::new()
            .profile("ros2")
            .library(format!("squall {}", primitives::VERSION));
        // A chunk is written only when complete, so the file on disk never needs repair. With
        // compression (zlib), a 2v2 game would be a quarter to half the size. But zlib needs C, and
        // a truncated file would lose everything from the truncated chunk on.
        let options = options
            .compression(None)
            .chunk_size(Some(CHUNK))
            .disable_seeking(true);
        let mut mcap = options.create(file)?;
        let Opening {
            kind,
            began_utc_ns,
            facts,
            more,
            teams,
        } = opening.clone();
        let mut header = facts;
        header
            .entry(VERSION.to_owned())
            .or_insert_with(|| primitives::VERSION.to_owned());
        header.insert(BEGAN.to_owned(), began_utc_ns.to_string());
        // The header has its own checksum: a truncated file lacks the checksum of the whole file,
        // and a header is accepted either as a whole or not at all.
        header.insert(CHECKSUM.to_owned(), checksum(&header));
        for (name, facts) in std::iter::once((kind.header(), header)).chain(more) {
            mcap.write_metadata(&Metadata {
                name: name.to_owned(),
                metadata: facts,
            })?;
        }
        mcap.flush()?;
        let pictures = teams.iter().map(|team| picture(team)).collect();
        Ok(Writer {
            mcap,
            began_utc_ns,
            pictures,
            channels: BTreeMap::new(),
            is_dirty: false,
        })
    }

    /// Records an entry at this time (UTC, ns).
    ///
    /// # Errors
    /// [`RecordError`] if the file cannot be written.
    pub fn write(&mut self, entry: &Entry, utc_ns: u64) -> Result<(), RecordError> {
        self.is_dirty = true;
        match entry {
            Entry::Decision(decision) => self.decision(decision, utc_ns),
            Entry::Message {
                topic,
                schema: Some(schema),
                bytes,
                at,
            } => self.put(topic, schema, *at, utc_ns, bytes),
            Entry::Message {
                topic,
                schema: None,
                bytes,
                at,
            } => self.put(
                topic,
                json_string::SCHEMA,
                *at,
                utc_ns,
                &json_string::wrap(bytes),
            ),
        }
    }

    /// Flushes new data to the system.
    ///
    /// # Errors
    /// [`RecordError`] if the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        if std::mem::take(&mut self.is_dirty) {
            self.mcap.flush()?;
        }
        Ok(())
    }

    /// Completes the file, with a result if there is one.
    ///
    /// # Errors
    /// [`RecordError`] if the file cannot be written.
    pub fn end(mut self, result: Facts) -> Result<W, RecordError> {
        if !result.is_empty() {
            self.mcap.write_metadata(&Metadata {
                name: RESULT.to_owned(),
                metadata: result,
            })?;
        }
        self.mcap.finish()?;
        Ok(self.mcap.into_inner())
    }

    fn decision(&mut self, decision: &Decision, utc_ns: u64) -> Result<(), RecordError> {
        for picture in &decision.pictures {
            let topic = self
                .pictures
                .get(usize::from(picture.team))
                .cloned()
                .unwrap_or_default();
            self.put_message(&topic, picture, picture.stamp, utc_ns)?;
        }
        let stamp = Stamp {
            version: Inputs::VERSION,
            ..decision.frame.stamp
        };
        let inputs = decision
            .inputs
            .iter()
            .map(|input| (*input).into())
            .collect();
        // Record inputs as well as their results, so that a game, including a field game with real
        // boats, can be simulated again with a different version or in a debugger.
        self.put_message(INPUTS, &Inputs { stamp, inputs }, stamp, utc_ns)?;
        self.put_message(FRAME, &*decision.frame, stamp, utc_ns)
    }

    fn put_message<M: Message + Serialize>(
        &mut self,
        topic: &str,
        message: &M,
        stamp: Stamp,
        utc_ns: u64,
    ) -> Result<(), RecordError> {
        self.put(
            topic,
            M::SCHEMA,
            stamp.valid_ns,
            utc_ns,
            &codec::encode(message),
        )
    }

    fn put(
        &mut self,
        topic: &str,
        schema: &str,
        at: SimTime,
        utc_ns: u64,
        bytes: &[u8],
    ) -> Result<(), RecordError> {
        let (channel_id, sequence) = match self.channels.get_mut(topic) {
            Some((id, count)) => {
                *count = count.wrapping_add(1);
                (*id, *count)
            }
            None => {
                let id = self.open(topic, schema)?;
                self.channels.insert(topic.to_owned(), (id, 0));
                (id, 0)
            }
        };
        // Tools plot over simulated time: over wall-clock time, a lockstep game of ten minutes that
        // took a second and a half would be a spike. The wall-clock time is `publish_time`.
        let log_time = self
            .began_utc_ns
            .saturating_add(u64::try_from(at.0).unwrap_or(0));
        let header = MessageHeader {
            channel_id,
            sequence,
            log_time,
            publish_time: utc_ns,
        };
        Ok(self.mcap.write_to_known_channel(&header, bytes)?)
    }

    /// Opens a channel for this topic.
    fn open(&mut self, topic: &str, schema: &str) -> Result<u16, RecordError> {
        let definition = match schema {
            json_string::SCHEMA => json_string::DEFINITION.to_owned(),
            ours => ros::full_definition(ours).unwrap_or_default(),
        };
        let schema_id = self
            .mcap
            .add_schema(schema, "ros2msg", definition.as_bytes())?;
        // The profile requires this field; no quality of service was offered.
        let qos = BTreeMap::from([("offered_qos_profiles".to_owned(), "[]".to_owned())]);
        Ok(self.mcap.add_channel(schema_id, topic, "cdr", &qos)?)
    }
}
