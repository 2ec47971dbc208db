//! Tests how well the mandatory behaviours keep random strategies safe: how often boats leave the
//! field, and how often hulls touch.
//!
//! Run `cargo run --release -p squall-arena --example safety -- [GAMES] [SEA] [DURATION_S] [BOAT] [TRACKED_SEED]`.
//! The default is 10,000 games of 120 s in calm water between boats of the kind `surveyor_m1_8`. With
//! the seed of a game, it plays only that game and prints the track of every boat before it leaves
//! the field or touches another. Every boat has a random strategy over `safety.toml`: places on the
//! field and up to 20 m beyond it, pursuits, stations, headings, at any speed. Equal seeds give equal
//! games.

use agent::MindRunner;
use analysis::HullRectangle;
use messages::Order;
use primitives::VehicleId;
use primitives::angle::compass_deg_from_rad;
use primitives::stream::Stream;
use rules::Event;
use rules::event::EventCursor;
use scenario::Scenario;
use scenario::outcome::Outcome;
use sim::Contest;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts over all games.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    games: u64,
    boat_hours: f64,
    /// Times a boat left the field.
    left: u64,
    /// Of those, within five seconds after hulls touched.
    left_pushed: u64,
    /// Of those that were not pushed, by a boat within 15 m of another: it gave way, or chased.
    left_crowded: u64,
    games_left: u64,
    /// Times two hulls started to touch.
    touched: u64,
    games_touched: u64,
    /// Times two boats came within the collision distance of the rules.
    collided: u64,
}

impl Tally {
    fn add(&mut self, other: Tally) {
        self.games += other.games;
        self.boat_hours += other.boat_hours;
        self.left += other.left;
        self.left_pushed += other.left_pushed;
        self.left_crowded += other.left_crowded;
        self.games_left += other.games_left;
        self.touched += other.touched;
        self.games_touched += other.games_touched;
        self.collided += other.collided;
    }
}

/// A boat that leaves the field later than this after hulls touched was not pushed out, s.
const PUSH_REMEMBERED_S: f64 = 5.0;
/// Boats closer than this make each other give way, m.
const CROWD_M: f64 = 15.0;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: u64| args.get(i).and_then(|arg| arg.parse().ok()).unwrap_or(default);
    let (games, duration_s) = (number(0, 10_000), number(2, 120));
    let sea = args.get(1).map_or("calm", String::as_str);
    let boat = args.get(3).map_or("surveyor_m1_8", String::as_str);
    if let Some(seed) = args.get(4).and_then(|arg| arg.parse().ok()) {
        let folder = tempfile::tempdir().expect("a folder for strategies");
        play(&scenario(folder.path(), (sea, boat), duration_s, seed), seed, &mut Tracks::shown());
        return;
    }
    let next = AtomicU64::new(1);
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let mut total = Tally::default();
    std::thread::scope(|scope| {
        let work = || {
            let folder = tempfile::tempdir().expect("a folder for strategies");
            let mut tally = Tally::default();
            loop {
                let seed = next.fetch_add(1, Ordering::Relaxed);
                if seed > games {
                    return tally;
                }
                tally.add(play(&scenario(folder.path(), (sea, boat), duration_s, seed), seed, &mut Tracks::default()));
            }
        };
        let workers: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            total.add(worker.join().expect("a worker ends"));
        }
    });
    print_summary(&total, (sea, boat), duration_s);
}

