//! Scenarios for tests, as users would write them.
#![allow(dead_code, reason = "each test file uses a part of it")]

use messages::Order;
use primitives::{LatLon, Ned, Pose, VehicleId};
use rules::field::{Obstacle, Plan, Walls};
use rules::{Field, Sharing};
use scenario::link::{Link, Loss};
use scenario::sea::{Sea, Spreading, Waves};
use scenario::{Boat, Overrides, Scenario};
use sim::hull::{HullModel, Planar};
use sim::{Contest, State, World};
use std::path::{Path, PathBuf};

/// The shipped scenarios.
pub(crate) fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios")
}

pub(crate) fn shipped(game: &str) -> Scenario {
    scenario::load(&scenarios().join("games").join(game)).unwrap_or_else(|e| panic!("{e}"))
}

/// A game written in a test; paths in it are relative to `scenarios/games`.
pub(crate) fn written(toml: &str) -> Scenario {
    let dir = tempfile::tempdir().expect("a temporary directory can be created");
    let root = scenarios().canonicalize().expect("the scenarios exist");
    let path = dir.path().join("test.toml");
    std::fs::write(&path, toml.replace("../", &format!("{}/", root.display())))
        .expect("a file can be written");
    scenario::load(&path).unwrap_or_else(|e| panic!("{e}"))
}

/// One idle boat from this file per side on open salt water, blue's at its half point.
pub(crate) fn alone(boat: &str, sea: &str) -> Scenario {
    written(
        &include_str!("alone.toml")
            .replace("SEA.toml", &format!("{sea}.toml"))
            .replace("BOAT.toml", &format!("{boat}.toml")),
    )
}

/// Like [`alone`], but in still fresh water with these obstacles.
pub(crate) fn among(boat: &str, obstacles: Vec<Obstacle>) -> Scenario {
    let mut scenario = alone(boat, "calm");
    scenario.field.plan.obstacles = obstacles;
    scenario
}

/// A contest with seed 1, before its first tick.
pub(crate) fn started(scenario: &Scenario) -> Contest {
    Contest::new(scenario, 1).unwrap_or_else(|e| panic!("{e}"))
}

/// The world of a game, with its first boat placed by [`place_boat`].
pub(crate) fn afloat(
    scenario: &Scenario,
    seed: u64,
    start: (f64, f64, f64),
    nu: (f64, f64, f64),
) -> World {
    let mut world = World::of_game(scenario, seed).expect("the boats fit");
    place_boat(&mut world, 0, start, nu);
    world
}

