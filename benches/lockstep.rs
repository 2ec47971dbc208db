//! Compares the rate of lockstep ticks across processes with that of a bare zenoh ping with
//! messages of the same sizes, in the same run.
//!
//! The ping measures the cost of transport alone: a hub publishes one message per team to N leaf
//! processes and waits until each has answered. Topology and message sizes are the same, but there
//! is no game. The cases alternate, so that both see the same machine. The benchmark prints
//! medians, the cost of keys (TLS and access rules by certificate), and the rate of the same game
//! in one process. Boats with the strategy *idle* stay still, so that only the cost of the game's
//! messages remains.
#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a benchmark reads the clock and prints"
)]

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use zenoh::{Config, Session, Wait};

/// Runs of each case.
const ROUNDS: usize = 5;
const RUN_S: f64 = 2.0;

struct Case {
    processes: usize,
    vehicles: usize,
    strategy: &'static str,
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    if let Some(at) = args.iter().position(|arg| arg == "--echo") {
        return echo(
            &args[at + 1],
            args[at + 2].parse().expect("a size"),
            &args[at + 3],
        );
    }
    // `cargo test --benches` runs this with `--test`: there is nothing to check.
    if !args.iter().any(|arg| arg == "--bench") {
        return;
    }
    if std::env::var_os(bus::RUNTIME_VARIABLE).is_none() {
        // The bare hub must use the same zenoh threads as the sim.
        let mut again = Command::new(std::env::current_exe().expect("the path of this program"));
        let status = again
            .args(&args[1..])
            .env(bus::RUNTIME_VARIABLE, bus::RUNTIME)
            .status()
            .expect("this program starts again");
        std::process::exit(status.code().unwrap_or(1));
    }
    println!("lockstep over zenoh, median of {ROUNDS} runs of {RUN_S} s each");
    println!(
        "| agent processes | vehicles | strategy | ticks/s | bare zenoh/s | time over bare | with keys, ticks/s | time over \
         without keys | in one process, ticks/s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let keys = tempfile::tempdir().expect("a temporary directory");
    let parts = ["sim", "team-blue", "team-red"].map(|part| part.parse().expect("a part"));
    let hosts = ["127.0.0.1".to_owned()];
    bus::keys::make(keys.path(), &parts, &hosts, Duration::from_secs(3600)).expect("keys");
    let with_keys = ["--keys", keys.path().to_str().expect("UTF-8")];
    for case in [
        Case {
            processes: 4,
            vehicles: 4,
            strategy: "pav01",
        },
        Case {
            processes: 16,
            vehicles: 16,
            strategy: "pav01",
        },
        Case {
            processes: 64,
            vehicles: 64,
            strategy: "pav01",
        },
        Case {
            processes: 4,
            vehicles: 64,
            strategy: "idle",
        },
        Case {
            processes: 4,
            vehicles: 64,
            strategy: "pav01",
        },
    ] {
        let each = (case.vehicles / case.processes).to_string();
        let apart = ["--agents-per-process", &each];
        let round = |_| {
            let keyed = squall(&case, &[&apart[..], &with_keys].concat());
            [
                squall(&case, &apart),
                bare(&case),
                keyed,
                squall(&case, &["--in-process"]),
            ]
        };
        let rounds: Vec<[f64; 4]> = (0..ROUNDS).map(round).collect();
        let over_bare = median(rounds.iter().map(|r| r[1] / r[0]));
        let for_keys = median(rounds.iter().map(|r| r[0] / r[2]));
        let [ticks, pings, keyed, alone] =
            [0, 1, 2, 3].map(|i| median(rounds.iter().map(|r| r[i])));
        let Case {
            processes,
            vehicles,
            strategy,
        } = case;
        println!(
            "| {processes} | {vehicles} | {strategy} | {ticks:.0} | {pings:.0} | {over_bare:.2} | {keyed:.0} | {for_keys:.2} | \
             {alone:.0} |"
        );
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Decisions per second of a game with this many boats, played by `squall run` with these options.
fn squall(case: &Case, options: &[&str]) -> f64 {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let dir = tempfile::tempdir().expect("a temporary directory");
    let game = dir.path().join("bench.toml");
    let json = dir.path().join("result.json");
    let fleet = |team: &str| {
        format!(
            "[[fleet]]\nteam = \"{team}\"\nname = \"{team}_{{}}\"\ncount = {}\nspawn = {{}}\n",
            case.vehicles / 2
        )
    };
    let team = |team: &str| {
        format!(
            "[[team]]\nname = \"{team}\"\nstrategy = \"{}/strategies/{}.toml\"\n",
            root.display(),
            case.strategy
        )
    };
    let text = |duration_s: f64| {
        format!(
            "field = \"{0}/fields/open_800x400.toml\"\nrules = \"{0}/rules/aquaticus_2023.toml\"\n\
             boat = \"{0}/boats/surveyor_m1_8.toml\"\nduration_s = {duration_s}\n{1}{2}{3}{4}",
            root.display(),
            team("blue"),
            team("red"),
            fleet("blue"),
            fleet("red")
        )
    };
    // A short first game determines the length of a game of about two seconds.
    let mut duration_s = 40.0;
    loop {
        std::fs::write(&game, text(duration_s)).expect("a file");
        let mut command = Command::new(env!("CARGO_BIN_EXE_squall"));
        command.args([
            "run",
            &game.display().to_string(),
            "--no-record",
            "--json",
            &json.display().to_string(),
        ]);
        command.args(options);
        let output = command.output().expect("squall runs");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let result = std::fs::read_to_string(&json).expect("a result");
        let result: serde_json::Value = serde_json::from_str(&result).expect("JSON");
        let wall_s = result["run"]["wall_s"].as_f64().expect("a number");
        if wall_s > 0.5 * RUN_S {
            return duration_s / 0.1 / wall_s;
        }
        duration_s = (duration_s * RUN_S / wall_s).min(80_000.0);
    }
}

/// The sizes of a picture and of one process's orders in such a game (bytes).
fn sizes(case: &Case) -> (usize, usize) {
    use messages::{Order, Orders, VehicleOrder};
    use primitives::VehicleId;
    use primitives::codec::encode;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut scenario = scenario::load(&root.join("games/swarm_20v20.toml")).expect("a game");
    let spare = scenario.vehicles.clone();
    let own = spare
        .iter()
        .filter(|v| v.team.0 == 0)
        .cycle()
        .take(case.vehicles / 2)
        .cloned();
    let others = spare
        .iter()
        .filter(|v| v.team.0 == 1)
        .cycle()
        .take(case.vehicles / 2)
        .cloned();
    scenario.vehicles = own.chain(others).collect();
    for (i, vehicle) in scenario.vehicles.iter_mut().enumerate() {
        let at = primitives::Ned {
            north: i as f64 * 8.0,
            east: 0.0,
        };
        vehicle.start_position = scenario::StartPosition::At(primitives::Pose { at, psi_rad: 0.0 });
    }
    let mut contest = sim::Contest::new(&scenario, 1).expect("the start positions are given");
    let picture = encode(&contest.pictures()[0]).len();
    let mine = (0..case.vehicles / case.processes)
        .map(|i| VehicleOrder::new(VehicleId(i as u16), Order::Hold));
    let orders = encode(&Orders {
        orders: mine.collect(),
        ..Orders::default()
    })
    .len();
    (picture, orders)
}

fn open(mode: &str, key: &str, endpoint: &str) -> Session {
    let mut config = Config::default();
    for (key, value) in [
        ("mode", format!("\"{mode}\"")),
        (key, format!("[\"{endpoint}\"]")),
        ("scouting/multicast/enabled", "false".to_owned()),
        ("scouting/gossip/enabled", "false".to_owned()),
        ("timestamping/enabled", "false".to_owned()),
    ] {
        config.insert_json5(key, &value).expect("a setting");
    }
    zenoh::open(config).wait().expect("a session")
}

/// A leaf process of the bare ping: answers every message to its team.
fn echo(endpoint: &str, size: usize, name: &str) {
    let session = open("client", "connect/endpoints", endpoint);
    let back = session
        .declare_publisher(format!("bare/back/{name}"))
        .congestion_control(zenoh::qos::CongestionControl::Block)
        .wait()
        .expect("a publisher");
    let team = if name.ends_with(['0', '2', '4', '6', '8']) {
        0
    } else {
        1
    };
    let (sender, receiver) = channel();
    let _subscriber = session
        .declare_subscriber(format!("bare/out/{team}"))
        .callback(move |sample| {
            sender
                .send(sample.payload().to_bytes().len())
                .unwrap_or_default()
        })
        .wait()
        .expect("a subscriber");
    let _token = session
        .liveliness()
        .declare_token(format!("bare/alive/{name}"))
        .wait()
        .expect("a token");
    // A message of one byte ends the run.
    while receiver
        .recv_timeout(Duration::from_secs(20))
        .is_ok_and(|bytes| bytes > 1)
    {
        back.put(vec![0_u8; size]).wait().expect("a session");
    }
}

/// Rounds per second of the bare ping. The hub is a separate process, as the sim is.
fn bare(case: &Case) -> f64 {
    let (out_size, back_size) = sizes(case);
    let port = bus::free_port(false).expect("a port");
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let session = open("router", "listen/endpoints", &endpoint);
    let (sender, receiver) = channel();
    let _subscriber = session
        .declare_subscriber("bare/back/*")
        .callback(move |sample| {
            sender
                .send(sample.payload().to_bytes().len())
                .unwrap_or_default()
        })
        .wait()
        .expect("a subscriber");
    let out = [0, 1].map(|team| {
        session
            .declare_publisher(format!("bare/out/{team}"))
            .congestion_control(zenoh::qos::CongestionControl::Block)
            .wait()
            .expect("a publisher")
    });
    let mut leaves: Vec<Child> = (0..case.processes)
        .map(|i| start_leaf(&endpoint, back_size, i))
        .collect();
    let alive = || {
        session
            .liveliness()
            .get("bare/alive/*")
            .wait()
            .expect("a session")
            .into_iter()
            .count()
    };
    while alive() < case.processes {
        std::thread::sleep(Duration::from_millis(10));
    }
    let start = Instant::now();
    let mut rounds = 0;
    while start.elapsed().as_secs_f64() < RUN_S {
        for publisher in &out {
            publisher
                .put(vec![0_u8; out_size])
                .wait()
                .expect("a session");
        }
        for _ in 0..case.processes {
            receiver
                .recv_timeout(Duration::from_secs(10))
                .expect("every leaf answers");
        }
        rounds += 1;
    }
    let rate = f64::from(rounds) / start.elapsed().as_secs_f64();
    out.iter()
        .for_each(|publisher| publisher.put(vec![0_u8]).wait().expect("a session"));
    leaves.iter_mut().for_each(|leaf| drop(leaf.wait()));
    rate
}

fn start_leaf(endpoint: &str, size: usize, i: usize) -> Child {
    let mut command = Command::new(std::env::current_exe().expect("the path of this program"));
    command.args(["--echo", endpoint, &size.to_string(), &format!("leaf{i}")]);
    command
        .env(bus::RUNTIME_VARIABLE, bus::RUNTIME)
        .stdout(Stdio::null());
    command.spawn().expect("a leaf starts")
}
