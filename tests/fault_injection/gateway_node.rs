//! The gateway of a game's real boat, unmodified, over a link in memory.

use crate::play::{WAIT, name, net};
use crate::real_boat::{DECLINATION_RAD, Wire};
use bus::{NodeThread, clock};
use gateway::bridge::{Event, Plan};
use gateway::config::Gateway;
use gateway::link::{BoatLink, LinkEvent};
use gateway::node::{NodeError, NodeEvent, OnLinkEvent, Settings, serve_over};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

/// Time without a byte after which a boat counts as lost.
const SILENCE: Duration = Duration::from_secs(3);
/// The time needed to connect.
const CONNECT: Duration = Duration::from_millis(100);
/// Interval at which a link without a boat checks whether to end.
const POLL: Duration = Duration::from_millis(500);

/// The gateway's settings.
static GATEWAY: LazyLock<Gateway> = LazyLock::new(|| {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/gateways/surveyor.toml");
    let gateway =
        scenario::load_file::<gateway::config::Gateway>(&file).unwrap_or_else(|e| panic!("{e}"));
    Gateway {
        declination_rad: Some(DECLINATION_RAD),
        ..gateway
    }
});

/// Runs the gateway of a boat until `stop` is set.
pub(crate) fn connect(wire: &Arc<Wire>, vehicle: &str, stop: &Arc<AtomicBool>) {
    let settings = Settings {
        plan: Plan::new(vehicle, GATEWAY.clone()),
        game: Some(name()),
        place: net(false).into(),
        at_game_pace: false,
        commit: "",
        wait: WAIT,
        stop: Arc::clone(stop),
    };
    wire.note_start();
    let open = |on_event| Ok(Box::new(MemoryLink::open(wire, on_event)) as Box<dyn BoatLink>);
    let mut notify = |event: NodeEvent<'_>| {
        if let NodeEvent::Event {
            event: Event::State { from, to },
            ..
        } = event
        {
            wire.note_state(from, to);
        }
    };
    match serve_over(&settings, open, &mut notify) {
        // The sim died before the gateway found it.
        Ok(()) | Err(NodeError::NotFound(_)) => {}
        Err(e) => panic!("the gateway fails: {e}"),
    }
}

/// A link over an in-memory wire.
struct MemoryLink {
    wire: Arc<Wire>,
    on_event: Arc<OnLinkEvent>,
    _reader: NodeThread,
}

impl MemoryLink {
    fn open(wire: &Arc<Wire>, on_event: OnLinkEvent) -> MemoryLink {
        let link = wire.visit(|state, _| {
            state.links += 1;
            state.is_connected = false;
            state.links
        });
        let wire = Arc::clone(wire);
        let on_event = Arc::new(on_event);
        let read_from = Arc::clone(&wire);
        let tell = Arc::clone(&on_event);
        let reader = NodeThread::start(move || read(&read_from, link, &**tell));
        MemoryLink {
            wire,
            on_event,
            _reader: reader.expect("a thread of the simulation"),
        }
    }
}

/// Connects and reads repeatedly, as long as this link is the newest on the wire.
fn read(wire: &Wire, link: u64, tell: &(dyn Fn(LinkEvent) + Send + Sync)) {
    let is_over = || wire.visit(|state, _| state.links != link);
    let mut peer = 0;
    while !is_over() {
        if !wire.wait(POLL, |state| state.links != link || state.is_whole) {
            continue;
        }
        clock::rest(CONNECT);
        if is_over() {
            return;
        }
        wire.visit(|state, _| {
            (state.is_connected, state.from_boat) = (true, vec![]);
            state.oracle.forget();
        });
        tell(LinkEvent::Up {
            peer,
            name: "memory".to_owned(),
        });
        while wire.wait(SILENCE, |state| {
            state.links != link || !state.from_boat.is_empty()
        }) && !is_over()
        {
            let bytes = wire.visit(|state, now| {
                let bytes = std::mem::take(&mut state.from_boat);
                state.oracle.note(now, &bytes);
                bytes
            });
            tell(LinkEvent::Bytes {
                peer,
                at: clock::now(),
                bytes,
            });
        }
        if is_over() {
            return;
        }
        wire.visit(|state, _| state.is_connected = false);
        tell(LinkEvent::Down {
            peer,
            reason: format!("no bytes for {SILENCE:?}"),
        });
        peer += 1;
    }
}

impl BoatLink for MemoryLink {
    fn send(&self, bytes: Vec<u8>, tag: u64) {
        self.wire.carry(&bytes);
        (self.on_event)(LinkEvent::Written {
            tag,
            at: clock::now(),
        });
    }

    fn displaced(&self) -> u64 {
        0
    }

    fn send_and_wait(&self, bytes: &[u8], _limit: Duration) -> bool {
        self.wire.carry(bytes);
        true
    }
}

impl Drop for MemoryLink {
    fn drop(&mut self) {
        // Dropping the fields joins the reader thread.
        self.wire.visit(|state, _| state.links += 1);
    }
}
