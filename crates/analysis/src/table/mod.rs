//! Tables of single topics as CSV.
//!
//! The first column is `t_s`, the time of the game (or of the gateway's clock). Columns have the
//! names of message fields, with boat and team names instead of numbers. Units are those of the
//! messages, except that times are in s. Missing values are empty cells.
//!
//! | topic | row |
//! |---|---|
//! | `frame` | a decision: all boats, flags, the score, and the events since the last as sentences |
//! | `picture/<team>` | an own boat or a contact in a picture (see column `seen`) |
//! | `inputs` | one input of the game |
//! | `say/<team>` | a shared variable of a boat |
//! | `link/<boat>` | a line on the link, at the time of the chunk that completed it |
//! | `events` | an event of the game (extracted from its frames, not a topic of the file) |
//! | any other | a message; JSON is flattened, with numbered lists |

mod cells;
mod message;

use crate::link_line::{Line, Lines};
use cells::Cells;
use messages::external::LinkBytes;
use messages::{Frame, Message};
use primitives::SimTime;
use recording::{Bag, Damaged, FRAME, RecordedMessage, RecordingError};
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use serde_json::Value;
use std::collections::BTreeSet;
use thiserror::Error;

/// Pseudo-topic of the events.
pub const EVENTS: &str = "events";

/// Receives rows, starting with the column names.
pub type Sink<'a> = dyn FnMut(&[String]) -> std::io::Result<()> + 'a;

/// Why a table cannot be written.
#[derive(Debug, Error)]
pub enum TableError {
    /// The recording has no such topic.
    #[error("no topic {topic:?} in this recording; its topics are: {}", .known.join(", "))]
    Unknown {
        /// The topic.
        topic: String,
        /// The available topics.
        known: Vec<String>,
    },
    /// There is no table for messages of this kind.
    #[error("messages of {topic} have the type {schema}, which has no table")]
    Strange {
        /// The topic.
        topic: String,
        /// Their schema.
        schema: String,
    },
    /// A row could not be written.
    #[error(transparent)]
    Sink(#[from] std::io::Error),
}

/// The topics of a recording that have tables, by name.
pub fn topics(bag: &Bag) -> Vec<String> {
    let mut known: Vec<String> = bag.topics().into_keys().map(str::to_owned).collect();
    if known.iter().any(|topic| topic == FRAME) {
        known.push(EVENTS.to_owned());
        known.sort();
    }
    known
}

/// Checks that the topic exists.
///
/// # Errors
/// [`TableError::Unknown`] lists the available topics.
pub fn check(bag: &Bag, topic: &str) -> Result<(), TableError> {
    let known = topics(bag);
    if known.iter().any(|known| known == topic) {
        Ok(())
    } else {
        Err(TableError::Unknown {
            topic: topic.to_owned(),
            known,
        })
    }
}

/// Writes the table of a topic row by row and returns the damaged messages. For the recording of a
/// game, `scenario` is the game's.
///
/// # Errors
/// [`TableError`] if the topic does not exist or is damaged, or a row cannot be written.
pub fn write(
    bag: &Bag,
    scenario: Option<&Scenario>,
    topic: &str,
    sink: &mut Sink<'_>,
) -> Result<Damaged, TableError> {
    check(bag, topic)?;
    let schema = bag.on(topic).next().and_then(|message| message.schema);
    match (topic, schema, scenario) {
        (EVENTS, _, Some(scenario)) => events(bag, scenario, sink),
        (_, None, _) => json(bag, topic, sink),
        (_, Some(LinkBytes::SCHEMA), _) => link(bag, topic, sink),
        (_, Some(schema), Some(scenario))
            if let Some(columns) = message::columns(schema, scenario) =>
        {
            let columns: Vec<String> = std::iter::once("t_s".to_owned()).chain(columns).collect();
            sink(&columns)?;
            let mut damaged = Damaged::default();
            for message in bag.on(topic) {
                for cells in damaged
                    .sound(message::rows(&message, scenario))
                    .unwrap_or_default()
                {
                    sink(&cells::in_order(cells, message.at, &columns))?;
                }
            }
            Ok(damaged)
        }
        (_, Some(schema), _) => Err(TableError::Strange {
            topic: topic.to_owned(),
            schema: schema.to_owned(),
        }),
    }
}

/// Flattened JSON: one column for every path in any message of the topic.
fn json(bag: &Bag, topic: &str, sink: &mut Sink<'_>) -> Result<Damaged, TableError> {
    let cells_of = |message: &RecordedMessage<'_>| -> Result<Cells, RecordingError> {
        let leaves = cells::flat(&message.read_json::<Value>()?);
        Ok(leaves
            .into_iter()
            .map(|(path, leaf)| (path, cells::text(&leaf)))
            .collect())
    };
    // The columns are known only after reading all messages, which are few.
    let mut paths = BTreeSet::new();
    let mut damaged = Damaged::default();
    for message in bag.on(topic) {
        paths.extend(
            damaged
                .sound(cells_of(&message))
                .unwrap_or_default()
                .into_keys(),
        );
    }
    let columns: Vec<String> = std::iter::once("t_s".to_owned()).chain(paths).collect();
    sink(&columns)?;
    for message in bag.on(topic) {
        if let Ok(cells) = cells_of(&message) {
            sink(&cells::in_order(cells, message.at, &columns))?;
        }
    }
    Ok(damaged)
}

/// Writes a row for each line on a link.
fn link(bag: &Bag, topic: &str, sink: &mut Sink<'_>) -> Result<Damaged, TableError> {
    sink(&["t_s", "direction", "text"].map(str::to_owned))?;
    let mut lines = Lines::default();
    let mut last = SimTime::ZERO;
    let mut write = |at, line: Line| {
        let direction = if line.outward { "to_boat" } else { "from_boat" };
        sink(&[cells::time(at), direction.to_owned(), line.text])
    };
    let mut damaged = Damaged::default();
    for message in bag.on(topic) {
        last = message.at;
        if let Some(LinkBytes { outward, data, .. }) = damaged.sound(message.read()) {
            for line in lines.take(outward, &data) {
                write(last, line)?;
            }
        }
    }
    for line in lines.rest() {
        write(last, line)?;
    }
    Ok(damaged)
}

fn events(bag: &Bag, scenario: &Scenario, sink: &mut Sink<'_>) -> Result<Damaged, TableError> {
    sink(
        &[
            "t_s", "tick", "event", "vehicle", "other", "team", "sentence",
        ]
        .map(str::to_owned),
    )?;
    let mut damaged = Damaged::default();
    for message in bag.on(FRAME) {
        let Some(frame) = damaged.sound(message.read::<Frame>()) else {
            continue;
        };
        for logged in frame.logged(scenario) {
            let event = EventOutcome::new(scenario, &logged);
            let sentence = event.sentence();
            let EventOutcome {
                tick,
                at_s,
                event,
                vehicle,
                other,
                team,
            } = event;
            let [vehicle, other, team] = [vehicle, other, team].map(Option::unwrap_or_default);
            sink(&[
                cells::time(SimTime::from_s(at_s)),
                tick.to_string(),
                event,
                vehicle,
                other,
                team,
                sentence,
            ])?;
        }
    }
    Ok(damaged)
}
