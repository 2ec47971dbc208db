//! The point boat against reference trajectories and numbers of its published law.

mod common;

use game::boat::Kinematic;
use game::{Ned, Order};
use sim::kinematic::{KinematicModel, KinematicState};

const DT_S: f64 = 0.1;
/// How long a boat runs up before a manoeuvre.
const RUN_UP_S: f64 = 60.0;

/// The shipped point boat of this name: Pyquaticus' (main, 2025-11).
fn shipped(name: &str) -> Kinematic {
    let boat = common::boat(&format!("{name}_kinematic"));
    let game::boat::Drive::Kinematic(kinematic) = boat.drive else { panic!("{name} is a point boat") };
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

/// Where it was, and its state, at a time since the manoeuvre began.
struct Row {
    t_s: f64,
    at: Ned,
    state: KinematicState,
}

impl Afloat {
    fn new(boat: &Kinematic) -> Afloat {
        let (model, state) = (KinematicModel::new(boat), KinematicState::default());
        Afloat { model, state, at: Ned::default(), rate_deg_s: 0.0 }
    }

    /// One that has run up northward and is back at the origin.
    fn under_way(boat: &Kinematic, speed_m_s: f64) -> Afloat {
        let mut afloat = Afloat::new(boat);
        afloat.sail(RUN_UP_S, |_| north(speed_m_s));
        afloat.at = Ned::default();
        afloat
    }

    fn step(&mut self, command: Order) {
        let motion = self.model.step(&mut self.state, command, Ned::default(), DT_S);
        self.at = self.at + motion.travel_m;
        self.rate_deg_s = motion.turn_rad.to_degrees() / DT_S;
    }

    fn sail(&mut self, seconds: f64, command: impl Fn(&KinematicState) -> Order) -> Vec<Row> {
        let ticks = 1..=(seconds / DT_S).round() as u32;
        let row = |tick: u32| {
            self.step(command(&self.state));
            Row { t_s: f64::from(tick) * DT_S, at: self.at, state: self.state }
        };
        ticks.map(row).collect()
    }
}

fn steer(heading_deg: f64, speed_m_s: f64) -> Order {
    Order::Steer { heading_rad: heading_deg.to_radians(), speed_m_s }
}

/// Thrust and rudder, per cent.
fn impose(thrust: f64, rudder: f64) -> Order {
    Order::Thrust { port: (thrust + rudder) / 100.0, starboard: (thrust - rudder) / 100.0 }
}

fn north(speed_m_s: f64) -> Order {
    steer(0.0, speed_m_s)
}

/// When something first holds, s.
fn first(rows: &[Row], holds: impl Fn(&Row) -> bool) -> f64 {
    rows.iter().find(|row| holds(row)).map_or(f64::NAN, |row| row.t_s)
}

/// Every row and column of a reference within 1e-6.
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
        let got = [afloat.at.east, afloat.at.north, state.speed_m_s, state.heading_deg, state.thrust, state.rudder];
        for (column, got) in got.into_iter().enumerate() {
            let want = number(4 + column);
            assert!((got - want).abs() < 1e-6, "{name}, row {i}, column {}: {got}, reference {want}", 4 + column);
        }
    }
}

#[test]
fn it_accelerates_as_the_reference_does() {
    follow("heron", Afloat::new(&shipped("heron")), include_str!("kinematic/heron_accel_max.csv"));
    follow("surveyor", Afloat::new(&shipped("surveyor")), include_str!("kinematic/surveyor_accel_max.csv"));
}

#[test]
fn it_turns_as_the_reference_does() {
    let heron = Afloat::under_way(&shipped("heron"), 2.0);
    follow("heron", heron, include_str!("kinematic/heron_turn90_max.csv"));
    let surveyor = Afloat::under_way(&shipped("surveyor"), 3.0);
    follow("surveyor", surveyor, include_str!("kinematic/surveyor_turn90_max.csv"));
}

#[test]
fn it_takes_thrust_and_rudder_from_outside_as_the_reference_does() {
    for run_up in [north(3.0), impose(100.0, 0.0)] {
        let mut surveyor = Afloat::new(&shipped("surveyor"));
        surveyor.sail(RUN_UP_S, |_| run_up);
        surveyor.at = Ned::default();
        follow("surveyor", surveyor, include_str!("kinematic/surveyor_tr_thrust100_rudder50.csv"));
    }
}

