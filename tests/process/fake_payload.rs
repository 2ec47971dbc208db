//! Payloads of real boats: a camera that streams pictures over HTTP, and an EXO2 sonde, over a
//! serial server or with an HTTP server.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The sonde's output: temperature, pH, oxygen in mg/L.
pub(crate) const CODES: &str = "1 18 212";
pub(crate) const VALUES: [f64; 3] = [20.5, 7.25, -8.125];

/// A payload, and how many requests it has received.
pub(crate) struct FakePayload {
    pub(crate) address: SocketAddr,
    asked: Arc<AtomicU64>,
}

impl FakePayload {
    /// Serves each connection on a separate thread.
    fn start(
        serve: impl Fn(TcpStream, &AtomicU64) -> std::io::Result<()> + Send + Sync + 'static,
    ) -> FakePayload {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("an address");
        let asked = Arc::<AtomicU64>::default();
        let serve = Arc::new(serve);
        let counted = Arc::clone(&asked);
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let asked = Arc::clone(&counted);
                let serve = Arc::clone(&serve);
                // It is not an error if a client disconnects.
                std::thread::spawn(move || drop(serve(stream, &asked)));
            }
        });
        FakePayload { address, asked }
    }

    pub(crate) fn asked(&self) -> u64 {
        self.asked.load(Ordering::Relaxed)
    }

    /// Streams pictures for ever with this pause between them.
    pub(crate) fn camera(pause: Duration) -> FakePayload {
        FakePayload::start(move |mut stream, asked| {
            drop(request(&mut BufReader::new(stream.try_clone()?))?);
            asked.fetch_add(1, Ordering::Relaxed);
            stream.write_all(b"HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n")?;
            for number in 0_u32.. {
                let picture: Vec<u8> = (0..20_000_u32)
                    .map(|i| (i.wrapping_mul(number | 1) >> 5) as u8)
                    .collect();
                stream.write_all(b"--frame\r\nContent-Type: image/jpeg\r\n\r\n\xff\xd8")?;
                stream.write_all(&picture)?;
                stream.write_all(b"\xff\xd9\r\n")?;
                std::thread::sleep(pause);
            }
            Ok(())
        })
    }

    /// An HTTP/1.0 server at the sonde.
    pub(crate) fn http_sonde() -> FakePayload {
        FakePayload::start(|mut stream, asked| {
            let (head, body) = request(&mut BufReader::new(stream.try_clone()?))?;
            asked.fetch_add(1, Ordering::Relaxed);
            let answer = match (head.as_str(), body.as_str()) {
                (head, _) if head.starts_with("GET /data ") => answer("data"),
                (head, command) if head.starts_with("POST /data ") => answer(command),
                _ => String::new(),
            };
            write!(
                stream,
                "HTTP/1.0 200 OK\r\nServer: BaseHTTP/0.6\r\nContent-type: text/html\r\n\r\n{answer}"
            )
        })
    }

    /// The sonde itself: it echoes, prompts and counts commands.
    pub(crate) fn sonde() -> FakePayload {
        FakePayload::start(|mut stream, asked| {
            let mut command = String::new();
            stream.write_all(b"# ")?;
            for byte in BufReader::new(stream.try_clone()?).bytes() {
                let byte = byte?;
                stream.write_all(&[byte])?;
                if byte != b'\r' {
                    command.push(char::from(byte));
                    continue;
                }
                asked.fetch_add(1, Ordering::Relaxed);
                write!(stream, "\n{}\r\n# ", answer(&command))?;
                command.clear();
            }
            Ok(())
        })
    }

    /// Accepts connections, but neither reads nor writes.
    pub(crate) fn silent() -> FakePayload {
        FakePayload::start(|stream, _| {
            std::thread::sleep(Duration::from_secs(600));
            drop(stream);
            Ok(())
        })
    }
}

fn answer(command: &str) -> String {
    match command {
        "para" => CODES.to_owned(),
        "data" => VALUES.map(|value| value.to_string()).join(" "),
        _ => String::new(),
    }
}

/// The request line and the body of a request.
fn request(reader: &mut impl BufRead) -> std::io::Result<(String, String)> {
    let mut head = String::new();
    let mut length = 0;
    reader.read_line(&mut head)?;
    loop {
        let mut line = String::new();
        reader.read_line(&mut line)?;
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse().expect("a length");
        }
        if line.trim().is_empty() {
            break;
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    Ok((head, String::from_utf8_lossy(&body).into_owned()))
}
