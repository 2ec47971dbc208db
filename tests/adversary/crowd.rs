//! Exhausts the port of a sim that may open only a few files: no authorised node is kept out, and
//! no connected node is disturbed.

use crate::disturbed_game::all_stay;
use crate::intruder::Target;
use crate::support::{FOUR, Process, Sim, squall, wait_until, wait_within};
use bus::Bus;
use messages::{Control, topic};
use serde_json::Value;
use std::any::Any;
use std::collections::VecDeque;
use std::net::TcpStream;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Two limits on the sim's open files; each crowd has 50 % more connections. Each limit has its own
/// test, because a test mostly waits, for about two minutes.
pub(crate) const MANY_FILES: usize = 1024;
pub(crate) const FEW_FILES: usize = 128;
/// The start of a TLS handshake (RFC 8446) that announces 512 bytes.
const HALF_HELLO: [u8; 11] = [0x16, 3, 1, 2, 0, 1, 0, 1, 0xfc, 3, 3];

/// Time limit for an authorised node to join.
const IN: Duration = Duration::from_secs(10);
/// Maximum gap between frames, which arrive at least ten times a second. A link congested by a busy
/// machine is closed, and reopened after a second.
const GAP: Duration = Duration::from_secs(2);

/// A named crowd; it lasts until its return value is dropped.
type Crowd = (&'static str, fn(&Target, usize) -> Box<dyn Any>);

const CROWDS: [Crowd; 4] = [
    ("silent", |target, count| {
        Box::new(target.connections(&[], count))
    }),
    ("half-way through a handshake", |target, count| {
        Box::new(target.connections(&HALF_HELLO, count))
    }),
    ("with garbage", |target, count| {
        Box::new(target.connections(&[b'x'; 5000], count))
    }),
    ("new ones all the time", |target, count| {
        Box::new(stream(target, count))
    }),
];

/// Work that is repeated in its own thread until it is dropped.
pub(crate) struct Repeated {
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Repeated {
    pub(crate) fn start(mut work: impl FnMut() + Send + 'static) -> Repeated {
        let is_over = Arc::new(AtomicBool::new(false));
        let over = Arc::clone(&is_over);
        let thread = std::thread::spawn(move || {
            while !over.load(Ordering::Relaxed) {
                work();
            }
        });
        Repeated {
            is_over,
            thread: Some(thread),
        }
    }
}

impl Drop for Repeated {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.thread
            .take()
            .into_iter()
            .for_each(|thread| thread.join().expect("it does not panic"));
    }
}

/// New connections, opened as fast as the port accepts them; the newest ones stay open.
fn stream(target: &Target, count: usize) -> Repeated {
    let at = target.address().to_owned();
    let mut newest = VecDeque::new();
    let stream = Repeated::start(move || {
        newest.extend(TcpStream::connect(&at));
        if newest.len() > count {
            newest.pop_front();
        }
    });
    // Wait until all limits are reached.
    std::thread::sleep(Duration::from_secs(5));
    stream
}

/// The program with this limit on open files.
pub(crate) fn squall_with_files(files: usize) -> Command {
    let program = squall(&[]);
    let mut shell = Command::new("sh");
    shell
        .args(["-c", &format!("ulimit -n {files}; exec \"$0\" \"$@\"")])
        .arg(program.get_program());
    shell.current_dir(env!("CARGO_MANIFEST_DIR"));
    shell.envs(
        program
            .get_envs()
            .filter_map(|(name, value)| Some((name, value?))),
    );
    shell
}

/// The longest time between two frames, in microseconds, and when the last one arrived.
#[derive(Default)]
struct Gaps {
    longest_us: AtomicU64,
    last: Mutex<Option<Instant>>,
}

impl Gaps {
    fn note(&self) {
        let now = Instant::now();
        let last = self
            .last
            .lock()
            .expect("no thread panics while holding it")
            .replace(now);
        let gap = last.map_or(Duration::ZERO, |last| now - last);
        self.longest_us
            .fetch_max(gap.as_micros() as u64, Ordering::Relaxed);
    }
}

/// Exhausts the port of a sim with this limit on open files. `operator` is connected to the game,
/// and `comes_in` tries to join.
pub(crate) fn is_withstood(
    sim: Sim,
    mut agents: Vec<Process>,
    files: usize,
    operator: &Bus,
    comes_in: &dyn Fn(&Sim) -> bool,
) {
    sim.wait_for_kind("started");
    let gaps = Arc::new(Gaps::default());
    let noted = Arc::clone(&gaps);
    let _heard = operator
        .subscribe(topic::frame(&sim.name()), move |_| noted.note())
        .expect("it is in the game");
    for (what, crowd) in CROWDS {
        let kept = crowd(&Target::of(&sim), files * 3 / 2);
        let during = wait_within(
            IN,
            &format!("an agent joins beside connections {what}"),
            || comes_in(&sim),
        );
        sim.newest_progress();
        let asked = Instant::now();
        bus::control(operator, &sim.name(), Control::EStop).expect("it is published");
        sim.wait_for_event("e_stopped", Value::Null);
        let stopped = asked.elapsed();
        drop(kept);
        let after = wait_within(
            IN,
            &format!("an agent joins after connections {what}"),
            || comes_in(&sim),
        );
        let gap = Duration::from_micros(gaps.longest_us.swap(0, Ordering::Relaxed));
        eprintln!(
            "{files} files, {what}: joined after {during:.1?}, later after {after:.1?}; E-stop after {stopped:.1?}; \
            no frame for {gap:.1?}"
        );
        assert!(stopped < Duration::from_secs(1) && gap < GAP, "{what}");
        wait_until("it is released", || {
            bus::control(operator, &sim.name(), Control::Release).is_ok()
        });
        sim.wait_for_event("released", Value::Null);
    }
    sim.play_on(1.0);
    all_stay(&mut agents);
    let done = sim.stop();
    FOUR.iter().for_each(|name| {
        assert_eq!(
            done["outcome"]["counts"]["boats"][name]["agents_lost"], 0,
            "{name}"
        )
    });
}
