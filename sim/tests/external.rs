//! Real boats in a game: reports, rules, collisions, loss and return.

mod common;

use common::{gap_m, order, started, written};
use messages::external::ExternalOrder;
use messages::picture::Nav;
use messages::{Message, Order};
use primitives::angle::{rad_from_compass_deg, wrap_pi};
use primitives::{FlagId, Ned, SimTime, VehicleId};
use rules::event::{EventCursor, TagCause};
use rules::{Event, TaggedBoat};
use scenario::Scenario;
use sim::{BadReport, Contest};

/// A real boat, and a simulated one of the opposing team.
const REAL: VehicleId = VehicleId(0);
const OTHER: VehicleId = VehicleId(1);

/// Blue one, a real boat at (50, 40), and red one at `red_at`; its flag is at (140, 40), blue's at
/// (20, 40).
fn game(red_at: &str, more: &str) -> Scenario {
    written(&format!(
        "base = \"../games/pav01_vs_pav01.toml\"\norder_ttl_s = 60\n{more}\n\
         [[vehicle]]\nname = \"blue_one\"\nteam = \"blue\"\nsource = \"external\"\n\
         [[vehicle]]\nname = \"red_one\"\nteam = \"red\"\n{red_at}\n"
    ))
}

fn nav(x: f64, y: f64, heading_deg: f64, speed_m_s: f64) -> Nav {
    let psi_rad = rad_from_compass_deg(heading_deg);
    Nav {
        north_m: y,
        east_m: x,
        psi_rad,
        surge_m_s: speed_m_s,
        ..Nav::default()
    }
}

fn report(contest: &mut Contest, nav: Nav) {
    contest
        .report(REAL, nav, contest.now(), true)
        .expect("the report is valid");
}

/// Drives the real boat along y = 40 from one place to another, with a report at every decision.
fn sail(contest: &mut Contest, from_x: f64, to_x: f64, speed_m_s: f64) {
    let decisions = ((to_x - from_x) / speed_m_s / 0.1).round() as u32;
    for i in 0..decisions {
        report(
            contest,
            nav(
                from_x + f64::from(i) * 0.1 * speed_m_s,
                40.0,
                90.0,
                speed_m_s,
            ),
        );
        contest.advance();
    }
}

fn advance(contest: &mut Contest, decisions: u32) {
    (0..decisions).for_each(|_| contest.advance());
}

fn events(contest: &Contest) -> Vec<Event> {
    contest.events().iter().map(|logged| logged.event).collect()
}

#[test]
fn a_real_boat_is_told_where_the_other_real_boats_are() {
    let mut contest = started(&game("source = \"external\"", ""));
    report(&mut contest, nav(62.0, 31.0, 90.0, 0.0));
    contest.advance();
    assert_eq!(contest.other_real_boats_m(OTHER), [31.0, 62.0]);
    let contest = started(&game("at = [150, 5]", ""));
    assert!(contest.other_real_boats_m(REAL).is_empty());
}

#[test]
fn a_real_boat_that_is_reported_at_the_flag_grabs_it() {
    let mut contest = started(&game("at = [150, 5]", ""));
    sail(&mut contest, 50.0, 135.0, 3.0);
    assert!(
        events(&contest).contains(&Event::Grabbed {
            vehicle: REAL,
            flag: FlagId(1)
        }),
        "{:?}",
        events(&contest)
    );
    assert_eq!(
        contest.frame(&mut EventCursor::default()).vehicles[0].carrying,
        1
    );
    assert!(!events(&contest).contains(&Event::NavLost(REAL)));
}

#[test]
fn a_real_boat_is_tagged_and_its_effective_command_is_what_the_rules_make_of_its_orders() {
    let steer = Order::Steer {
        heading_rad: 1.0,
        speed_m_s: 9.0,
    };
    let thrust = Order::Thrust {
        port: 1.0,
        starboard: -0.5,
    };
    let slow = |tagged_boat| {
        let mut scenario = game("", "");
        (
            scenario.rules.tagged_boat,
            scenario.rules.tagged_speed_factor,
        ) = (tagged_boat, 0.5);
        let mut contest = started(&scenario);
        order(&mut contest, REAL, steer);
        report(&mut contest, nav(50.0, 40.0, 90.0, 0.0));
        assert_eq!(
            contest.effective_command(REAL),
            Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 3.0
            },
            "limited to its top speed"
        );
        sail(&mut contest, 60.0, 103.0, 3.0);
        let tagged = Event::Tagged {
            vehicle: REAL,
            cause: TagCause::Opponent(OTHER),
        };
        assert!(events(&contest).contains(&tagged), "{:?}", events(&contest));
        contest
    };
    let mut contest = slow(TaggedBoat::DrivesItself);
    assert_eq!(
        contest.effective_command(REAL),
        Order::Steer {
            heading_rad: 1.0,
            speed_m_s: 1.5
        }
    );
    order(&mut contest, REAL, thrust);
    assert_eq!(
        contest.effective_command(REAL),
        Order::Thrust {
            port: 0.5,
            starboard: -0.25
        }
    );

    let mut contest = slow(TaggedBoat::IsDriven);
    let Order::Steer {
        heading_rad,
        speed_m_s,
    } = contest.effective_command(REAL)
    else {
        panic!("expected a steer order")
    };
    assert!(wrap_pi(heading_rad - rad_from_compass_deg(270.0)).abs() < 1e-9 && speed_m_s == 1.5);
    // The command to the boat is valid.
    let sent = messages::VehicleOrder::new(REAL, contest.effective_command(REAL));
    assert!(
        sent.order().expect("the kind is known").check().is_ok() && ExternalOrder::VERSION == 3
    );
    // A boat without an agent holds.
    contest.lose_agent(REAL);
    assert_eq!(contest.effective_command(REAL), Order::Hold);
}