/// What Pyquaticus measures of a boat: each manoeuvre's numbers, and the place to which they are printed.
struct Reference {
    name: &'static str,
    /// Time to 63.2, 90 and 99 % of the highest speed (NaN: never), s; speed reached, m/s; distance in 60 s, m.
    accelerate: [(f64, f64); 5],
    /// To half speed: time to 90 % of it, s; peak, m/s.
    half: [(f64, f64); 2],
    /// By 90° at full speed: time to 45°, to 88.2°, last time more than 2° off, s; lowest speed, m/s.
    turn_90: [(f64, f64); 4],
    /// By 180° at full speed: time to 90°, 135° and 175°, s; largest offset to the side, m.
    turn_180: [(f64, f64); 4],
    /// By 90° at half speed: time to 45° and 88.2°, s.
    turn_90_half: [(f64, f64); 2],
    /// From full and from half speed: time to 5 % of the speed it had, s; way to standstill, m.
    stop: [(f64, f64); 4],
    /// With the heading always 90° off: yaw rate, °/s; speed, m/s; radius, m.
    held: [(f64, f64); 3],
}

const NEVER: (f64, f64) = (f64::NAN, 0.1);

fn references() -> [Reference; 3] {
    [
        Reference {
            name: "heron",
            accelerate: [(4.6, 0.1), (12.2, 0.1), (25.7, 0.1), (2.0, 0.1), (110.2, 0.1)],
            half: [(9.0, 0.1), (1.00, 0.01)],
            turn_90: [(1.1, 0.1), (6.2, 0.1), (5.9, 0.1), (1.68, 0.01)],
            turn_180: [(1.1, 0.1), (2.2, 0.1), (5.7, 0.1), (5.1, 0.1)],
            turn_90_half: [(2.0, 0.1), (10.6, 0.1)],
            stop: [(12.9, 0.1), (9.8, 0.1), (11.7, 0.1), (3.9, 0.1)],
            held: [(97.2, 0.1), (0.62, 0.01), (0.37, 0.01)],
        },
        Reference {
            name: "surveyor",
            accelerate: [(25.3, 0.1), (36.0, 0.1), (39.6, 0.1), (3.0, 0.1), (120.1, 0.1)],
            half: [(18.1, 0.1), (2.09, 0.01)],
            turn_90: [(4.6, 0.1), (26.1, 0.1), (25.3, 0.1), (2.28, 0.01)],
            turn_180: [(5.0, 0.1), (9.6, 0.1), (24.2, 0.1), (29.8, 0.1)],
            turn_90_half: [(8.0, 0.1), (42.2, 0.1)],
            stop: [(22.8, 0.1), (35.9, 0.1), (11.6, 0.1), (9.1, 0.1)],
            held: [(20.0, 1.0), (0.45, 0.01), (1.29, 0.01)],
        },
        Reference {
            name: "large_usv",
            accelerate: [(30.4, 0.1), NEVER, NEVER, (10.5, 0.1), (410.0, 1.0)],
            half: [(21.6, 0.1), (6.0, 0.1)],
            turn_90: [(2.8, 0.1), (16.4, 0.1), (15.9, 0.1), (9.5, 0.1)],
            turn_180: [(2.9, 0.1), (5.9, 0.1), (15.2, 0.1), (76.4, 0.1)],
            turn_90_half: [(4.9, 0.1), (28.4, 0.1)],
            stop: [(39.9, 0.1), (220.0, 1.0), (22.8, 0.1), (71.7, 0.1)],
            held: [(22.1, 0.1), (7.7, 0.1), (20.0, 0.1)],
        },
    ]
}

/// Compares to the place to which the reference is printed: half of it either way.
fn compare<const N: usize>(reference: &Reference, what: &str, got: [f64; N], want: [(f64, f64); N]) {
    for (got, (want, place)) in got.into_iter().zip(want) {
        // The binary neighbours of a decimal half are on either side of it.
        let agrees = (got - want).abs() <= 0.5 * place + 1e-9 || got.is_nan() && want.is_nan();
        assert!(agrees, "{}, {what}: {got}, reference {want}", reference.name);
    }
}

