//! Tests how well the mandatory behaviours keep random strategies safe: how often boats leave the
//! field, and how often hulls touch.
//!
//! Run `cargo run --release -p squall-arena --example safety -- [GAMES] [SEA] [DURATION_S] [BOAT]
//! [SEED]`. The default is 10,000 games of 120 s in calm water between boats from the file
//! `surveyor_m1_8`. With the seed of a game, it only writes the files of that game, for `squall
//! run`, which records and shows it. Every boat has a random strategy on top of `safety.toml`:
//! places on the field and up to 20 m beyond it, pursuits, stations and headings, at any speed.
//! Equal seeds give equal games.

use analysis::HullRectangle;
use primitives::VehicleId;
use primitives::stream::Stream;
use rules::Event;
use rules::event::EventCursor;
use scenario::Scenario;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts of one game.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    boat_hours: f64,
    /// Times a boat left the field.
    left: usize,
    /// Of those, within five seconds after hulls touched.
    left_pushed: usize,
    /// Of those not pushed out, times that the boat was within 15 m of another, and so may have
    /// been giving way or chasing.
    left_crowded: usize,
    /// Times two hulls came into contact.
    touched: usize,
    /// Times two boats came within the collision distance of the rules.
    collided: usize,
}

/// Time after a hull contact during which a boat that leaves the field counts as pushed out, s.
const PUSH_REMEMBERED_S: f64 = 5.0;
/// Distance to another boat below which a boat counts as crowded, m.
const CROWD_M: f64 = 15.0;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: u64| {
        args.get(i)
            .and_then(|arg| arg.parse().ok())
            .unwrap_or(default)
    };
    let games = number(0, 10_000);
    let duration_s = number(2, 120);
    let sea = args.get(1).map_or("calm", String::as_str);
    let boat = args.get(3).map_or("surveyor_m1_8", String::as_str);
    if let Some(seed) = args.get(4).and_then(|arg| arg.parse().ok()) {
        let folder = PathBuf::from(format!("runs/safety/{seed}"));
        std::fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        scenario(&folder, (sea, boat), duration_s, seed);
        print(&format!(
            "squall run {}/game.toml --seed {seed}",
            folder.display()
        ));
        return;
    }
    let next = AtomicU64::new(1);
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let mut tallies = Vec::new();
    std::thread::scope(|scope| {
        let work = || {
            let folder = tempfile::tempdir().expect("a folder for strategies");
            let seeds = std::iter::from_fn(|| Some(next.fetch_add(1, Ordering::Relaxed)));
            let seeds = seeds.take_while(|seed| *seed <= games);
            seeds
                .map(|seed| {
                    play(
                        &scenario(folder.path(), (sea, boat), duration_s, seed),
                        seed,
                    )
                })
                .collect::<Vec<_>>()
        };
        let workers: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            tallies.extend(worker.join().expect("a worker ends"));
        }
    });
    print(&summary(&tallies, (sea, boat), duration_s));
}

#[expect(clippy::print_stdout, reason = "this is a program")]
fn print(text: &str) {
    println!("{text}");
}

fn summary(tallies: &[Tally], (sea, boat): (&str, &str), duration_s: u64) -> String {
    let sum = |count: fn(&Tally) -> usize| tallies.iter().map(count).sum::<usize>();
    let boat_hours: f64 = tallies.iter().map(|tally| tally.boat_hours).sum();
    let often = |total: usize| {
        format!(
            "{total} times, {:.3} a boat-hour",
            total as f64 / boat_hours
        )
    };
    let in_games = |count: fn(&Tally) -> usize| {
        let games = tallies.iter().filter(|tally| count(tally) > 0).count();
        format!(
            "in {:.2} % of games",
            100.0 * games as f64 / tallies.len() as f64
        )
    };
    let left = sum(|t| t.left);
    let pushed = sum(|t| t.left_pushed);
    let crowded = sum(|t| t.left_crowded);
    [
        format!(
            "{} games of {duration_s} s, sea {sea}, {boat}, {boat_hours:.0} boat-hours",
            tallies.len()
        ),
        format!("left the field: {}, {}", often(left), in_games(|t| t.left)),
        format!("  pushed (hulls touched within {PUSH_REMEMBERED_S} s): {pushed}"),
        format!("  with another boat within {CROWD_M} m: {crowded}"),
        format!("  neither: {}", left - pushed - crowded),
        format!(
            "hulls touched: {}, {}",
            often(sum(|t| t.touched)),
            in_games(|t| t.touched)
        ),
        format!(
            "nearer than the rules' collision distance: {}",
            often(sum(|t| t.collided))
        ),
    ]
    .join("\n")
}

/// A game between random strategies.
fn scenario(folder: &Path, (sea, boat): (&str, &str), duration_s: u64, seed: u64) -> Scenario {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut stream = Stream::new(seed, "safety");
    let mut game = format!(
        "base = \"{0}/games/surveyor_2v2.toml\"\nsea = \"{0}/seas/{sea}.toml\"\nboat = \"{0}/boats/{boat}.toml\"\nduration_s = {duration_s}\n",
        scenarios.display()
    );
    for team in ["blue", "red"] {
        let roles: Vec<String> = (0..2).map(|i| format!("{team}_{i}.toml")).collect();
        for role in &roles {
            write(folder.join(role), &program(&scenarios, &mut stream));
        }
        write(
            folder.join(format!("{team}.toml")),
            &format!("about = \"Random\"\nroles = {roles:?}\n"),
        );
        game += &format!("[[team]]\nname = \"{team}\"\nstrategy = \"{team}.toml\"\n");
    }
    write(folder.join("game.toml"), &game);
    scenario::load(&folder.join("game.toml")).unwrap_or_else(|e| panic!("seed {seed}: {e}"))
}

