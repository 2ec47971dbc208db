//! Links that connect by TCP.

use crate::event_log::{EventLog, LIMIT, close, connect, patient, read, retrying, up, wait};
use gateway::link::{BoatLink, Link, LinkSettings};
use socket2::SockRef;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

fn listener() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp://{}", listener.local_addr().unwrap());
    (listener, address)
}

/// A link and the boat that accepted it.
type Joined = (Link, Arc<EventLog>, TcpStream, TcpListener);

fn joined(settings: LinkSettings) -> Joined {
    joined_at(listener(), settings)
}

/// A link and a boat with small buffers.
pub(crate) fn joined_narrowly() -> Joined {
    let (listener, address) = listener();
    SockRef::from(&listener).set_recv_buffer_size(4096).unwrap();
    joined_at((listener, address), patient())
}

fn joined_at((listener, address): (TcpListener, String), settings: LinkSettings) -> Joined {
    let (link, log) = connect(&address, settings);
    let stream = accept(&listener);
    assert_eq!(log.up(0).0, 0);
    (link, log, stream, listener)
}

/// Accepts a connection with a read timeout.
fn accept(listener: &TcpListener) -> TcpStream {
    let (stream, _) = listener.accept().unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    stream.set_nodelay(true).unwrap();
    stream
}

#[test]
fn single_bytes_go_out_and_come_back() {
    let (link, log, mut boat, _listener) = joined(patient());
    let mut sent = Vec::new();
    for byte in 0..=255 {
        link.send(vec![byte], u64::from(byte));
        let echo = read(&mut boat, 1);
        boat.write_all(&echo).unwrap();
        sent.push(byte);
        log.received(&sent);
        log.written(u64::from(byte));
    }
    assert_eq!(link.displaced(), 0);
}

#[test]
fn sixty_four_kib_in_one_write_arrive_whole() {
    let (link, log, mut boat, _listener) = joined(patient());
    let bulk: Vec<u8> = (0..65536_u32).map(|i| (i % 251) as u8).collect();
    link.send(bulk.clone(), 7);
    assert!(
        read(&mut boat, bulk.len()) == bulk,
        "the received bytes differ from the sent ones"
    );
    log.written(7);
    boat.write_all(&bulk).unwrap();
    log.received(&bulk);
}

#[test]
fn a_server_that_is_gone_is_tried_with_growing_waits_and_found_when_it_returns() {
    let (link, log, boat, listener) = joined(retrying(
        Duration::from_millis(10),
        Duration::from_millis(80),
    ));
    let address = listener.local_addr().unwrap();
    drop((boat, listener));
    log.down(0);
    let waits = log.until("five failures", |events| {
        let waits: Vec<u128> = events
            .iter()
            .filter_map(wait)
            .map(|wait| wait.as_millis())
            .collect();
        (waits.len() >= 5).then_some(waits)
    });
    assert!(
        waits.windows(2).all(|two| two[1] == (two[0] * 2).min(80)),
        "{waits:?}"
    );
    assert_eq!(waits.last(), Some(&80), "{waits:?}");

    let listener = TcpListener::bind(address).unwrap();
    let mut boat = accept(&listener);
    assert_eq!(log.up(1).0, 1);
    link.send(b"back".to_vec(), 1);
    assert_eq!(read(&mut boat, 4), b"back");
}

#[test]
fn nobody_there_is_no_error() {
    let (listener, address) = listener();
    drop(listener);
    let (link, log) = connect(&address, patient());
    assert_eq!(log.failure(), patient().retry_first);
    link.send(b"to nobody".to_vec(), 1);
    assert_eq!(link.displaced(), 0);
    assert_eq!(link.reach(), address);
}

