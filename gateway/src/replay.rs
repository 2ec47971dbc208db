//! A recording, played through the codec and the supervisor again.

use crate::bridge::{Bridge, Event, Input, Output, Plan};
use crate::record::{EVENT, INPUT, LINK_IN, LINK_OUT, METADATA};
use game::SimTime;
use game::external::GatewayStatus;
use mcap::records::Record;
use std::collections::BTreeMap;
use thiserror::Error;

/// Why a file cannot be replayed.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// It is no recording of a gateway.
    #[error("not a recording of a gateway: {0}")]
    Foreign(String),
    /// It was made by another version, whose core may act differently.
    #[error("recorded by Squall {found}, this is {ours}", ours = game::VERSION)]
    Version {
        /// The recorder's.
        found: String,
    },
    /// Something in the middle of it is damaged.
    #[error("message {sequence} is damaged: {reason}")]
    Damaged {
        /// Which.
        sequence: u32,
        /// How.
        reason: String,
    },
}

/// What came of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// What the gateway was made for.
    pub plan: Plan,
    /// How many inputs there were, and how many bytes came and went.
    pub inputs: u64,
    /// Bytes from the boat.
    pub bytes_in: u64,
    /// Bytes to the boat.
    pub bytes_out: u64,
    /// Time from the first input to the last.
    pub lasted: SimTime,
    /// What happened this time.
    pub events: Vec<(SimTime, Event)>,
    /// How it ended.
    pub status: GatewayStatus,
    /// Where the replay first differs from the recording.
    pub difference: Option<Difference>,
    /// Whether the file ends abruptly.
    pub is_cut: bool,
}

/// A difference between a recording and its replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// When.
    pub at: SimTime,
    /// What was recorded.
    pub recorded: String,
    /// What came out this time.
    pub replayed: String,
}

/// What a turn of the core brought, as recorded.
struct Turn {
    at: SimTime,
    input: Input,
    out: Vec<u8>,
    events: Vec<Event>,
}

/// Plays a recording again.
///
/// # Errors
/// [`ReplayError`] for anything but a sound recording, cut off or not.
pub fn replay(file: &[u8]) -> Result<Replay, ReplayError> {
    let (plan, turns, is_cut) = read(file)?;
    let mut bridge = Bridge::new(plan.clone());
    let (mut bytes_in, mut bytes_out) = (0, 0);
    let (mut events, mut difference) = (Vec::new(), None);
    for (i, turn) in turns.iter().enumerate() {
        let mut out = Output::default();
        bridge.take(turn.at, &turn.input, &mut out);
        if let Input::Bytes(bytes) = &turn.input {
            bytes_in += bytes.len() as u64;
        }
        bytes_out += out.bytes.len() as u64;
        // Of the last turn of a cut file some outputs may be missing.
        let is_whole = !is_cut || i + 1 < turns.len();
        if difference.is_none() && is_whole {
            difference = differing(turn, &out);
        }
        events.extend(out.events.into_iter().map(|event| (turn.at, event)));
    }
    let ends = turns.first().zip(turns.last()).map_or((SimTime::ZERO, SimTime::ZERO), |(a, b)| (a.at, b.at));
    Ok(Replay {
        plan,
        inputs: turns.len() as u64,
        bytes_in,
        bytes_out,
        lasted: ends.1 - ends.0,
        events,
        status: bridge.status(ends.1),
        difference,
        is_cut,
    })
}

fn differing(turn: &Turn, out: &Output) -> Option<Difference> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).replace("\r\n", " ").trim_end().to_owned();
    let said = |events: &[Event]| format!("{events:?}");
    let pairs = [(text(&turn.out), text(&out.bytes)), (said(&turn.events), said(&out.events))];
    let (recorded, replayed) = pairs.into_iter().find(|(recorded, replayed)| recorded != replayed)?;
    Some(Difference { at: turn.at, recorded, replayed })
}

/// The plan, the turns, and whether the file is cut.
fn read(file: &[u8]) -> Result<(Plan, Vec<Turn>, bool), ReplayError> {
    let foreign = |reason: String| ReplayError::Foreign(reason);
    let options = mcap::read::Options::IgnoreEndMagic.into();
    let records = mcap::read::LinearReader::new_with_options(file, options).map_err(|e| foreign(e.to_string()))?;
    let (mut topics, mut plan, mut turns) = (BTreeMap::<u16, String>::new(), None, Vec::<Turn>::new());
    let mut is_cut = true;
    for record in records {
        // A record that is not whole is the end of a file that was cut.
        let Ok(record) = record else { break };
        match record {
            Record::Metadata(metadata) if metadata.name == METADATA => plan = Some(plan_of(&metadata.metadata)?),
            Record::Channel(channel) => drop(topics.insert(channel.id, channel.topic)),
            Record::Message { header, data } => {
                let topic = topics.get(&header.channel_id).map_or("", String::as_str);
                let damaged =
                    |e: serde_json::Error| ReplayError::Damaged { sequence: header.sequence, reason: e.to_string() };
                take(&mut turns, topic, SimTime(header.publish_time as i64), &data).map_err(damaged)?;
            }
            Record::DataEnd(_) => is_cut = false,
            _ => {}
        }
    }
    let plan = plan.ok_or_else(|| foreign(format!("there is no metadata {METADATA:?} in it")))?;
    Ok((plan, turns, is_cut))
}

fn plan_of(metadata: &BTreeMap<String, String>) -> Result<Plan, ReplayError> {
    let text = |key: &str| metadata.get(key).map_or("", String::as_str);
    if text("version") != game::VERSION {
        return Err(ReplayError::Version { found: text("version").to_owned() });
    }
    serde_json::from_str(text("plan")).map_err(|e| ReplayError::Foreign(format!("its plan is not understood: {e}")))
}

/// Puts one message where it belongs.
fn take(turns: &mut Vec<Turn>, topic: &str, at: SimTime, data: &[u8]) -> Result<(), serde_json::Error> {
    let mut begin = |input: Input| turns.push(Turn { at, input, out: vec![], events: vec![] });
    match topic {
        LINK_IN => begin(Input::Bytes(data.to_vec())),
        INPUT => begin(serde_json::from_slice(data)?),
        LINK_OUT => turns.iter_mut().next_back().into_iter().for_each(|turn| turn.out.extend_from_slice(data)),
        EVENT => match (serde_json::from_slice(data)?, turns.last_mut()) {
            // What the core did not say is not compared.
            (Event::Remark(_), _) | (_, None) => {}
            (event, Some(turn)) => turn.events.push(event),
        },
        _ => {}
    }
    Ok(())
}
