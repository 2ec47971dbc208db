//! Entries to the bytes of a recording.

use crate::{
    BEGAN, CHECKSUM, FRAME, Facts, INPUTS, Kind, RESULT, RecordError, VERSION, checksum, json_string, picture,
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

/// How a recording begins: what is known before anything happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// What it is of.
    pub kind: Kind,
    /// When it begins: UTC, ns since 1970.
    pub began_utc_ns: u64,
    /// The header; version, beginning and checksum are added.
    pub facts: Facts,
    /// Metadata that follows the header, by name.
    pub more: Vec<(&'static str, Facts)>,
    /// The teams that there are pictures of, by number.
    pub teams: Vec<String>,
}

/// Something to be recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A decision of the game.
    Decision(Box<Decision>),
    /// A message, in bytes.
    Message {
        /// The topic, without the game's name.
        topic: String,
        /// The schema, for CDR; none for JSON.
        schema: Option<&'static str>,
        /// The message.
        bytes: Vec<u8>,
        /// When: time of the game, or of the gateway's clock.
        at: SimTime,
    },
}

impl Entry {
    /// About how much memory it takes up, bytes.
    pub(crate) fn size(&self) -> usize {
        match self {
            Entry::Decision(decision) => {
                let Decision { frame, pictures, inputs } = decision.as_ref();
                let boats = pictures.iter().map(|picture| size_of_val(&*picture.own) + size_of_val(&*picture.contacts));
                size_of::<Decision>() + size_of_val(&*frame.vehicles) + size_of_val(&**inputs) + boats.sum::<usize>()
            }
            Entry::Message { topic, bytes, .. } => size_of::<Entry>() + topic.len() + bytes.len(),
        }
    }
}

/// A decision of the game, and what led to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decision {
    /// The truth, with the events since the decision before.
    pub frame: Arc<Frame>,
    /// The pictures that were shown since then, where they are not recorded as messages.
    pub pictures: Vec<Picture>,
    /// What the game was given since then, in order.
    pub inputs: Vec<Input>,
}

/// Writes a recording.
pub struct Writer<W: Write + Seek> {
    mcap: mcap::Writer<W>,
    began_utc_ns: u64,
    /// The topics of pictures, by team.
    pictures: Vec<String>,
    /// Number and count of messages, by topic.
    channels: BTreeMap<String, (u16, u32)>,
    /// Whether something has been written since the last flush.
    is_dirty: bool,
}

impl<W: Write + Seek> Writer<W> {
    /// Begins a recording.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn begin(file: W, opening: &Opening) -> Result<Writer<W>, RecordError> {
        let options = mcap::WriteOptions::new().profile("ros2").library(format!("squall {}", primitives::VERSION));
        // A chunk is written when it is whole: what is on the disk is then never in need of mending.
        // Compressed (zlib), a 2v2 game would be a quarter to half as long. But that needs C,
        // and a file that was cut would lose everything from the cut chunk on.
        let options = options.compression(None).chunk_size(Some(CHUNK)).disable_seeking(true);
        let mut mcap = options.create(file)?;
        let Opening { kind, began_utc_ns, facts, more, teams } = opening.clone();
        let mut header = facts;
        header.entry(VERSION.to_owned()).or_insert_with(|| primitives::VERSION.to_owned());
        header.insert(BEGAN.to_owned(), began_utc_ns.to_string());
        // A checksum of the header's own: the one over the whole file is missing where the file
        // is cut, and a header is believed as a whole or not at all.
        header.insert(CHECKSUM.to_owned(), checksum(&header));
        for (name, facts) in std::iter::once((kind.header(), header)).chain(more) {
            mcap.write_metadata(&Metadata { name: name.to_owned(), metadata: facts })?;
        }
        mcap.flush()?;
        let pictures = teams.iter().map(|team| picture(team)).collect();
        Ok(Writer { mcap, began_utc_ns, pictures, channels: BTreeMap::new(), is_dirty: false })
    }

    /// Records something, at this time (UTC, ns).
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn write(&mut self, entry: &Entry, utc_ns: u64) -> Result<(), RecordError> {
        self.is_dirty = true;
        match entry {
            Entry::Decision(decision) => self.decision(decision, utc_ns),
            Entry::Message { topic, schema: Some(schema), bytes, at } => self.put(topic, schema, *at, utc_ns, bytes),
            Entry::Message { topic, schema: None, bytes, at } => {
                self.put(topic, json_string::SCHEMA, *at, utc_ns, &json_string::wrap(bytes))
            }
        }
    }

    /// Hands what was recorded to the system, if there is anything new.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        if std::mem::take(&mut self.is_dirty) {
            self.mcap.flush()?;
        }
        Ok(())
    }

    /// Completes the file, with a result where there is one.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn end(mut self, result: Facts) -> Result<W, RecordError> {
        if !result.is_empty() {
            self.mcap.write_metadata(&Metadata { name: RESULT.to_owned(), metadata: result })?;
        }
        self.mcap.finish()?;
        Ok(self.mcap.into_inner())
    }

    fn decision(&mut self, decision: &Decision, utc_ns: u64) -> Result<(), RecordError> {
        for picture in &decision.pictures {
            let topic = self.pictures.get(usize::from(picture.team)).cloned().unwrap_or_default();
            self.put_message(&topic, picture, picture.stamp, utc_ns)?;
        }
        let stamp = Stamp { version: Inputs::VERSION, ..decision.frame.stamp };
        let inputs = decision.inputs.iter().map(|input| (*input).into()).collect();
        // Inputs and not only what came of them: so a game can be simulated again, with another
        // version or a debugger beside it, and a field game with real boats too.
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
        self.put(topic, M::SCHEMA, stamp.valid_ns, utc_ns, &codec::encode(message))
    }

    fn put(&mut self, topic: &str, schema: &str, at: SimTime, utc_ns: u64, bytes: &[u8]) -> Result<(), RecordError> {
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
        // Simulated time, over which tools plot: a lockstep game of ten minutes that took a
        // second and a half would be a spike otherwise. The clock's time is `publish_time`.
        let log_time = self.began_utc_ns.saturating_add(u64::try_from(at.0).unwrap_or(0));
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: utc_ns };
        Ok(self.mcap.write_to_known_channel(&header, bytes)?)
    }

    /// A channel for this topic.
    fn open(&mut self, topic: &str, schema: &str) -> Result<u16, RecordError> {
        let definition = match schema {
            json_string::SCHEMA => json_string::DEFINITION.to_owned(),
            ours => ros::full_definition(ours).unwrap_or_default(),
        };
        let schema_id = self.mcap.add_schema(schema, "ros2msg", definition.as_bytes())?;
        // The profile asks for the qualities of service that were offered: there were none.
        let qos = BTreeMap::from([("offered_qos_profiles".to_owned(), "[]".to_owned())]);
        Ok(self.mcap.add_channel(schema_id, topic, "cdr", &qos)?)
    }
}
