//! The recording of a gateway: every byte both ways, everything else that came in, and what happened, as MCAP.
//!
//! | topic | what | encoding |
//! |---|---|---|
//! | `link/in` | bytes from the boat, as they came | raw |
//! | `link/out` | bytes to the boat, as they went | raw |
//! | `input` | everything else that the core was given | JSON of [`Input`] |
//! | `event` | what happened | JSON of [`Event`] |
//!
//! `log_time` is UTC, `publish_time` the gateway's own clock, which never steps, both in ns; `sequence` counts through all
//! topics. The metadata `gateway` holds the version and the plan. Nothing is compressed or held back in chunks, so that a
//! file that ends abruptly is good up to there.

use crate::bridge::{Event, Input, Output, Plan};
use game::SimTime;
use mcap::records::{MessageHeader, Metadata};
use std::collections::BTreeMap;
use std::io::{Seek, Write};
use thiserror::Error;

/// The name of the metadata.
pub(crate) const METADATA: &str = "gateway";
/// The topics, by what they hold.
pub(crate) const LINK_IN: &str = "link/in";
pub(crate) const LINK_OUT: &str = "link/out";
pub(crate) const INPUT: &str = "input";
pub(crate) const EVENT: &str = "event";

/// Why something cannot be recorded.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The file does not take it.
    #[error("the recording cannot be written: {0}")]
    Mcap(#[from] mcap::McapError),
    /// It is not JSON.
    #[error("the recording cannot hold this: {0}")]
    Json(#[from] serde_json::Error),
}

/// When something was: by the gateway's own clock, and UTC in ns since 1970.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment {
    /// Since the gateway began.
    pub at: SimTime,
    /// By the host's clock.
    pub utc_ns: u64,
}

/// Writes a recording.
pub struct Recorder<W: Write + Seek> {
    writer: mcap::Writer<W>,
    /// The channels of the four topics.
    channels: [u16; 4],
    sequence: u32,
}

impl<W: Write + Seek> Recorder<W> {
    /// Begins a recording of the gateway that `plan` makes.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn begin(file: W, plan: &Plan) -> Result<Recorder<W>, RecordError> {
        let options = mcap::WriteOptions::new().use_chunks(false).compression(None).library("squall");
        let mut writer = options.create(file)?;
        let metadata = BTreeMap::from([
            ("version".to_owned(), game::VERSION.to_owned()),
            ("plan".to_owned(), serde_json::to_string(plan)?),
        ]);
        writer.write_metadata(&Metadata { name: METADATA.to_owned(), metadata })?;
        let mut channel = |topic, encoding| writer.add_channel(0, topic, encoding, &BTreeMap::new());
        let channels =
            [channel(LINK_IN, "raw")?, channel(LINK_OUT, "raw")?, channel(INPUT, "json")?, channel(EVENT, "json")?];
        writer.flush()?;
        Ok(Recorder { writer, channels, sequence: 0 })
    }

    /// Records one turn of the core: what went in, and what came out.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn turn(&mut self, moment: Moment, input: &Input, out: &Output) -> Result<(), RecordError> {
        let [link_in, link_out, inputs, events] = self.channels;
        match input {
            Input::Bytes(bytes) => self.write(link_in, moment, bytes)?,
            other => self.write(inputs, moment, &serde_json::to_vec(other)?)?,
        }
        if !out.bytes.is_empty() {
            self.write(link_out, moment, &out.bytes)?;
        }
        for event in &out.events {
            self.write(events, moment, &serde_json::to_vec(event)?)?;
        }
        Ok(self.writer.flush()?)
    }

    /// Records something that the core does not know of.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn remark(&mut self, moment: Moment, event: &Event) -> Result<(), RecordError> {
        self.write(self.channels[3], moment, &serde_json::to_vec(event)?)?;
        Ok(self.writer.flush()?)
    }

    /// Ends it well.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take it.
    pub fn end(mut self) -> Result<(), RecordError> {
        self.writer.finish()?;
        Ok(())
    }

    fn write(&mut self, channel_id: u16, moment: Moment, data: &[u8]) -> Result<(), RecordError> {
        let publish_time = u64::try_from(moment.at.0).unwrap_or(0);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time: moment.utc_ns, publish_time };
        self.sequence = self.sequence.wrapping_add(1);
        Ok(self.writer.write_to_known_channel(&header, data)?)
    }
}
