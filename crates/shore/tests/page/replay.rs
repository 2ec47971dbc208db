//! Replaying a recording on pages.

use super::source::{Rememberer, bytes_of_recording, recorded, recorded_in, seq_of, two_minutes};
use super::{open_viewer, page, visit};
use bus::clock;
use messages::Control;
use proptest::prelude::*;
use recording::Recording;
use serde_json::json;
use shore::page::replay::ReplayView;
use shore::page::{Access, Budget, Outgoing, PageRequest, View};
use std::sync::Arc;
use std::time::Duration;

pub(crate) fn show() -> Arc<dyn View> {
    Arc::new(ReplayView::new(
        None,
        two_minutes(),
        Some(Box::new(Rememberer)),
        None,
    ))
}

#[test]
fn a_replay_says_hello_tells_all_events_and_stands_at_the_beginning() {
    let (_page, mut client) = visit(show());
    let hello = client.text();
    assert_eq!(
        (&hello["kind"], &hello["protocol"]),
        (&json!("hello"), &json!(1))
    );
    assert_eq!(
        (&hello["mode"], &hello["game"]),
        (&json!("replay"), &json!("made_up"))
    );
    assert!(
        hello["definitions"]["Frame"]
            .as_str()
            .is_some_and(|text| text.contains("VehicleTruth"))
    );
    assert_eq!(hello["chart"]["vehicles"][0]["name"], "blue_one");
    let events = client.text();
    assert_eq!(
        (&events["kind"], &events["reset"]),
        (&json!("events"), &json!(true))
    );
    assert_eq!(events["events"].as_array().map(Vec::len), Some(2));
    let want = json!({"kind": "player", "playing": false, "t_s": 0.0, "speed": 1.0, "from_s": 0.0, "to_s": 120.0,
        "cut": true, "file": "made_up.mcap"});
    assert_eq!(client.text(), want);
    let first = client.frame();
    assert_eq!((first[0], seq_of(&first)), (1, 0));
    client.ack();
    assert_eq!(client.rest(), [], "the replay is paused");
}

