//! Payloads behind a boat's gateway: traffic, recording, and the priority of the boat.

use crate::boat_alone::{Wire, tell};
use crate::fake_payload::{FakePayload, VALUES};
use crate::support::{LIMIT, Process, printed, squall, temporary, wait_until, wait_within};
use bus::token::TOKEN_VARIABLE;
use messages::payload::PayloadBytes;
use recording::Bag;
use serde_json::Value;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::path::Path;
use std::process::Stdio;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A gateway without a game, whose boat is a test wire.
struct Gateway {
    process: Process,
    wire: Wire,
    /// All of its output.
    printed: Arc<Mutex<Vec<String>>>,
    game: &'static str,
}

impl Gateway {
    fn start(game: &'static str, payloads: &[String], more: &[&str]) -> Gateway {
        let wire = Wire::listen("tcp://127.0.0.1:0");
        let address = wire.address();
        let payloads = payloads
            .iter()
            .flat_map(|payload| ["--payload", payload.as_str()]);
        let args = [
            "gateway",
            "surveyor",
            "--vehicle",
            "blue_one",
            "--game",
            game,
            "--link",
            &address,
        ];
        let args: Vec<&str> = args
            .into_iter()
            .chain(payloads)
            .chain(more.iter().copied())
            .collect();
        let mut command = squall(&args);
        command.env_remove(TOKEN_VARIABLE).stderr(Stdio::piped());
        let (mut process, lines) = Process::with_lines(command);
        let printed = Arc::<Mutex<Vec<String>>>::default();
        let said = BufReader::new(process.0.stderr.take().expect("piped"))
            .lines()
            .map_while(Result::ok);
        let lines: [Box<dyn Iterator<Item = String> + Send>; 2] = [Box::new(said), Box::new(lines)];
        for lines in lines {
            let printed = Arc::clone(&printed);
            std::thread::spawn(move || {
                lines.for_each(|line| printed.lock().expect("nobody panics").push(line))
            });
        }
        Gateway {
            process,
            wire,
            printed,
            game,
        }
    }

    fn printed(&self, part: &str) -> Vec<String> {
        let printed = self.printed.lock().expect("nobody panics");
        printed
            .iter()
            .filter(|line| line.contains(part))
            .cloned()
            .collect()
    }

    /// The address of a payload for clients.
    fn reach(&self, payload: &str) -> String {
        let mut reach = None;
        wait_until("it prints where the payload is reached", || {
            let line = self.printed(&format!("payload {payload} at tcp://")).pop();
            reach = line
                .and_then(|line| Some(line.split("tcp://").nth(1)?.split(' ').next()?.to_owned()));
            reach.is_some()
        });
        reach.expect("an address")
    }

    fn connect(&self, payload: &str) -> TcpStream {
        let stream = TcpStream::connect(self.reach(payload)).expect("it accepts");
        stream.set_read_timeout(Some(LIMIT)).expect("a limit");
        stream
    }

    /// Runs an operator's command.
    fn tell(&self, command: &str) -> String {
        tell(self.game, command)
    }

    fn end(&mut self) {
        self.process.signal("TERM");
        assert!(self.process.wait().success(), "{:?}", self.printed(""));
    }
}

/// Sends a request and reads the whole answer.
fn asked(mut stream: TcpStream, request: &str) -> String {
    stream.write_all(request.as_bytes()).expect("it is taken");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("an answer");
    answer
}

/// The bytes of one direction over each connection of a payload, in connection order.
fn recorded(bag: &Bag, topic: &str, outward: bool) -> Vec<Vec<u8>> {
    let mut by_connection = std::collections::BTreeMap::<u32, Vec<u8>>::new();
    for message in bag.on(topic) {
        let piece = message.read::<PayloadBytes>().expect("bytes of a payload");
        if piece.outward == outward {
            by_connection
                .entry(piece.connection)
                .or_default()
                .extend(piece.data);
        }
    }
    by_connection.into_values().collect()
}

