//! Notes of a game to the bytes of a recording.

use crate::text;
use crate::{CHECKSUM, DRAWN, Ending, FRAME, Header, INPUTS, RESULT, RecordError, SQUALL, checksum, picture};
use game::codec;
use game::input::{Input, Inputs};
use game::message::{Frame, Message, Stamp};
use game::ros;
use game::{Picture, SimTime};
use mcap::records::{MessageHeader, Metadata};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// The size at which a chunk is closed, bytes.
const CHUNK: u64 = 1 << 20;

/// Something to be recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// A decision of the game.
    Turn(Box<Turn>),
    /// Something that went over the network.
    Heard {
        /// The topic, without the game's name.
        topic: String,
        /// The schema, for CDR; none for JSON.
        schema: Option<&'static str>,
        /// The message.
        bytes: Vec<u8>,
        /// Simulated time at which it came.
        at: SimTime,
    },
}

impl Note {
    /// About how much memory it takes up, bytes.
    pub(super) fn size(&self) -> usize {
        match self {
            Note::Turn(turn) => {
                let Turn { frame, pictures, inputs } = turn.as_ref();
                let boats = pictures.iter().map(|picture| size_of_val(&*picture.own) + size_of_val(&*picture.contacts));
                size_of::<Turn>() + size_of_val(&*frame.vehicles) + size_of_val(&**inputs) + boats.sum::<usize>()
            }
            Note::Heard { topic, bytes, .. } => size_of::<Note>() + topic.len() + bytes.len(),
        }
    }
}

/// A decision of the game, and what led to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turn {
    /// The truth, with the events since the turn before.
    pub frame: Frame,
    /// What was shown since the turn before.
    pub pictures: Vec<Picture>,
    /// What was given since the turn before, in order.
    pub inputs: Vec<Input>,
}

/// Writes a recording.
pub struct Writer<W: Write + Seek> {
    mcap: mcap::Writer<W>,
    began_utc_ns: u64,
    teams: Vec<String>,
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
    pub fn begin(file: W, header: &Header) -> Result<Writer<W>, RecordError> {
        let options = mcap::WriteOptions::new().profile("ros2").library(format!("squall {}", game::VERSION));
        // A chunk is written when it is whole: what is on the disk is then never in need of mending.
        let options = options.compression(None).chunk_size(Some(CHUNK)).disable_seeking(true);
        let mut mcap = options.create(file)?;
        let scenario = &header.notice.scenario;
        let facts = [
            ("version", header.notice.version.clone()),
            ("commit", header.commit.clone()),
            ("game", header.game.clone()),
            ("pace", header.notice.pace.clone()),
            ("seed", scenario.seed.to_string()),
            ("began_utc_ns", header.began_utc_ns.to_string()),
            ("scenario", serde_json::to_string(scenario)?),
            ("water", serde_json::to_string(&header.water)?),
        ];
        let mut facts: BTreeMap<String, String> = facts.map(|(key, value)| (key.to_owned(), value)).into();
        facts.insert(CHECKSUM.to_owned(), checksum(&facts));
        mcap.write_metadata(&Metadata { name: SQUALL.to_owned(), metadata: facts })?;
        let drawn = scenario.drawn.iter().map(|drawn| (drawn.parameter.as_str(), drawn.value.to_string()));
        write_metadata(&mut mcap, DRAWN, drawn)?;
        mcap.flush()?;
        let teams = scenario.teams.iter().map(|team| picture(&team.name)).collect();
        Ok(Writer { mcap, began_utc_ns: header.began_utc_ns, teams, channels: BTreeMap::new(), is_dirty: false })
    }

    /// Records something, at this moment (UTC, ns).
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn note(&mut self, note: &Note, utc_ns: u64) -> Result<(), RecordError> {
        self.is_dirty = true;
        match note {
            Note::Turn(turn) => self.turn(turn, utc_ns),
            Note::Heard { topic, schema: Some(schema), bytes, at } => self.put(topic, schema, *at, utc_ns, bytes),
            Note::Heard { topic, schema: None, bytes, at } => {
                self.put(topic, text::SCHEMA, *at, utc_ns, &text::wrap(bytes))
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

    /// Ends the recording well.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn end(mut self, ending: &Ending) -> Result<W, RecordError> {
        let facts = [
            ("digest", ending.outcome.digest.clone()),
            ("outcome", serde_json::to_string(&ending.outcome)?),
            ("run", ending.run.to_string()),
            ("dropped", ending.dropped.to_string()),
        ];
        write_metadata(&mut self.mcap, RESULT, facts)?;
        self.mcap.finish()?;
        Ok(self.mcap.into_inner())
    }

    fn turn(&mut self, turn: &Turn, utc_ns: u64) -> Result<(), RecordError> {
        for picture in &turn.pictures {
            let topic = self.teams.get(usize::from(picture.team)).cloned().unwrap_or_default();
            self.put_message(&topic, picture, utc_ns)?;
        }
        let stamp = Stamp { version: Inputs::VERSION, ..turn.frame.stamp };
        let inputs = turn.inputs.iter().map(|input| (*input).into()).collect();
        self.put_message(INPUTS, &Inputs { stamp, inputs }, utc_ns)?;
        self.put_message(FRAME, &turn.frame, utc_ns)
    }

    fn put_message<M: Message + Serialize>(
        &mut self,
        topic: &str,
        message: &M,
        utc_ns: u64,
    ) -> Result<(), RecordError> {
        let at = message.stamp().valid_ns;
        self.put(topic, M::SCHEMA, at, utc_ns, &codec::encode(message))
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
        let log_time = self.began_utc_ns.saturating_add(u64::try_from(at.0).unwrap_or(0));
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: utc_ns };
        Ok(self.mcap.write_to_known_channel(&header, bytes)?)
    }

    /// A channel for this topic.
    fn open(&mut self, topic: &str, schema: &str) -> Result<u16, RecordError> {
        let definition = match schema {
            text::SCHEMA => text::DEFINITION.to_owned(),
            ours => ros::full_definition(ours).unwrap_or_default(),
        };
        let schema_id = self.mcap.add_schema(schema, "ros2msg", definition.as_bytes())?;
        // NoRecorder offered any: the profile wants to be told.
        let qos = BTreeMap::from([("offered_qos_profiles".to_owned(), "[]".to_owned())]);
        Ok(self.mcap.add_channel(schema_id, topic, "cdr", &qos)?)
    }
}

fn write_metadata<'a, W: Write + Seek>(
    mcap: &mut mcap::Writer<W>,
    name: &str,
    facts: impl IntoIterator<Item = (&'a str, String)>,
) -> Result<(), RecordError> {
    let metadata = facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    Ok(mcap.write_metadata(&Metadata { name: name.to_owned(), metadata })?)
}
