//! A recording, shown to pages with separate playbacks.

mod curves;
mod playback;
mod query_thread;
mod recorded;
mod viewer;

pub use query_thread::Helms;
pub use recorded::Recorded;

use super::chart::chart;
use super::view::{Access, Changes, View, Viewer};
use curves::Plotter;
use query_thread::{QueryThread, Sources};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use viewer::PageViewer;

/// A recording, shown to pages.
pub struct ReplayView {
    shared: Arc<SharedReplay>,
    news: Changes,
}

/// The state shared by all viewers of a recording.
struct SharedReplay {
    source: Arc<Recorded>,
    chart: Value,
    /// The origin of the game.
    about: Option<String>,
    queries: QueryThread,
    viewers: AtomicU64,
}

impl ReplayView {
    /// Shows a recording. Without `helms` there are no helm reports.
    pub fn new(source: Arc<Recorded>, helms: Option<Box<dyn Helms>>) -> ReplayView {
        ReplayView::about(None, source, helms)
    }

    /// Shows a recording with a description of its origin.
    pub fn about(
        about: Option<String>,
        source: Arc<Recorded>,
        helms: Option<Box<dyn Helms>>,
    ) -> ReplayView {
        let news = Changes::default();
        let scenario = source.recording.scenario().clone();
        let mut chart = chart(&scenario, &source.recording.header().water);
        if let Some(chances) = &source.chances {
            chart["chances"] = chances.clone();
        }
        let plotter = Plotter::new(Arc::clone(&source.recording));
        let queries = QueryThread::open(
            Sources {
                scenario,
                helms,
                plotter,
            },
            news.clone(),
        );
        ReplayView {
            shared: Arc::new(SharedReplay {
                source,
                chart,
                about,
                queries,
                viewers: AtomicU64::new(0),
            }),
            news,
        }
    }
}

impl View for ReplayView {
    fn open_viewer(&self, access: Access) -> Box<dyn Viewer> {
        let viewer = self.shared.viewers.fetch_add(1, Ordering::Relaxed);
        Box::new(PageViewer::new(Arc::clone(&self.shared), access, viewer))
    }

    fn news(&self) -> &Changes {
        &self.news
    }
}
