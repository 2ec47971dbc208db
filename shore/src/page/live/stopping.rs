//! E-stops and halts that pages ask for. Each goes over the game's network and straight to every gateway that has told its
//! control port, in threads of their own: none waits for another, nor behind anything else that pages ask for.

use super::SharedState;
use super::live_state::LiveState;
use bus::{ask_gateway, start_thread};
use game::external::{FleetCommand, GatewayCommand};
use game::message::Control;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// The most threads at once; each ends within some seconds.
const THREADS_MAX: usize = 256;
/// How long a gateway may take.
const GATEWAY_ANSWER: Duration = Duration::from_secs(3);

/// The threads that are under way.
#[derive(Default)]
pub(super) struct Stopping(AtomicUsize);

/// Stops boats. Gateways can be reached without a game.
pub(super) fn stop(shared: &Arc<SharedState>, state: &LiveState, control: Control) -> Result<(), String> {
    let gateways: Vec<SocketAddr> = match control {
        Control::EStop => state.statuses.values().filter_map(|status| status.control.as_ref()?.parse().ok()).collect(),
        _ => vec![],
    };
    if gateways.is_empty() {
        state.on()?;
    }
    for at in gateways {
        begin(shared, move |shared| {
            let stopped = ask_gateway(at, None, &GatewayCommand::Fleet(FleetCommand::EStop), GATEWAY_ANSWER);
            stopped.err().iter().for_each(|e| (shared.tell)(&format!("an E-stop was asked for on the page: {e}")));
        })?;
    }
    if let (Some(bus), Some(game)) = (state.bus.clone(), state.game.clone()) {
        begin(shared, move |shared| {
            let stopped = bus::control(&bus, &game.name, control);
            stopped.err().iter().for_each(|e| (shared.tell)(&format!("{control:?} was asked for on the page: {e}")));
        })?;
    }
    Ok(())
}

/// Runs `work` in a thread of its own.
fn begin(shared: &Arc<SharedState>, work: impl FnOnce(&SharedState) + Send + 'static) -> Result<(), String> {
    let under_way = &shared.stopping.0;
    if under_way.fetch_add(1, Ordering::SeqCst) >= THREADS_MAX {
        under_way.fetch_sub(1, Ordering::SeqCst);
        return Err(format!("{THREADS_MAX} stops are under way"));
    }
    let at_work = Arc::clone(shared);
    let thread = start_thread("page-stop", move || {
        work(&at_work);
        at_work.stopping.0.fetch_sub(1, Ordering::SeqCst);
    });
    if let Err(e) = thread {
        under_way.fetch_sub(1, Ordering::SeqCst);
        return Err(format!("there is no thread for it: {e}"));
    }
    Ok(())
}
