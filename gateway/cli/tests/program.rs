//! Tests the boat's program from the command line: help, check, operator commands, guard, replay.

#![allow(
    clippy::disallowed_methods,
    reason = "waits for processes by the clock, with a limit"
)]

use bus::Token;
use gateway::link::{BoatLink, Link, LinkAddress, LinkEvent, LinkSettings};
use gateway::nmea::{Gga, Sentence, date_and_time};
use primitives::LatLon;
use std::process::{Child, Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Timeout, generous for a busy machine.
const LIMIT: Duration = Duration::from_secs(60);
/// The sentence that stops a boat, sent by its gateway or the guard.
const ZERO: &str = "$PSEAC,T,0,0,0,*";

/// A temporary folder for the program, with its own registry.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().expect("a folder"))
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_squall-gateway"));
        command
            .current_dir(self.0.path())
            .env("XDG_RUNTIME_DIR", self.0.path())
            .args(args);
        command
    }

    fn run(&self, args: &[&str]) -> (Output, String) {
        let output = self.command(args).output().expect("the program starts");
        let said =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
        (output, said.concat())
    }

    /// Starts a gateway for a boat in a game that does not exist. The gateway exits when its
    /// standard input closes.
    fn gateway(&self, boat: &Boat) -> Running {
        let link = boat.link.reach();
        let args = [
            "surveyor",
            "--vehicle",
            "blue_one",
            "--game",
            "nowhere",
            "--link",
            &link,
            "--for-parent",
        ];
        let mut command = self.command(&args);
        command
            .args(["--record", "run.mcap"])
            .stdin(Stdio::piped())
            .stdout(Stdio::null());
        Running(command.spawn().expect("the program starts"))
    }

    /// Repeats a command until it prints `what`.
    fn run_until(&self, args: &[&str], what: &str) {
        let start = Instant::now();
        let mut said = String::new();
        while !said.contains(what) {
            assert!(
                start.elapsed() < LIMIT,
                "{args:?} does not print {what:?}: {said}"
            );
            said = self.run(args).1;
        }
    }
}

/// A process that is killed when dropped.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        drop(self.0.kill());
        drop(self.0.wait());
    }
}

/// The boat's end of a link. It reports standby, and records the sentences that it receives.
struct Boat {
    link: Arc<Link>,
    received: Receiver<String>,
    is_gone: Arc<AtomicBool>,
}

impl Boat {
    fn new() -> Boat {
        Boat::sending(|| b"$PSEAG,N*22\r\n".to_vec())
    }

