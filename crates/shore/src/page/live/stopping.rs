//! E-stops and halts from pages. An E-stop goes over the game's network and directly to every
//! gateway with a known control port, all at once (`bus::stop`). It never waits for other requests
//! from pages.

use super::SharedState;
use super::live_state::LiveState;
use bus::start_thread;
use bus::stop::{StopCommand, StopNews};
use messages::Control;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Maximum number of concurrent threads; each ends within seconds.
const THREADS_MAX: usize = 256;
/// Interval between checks whether the view is closing.
const ROUND: Duration = Duration::from_millis(500);

/// Stops boats. Gateways can be reached even without a game.
pub(super) fn stop(
    shared: &Arc<SharedState>,
    state: &LiveState,
    control: Control,
) -> Result<(), String> {
    if control == Control::EStop && !shared.stops.gateways().is_empty() {
        shared.stops.stop(None, StopCommand::EStop);
        return Ok(());
    }
    state.on()?;
    if control == Control::EStop {
        shared.stops.stop(None, StopCommand::EStop);
    } else if let (Some(bus), Some(game)) = (state.bus.clone(), state.game.clone()) {
        begin(shared, move |shared| {
            let stopped = bus::control(&bus, &game.name, control);
            stopped
                .err()
                .iter()
                .for_each(|e| (shared.tell)(&format!("{control:?} from the page failed: {e}")));
        })?;
    }
    Ok(())
}

/// Reports boats that do not stop, until the view closes.
pub(super) fn tell_late(shared: &SharedState) {
    while !shared.is_closing() {
        for news in shared.stops.news(ROUND) {
            let late = match news {
                StopNews::Late { vehicle, command } => {
                    format!(
                        "{} from the page: {vehicle} does not confirm it",
                        command.operator_command()
                    )
                }
                StopNews::Sim(Err(reason)) => format!("an E-stop from the page failed: {reason}"),
                _ => continue,
            };
            (shared.tell)(&late);
        }
    }
}

/// Runs `work` in its own thread.
fn begin(
    shared: &Arc<SharedState>,
    work: impl FnOnce(&SharedState) + Send + 'static,
) -> Result<(), String> {
    let under_way = &shared.stopping;
    if under_way.fetch_add(1, Ordering::SeqCst) >= THREADS_MAX {
        under_way.fetch_sub(1, Ordering::SeqCst);
        return Err(format!("{THREADS_MAX} stops are already in progress"));
    }
    let at_work = Arc::clone(shared);
    let thread = start_thread("page-stop", move || {
        work(&at_work);
        at_work.stopping.fetch_sub(1, Ordering::SeqCst);
    });
    if let Err(e) = thread {
        under_way.fetch_sub(1, Ordering::SeqCst);
        return Err(format!("cannot start a thread: {e}"));
    }
    Ok(())
}
