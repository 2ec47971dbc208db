//! A boat at the other end of a gateway's link: it reports no faults, follows commands, and records
//! their times.

use gateway::emulator::{Emulator, FrontSeat, Plan, Port};
use gateway::nmea::{Framer, Mode, Sentence, date_and_time};
use messages::picture::{Nav, OwnBoat};
use primitives::frame::LatLon;
use primitives::{SimTime, VehicleId};
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

const TELEMETRY_EVERY: Duration = Duration::from_millis(100);

/// A boat at rest in the middle of the field.
pub(crate) struct Boat {
    pub(crate) link: String,
    /// The commanded modes, with their times of arrival.
    pub(crate) commands: Receiver<(Instant, Mode)>,
}

impl Boat {
    pub(crate) fn start(datum: LatLon) -> Boat {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let link = format!("tcp://{}", listener.local_addr().expect("bound"));
        let (sender, commands) = channel();
        std::thread::spawn(move || {
            listener
                .incoming()
                .map_while(Result::ok)
                .for_each(|stream| serve(stream, datum, &sender));
        });
        Boat { link, commands }
    }

    /// The time of the next command with this mode.
    pub(crate) fn next(&self, wanted: &Mode, limit: Duration) -> Instant {
        let start = Instant::now();
        loop {
            let left = limit.saturating_sub(start.elapsed());
            let (at, mode) = self
                .commands
                .recv_timeout(left)
                .expect("it is sent to the boat in time");
            if mode == *wanted {
                return at;
            }
        }
    }
}

fn serve(mut stream: TcpStream, datum: LatLon, commands: &Sender<(Instant, Mode)>) {
    let began = date_and_time(recording::utc::now_ns());
    let plan = Plan {
        datum,
        declination_rad: 0.0,
        watchdog_s: None,
        integers: false,
        extra: vec![],
        began,
        charge: Some(1.0),
    };
    let mut emulator = Emulator::new(plan);
    let mut framer = Framer::new();
    let nav = Nav {
        north_m: 40.0,
        east_m: 80.0,
        ..Nav::default()
    };
    let start = Instant::now();
    let mut due = Instant::now();
    let mut bytes = [0; 4096];
    stream.set_nodelay(true).expect("a socket");
    loop {
        let now = SimTime::from_s(start.elapsed().as_secs_f64());
        if Instant::now() >= due {
            due += TELEMETRY_EVERY;
            emulator.observe(
                now,
                &OwnBoat {
                    fix_ns: now,
                    ..OwnBoat::new(VehicleId(0), nav)
                },
            );
            let mut burst = Vec::new();
            emulator.telemetry(now, &mut burst);
            if stream.write_all(&burst).is_err() {
                return;
            }
        }
        let wait = due
            .saturating_duration_since(Instant::now())
            .max(Duration::from_millis(1));
        stream.set_read_timeout(Some(wait)).expect("a socket");
        let read = match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => &bytes[..count],
            Err(e) if e.kind() == ErrorKind::WouldBlock => continue,
            Err(_) => return,
        };
        let at = Instant::now();
        emulator.receive(now, Port::Secondary, read);
        framer.push(read, &mut |body| {
            if let Ok(Sentence::Command(command)) = Sentence::parse(body) {
                let _ = commands.send((at, command.mode));
            }
        });
    }
}
