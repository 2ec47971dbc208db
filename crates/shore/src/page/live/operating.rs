//! Operator commands to the gateways of real boats. Each goes over the game's network in its own
//! thread. For each boat, one command that needs the token and one that does not, such as a stop,
//! can be in progress, so that no number of commands can delay a stop.

use super::SharedState;
use super::live_state::{LiveGame, LiveState};
use bus::stop::StopCommand;
use bus::{ANSWER, Bus, BusError, start_thread};
use messages::external::{OperatorCommand, OperatorReply};
use messages::topic;
use primitives::VehicleId;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// Maximum number of replies queued for a page; a page that does not read them misses some.
const REPLIES_MAX: usize = 16;

/// The result of a command.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Operated {
    pub(super) vehicle: VehicleId,
    pub(super) command: &'static str,
    /// The reason if it was refused.
    pub(super) refused: Option<String>,
}

/// The commands to the boats of a game.
#[derive(Default)]
pub(super) struct Operating {
    /// Commands in progress: the boat, and whether they need the token.
    under_way: BTreeSet<(VehicleId, bool)>,
    /// By page: the results of its own commands.
    replies: BTreeMap<u64, VecDeque<Operated>>,
}

impl Operating {
    /// Takes the next reply for a page.
    pub(super) fn reply(&mut self, page: u64) -> Option<Operated> {
        self.replies.get_mut(&page)?.pop_front()
    }

    /// Forgets a page that has disconnected.
    pub(super) fn forget(&mut self, page: u64) {
        self.replies.remove(&page);
    }

    /// Starts a command unless a command of the same kind is in progress for the boat.
    fn begin(
        &mut self,
        page: u64,
        vehicle: VehicleId,
        command: &OperatorCommand,
    ) -> Result<(), String> {
        self.replies.entry(page).or_default();
        if self.under_way.insert((vehicle, command.needs_token())) {
            return Ok(());
        }
        Err("the boat's gateway has not answered the previous command yet".to_owned())
    }

    fn end(&mut self, page: u64, needs_token: bool, operated: Operated) {
        self.under_way.remove(&(operated.vehicle, needs_token));
        if let Some(replies) = self
            .replies
            .get_mut(&page)
            .filter(|replies| replies.len() < REPLIES_MAX)
        {
            replies.push_back(operated);
        }
    }
}

/// Sends a command to a boat's gateway. The reply goes to the page that sent the command.
pub(super) fn operate(
    shared: &Arc<SharedState>,
    state: &mut LiveState,
    page: u64,
    name: &str,
    command: OperatorCommand,
) -> Result<(), String> {
    let game = state.on()?;
    let vehicle = game
        .scenario()
        .vehicle_named(name)
        .map_err(|e| e.to_string())?;
    if !game
        .scenario()
        .externals()
        .any(|external| external == vehicle)
    {
        return Err(format!("{name} is simulated and has no gateway"));
    }
    let Some(bus) = state.bus.clone() else {
        return Err("the game is no longer running".to_owned());
    };
    state.operating.begin(page, vehicle, &command)?;
    // A stop uses every path, including this query. The latest command counts.
    let stop = StopCommand::of(&command);
    match stop {
        Some(stop) => shared.stops.stop(Some(name), stop),
        None if command != OperatorCommand::Status => shared.stops.cancel(Some(name)),
        None => {}
    }
    let generation = state.generation;
    let needs_token = command.needs_token();
    let word = (&command).into();
    let at_work = Arc::clone(shared);
    let named = name.to_owned();
    let thread = start_thread("page-operate", move || {
        let reply = ask(&bus, &game, vehicle, &command);
        if let (Err(_), Some(stop)) = (&reply, stop) {
            // Without the token, replies are not trusted, but the boat's status is.
            at_work
                .stops
                .wait(ANSWER, |orders| orders.is_shown(&named, stop));
        }
        let mut state = at_work.state.lock();
        // No page waits for a reply from a game that no longer exists.
        if state.generation == generation {
            let refused = match reply {
                Ok(OperatorReply { refused, status }) => {
                    state.statuses.insert(vehicle, Arc::new(status));
                    refused
                }
                // The boat's status shows that the command arrived on a different path.
                Err(_)
                    if stop.is_some_and(|stop| {
                        at_work.stops.visit(|orders| orders.is_shown(&named, stop))
                    }) =>
                {
                    None
                }
                Err(reason) => Some(reason),
            };
            state.operating.end(
                page,
                needs_token,
                Operated {
                    vehicle,
                    command: word,
                    refused,
                },
            );
            drop(state);
            at_work.news.send_replace(());
        }
    });
    thread.map_err(|e| {
        state.operating.under_way.remove(&(vehicle, needs_token));
        format!("cannot start a thread: {e}")
    })
}

fn ask(
    bus: &Bus,
    game: &LiveGame,
    vehicle: VehicleId,
    command: &OperatorCommand,
) -> Result<OperatorReply, String> {
    let name = game.name_of(vehicle);
    let reply: Result<Option<OperatorReply>, BusError> =
        bus.request_node(&topic::operate(&game.name, name), command, ANSWER);
    let reply = reply
        .map_err(|e| e.to_string())?
        .ok_or_else(|| format!("no gateway of {name} is responding"))?;
    if reply.status.vehicle == name {
        Ok(reply)
    } else {
        Err(format!(
            "the gateway of {} answered a request meant for {name}",
            reply.status.vehicle
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOAT: VehicleId = VehicleId(1);

    #[test]
    fn a_stop_waits_for_no_other_command_and_a_flood_is_refused() {
        let mut operating = Operating::default();
        assert_eq!(operating.begin(7, BOAT, &OperatorCommand::Arm), Ok(()));
        for command in [
            OperatorCommand::Arm,
            OperatorCommand::Release,
            OperatorCommand::StationKeep,
        ] {
            assert!(operating.begin(7, BOAT, &command).is_err(), "{command:?}");
        }
        assert_eq!(
            operating.begin(7, VehicleId(2), &OperatorCommand::Arm),
            Ok(()),
            "another boat"
        );
        assert_eq!(operating.begin(7, BOAT, &OperatorCommand::Disarm), Ok(()));
        assert!(
            operating.begin(7, BOAT, &OperatorCommand::EStop).is_err(),
            "a stop is in progress"
        );
        let operated = |refused: Option<&str>| Operated {
            vehicle: BOAT,
            command: "arm",
            refused: refused.map(str::to_owned),
        };
        operating.end(7, true, operated(Some("missing: a fresh order")));
        assert_eq!(operating.begin(7, BOAT, &OperatorCommand::Arm), Ok(()));
        assert_eq!(operating.reply(8), None, "the reply is for another page");
        assert_eq!(
            operating.reply(7),
            Some(operated(Some("missing: a fresh order")))
        );
        (0..2 * REPLIES_MAX).for_each(|_| operating.end(7, true, operated(None)));
        assert_eq!(
            std::iter::from_fn(|| operating.reply(7)).count(),
            REPLIES_MAX
        );
        operating.forget(7);
        operating.end(7, true, operated(None));
        assert!(
            operating.replies.is_empty(),
            "no reply is kept for a page that has left"
        );
    }
}
