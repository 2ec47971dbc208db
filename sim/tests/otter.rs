//! The Otter compared with reference trajectories from its published equations.

mod common;

use messages::Order;
use primitives::Ned;
use primitives::angle::wrap_pi;
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
    let number = |field: &str| {
        field
            .parse::<f64>()
            .unwrap_or_else(|e| panic!("{field}: {e}"))
    };
    let row = |line: &str| {
        let c: Vec<f64> = line.split(',').map(number).collect();
        Row {
            t_s: c[0],
            at: Ned {
                north: c[1],
                east: c[2],
            },
            psi_rad: c[3],
            nu: [c[4], c[5], c[6]],
            n_cmd_rad_s: [c[7], c[8]],
        }
    };
    text.lines().skip(1).map(row).collect()
}

fn thrust(n_rad_s: [f64; 2]) -> Order {
    let share = |n: f64| if n > 0.0 { n / 103.931 } else { n / 101.737 };
    Order::Thrust {
        port: share(n_rad_s[0]),
        starboard: share(n_rad_s[1]),
    }
}

/// The boat's motion at the times of the reference: position from the start, psi, u, v, r.
fn sail(
    rows: &[Row],
    sea: &str,
    mut order_at: impl FnMut(f64, f64, &Row) -> Order,
) -> Vec<(Ned, f64, [f64; 3])> {
    let mut world = World::of_game(&common::alone("otter", sea), 1).expect("the boats fit");
    let start = world.state().boats[0].pose.at;
    let mut track = Vec::new();
    for row in rows {
        let boat = world.state().boats[0];
        track.push((
            boat.pose.at - start,
            boat.pose.psi_rad,
            [boat.nu.surge, boat.nu.sway, boat.nu.yaw],
        ));
        for _ in 0..2 {
            let now = world.state().now.as_s();
            let psi = world.state().boats[0].pose.psi_rad;
            let order = order_at(now, psi, row);
            world.step(&[order, Order::Hold]);
        }
    }
    track
}

/// The largest distance from the reference, relative to the distance travelled.
fn position_error(rows: &[Row], track: &[(Ned, f64, [f64; 3])]) -> f64 {
    let mut sailed_m = 0.0;
    let mut worst = 0.0_f64;
    for (i, row) in rows.iter().enumerate() {
        sailed_m += if i > 0 {
            row.at.distance(rows[i - 1].at)
        } else {
            0.0
        };
        // Below a metre a relative error has no meaning.
        worst = worst.max(track[i].0.distance(row.at) / sailed_m.max(1.0));
    }
    worst
}

#[test]
fn it_accelerates_as_the_reference_does() {
    let rows = reference(include_str!("otter/accel_n80.csv"));
    let track = sail(&rows, "calm_salt", |_, _, row| thrust(row.n_cmd_rad_s));
    let error = position_error(&rows, &track);
    assert!(error < 0.005, "position error {:.3} %", error * 100.0);
}

/// The Otter's velocity at every tick for this many seconds under these shaft speeds, from rest,
/// and the final world.
fn from_rest(n_rad_s: [f64; 2], seconds: u32) -> (Vec<[f64; 3]>, World) {
    let mut world = World::of_game(&common::alone("otter", "calm_salt"), 1).expect("the boats fit");
    let step = |_| {
        world.step(&[thrust(n_rad_s), Order::Hold]);
        let nu = world.state().boats[0].nu;
        [nu.surge, nu.sway, nu.yaw]
    };
    ((0..20 * seconds).map(step).collect(), world)
}

#[test]
fn it_takes_up_speed_as_its_mass_resistance_and_shafts_say() {
    // Shaft speeds follow 1 − e^(−t / 0.1 s), thrust is proportional to their square, and (m + A11)
    // u' = thrust − d u is linear. The steady speeds, 2 k n² / d, are published as 0.4572 and
    // 1.8287 m/s.
    let time_s = 85.2815 / 77.5544;
    let share = |t_s: f64| {
        let ramp = |rate: f64| {
            let hull = primitives::math::exp(-t_s / time_s);
            (primitives::math::exp(-rate * t_s) - hull) / (1.0 - rate * time_s)
        };
        1.0 - primitives::math::exp(-t_s / time_s) - 2.0 * ramp(10.0) + ramp(20.0)
    };
    for (n_rad_s, published_m_s) in [(40.0, 0.4572), (80.0, 1.8287)] {
        let track = from_rest([n_rad_s; 2], 60).0;
        let steady = track[1199][0];
        let want = 2.0 * 0.01108 * n_rad_s * n_rad_s / 77.5544;
        assert!(
            (steady / want - 1.0).abs() < 1e-9,
            "{n_rad_s} rad/s: {steady}, closed form {want}"
        );
        assert!(
            (steady - published_m_s).abs() < 1e-4,
            "{n_rad_s} rad/s: {steady}, published {published_m_s}"
        );
        for (i, [u, v, r]) in track.iter().enumerate() {
            let want = steady * share(0.05 * (i + 1) as f64);
            assert!(
                (u - want).abs() < 1e-4 * steady && (*v, *r) == (0.0, 0.0),
                "tick {i}: {u}, closed form {want}"
            );
        }
        for (part, published_s) in [(0.632, 1.3), (0.9, 2.7)] {
            let after = track.iter().position(|nu| nu[0] >= part * steady).unwrap();
            let got_s = 0.05 * (after + 1) as f64
                - 0.05 * (track[after][0] - part * steady)
                    / (track[after][0] - track[after - 1][0]);
            assert!(
                (got_s - published_s).abs() < 0.05,
                "{part} after {got_s} s, published {published_s} s"
            );
        }
    }
}