#[expect(clippy::print_stdout, reason = "this is a program")]
fn print_summary(total: &Tally, (sea, boat): (&str, &str), duration_s: u64) {
    let share = |n: u64| 100.0 * n as f64 / total.games as f64;
    let hourly = |n: u64| n as f64 / total.boat_hours;
    println!("{} games of {duration_s} s, sea {sea}, {boat}, {:.0} boat-hours", total.games, total.boat_hours);
    println!(
        "left the field: {} times, {:.3} a boat-hour, in {:.2} % of games",
        total.left,
        hourly(total.left),
        share(total.games_left)
    );
    println!("  pushed (hulls touched within {PUSH_REMEMBERED_S} s): {}", total.left_pushed);
    println!("  with another boat within {CROWD_M} m: {}", total.left_crowded);
    println!("  neither: {}", total.left - total.left_pushed - total.left_crowded);
    println!(
        "hulls touched: {} times, {:.3} a boat-hour, in {:.2} % of games",
        total.touched,
        hourly(total.touched),
        share(total.games_touched)
    );
    println!(
        "nearer than the rules' collision distance: {} times, {:.3} a boat-hour",
        total.collided,
        hourly(total.collided)
    );
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
        write(folder.join(format!("{team}.toml")), &format!("about = \"Random\"\nroles = {roles:?}\n"));
        game += &format!("[[team]]\nname = \"{team}\"\nstrategy = \"{team}.toml\"\n");
    }
    write(folder.join("game.toml"), &game);
    scenario::load(&folder.join("game.toml")).unwrap_or_else(|e| panic!("seed {seed}: {e}"))
}

fn write(path: PathBuf, text: &str) {
    std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

/// A random program: one to three behaviours over the mandatory ones.
fn program(scenarios: &Path, stream: &mut Stream) -> String {
    let mut text = format!("base = \"{}/strategies/safety.toml\"\nabout = \"Random\"\n", scenarios.display());
    let count = 1 + stream.below(3);
    for i in 0..count {
        let weight = stream.between(20.0, 100.0);
        text += &format!("[behaviour.b{i}]\nweight = {weight:.1}\n");
        text += &behaviour(stream);
        // The first one is always active.
        if i > 0 {
            let conditions =
                ["enemy_in_zone", "own_side", "time_s > 60", "has_flag", "!tagged", "distance(nearest_enemy) < 30"];
            text += &format!("when = \"{}\"\n", conditions[stream.below(conditions.len() as u64) as usize]);
        }
    }
    text
}

fn behaviour(stream: &mut Stream) -> String {
    let speed_m_s = stream.between(0.5, 5.0);
    // The field is 160 m by 80 m from its corner at the datum.
    let place =
        |stream: &mut Stream| format!("[{:.1}, {:.1}]", stream.between(-20.0, 180.0), stream.between(-20.0, 100.0));
    let boats = ["nearest_enemy", "opponent", "nearest_attacker", "nearest_mate"];
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
            let (centre, along, across) = (place(stream), stream.between(10.0, 120.0), stream.between(10.0, 80.0));
            format!(
                "kind = \"loiter\"\nellipse = {{ centre = {centre}, along_m = {along:.1}, across_m = {across:.1} }}\nspeed_m_s = {speed_m_s:.2}\n"
            )
        }
        3 => format!("kind = \"cut_range\"\ncontact = \"{boat}\"\npatience = {:.0}\n", stream.between(0.0, 100.0)),
        4 => format!("kind = \"intercept\"\ncontact = \"{boat}\"\nspeed_m_s = {speed_m_s:.2}\n"),
        5 => format!("kind = \"station_keep\"\nat = {}\ntransit_speed_m_s = {speed_m_s:.2}\n", place(stream)),
        _ => format!("kind = \"attractor\"\nto = {}\nouter_m = 300\nspeed_m_s = {speed_m_s:.2}\n", place(stream)),
    }
}

/// The last seconds of every boat, to show why it left.
#[derive(Default)]
struct Tracks {
    shown: bool,
    /// Lines by boat, newest last.
    lines: Vec<VecDeque<String>>,
}

impl Tracks {
    /// Number of decisions kept.
    const COUNT: usize = 120;
    /// Every nth decision is printed.
    const EVERY: usize = 5;

    fn shown() -> Tracks {
        Tracks { shown: true, ..Tracks::default() }
    }

