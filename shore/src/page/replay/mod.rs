//! A recording to look at: each page plays it for itself.

mod helm_thread;
mod player;
mod recorded;
mod source;
mod viewer;

pub use recorded::Recorded;
pub use source::{Helms, ReplaySource};

use super::chart::Chart;
use super::show::{Guest, News, Show, Viewer};
use helm_thread::HelmThread;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use viewer::PageViewer;

/// A recording, shown to pages.
pub struct ReplayShow {
    reel: Arc<Reel>,
    news: News,
}

/// What all who look at one recording share.
struct Reel {
    film: Arc<dyn ReplaySource>,
    chart: Chart,
    desk: HelmThread,
    readers: AtomicU64,
}

impl ReplayShow {
    /// Shows a recording. Without helms nobody can say what they thought.
    #[must_use]
    pub fn new(film: Arc<dyn ReplaySource>, helms: Option<Box<dyn Helms>>) -> ReplayShow {
        let news = News::default();
        let scenario = film.notice().scenario.clone();
        let chart = Chart::new(&scenario, film.water());
        let desk = HelmThread::open(scenario, helms, news.clone());
        ReplayShow { reel: Arc::new(Reel { film, chart, desk, readers: AtomicU64::new(0) }), news }
    }
}

impl Show for ReplayShow {
    fn admit(&self, guest: Guest) -> Box<dyn Viewer> {
        let reader = self.reel.readers.fetch_add(1, Ordering::Relaxed);
        Box::new(PageViewer::new(Arc::clone(&self.reel), guest, reader))
    }

    fn news(&self) -> &News {
        &self.news
    }
}
