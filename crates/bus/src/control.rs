//! Controlling a game from outside of it.

use crate::{ANSWER, Bus, BusError, Priority, Watched, clock, start_thread};
use messages::topic::{self, GameName};
use messages::{Control, ControlReply};
use std::sync::Arc;
use std::time::Duration;

/// How long the sim may take to answer a stop before it is said again.
const STOP_ANSWER: Duration = Duration::from_millis(200);

/// How often a stop is said by those whom the sim does not answer.
const SAID_UNASKED: u32 = 3;

/// What the sim has answered to one of several questions.
type Answered = Watched<Option<Result<ControlReply, BusError>>>;

/// Controls a game. What stops boats is published to everybody, gateways too, and needs no token; a link may lose it, so it is
/// said again until the sim has answered. The rest is asked of the sim.
///
/// # Errors
/// [`BusError`] if the sim refuses or does not answer (gateways may have heard a stop all the same), if it asks for a token that is
/// not known, or if the session is closed.
///
/// # Panics
/// Never: a control is JSON.
pub fn control(bus: &Bus, game: &GameName, control: Control) -> Result<(), BusError> {
    let key = topic::control(game);
    let reply: Option<ControlReply> =
        // Pausing or ending a game can wait for a question and its challenge; a stop is
        // published at once and asked for besides, since nothing that is published is sure to
        // arrive.
        if control.stops() { stop(bus, &key, control)? } else { bus.request(&key, &control, ANSWER)? };
    match reply {
        Some(Ok(())) => Ok(()),
        Some(Err(reason)) => Err(BusError::Refused(reason)),
        None => Err(BusError::Silent),
    }
}

fn stop(bus: &Bus, key: &str, control: Control) -> Result<Option<ControlReply>, BusError> {
    let publisher = bus.publisher(key.to_owned(), Priority::Urgent)?;
    let (start, json) = (clock::now(), serde_json::to_vec(&control).expect("a control is JSON"));
    let answered = Arc::new(Answered::default());
    for said in 1.. {
        publisher.send_json(json.clone())?;
        ask(bus, key, control, ANSWER.saturating_sub(clock::since(start)), &answered);
        answered.wait(STOP_ANSWER, Option::is_some);
        match answered.visit(Option::take) {
            // Whoever may only look may stop all the same, and must not ask.
            Some(Err(BusError::NotAllowed { .. })) if said < SAID_UNASKED => clock::rest(STOP_ANSWER),
            Some(Err(BusError::NotAllowed { .. })) => return Ok(Some(Ok(()))),
            Some(reply) => return reply.map(Some),
            None if clock::since(start) >= ANSWER => return Ok(None),
            None => {}
        }
    }
    Ok(None)
}

/// Asks the sim. On a long way the next question goes out before the answer to this one is back.
fn ask(bus: &Bus, key: &str, control: Control, limit: Duration, answered: &Arc<Answered>) {
    let (bus, key, answered) = (bus.clone(), key.to_owned(), Arc::clone(answered));
    // In a thread of its own, since a question blocks until it is answered or given up, and the
    // stop must be said again meanwhile.
    let asked = start_thread("stop-question", move || {
        if let Some(reply) = bus.request(&key, &control, limit).transpose() {
            answered.visit(|answered| *answered = Some(reply));
        }
    });
    // Where there is no thread it is asked again.
    drop(asked);
}