    fn note(&mut self, contest: &Contest, runner: &MindRunner) {
        if !self.shown {
            return;
        }
        let scenario = contest.scenario();
        self.lines.resize(scenario.vehicles.len(), VecDeque::new());
        for (i, lines) in self.lines.iter_mut().enumerate() {
            let vehicle = VehicleId::at(i);
            let boat = &contest.world().state().boats[i];
            let (x, y) = scenario.field.along_across(boat.pose.at);
            let order = match contest.effective_command(vehicle) {
                Order::Steer { heading_rad, speed_m_s } => {
                    format!("{:4.0} deg {speed_m_s:4.2} m/s", compass_deg_from_rad(heading_rad))
                }
                other => format!("{other:?}"),
            };
            let report = runner.mind(vehicle).and_then(|mind| mind.report());
            let functions = report.map(|report| report.functions).unwrap_or_default();
            let weighed: Vec<String> = functions.iter().map(|f| format!("{} {:.0}", f.behaviour, f.weight)).collect();
            let line = format!(
                "{:6.1} s boat {i} at {x:6.1} {y:6.1} m, heads {:4.0} deg, {:5.2} ahead {:5.2} starboard {:5.2} rad/s; thrust {:4.0} {:4.0} N; ordered {order}; {}",
                contest.now().as_s(),
                compass_deg_from_rad(boat.pose.psi_rad),
                boat.nu.surge,
                boat.nu.sway,
                boat.nu.yaw,
                boat.port.newton,
                boat.starboard.newton,
                weighed.join(", ")
            );
            lines.push_back(line);
            if lines.len() > Tracks::COUNT {
                lines.pop_front();
            }
        }
    }

    #[expect(clippy::print_stdout, reason = "this is a program")]
    fn print(&self, i: usize, what: &str) {
        let Some(lines) = self.lines.get(i) else { return };
        println!("boat {i} {what}");
        lines
            .iter()
            .rev()
            .step_by(Tracks::EVERY)
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
            .for_each(|line| println!("{line}"));
    }
}

/// Plays a game and counts its events.
fn play(scenario: &Scenario, seed: u64, tracks: &mut Tracks) -> Tally {
    let mut contest = Contest::new(scenario, seed).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
    let scenario = contest.scenario().clone();
    let mut runner = arena::runner_of(agent::minds_of(&scenario));
    let count = scenario.vehicles.len();
    let (mut touching, mut touched_s) = (vec![false; count * count], vec![f64::NEG_INFINITY; count]);
    let mut tally = Tally { games: 1, ..Tally::default() };
    let mut cursor = EventCursor::default();
    while !contest.is_over() {
        arena::decide(&mut contest, &mut runner);
        tracks.note(&contest, &runner);
        contest.advance();
        let now_s = contest.now().as_s();
        let pose = |i: usize| contest.world().state().boats[i].pose;
        for a in 0..count {
            for b in a + 1..count {
                let (one, other) = (VehicleId::at(a), VehicleId::at(b));
                let hull = |vehicle: VehicleId| {
                    let boat = scenario.boat_of(vehicle);
                    HullRectangle { pose: pose(vehicle.index()), length_m: boat.length_m, beam_m: boat.beam_m }
                };
                let touch = hull(one).overlaps(&hull(other));
                if touch && !touching[a * count + b] {
                    tally.touched += 1;
                    tracks.print(a, "touches");
                    tracks.print(b, "touches");
                }
                touching[a * count + b] = touch;
                if touch {
                    (touched_s[a], touched_s[b]) = (now_s, now_s);
                }
            }
        }
        for logged in cursor.read(contest.events()) {
            if let Event::LeftField(vehicle) = logged.event {
                let i = vehicle.index();
                tally.left += 1;
                tracks.print(i, "leaves the field");
                let crowded = (0..count).any(|j| j != i && pose(i).at.distance(pose(j).at) < CROWD_M);
                if now_s - touched_s[i] <= PUSH_REMEMBERED_S {
                    tally.left_pushed += 1;
                } else if crowded {
                    tally.left_crowded += 1;
                }
            }
        }
    }
    let outcome: Outcome = contest.outcome();
    tally.collided = outcome.events.iter().filter(|event| event.event == "collided").count() as u64;
    tally.boat_hours = outcome.duration_s * count as f64 / 3600.0;
    tally.games_left = u64::from(tally.left > 0);
    tally.games_touched = u64::from(tally.touched > 0);
    tally
}
