//! Shutdown messages: the last bytes sent by a link.

use crate::event_log::{LIMIT, listen};
use crate::tcp_client::joined_narrowly;
use gateway::link::{BoatLink, Link};
use std::io::Read;
use std::net::TcpStream;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

const STANDBY: &[u8] = b"$PSEAC,L,0,0,0,*14\r\n";

/// Sends the shutdown message when dropped, even by a panic.
struct Guard(Link);

impl Drop for Guard {
    fn drop(&mut self) {
        assert!(self.0.send_and_wait(STANDBY, Duration::from_millis(500)));
    }
}

#[test]
fn a_guard_sends_it_while_its_thread_panics() {
    let (link, _log, mut boat, _listener) = joined_narrowly();
    let guard = Guard(link);
    let died = thread::spawn(move || {
        guard.0.send(b"$PSEAC,T,0,99,0,*00\r\n".to_vec(), 1);
        panic!("a bug, for a test");
    });
    let mut got = Vec::new();
    boat.read_to_end(&mut got).unwrap();
    assert!(died.join().is_err());
    assert!(
        got.ends_with(STANDBY),
        "{:?}",
        String::from_utf8_lossy(&got)
    );
}

#[test]
fn without_a_peer_it_fails_at_once() {
    let (link, _) = listen("tcp://127.0.0.1:0");
    let start = Instant::now();
    assert!(!link.send_and_wait(STANDBY, LIMIT));
    assert!(
        start.elapsed() < Duration::from_millis(200),
        "{:?}",
        start.elapsed()
    );
}

#[test]
fn a_peer_that_does_not_read_delays_it_up_to_the_limit_only() {
    let (link, _log, mut boat, _listener) = joined_narrowly();
    begin_bulk(&link, &mut boat);
    let limit = Duration::from_millis(300);
    let start = Instant::now();
    assert!(!link.send_and_wait(STANDBY, limit));
    let took = start.elapsed();
    assert!(
        took >= limit && took < limit + Duration::from_millis(200),
        "{took:?}"
    );
    assert!(read_until(&mut boat, STANDBY), "late, but sent");
}

#[test]
fn it_displaces_what_is_queued_and_nothing_displaces_it() {
    let (link, _log, mut boat, _listener) = joined_narrowly();
    let link = Arc::new(link);
    begin_bulk(&link, &mut boat);
    link.send(b"$PSEAC,T,0,98,0,*00\r\n".to_vec(), 1);
    let before = link.displaced();
    let sender = Arc::clone(&link);
    let sent = thread::spawn(move || sender.send_and_wait(STANDBY, Duration::from_millis(1500)));
    let start = Instant::now();
    while link.displaced() == before {
        assert!(
            start.elapsed() < LIMIT,
            "the shutdown message displaced nothing"
        );
        thread::yield_now();
    }
    link.send(b"$PSEAC,T,0,99,0,*00\r\n".to_vec(), 2);
    assert_eq!(
        link.displaced(),
        before + 2,
        "a pending set-point, and one that came too late"
    );
    assert!(read_until(&mut boat, STANDBY));
    assert!(sent.join().unwrap());
    link.send(b"after".to_vec(), 3);
    assert!(read_until(&mut boat, b"after"), "and work continues");
}

/// Starts to send more than the buffers hold: nothing else is written until the boat reads.
fn begin_bulk(link: &Link, boat: &mut TcpStream) {
    link.send(vec![b'x'; 8 << 20], 0);
    boat.read_exact(&mut [0]).unwrap();
}

/// Reads until the last bytes equal `end`; returns false if they included a set-point.
fn read_until(boat: &mut TcpStream, end: &[u8]) -> bool {
    let mut got = Vec::new();
    let mut buffer = vec![0; 65536];
    while !got.ends_with(end) {
        let count = boat.read(&mut buffer).unwrap();
        assert!(
            count > 0,
            "closed before {:?}",
            String::from_utf8_lossy(end)
        );
        got.extend_from_slice(&buffer[..count]);
    }
    !got.windows(8).any(|eight| eight == b"$PSEAC,T")
}
