//! The Surveyor of the boat files approaches its geofence at every speed, in every shipped sea. The
//! geofence watch stops it early enough for it to come to rest inside.
//!
//! `SQUALL_APPROACHES=10000 cargo test --locked --release --workspace --test geofence --
//! --nocapture` runs more.

#![expect(clippy::print_stdout, reason = "prints measurements when run by hand")]

use gateway::config::default_gateway;
use gateway::geofence::{Coasting, GeofenceWatch};
use gateway::set_point::{SetPoint, SetPointMapper};
use messages::Order;
use messages::picture::Nav;
use primitives::SimTime;
use primitives::frame::Ned;
use primitives::stream::Stream;
use scenario::boat::Boat;
use scenario::sea::Sea;
use scenario::{draw_file, load_file};
use sim::hull::Planar;
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use trial::{Command, Sample, Start, TrialBoat, open_field};

/// The simulated water's tick; the gateway runs in every second one.
const TICK: SimTime = SimTime(50_000_000);
/// The age of a fix when the gateway receives it, and the time that a command is in transit, in
/// ticks: 0.2 s and 0.1 s.
const FIX_TICKS: usize = 4;
const COMMAND_TICKS: u32 = 2;
/// Distance of the geofence's edge north of the middle of the field, m.
const EDGE_M: f64 = 500.0;
/// Time for which a stopped boat is observed, s: on water at rest, until it lies still; elsewhere
/// it continues to drift.
const STILL_S: f64 = 60.0;
const DRIFTING_S: f64 = 20.0;
/// Time after which an approach that has not reached the edge ends, s.
const LONGEST_S: f64 = 150.0;

/// Distance from the edge beyond which a boat may manoeuvre freely, m.
const ROOM_M: f64 = 30.0;

/// An approach: its speed, heading and initial distance.
struct Approach {
    sea: usize,
    speed_m_s: f64,
    heading_rad: f64,
    /// Angle by which the boat turns occasionally, rad.
    turn_rad: f64,
    from_m: f64,
    seed: u64,
}

/// How an approach ended: by how much the boat crossed the edge (m, negative inside), its distance
/// at rest from where it was stopped, and the distance of that place from the edge.
struct Ended {
    crossed_m: f64,
    went_m: f64,
    room_m: f64,
}

fn nav(sample: &Sample) -> Nav {
    Nav {
        north_m: sample.at.north,
        east_m: sample.at.east,
        psi_rad: sample.psi_rad,
        surge_m_s: sample.nu.surge,
        sway_m_s: sample.nu.sway,
        yaw_rate_rad_s: sample.nu.yaw,
    }
}

/// Heads for the edge, with a turn to either side every 8 s.
fn approach(approach: &Approach, boat: &Boat, sea: &Sea) -> Option<Ended> {
    let &Approach {
        speed_m_s,
        heading_rad,
        turn_rad,
        ..
    } = approach;
    sail(approach, boat, sea, |now, _| {
        let side = if ((now.as_s() / 8.0) as u32).is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        Order::Steer {
            heading_rad: heading_rad + side * turn_rad,
            speed_m_s,
        }
    })
}

/// Manoeuvres well inside: heads for a new point every few seconds, at changing speeds, and
/// occasionally astern.
fn play(approach: &Approach, boat: &Boat, sea: &Sea) -> Option<Ended> {
    sail(approach, boat, sea, |now, at| {
        let mut stream = Stream::new(approach.seed + (now.as_s() / 7.0) as u64, "test/play");
        let goal = Ned {
            north: EDGE_M - stream.between(40.0, 90.0),
            east: stream.between(-40.0, 40.0),
        };
        Order::Steer {
            heading_rad: at.bearing_rad(goal),
            speed_m_s: stream.between(-0.5, 2.0),
        }
    })
}

