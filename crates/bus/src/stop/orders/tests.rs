//! Stops that are repeated, shown, doubted and reported as late.

use super::*;
use crate::clock;

const MS: fn(u64) -> Duration = Duration::from_millis;

/// When a stop is sent within the first 3 s, ms; each report arrives at its time.
fn said(orders: &mut StopOrders, start: Instant, reports: &[(u64, &str, Source)]) -> Vec<u64> {
    let mut said = Vec::new();
    for ms in 0..3000 {
        for (_, state, source) in reports.iter().filter(|(at, ..)| *at == ms) {
            orders.report(start + MS(ms), "blue_one", state, *source);
        }
        said.extend(orders.due(start + MS(ms)).iter().map(|_| ms));
    }
    said
}

fn orders(boats: &[&str]) -> (StopOrders, Instant) {
    let mut orders = StopOrders::new(Duration::MAX);
    boats.iter().for_each(|boat| orders.expect(boat));
    orders.complete();
    (orders, clock::now())
}

#[test]
fn a_stop_is_said_again_until_the_boat_answers_and_told_once() {
    let (mut orders, start) = orders(&["blue_one"]);
    let number = orders.ask(start, Some("blue_one".to_owned()), StopCommand::EStop);
    let stopped = "e-stopped (by an E-stop of this boat)";
    let times = said(
        &mut orders,
        start,
        &[
            (50, "armed", Source::Answer(number)),
            (90, stopped, Source::Answer(number)),
        ],
    );
    assert_eq!(times, [0, 10, 20, 40, 80]);
    let done: Vec<StopNews> = orders
        .take_news()
        .into_iter()
        .filter(|news| matches!(news, StopNews::Done { .. }))
        .collect();
    let vehicle = "blue_one".to_owned();
    let state = stopped.to_owned();
    assert_eq!(
        done,
        [StopNews::Done {
            vehicle,
            command: StopCommand::EStop,
            state,
            after: MS(90)
        }]
    );
    assert!(orders.unfinished().is_empty());
}

#[test]
fn what_was_published_may_be_older_than_the_stop() {
    let (mut orders, start) = orders(&["blue_one"]);
    orders.ask(start, Some("blue_one".to_owned()), StopCommand::Disarm);
    let published = Source::Published(start + MS(1));
    let times = said(
        &mut orders,
        start,
        &[(5, "disarmed", published), (30, "armed", published)],
    );
    assert_eq!(times.len(), 6 + 14, "{times:?}");
    assert_eq!(
        orders.unfinished(),
        ["blue_one does not report that it has stopped: armed"]
    );
    orders.ask(start, Some("blue_one".to_owned()), StopCommand::Disarm);
    let times = said(
        &mut orders,
        start,
        &[(5, "disarmed", Source::Published(start + MS(1)))],
    );
    assert_eq!(times, [0, 10, 20, 40, 80, 160, 360, 560, 760, 960]);
    assert!(orders.unfinished().is_empty());
}

#[test]
fn a_status_that_a_lost_packet_held_up_shows_no_later_stop() {
    let (mut orders, start) = orders(&["blue_one"]);
    // A one-way trip takes 50 ms; the gateway started 10 s ago.
    let as_of =
        |orders: &mut StopOrders, came: u64, at_s| orders.as_of(start + MS(came), "blue_one", at_s);
    assert_eq!(as_of(&mut orders, 10_050, 10.0), start + MS(10_050));
    let held_up = as_of(&mut orders, 10_800, 10.5);
    assert!(held_up < start + MS(10_551), "as if it had come in time");
    let asked = start + MS(10_600);
    orders.ask(asked, Some("blue_one".to_owned()), StopCommand::EStop);
    orders.report(
        start + MS(10_700),
        "blue_one",
        "armed",
        Source::Published(asked),
    );
    orders.report(
        start + MS(10_800),
        "blue_one",
        "e-stopped",
        Source::Published(held_up),
    );
    assert_eq!(orders.unfinished().len(), 1, "it is of an earlier stop");
    let now = as_of(&mut orders, 10_720, 10.67);
    orders.report(
        start + MS(10_720),
        "blue_one",
        "e-stopped",
        Source::Published(now),
    );
    assert!(orders.unfinished().is_empty());
    // A restarted gateway starts counting again.
    assert_eq!(as_of(&mut orders, 60_000, 1.0), start + MS(60_000));
}

#[test]
fn what_is_told_again_counts_only_for_a_boat_that_is_not_heard_itself() {
    let (mut orders, start) = orders(&["blue_one"]);
    orders.ask(start, Some("blue_one".to_owned()), StopCommand::Disarm);
    // The sim received this state before the stop was requested.
    orders.report(
        start + MS(40),
        "blue_one",
        "disarmed",
        Source::Relayed(start),
    );
    assert_eq!(
        orders.unfinished(),
        ["blue_one does not report that it has stopped: disarmed"]
    );
    orders.report(
        start + MS(50),
        "blue_one",
        "disarmed",
        Source::Relayed(start + MS(1)),
    );
    assert!(orders.is_done(start + MS(50)));
    let state = |orders: &StopOrders| {
        orders
            .boats()
            .next()
            .and_then(|(_, boat)| boat.state.clone())
    };
    orders.report(
        start + MS(100),
        "blue_one",
        "armed",
        Source::Published(start + MS(100)),
    );
    for (at, want) in [(900, "armed"), (1200, "disarmed")] {
        orders.report(
            start + MS(at),
            "blue_one",
            "disarmed",
            Source::Relayed(start + MS(at)),
        );
        assert_eq!(state(&orders).as_deref(), Some(want), "{at} ms");
    }
}

#[test]
fn a_boat_that_says_nothing_is_told_and_stopped_until_something_else_is_asked_of_it() {
    let (mut orders, start) = orders(&["blue_one", "red_one"]);
    let number = orders.ask(start, None, StopCommand::EStop);
    let stopped = (3, "e-stopped", Source::Answer(number));
    assert_eq!(said(&mut orders, start, &[stopped]).len(), 6 + 14);
    let later = orders.due(start + MS(3200));
    assert!(
        !later[0].to_everybody && later[0].boats == ["red_one"],
        "{later:?}"
    );
    let late = StopNews::Late {
        vehicle: "red_one".to_owned(),
        command: StopCommand::EStop,
    };
    assert!(orders.take_news().contains(&late));
    assert_eq!(orders.unfinished(), ["no report from red_one"]);
    orders.cancel(Some("red_one"));
    assert!(orders.due(start + MS(9000)).is_empty());
    assert_eq!(orders.unfinished().len(), 1, "it was not done");
}

#[test]
fn a_game_without_real_boats_is_stopped_when_its_sim_says_so() {
    let (mut orders, start) = orders(&[]);
    let number = orders.ask(start, None, StopCommand::EStop);
    assert_eq!(orders.due(start).len(), 1);
    assert_eq!(orders.unfinished(), ["the sim does not respond"]);
    orders.sim_answered(start + MS(20), number, Ok(()));
    assert!(orders.unfinished().is_empty());
    assert_eq!(orders.take_news(), [StopNews::Sim(Ok(MS(20)))]);
}