#[test]
fn a_boat_holds_without_position_order_or_agent_and_while_people_stop_it() {
    let mut contest = started(&game("at = [150, 5]", ""));
    let hold = |contest: &Contest, want: bool| {
        let holds = [REAL, OTHER].map(|vehicle| contest.effective_command(vehicle) == Order::Hold);
        assert_eq!(holds, [want; 2]);
    };
    // The real boat has had no report, and the other no order.
    order(
        &mut contest,
        REAL,
        Order::Steer {
            heading_rad: 1.0,
            speed_m_s: 1.0,
        },
    );
    hold(&contest, true);
    report(&mut contest, nav(50.0, 40.0, 90.0, 0.0));
    order(
        &mut contest,
        OTHER,
        Order::Steer {
            heading_rad: 1.0,
            speed_m_s: 1.0,
        },
    );
    hold(&contest, false);
    for stop in [Contest::halt, Contest::e_stop] {
        stop(&mut contest, true);
        hold(&contest, true);
        stop(&mut contest, false);
        hold(&contest, false);
    }
    [REAL, OTHER]
        .into_iter()
        .for_each(|vehicle| contest.lose_agent(vehicle));
    hold(&contest, true);
}

#[test]
fn a_simulated_boat_that_bumps_into_a_real_one_is_stopped_and_the_real_one_is_not() {
    let scenario = game("at = [62, 40]\nheading_deg = 270", "");
    let mut contest = started(&scenario);
    let mut least_m = f64::INFINITY;
    for _ in 0..300 {
        report(&mut contest, nav(50.0, 40.0, 0.0, 0.0));
        order(
            &mut contest,
            OTHER,
            Order::Thrust {
                port: 1.0,
                starboard: 1.0,
            },
        );
        contest.advance();
        least_m = least_m.min(gap_m(contest.world(), &scenario, 0, 1));
    }
    let [real, other] = [0, 1].map(|i| contest.world().state().boats[i]);
    assert!(
        (-0.03..0.05).contains(&least_m),
        "hulls come as near as {least_m} m"
    );
    assert_eq!(
        (real.pose.at, real.nu.surge),
        (Ned::from_xy(50.0, 40.0), 0.0)
    );
    assert!(!other.quarantined && !real.quarantined);
}

#[test]
fn a_real_boat_pushes_a_simulated_one_out_of_its_way() {
    let scenario = game("at = [58, 40]\nheading_deg = 0", "");
    let mut contest = started(&scenario);
    sail(&mut contest, 50.0, 65.0, 1.5);
    let [real, other] = [0, 1].map(|i| contest.world().state().boats[i].pose.at);
    assert!(real.distance(Ned::from_xy(65.0, 40.0)) < 1e-9, "{real:?}");
    assert!(other.distance(Ned::from_xy(58.0, 40.0)) > 1.0, "{other:?}");
    assert!(gap_m(contest.world(), &scenario, 0, 1) > -0.05);
    // A real boat suddenly reported on top of a simulated one must not throw the latter far away.
    report(&mut contest, nav(other.east, other.north, 45.0, 0.0));
    advance(&mut contest, 10);
    let thrown_m = contest.world().state().boats[1].pose.at.distance(other);
    assert!(thrown_m < 3.0, "{thrown_m} m");
}