fn write(path: PathBuf, text: &str) {
    std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

/// A random program: one to three behaviours on top of the mandatory ones.
fn program(scenarios: &Path, stream: &mut Stream) -> String {
    let mut text = format!(
        "base = \"{}/strategies/safety.toml\"\nabout = \"Random\"\n",
        scenarios.display()
    );
    let count = 1 + stream.below(3);
    for i in 0..count {
        let weight = stream.between(20.0, 100.0);
        text += &format!("[behaviour.b{i}]\nweight = {weight:.1}\n");
        text += &behaviour(stream);
        // The first behaviour is always active.
        if i > 0 {
            let conditions = [
                "enemy_in_zone",
                "own_side",
                "time_s > 60",
                "has_flag",
                "!tagged",
                "distance(nearest_enemy) < 30",
            ];
            text += &format!(
                "when = \"{}\"\n",
                conditions[stream.below(conditions.len() as u64) as usize]
            );
        }
    }
    text
}

fn behaviour(stream: &mut Stream) -> String {
    let speed_m_s = stream.between(0.5, 5.0);
    // The field is 160 m by 80 m from its corner at the datum.
    let place = |stream: &mut Stream| {
        format!(
            "[{:.1}, {:.1}]",
            stream.between(-20.0, 180.0),
            stream.between(-20.0, 100.0)
        )
    };
    let boats = [
        "nearest_enemy",
        "opponent",
        "nearest_attacker",
        "nearest_mate",
    ];
    let boat = boats[stream.below(boats.len() as u64) as usize];
    match stream.below(7) {
        0 => {
            let points: Vec<String> = (0..=stream.below(4)).map(|_| place(stream)).collect();
            format!(
                "kind = \"waypoint\"\npoints = [{}]\nspeed_m_s = {speed_m_s:.2}\nperpetual = true\n",
                points.join(", ")
            )
        }
        1 => format!(
            "kind = \"waypoint\"\npoints = [\"enemy_flag\", \"own_flag\"]\nspeed_m_s = {speed_m_s:.2}\nperpetual = true\n"
        ),
        2 => {
            let centre = place(stream);
            let along = stream.between(10.0, 120.0);
            let across = stream.between(10.0, 80.0);
            format!(
                "kind = \"loiter\"\nellipse = {{ centre = {centre}, along_m = {along:.1}, across_m = {across:.1} }}\nspeed_m_s = {speed_m_s:.2}\n"
            )
        }
        3 => format!(
            "kind = \"cut_range\"\ncontact = \"{boat}\"\npatience = {:.0}\n",
            stream.between(0.0, 100.0)
        ),
        4 => format!("kind = \"intercept\"\ncontact = \"{boat}\"\nspeed_m_s = {speed_m_s:.2}\n"),
        5 => format!(
            "kind = \"station_keep\"\nat = {}\ntransit_speed_m_s = {speed_m_s:.2}\n",
            place(stream)
        ),
        _ => format!(
            "kind = \"attractor\"\nto = {}\nouter_m = 300\nspeed_m_s = {speed_m_s:.2}\n",
            place(stream)
        ),
    }
}

/// Plays a game and counts its events.
fn play(scenario: &Scenario, seed: u64) -> Tally {
    let count = scenario.vehicles.len();
    let mut touching = vec![false; count * count];
    let mut touched_s = vec![f64::NEG_INFINITY; count];
    let mut tally = Tally::default();
    let mut cursor = EventCursor::default();
    let outcome = arena::play_watched(scenario, agent::minds_of(scenario), seed, |contest| {
        let now_s = contest.now().as_s();
        let pose = |i: usize| contest.world().state().boats[i].pose;
        let hull = |i: usize| {
            let boat = scenario.boat_of(VehicleId::at(i));
            HullRectangle {
                pose: pose(i),
                length_m: boat.length_m,
                beam_m: boat.beam_m,
            }
        };
        for (a, b) in (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))) {
            let touch = hull(a).overlaps(&hull(b));
            tally.touched += usize::from(touch && !touching[a * count + b]);
            touching[a * count + b] = touch;
            if touch {
                (touched_s[a], touched_s[b]) = (now_s, now_s);
            }
        }
        for logged in cursor.read(contest.events()) {
            if let Event::LeftField(vehicle) = logged.event {
                let i = vehicle.index();
                tally.left += 1;
                let crowded =
                    (0..count).any(|j| j != i && pose(i).at.distance(pose(j).at) < CROWD_M);
                if now_s - touched_s[i] <= PUSH_REMEMBERED_S {
                    tally.left_pushed += 1;
                } else if crowded {
                    tally.left_crowded += 1;
                }
            }
        }
        true
    });
    let outcome = outcome.unwrap_or_else(|e| panic!("seed {seed}: {e}"));
    tally.collided = outcome
        .events
        .iter()
        .filter(|event| event.event == "collided")
        .count();
    tally.boat_hours = outcome.duration_s * count as f64 / 3600.0;
    tally
}
