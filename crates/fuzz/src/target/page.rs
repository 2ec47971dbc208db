//! Browser messages (JSON over WebSocket) to a page that shows a recording or a game. Each line is
//! a message: `~` starts a pong, `!` a binary message.

use super::{Target, mutations};
use crate::played::{self, played};
use bus::{Place, clock};
use recording::Recording;
use serde_json::Value;
use shore::page::live::LiveView;
use shore::page::replay::{Recorded, ReplayView};
use shore::page::{Access, Outgoing, PageRequest, PageSession, View};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

pub(super) const TARGET: Target = Target {
    name: "page",
    seeds,
    change: mutations,
    check,
    allocated_max: (16 << 20, 5000),
};

/// Maximum number of messages to a page at once: a minute of history in steps of half a second,
/// events, and new data.
const SENT_MAX: usize = 300;

static REPLAY: LazyLock<ReplayView> = LazyLock::new(|| {
    let recording = Recording::of(played(played::scenario("attack_1v1"), 30).recording(&[]))
        .expect("the recording is valid");
    replay_of(recording)
});

/// A view whose search for a game never succeeds.
static LIVE: LazyLock<LiveView> = LazyLock::new(|| {
    let nowhere = Place::new(|_| Err("no game found".to_owned()));
    LiveView::open(nowhere, None, Box::new(|_| ()), |_| Err(String::new())).expect("a thread")
});

fn seeds() -> Vec<Vec<u8>> {
    let cases = include_str!("../../../shore/src/page/request_cases.txt");
    let requests: Vec<&str> = cases
        .lines()
        .filter_map(|line| line.split_once(" is "))
        .map(|(text, _)| text)
        .collect();
    let more = [
        r#"{"do":"select","vehicle":"blue_one","functions":true}"#,
        r#"{"do":"seek","t_s":1.5}"#,
        r#"{"do":"control","what":"resume"}"#,
        r#"{"do":"control","what":{"speed":4}}"#,
        r#"{"do":"ack"}"#,
        "~1",
        "!",
        r#"{"do":"step","by":2}"#,
    ];
    vec![
        requests.join("\n").into_bytes(),
        more.join("\n").into_bytes(),
        [more, more].concat().join("\n").into_bytes(),
    ]
}

fn check(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    for access in [Access::Watch, Access::Control, Access::Operate] {
        talk(
            PageSession::new(REPLAY.open_viewer(access), access),
            &text,
            |_, _| (),
        );
    }
    let access = Access::Watch;
    talk(
        PageSession::new(LIVE.open_viewer(access), access),
        &text,
        |line, said| {
            // A viewer without control rights cannot change anything.
            let acts = serde_json::from_str::<PageRequest>(line)
                .is_ok_and(|ask| ask.needs() > Access::Watch);
            let refused = |text: &String| {
                text.starts_with(r#"{"kind":"refused""#) && text.contains("may only watch")
            };
            assert!(
                !acts || said.iter().any(refused),
                "the reply to {line} was {said:?}"
            );
        },
    );
}

fn replay_of(recording: Recording) -> ReplayView {
    ReplayView::new(
        None,
        Arc::new(Recorded::new(Arc::new(recording), "fuzz.mcap".to_owned())),
        None,
        None,
    )
}

/// Shows a recording to a page and navigates in it.
pub(super) fn look_around(recording: Recording) {
    let view = replay_of(recording);
    let access = Access::Watch;
    let seed = String::from_utf8(seeds().swap_remove(1)).expect("a text");
    talk(
        PageSession::new(view.open_viewer(access), access),
        &seed,
        |_, _| (),
    );
}

/// Sends lines to a session. Every reply has a kind, the number of replies is limited, and at most
/// two frames are in flight.
fn talk(mut session: PageSession, lines: &str, answered: impl Fn(&str, &[String])) {
    let mut now = clock::now();
    let mut under_way = 0_usize;
    for line in lines.lines() {
        now += Duration::from_millis(10 * (line.len() as u64 % 50));
        match (line.strip_prefix('~'), line.starts_with('!')) {
            (Some(ping), _) => session.receive_pong(ping.parse().unwrap_or(u64::MAX)),
            (None, true) => session.receive_binary(),
            (None, false) => session.receive(line, now),
        }
        if serde_json::from_str::<PageRequest>(line).is_ok_and(|ask| ask == PageRequest::Ack) {
            under_way = under_way.saturating_sub(1);
        }
        answered(line, &said(&mut session, now, &mut under_way));
    }
}

/// The session's pending messages.
fn said(session: &mut PageSession, now: Instant, under_way: &mut usize) -> Vec<String> {
    let mut texts = Vec::new();
    for _ in 0..SENT_MAX {
        match session.next_message(now) {
            None => return texts,
            Some(Outgoing::Text(text)) => {
                let value: Value =
                    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text:.300}"));
                assert!(value["kind"].is_string(), "{text:.300}");
                texts.push(text);
            }
            Some(Outgoing::Past(_)) => {}
            Some(Outgoing::Now(_)) => *under_way += 1,
        }
        assert!(*under_way <= 2, "{under_way} frames in flight");
        // A browser answers immediately.
        if let Some(ping) = session.ping() {
            session.receive_pong(ping);
        }
    }
    panic!("more than {SENT_MAX} messages at once");
}
