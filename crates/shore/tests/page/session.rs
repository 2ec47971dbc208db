//! The protocol between the server and a page, with any view.

use super::replay::show;
use super::source::seq_of;
use super::{empty_page, open_viewer, page, visit};
use shore::page::{Access, Budget, Changes, Mode, Outgoing, PageRequest, View, Viewer};
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};
use tungstenite::Message;

/// A view that sends continuously, ignores the budget, and passes requests on.
struct Talker(Sender<PageRequest>, Changes);

/// The viewer of `Talker`.
struct Ear(Sender<PageRequest>);

impl View for Talker {
    fn open_viewer(&self, _: Access) -> Box<dyn Viewer> {
        Box::new(Ear(self.0.clone()))
    }
    fn news(&self) -> &Changes {
        &self.1
    }
}

impl Viewer for Ear {
    fn mode(&self) -> Mode {
        Mode::Live
    }
    fn ask(&mut self, ask: &PageRequest, _: Instant) -> Result<(), String> {
        self.0.send(ask.clone()).map_err(|e| e.to_string())
    }
    fn next_message(&mut self, _: Instant, _: Budget) -> Option<Outgoing> {
        Some(Outgoing::Text("x".repeat(1 << 20)))
    }
    fn due(&self, _: Instant) -> Option<Instant> {
        None
    }
}

/// The numbers of frames sent to a page that draws nothing.
fn frames(messages: &[Message]) -> Vec<u64> {
    let bytes = messages.iter().filter_map(|message| match message {
        Message::Binary(bytes) if bytes.first() == Some(&1) => Some(bytes),
        _ => None,
    });
    bytes.map(|bytes| seq_of(bytes)).collect()
}

#[test]
fn a_page_that_draws_nothing_gets_two_frames() {
    let (_page, mut client) = visit(show());
    client.send(r#"{"do":"control","what":"resume"}"#);
    let messages: Vec<Message> = std::iter::from_fn(|| Some(client.next()))
        .take(20)
        .collect();
    assert_eq!(frames(&messages).len(), 2, "after seconds of playback");
    client.send(r#"{"do":"control","what":"pause"}"#);
    let paused = client.until("player", |player| player["playing"] == false);
    assert!(frames(&client.rest()).is_empty());
    client.ack();
    let newest = (paused["t_s"].as_f64().expect("a time") * 10.0 + 1e-6) as u64;
    assert_eq!(
        frames(&client.rest()),
        [newest],
        "the frames in between are skipped"
    );
}

#[test]
fn a_page_that_does_not_read_can_still_send() {
    let (asked, asks) = channel();
    let (_page, mut client) = visit(Arc::new(Talker(asked, Changes::default())));
    // The connection's buffers fill up after the page has read nothing for a while.
    assert!(asks.recv_timeout(Duration::from_secs(1)).is_err());
    for ask in [
        r#"{"do":"control","what":"halt"}"#,
        r#"{"do":"control","what":"e_stop"}"#,
    ] {
        client.send(ask);
        let want: PageRequest = serde_json::from_str(ask).expect("a valid request");
        assert_eq!(asks.recv_timeout(Duration::from_secs(10)), Ok(want));
    }
    // The message that was partly sent in the meantime arrives complete.
    (0..40).for_each(|_| assert_eq!(client.next(), Message::text("x".repeat(1 << 20))));
}

#[test]
fn another_show_begins_with_a_hello() {
    let (page, mut client) = visit(show());
    client.frame();
    page.show(show());
    client.until("hello", |_| true);
    assert_eq!(client.text()["kind"], "events");
    // One frame of the previous view is in flight.
    let rest = client.rest();
    assert_eq!(frames(&rest), [0]);
}

#[test]
fn a_page_opened_before_there_is_a_show_waits_for_it() {
    let page = empty_page(None, &[]);
    let mut client = open_viewer(&page);
    client.ack();
    assert_eq!(client.rest(), []);
    page.show(show());
    assert_eq!(client.text()["kind"], "hello");
}

#[test]
fn garbage_is_refused_and_survived() {
    let page = page(show(), None, &[]);
    let mut rude = open_viewer(&page);
    let mut polite = open_viewer(&page);
    for garbage in [
        Message::text("ahoy"),
        Message::text(r#"{"do":"fly"}"#),
        Message::text(r#"{"do":"seek","t_s":1e999}"#),
        Message::text("[".repeat(10_000)),
        Message::binary(vec![0; 100]),
    ] {
        rude.send_raw(garbage).expect("the server still listens");
        assert_eq!(rude.until("refused", |_| true)["what"], "message");
    }
    // A message that is too long ends only this page's session.
    drop(rude.send_raw(Message::text("x".repeat(17 * 1024))));
    assert!(rude.is_hung_up_on());
    polite.send(r#"{"do":"seek","t_s":5}"#);
    polite.until("player", |player| player["t_s"] == 5.0);
}
