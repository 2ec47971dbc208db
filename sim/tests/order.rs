//! Orders in a contest: how long they are in force, and that a recording contains everything that
//! determines this.

mod common;

use common::{alone, order, started};
use messages::input::{Input, InputRecord, Inputs};
use messages::{Message, Order, Stamp};
use primitives::{Ned, SimTime, VehicleId};
use scenario::Scenario;
use scenario::boat::Hold;
use scenario::link::{Link, Loss};
use sim::Contest;

const BLUE: VehicleId = VehicleId(0);
const EAST: Order = Order::Steer {
    heading_rad: std::f64::consts::FRAC_PI_2,
    speed_m_s: 2.0,
};

/// One boat per side; orders expire after a second.
fn game() -> Scenario {
    Scenario {
        order_ttl_s: 1.0,
        ..alone("surveyor_m1_8", "calm")
    }
}

/// Whether the boat follows an order in each of the next `decisions` decisions, starting with the
/// open one.
fn follows(contest: &mut Contest, decisions: u32) -> Vec<bool> {
    let decision = |_| {
        contest.advance();
        contest.order_in_force(BLUE) != Order::Hold
    };
    (0..decisions).map(decision).collect()
}

#[test]
fn an_order_expires_with_the_age_of_its_picture() {
    for (given_s, decisions) in [
        (3.0, 11),
        (2.9, 10),
        (2.1, 2),
        (2.0, 1),
        (1.9, 0),
        (7.0, 11),
    ] {
        let mut contest = started(&game());
        (0..30).for_each(|_| contest.advance());
        contest
            .order(BLUE, EAST, SimTime::from_s(given_s))
            .expect("the order is valid");
        let want: Vec<bool> = (0..20).map(|i| i < decisions).collect();
        assert_eq!(
            follows(&mut contest, 20),
            want,
            "given at {given_s} s, at 3 s"
        );
        order(&mut contest, BLUE, EAST);
        assert!(follows(&mut contest, 1)[0], "the next order is in force");
    }
}

#[test]
fn an_order_that_expires_under_way_does_not_arrive() {
    let loss = Loss::default();
    let link = Link {
        delay_s: 0.5,
        jitter_s: 0.0,
        loss,
        range_m: None,
        station: Ned::default(),
    };
    let mut contest = started(&Scenario {
        link: Some(link),
        ..game()
    });
    (0..30).for_each(|_| contest.advance());
    contest
        .order(BLUE, EAST, SimTime::from_s(2.3))
        .expect("the order is valid");
    assert_eq!(follows(&mut contest, 20), [false; 20]);
    order(&mut contest, BLUE, EAST);
    let want: Vec<bool> = (0..20).map(|i| (5..11).contains(&i)).collect();
    assert_eq!(
        follows(&mut contest, 20),
        want,
        "in transit for half a second, and in force for as long"
    );
}

#[test]
fn a_game_with_silent_agents_is_played_again_from_its_recording() {
    let play = |contest: &mut Contest| {
        for decision in 0..100_u32 {
            contest.pictures();
            if decision % 30 < 10 {
                let late = SimTime::from_s(0.1 * f64::from((decision + 1) % 3));
                contest
                    .order(BLUE, EAST, contest.now() - late)
                    .expect("the order is valid");
            }
            contest.advance();
        }
    };
    let mut contest = started(&game());
    contest.keep_inputs();
    play(&mut contest);
    let inputs = contest.take_inputs();
    let ordered = inputs
        .iter()
        .filter(|input| matches!(input, Input::Ordered { .. }))
        .count();
    assert_eq!(
        (inputs.len(), ordered),
        (2 * 100 + 40, 40),
        "silence adds nothing to a recording"
    );
    let stamp = Stamp {
        version: Inputs::VERSION,
        ..Stamp::default()
    };
    let recorded = Inputs {
        stamp,
        inputs: inputs.into_iter().map(InputRecord::from).collect(),
    };
    let again = |recorded: &Inputs| {
        let mut contest = started(&game());
        recorded
            .of(&game())
            .for_each(|input| contest.give(input.expect("an input of this game")));
        contest
    };
    assert!(again(&recorded).snapshot() == contest.snapshot());

    // Before orders carried a time, they were in force from arrival until the next order or a
    // recorded hold.
    let old = Inputs {
        stamp: Stamp {
            version: 1,
            ..stamp
        },
        ..recorded
    };
    let old = Inputs {
        inputs: old
            .inputs
            .into_iter()
            .map(|record| InputRecord {
                at_ns: SimTime::ZERO,
                ..record
            })
            .collect(),
        ..old
    };
    let old = again(&old);
    assert!(
        old.world().state().boats[0].pose.at.east > contest.world().state().boats[0].pose.at.east,
        "a late order was in force for longer"
    );
}

#[test]
fn a_boat_that_keeps_its_station_stays_where_it_began_to_hold_until_people_stop_it() {
    let drift_m = |hold: Hold, e_stopped: bool| {
        let mut scenario = alone("surveyor_m1_8", "gale");
        scenario.boats.iter_mut().for_each(|boat| boat.hold = hold);
        let mut contest = started(&scenario);
        contest.e_stop(e_stopped);
        let start = contest.world().state().boats[0].pose.at;
        (0..1200).for_each(|_| contest.advance());
        contest.world().state().boats[0].pose.at.distance(start)
    };
    assert!(
        drift_m(Hold::Drifts, false) > 30.0,
        "a gale drifts a boat without thrust"
    );
    let kept_m = drift_m(Hold::KeepsStation, false);
    assert!(kept_m < 8.0, "{kept_m} m from its station");
    assert!(
        drift_m(Hold::KeepsStation, true) > 30.0,
        "a stopped boat does not keep its station"
    );
}
