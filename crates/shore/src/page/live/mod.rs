//! A running game, shown to pages that may also control it.
//!
//! One thread finds the game, subscribes to it, and finds it again when it is gone (`game_watcher`). Another queries what is
//! not published (`query_thread`). Both write the state that all viewers read (`live_state`). Stops have threads of their own
//! (`stopping`).

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
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use stopping::Stopping;
use viewer::PageViewer;

/// The most commands that wait for the network.
const COMMANDS_MAX: usize = 64;

/// Shows a person what went wrong, in a sentence.
pub type Tell = Box<dyn Fn(&str) + Send + Sync>;

/// Reads the text of a mission file, or says what is wrong with it.
pub type ReadMission = fn(&str) -> Result<Mission, String>;

/// A game on the network, shown to pages.
pub struct LiveView {
    shared: Arc<SharedState>,
}

/// What the threads and all viewers share.
struct SharedState {
    /// To be locked for moments only.
    state: Mutex<LiveState>,
    news: Changes,
    commands: InboxSender<Command>,
    stops: StopClient,
    stopping: Stopping,
    /// Where a person reads what went wrong.
    tell: Tell,
    read_mission: ReadMission,
    pages: AtomicU64,
    is_closing: AtomicBool,
}

/// A command to the game.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Command {
    /// For all of it, and nothing that stops boats.
    Control(Control),
    /// For steered boats; the set-points are in the state.
    Steer,
}

impl LiveView {
    /// Looks for a game at `place`, this one or the only one there is, for as long as the view is kept. `tell` gets what is missing
    /// meanwhile, whenever that changes, and what the sim refuses; `read_mission` reads mission files that operators send.
    ///
    /// # Errors
    /// If the system has no thread to give.
    pub fn open(
        place: Place,
        game: Option<GameName>,
        tell: Tell,
        read_mission: ReadMission,
    ) -> std::io::Result<LiveView> {
        let (commands, to_do) = inbox(COMMANDS_MAX);
        let shared = Arc::new(SharedState::new(commands, tell, read_mission)?);
        let watcher = GameWatcher { shared: Arc::clone(&shared), place, game, commands: to_do };
        start_thread("page-live", move || watcher.run())?;
        let late = Arc::clone(&shared);
        start_thread("page-late", move || stopping::tell_late(&late))?;
        Ok(LiveView { shared })
    }

    /// Whether the game that is shown has real boats.
    #[must_use]
    pub fn has_real_boats(&self) -> bool {
        self.shared.state.lock().on().is_ok_and(|game| game.has_real_boats())
    }
}

impl Drop for LiveView {
    fn drop(&mut self) {
        // The thread may wait for an answer; it ends by itself.
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
    /// With an empty state.
    fn new(commands: InboxSender<Command>, tell: Tell, read_mission: ReadMission) -> std::io::Result<SharedState> {
        Ok(SharedState {
            state: Mutex::default(),
            news: Changes::default(),
            commands,
            // Whoever looks at the page asks again.
            stops: StopClient::open(ANSWER)?,
            stopping: Stopping::default(),
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
