//! A boat for ArduPilot's firmware: a stand-in implements the firmware's side of its JSON back end.

use crate::support::{LIMIT, Process, Sim, newest, stderr, wait_within};
use messages::{Frame, topic};
use primitives::codec;
use std::net::UdpSocket;
use std::process::Stdio;
use std::time::Duration;

/// The firmware's side, at its usual rate.
struct Firmware {
    socket: UdpSocket,
    step: u32,
}

impl Firmware {
    fn connect(port: &str) -> Firmware {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        socket.connect(port).expect("an address");
        socket
            .set_read_timeout(Some(Duration::from_secs(10)))
            .expect("a limit");
        Firmware { socket, step: 0 }
    }

    /// One step with this thrust of both thrusters; returns the timestamp and the position.
    fn step(&mut self, pulse_us: u16) -> (f64, [f64; 3]) {
        let mut pulses_us = [0_u16; 16];
        (pulses_us[0], pulses_us[2]) = (pulse_us, pulse_us);
        let count = [(self.step & 0xffff) as u16, (self.step >> 16) as u16];
        let words = [&[18_458, 400], &count[..], &pulses_us].concat();
        let datagram: Vec<u8> = words
            .iter()
            .flat_map(|word: &u16| word.to_le_bytes())
            .collect();
        self.socket.send(&datagram).expect("the port is open");
        self.step += 1;
        let mut line = [0; 1024];
        let count = self.socket.recv(&mut line).expect("a reply");
        let state: serde_json::Value = serde_json::from_slice(&line[..count]).expect("JSON");
        let position = [0, 1, 2].map(|i| state["position"][i].as_f64().expect("a number"));
        (state["timestamp"].as_f64().expect("a number"), position)
    }
}

#[test]
fn a_firmware_sails_a_simulated_boat_and_a_dead_one_stops_it() {
    let sim = Sim::start(
        "real_attacker",
        &["--pace", "realtime", "--afloat", "blue_one"],
    );
    let mut command = sim.squall(&[
        "gateway",
        "sitl",
        "--vehicle",
        "blue_one",
        "--listen",
        "127.0.0.1:0",
    ]);
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    let (_boat, mut lines) = Process::with_lines(command);
    let line = lines
        .find(|line| line.starts_with("firmware at "))
        .expect("it prints where it listens");
    std::thread::spawn(move || lines.for_each(drop));
    let (port, home) = line["firmware at udp://".len()..]
        .split_once(", started with --home ")
        .expect(&line);
    let datum = sim.session().2.field.plan.datum;
    assert_eq!(home, format!("{},{},0,0", datum.lat_deg, datum.lon_deg));

    let bus = sim.bus();
    let (frame, _frames) = newest(&bus, topic::frame(&sim.name()), |bytes| {
        codec::decode::<Frame>(bytes).expect("a frame")
    });
    let is_still = || {
        frame.visit(|frame| {
            frame
                .vehicles
                .first()
                .is_none_or(|boat| boat.port_newton.abs() < 0.5)
        })
    };
    // A stranger's datagrams change nothing.
    let stranger = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let mut firmware = Firmware::connect(port);
    let start = firmware.step(1500);
    let mut last = start;
    while last.0 < 5.0 {
        let now = firmware.step(1900);
        stranger.send_to(&[0; 40], port).expect("it is sent");
        assert!(
            (now.0 - last.0 - 0.0025).abs() < 0.003,
            "{} s after {} s",
            now.0,
            last.0
        );
        last = now;
    }
    let moved = ((last.1[0] - start.1[0]).powi(2) + (last.1[1] - start.1[1]).powi(2)).sqrt();
    assert!(
        (2.0..10.0).contains(&moved),
        "{moved} m at full ahead in 5 s from rest"
    );
    assert!(!is_still());
    drop(firmware);
    wait_within(LIMIT, "a dead firmware's boat stops", is_still);
}

#[test]
fn a_taken_port_and_lockstep_are_refused_in_words() {
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let listen = taken.local_addr().expect("its address").to_string();
    let refusal = |sim: &Sim| {
        let output = sim.run(&[
            "gateway",
            "sitl",
            "--vehicle",
            "blue_one",
            "--listen",
            &listen,
        ]);
        assert!(!output.status.success());
        stderr(&output)
    };
    let realtime = Sim::start(
        "real_attacker",
        &["--pace", "realtime", "--afloat", "blue_one"],
    );
    let text = refusal(&realtime);
    assert!(
        text.contains(&listen) && text.contains("--listen"),
        "{text}"
    );
    let lockstep = Sim::start("real_attacker", &["--afloat", "blue_one"]);
    let text = refusal(&lockstep);
    assert!(
        text.contains("lockstep") && text.contains("realtime"),
        "{text}"
    );
}
