//! Keeps the gateway in the game: joins whenever a sim is there, for as long as the gateway runs.

use super::loop_input::Call;
use bus::game_search::{self, GameSearch, NotFound};
use bus::{Bus, BusError, InboxSender, NodeThread, Patience, Place, SimWatch};
use messages::Role;
use messages::topic::GameName;
use scenario::Scenario;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often a thread that sees no change looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);

/// The thread that joins.
pub(super) struct Join {
    stop: Arc<AtomicBool>,
    _thread: NodeThread,
}

impl Join {
    /// Begins to ask for this vehicle.
    pub(super) fn begin(
        bus: &Bus,
        place: &Place,
        (game, scenario): (&GameName, &Scenario),
        vehicle: &str,
        calls: InboxSender<Call>,
    ) -> Result<Join, BusError> {
        // Its token is all that counts: a sim that hangs is waited for, and its boat rests when no orders come.
        let sim = SimWatch::open(bus, game, Patience::of_player(Duration::MAX))?;
        let stop = Arc::new(AtomicBool::new(false));
        let (bus, place, game, scenario) = (bus.clone(), place.clone(), game.clone(), scenario.clone());
        let joining = Joining { bus, place, game, scenario, vehicle: [vehicle.to_owned()] };
        let ended = Arc::clone(&stop);
        let failed = |e: std::io::Error| BusError::Use {
            doing: "start the thread that joins as",
            key: vehicle.to_owned(),
            reason: e.to_string(),
        };
        let thread = NodeThread::start(move || joining.keep_joined(&sim, &ended, &calls)).map_err(failed)?;
        Ok(Join { stop, _thread: thread })
    }
}

impl Drop for Join {
    fn drop(&mut self) {
        // The thread is waited for when the fields are dropped.
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// What the thread joins, with what, and by which way.
struct Joining {
    bus: Bus,
    place: Place,
    game: GameName,
    scenario: Scenario,
    vehicle: [String; 1],
}

impl Joining {
    /// Joins, waits until the sim is gone, and begins again with the next.
    fn keep_joined(&self, sim: &SimWatch, stop: &AtomicBool, calls: &InboxSender<Call>) {
        let Joining { bus, place, game, scenario, vehicle } = self;
        while !stop.load(Ordering::Relaxed) {
            if !sim.find(LOOK) {
                continue;
            }
            let mut say = |reason: &str| calls.put(Call::Remark(format!("joining: {reason}")));
            let joined = GameSearch::new(Duration::MAX, stop)
                .until(&mut say, || game_search::join(bus, place, (game, scenario), Role::Gateway, vehicle));
            match joined {
                Ok(joined) => calls.put(Call::Joined(joined)),
                // It goes on: the boat may be taken by a gateway that is about to leave, or the
                // next sim may know it.
                Err(NotFound::Refused(refusal)) => calls.put(Call::Remark(format!("the sim refuses: {refusal}"))),
                Err(NotFound::InTime(..)) => return,
            }
            while !stop.load(Ordering::Relaxed) && !sim.is_lost(LOOK) {}
            calls.put(Call::SimGone);
        }
    }
}
