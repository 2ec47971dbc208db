//! Links that listen on a TCP port.

use crate::event_log::{EventLog, LIMIT, close, listen, open, patient, read};
use gateway::link::{
    BoatLink, HostPort, Link, LinkAddress, LinkError, LinkEvent, LinkSettings, Side,
};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

const ANY: &str = "tcp://127.0.0.1:0";

/// Connects the maximum number of peers.
fn join_all(link: &Link, log: &EventLog) -> Vec<TcpStream> {
    let all = (0..8).map(|_| join(link)).collect();
    log.up(7);
    all
}

fn join(link: &Link) -> TcpStream {
    let reach = link.reach();
    let stream = TcpStream::connect(reach.strip_prefix("tcp://").unwrap()).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    stream
}

#[test]
fn what_is_sent_reaches_all_and_peers_are_told_apart() {
    let (link, log) = listen(ANY);
    let mut back_seats = join_all(&link, &log);
    link.send(b"$GPGGA".to_vec(), 5);
    for back_seat in &mut back_seats {
        assert_eq!(read(back_seat, 6), b"$GPGGA");
    }
    log.written(5);
    for (peer, back_seat) in back_seats.iter_mut().enumerate() {
        back_seat.write_all(&[peer as u8]).unwrap();
        log.until("its byte", |events| {
            let is_it = |event: &LinkEvent| matches!(event, LinkEvent::Bytes { bytes, .. } if *bytes == [peer as u8]);
            events.iter().any(|(_, event)| is_it(event)).then_some(())
        });
    }
    let numbers = log.all().into_iter().filter_map(|(_, event)| match event {
        LinkEvent::Bytes { peer, bytes, .. } => Some((peer, bytes)),
        _ => None,
    });
    let want: Vec<(u32, Vec<u8>)> = (0..8).map(|peer| (peer, vec![peer as u8])).collect();
    assert_eq!(numbers.collect::<Vec<_>>(), want);
}

#[test]
fn a_ninth_is_closed_at_once_and_finds_room_when_one_goes() {
    let (link, log) = listen(ANY);
    let mut back_seats = join_all(&link, &log);
    let mut ninth = join(&link);
    assert_eq!(ninth.read(&mut [0]).unwrap_or(0), 0);
    drop(back_seats.pop());
    log.down(0);
    let mut ninth = join(&link);
    assert_eq!(log.up(8).0, 8, "a number is never reused");
    link.send(b"ahoy".to_vec(), 0);
    assert_eq!(read(&mut ninth, 4), b"ahoy");
}

#[test]
fn a_peer_that_does_not_read_holds_up_nobody_and_is_dropped() {
    let (link, log) = listen(ANY);
    let mut quick = join(&link);
    let _slow = join(&link);
    log.up(1);
    let start = Instant::now();
    let mut slowest = Duration::ZERO;
    let mut tag = 0;
    // 64 KiB each, so that the slow peer's buffers soon fill up.
    while log
        .all()
        .iter()
        .all(|(_, event)| !matches!(event, LinkEvent::Down { .. }))
    {
        assert!(start.elapsed() < LIMIT, "the slow one is never dropped");
        let sent_at = Instant::now();
        link.send(vec![b'x'; 65536], tag);
        read(&mut quick, 65536);
        slowest = slowest.max(sent_at.elapsed());
        tag += 1;
    }
    assert!(slowest < Duration::from_millis(500), "{slowest:?}");
    assert!(link.displaced() > 0);
    let (_, down) = log.down(0);
    assert!(
        down - start > Duration::from_millis(1900) && down - start < Duration::from_millis(5000)
    );
    link.send(b"on".to_vec(), tag);
    assert_eq!(read(&mut quick, 2), b"on");
    log.written(tag);
}

#[test]
fn a_silent_peer_stays_unless_the_settings_say_otherwise() {
    let address = LinkAddress::to_listen(ANY).unwrap();
    let (link, log) = open(
        &address,
        LinkSettings {
            silence: Some(Duration::from_millis(200)),
            ..patient()
        },
    );
    let (patient_link, patient_log) = listen(ANY);
    let _one = join(&link);
    let _other = join(&patient_link);
    let (reason, _) = log.down(0);
    assert!(reason.contains("no bytes for 200ms"), "{reason}");
    patient_log.up(0);
    assert_eq!(patient_log.all().len(), 1);
}

#[test]
fn a_dropped_link_frees_its_port_within_200_ms() {
    let (link, log) = listen(ANY);
    let mut back_seat = join(&link);
    log.up(0);
    let address = link.reach();
    close(link);
    assert_eq!(back_seat.read(&mut [0]).unwrap(), 0);
    let (again, log) = listen(&address);
    let _back_seat = join(&again);
    log.up(0);
}

#[test]
fn an_address_in_use_is_refused() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let address = LinkAddress::Tcp(
        Side::Listens,
        HostPort {
            host: "127.0.0.1".to_owned(),
            port,
        },
    );
    let refused = Link::open(&address, patient(), drop)
        .err()
        .expect("the port is taken");
    assert!(matches!(refused, LinkError::Listen { .. }), "{refused}");
    assert!(refused.to_string().contains(&port.to_string()), "{refused}");
}
