//! The Otter against reference trajectories from its published equations.

mod common;

use game::angle::wrap_pi;
use game::{Ned, Order};
use sim::World;

/// One row of a reference: time, north, east, psi, u, v, r, commanded shaft speeds.
struct Row {
    t_s: f64,
    at: Ned,
    psi_rad: f64,
    nu: [f64; 3],
    n_cmd_rad_s: [f64; 2],
}

fn reference(text: &str) -> Vec<Row> {
    let number = |field: &str| field.parse::<f64>().unwrap_or_else(|e| panic!("{field}: {e}"));
    let row = |line: &str| {
        let c: Vec<f64> = line.split(',').map(number).collect();
        Row {
            t_s: c[0],
            at: Ned { north: c[1], east: c[2] },
            psi_rad: c[3],
            nu: [c[4], c[5], c[6]],
            n_cmd_rad_s: [c[7], c[8]],
        }
    };
    text.lines().skip(1).map(row).collect()
}

fn thrust(n_rad_s: [f64; 2]) -> Order {
    let share = |n: f64| if n > 0.0 { n / 103.931 } else { n / 101.737 };
    Order::Thrust { port: share(n_rad_s[0]), starboard: share(n_rad_s[1]) }
}

/// What the boat did, at the times of the reference: position from the start, psi, u, v, r.
fn sail(rows: &[Row], sea: &str, mut order_at: impl FnMut(f64, f64, &Row) -> Order) -> Vec<(Ned, f64, [f64; 3])> {
    let mut world = World::new(&common::alone("otter", sea), 1).expect("an empty sea has room");
    let start = world.state().boats[0].pose.at;
    let mut track = Vec::new();
    for row in rows {
        let boat = world.state().boats[0];
        track.push((boat.pose.at - start, boat.pose.psi_rad, [boat.nu.surge, boat.nu.sway, boat.nu.yaw]));
        for _ in 0..2 {
            let (now, psi) = (world.state().now.as_s(), world.state().boats[0].pose.psi_rad);
            let order = order_at(now, psi, row);
            world.step(&[order, Order::Hold]);
        }
    }
    track
}

/// The largest distance from the reference over the distance sailed.
fn position_error(rows: &[Row], track: &[(Ned, f64, [f64; 3])]) -> f64 {
    let mut sailed_m = 0.0;
    let mut worst = 0.0_f64;
    for (i, row) in rows.iter().enumerate() {
        sailed_m += if i > 0 { row.at.distance(rows[i - 1].at) } else { 0.0 };
        // Below a metre a share means nothing.
        worst = worst.max(track[i].0.distance(row.at) / sailed_m.max(1.0));
    }
    worst
}

#[test]
fn it_accelerates_to_the_speed_of_the_closed_form() {
    let rows = reference(include_str!("otter/accel_n80.csv"));
    let track = sail(&rows, "calm_salt", |_, _, row| thrust(row.n_cmd_rad_s));
    let (u, want) = (track.last().unwrap().2[0], 2.0 * 0.01108 * 80.0 * 80.0 / 77.5544);
    assert!((u - want).abs() < 1e-3 * want, "steady surge {u}, closed form {want}");
    let error = position_error(&rows, &track);
    assert!(error < 0.005, "position is off by {:.3} %", error * 100.0);
}

#[test]
fn it_turns_as_tight_and_as_fast() {
    let rows = reference(include_str!("otter/turn_80_60.csv"));
    let track = sail(&rows, "calm_salt", |_, _, row| thrust(row.n_cmd_rad_s));
    let [u, v, r] = track.last().unwrap().2;
    let radius_m = (u * u + v * v).sqrt() / r;
    for (what, got, want) in [("surge", u, 1.400), ("yaw rate", r.to_degrees(), 9.375), ("radius", radius_m, 8.57)] {
        assert!((got - want).abs() < 0.01 * want, "{what} {got}, reference {want}");
    }
    let error = position_error(&rows, &track);
    assert!(error < 0.01, "position is off by {:.3} % of the way", error * 100.0);
}

#[test]
fn it_drifts_with_the_current_and_turns_as_it_is_caught() {
    let rows = reference(include_str!("otter/current_drift_0p5_b30.csv"));
    let mut scenario = common::alone("otter", "calm_salt");
    scenario.sea.current.mean_m_s = Ned { north: 0.5 * 0.75_f64.sqrt(), east: 0.25 };
    let mut world = World::new(&scenario, 1).unwrap();
    let start = world.state().boats[0].pose.at;
    for row in &rows {
        let boat = world.state().boats[0];
        let off = (boat.pose.at - start).distance(row.at);
        assert!(off < 0.005 * row.at.length().max(1.0), "t {}: {off} m off", row.t_s);
        (0..2).for_each(|_| {
            world.step(&[Order::Hold; 2]);
        });
    }
    let boat = world.state().boats[0];
    let speed = (boat.nu.surge * boat.nu.surge + boat.nu.sway * boat.nu.sway).sqrt();
    assert!((speed - 0.5).abs() < 1e-3, "ground speed {speed}");
    assert!((boat.pose.psi_rad.to_degrees() + 6.22).abs() < 0.05, "psi {}", boat.pose.psi_rad.to_degrees());
}

#[test]
fn its_zigzag_has_the_same_period_and_overshoot() {
    let rows = reference(include_str!("otter/zigzag10_n80_d10.csv"));
    // 20 s straight, then 80 ± 10, switching where the heading passes 10 degrees.
    let mut side = 1.0;
    let mut switches = Vec::new();
    let limit = 10.0_f64.to_radians();
    let track = sail(&rows, "calm_salt", |now, psi, _| {
        if now < 20.0 - 1e-9 {
            return thrust([80.0, 80.0]);
        }
        if side * wrap_pi(psi) > limit {
            side = -side;
            switches.push(now);
        }
        thrust([80.0 + side * 10.0, 80.0 - side * 10.0])
    });
    let period_s = (switches[switches.len() - 1] - switches[2]) / ((switches.len() - 3) as f64 / 2.0);
    assert!((period_s - 8.25).abs() < 0.02 * 8.25, "period {period_s} s");
    let settled = |t_s: f64| t_s > 40.0;
    let peak = |psi: &mut dyn Iterator<Item = f64>| psi.fold(0.0, |a: f64, b| a.max(b.abs())).to_degrees();
    let want_deg = peak(&mut rows.iter().filter(|row| settled(row.t_s)).map(|row| row.psi_rad));
    let got_deg = peak(&mut track.iter().zip(&rows).filter(|(_, row)| settled(row.t_s)).map(|(t, _)| t.1));
    assert!((got_deg - want_deg).abs() < 0.5, "overshoot to {got_deg} degrees, reference {want_deg}");
    assert!(rows.iter().all(|row| row.nu[0] >= 0.0));
}