fn sail(
    approach: &Approach,
    boat: &Boat,
    sea: &Sea,
    ordered: impl Fn(SimTime, Ned) -> Order,
) -> Option<Ended> {
    let &Approach {
        speed_m_s,
        heading_rad,
        from_m,
        seed,
        ..
    } = approach;
    let mut gateway = default_gateway();
    (gateway.geofence.margin_m, gateway.limits.thrust_max_pct) = (0.0, 100.0);
    let mut watch = GeofenceWatch::new(&open_field(), &gateway.geofence, Some(Coasting::of(boat)));
    let mut set_points = SetPointMapper::new(&gateway, 0.0);
    let start = Start {
        psi_rad: heading_rad,
        nu: Planar {
            surge: speed_m_s,
            ..Planar::default()
        },
        ..Start::default()
    };
    let mut afloat = TrialBoat::new(boat, sea, TICK, seed, &start);
    let begin = Ned {
        north: EDGE_M - from_m,
        east: 0.0,
    };
    let mut fixes = VecDeque::new();
    let mut farthest_m = f64::NEG_INFINITY;
    let mut command = Command::Hold;
    let mut stopped = None::<(u32, Ned)>;
    for tick in 0.. {
        let sample = afloat.sample(0.0, command);
        let at = begin + sample.at;
        if let Some((since, from)) = stopped {
            if tick >= since + COMMAND_TICKS {
                command = Command::Thrust {
                    port: 0.0,
                    starboard: 0.0,
                };
            }
            farthest_m = farthest_m.max(at.north - EDGE_M);
            if f64::from(tick - since) * TICK.as_s()
                > if sea.is_at_rest() {
                    STILL_S
                } else {
                    DRIFTING_S
                }
            {
                return Some(Ended {
                    crossed_m: farthest_m,
                    went_m: at.distance(from),
                    room_m: EDGE_M - from.north,
                });
            }
        } else if f64::from(tick) * TICK.as_s() > LONGEST_S {
            return None;
        }
        fixes.push_back(nav(&sample));
        if fixes.len() > FIX_TICKS && tick % 2 == 0 && stopped.is_none() {
            let nav = fixes[fixes.len() - 1 - FIX_TICKS];
            let now = TICK * i64::from(tick);
            let order = ordered(now, begin + nav.at());
            let set_point = set_points.map(now, order, &nav);
            watch.note_order(
                now,
                set_points.ordered(order, set_point).ahead_m_s,
                (nav.psi_rad, nav.velocity_m_s()),
            );
            let SetPoint::Thrust {
                thrust_pct,
                difference_pct,
            } = set_point
            else {
                panic!("it is driven by thrust")
            };
            let [port, starboard] =
                [thrust_pct + difference_pct, thrust_pct - difference_pct].map(|pct| pct / 100.0);
            command = Command::Thrust { port, starboard };
            if !watch.is_inside(
                now,
                begin + nav.at(),
                (nav.velocity_m_s(), nav.yaw_rate_rad_s),
            ) {
                stopped = Some((tick, at));
            }
        }
        afloat.step(command);
    }
    None
}

fn seas() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/seas");
    let mut seas: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("there are seas")
        .map(|entry| entry.expect("one").path())
        .collect();
    seas.sort();
    seas
}

fn drawn(i: u64, seas: usize) -> Approach {
    let mut stream = Stream::new(i, "test/approach");
    let speed_m_s = stream.between(0.3, 3.0);
    Approach {
        sea: (i % seas as u64) as usize,
        speed_m_s,
        heading_rad: stream.between(-1.3, 1.3),
        turn_rad: if stream.below(2) == 0 {
            0.0
        } else {
            stream.between(0.0, 0.8)
        },
        from_m: 25.0 + 10.0 * speed_m_s,
        seed: i,
    }
}

/// The number of approaches to run.
fn count() -> u64 {
    std::env::var("SQUALL_APPROACHES").map_or(1000, |text| text.parse().expect("a number"))
}

