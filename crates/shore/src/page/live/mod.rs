//! A running game, shown to pages that may also control it.
//!
//! One thread finds the game, subscribes to it, and searches again when it has disappeared
//! (`game_watcher`). Another queries data that are not published (`query_thread`). Both write the
//! state that all viewers read (`live_state`). Stops have their own threads (`stopping`).

mod event_log;
mod frame_buffer;
mod game_watcher;
mod live_state;
mod operating;
mod query_thread;
mod steering;
mod stopping;
mod viewer;

use super::view::{Access, Changes, View, Viewer};
use bus::stop::StopClient;
use bus::{ANSWER, InboxSender, Place, inbox, start_thread};
use game_watcher::GameWatcher;
use live_state::LiveState;
use messages::Control;
use messages::external::Mission;
use messages::topic::GameName;
use parking_lot::Mutex;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use viewer::PageViewer;

/// Maximum number of commands queued for the network.
const COMMANDS_MAX: usize = 64;

/// Reports a failure to a person, in one sentence.
pub type Tell = Box<dyn Fn(&str) + Send + Sync>;

/// Parses the contents of a mission file. The error states the fault.
pub type ReadMission = fn(&str) -> Result<Mission, String>;

/// A game on the network, shown to pages.
pub struct LiveView {
    shared: Arc<SharedState>,
}

/// The state shared by the threads and all viewers.
struct SharedState {
    /// Locked only briefly.
    state: Mutex<LiveState>,
    news: Changes,
    commands: InboxSender<Command>,
    stops: StopClient,
    /// The number of threads that stop boats.
    stopping: AtomicUsize,
    /// Reports failures to a person.
    tell: Tell,
    read_mission: ReadMission,
    pages: AtomicU64,
    is_closing: AtomicBool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Command {
    /// A command for the whole game, other than one that stops boats.
    Control(Control),
    /// The state has new set-points for steered boats.
    Steer,
}

impl LiveView {
    /// Searches for a game at `place` (the named one, or the only one running) until dropped.
    /// `tell` receives a description of what is missing, whenever this changes, and refusals from
    /// the sim. `read_mission` parses operators' mission files.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn open(
        place: Place,
        game: Option<GameName>,
        tell: Tell,
        read_mission: ReadMission,
    ) -> std::io::Result<LiveView> {
        let (commands, to_do) = inbox(COMMANDS_MAX);
        let shared = Arc::new(SharedState::new(commands, tell, read_mission)?);
        let watcher = GameWatcher {
            shared: Arc::clone(&shared),
            place,
            game,
            commands: to_do,
        };
        start_thread("page-live", move || watcher.run())?;
        let late = Arc::clone(&shared);
        start_thread("page-late", move || stopping::tell_late(&late))?;
        Ok(LiveView { shared })
    }

    /// Whether the game shown has real boats.
    pub fn has_real_boats(&self) -> bool {
        self.shared
            .state
            .lock()
            .on()
            .is_ok_and(|game| game.has_real_boats())
    }
}

impl Drop for LiveView {
    fn drop(&mut self) {
        // The thread may be waiting for a reply; it ends by itself.
        self.shared.is_closing.store(true, Ordering::Relaxed);
    }
}

impl View for LiveView {
    fn open_viewer(&self, access: Access) -> Box<dyn Viewer> {
        let page = self.shared.pages.fetch_add(1, Ordering::Relaxed);
        Box::new(PageViewer::new(Arc::clone(&self.shared), access, page))
    }

    fn news(&self) -> &Changes {
        &self.shared.news
    }
}

impl SharedState {
    fn new(
        commands: InboxSender<Command>,
        tell: Tell,
        read_mission: ReadMission,
    ) -> std::io::Result<SharedState> {
        Ok(SharedState {
            state: Mutex::default(),
            news: Changes::default(),
            commands,
            // A person at the page can repeat the stop.
            stops: StopClient::open(ANSWER)?,
            stopping: AtomicUsize::new(0),
            tell,
            read_mission,
            pages: AtomicU64::new(1),
            is_closing: AtomicBool::new(false),
        })
    }

    fn is_closing(&self) -> bool {
        self.is_closing.load(Ordering::Relaxed)
    }
}
