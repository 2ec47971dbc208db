//! The radio link in a game: when orders are in force, message losses, and boats without orders.

mod common;

use common::{alone, order, started};
use messages::Order;
use primitives::{Ned, Pose, SimTime, VehicleId};
use scenario::boat::Drive;
use scenario::link::{Link, Loss};
use scenario::{Scenario, StartPosition};
use sim::Contest;

const BLUE: VehicleId = VehicleId(0);
const RED: VehicleId = VehicleId(1);

/// Losses in both the good and the bad state of a link.
const BURSTS: Loss = Loss {
    good: 0.1,
    bad: 0.8,
    good_time_s: 4.0,
    bad_time_s: 2.0,
};

fn link() -> Link {
    Link {
        delay_s: 0.0,
        jitter_s: 0.0,
        loss: Loss::default(),
        range_m: None,
        station: Ned::default(),
    }
}

/// One boat per side over this link, blue at x = 150 m, y = 200 m, pointing east.
fn over(link: Link) -> Scenario {
    let mut scenario = alone("surveyor_m1_8", "calm");
    scenario.rules.time_limit = SimTime::from_s(80_000.0);
    let psi_rad = std::f64::consts::FRAC_PI_2;
    scenario.vehicles[BLUE.index()].start_position = StartPosition::At(Pose {
        at: Ned::from_xy(150.0, 200.0),
        psi_rad,
    });
    scenario.link = Some(link);
    // The expiry of an order without a successor is tested elsewhere.
    scenario.order_ttl_s = 3_600.0;
    scenario
}

/// An order that encodes the decision at which it was given. At this speed boats barely move.
fn labelled(decision: u64) -> Order {
    Order::Steer {
        heading_rad: 0.0,
        speed_m_s: 1e-6 * decision as f64,
    }
}

/// Gives both boats the order of the open decision, and plays it.
fn play(contest: &mut Contest) {
    contest.pictures();
    for vehicle in [BLUE, RED] {
        order(contest, vehicle, labelled(contest.decision()));
    }
    contest.advance();
}

#[test]
fn an_order_is_in_force_once_the_delay_has_passed() {
    let mut contest = started(&over(Link {
        delay_s: 0.25,
        ..link()
    }));
    for k in 0..100_u64 {
        play(&mut contest);
        // The last tick of decision k begins at (k + 1/2) tenths of a second, just as order k - 2
        // arrives.
        let want = k.checked_sub(2).map_or(Order::Hold, labelled);
        assert_eq!(contest.order_in_force(BLUE), want, "decision {k}");
    }
}

#[test]
fn every_order_of_the_longest_delay_and_a_short_decision_arrives() {
    let mut scenario = over(Link {
        delay_s: 10.0,
        ..link()
    });
    (scenario.tick, scenario.ticks_per_decision) = (SimTime(20_000_000), 1);
    let mut contest = started(&scenario);
    for k in 0..1_500_u64 {
        let now = contest.now();
        let reported = contest.pictures()[0].own[0].fix_ns;
        assert_eq!(
            reported,
            SimTime((now - SimTime::from_s(10.0)).0.max(0)),
            "decision {k}"
        );
        play(&mut contest);
        assert_eq!(
            contest.order_in_force(BLUE),
            k.checked_sub(500).map_or(Order::Hold, labelled),
            "decision {k}"
        );
    }
}

#[test]
fn orders_sent_beyond_the_range_do_not_arrive() {
    let station = Ned::from_xy(150.0, 200.0);
    let mut contest = started(&over(Link {
        range_m: Some(30.0),
        station,
        ..link()
    }));
    let mut inside = 0;
    let mut outside = 0;
    let mut want = Order::Hold;
    for k in 0..400_u32 {
        // A heading to the east, at a speed that encodes the decision at which the order was given.
        let heading_rad = std::f64::consts::FRAC_PI_2;
        let order = Order::Steer {
            heading_rad,
            speed_m_s: 2.0 + 1e-6 * f64::from(k),
        };
        if contest.world().state().boats[0].pose.at.distance(station) <= 30.0 {
            (want, inside) = (order, inside + 1);
        } else {
            outside += 1;
        }
        common::order(&mut contest, BLUE, order);
        contest.advance();
        assert_eq!(contest.order_in_force(BLUE), want, "decision {k}");
    }
    assert!(inside > 100 && outside > 100, "{inside} {outside}");
}

