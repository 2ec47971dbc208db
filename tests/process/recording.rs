//! Recordings of whole games, killed games and real boats; and replays of games.

use crate::support::{
    FOUR, Process, Sim, all_output, own, printed, refusal_of, refused, result_of, squall,
    squall_on_a_disk_of, temporary, wait_until,
};
use bus::Priority;
use messages::external::LinkBytes;
use messages::{Message, PolicyProposal, Stamp, topic};
use primitives::VehicleId;
use recording::{Bag, Recording};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// The only recording in a folder.
fn only_recording(dir: &Path) -> PathBuf {
    let files: Vec<PathBuf> = std::fs::read_dir(dir)
        .expect("the folder is there")
        .map(|f| f.expect("a file").path())
        .collect();
    assert_eq!(files.len(), 1, "{files:?}");
    files[0].clone()
}

fn opened(path: &Path) -> Recording {
    Recording::open(path).unwrap_or_else(|e| panic!("{e}"))
}

/// The output of the replay check; the rerun must reproduce the game.
fn checked(path: &Path) -> String {
    printed(&["replay", "--check", &path.display().to_string()])
}

#[test]
fn a_game_recorded_replayed_and_played_again_is_one_game() {
    let game = "scenarios/games/pav01_vs_pav01.toml";
    let mut digests = Vec::new();
    for how in [&["--in-process"][..], &["--agents-per-process", "2"]] {
        let dir = temporary();
        let folder = dir.path().join("runs").display().to_string();
        let result = result_of(&[&[game, "--record", &folder], how].concat());
        let path = only_recording(Path::new(&folder));
        let recording = opened(&path);
        let ending = recording.ending().expect("it ended well");
        assert_eq!(
            ending.outcome.digest,
            result["digest"].as_str().expect("a digest")
        );
        assert_eq!((ending.dropped, recording.is_cut()), (0, false));
        assert_eq!(
            recording.frame_count(),
            6001,
            "a frame per decision, and the last"
        );
        let score = recording
            .frames()
            .last()
            .expect("frames")
            .expect("a frame")
            .score;
        let told = &result["score"]["teams"];
        assert_eq!(
            [told["blue"].as_u64(), told["red"].as_u64()],
            [score[0], score[1]].map(|n| Some(u64::from(n)))
        );
        let said = checked(&path);
        assert!(
            said.contains("identical: 6001 frames to 600.0 s")
                && said.contains(&ending.outcome.digest),
            "{said}"
        );
        digests.push(ending.outcome.digest.clone());
    }
    assert_eq!(digests[0], digests[1]);
}

#[test]
fn simultaneous_games_have_separate_recordings() {
    let dir = temporary();
    let folder = dir.path().display().to_string();
    let args = [
        "run",
        "scenarios/games/attack_1v1.toml",
        "--set",
        "game.duration_s=5",
        "--record",
        &folder,
    ];
    let start = |_| {
        let mut command = squall(&args);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        Process::start(command)
    };
    let games: Vec<Process> = (0..4).map(start).collect();
    for mut game in games {
        assert!(game.wait().success(), "{}", game.errors());
    }
    let files = std::fs::read_dir(dir.path())
        .expect("the folder is there")
        .map(|file| file.expect("a file").path());
    assert_eq!(
        files.filter(|path| opened(path).ending().is_some()).count(),
        4
    );
}

#[test]
fn a_killed_sim_leaves_a_recording_up_to_the_last_second() {
    let dir = temporary();
    let path = dir.path().join("killed.mcap");
    let file = path.display().to_string();
    let mut sim = Sim::start("long", &["--pace", "20x", "--record", &file]);
    let _agent = sim.agent(&FOUR);
    let now_s = sim.play_on(80.0);
    sim.process.kill();
    let recording = opened(&path);
    assert!(recording.is_cut() && recording.ending().is_none());
    let last_s = recording.frame(recording.frame_count() - 1).at.as_s();
    // The documented limit is one second, or 20 s of the game; the rest allows for a busy machine.
    assert!(last_s > now_s - 40.0, "{last_s} s recorded of {now_s} s");
    let said = checked(&path);
    assert!(said.contains("the file ends abruptly there"), "{said}");
}

