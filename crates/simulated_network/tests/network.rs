//! Tests the simulated network itself: time, order, faults, and reproducibility from the seed.

use bus::{Bus, Net, Priority, Watched, clock, inbox};
use messages::topic::GameName;
use parking_lot::Mutex;
use scenario::Scenario;
use simulated_network::{Conditions, Damage, Fault, Run, SimulatedNetwork, Verdict};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

const DELAY: Duration = Duration::from_millis(10);
const LIMIT: Duration = Duration::from_secs(7200);
const KEY: &str = "game/test/number";
const TOKEN: &str = "game/test/alive/agent/a";

fn conditions() -> Conditions {
    Conditions {
        delay: DELAY,
        jitter: Duration::from_millis(30),
        loss: 0.0,
        damaged: (0.0, Damage::Noise),
        lease: Duration::from_secs(10),
        retry: Duration::from_secs(1),
        queue: 1000,
        pause: Duration::ZERO,
    }
}

fn net() -> Net {
    let endpoint = vec!["tcp/127.0.0.1:1".to_owned()];
    Net {
        listen: endpoint.clone(),
        connect: endpoint,
        ..Net::default()
    }
}

fn scenario() -> Scenario {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
    scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

/// Observations of a node in order, each with its virtual time in s.
type Log = Arc<Mutex<Vec<(f64, String)>>>;

/// A hub that listens for `time` and logs numbers and tokens.
fn add_hub(network: &SimulatedNetwork, time: Duration, log: &Log) -> usize {
    let log = Arc::clone(log);
    network.node(Duration::ZERO, "hub", move || {
        let start = clock::now();
        let note = move |log: &Log, text: String| {
            log.lock().push((clock::since(start).as_secs_f64(), text))
        };
        let bus = Bus::hub(&net(), &GameName::new("test").expect("a name"), &scenario())
            .expect("the address is free");
        let numbers = Arc::clone(&log);
        let tokens = Arc::clone(&log);
        let heard = bus.subscribe(KEY.to_owned(), move |bytes| {
            note(&numbers, String::from_utf8_lossy(bytes).into_owned())
        });
        let seen = bus.watch_alive("game/*/alive/**".to_owned(), move |_, there| {
            note(&tokens, format!("there: {there}"))
        });
        let _kept = (
            heard.expect("open"),
            seen.expect("open"),
            bus.show_alive("game/test/alive/sim/s".to_owned()),
        );
        clock::rest(time);
        bus.close();
    })
}

/// A leaf that declares a token and publishes a number every `every`.
fn add_leaf(network: &SimulatedNetwork, numbers: u32, every: Duration) -> usize {
    network.node(Duration::from_millis(1), "leaf", move || {
        let bus = Bus::leaf(&net()).expect("the hub is up");
        let _token = bus.show_alive(TOKEN.to_owned()).expect("open");
        let publisher = bus
            .publisher(KEY.to_owned(), Priority::Normal)
            .expect("open");
        for number in 0..numbers {
            publisher
                .send_raw(number.to_string().into_bytes())
                .expect("open");
            clock::rest(every);
        }
        bus.close();
    })
}

fn played(
    seed: u64,
    numbers: u32,
    every: Duration,
    faults: &[(Duration, Fault)],
) -> (Run, Vec<(f64, String)>) {
    let network = SimulatedNetwork::new(seed, conditions());
    let log = Log::default();
    add_hub(&network, Duration::from_secs(60), &log);
    add_leaf(&network, numbers, every);
    faults
        .iter()
        .for_each(|(at, fault)| network.fault(*at, *fault));
    let run = network.run(LIMIT);
    let log = log.lock().clone();
    (run, log)
}

fn numbers_of(log: &[(f64, String)]) -> Vec<u32> {
    log.iter()
        .filter_map(|(_, text)| text.parse().ok())
        .collect()
}

#[test]
fn an_hour_of_rest_takes_no_time() {
    let network = SimulatedNetwork::new(1, conditions());
    network.node(Duration::from_secs(5), "sleeper", || {
        clock::rest(Duration::from_secs(3600))
    });
    let run = network.run(LIMIT);
    assert_eq!(
        (run.verdict, run.time),
        (Verdict::Ended, Duration::from_secs(3605))
    );
}

#[test]
fn messages_take_their_time_and_keep_their_order() {
    for seed in 0..20 {
        let (run, log) = played(seed, 200, Duration::from_millis(1), &[]);
        assert_eq!(run.verdict, Verdict::Ended);
        assert_eq!(numbers_of(&log), (0..200).collect::<Vec<u32>>());
        let first_s = log.iter().find(|(_, text)| text == "0").expect("it came").0;
        assert!(
            (0.04..0.1).contains(&first_s),
            "a connection and a message: {first_s} s"
        );
    }
}

#[test]
fn the_same_seed_is_the_same_run_and_another_seed_another() {
    let run = |seed| played(seed, 50, Duration::from_millis(3), &[]).0.trace;
    assert_eq!(run(4), run(4));
    assert_ne!(run(4), run(5));
}

#[test]
fn a_short_cut_delays_and_a_long_one_takes_the_token_until_the_link_is_back() {
    let cut = |s: u64| {
        [(
            Duration::from_secs(2),
            Fault::Cut {
                node: 1,
                time: Duration::from_secs(s),
            },
        )]
    };
    let (_, short) = played(3, 400, Duration::from_millis(100), &cut(5));
    assert_eq!(
        numbers_of(&short),
        (0..400).collect::<Vec<u32>>(),
        "nothing is lost"
    );
    let gap_s = short
        .windows(2)
        .map(|pair| pair[1].0 - pair[0].0)
        .fold(0.0, f64::max);
    assert!((4.9..5.5).contains(&gap_s), "{gap_s}");
    let (_, long) = played(3, 400, Duration::from_millis(100), &cut(15));
    let tokens: Vec<f64> = long
        .iter()
        .filter(|(_, text)| text.starts_with("there"))
        .map(|(at_s, _)| *at_s)
        .collect();
    let [came_s, gone_s, back_s, left_s] = tokens[..] else {
        panic!("{tokens:?}")
    };
    assert!(
        came_s < 0.1
            && (9.5..=12.0).contains(&gone_s)
            && (17.0..18.5).contains(&back_s)
            && left_s > 40.0,
        "{tokens:?}"
    );
    assert!(numbers_of(&long).len() < 300, "what was in transit is lost");
}

#[test]
fn who_is_suspended_hears_everything_afterwards_if_it_is_not_for_too_long() {
    let pause = |s: u64| {
        [(
            Duration::from_secs(2),
            Fault::Suspend {
                node: 0,
                time: Duration::from_secs(s),
            },
        )]
    };
    let (_, log) = played(6, 100, Duration::from_millis(100), &pause(6));
    assert_eq!(numbers_of(&log), (0..100).collect::<Vec<u32>>());
    assert!(
        log.iter().all(|(at_s, _)| !(2.1..8.0).contains(at_s)),
        "it ran while it was suspended"
    );
}

#[test]
fn a_full_link_drops_and_a_killed_node_is_missed_at_once() {
    let mut little = conditions();
    little.queue = 10;
    let network = SimulatedNetwork::new(9, little);
    let log = Log::default();
    add_hub(&network, Duration::from_secs(60), &log);
    let leaf = add_leaf(&network, 200, Duration::from_millis(100));
    network.fault(
        Duration::from_secs(2),
        Fault::Cut {
            node: leaf,
            time: Duration::from_secs(5),
        },
    );
    network.fault(
        Duration::from_secs(10),
        Fault::Kill {
            node: leaf,
            restart: Some(Duration::from_secs(1)),
        },
    );
    let run = network.run(LIMIT);
    let log = log.lock().clone();
    let before_the_kill = log
        .iter()
        .filter(|(at_s, text)| *at_s < 10.0 && text.parse::<u32>().is_ok())
        .count();
    assert!(
        (50..75).contains(&before_the_kill),
        "{before_the_kill} of 100, 40 of them dropped"
    );
    let gone_s = log
        .iter()
        .find(|(_, text)| text == "there: false")
        .expect("it is missed")
        .0;
    assert!((10.0..10.1).contains(&gone_s), "{gone_s}");
    assert_eq!(
        log.iter().filter(|(_, text)| text == "0").count(),
        2,
        "it began again"
    );
    let ends: Vec<(&str, bool)> = run
        .ends
        .iter()
        .map(|end| (end.node.as_str(), end.was_killed))
        .collect();
    assert_eq!(ends, [("leaf", true), ("leaf", false), ("hub", false)]);
}

#[test]
fn a_wait_that_nobody_can_end_is_a_deadlock_and_an_endless_node_is_out_of_time() {
    let network = SimulatedNetwork::new(1, conditions());
    network.node(Duration::ZERO, "stuck", || {
        let _ = inbox::<()>(1).1.take(Duration::MAX);
    });
    assert_eq!(
        network.run(LIMIT).verdict,
        Verdict::Deadlock(vec!["stuck".to_owned()])
    );
    let network = SimulatedNetwork::new(1, conditions());
    network.node(Duration::ZERO, "endless", || {
        loop {
            Watched::new(()).wait(Duration::from_secs(1), |()| false);
        }
    });
    assert_eq!(
        network.run(LIMIT).verdict,
        Verdict::OutOfTime(vec!["endless".to_owned()])
    );
}

#[test]
fn a_node_that_panics_is_reported() {
    let network = SimulatedNetwork::new(1, conditions());
    network.node(Duration::ZERO, "careless", || panic!("the mast is gone"));
    assert_eq!(
        network.run(LIMIT).verdict,
        Verdict::Panic("careless: the mast is gone".to_owned())
    );
}