#[test]
fn between_reports_a_real_boat_goes_on_as_it_did_and_then_it_is_lost() {
    let mut contest = started(&game("", "link = { delay_s = 5 }"));
    advance(&mut contest, 3);
    assert_eq!(
        events(&contest),
        [Event::NavLost(REAL)],
        "lost before the first report"
    );
    assert!(!contest.has_position(REAL) && contest.has_position(OTHER));
    let start_position = contest.world().state().boats[0].pose;
    let unknown = *contest.pictures()[0]
        .own(REAL)
        .expect("the picture has the boat");
    assert_eq!(
        (unknown.nav.pose(), unknown.fix_ns),
        (start_position, SimTime::LONG_AGO),
        "at rest at its start position"
    );

    let u = 2.0;
    let r = 0.25;
    let fix = Nav {
        yaw_rate_rad_s: r,
        ..nav(50.0, 40.0, 0.0, u)
    };
    contest.advance();
    // A fix taken 0.1 s ago and delayed since then.
    let fix_at = contest.now() - SimTime::from_s(0.1);
    contest
        .report(REAL, fix, fix_at, true)
        .expect("the report is valid");
    // There is no simulated radio between the boat and its mind.
    order(
        &mut contest,
        REAL,
        Order::Thrust {
            port: 1.0,
            starboard: 1.0,
        },
    );
    for decisions in 0..30 {
        let since_s = (contest.now() - fix_at).as_s();
        let turn = primitives::math::sin_cos(r * since_s.min(1.0));
        let boat = contest.world().state().boats[0];
        let want = Ned::from_xy(50.0 + u / r * (1.0 - turn.1), 40.0 + u / r * turn.0);
        assert!(
            boat.pose.at.distance(want) < 1e-9,
            "after {since_s} s: {:?} is not {want:?}",
            boat.pose.at
        );
        assert!(since_s > 0.999 || boat.nu.surge == u);
        let own = *contest.pictures()[0]
            .own(REAL)
            .expect("the picture has the boat");
        assert_eq!(
            (own.nav, own.fix_ns),
            (fix, fix_at),
            "its own team knows the reported fix"
        );
        let seen = contest.pictures()[1].contacts[0];
        assert!(
            Ned {
                north: seen.north_m,
                east: seen.east_m
            }
            .distance(want)
                < 1e-9,
            "others see the extrapolated position"
        );
        let is_lost = since_s > 1.5;
        assert_eq!(
            contest.effective_command(REAL) == Order::Hold,
            is_lost,
            "after {since_s} s, {decisions} decisions"
        );
        contest.advance();
    }
    assert_eq!(
        contest.world().state().boats[0].nu,
        sim::hull::Planar::default(),
        "at rest where it was"
    );
    let lost = Event::NavLost(REAL);
    let back = Event::NavBack(REAL);
    assert_eq!(events(&contest), [lost, back, lost]);
    report(&mut contest, fix);
    contest.advance();
    assert_eq!(events(&contest), [lost, back, lost, back]);
    assert_eq!(
        contest.effective_command(REAL),
        Order::Thrust {
            port: 1.0,
            starboard: 1.0
        }
    );
}

#[test]
fn reports_that_cannot_be_relied_on_change_nothing_and_bad_ones_are_refused() {
    let mut contest = started(&game("", ""));
    report(&mut contest, nav(50.0, 40.0, 90.0, 1.0));
    contest.advance();
    let before = contest.digest();
    let now = contest.now();
    assert_eq!(
        contest.report(REAL, nav(90.0, 40.0, 0.0, 3.0), now, false),
        Ok(())
    );
    let bad = [
        Nav {
            east_m: f64::NAN,
            ..Nav::default()
        },
        nav(50.0, 40.0, 0.0, 1e9),
        nav(1e300, 0.0, 0.0, 0.0),
    ];
    for bad in bad {
        assert_eq!(
            contest.report(REAL, bad, now, true),
            Err(BadReport::BadNumber),
            "{bad:?}"
        );
    }
    assert_eq!(
        contest.report(OTHER, Nav::default(), now, true),
        Err(BadReport::Simulated)
    );
    assert_eq!(contest.digest(), before);
    // A fix in the future counts as at most one decision ahead.
    assert_eq!(
        contest.report(REAL, nav(50.0, 40.0, 0.0, 1.0), SimTime::NEVER, true),
        Ok(())
    );
    assert!(
        contest.world().state().boats[0]
            .pose
            .at
            .distance(Ned::from_xy(50.0, 39.9))
            < 1e-9
    );
    advance(&mut contest, 40);
    let quarantined = Event::Quarantined(REAL);
    assert!(!events(&contest).contains(&quarantined));
}

#[test]
fn a_real_boat_has_no_physics_and_no_sensors_of_ours() {
    let mut scenario = game("at = [62, 40]", "sea = \"../seas/gale.toml\"");
    scenario.rules.flag_keepout_m = 8.0;
    let mut contest = started(&scenario);
    order(
        &mut contest,
        REAL,
        Order::Thrust {
            port: 1.0,
            starboard: 1.0,
        },
    );
    // The boat is in the keep-out circle of its own flag.
    for _ in 0..50 {
        report(&mut contest, nav(22.0, 40.0, 30.0, 0.0));
        contest.advance();
    }
    let truth = contest.frame(&mut EventCursor::default()).vehicles[0];
    assert_eq!(
        (truth.nav.east_m, truth.nav.north_m),
        (22.0, 40.0),
        "neither set back nor driven by the wind"
    );
    let unknown = [
        truth.heave_m,
        truth.roll_rad,
        truth.pitch_rad,
        truth.port_newton,
        truth.starboard_newton,
    ];
    assert_eq!(unknown, [0.0; 5]);
    assert!(
        events(&contest).contains(&Event::EnteredKeepout(REAL)),
        "the referee noticed the entry"
    );
}
