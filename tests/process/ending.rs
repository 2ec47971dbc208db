//! SIGTERM ends every long-running command.

use crate::support::{Process, Sim, own, printed, squall, temporary};
use std::net::TcpListener;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Time within which a command must end.
const END_MAX: Duration = Duration::from_secs(2);

/// Commands, with the words that this test fills in.
const COMMANDS: [&str; 20] = [
    "run LONG --in-process --no-record",
    "run LONG --no-record",
    "run mixed_2v2 --emulate --pace realtime --no-record",
    "run LONG --watch-files --in-process --no-record",
    "tournament paper_2023 --games 100000 --jobs 1",
    "tournament simple --games 100000 --jobs 1 --league DIR/league",
    "sweep wind --games 100000 --jobs 1 --out DIR/wind",
    "train options --jobs 1 --out DIR/options",
    "log --quality RECORDINGS",
    "trial surveyor_m1_8 --manoeuvre zigzag --duration-s 86000 --csv DIR/track.csv --plot DIR/track.svg",
    "identify surveyor_m1_8 --log DIR/zigzag.csv --out DIR/fit.toml",
    "replay RECORDING --listen 127.0.0.1:0",
    "view --listen 127.0.0.1:0 GAME",
    "watch GAME",
    "watch SILENT",
    "sim LONG --listen tcp/127.0.0.1:0 --join-s 600",
    "agent --vehicle blue_one GAME --wait-s 100",
    "agent --vehicle blue_one SILENT --wait-s 100",
    "gateway surveyor --vehicle blue_one --no-record --link LINK SILENT",
    "gateway console SILENT",
];

/// Starts the command, sends SIGTERM after a second, and returns how long it took to end.
fn time_to_end(words: &[&str]) -> Duration {
    let mut command = squall(words);
    command.stdin(Stdio::piped());
    let mut process = Process::quiet(command);
    std::thread::sleep(Duration::from_secs(1));
    assert!(
        process.0.try_wait().expect("it can be asked").is_none(),
        "{words:?} has ended by itself"
    );
    let start = Instant::now();
    process.signal("TERM");
    process.wait();
    start.elapsed()
}

#[test]
fn sigterm_ends_every_command_within_two_seconds() {
    let dir = temporary();
    let folder = dir.path().display().to_string();
    let log = format!("{folder}/zigzag.csv");
    let plot = format!("{folder}/zigzag.svg");
    let args = [
        "trial",
        "surveyor_m1_8",
        "--manoeuvre",
        "zigzag",
        "--with-orders",
        "--csv",
        &log,
        "--plot",
        &plot,
    ];
    printed(&args);
    let recording = format!("{folder}/game.mcap");
    printed(&["sim", "attack_1v1", "--join-s", "0", "--record", &recording]);
    let sim = Sim::start("patient", &["--join-s", "600"]);
    // It accepts connections but never answers.
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let silent = listener.local_addr().expect("it is bound");
    let words = [
        ("RECORDINGS", vec![recording.as_str(); 2000].join(" ")),
        ("RECORDING", recording.clone()),
        ("SILENT", format!("--connect tcp/{silent} --game silent")),
        ("LINK", format!("tcp://{silent}")),
        (
            "GAME",
            format!("--connect {} --game {}", sim.endpoint, sim.game),
        ),
        ("LONG", own("long")),
        ("DIR", folder),
    ];
    let mut slow = vec![];
    for command in COMMANDS {
        let text = words
            .iter()
            .fold(command.to_owned(), |text, (word, value)| {
                text.replace(word, value)
            });
        let words: Vec<&str> = text.split(' ').collect();
        // A busy machine may delay one of several attempts.
        let attempts = std::iter::repeat_with(|| time_to_end(&words)).take(3);
        let took = attempts
            .inspect(|took| eprintln!("{took:.1?}: {command}"))
            .find(|took| *took < END_MAX);
        if took.is_none() {
            slow.push(command);
        }
    }
    assert!(slow.is_empty(), "{slow:?}");
}