#[test]
fn a_peer_that_closes_at_once_or_after_one_line_is_not_stormed() {
    for line in [&b""[..], b"$full*00\r\n"] {
        let (listener, address) = listener();
        let slam =
            thread::spawn(move || (0..6).for_each(|_| accept(&listener).write_all(line).unwrap()));
        let (_link, log) = connect(
            &address,
            retrying(Duration::from_millis(100), Duration::from_secs(5)),
        );
        // Attempts after 0, 100, 300, 700, 1500 and 3100 ms.
        let (_, sixth) = log.up(5);
        let first = log.up(0).1;
        assert!(
            sixth - first >= Duration::from_millis(3000),
            "six attempts in {:?}",
            sixth - first
        );
        let is_soon = |(_, at): &(u32, Instant)| *at - first < Duration::from_secs(1);
        let in_a_second = log.all().iter().filter_map(up).filter(is_soon).count();
        assert!(
            (3..=4).contains(&in_a_second),
            "{in_a_second} attempts in a second"
        );
        slam.join().unwrap();
    }
}

#[test]
fn a_link_that_was_good_for_some_time_is_tried_again_quickly() {
    let (listener, address) = listener();
    let (_link, log) = connect(
        &address,
        retrying(Duration::from_millis(20), Duration::from_secs(60)),
    );
    (0..5).for_each(|_| drop(accept(&listener)));
    // The next wait would have been 640 ms.
    let mut boat = accept(&listener);
    let (_, start) = log.up(5);
    let send = || boat.write_all(b"here\n").unwrap();
    chatter(start + Duration::from_millis(1200), &listener, send);
    drop(boat);
    let (_, gone) = log.down(5);
    drop(accept(&listener));
    let wait = log.up(6).1 - gone;
    assert!(wait < Duration::from_millis(300), "{wait:?}");
}

/// Sends until `end`, and checks in the pauses that there is no second connection.
fn chatter(end: Instant, listener: &TcpListener, mut talk: impl FnMut()) {
    SockRef::from(listener)
        .set_read_timeout(Some(Duration::from_millis(50)))
        .unwrap();
    while Instant::now() < end {
        talk();
        assert!(listener.accept().is_err(), "a second connection");
    }
    SockRef::from(listener).set_read_timeout(None).unwrap();
}

#[test]
fn a_peer_that_falls_silent_counts_as_gone() {
    let silence = Duration::from_millis(300);
    let (_link, log, mut boat, listener) = joined(LinkSettings {
        silence: Some(silence),
        ..patient()
    });
    let (_, up) = log.up(0);
    chatter(up + 2 * silence, &listener, || {
        boat.write_all(b"here\n").unwrap()
    });
    let (reason, down) = log.down(0);
    assert!(reason.contains("no bytes for 300ms"), "{reason}");
    assert!(
        down - up >= 3 * silence - Duration::from_millis(60),
        "chatter was not received: {:?}",
        down - up
    );
    assert!(
        down - up < 3 * silence + Duration::from_millis(500),
        "{:?}",
        down - up
    );
    // The link retries although this peer still holds the old connection.
    let _second = accept(&listener);
    assert_eq!(log.up(1).0, 1);
}

#[test]
fn a_peer_that_does_not_read_gets_the_newest_late_instead_of_all_in_order() {
    const SENT: u64 = 3000;
    const SIZE: usize = 1024;
    let (link, log, mut boat, _listener) = joined_narrowly();
    let mut slowest = Duration::ZERO;
    for tag in 0..SENT {
        let start = Instant::now();
        link.send(
            format!("{tag:0width$}\n", width = SIZE - 1).into_bytes(),
            tag,
        );
        slowest = slowest.max(start.elapsed());
    }
    assert!(
        slowest < Duration::from_millis(200),
        "a send took {slowest:?}"
    );
    assert!(
        link.displaced() > SENT / 2,
        "{} displaced",
        link.displaced()
    );

    let mut got: Vec<u64> = Vec::new();
    while got.last() != Some(&(SENT - 1)) {
        got.push(
            String::from_utf8(read(&mut boat, SIZE))
                .unwrap()
                .trim()
                .parse()
                .unwrap(),
        );
    }
    assert!(got.is_sorted(), "{got:?}");
    assert_eq!(
        got.len() as u64 + link.displaced(),
        SENT,
        "each is written whole or not at all"
    );
    assert!(got.len() < 200, "{} KiB were held for it", got.len());
    log.written(SENT - 1);
    let tags = log.all().len();
    assert!(
        tags <= got.len() + 1,
        "{tags} events for {} writes",
        got.len()
    );
}

