//! Controlling a game from outside of it.

use crate::{ANSWER, Bus, BusError, Priority};
use game::message::{Control, ControlReply};
use game::topic::{self, GameName};

/// Controls a game. What stops boats is published to everybody, gateways too, and needs no token; the rest is asked of the
/// sim.
///
/// # Errors
/// [`BusError`] if the sim refuses or does not answer, if it asks for a token that is not known, or if the session is closed.
///
/// # Panics
/// Never: a control is JSON.
pub fn control(bus: &Bus, game: &GameName, control: Control) -> Result<(), BusError> {
    let key = topic::control(game);
    if control.stops() {
        let publisher = bus.publisher(key, Priority::Urgent)?;
        return publisher.send_json(serde_json::to_vec(&control).expect("a control is JSON"));
    }
    let reply: Option<ControlReply> = bus.request(&key, &control, ANSWER)?;
    match reply {
        Some(Ok(())) => Ok(()),
        Some(Err(reason)) => Err(BusError::Refused(reason)),
        None => Err(BusError::Silent),
    }
}