/// A shipped game on a shipped sea.
pub(crate) fn on_sea(game: &str, sea: &Path) -> Scenario {
    let overrides = Overrides {
        sea: Some(scenarios().join("seas").join(sea)),
        ..Overrides::default()
    };
    let path = scenarios().join("games").join(game);
    scenario::load_with(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// Adds radio links with losses, and limits on sharing.
pub(crate) fn hamper(scenario: &mut Scenario) {
    let loss = Loss {
        good: 0.1,
        bad: 0.8,
        good_time_s: 5.0,
        bad_time_s: 2.0,
    };
    let station = scenario.field.corners[0];
    scenario.link = Some(Link {
        delay_s: 0.35,
        jitter_s: 0.2,
        loss,
        range_m: Some(500.0),
        station,
    });
    scenario.rules.sharing = Sharing {
        range_m: Some(60.0),
        view_rad: Some(4.0),
        delay_s: 0.3,
        noise_m: 1.0,
        velocity_noise_m_s: 0.1,
        loss: 0.1,
        memory_s: 5.0,
    };
}

/// Changes the state of a contest's world directly.
pub(crate) fn set_in(contest: &mut Contest, change: impl FnOnce(&mut State)) {
    // Name, version, fingerprint of the scenario and checksum; the body begins with the world.
    let snapshot = contest.snapshot();
    let head = &snapshot[..13];
    let body = &snapshot[21..];
    let (mut state, rest) =
        postcard::take_from_bytes::<State>(body).expect("a snapshot begins with the world");
    change(&mut state);
    let body = [
        &postcard::to_stdvec(&state).expect("plain numbers can be encoded"),
        rest,
    ]
    .concat();
    let checksum = xxhash_rust::xxh3::xxh3_64(&body).to_le_bytes();
    contest
        .restore(&[head, &checksum, &body].concat())
        .expect("the snapshot is valid");
}

/// Advances a world under constant orders.
pub(crate) fn sail(world: &mut World, orders: &[Order], ticks: u32) {
    for _ in 0..ticks {
        world.step(orders);
    }
}

/// A 128-bit hash of a world's state.
pub(crate) fn digest(world: &World) -> u128 {
    xxhash_rust::xxh3::xxh3_128(
        &postcard::to_stdvec(world.state()).expect("plain numbers can be encoded"),
    )
}

/// The number of boat pairs newly within the rules' collision distance, compared with `touching`.
pub(crate) fn came_together(
    world: &World,
    scenario: &Scenario,
    touching: &mut Vec<(u16, u16)>,
) -> usize {
    let distance_m = scenario.rules.collision_distance_m;
    let near = world
        .pairs()
        .iter()
        .filter(|pair| pair.distance_squared < distance_m * distance_m);
    let now: Vec<(u16, u16)> = near.map(|pair| (pair.a, pair.b)).collect();
    let new = now.iter().filter(|pair| !touching.contains(pair)).count();
    *touching = now;
    new
}

/// Gives a vehicle an order in reply to the open picture.
pub(crate) fn order(contest: &mut Contest, vehicle: VehicleId, order: Order) {
    contest
        .order(vehicle, order, contest.now())
        .expect("the order is valid");
}

/// Places a boat (x east, y north) with a heading and a velocity.
pub(crate) fn place_boat(
    world: &mut World,
    boat: usize,
    (x, y, heading_deg): (f64, f64, f64),
    nu: (f64, f64, f64),
) {
    let pose = Pose {
        at: Ned::from_xy(x, y),
        psi_rad: primitives::angle::rad_from_compass_deg(heading_deg),
    };
    world.set_under_way(
        VehicleId::at(boat),
        pose,
        Planar {
            surge: nu.0,
            sway: nu.1,
            yaw: nu.2,
        },
    );
}

/// The hulls of a scenario, by vehicle index.
pub(crate) fn hulls(scenario: &Scenario) -> Vec<HullModel> {
    let density = scenario.sea.water_density_kg_m3;
    scenario
        .vehicles
        .iter()
        .map(|v| HullModel::new(&scenario.boats[v.boat].hull, density))
        .collect()
}

/// Kinetic energy of all boats, J.
pub(crate) fn energy_joule(world: &World, hulls: &[HullModel]) -> f64 {
    world
        .state()
        .boats
        .iter()
        .zip(hulls)
        .map(|(boat, hull)| hull.energy_joule(boat.nu))
        .sum()
}

/// A boat's hull as a capsule: the ends of its axis, and its radius in m.
pub(crate) fn capsule(world: &World, scenario: &Scenario, vehicle: usize) -> ((Ned, Ned), f64) {
    let kind = &scenario.boats[scenario.vehicles[vehicle].boat];
    let pose = world.state().boats[vehicle].pose;
    let half = pose
        .rotation()
        .ahead()
        .scaled(0.5 * (kind.length_m - kind.beam_m));
    ((pose.at - half, pose.at + half), 0.5 * kind.beam_m)
}

/// The distance between the hulls of two boats, m.
pub(crate) fn gap_m(world: &World, scenario: &Scenario, a: usize, b: usize) -> f64 {
    let (keel_a, radius_a) = capsule(world, scenario, a);
    let (keel_b, radius_b) = capsule(world, scenario, b);
    keels_m(keel_a, keel_b) - radius_a - radius_b
}

/// The distance between two line segments, m; zero if they cross.
pub(crate) fn keels_m((a, b): (Ned, Ned), (c, d): (Ned, Ned)) -> f64 {
    let cross =
        |o: Ned, p: Ned, q: Ned| (p - o).north * (q - o).east - (p - o).east * (q - o).north;
    if cross(a, b, c) * cross(a, b, d) < 0.0 && cross(c, d, a) * cross(c, d, b) < 0.0 {
        return 0.0;
    }
    let ends = [
        point_m(a, (c, d)),
        point_m(b, (c, d)),
        point_m(c, (a, b)),
        point_m(d, (a, b)),
    ];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// The distance of a point from a line segment, m.
pub(crate) fn point_m(at: Ned, (a, b): (Ned, Ned)) -> f64 {
    let side = b - a;
    let from_a = at - a;
    let share = (from_a.dot(side) / side.dot(side)).clamp(0.0, 1.0);
    from_a.distance(side.scaled(share))
}

/// The root of an increasing `f` between `low` and `high`, by bisection.
pub(crate) fn root((mut low, mut high): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}

/// Two Surveyors far apart on this water.
pub(crate) fn surveyor_on(change: impl FnOnce(&mut Sea)) -> Scenario {
    let mut scenario = alone("surveyor_m1_8", "calm");
    change(&mut scenario.sea);
    scenario
}

/// One of the boat files shipped with Squall.
pub(crate) fn boat(name: &str) -> Boat {
    scenario::load_file(&scenarios().join(format!("boats/{name}.toml")))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// An empty field of 160 m by 80 m from this corner.
pub(crate) fn empty_field(corner: Ned, along_deg: f64) -> Field {
    Field::new(Plan {
        name: "test".into(),
        datum: LatLon::default(),
        corner,
        along_deg,
        width_m: 160.0,
        depth_m: 80.0,
        flag_inset_m: 20.0,
        extra_flags: vec![],
        default_flags: Default::default(),
        obstacles: vec![],
        walls: Walls::None,
    })
}

/// A short-crested sea of 64 components from this bearing.
pub(crate) fn waves(hs_m: f64, tp_s: f64, from_rad: f64) -> Waves {
    let spreading = Spreading::CosineSquared;
    Waves {
        hs_m,
        tp_s,
        gamma: 3.3,
        from_rad,
        spreading,
        components: 64,
        drift_factor: 1.0,
    }
}

pub(crate) fn square(x: f64) -> f64 {
    x * x
}

/// Tolerance, five standard errors, of the mean square (about 1) of `count` samples of a process,
/// `step` correlation times apart.
pub(crate) fn five_errors(count: usize, step: f64) -> f64 {
    5.0 * (2.0 / (count as f64 * step)).sqrt()
}

/// Asserts that a series of samples `step` correlation times apart, with mean 0 and variance 1, has
/// the autocorrelation e^(−lag) within this tolerance.
pub(crate) fn assert_memory(what: &str, x: &[f64], lags: &[usize], step: f64, within: f64) {
    assert!(mean_of(x.len(), |i| x[i]).abs() < within, "{what}: mean");
    for lag in lags {
        let want = primitives::math::exp(-(*lag as f64) * step);
        let got = mean_of(x.len() - lag, |i| x[i] * x[i + lag]);
        assert!(
            (got - want).abs() < within,
            "{what}, lag {lag}: {got}, want {want} within {within}"
        );
    }
}

/// The mean of `f` over 0 to `count`.
pub(crate) fn mean_of(count: usize, f: impl Fn(usize) -> f64) -> f64 {
    (0..count).map(f).sum::<f64>() / count as f64
}

/// The amplitudes of the harmonics of a series, by the discrete Fourier transform with a Hann
/// window: harmonic `n` has `n` periods in the series. A sine between two harmonics loses up to a
/// sixth of its amplitude.
pub(crate) fn amplitudes(series: &[f64]) -> Vec<f64> {
    let count = series.len();
    let turns: Vec<(f64, f64)> = (0..count)
        .map(|i| primitives::math::sin_cos(std::f64::consts::TAU * i as f64 / count as f64))
        .collect();
    let windowed: Vec<f64> = series
        .iter()
        .zip(&turns)
        .map(|(x, turn)| x * (1.0 - turn.1))
        .collect();
    let amplitude = |harmonic: usize| {
        let mut sin = 0.0;
        let mut cos = 0.0;
        let mut place = 0;
        for x in &windowed {
            (sin, cos) = (sin + x * turns[place].0, cos + x * turns[place].1);
            place += harmonic;
            place -= if place >= count { count } else { 0 };
        }
        2.0 / count as f64 * primitives::math::length(sin, cos)
    };
    (0..count / 2).map(amplitude).collect()
}

/// The derivatives at 0 of the components of `f`, by fourth-order differences. The step suits
/// single-precision numbers that vary over a tenth of a unit.
pub(crate) fn derivative<T, const N: usize>(
    f: impl Fn(f64) -> T,
    parts: impl Fn(&T) -> [f64; N],
) -> [f64; N] {
    let step = 0.01;
    let [far_before, before, after, far_after] =
        [-2.0, -1.0, 1.0, 2.0].map(|n| parts(&f(n * step)));
    std::array::from_fn(|i| {
        (8.0 * (after[i] - before[i]) - (far_after[i] - far_before[i])) / (12.0 * step)
    })
}