#[test]
fn seeking_brings_the_past_and_the_moment() {
    let (_page, mut client) = visit(show());
    client.frame();
    client.ack();
    client.send(r#"{"do":"seek","t_s":100.04}"#);
    client.until("player", |playback| playback["t_s"] == 100.04);
    let past: Vec<Vec<u8>> = (0..120).map(|_| client.frame()).collect();
    assert!(past.iter().all(|frame| frame[0] == 2));
    assert_eq!((seq_of(&past[0]), seq_of(&past[119])), (400, 995));
    let moment = client.frame();
    assert_eq!((moment[0], seq_of(&moment)), (1, 1000));
    client.ack();
    for (ask, want) in [
        (r#"{"do":"step","by":1}"#, 1001),
        (r#"{"do":"control","what":"step"}"#, 1002),
        (r#"{"do":"step","by":-3}"#, 999),
        (r#"{"do":"step","by":999999}"#, 1200),
        (r#"{"do":"seek","t_s":-5}"#, 0),
    ] {
        client.send(ask);
        let shown = std::iter::from_fn(|| Some(client.frame()))
            .find(|frame| frame[0] == 1)
            .expect("a frame arrives");
        assert_eq!(seq_of(&shown), want, "{ask}");
        client.ack();
    }
}

#[test]
fn it_plays_as_fast_as_asked_and_to_the_end() {
    let (_page, mut client) = visit(show());
    client.send(r#"{"do":"speed","factor":50}"#);
    client.until("player", |playback| playback["speed"] == 50.0);
    client.send(r#"{"do":"seek","t_s":100}"#);
    client.send(r#"{"do":"control","what":"resume"}"#);
    client.until("player", |playback| playback["playing"] == true);
    client.until("player", |playback| {
        playback["playing"] == false && playback["t_s"] == 120.0
    });
    client.send(r#"{"do":"control","what":"resume"}"#);
    client.until("player", |playback| {
        playback["playing"] == true && playback["t_s"].as_f64().is_some_and(|t_s| t_s < 60.0)
    });
}

#[test]
fn each_page_has_a_player_of_its_own() {
    let page = page(show(), None, &[]);
    let mut one = open_viewer(&page);
    let mut other = open_viewer(&page);
    one.frame();
    one.ack();
    other.frame();
    other.ack();
    one.send(r#"{"do":"seek","t_s":3}"#);
    one.until("player", |playback| playback["t_s"] == 3.0);
    assert_eq!(other.rest(), []);
}

#[test]
fn a_selected_boat_tells_what_its_helm_thought_and_where_it_believed_to_be() {
    let (_page, mut client) = visit(show());
    client.send(r#"{"do":"seek","t_s":10}"#);
    client.send(r#"{"do":"select","vehicle":"red_one","functions":true}"#);
    let helm = client.until("helm", |helm| helm["report"]["mode"] == "sailing:100");
    assert_eq!(
        (&helm["vehicle"], &helm["computed"], &helm["agrees"]),
        (&json!("red_one"), &json!(true), &json!(true))
    );
    client.send(r#"{"do":"step","by":1}"#);
    let estimate = client.until("estimate", |estimate| estimate["at_s"] == 10.1);
    let want = json!({"kind": "estimate", "vehicle": "red_one", "x": 4.0, "y": 3.0, "heading_deg": 90.0,
        "speed_m_s": 1.5, "fix_age_s": 10.1, "at_s": 10.1});
    assert_eq!(estimate, want);
    client.send(r#"{"do":"select","vehicle":"whale"}"#);
    assert_eq!(client.is_refused("red_one")["what"], "select");
}

#[test]
fn the_modes_of_all_boats_are_told_where_they_are_wanted() {
    let (_page, mut client) = visit(show());
    client.send(r#"{"do":"seek","t_s":10}"#);
    client.send(r#"{"do":"modes","wanted":true}"#);
    let modes = client.until("modes", |modes| modes["modes"][0] == "sailing:100");
    assert_eq!(
        modes,
        json!({"kind": "modes", "at_s": 10.0, "modes": ["sailing:100", null]})
    );
    client.send(r#"{"do":"step","by":1}"#);
    client.until("modes", |modes| modes["modes"][0] == "sailing:101");
    client.send(r#"{"do":"modes","wanted":false}"#);
    client.send(r#"{"do":"step","by":1}"#);
    assert!(
        client
            .rest()
            .iter()
            .all(|said| !said.to_string().contains(r#""kind":"modes""#))
    );
}

#[test]
fn curves_are_of_the_whole_recording() {
    let (_page, mut client) = visit(show());
    client.send(r#"{"do":"curves"}"#);
    let score = client.until("curves", |_| true);
    assert_eq!(
        (&score["vehicle"], &score["boat"]),
        (&json!(null), &json!(null))
    );
    let times = score["t_s"].as_array().expect("times");
    assert_eq!((times.len(), &times[1200]), (1201, &json!(120.0)));
    assert_eq!(
        score["score"].as_array().map(Vec::len),
        Some(2),
        "one per team"
    );
    client.send(r#"{"do":"curves","vehicle":"blue_one"}"#);
    let curves = client.until("curves", |curves| curves["vehicle"] == "blue_one");
    let boat = curves["boat"].as_object().expect("a boat's curves");
    assert_eq!(boat.len(), 13);
    assert!(
        boat.values()
            .all(|curve| curve.as_array().map(Vec::len) == Some(1201))
    );
    // All boats are at rest at the datum.
    assert_eq!(
        (
            &boat["x_m"][7],
            &boat["course_deg"][7],
            &boat["port_newton"][7]
        ),
        (&json!(0.0), &json!(0.0), &json!(0.0))
    );
    let flag_m = curves["boat"]["flag_m"][7].as_f64().expect("a distance");
    assert!(
        (flag_m - primitives::math::length(140.0, 40.0)).abs() < 0.01,
        "{flag_m}"
    );
    client.send(r#"{"do":"curves","vehicle":"whale"}"#);
    assert_eq!(client.until("refused", |_| true)["what"], "curves");
}

#[test]
fn what_a_recording_cannot_do_is_refused() {
    let (_page, mut client) = visit(show());
    for (ask, what) in [
        (r#"{"do":"control","what":"e_stop"}"#, "control"),
        (
            r#"{"do":"drive","vehicle":"blue_one","course_deg":0,"speed_m_s":1}"#,
            "drive",
        ),
        (r#"{"do":"speed","factor":-1}"#, "speed"),
    ] {
        client.send(ask);
        assert_eq!(client.until("refused", |_| true)["what"], what, "{ask}");
    }
}

#[test]
fn a_frame_that_is_damaged_is_left_out_and_all_others_are_shown() {
    let mut bytes = bytes_of_recording(4);
    let frame = Recording::of(bytes.clone())
        .expect("a recording")
        .frame(1)
        .bytes;
    let place = bytes
        .windows(frame.len())
        .position(|window| window == frame)
        .expect("the recording contains the frame");
    // The encapsulation of a message identifies it as CDR.
    bytes[place] = 0xff;
    let recorded = recorded_in(bytes);
    assert_eq!((recorded.damaged.count, recorded.frame_times.len()), (1, 3));
    let (_page, mut client) = visit(Arc::new(ReplayView::new(None, recorded, None, None)));
    let shown = [0, 1, 2].map(|_| {
        let seq = seq_of(&client.frame());
        client.ack();
        client.send(r#"{"do":"step","by":1}"#);
        seq
    });
    assert_eq!(shown, [0, 2, 3]);
}

#[test]
fn a_recording_without_frames_is_shown_too() {
    let (_page, mut client) = visit(Arc::new(ReplayView::new(None, recorded(0), None, None)));
    for ask in [
        r#"{"do":"control","what":"resume"}"#,
        r#"{"do":"step","by":1}"#,
        r#"{"do":"seek","t_s":9}"#,
    ] {
        client.send(ask);
    }
    client.until("player", |playback| {
        playback["t_s"] == 0.0 && playback["to_s"] == 0.0
    });
}

fn any_ask() -> impl Strategy<Value = PageRequest> {
    let vehicle = prop::sample::select(vec!["blue_one", "red_two", "whale"]);
    prop_oneof![
        (vehicle, any::<bool>()).prop_map(|(name, functions)| PageRequest::Select {
            vehicle: Some(name.to_owned()),
            functions
        }),
        prop::sample::select(vec![
            Control::Pause,
            Control::Resume,
            Control::Step,
            Control::Stop
        ])
        .prop_map(|what| PageRequest::Control { what }),
        prop::option::of(any::<f64>()).prop_map(|factor| PageRequest::Speed { factor }),
        any::<i64>().prop_map(|by| PageRequest::Step { by }),
        (-2..3_i64).prop_map(|by| PageRequest::Step { by }),
        any::<f64>().prop_map(|t_s| PageRequest::Seek { t_s }),
        (0.0..130.0).prop_map(|t_s| PageRequest::Seek { t_s }),
    ]
}

fn any_room() -> impl Strategy<Value = Budget> {
    prop::sample::select(vec![Budget::None, Budget::Frames, Budget::All])
}

/// Whether this is a repeated message about the selected boat.
fn is_of_selected(said: &Outgoing) -> bool {
    let kinds = [r#"{"kind":"helm""#, r#"{"kind":"estimate""#];
    matches!(said, Outgoing::Text(text) if kinds.iter().any(|kind| text.starts_with(kind)))
}

#[test]
fn what_can_wait_waits_until_there_is_room() {
    let show = ReplayView::new(None, two_minutes(), None, None);
    let mut viewer = show.open_viewer(Access::Watch);
    let now = clock::now();
    while viewer.next_message(now, Budget::All).is_some() {}
    viewer
        .ask(
            &PageRequest::Select {
                vehicle: Some("red_one".to_owned()),
                functions: true,
            },
            now,
        )
        .expect("the boat exists");
    let said: Vec<Outgoing> =
        std::iter::from_fn(|| viewer.next_message(now, Budget::Frames)).collect();
    assert!(!said.iter().any(is_of_selected), "{said:?}");
    let estimate = viewer
        .next_message(now, Budget::All)
        .expect("an estimate is waiting");
    assert!(is_of_selected(&estimate), "{estimate:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn whatever_is_asked_frames_come_in_order_between_jumps(
        asks in prop::collection::vec((any_ask(), 0..2_000_u64, any_room()), 1..30),
    ) {
        let show = ReplayView::new(None, two_minutes(), None, None);
        let mut viewer = show.open_viewer(Access::Watch);
        let mut now = clock::now();
        for (ask, wait_ms, room) in asks {
            drop(viewer.ask(&ask, now));
            now += Duration::from_millis(wait_ms);
            let said: Vec<Outgoing> = std::iter::from_fn(|| viewer.next_message(now, room)).take(1000).collect();
            prop_assert!(said.len() < 1000, "the messages do not end after {ask:?}");
            let frames: Vec<u64> = said.iter().filter_map(|said| match said {
                Outgoing::Past(bytes) | Outgoing::Now(bytes) => Some(seq_of(bytes)),
                Outgoing::Text(_) => None,
            }).collect();
            prop_assert!(frames.is_sorted() && (room != Budget::None || frames.is_empty()), "{frames:?} after {ask:?}");
            prop_assert!(room == Budget::All || !said.iter().any(is_of_selected));
            prop_assert!(said.iter().filter(|said| matches!(said, Outgoing::Now(_))).count() <= 1);
            prop_assert!(viewer.due(now).is_none_or(|due| due > now));
        }
    }
}
