//! A game to look at while it is played, and to have a hand in.
//!
//! A thread looks for the game, meets it, and looks again when it is gone (`keeper`); another asks for what is not
//! published (`asker`). What both learn stands on a stage that all pages look at.

mod event_log;
mod frame_buffer;
mod game_watcher;
mod live_state;
mod query_thread;
mod steering;
mod viewer;

use super::show::{Guest, News, Show, Viewer};
use bus::Net;
use game::message::Control;
use game::topic::GameName;
use live_state::LiveState;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use viewer::PageViewer;

/// The most things to be sent that wait for the network.
const COMMANDS_MAX: usize = 64;

/// Where a game can be reached, or why that is not known: asked anew for every search, since the next may be elsewhere.
pub type Place = Box<dyn Fn() -> Result<Net, String> + Send>;

/// A game on the network, shown to pages.
pub struct LiveShow {
    shared: Arc<SharedState>,
}

/// What the threads and all who look share.
struct SharedState {
    stage: Mutex<LiveState>,
    news: News,
    commands: SyncSender<Command>,
    pages: AtomicU64,
    is_closing: AtomicBool,
}

/// Something for the game.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Command {
    /// For all of it.
    Control(Control),
    /// For boats that are steered: where to stands on the stage.
    Steer,
}

impl LiveShow {
    /// Looks for a game at `place`, this one or the only one there is, for as long as the show is kept. `tell` is told what
    /// is missing meanwhile, whenever that is news.
    ///
    /// # Errors
    /// If the system has no thread to give.
    pub fn open(place: Place, game: Option<GameName>, tell: Box<dyn Fn(&str) + Send>) -> std::io::Result<LiveShow> {
        let (commands, to_do) = sync_channel(COMMANDS_MAX);
        let shared = Arc::new(SharedState::new(commands));
        let keeper = game_watcher::GameWatcher::new(Arc::clone(&shared), place, game, to_do, tell);
        std::thread::Builder::new().name("page-live".to_owned()).spawn(move || keeper.keep())?;
        Ok(LiveShow { shared })
    }
}

impl Drop for LiveShow {
    fn drop(&mut self) {
        // The thread may wait for an answer; it ends by itself.
        self.shared.is_closing.store(true, Ordering::Relaxed);
    }
}

impl Show for LiveShow {
    fn admit(&self, guest: Guest) -> Box<dyn Viewer> {
        let page = self.shared.pages.fetch_add(1, Ordering::Relaxed);
        Box::new(PageViewer::new(Arc::clone(&self.shared), guest, page))
    }

    fn news(&self) -> &News {
        &self.shared.news
    }
}

impl SharedState {
    /// A shared with an empty stage.
    fn new(commands: SyncSender<Command>) -> SharedState {
        SharedState {
            stage: Mutex::default(),
            news: News::default(),
            commands,
            pages: AtomicU64::new(1),
            is_closing: AtomicBool::new(false),
        }
    }

    /// The stage: looked at and changed for moments only.
    fn stage(&self) -> MutexGuard<'_, LiveState> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_closing(&self) -> bool {
        self.is_closing.load(Ordering::Relaxed)
    }
}