/// Runs approaches on all cores, and returns their numbers and outcomes.
fn on_all_cores(
    count: u64,
    seas: &[PathBuf],
    run: impl Fn(&Approach, &Boat, &Sea) -> Option<Ended> + Sync,
) -> Vec<(u64, Option<Ended>)> {
    let boat = load_file::<Boat>(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/boats/surveyor_m1_8.toml"),
    )
    .unwrap_or_else(|problems| panic!("{problems}"));
    let workers = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let of_worker = |worker: u64| {
        let mut ended = vec![];
        for i in (worker..count).step_by(workers as usize) {
            let drawn = drawn(i, seas.len());
            let (sea, _) = draw_file::<Sea>(&seas[drawn.sea], i)
                .unwrap_or_else(|problems| panic!("{problems}"));
            ended.push((i, run(&drawn, &boat, &sea)));
        }
        ended
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers)
            .map(|worker| scope.spawn(move || of_worker(worker)))
            .collect();
        threads
            .into_iter()
            .flat_map(|thread| thread.join().expect("no panic"))
            .collect()
    })
}

#[test]
fn no_approach_to_the_geofence_crosses_it() {
    let count = count();
    let seas = seas();
    let ended = on_all_cores(count, &seas, approach);
    let mut by_sea: BTreeMap<usize, (u32, u32, f64, f64)> = BTreeMap::new();
    let mut crossings = vec![];
    for (i, end) in &ended {
        let drawn = drawn(*i, seas.len());
        let (stopped, crossed, nearest_m, farthest_m) =
            by_sea.entry(drawn.sea).or_insert((0, 0, f64::MIN, 0.0));
        let Some(Ended {
            crossed_m, went_m, ..
        }) = end
        else {
            continue;
        };
        *stopped += 1;
        (*nearest_m, *farthest_m) = (nearest_m.max(*crossed_m), farthest_m.max(*went_m));
        if *crossed_m > 0.0 {
            *crossed += 1;
            let Approach {
                speed_m_s,
                heading_rad,
                turn_rad,
                ..
            } = drawn;
            let sea = seas[drawn.sea]
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy();
            crossings.push(format!(
                "{crossed_m:.2} m: {i}, {sea}: {speed_m_s:.2} m/s, heading {heading_rad:.2} rad, turn {turn_rad:.2} rad"
            ));
        }
    }
    for (sea, (stopped, crossed, nearest_m, farthest_m)) in by_sea {
        let sea = seas[sea].file_stem().unwrap_or_default().to_string_lossy();
        println!(
            "{sea:20} {stopped:6} stopped, {crossed} crossed, {nearest_m:.1} m from the edge at rest, {farthest_m:.1} m to rest"
        );
    }
    assert!(
        crossings.is_empty(),
        "{} of {count} crossed:\n{}",
        crossings.len(),
        crossings[..crossings.len().min(20)].join("\n")
    );
}

#[test]
fn boats_that_play_well_inside_are_hardly_ever_stopped() {
    let seas: Vec<PathBuf> = seas()
        .into_iter()
        .filter(|sea| !sea.to_string_lossy().ends_with("gale.toml"))
        .collect();
    let inside = |drawn: &Approach, boat: &Boat, sea: &Sea| {
        let drawn = Approach {
            from_m: 60.0,
            ..*drawn
        };
        play(&drawn, boat, sea)
    };
    let ended = on_all_cores(count() / 4, &seas, inside);
    let stopped: Vec<String> = ended
        .iter()
        .filter_map(|(i, end)| {
            let Ended { room_m, .. } = end.as_ref()?;
            let sea = seas[drawn(*i, seas.len()).sea]
                .file_stem()?
                .to_string_lossy();
            (*room_m > ROOM_M).then(|| format!("{i}, {sea}: {room_m:.1} m from the edge"))
        })
        .collect();
    println!("{} of {} stopped", stopped.len(), ended.len());
    assert!(
        stopped.len() * 50 <= ended.len(),
        "more than 2 %:\n{}",
        stopped.join("\n")
    );
}
