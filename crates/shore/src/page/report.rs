//! A report on the page: its files, and its games, which pages can open.

use super::view::View;
use std::sync::{Arc, OnceLock};
use tokio::sync::watch;

/// A summary of many games: a tournament, a sweep or a training run.
pub trait Report: Send + Sync {
    /// The report's own file at a path such as `/report.json`, if any. May take some time.
    fn file(&self, path: &str) -> Option<Vec<u8>>;

    /// The view of a game. `name` may be any string; for an unknown game, the view gives the reason
    /// for its absence.
    fn game(&self, name: &str) -> Shown;
}

/// A report that may be set after the page has started.
pub(super) type LateReport = Arc<OnceLock<Arc<dyn Report>>>;

/// The view that one page shows, if any, and its later replacements. The channel closes when the
/// server stops.
#[derive(Clone)]
pub struct Shown {
    pub(super) receiver: watch::Receiver<Option<Arc<dyn View>>>,
    /// Keeps a report's game open while a page shows it.
    _kept: Option<Arc<Showing>>,
}

impl Shown {
    /// The default view for all pages.
    pub(super) fn to_all(receiver: watch::Receiver<Option<Arc<dyn View>>>) -> Shown {
        Shown {
            receiver,
            _kept: None,
        }
    }
}

/// The view for all pages that open one game. It can change.
pub struct Showing(watch::Sender<Option<Arc<dyn View>>>);

impl Showing {
    /// Starts with this view.
    pub fn new(first: Arc<dyn View>) -> Arc<Showing> {
        Arc::new(Showing(watch::Sender::new(Some(first))))
    }

    /// Shows a different view from now on.
    pub fn show(&self, next: Arc<dyn View>) {
        self.0.send_replace(Some(next));
    }

    /// A handle for one page.
    pub fn shown(self: &Arc<Showing>) -> Shown {
        Shown {
            receiver: self.0.subscribe(),
            _kept: Some(Arc::clone(self)),
        }
    }

    /// Whether any page shows this view.
    pub fn is_watched(&self) -> bool {
        self.0.receiver_count() > 0
    }
}
