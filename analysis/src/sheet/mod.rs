//! Tables of single topics, for programs that read CSV.
//!
//! The first column is `t_s`, simulated time. Names are those of the messages, with the names of boats and teams in place
//! of numbers; units are those of the messages, except that times are in s. What is not there is an empty cell.
//!
//! | topic | a row |
//! |---|---|
//! | `frame` | a decision: all boats, flags, the score, and what happened since the last as sentences |
//! | `picture/<team>` | an own boat or a contact in a picture (`seen` says which) |
//! | `inputs` | one thing that the game was given |
//! | `say/<team>` | a word of a boat |
//! | `link/<boat>` | a line on the link, by the time of the piece that ended it |
//! | `events` | something that happened (no topic of the file, but told in its frames) |
//! | any other | a message; JSON is laid flat, with numbered lists |

mod json;
mod message;
mod row;

use game::external::{ExternalOrder, LinkBytes, NavReport};
use game::input::Inputs;
use game::message::{Frame, Message, PolicyProposal, Say};
use game::outcome::EventOutcome;
use game::{Picture, Scenario, SimTime};
use message::Table;
use recording::{FRAME, Recording, RecordingError, Said};
use row::Row;
use thiserror::Error;

/// What happened, as if it were a topic.
pub const EVENTS: &str = "events";

/// Takes rows: the names of the columns first.
pub type Sink<'a> = dyn FnMut(&[String]) -> std::io::Result<()> + 'a;

/// Why there is no table.
#[derive(Debug, Error)]
pub enum SheetError {
    /// There is nothing on that topic.
    #[error("there is no topic {topic:?} in this recording; there are {}", .known.join(", "))]
    Unknown {
        /// The topic.
        topic: String,
        /// Those there are.
        known: Vec<String>,
    },
    /// What is on it is of a kind that no table is known for.
    #[error("messages of {topic} are {schema}, which no table is known for")]
    Strange {
        /// The topic.
        topic: String,
        /// What they are.
        schema: String,
    },
    /// Something on it is not JSON.
    #[error("message {number} of {topic} is not JSON: {reason}")]
    Json {
        /// The topic.
        topic: String,
        /// Which, from 0.
        number: u32,
        /// What is wrong.
        reason: serde_json::Error,
    },
    /// The recording is damaged.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The rows are not taken.
    #[error(transparent)]
    Sink(#[from] std::io::Error),
}

/// The topics of a recording that there are tables of, by name.
#[must_use]
pub fn topics(recording: &Recording) -> Vec<String> {
    let mut known: Vec<String> = recording.topics().into_keys().map(str::to_owned).collect();
    if known.iter().any(|topic| topic == FRAME) {
        known.push(EVENTS.to_owned());
        known.sort();
    }
    known
}

/// Whether there is such a topic.
///
/// # Errors
/// [`SheetError::Unknown`] names those there are.
pub fn check(recording: &Recording, topic: &str) -> Result<(), SheetError> {
    let known = topics(recording);
    if known.iter().any(|known| known == topic) {
        Ok(())
    } else {
        Err(SheetError::Unknown { topic: topic.to_owned(), known })
    }
}

/// Gives the table of a topic, row by row.
///
/// # Errors
/// [`SheetError`] if there is no such topic, it is damaged, or the rows are not taken.
pub fn write(recording: &Recording, topic: &str, sink: &mut Sink<'_>) -> Result<(), SheetError> {
    check(recording, topic)?;
    let scenario = &recording.header().notice.scenario;
    if topic == EVENTS {
        return events(recording, scenario, &mut Row::new(sink));
    }
    let first = recording.on(topic).next();
    let row = &mut Row::new(sink);
    match first.and_then(|said| said.schema) {
        None => json::write(recording, topic, row),
        Some(Frame::SCHEMA) => each::<Frame>(recording, topic, scenario, row),
        Some(Picture::SCHEMA) => each::<Picture>(recording, topic, scenario, row),
        Some(Inputs::SCHEMA) => each::<Inputs>(recording, topic, scenario, row),
        Some(Say::SCHEMA) => each::<Say>(recording, topic, scenario, row),
        Some(PolicyProposal::SCHEMA) => each::<PolicyProposal>(recording, topic, scenario, row),
        Some(NavReport::SCHEMA) => each::<NavReport>(recording, topic, scenario, row),
        Some(ExternalOrder::SCHEMA) => each::<ExternalOrder>(recording, topic, scenario, row),
        Some(LinkBytes::SCHEMA) => message::link(recording, topic, row),
        Some(schema) => Err(SheetError::Strange { topic: topic.to_owned(), schema: schema.to_owned() }),
    }
}

fn each<M: Message + Table + serde::de::DeserializeOwned>(
    recording: &Recording,
    topic: &str,
    scenario: &Scenario,
    row: &mut Row<'_>,
) -> Result<(), SheetError> {
    for said in recording.on(topic) {
        said.read::<M>()?.write(scenario, &said, row)?;
    }
    Ok(())
}

fn events(recording: &Recording, scenario: &Scenario, row: &mut Row<'_>) -> Result<(), SheetError> {
    for said in recording.on(FRAME) {
        for event in message::events_of(scenario, &said.read::<Frame>()?) {
            let EventOutcome { tick, at_s, event: word, vehicle, other, team } = &event;
            row.put("t_s", time(SimTime::from_s(*at_s)));
            row.put("tick", *tick);
            row.put("event", word);
            row.put("vehicle", vehicle.as_deref().unwrap_or_default());
            row.put("other", other.as_deref().unwrap_or_default());
            row.put("team", team.as_deref().unwrap_or_default());
            row.put("sentence", event.sentence());
            row.end()?;
        }
    }
    // Where nothing happened, there are no columns either: say them all the same.
    row.otherwise(&["t_s", "tick", "event", "vehicle", "other", "team", "sentence"])?;
    Ok(())
}

/// When and which: how every row begins.
fn begin(row: &mut Row<'_>, said: &Said<'_>) {
    row.put("t_s", time(said.at));
}

/// A time in s, with no more digits than it has; nothing for one before anything can happen.
fn time(at: SimTime) -> String {
    if at <= SimTime::LONG_AGO { String::new() } else { (at.0 as f64 / 1e9).to_string() }
}
