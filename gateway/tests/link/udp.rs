//! Links over UDP.

use crate::event_log::{LIMIT, close, connect, listen, open, patient, up};
use gateway::link::{BoatLink, LinkAddress, LinkEvent, LinkSettings};
use std::net::UdpSocket;
use std::time::{Duration, Instant};

const ANY: &str = "udp://127.0.0.1:0";

fn speak(to: &str, bytes: &[u8]) -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(to.strip_prefix("udp://").unwrap()).unwrap();
    socket.set_read_timeout(Some(LIMIT)).unwrap();
    socket.send(bytes).unwrap();
    socket
}

#[test]
fn bytes_go_both_ways() {
    let (server, server_log) = listen(ANY);
    let (client, client_log) = connect(&server.reach(), patient());
    client_log.up(0);
    server.send(b"to nobody".to_vec(), 1);
    let all: Vec<u8> = (0..=255).collect();
    client.send(all.clone(), 0);
    server_log.up(0);
    server_log.received(&all);
    server.send(b"aye".to_vec(), 2);
    client_log.received(b"aye");
    server_log.written(2);
    client_log.written(0);
}

#[test]
fn an_empty_datagram_brings_a_peer_up_without_bytes() {
    let (server, log) = listen(ANY);
    let peer = speak(&server.reach(), b"");
    log.up(0);
    server.send(b"hm".to_vec(), 0);
    let mut got = [0; 9];
    assert_eq!(peer.recv(&mut got).unwrap(), 2);
    log.written(0);
    assert_eq!(log.all().len(), 2, "up and written");
}

#[test]
fn eight_are_served_and_a_ninth_only_when_one_is_forgotten() {
    let address = LinkAddress::to_listen(ANY).unwrap();
    let silence = Duration::from_millis(400);
    let (server, log) = open(
        &address,
        LinkSettings {
            silence: Some(silence),
            ..patient()
        },
    );
    let peers: Vec<UdpSocket> = (0..9).map(|_| speak(&server.reach(), b"x")).collect();
    let (_, start) = log.up(7);
    let (reason, down) = log.down(7);
    assert!(reason.contains("no bytes for 400ms"), "{reason}");
    assert!(
        down - start >= silence - Duration::from_millis(50),
        "{:?}",
        down - start
    );
    let ups = log.all().iter().filter_map(up).count();
    assert_eq!(ups, 8);
    peers[8].send(b"x").unwrap();
    assert_eq!(log.up(8).0, 8);
}

#[test]
fn nobody_there_is_no_error_and_somebody_who_comes_is_found() {
    let (server, _) = listen(ANY);
    let reach = server.reach();
    drop(server);
    let (client, log) = connect(&reach, patient());
    log.up(0);
    client.send(b"x".to_vec(), 0);
    let (reason, _) = log.down(0);
    assert!(reason.contains("refused"), "{reason}");
    log.up(1);

    let (server, server_log) = listen(&reach);
    let start = Instant::now();
    let mut tag = 1;
    while server_log.all().is_empty() {
        assert!(
            start.elapsed() < LIMIT,
            "never found again: {:?}",
            log.all()
        );
        client.send(b"x".to_vec(), tag);
        tag += 1;
        std::thread::yield_now();
    }
    server_log.up(0);
    server.send(b"aye".to_vec(), 0);
    log.received(b"aye");
}

#[test]
fn a_port_that_is_listened_on_is_linked_to_its_first_sender_and_to_the_next_after_silence() {
    let free = UdpSocket::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    let address = LinkAddress::to_connect(&format!("udp-listen://{free}")).unwrap();
    let (link, log) = open(
        &address,
        LinkSettings {
            silence: Some(Duration::from_millis(400)),
            ..patient()
        },
    );
    let mut got = [0; 9];
    for round in 0..2_u32 {
        let boat = UdpSocket::bind("127.0.0.1:0").unwrap();
        boat.set_read_timeout(Some(Duration::from_millis(20)))
            .unwrap();
        let start = Instant::now();
        // Like a boat that does not know whether anyone is listening.
        let count = loop {
            assert!(start.elapsed() < LIMIT, "no link: {:?}", log.all());
            let _ = boat.send_to(&[b'a' + round as u8; 3], free);
            link.send(b"aye".to_vec(), u64::from(round));
            if let Ok((count, from)) = boat.recv_from(&mut got) {
                assert_eq!(
                    from, free,
                    "the answer comes from the port that was addressed"
                );
                break count;
            }
        };
        assert!(got[..count].starts_with(b"aye"), "{got:?}");
        assert_eq!(log.up(round as usize).0, round);
        let is_its = |event: &LinkEvent| matches!(event, LinkEvent::Bytes { peer, bytes, .. } if *peer == round && bytes[0] == b'a' + round as u8);
        log.until("its bytes", |events| {
            events.iter().any(|(_, event)| is_its(event)).then_some(())
        });
        assert!(
            log.down(round as usize).0.contains("no bytes"),
            "{:?}",
            log.all()
        );
    }
    drop(link);
}

#[test]
fn a_dropped_link_frees_its_port() {
    let (server, log) = listen(ANY);
    let _peer = speak(&server.reach(), b"x");
    log.up(0);
    let address = server.reach();
    close(server);
    listen(&address);
}
