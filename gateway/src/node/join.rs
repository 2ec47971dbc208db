//! Keeps the boat moored: asks the sim for a ticket whenever a sim is there, for as long as the gateway runs.

use super::gateway_loop::Call;
use bus::game_search::{self, GameSearch, NotFound};
use bus::{Bus, BusError, Declaration, InboxSender, Watched};
use game::topic::{self, GameName, Part};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often a watcher that sees no change looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);

/// The thread that asks.
pub(super) struct Join {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    _watch: Declaration,
}

impl Join {
    /// Begins to ask for this vehicle.
    pub(super) fn begin(bus: &Bus, game: &GameName, vehicle: &str, calls: InboxSender<Call>) -> Result<Join, BusError> {
        let sims = Arc::new(Watched::new(BTreeSet::<String>::new()));
        let seen = Arc::clone(&sims);
        let watch = bus.watch_alive(topic::all_alive(game, Part::Sim), move |key, alive| {
            seen.visit(|sims| if alive { sims.insert(key.to_owned()) } else { sims.remove(key) });
        })?;
        let stop = Arc::new(AtomicBool::new(false));
        let (bus, game, vehicle, ended) = (bus.clone(), game.clone(), vehicle.to_owned(), Arc::clone(&stop));
        let thread = std::thread::spawn(move || ask(&bus, &game, &vehicle, &sims, &ended, &calls));
        Ok(Join { stop, thread: Some(thread), _watch: watch })
    }
}

impl Drop for Join {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        // A thread that panicked has nothing to give back.
        self.thread.take().map(JoinHandle::join).into_iter().for_each(drop);
    }
}

/// Moors, waits until the sim is gone, and begins again with the next.
fn ask(
    bus: &Bus,
    game: &GameName,
    vehicle: &str,
    sims: &Watched<BTreeSet<String>>,
    stop: &AtomicBool,
    calls: &InboxSender<Call>,
) {
    while !stop.load(Ordering::Relaxed) {
        let mut there = BTreeSet::new();
        let some = sims.wait(LOOK, |now| {
            there.clone_from(now);
            !now.is_empty()
        });
        if !some {
            continue;
        }
        let mut say = |reason: &str| calls.put(Call::Remark(format!("mooring: {reason}")));
        let vehicles = [vehicle.to_owned()];
        let asked = GameSearch::new(Duration::MAX, stop)
            .until(&mut say, || game_search::join(bus, &topic::moor(game), &vehicles, "gateway"));
        match asked {
            Ok((ticket, vehicles)) => calls.put(Call::Moored(ticket, vehicles)),
            Err(NotFound::Refused(refusal)) => calls.put(Call::Remark(format!("the sim refuses: {refusal}"))),
            Err(NotFound::InTime(..)) => return,
        }
        while !stop.load(Ordering::Relaxed) && !sims.wait(LOOK, |now| *now != there) {}
        calls.put(Call::SimGone);
    }
}
