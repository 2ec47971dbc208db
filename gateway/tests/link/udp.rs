//! Links by UDP.

use crate::ears::{LIMIT, connect, listen, open, patient, up};
use gateway::link::{LinkAddress, LinkSettings};
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
    let (server, server_ears) = listen(ANY);
    let (client, client_ears) = connect(&server.reach(), patient());
    client_ears.up(0);
    server.send(b"to nobody".to_vec(), 1);
    let all: Vec<u8> = (0..=255).collect();
    client.send(all.clone(), 0);
    server_ears.up(0);
    server_ears.heard(&all);
    server.send(b"aye".to_vec(), 2);
    client_ears.heard(b"aye");
    server_ears.written(2);
    client_ears.written(0);
}

#[test]
fn an_empty_datagram_is_a_word_but_no_bytes() {
    let (server, ears) = listen(ANY);
    let peer = speak(&server.reach(), b"");
    ears.up(0);
    server.send(b"hm".to_vec(), 0);
    let mut got = [0; 9];
    assert_eq!(peer.recv(&mut got).unwrap(), 2);
    ears.written(0);
    assert_eq!(ears.all().len(), 2, "up and written");
}

#[test]
fn eight_are_served_and_a_ninth_is_not_heard_until_one_is_forgotten() {
    let address = LinkAddress::to_listen(ANY).unwrap();
    let silence = Duration::from_millis(400);
    let (server, ears) = open(&address, LinkSettings { silence: Some(silence), ..patient() });
    let peers: Vec<UdpSocket> = (0..9).map(|_| speak(&server.reach(), b"x")).collect();
    let (_, start) = ears.up(7);
    let (reason, down) = ears.down(7);
    assert!(reason.contains("no bytes for 400ms"), "{reason}");
    assert!(down - start >= silence - Duration::from_millis(50), "{:?}", down - start);
    let ups = ears.all().iter().filter_map(up).count();
    assert_eq!(ups, 8);
    peers[8].send(b"x").unwrap();
    assert_eq!(ears.up(8).0, 8);
}

#[test]
fn nobody_there_is_no_error_and_somebody_who_comes_is_found() {
    let (server, _) = listen(ANY);
    let reach = server.reach();
    drop(server);
    let (client, ears) = connect(&reach, patient());
    ears.up(0);
    client.send(b"x".to_vec(), 0);
    let (reason, _) = ears.down(0);
    assert!(reason.contains("refused"), "{reason}");
    ears.up(1);

    let (server, server_ears) = listen(&reach);
    let start = Instant::now();
    let mut tag = 1;
    while server_ears.all().is_empty() {
        assert!(start.elapsed() < LIMIT, "never found again: {:?}", ears.all());
        client.send(b"x".to_vec(), tag);
        tag += 1;
        std::thread::yield_now();
    }
    server_ears.up(0);
    server.send(b"aye".to_vec(), 0);
    ears.heard(b"aye");
}

#[test]
fn a_dropped_link_frees_its_port() {
    let (server, ears) = listen(ANY);
    let _peer = speak(&server.reach(), b"x");
    ears.up(0);
    let address = server.reach();
    let start = Instant::now();
    drop(server);
    assert!(start.elapsed() < Duration::from_millis(200), "{:?}", start.elapsed());
    listen(&address);
}
