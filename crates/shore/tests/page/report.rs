//! A report and its games.

use super::client::{Client, get};
use super::empty_page;
use super::replay::show;
use shore::page::{PreparingView, Report, Showing, Shown};
use std::sync::Arc;

/// A report with one game, which takes time to prepare.
struct OneGame {
    preparing: Arc<PreparingView>,
    showing: Arc<Showing>,
}

impl Report for OneGame {
    fn file(&self, path: &str) -> Option<Vec<u8>> {
        (path == "/report.json").then(|| b"{\"kind\":\"x\"}".to_vec())
    }

    fn game(&self, name: &str) -> Shown {
        match name {
            "a b&c" => self.showing.shown(),
            other => Showing::new(Arc::new(PreparingView::failed(&format!(
                "there is no game {other:?}"
            ))))
            .shown(),
        }
    }
}

#[test]
fn a_report_has_files_and_a_game_is_told_of_until_it_is_there() {
    let preparing = Arc::new(PreparingView::new("in a moment"));
    let report = Arc::new(OneGame {
        showing: Showing::new(Arc::clone(&preparing) as _),
        preparing,
    });
    let page = empty_page(None, &[]);
    page.publish(Arc::clone(&report) as _);
    let at = page.address;
    let host = page.address.to_string();
    for (path, status, part) in [
        ("/", 307, "location: /report.html"),
        ("/?game=1", 200, "layer-boats"),
        ("/report.json", 200, "{\"kind\":\"x\"}"),
        ("/report.html", 200, "report.js"),
        ("/other.json", 404, "No such file"),
    ] {
        let (got, answer) = get(at, path, &host);
        assert!(
            got == status && answer.contains(part),
            "{path}: {got} {answer}"
        );
        assert!(
            answer
                .to_lowercase()
                .contains("content-security-policy: default-src 'self'"),
            "{path}: {answer}"
        );
    }
    assert!(!report.showing.is_watched());
    let mut client = Client::connect(at, "/ws?game=a%20b%26c", &[]).expect("everyone may watch");
    let told = client.until("preparing", |told| told["text"] == "in a moment");
    assert_eq!(told["failed"], false);
    // A request before the game is available is harmless.
    client.send(r#"{"do":"seek","t_s":3}"#);
    client.until("refused", |told| told["reason"] == "there is no game yet");
    report.preparing.tell("half of it");
    client.until("preparing", |told| told["text"] == "half of it");
    assert!(report.showing.is_watched());
    report.showing.show(show());
    assert_eq!(client.until("hello", |_| true)["mode"], "replay");
    let mut other = Client::connect(at, "/ws?game=%3Cb%3E", &[]).expect("everyone may watch");
    let told = other.until("preparing", |_| true);
    assert_eq!(
        (&told["text"], &told["failed"]),
        (&"there is no game \"<b>\"".into(), &true.into())
    );
    // The connection stays open: otherwise a page that reconnects to retry would do so forever.
    other.send(r#"{"do":"seek","t_s":3}"#);
    other.until("refused", |_| true);
}