    /// A boat that sends these bytes ten times a second.
    fn sending(bytes: impl Fn() -> Vec<u8> + Send + 'static) -> Boat {
        let (sender, received) = channel();
        let take = move |event| {
            if let LinkEvent::Bytes { bytes, .. } = event {
                drop(sender.send(String::from_utf8_lossy(&bytes).into_owned()));
            }
        };
        let address = LinkAddress::to_listen("tcp://127.0.0.1:0").expect("an address");
        let settings = LinkSettings {
            silence: None,
            ..LinkSettings::default()
        };
        let link = Arc::new(Link::open(&address, settings, take).expect("it listens"));
        let reporter = Arc::clone(&link);
        let is_gone = Arc::<AtomicBool>::default();
        let ended = Arc::clone(&is_gone);
        std::thread::spawn(move || {
            while !ended.load(Ordering::Relaxed) {
                reporter.send(bytes(), 0);
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        Boat {
            link,
            received,
            is_gone,
        }
    }

    /// Waits until `what` is received, starting after the previous match.
    fn wait_for(&self, what: &str) {
        let start = Instant::now();
        let mut text = String::new();
        while !text.contains(what) {
            assert!(
                start.elapsed() < LIMIT,
                "{what:?} does not arrive: {text:?}"
            );
            text.extend(self.received.recv_timeout(Duration::from_millis(100)));
        }
    }
}

impl Drop for Boat {
    fn drop(&mut self) {
        self.is_gone.store(true, Ordering::Relaxed);
    }
}

#[test]
fn help_and_hints_name_this_program() {
    let folder = Folder::new();
    let (output, help) = folder.run(&["--help"]);
    assert!(
        output.status.success() && help.contains("squall-gateway"),
        "{help}"
    );
    for command in ["surveyor", "check", "stop", "tell", "console", "replay"] {
        assert!(help.contains(command), "{help}");
        let (output, help) = folder.run(&[command, "--help"]);
        assert!(
            output.status.success() && help.contains(&format!("squall-gateway {command}")),
            "{help}"
        );
        assert!(!help.contains("squall gateway"), "{help}");
    }
    // Emulated boats exist only in the simulator.
    assert!(!folder.run(&["emulate", "--help"]).0.status.success());
    assert!(
        folder
            .run(&["replay", "nothing.mcap"])
            .1
            .starts_with("squall-gateway: cannot read the recording nothing.mcap")
    );
}

#[test]
fn a_boat_is_checked_by_a_gateway_file_inside_of_the_program() {
    let folder = Folder::new();
    let boat = Boat::new();
    let link = boat.link.reach();
    let check = |config: &str| {
        folder.command(&[
            "check", "--link", &link, "--for-s", "60", "--config", config,
        ])
    };
    let refused = check("blueboot").output().expect("the program starts");
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(
        !refused.status.success() && said.contains("did you mean blueboat"),
        "{said}"
    );
    let mut check = Running(
        check("emulated")
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts"),
    );
    let mut said = std::io::BufReader::new(check.0.stderr.take().expect("piped"));
    let mut line = String::new();
    std::io::BufRead::read_line(&mut said, &mut line).expect("it says something");
    assert!(
        line.contains("listening for 60 s, sending nothing"),
        "{line}"
    );
}

#[test]
fn a_full_disk_is_reported_at_once_and_at_the_end() {
    // Use numbers that do not repeat, because the recording is compressed.
    let boat = Boat::sending(|| {
        (0..250)
            .map(|_| Token::random().hex())
            .collect::<String>()
            .into_bytes()
    });
    let folder = Folder::new();
    let link = boat.link.reach();
    let gateway = folder.command(&[
        "surveyor",
        "--vehicle",
        "blue_one",
        "--game",
        "nowhere",
        "--link",
        &link,
    ]);
    // A file size limit of 200 kB imitates a full disk.
    let limited = "trap '' XFSZ; ulimit -f 400; exec \"$@\"";
    let mut shell = Command::new("sh");
    shell
        .current_dir(folder.0.path())
        .env("XDG_RUNTIME_DIR", folder.0.path())
        .args(["-c", limited, "sh"]);
    shell
        .arg(gateway.get_program())
        .args(gateway.get_args())
        .args(["--record", "run.mcap", "--for-parent"]);
    let shell = shell
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut running = Running(shell.spawn().expect("it starts"));
    folder.run_until(
        &["tell", "blue_one", "status", "--game", "nowhere"],
        "recording to run.mcap has stopped",
    );
    drop(running.0.stdin.take());
    let code = running.0.wait().expect("it ends").code();
    let error = std::io::read_to_string(running.0.stderr.take().expect("piped")).expect("text");
    assert!(
        code == Some(1) && error.contains("recording to run.mcap has stopped"),
        "{code:?}: {error}"
    );
}

/// A GGA sentence for this moment.
fn gga() -> Vec<u8> {
    let Sentence::Gga(blank) = Sentence::parse("GPGGA,,,,,,").expect("it is blank") else {
        panic!("no GGA")
    };
    let at = Some(LatLon {
        lat_deg: 41.3,
        lon_deg: -74.0,
    });
    let time = Some(date_and_time(recording::utc::now_ns()).1);
    let mut bytes = vec![];
    Sentence::Gga(Gga {
        time,
        at,
        quality: 1,
        ..blank
    })
    .write(&mut bytes);
    bytes
}

#[test]
fn the_search_for_a_game_is_no_error_of_the_boats_clock() {
    let folder = Folder::new();
    let boat = Boat::sending(gga);
    let link = boat.link.reach();
    let nobody = std::net::TcpListener::bind("127.0.0.1:0")
        .and_then(|port| port.local_addr())
        .expect("a port");
    let connect = format!("tcp/{nobody}");
    let check = [
        "check",
        "--link",
        &link,
        "--for-s",
        "2",
        "--vehicle",
        "blue_one",
        "--game",
        "nosuch",
    ];
    // The search ends after five seconds.
    let (_, said) = folder.run(&[check.as_slice(), &["--connect", &connect]].concat());
    assert!(
        said.contains("passed  clock") && said.contains("without a game"),
        "{said}"
    );
}

#[test]
fn a_check_of_a_link_without_sentences_shows_a_line_and_what_is_wrong_with_it() {
    let folder = Folder::new();
    let boat = Boat::sending(|| b"$PSEAG,N\r\n".to_vec());
    let (output, said) = folder.run(&["check", "--link", &boat.link.reach(), "--for-s", "2"]);
    assert!(
        !output.status.success()
            && said.contains("none of them a valid sentence: $PSEAG,N has no checksum"),
        "{said}"
    );
}

#[test]
fn a_gateway_serves_operators_and_its_recording_is_replayed_and_its_guard_stops_the_boat() {
    let folder = Folder::new();
    let boat = Boat::new();
    let mut gateway = folder.gateway(&boat);
    boat.wait_for(ZERO);
    folder.run_until(
        &["tell", "blue_one", "status", "--game", "nowhere"],
        "blue_one: disarmed",
    );
    let (output, said) = folder.run(&["tell", "blue_one", "arm", "--game", "nowhere"]);
    assert!(
        !output.status.success() && said.contains("no game yet"),
        "{said}"
    );
    let (output, said) = folder.run(&["stop", &boat.link.reach()]);
    assert!(
        output.status.success() && said.contains("holds the link: e-stopped"),
        "{said}"
    );
    drop(gateway.0.stdin.take());
    assert!(gateway.0.wait().expect("it ends").success());
    let (output, said) = folder.run(&["replay", "run.mcap"]);
    assert!(
        output.status.success()
            && said.contains("the replay is identical to the recording, byte for byte"),
        "{said}"
    );

    std::fs::remove_file(folder.0.path().join("run.mcap")).expect("it was recorded");
    let mut gateway = folder.gateway(&boat);
    folder.run_until(
        &["tell", "blue_one", "status", "--game", "nowhere"],
        "blue_one: disarmed",
    );
    gateway.0.kill().expect("it runs");
    gateway.0.wait().expect("it is killed");
    while boat.received.try_recv().is_ok() {}
    boat.wait_for(ZERO);
}