#[test]
fn it_spins_on_the_spot_under_opposed_shafts() {
    // At 70 and −70 rad/s, published as 13.18 degrees per second. Astern, the propellers give less
    // thrust, so the boat creeps ahead.
    let [u, v, r] = from_rest([70.0, -70.0], 60).0[1199];
    assert!(
        (r.to_degrees() - 13.18).abs() < 0.02,
        "{} degrees per second",
        r.to_degrees()
    );
    assert!((0.0..0.4).contains(&u) && v.abs() < 0.1, "{u} {v}");

    // With equal thrust astern and ahead, the boat turns about a fixed point.
    let astern = -70.0 * (0.01108_f64 / 0.006445).sqrt();
    let (_, mut world) = from_rest([70.0, astern], 60);
    let mut around = || {
        // One turn, to the nearest tick.
        let rate = world.state().boats[0].nu.yaw;
        let ticks = (std::f64::consts::TAU / (0.05 * rate)).round() as u32;
        let mut middle = Ned::default();
        for _ in 0..ticks {
            world.step(&[thrust([70.0, astern]), Order::Hold]);
            middle = middle
                + world.state().boats[0]
                    .pose
                    .at
                    .scaled(1.0 / f64::from(ticks));
        }
        middle
    };
    let moved_m = around().distance(around());
    assert!(moved_m < 1e-3, "{moved_m} m a turn");
}

#[test]
fn it_turns_as_tight_and_as_fast() {
    let rows = reference(include_str!("otter/turn_80_60.csv"));
    let track = sail(&rows, "calm_salt", |_, _, row| thrust(row.n_cmd_rad_s));
    let [u, v, r] = track.last().unwrap().2;
    let radius_m = (u * u + v * v).sqrt() / r;
    for (what, got, want) in [
        ("surge", u, 1.400),
        ("yaw rate", r.to_degrees(), 9.375),
        ("radius", radius_m, 8.57),
    ] {
        assert!(
            (got - want).abs() < 0.01 * want,
            "{what} {got}, reference {want}"
        );
    }
    let error = position_error(&rows, &track);
    assert!(
        error < 0.01,
        "position error {:.3} % of the distance",
        error * 100.0
    );
}

#[test]
fn it_drifts_with_the_current_and_turns_as_it_is_caught() {
    let rows = reference(include_str!("otter/current_drift_0p5_b30.csv"));
    let mut scenario = common::alone("otter", "calm_salt");
    scenario.sea.current.mean_m_s = Ned {
        north: 0.5 * 0.75_f64.sqrt(),
        east: 0.25,
    };
    let mut world = World::of_game(&scenario, 1).unwrap();
    let start = world.state().boats[0].pose.at;
    for row in &rows {
        let boat = world.state().boats[0];
        let off = (boat.pose.at - start).distance(row.at);
        assert!(
            off < 0.005 * row.at.length().max(1.0),
            "t {}: {off} m off",
            row.t_s
        );
        common::sail(&mut world, &[Order::Hold; 2], 2);
    }
    let boat = world.state().boats[0];
    let speed = (boat.nu.surge * boat.nu.surge + boat.nu.sway * boat.nu.sway).sqrt();
    assert!((speed - 0.5).abs() < 1e-3, "ground speed {speed}");
    assert!(
        (boat.pose.psi_rad.to_degrees() + 6.22).abs() < 0.05,
        "psi {}",
        boat.pose.psi_rad.to_degrees()
    );
}

#[test]
fn its_zigzag_has_the_same_period_and_overshoot() {
    let rows = reference(include_str!("otter/zigzag10_n80_d10.csv"));
    // 20 s straight, then 80 ± 10, switching when the heading passes 10 degrees.
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
    let period_s =
        (switches[switches.len() - 1] - switches[2]) / ((switches.len() - 3) as f64 / 2.0);
    assert!((period_s - 8.25).abs() < 0.02 * 8.25, "period {period_s} s");
    let settled = |t_s: f64| t_s > 40.0;
    let peak =
        |psi: &mut dyn Iterator<Item = f64>| psi.fold(0.0, |a: f64, b| a.max(b.abs())).to_degrees();
    let want_deg = peak(
        &mut rows
            .iter()
            .filter(|row| settled(row.t_s))
            .map(|row| row.psi_rad),
    );
    let got_deg = peak(
        &mut track
            .iter()
            .zip(&rows)
            .filter(|(_, row)| settled(row.t_s))
            .map(|(t, _)| t.1),
    );
    assert!(
        (got_deg - want_deg).abs() < 0.5,
        "overshoot to {got_deg} degrees, reference {want_deg}"
    );
    assert!(rows.iter().all(|row| row.nu[0] >= 0.0));
}