#[test]
fn what_is_heard_is_written_down_if_it_is_sound() {
    let dir = temporary();
    let path = dir.path().join("heard.mcap");
    let file = path.display().to_string();
    let sim = Sim::start("long", &["--pace", "20x", "--record", &file]);
    let _agent = sim.agent(&FOUR);
    let bus = sim.bus();
    let game = sim.name();
    let scenario = scenario::load(Path::new(&own("long"))).unwrap_or_else(|e| panic!("{e}"));
    // A recording begins with the game.
    sim.play_on(1.0);
    let publisher = |key| bus.publisher(key, Priority::Normal).expect("a session");
    publisher(topic::control(&game))
        .send_json(b"\"halt\"".to_vec())
        .expect("a session");
    let proposals = publisher(topic::policy(&game, &scenario, VehicleId(0)));
    let stamp = Stamp {
        version: PolicyProposal::VERSION,
        ..Stamp::default()
    };
    let proposal = PolicyProposal {
        stamp,
        vehicle: VehicleId(0),
        course_rad: 0.5,
        speed_m_s: 1.0,
    };
    proposals.send_raw(b"garbage".to_vec()).expect("a session");
    proposals.send(&proposal).expect("a session");
    sim.play_on(5.0);
    let done = sim.stop();
    assert_eq!(done["run"]["refused"]["garbage"], 1);
    let recording = opened(&path);
    let proposals: Vec<_> = recording
        .bag()
        .on("policy/blue_one")
        .map(|said| said.read::<PolicyProposal>())
        .collect();
    assert!(
        matches!(proposals.as_slice(), [Ok(said)] if *said == proposal),
        "{proposals:?}"
    );
    let json = |topic: &str| {
        let last = recording
            .bag()
            .on(topic)
            .last()
            .unwrap_or_else(|| panic!("nothing on {topic}"));
        serde_json::from_slice::<serde_json::Value>(&last.bytes).expect("JSON")
    };
    assert_eq!(json("control"), serde_json::json!({"control": "halt"}));
    assert_eq!(json("run")["phase"], "over");
    let said = refusal_of(&["sim", "scenarios/games/attack_1v1.toml", "--record", &file]);
    assert!(said.contains(&format!("cannot record to {file}")), "{said}");
}

/// Runs the program, which must fail, on a disk that is full after one or two MiB, depending on the
/// shell's block size; returns the last line of its error output.
#[cfg(unix)]
fn refused_on_a_full_disk(args: &[&str]) -> String {
    refused(squall_on_a_disk_of(2048, args))
        .lines()
        .last()
        .unwrap_or_default()
        .to_owned()
}

#[test]
#[cfg(unix)]
fn a_recording_that_the_disk_has_no_room_for_is_told_in_the_end() {
    for how in [&["--in-process"][..], &["--agents-per-process", "2"]] {
        let dir = temporary();
        let folder = dir.path().display().to_string();
        let args = [
            &[
                "run",
                "scenarios/games/attack_1v1.toml",
                "--record",
                &folder,
            ],
            how,
        ]
        .concat();
        let last = refused_on_a_full_disk(&args);
        assert!(
            last.starts_with("squall: the recording ") && last.contains("too large"),
            "{last}"
        );
        assert!(
            opened(&only_recording(dir.path())).is_cut(),
            "what fitted on the disk is there"
        );
    }
    let dir = temporary();
    let file = dir.path().join("game.mcap").display().to_string();
    let args = [
        "sim",
        "scenarios/games/attack_1v1.toml",
        "--record",
        &file,
        "--join-s",
        "0",
    ];
    let last = refused_on_a_full_disk(&args);
    assert!(last.contains("is incomplete"), "{last}");
}

#[test]
fn unusable_outputs_are_refused_before_the_game() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let taken = taken.local_addr().expect("it is bound").to_string();
    // This game is too long to wait for its end.
    let game = &*own("long");
    for (args, part) in [
        (
            &["run", game, "--no-record", "--json", "/nope/x"][..],
            "cannot write the result to /nope/x",
        ),
        (
            &[
                "run",
                game,
                "--in-process",
                "--no-record",
                "--json",
                "/nope/x",
            ],
            "cannot write the result to /nope/x",
        ),
        (
            &["sim", game, "--json", "/nope/x"],
            "cannot write the result to /nope/x",
        ),
        (
            &["run", game, "--record", "/proc"],
            "cannot record to /proc",
        ),
        (
            &["run", game, "--in-process", "--record", "/proc"],
            "cannot record to /proc",
        ),
        (
            &["run", game, "--no-record", "--view", "--listen", &taken],
            "the page cannot listen on",
        ),
    ] {
        let said = refusal_of(args);
        assert!(
            said.contains(part) && !said.contains("every boat has an agent"),
            "{args:?}: {said}"
        );
    }
}