fn fastest(rows: &[Row]) -> f64 {
    rows.iter().fold(0.0, |most, row| most.max(row.state.speed_m_s))
}

fn slowest(rows: &[Row]) -> f64 {
    rows.iter().fold(f64::INFINITY, |least, row| least.min(row.state.speed_m_s))
}

#[test]
fn its_accelerations_have_the_reference_numbers() {
    for reference in references() {
        let boat = shipped(reference.name);
        let top_m_s = boat.speed_max_m_s;
        let rows = Afloat::new(&boat).sail(60.0, |_| north(top_m_s));
        let [t63, t90, t99] =
            [0.632, 0.9, 0.99].map(|share| first(&rows, |row| row.state.speed_m_s >= share * top_m_s));
        let got = [t63, t90, t99, rows[599].state.speed_m_s, rows[599].at.north];
        compare(&reference, "to full speed", got, reference.accelerate);
        let rows = Afloat::new(&boat).sail(60.0, |_| north(0.5 * top_m_s));
        let got = [first(&rows, |row| row.state.speed_m_s >= 0.45 * top_m_s), fastest(&rows)];
        compare(&reference, "to half speed", got, reference.half);
    }
}

#[test]
fn its_turns_have_the_reference_numbers() {
    for reference in references() {
        let boat = shipped(reference.name);
        let (top_m_s, half_m_s) = (boat.speed_max_m_s, 0.5 * boat.speed_max_m_s);
        let past = |rows: &[Row], angle_deg: f64| first(rows, |row| row.state.heading_deg.abs() >= angle_deg);
        let rows = Afloat::under_way(&boat, top_m_s).sail(90.0, |_| steer(90.0, top_m_s));
        let off = rows.iter().rev().find(|row| (row.state.heading_deg - 90.0).abs() > 2.0);
        let settled_s = off.map_or(f64::NAN, |row| row.t_s);
        let got = [past(&rows, 45.0), past(&rows, 88.2), settled_s, slowest(&rows)];
        compare(&reference, "90 degrees", got, reference.turn_90);
        let rows = Afloat::under_way(&boat, top_m_s).sail(90.0, |_| steer(180.0, top_m_s));
        let aside_m = rows.iter().fold(0.0, |most: f64, row| most.max(row.at.east.abs()));
        compare(
            &reference,
            "180 degrees",
            [past(&rows, 90.0), past(&rows, 135.0), past(&rows, 175.0), aside_m],
            reference.turn_180,
        );
        let rows = Afloat::under_way(&boat, half_m_s).sail(90.0, |_| steer(90.0, half_m_s));
        compare(&reference, "90 degrees, half", [past(&rows, 45.0), past(&rows, 88.2)], reference.turn_90_half);
    }
}

#[test]
fn its_stops_have_the_reference_numbers() {
    for reference in references() {
        let boat = shipped(reference.name);
        let stop = |share: f64| {
            let mut afloat = Afloat::under_way(&boat, share * boat.speed_max_m_s);
            let speed_m_s = afloat.state.speed_m_s;
            let rows = afloat.sail(120.0, |_| Order::Hold);
            (first(&rows, |row| row.state.speed_m_s <= 0.05 * speed_m_s), rows[1199].at.north)
        };
        let (full, half) = (stop(1.0), stop(0.5));
        compare(&reference, "stops", [full.0, full.1, half.0, half.1], reference.stop);
    }
}

#[test]
fn its_tightest_turn_has_the_reference_numbers() {
    for reference in references() {
        let boat = shipped(reference.name);
        let top_m_s = boat.speed_max_m_s;
        let mut afloat = Afloat::under_way(&boat, top_m_s);
        afloat.sail(200.0, |state| steer(state.heading_deg + 90.0, top_m_s));
        let (rate_deg_s, speed_m_s) = (afloat.rate_deg_s, afloat.state.speed_m_s);
        let got = [rate_deg_s, speed_m_s, speed_m_s / rate_deg_s.to_radians()];
        compare(&reference, "held turn", got, reference.held);
    }
}
