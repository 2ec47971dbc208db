//! The point boat compared with reference trajectories and published numbers.

mod common;

use messages::Order;
use primitives::Ned;
use scenario::boat::Kinematic;
use sim::kinematic::{KinematicModel, KinematicState};

const DT_S: f64 = 0.1;
/// Duration of the run-up before a manoeuvre, s.
const RUN_UP_S: f64 = 60.0;

/// The shipped point boat with this name, from Pyquaticus (main, 2025-11).
fn shipped(name: &str) -> Kinematic {
    let boat = common::boat(&format!("{name}_kinematic"));
    let scenario::boat::Drive::Kinematic(kinematic) = boat.drive else {
        panic!("{name} is not a point boat")
    };
    kinematic
}

/// A boat afloat.
struct Afloat {
    model: KinematicModel,
    state: KinematicState,
    at: Ned,
    /// Yaw rate in the last step.
    rate_deg_s: f64,
}

/// Position and state at a time since the start of the manoeuvre.
struct Row {
    t_s: f64,
    at: Ned,
    state: KinematicState,
}

impl Afloat {
    fn new(boat: &Kinematic) -> Afloat {
        let model = KinematicModel::new(boat);
        let state = KinematicState::default();
        Afloat {
            model,
            state,
            at: Ned::default(),
            rate_deg_s: 0.0,
        }
    }

    /// A boat after its run-up northward, moved back to the origin.
    fn under_way(boat: &Kinematic, speed_m_s: f64) -> Afloat {
        let mut afloat = Afloat::new(boat);
        afloat.sail(RUN_UP_S, |_| north(speed_m_s));
        afloat.at = Ned::default();
        afloat
    }

    fn step(&mut self, command: Order) {
        let motion = self
            .model
            .step(&mut self.state, command, Ned::default(), DT_S);
        self.at = self.at + motion.travel_m;
        self.rate_deg_s = motion.turn_rad.to_degrees() / DT_S;
    }

    fn sail(&mut self, seconds: f64, command: impl Fn(&KinematicState) -> Order) -> Vec<Row> {
        let ticks = 1..=(seconds / DT_S).round() as u32;
        let row = |tick: u32| {
            self.step(command(&self.state));
            Row {
                t_s: f64::from(tick) * DT_S,
                at: self.at,
                state: self.state,
            }
        };
        ticks.map(row).collect()
    }
}

fn steer(heading_deg: f64, speed_m_s: f64) -> Order {
    Order::Steer {
        heading_rad: heading_deg.to_radians(),
        speed_m_s,
    }
}

/// Thrust and rudder, per cent.
fn impose(thrust: f64, rudder: f64) -> Order {
    Order::Thrust {
        port: (thrust + rudder) / 100.0,
        starboard: (thrust - rudder) / 100.0,
    }
}

fn north(speed_m_s: f64) -> Order {
    steer(0.0, speed_m_s)
}

/// The first time at which `holds` returns true, s.
fn first(rows: &[Row], holds: impl Fn(&Row) -> bool) -> f64 {
    rows.iter()
        .find(|row| holds(row))
        .map_or(f64::NAN, |row| row.t_s)
}

/// Compares every row and column with a reference, within 1e-6.
fn follow(name: &str, mut afloat: Afloat, text: &str) {
    for (i, line) in text.lines().skip(1).enumerate() {
        let c: Vec<Option<f64>> = line.split(',').map(|field| field.parse().ok()).collect();
        let number = |column: usize| c[column].unwrap_or_else(|| panic!("{name}: {line}"));
        match (c[1], c[2]) {
            _ if i == 0 => {}
            (Some(speed_m_s), Some(heading_deg)) => afloat.step(steer(heading_deg, speed_m_s)),
            _ => afloat.step(impose(number(8), number(9))),
        }
        let state = afloat.state;
        let got = [
            afloat.at.east,
            afloat.at.north,
            state.speed_m_s,
            state.heading_deg,
            state.thrust,
            state.rudder,
        ];
        for (column, got) in got.into_iter().enumerate() {
            let want = number(4 + column);
            assert!(
                (got - want).abs() < 1e-6,
                "{name}, row {i}, column {}: {got}, reference {want}",
                4 + column
            );
        }
    }
}

#[test]
fn it_accelerates_as_the_reference_does() {
    follow(
        "heron",
        Afloat::new(&shipped("heron")),
        include_str!("kinematic/heron_accel_max.csv"),
    );
    follow(
        "surveyor",
        Afloat::new(&shipped("surveyor")),
        include_str!("kinematic/surveyor_accel_max.csv"),
    );
}

#[test]
fn it_turns_as_the_reference_does() {
    let heron = Afloat::under_way(&shipped("heron"), 2.0);
    follow(
        "heron",
        heron,
        include_str!("kinematic/heron_turn90_max.csv"),
    );
    let surveyor = Afloat::under_way(&shipped("surveyor"), 3.0);
    follow(
        "surveyor",
        surveyor,
        include_str!("kinematic/surveyor_turn90_max.csv"),
    );
}

#[test]
fn it_takes_thrust_and_rudder_from_outside_as_the_reference_does() {
    for run_up in [north(3.0), impose(100.0, 0.0)] {
        let mut surveyor = Afloat::new(&shipped("surveyor"));
        surveyor.sail(RUN_UP_S, |_| run_up);
        surveyor.at = Ned::default();
        follow(
            "surveyor",
            surveyor,
            include_str!("kinematic/surveyor_tr_thrust100_rudder50.csv"),
        );
    }
}