#[test]
fn bytes_pass_both_ways_and_are_recorded_with_what_the_sonde_measures() {
    let camera = FakePayload::camera(Duration::from_millis(20));
    let http = FakePayload::http_sonde();
    let sonde = FakePayload::sonde();
    let dir = temporary();
    let file = dir.path().join("boat.mcap").display().to_string();
    let payloads = [
        format!("camera=tcp://{}", camera.address),
        format!("dac=tcp://{},exo2=http", http.address),
        format!("sonde=tcp://{},exo2,listen=127.0.0.1:0", sonde.address),
    ];
    let mut gateway = Gateway::start("payloads", &payloads, &["--record", &file]);
    // Without a client, the gateway queries the sondes for their parameters and then for values.
    wait_until("both sondes are asked", || {
        sonde.asked() >= 4 && http.asked() >= 4
    });
    let request = "GET /video_feed HTTP/1.1\r\nHost: camera\r\n\r\n";
    let mut stream = gateway.connect("camera");
    stream.write_all(request.as_bytes()).expect("it is taken");
    let mut seen = vec![0; 300_000];
    stream.read_exact(&mut seen).expect("pictures");
    drop(stream);
    assert!(
        asked(
            gateway.connect("dac"),
            "POST /data HTTP/1.0\r\nContent-Length: 4\r\n\r\npara"
        )
        .ends_with("\r\n\r\n1 18 212")
    );
    assert!(
        asked(gateway.connect("dac"), "GET /data HTTP/1.0\r\n\r\n")
            .ends_with("\r\n\r\n20.5 7.25 -8.125")
    );
    // A client has exclusive use of the sonde, even after half a command.
    let mut client = gateway.connect("sonde");
    client.write_all(b"da").expect("it is taken");
    let mut answer = [0; 4];
    client
        .read_exact(&mut answer)
        .expect("the prompt and the echo");
    assert_eq!(&answer, b"# da");
    let before = sonde.asked();
    std::thread::sleep(Duration::from_millis(2500));
    assert_eq!(sonde.asked(), before, "nobody else asks meanwhile");
    client.write_all(b"ta\r").expect("it is taken");
    client.shutdown(Shutdown::Write).expect("it says no more");
    let mut answer = String::new();
    client
        .read_to_string(&mut answer)
        .expect("the answer arrives anyway");
    assert_eq!(answer, "ta\r\n20.5 7.25 -8.125\r\n# ");
    wait_until("the sonde is asked again", || sonde.asked() >= before + 4);
    gateway.end();

    let bag = Bag::open(Path::new(&file)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(recorded(&bag, "payload/camera", true), [request.as_bytes()]);
    let pictures = recorded(&bag, "payload/camera", false);
    assert!(
        pictures.len() == 1 && pictures[0].starts_with(&seen),
        "what the client saw was recorded"
    );
    let commands = recorded(&bag, "payload/sonde", true);
    assert!(
        commands[0].starts_with(b"para\rdata\r") && commands.contains(&b"data\r".to_vec()),
        "{commands:?}"
    );
    for topic in ["values/sonde", "values/dac"] {
        let measured: Vec<Value> = bag
            .on(topic)
            .map(|message| message.read_json().expect("values"))
            .collect();
        assert!(measured.len() >= 4, "{topic}: {}", measured.len());
        for measured in measured {
            let column = |key: &str| -> Vec<Value> {
                measured["values"]
                    .as_array()
                    .expect("a list")
                    .iter()
                    .map(|value| value[key].clone())
                    .collect()
            };
            assert_eq!(column("name"), ["temperature", "pH", "ODO"]);
            assert_eq!(column("unit"), ["C", "", "mg/L"]);
            assert_eq!(column("value"), VALUES);
        }
    }
    for (args, part) in [
        (
            &["gateway", "replay", &file][..],
            "the replay equals the recording, byte for byte",
        ),
        (&["log", &file], "payload/camera"),
        (
            &["log", &file, "--csv", "payload/sonde"],
            "from_payload,20.5 7.25 -8.125",
        ),
        (
            &["log", &file, "--csv", "payload/dac"],
            "to_payload,GET /data HTTP/1.0",
        ),
        (&["log", &file, "--csv", "values/sonde"], "values.2.value"),
    ] {
        let said = printed(args);
        assert!(said.contains(part), "{args:?}: {said}");
    }
}

/// The longest pause in sentences to the boat, and their rate per second, over this period.
fn pace(wire: &Wire, over: Duration) -> (Duration, f64) {
    let count = || wire.received.visit(|text| text.matches("$PSEAC").count());
    let begin = Instant::now();
    let first = count();
    let mut last = begin;
    let mut seen = first;
    let mut longest = Duration::ZERO;
    while begin.elapsed() < over {
        std::thread::sleep(Duration::from_millis(5));
        let now = count();
        if now != seen {
            (longest, last, seen) = (longest.max(last.elapsed()), Instant::now(), now);
        }
    }
    (
        longest.max(last.elapsed()),
        (seen - first) as f64 / begin.elapsed().as_secs_f64(),
    )
}

#[test]
fn the_boat_is_commanded_ten_times_a_second_whatever_payloads_do() {
    let camera = FakePayload::camera(Duration::from_millis(1));
    let silent = FakePayload::silent();
    let nobody = bus::free_port(false).expect("a free port");
    let dir = temporary();
    let file = dir.path().join("boat.mcap").display().to_string();
    let payloads = [
        format!("camera=tcp://{}", camera.address),
        format!("gone=tcp://127.0.0.1:{nobody},exo2"),
        format!("silent=tcp://{},exo2=http", silent.address),
    ];
    let mut gateway = Gateway::start("payloads-hostile", &payloads, &["--record", &file]);
    gateway.wire.wait_for("$PSEAC,L", LIMIT);
    let began = Instant::now();
    // Clients that do not read, and one that writes to a payload that does not read.
    let mut stopped: Vec<TcpStream> = (0..3).map(|_| gateway.connect("camera")).collect();
    for stream in &mut stopped {
        stream
            .write_all(b"GET /video_feed HTTP/1.1\r\n\r\n")
            .expect("it is taken");
    }
    let mut full = gateway.connect("silent");
    full.set_write_timeout(Some(Duration::from_secs(1)))
        .expect("a limit");
    assert!(
        full.write_all(&vec![b'x'; 50_000_000]).is_err(),
        "it is held up"
    );
    // A client of a missing payload is disconnected, however often it connects.
    let gone = gateway.connect("gone");
    let address = gateway.reach("gone");
    assert_eq!(asked(gone, ""), "");
    let flood = std::thread::spawn(move || {
        while began.elapsed() < Duration::from_secs(14) {
            drop(TcpStream::connect(&address));
        }
    });
    let (longest, rate_hz) = pace(&gateway.wire, Duration::from_secs(6));
    eprintln!("under load: {rate_hz:.2} sentences a second, none for {longest:.0?} at the longest");
    assert!(
        rate_hz > 9.0 && longest < Duration::from_millis(500),
        "{rate_hz} Hz, {longest:?}"
    );
    let start = Instant::now();
    assert!(gateway.tell("estop").contains("e-stopped"));
    assert!(
        start.elapsed() < Duration::from_secs(3),
        "an E-stop takes {:?}",
        start.elapsed()
    );
    // Another client receives pictures.
    let mut stream = gateway.connect("camera");
    stream
        .write_all(b"GET /video_feed HTTP/1.1\r\n\r\n")
        .expect("it is taken");
    stream
        .read_exact(&mut vec![0; 1_000_000])
        .expect("pictures");
    drop(stream);
    let limit = Duration::from_secs(30);
    wait_within(limit, "who does not read is disconnected", || {
        !gateway.printed("a client accepted no data").is_empty()
    });
    wait_within(limit, "so is who is not read", || {
        !gateway.printed("the payload accepted no data").is_empty()
    });
    flood.join().expect("it ends");
    let remarks = gateway.printed("payload gone: ");
    let remarks_max = 1 + began.elapsed().as_secs() as usize / 10;
    assert!(
        (1..=remarks_max).contains(&remarks.len()),
        "{remarks:?} in {:?}",
        began.elapsed()
    );
    assert!(remarks[0].contains("refused"), "{remarks:?}");
    gateway.end();
    let replayed = printed(&["gateway", "replay", &file]);
    assert!(
        replayed.contains("byte for byte"),
        "all of the boat was recorded: {replayed}"
    );
}

#[test]
fn a_payload_whose_port_cannot_be_opened_is_a_warning() {
    let sonde = FakePayload::sonde();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let at = taken.local_addr().expect("an address");
    let payloads = [
        format!("sonde=tcp://{},listen={at}", sonde.address),
        format!("other=tcp://{}", sonde.address),
    ];
    let mut gateway = Gateway::start("payloads-taken", &payloads, &["--no-record"]);
    gateway.wire.wait_for("$PSEAC,L", LIMIT);
    wait_until("it warns", || {
        !gateway
            .printed("WARNING: payload sonde is not passed through")
            .is_empty()
    });
    let mut client = gateway.connect("other");
    client.write_all(b"para\r").expect("it is taken");
    let mut answer = [0; 17];
    client.read_exact(&mut answer).expect("an answer");
    assert_eq!(&answer, b"# para\r\n1 18 212\r");
    gateway.end();
}

#[test]
fn the_clients_of_a_serial_line_share_it_and_are_disconnected_with_it() {
    let payload = Wire::listen("pty");
    let dir = temporary();
    let file = dir.path().join("boat.mcap").display().to_string();
    let payloads = [format!("probe={}", payload.address())];
    let mut gateway = Gateway::start("payloads-serial", &payloads, &["--record", &file]);
    let mut clients = ["one", "two"].map(|_| gateway.connect("probe"));
    for (client, word) in clients.iter_mut().zip(["alpha\r", "beta\r"]) {
        client.write_all(word.as_bytes()).expect("it is taken");
        payload.wait_for(word, LIMIT);
        let mut seen = [0; 26];
        client.read_exact(&mut seen).expect("what the line says");
        assert!(
            String::from_utf8_lossy(&seen).contains("$PSEAG,N*22"),
            "{seen:?}"
        );
    }
    drop(payload);
    for client in &mut clients {
        // The connection is closed, with or without data in transit.
        let rest = client.read_to_end(&mut vec![]);
        assert!(
            rest.as_ref()
                .map_or_else(|e| e.kind() != ErrorKind::WouldBlock, |_| true),
            "{rest:?}"
        );
    }
    wait_until("it says so", || {
        !gateway.printed("payload probe: ").is_empty()
    });
    gateway.end();
    let bag = Bag::open(Path::new(&file)).unwrap_or_else(|e| panic!("{e}"));
    // Their order is random.
    let mut words = recorded(&bag, "payload/probe", true);
    words.sort();
    assert_eq!(words, [b"alpha\r".to_vec(), b"beta\r".to_vec()]);
    let said = recorded(&bag, "payload/probe", false);
    assert!(
        said.len() == 1
            && String::from_utf8_lossy(&said[0])
                .matches("$PSEAG,N*22\r\n")
                .count()
                >= 2
    );
}
