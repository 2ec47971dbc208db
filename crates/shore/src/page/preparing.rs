//! The view until a game is available: progress, or the reason for a failure.

use super::message::{Mode, PageMessage};
use super::request::PageRequest;
use super::view::{Access, Budget, Changes, Outgoing, View, Viewer};
use parking_lot::Mutex;
use std::sync::Arc;
use std::time::Instant;

/// A message in place of a game.
pub struct PreparingView {
    said: Arc<Mutex<Said>>,
    news: Changes,
}

#[derive(Clone, PartialEq)]
struct Said {
    text: String,
    failed: bool,
}

impl PreparingView {
    /// Shows progress.
    pub fn new(text: &str) -> PreparingView {
        PreparingView::of(text, false)
    }

    /// Shows why no game is available.
    pub fn failed(text: &str) -> PreparingView {
        PreparingView::of(text, true)
    }

    fn of(text: &str, failed: bool) -> PreparingView {
        PreparingView {
            said: Arc::new(Mutex::new(Said {
                text: text.to_owned(),
                failed,
            })),
            news: Changes::default(),
        }
    }

    /// Replaces the message.
    pub fn tell(&self, text: &str) {
        text.clone_into(&mut self.said.lock().text);
        self.news.send_replace(());
    }
}

impl View for PreparingView {
    fn open_viewer(&self, _: Access) -> Box<dyn Viewer> {
        Box::new(PreparingViewer {
            said: Arc::clone(&self.said),
            sent: None,
        })
    }

    fn news(&self) -> &Changes {
        &self.news
    }
}

/// The view of one waiting page.
struct PreparingViewer {
    said: Arc<Mutex<Said>>,
    sent: Option<Said>,
}

impl Viewer for PreparingViewer {
    fn mode(&self) -> Mode {
        Mode::Replay
    }

    fn ask(&mut self, _: &PageRequest, _: Instant) -> Result<(), String> {
        Err("there is no game yet".to_owned())
    }

    fn next_message(&mut self, _: Instant, _: Budget) -> Option<Outgoing> {
        let said = self.said.lock().clone();
        if self.sent.as_ref() == Some(&said) {
            return None;
        }
        let message = PageMessage::Preparing {
            text: &said.text,
            failed: said.failed,
        }
        .json();
        self.sent = Some(said);
        Some(Outgoing::Text(message))
    }

    fn due(&self, _: Instant) -> Option<Instant> {
        None
    }
}
