//! Controlling a game from outside of it.

use crate::{ANSWER, Bus, BusError, Priority, clock};
use game::message::{Control, ControlReply};
use game::topic::{self, GameName};
use std::time::Duration;

/// How long the sim may take to answer a stop before it is said again.
const STOP_ANSWER: Duration = Duration::from_millis(200);

/// How often a stop is said by those whom the sim does not answer.
const SAID_UNASKED: u32 = 3;

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
    for said in 1.. {
        publisher.send_json(json.clone())?;
        let asked = clock::now();
        let reply = match bus.request(key, &control, STOP_ANSWER) {
            // Whoever may only look may stop all the same, and must not ask.
            Err(BusError::NotAllowed { .. }) if said < SAID_UNASKED => None,
            Err(BusError::NotAllowed { .. }) => Some(Ok(())),
            reply => reply?,
        };
        if reply.is_some() || clock::since(start) >= ANSWER {
            return Ok(reply);
        }
        // Without a link there is nobody to ask, which shows at once.
        clock::rest(STOP_ANSWER.saturating_sub(clock::since(asked)));
    }
    Ok(None)
}