const BOATS: [&str; 3] = ["heron", "surveyor", "large_usv"];

/// Compares within the printed precision of the reference: half a unit of the last digit.
fn compare(name: &str, what: &str, got: &[f64]) {
    let begin = format!("{name},{what},");
    let line = include_str!("kinematic/manoeuvres.csv")
        .lines()
        .find_map(|line| line.strip_prefix(&begin));
    let references: Vec<&str> = line
        .unwrap_or_else(|| panic!("no line starts with {begin}"))
        .split(',')
        .collect();
    assert_eq!(references.len(), got.len(), "{begin}");
    for (reference, got) in references.into_iter().zip(got) {
        let want: f64 = reference
            .parse()
            .unwrap_or_else(|e| panic!("{begin}{reference}: {e}"));
        let half_place = [0.5, 0.05, 0.005][reference
            .split_once('.')
            .map_or(0, |(_, places)| places.len())];
        // The binary neighbours of a decimal half lie on both sides of it.
        let agrees = (got - want).abs() <= half_place + 1e-9 || got.is_nan() && want.is_nan();
        assert!(agrees, "{name}, {what}: {got}, reference {reference}");
    }
}

fn fastest(rows: &[Row]) -> f64 {
    rows.iter()
        .fold(0.0, |most, row| most.max(row.state.speed_m_s))
}

fn slowest(rows: &[Row]) -> f64 {
    rows.iter()
        .fold(f64::INFINITY, |least, row| least.min(row.state.speed_m_s))
}

#[test]
fn its_accelerations_have_the_reference_numbers() {
    for name in BOATS {
        let boat = shipped(name);
        let top_m_s = boat.speed_max_m_s;
        let rows = Afloat::new(&boat).sail(60.0, |_| north(top_m_s));
        let [t63, t90, t99] = [0.632, 0.9, 0.99]
            .map(|share| first(&rows, |row| row.state.speed_m_s >= share * top_m_s));
        compare(
            name,
            "to full speed",
            &[t63, t90, t99, rows[599].state.speed_m_s, rows[599].at.north],
        );
        let rows = Afloat::new(&boat).sail(60.0, |_| north(0.5 * top_m_s));
        let got = [
            first(&rows, |row| row.state.speed_m_s >= 0.45 * top_m_s),
            fastest(&rows),
        ];
        compare(name, "to half speed", &got);
    }
}

#[test]
fn its_turns_have_the_reference_numbers() {
    for name in BOATS {
        let boat = shipped(name);
        let top_m_s = boat.speed_max_m_s;
        let half_m_s = 0.5 * boat.speed_max_m_s;
        let past = |rows: &[Row], angle_deg: f64| {
            first(rows, |row| row.state.heading_deg.abs() >= angle_deg)
        };
        let rows = Afloat::under_way(&boat, top_m_s).sail(90.0, |_| steer(90.0, top_m_s));
        let off = rows
            .iter()
            .rev()
            .find(|row| (row.state.heading_deg - 90.0).abs() > 2.0);
        let settled_s = off.map_or(f64::NAN, |row| row.t_s);
        compare(
            name,
            "by 90°",
            &[
                past(&rows, 45.0),
                past(&rows, 88.2),
                settled_s,
                slowest(&rows),
            ],
        );
        let rows = Afloat::under_way(&boat, top_m_s).sail(90.0, |_| steer(180.0, top_m_s));
        let aside_m = rows
            .iter()
            .fold(0.0, |most: f64, row| most.max(row.at.east.abs()));
        compare(
            name,
            "by 180°",
            &[
                past(&rows, 90.0),
                past(&rows, 135.0),
                past(&rows, 175.0),
                aside_m,
            ],
        );
        let rows = Afloat::under_way(&boat, half_m_s).sail(90.0, |_| steer(90.0, half_m_s));
        compare(
            name,
            "by 90° at half speed",
            &[past(&rows, 45.0), past(&rows, 88.2)],
        );
    }
}

#[test]
fn its_stops_have_the_reference_numbers() {
    for name in BOATS {
        let boat = shipped(name);
        let stop = |share: f64| {
            let mut afloat = Afloat::under_way(&boat, share * boat.speed_max_m_s);
            let speed_m_s = afloat.state.speed_m_s;
            let rows = afloat.sail(120.0, |_| Order::Hold);
            (
                first(&rows, |row| row.state.speed_m_s <= 0.05 * speed_m_s),
                rows[1199].at.north,
            )
        };
        let full = stop(1.0);
        let half = stop(0.5);
        compare(name, "stops", &[full.0, full.1, half.0, half.1]);
    }
}

#[test]
fn its_tightest_turn_has_the_reference_numbers() {
    for name in BOATS {
        let boat = shipped(name);
        let top_m_s = boat.speed_max_m_s;
        let mut afloat = Afloat::under_way(&boat, top_m_s);
        afloat.sail(200.0, |state| steer(state.heading_deg + 90.0, top_m_s));
        let rate_deg_s = afloat.rate_deg_s;
        let speed_m_s = afloat.state.speed_m_s;
        compare(
            name,
            "held turn",
            &[rate_deg_s, speed_m_s, speed_m_s / rate_deg_s.to_radians()],
        );
    }
}
