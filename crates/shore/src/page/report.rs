//! A report on the page: its files, and the games behind it, each of which pages can ask for.

use super::view::View;
use std::sync::{Arc, OnceLock};
use tokio::sync::watch;

/// Something that was counted up from many games: of a tournament, a sweep, a training.
pub trait Report: Send + Sync {
    /// The path of its page.
    fn page(&self) -> &'static str;

    /// The report's own file at this path of the page's address, such as `/report.json`, if it has one there. It may take its time.
    fn file(&self, path: &str) -> Option<Vec<u8>>;

    /// What is shown of the game of this name, which may be any text: the game, or why there is none.
    fn game(&self, name: &str) -> Shown;
}

/// A report that a page may get after it has begun.
pub(super) type LateReport = Arc<OnceLock<Arc<dyn Report>>>;

/// What one page is shown now, if anything is yet. Its end is that of the server.
#[derive(Clone)]
pub struct Shown {
    pub(super) receiver: watch::Receiver<Option<Arc<dyn View>>>,
    /// What a page is shown of a report does not end while it looks.
    _kept: Option<Arc<Showing>>,
}

impl Shown {
    /// What all pages are shown that ask for nothing of their own.
    pub(super) fn to_all(receiver: watch::Receiver<Option<Arc<dyn View>>>) -> Shown {
        Shown { receiver, _kept: None }
    }
}

/// What all pages are shown that ask for one game: one view after another.
pub struct Showing(watch::Sender<Option<Arc<dyn View>>>);

impl Showing {
    /// Shows this first.
    #[must_use]
    pub fn new(first: Arc<dyn View>) -> Arc<Showing> {
        Arc::new(Showing(watch::Sender::new(Some(first))))
    }

    /// From now on pages are shown this.
    pub fn show(&self, next: Arc<dyn View>) {
        self.0.send_replace(Some(next));
    }

    /// For one page.
    #[must_use]
    pub fn shown(self: &Arc<Showing>) -> Shown {
        Shown { receiver: self.0.subscribe(), _kept: Some(Arc::clone(self)) }
    }

    /// Whether any page looks.
    #[must_use]
    pub fn is_watched(&self) -> bool {
        self.0.receiver_count() > 0
    }
}