#[test]
fn a_peer_that_reads_nothing_for_two_seconds_is_dropped_with_its_unread_data() {
    let (link, log, mut boat, _listener) = joined(patient());
    let start = Instant::now();
    link.send(vec![b'x'; 16 << 20], 0);
    let (reason, down) = log.down(0);
    assert!(
        down - start >= Duration::from_millis(1900),
        "{:?}: {reason}",
        down - start
    );
    assert!(
        down - start < Duration::from_millis(4500),
        "{:?}: {reason}",
        down - start
    );
    // A reset rather than a close, so data in flight is lost.
    let mut waste = Vec::new();
    assert!(
        boat.read_to_end(&mut waste).is_err(),
        "{} bytes and a graceful close",
        waste.len()
    );
    assert!(
        !log.all()
            .iter()
            .any(|(_, event)| matches!(event, gateway::link::LinkEvent::Written { .. }))
    );
}

#[test]
fn a_dropped_link_closes_gracefully_within_200_ms() {
    let (link, log, mut boat, listener) = joined(patient());
    link.send(b"last".to_vec(), 0);
    log.written(0);
    // Unread bytes would turn the close into a reset.
    boat.write_all(&[0; 1000]).unwrap();
    close(link);
    let mut got = Vec::new();
    boat.read_to_end(&mut got).unwrap();
    assert_eq!(got, b"last");
    assert_eq!(log.down(0).0, "closed here");
    SockRef::from(&listener)
        .set_read_timeout(Some(Duration::from_millis(200)))
        .unwrap();
    assert!(listener.accept().is_err(), "a dropped link connected again");
}

#[test]
fn a_boat_that_keeps_sending_receives_everything_before_the_close() {
    let (link, _ears, mut boat, _listener) = joined(patient());
    assert!(link.send_and_wait(b"last", LIMIT));
    let closer = thread::spawn(move || drop(link));
    let mut got = Vec::new();
    boat.read_to_end(&mut got).unwrap();
    assert_eq!(got, b"last");
    // A boat takes a moment to notice. It must not be reset in the meantime, because a reset could
    // discard data that it has not yet read.
    for _ in 0..10 {
        boat.write_all(b"$GPGGA")
            .expect("the link still listens for a moment");
        thread::sleep(Duration::from_millis(1));
    }
    drop(boat);
    closer.join().unwrap();
}

/// A full listener, which does not answer the next connection, like a radio out of range. Also
/// returns the connection that fills it.
fn full() -> (String, socket2::Socket, TcpStream) {
    let listener =
        socket2::Socket::new(socket2::Domain::IPV4, socket2::Type::STREAM, None).unwrap();
    listener
        .bind(
            &"127.0.0.1:0"
                .parse::<std::net::SocketAddr>()
                .unwrap()
                .into(),
        )
        .unwrap();
    listener.listen(0).unwrap();
    let address = listener.local_addr().unwrap().as_socket().unwrap();
    (
        format!("tcp://{address}"),
        listener,
        TcpStream::connect(address).unwrap(),
    )
}

#[test]
fn a_link_that_cannot_reach_anybody_is_dropped_as_quickly() {
    let (address, _listener, _first) = full();
    let (link, log) = connect(&address, patient());
    close(link);
    assert!(log.all().is_empty(), "{:?}", log.all());
}

#[test]
fn a_peer_that_never_answers_is_given_up_and_tried_again_after_a_second() {
    let (address, _listener, _first) = full();
    let start = Instant::now();
    let (_link, log) = connect(
        &address,
        LinkSettings {
            silence: None,
            ..LinkSettings::default()
        },
    );
    log.failure();
    let took = start.elapsed();
    assert!(
        took > Duration::from_millis(900) && took < Duration::from_millis(1500),
        "{took:?}"
    );
    log.until("the fourth failure", |events| {
        events.iter().filter_map(wait).nth(3)
    });
    let took = start.elapsed();
    assert!(
        took < Duration::from_millis(4900),
        "four attempts took {took:?}"
    );
}
