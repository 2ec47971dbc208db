//! Keeps the gateway in the game: joins whenever a sim is available, as long as the gateway runs.

use super::POLL;
use super::loop_input::Call;
use bus::game_search::{self, GameSearch, Joined, Missing, NotFound};
use bus::{Bus, BusError, InboxSender, NodeThread, Patience, Place, SimWatch};
use messages::Role;
use messages::topic::GameName;
use scenario::Scenario;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The thread that joins the game.
pub(super) struct Join {
    stop: Arc<AtomicBool>,
    _thread: NodeThread,
}

impl Join {
    /// Starts requesting this vehicle.
    pub(super) fn begin(
        bus: &Bus,
        place: &Place,
        (game, scenario): (&GameName, &Scenario),
        vehicle: &str,
        calls: InboxSender<Call>,
    ) -> Result<Join, BusError> {
        // Only the sim's liveliness token matters: if the sim hangs, the gateway waits for it, and
        // without orders the boat stops.
        let sim = SimWatch::open(bus, game, Patience::of_player(Duration::MAX))?;
        let stop = Arc::new(AtomicBool::new(false));
        let bus = bus.clone();
        let place = place.clone();
        let game = game.clone();
        let scenario = scenario.clone();
        let vehicles = [vehicle.to_owned()];
        let ended = Arc::clone(&stop);
        let join =
            move || game_search::join(&bus, &place, (&game, &scenario), Role::Gateway, &vehicles);
        let failed = |e: std::io::Error| BusError::Use {
            doing: "start the thread that joins as",
            key: vehicle.to_owned(),
            reason: e.to_string(),
        };
        let thread =
            NodeThread::start(move || keep_joined(&join, &sim, &ended, &calls)).map_err(failed)?;
        Ok(Join {
            stop,
            _thread: thread,
        })
    }
}

impl Drop for Join {
    fn drop(&mut self) {
        // Dropping the fields joins the thread.
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// Joins, waits until the sim is lost, and repeats this with the next sim.
fn keep_joined(
    join: &impl Fn() -> Result<Joined, Missing>,
    sim: &SimWatch,
    stop: &AtomicBool,
    calls: &InboxSender<Call>,
) {
    while !stop.load(Ordering::Relaxed) {
        if !sim.find(POLL) {
            continue;
        }
        let mut say = |reason: &str| calls.put(Call::Remark(format!("joining: {reason}")));
        match GameSearch::new(Duration::MAX, stop).until(&mut say, join) {
            Ok(joined) => calls.put(Call::Joined(joined)),
            // Keep trying: the gateway that holds the boat may be about to leave, or the next sim
            // may include the boat.
            Err(NotFound::Refused(refusal)) => {
                calls.put(Call::Remark(format!("refused by the sim: {refusal}")))
            }
            Err(NotFound::InTime(..)) => return,
        }
        while !stop.load(Ordering::Relaxed) && !sim.is_lost(POLL) {}
        calls.put(Call::SimGone);
    }
}