#[test]
fn a_mind_that_is_silent_or_talks_much_changes_the_fate_of_no_other_message() {
    let link = Link {
        delay_s: 0.12,
        jitter_s: 0.1,
        loss: BURSTS,
        ..link()
    };
    let silence = 200..300;
    let loquacity = 600..700;
    // Arrivals by decision: orders in force, and the times at which the known reports were sent.
    let record = |says: &dyn Fn(u64) -> u32| {
        let mut contest = started(&over(link.clone()));
        let mut told = vec![];
        for k in 0..1_500 {
            let reported = [0, 1].map(|team| contest.pictures()[team].own[0].fix_ns);
            (0..says(k)).for_each(|_| order(&mut contest, BLUE, labelled(k)));
            order(&mut contest, RED, labelled(k));
            contest.advance();
            told.push((
                [BLUE, RED].map(|vehicle| contest.order_in_force(vehicle)),
                reported,
            ));
        }
        told
    };
    let plain = record(&|_| 1);
    let other = record(&|k| {
        if silence.contains(&k) {
            0
        } else {
            1 + 4 * u32::from(loquacity.contains(&k))
        }
    });
    let mut differ = 0;
    for (k, (plain, other)) in plain.iter().zip(&other).enumerate() {
        assert_eq!((plain.1, plain.0[1]), (other.1, other.0[1]), "decision {k}");
        // Until the first order after the silence arrives, the last one before the silence is in
        // force.
        let is_of_silence = |order: &Order| silence.clone().any(|k| labelled(k) == *order);
        if is_of_silence(&plain.0[0]) {
            differ += 1;
        } else {
            assert_eq!(plain.0[0], other.0[0], "decision {k}");
        }
    }
    assert!(differ > 50, "{differ}");
}

#[test]
fn holding_stops_what_is_under_way() {
    type Stop = fn(&mut Contest);
    let ways: [(&str, Stop); 3] = [
        ("hold", |contest| contest.hold(BLUE)),
        ("lose", |contest| contest.lose_agent(BLUE)),
        ("regain", |contest| {
            contest.lose_agent(BLUE);
            // An order without effect: its agent is lost.
            order(contest, BLUE, labelled(77));
            contest.regain_agent(BLUE);
        }),
    ];
    for (name, stop) in ways {
        let mut contest = started(&over(Link {
            delay_s: 1.0,
            ..link()
        }));
        (0..30).for_each(|_| play(&mut contest));
        assert_ne!(contest.order_in_force(BLUE), Order::Hold);
        stop(&mut contest);
        for _ in 0..20 {
            contest.advance();
            assert_eq!(contest.order_in_force(BLUE), Order::Hold, "{name}");
        }
        assert_eq!(
            contest.order_in_force(RED),
            labelled(29),
            "{name}: red's orders continue"
        );
        contest.regain_agent(BLUE);
        (0..20).for_each(|_| play(&mut contest));
        assert_ne!(
            contest.order_in_force(BLUE),
            Order::Hold,
            "{name}: the next order is in force"
        );
    }
}

#[test]
fn a_watchdog_stops_the_thrusters_when_the_link_is_silent_and_the_next_order_starts_them() {
    let loss = Loss {
        good: 0.0,
        bad: 1.0,
        good_time_s: 3.0,
        bad_time_s: 3.0,
    };
    let mut scenario = over(Link { loss, ..link() });
    for boat in &mut scenario.boats {
        let Drive::Thrusters { thruster, .. } = &mut boat.drive else {
            panic!("expected thrusters")
        };
        thruster.flaws.watchdog_s = Some(1.0);
    }
    let mut contest = started(&scenario);
    let thrust = |k: u32| Order::Thrust {
        port: 0.3 + 1e-6 * f64::from(k),
        starboard: 0.3,
    };
    let mut last = 0;
    let mut running = 0;
    let mut stopped = 0;
    let mut started_again = 0;
    let mut before_newton = 0.0;
    let mut least_newton = f64::INFINITY;
    for k in 0..1_000_u32 {
        order(&mut contest, BLUE, thrust(k));
        contest.advance();
        let got = contest.order_in_force(BLUE);
        if got == thrust(k) {
            started_again += u32::from(k - last > 10);
            last = k;
        }
        // The decision's last tick starts half a decision after its order arrives or should have
        // arrived.
        let is_silent = k - last >= 10;
        assert_eq!(
            got,
            if is_silent { Order::Hold } else { thrust(last) },
            "decision {k}, heard at {last}"
        );
        running = if got == Order::Hold { 0 } else { running + 1 };
        let newton = contest.world().state().boats[0].port.newton;
        if k - last >= 15 {
            // The remainder after the thruster's lag.
            assert!(
                newton < 0.95 * before_newton || newton < 1e-3,
                "decision {k}: {newton} N after {before_newton} N"
            );
            least_newton = least_newton.min(newton);
            stopped += 1;
        } else if running > 10 {
            assert!(newton > 1.0, "decision {k}: {newton} N under an order");
        }
        before_newton = newton;
    }
    assert!(
        stopped > 50 && started_again > 5 && least_newton < 0.1,
        "{stopped} {started_again} {least_newton} N"
    );
}

#[test]
fn a_digest_tells_games_apart_that_differ_in_what_is_under_way() {
    let scenario = over(Link {
        delay_s: 1.0,
        ..link()
    });
    let digest = |order: Order| {
        let mut contest = started(&scenario);
        contest.pictures();
        common::order(&mut contest, BLUE, order);
        contest.advance();
        (contest.world().state().clone(), contest.digest())
    };
    let first = digest(labelled(1));
    let second = digest(labelled(2));
    assert_eq!(first.0, second.0, "the worlds are still equal");
    assert_ne!(first.1, second.1);
    assert_eq!(first, digest(labelled(1)));
}
