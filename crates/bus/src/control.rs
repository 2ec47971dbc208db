//! Controlling a game from another process.

use crate::{ANSWER, Bus, BusError, Priority, Watched, clock, start_thread};
use messages::topic::{self, GameName};
use messages::{Control, ControlReply};
use std::sync::Arc;
use std::time::Duration;

/// Time for the sim to answer a stop before the stop is repeated.
const STOP_ANSWER: Duration = Duration::from_millis(200);

/// Number of times that a node without the right to query the sim publishes a stop.
const SAID_UNASKED: u32 = 3;

/// The sim's answer to one of several queries.
type Answered = Watched<Option<Result<ControlReply, BusError>>>;

/// Controls a game. Commands that stop boats are published to all nodes, including gateways, and
/// need no token; they are repeated until the sim answers, since a link may lose them. All other
/// commands are queries to the sim.
///
/// # Errors
/// [`BusError`] if the sim refuses or does not respond (gateways may still have received a stop),
/// if it requires a token that this node lacks, or if the session is closed.
///
/// # Panics
/// Never: every control can be encoded as JSON.
pub fn control(bus: &Bus, game: &GameName, control: Control) -> Result<(), BusError> {
    let key = topic::control(game);
    let reply: Option<ControlReply> =
        // Pausing or ending a game can wait for a query and its challenge. A stop is published
        // immediately and also sent as a query, since published messages may be lost.
        if control.stops() { stop(bus, &key, control)? } else { bus.request(&key, &control, ANSWER)? };
    match reply {
        Some(Ok(())) => Ok(()),
        Some(Err(reason)) => Err(BusError::Refused(reason)),
        None => Err(BusError::Silent),
    }
}

fn stop(bus: &Bus, key: &str, control: Control) -> Result<Option<ControlReply>, BusError> {
    let publisher = bus.publisher(key.to_owned(), Priority::Urgent)?;
    let start = clock::now();
    let json = serde_json::to_vec(&control).expect("a control is JSON");
    let answered = Arc::new(Answered::default());
    for said in 1.. {
        publisher.send_json(json.clone())?;
        ask(
            bus,
            key,
            control,
            ANSWER.saturating_sub(clock::since(start)),
            &answered,
        );
        answered.wait(STOP_ANSWER, Option::is_some);
        match answered.visit(Option::take) {
            // Observers may also stop a game, but they may not query the sim.
            Some(Err(BusError::NotAllowed { .. })) if said < SAID_UNASKED => {
                clock::rest(STOP_ANSWER)
            }
            Some(Err(BusError::NotAllowed { .. })) => return Ok(Some(Ok(()))),
            Some(reply) => return reply.map(Some),
            None if clock::since(start) >= ANSWER => return Ok(None),
            None => {}
        }
    }
    Ok(None)
}

/// Queries the sim. On a slow link, the next query is sent before the reply to this one arrives.
fn ask(bus: &Bus, key: &str, control: Control, limit: Duration, answered: &Arc<Answered>) {
    let bus = bus.clone();
    let key = key.to_owned();
    let answered = Arc::clone(answered);
    // Query in a separate thread: a query blocks until answered or timed out, and the stop must be
    // repeated meanwhile.
    let asked = start_thread("stop-question", move || {
        if let Some(reply) = bus.request(&key, &control, limit).transpose() {
            answered.visit(|answered| *answered = Some(reply));
        }
    });
    // If no thread can be started, the next repeat queries again.
    drop(asked);
}