#[test]
fn a_damaged_message_costs_itself_alone() {
    let dir = temporary();
    let folder = dir.path().display().to_string();
    result_of(&[
        "scenarios/games/attack_1v1.toml",
        "--in-process",
        "--record",
        &folder,
    ]);
    let path = only_recording(dir.path());
    let all = printed(&["log", "--events", &path.display().to_string()]);
    let frame = opened(&path).frame(7).bytes;
    let mut bytes = std::fs::read(&path).expect("it is there");
    let place = bytes
        .windows(frame.len())
        .position(|window| window == frame)
        .expect("it is in it");
    // Corrupt the encapsulation header, which marks a message as CDR.
    bytes[place] = 0xff;
    std::fs::write(&path, bytes).expect("it is written");
    let told = printed(&["log", &path.display().to_string()]);
    assert!(
        told.contains("1 message is damaged and skipped; message 7 of frame"),
        "{told}"
    );
    assert!(told.contains(&all), "everything else is unchanged");
    let csv = printed(&["log", &path.display().to_string(), "--csv", "frame"]);
    assert_eq!(
        csv.lines().count(),
        opened(&path).frame_count(),
        "a line of names, and one line less"
    );
    let mut replay = squall(&[
        "replay",
        &path.display().to_string(),
        "--listen",
        "127.0.0.1:0",
    ]);
    replay.stderr(Stdio::piped());
    let (mut replay, mut lines) = Process::with_lines(replay);
    let shown = lines.next().expect("it says where it is");
    assert!(shown.contains("http://127.0.0.1:"), "{shown}");
    replay.kill();
    let said = replay.errors();
    assert_eq!(
        said.matches("1 message is damaged and skipped; message 7 of frame")
            .count(),
        1,
        "{said}"
    );
}

#[test]
fn real_boats_are_recorded_with_every_byte_and_their_game_can_be_played_again() {
    let dir = temporary();
    let runs = dir.path().join("runs");
    let gateways = dir.path().join("gateways");
    let [runs_text, gateways_text] = [&runs, &gateways].map(|path| path.display().to_string());
    let config = "scenarios/gateways/emulated.toml";
    let options = [
        "--emulate",
        "--pace",
        "10x",
        "--gateway",
        config,
        "--record-gateways",
        &gateways_text,
    ];
    result_of(
        &[
            &[own("mixed_60s").as_str(), "--record", &runs_text][..],
            &options,
        ]
        .concat(),
    );
    let path = only_recording(&runs);
    let recording = opened(&path);
    let topics = recording.bag().topics();
    for topic in [
        "nav/blue_one",
        "external/blue_one",
        "status/blue_one",
        "link/blue_one",
        "link/red_one",
        "run",
    ] {
        assert!(topics.contains_key(topic), "{topic} is not in {topics:?}");
    }
    // The gateway's own recording, up to the end of the game.
    let bytes = |bag: &Bag, outward: bool| -> Vec<u8> {
        let said = bag
            .on("link/blue_one")
            .map(|said| said.read::<LinkBytes>().expect("bytes"));
        said.filter(|link| link.outward == outward)
            .flat_map(|link| link.data)
            .collect()
    };
    let file = gateways.join("blue_one.mcap").display().to_string();
    let own = Bag::open(Path::new(&file)).unwrap_or_else(|e| panic!("{e}"));
    let sentences = |bytes: &[u8]| {
        bytes
            .split(|byte| *byte == b'\n')
            .filter(|line| line.len() > 9)
            .count()
    };
    for outward in [false, true] {
        let ours = bytes(recording.bag(), outward);
        let theirs = bytes(&own, outward);
        let place = theirs.windows(ours.len()).position(|window| window == ours);
        assert!(
            place.is_some() && sentences(&ours) > 100,
            "outward {outward}: {} of {} bytes",
            ours.len(),
            theirs.len()
        );
    }
    checked(&path);
    for (args, part) in [
        (&["log", &file][..], "gateway of blue_one"),
        (
            &["log", &file, "--csv", "link/blue_one"],
            "to_boat,\"$PSEAC",
        ),
        (&["log", &file, "--csv", "event"], "event.state.to"),
        (&["log", &file, "--events"], "is the recording of a gateway"),
        (
            &["replay", "--check", &file],
            "not a recording of a game: it is a recording of a gateway",
        ),
        (
            &["gateway", "replay", &path.display().to_string()],
            "not a recording of a gateway: it is a recording of a game",
        ),
    ] {
        let said = all_output(squall(args));
        assert!(
            said.contains(part),
            "{args:?} should print {part:?}, but prints {said:.500}"
        );
    }
}

#[test]
fn a_recording_can_be_read_while_the_game_goes_on() {
    let dir = temporary();
    let path = dir.path().join("live.mcap");
    let file = path.display().to_string();
    let sim = Sim::start("long", &["--pace", "20x", "--record", &file]);
    let _agent = sim.agent(&FOUR);
    sim.play_on(20.0);
    let mut counts = vec![];
    wait_until("it grows twice", || {
        let count = opened(&path).frame_count();
        if Some(&count) != counts.last() {
            counts.push(count);
        }
        counts.len() == 3
    });
    assert!(counts.is_sorted(), "{counts:?}");
    sim.stop();
}
