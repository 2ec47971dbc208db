//! Which clients may connect, and which may act.

use super::client::{Client, get};
use super::replay::show;
use super::{open_viewer, page, visit};
use bus::clock::now;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// RFC 6455: try again later.
const AGAIN: u16 = 1013;

#[test]
fn the_page_is_served_under_its_own_names_and_sealed() {
    let page = page(show(), Some("a secret"), &["boat.local"]);
    let at = page.address;
    for (host, path, status) in [
        (at.to_string(), "/", 200),
        (format!("localhost:{}", at.port()), "/index.html", 200),
        ("boat.local".to_owned(), "/", 200),
        ("evil.example".to_owned(), "/", 403),
        ("evil.example".to_owned(), "/ws", 403),
        (at.to_string(), "/whale", 404),
        (at.to_string(), "/whale.js", 404),
        (at.to_string(), "/../Cargo.toml", 404),
        (at.to_string(), "/%2e%2e/Cargo.toml", 404),
        (at.to_string(), "/ws", 400),
    ] {
        let (got, answer) = get(at, path, &host);
        assert_eq!(got, status, "{path} of {host}");
        let low = answer.to_lowercase();
        for header in [
            "content-security-policy: default-src 'self'",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cache-control: no-cache",
        ] {
            assert!(low.contains(header), "no {header} in {answer}");
        }
        assert!(
            status != 403 || answer.contains("not known as"),
            "no reason in {answer}"
        );
        assert!(
            status != 200 || low.contains("content-type: text/html; charset=utf-8"),
            "no page in {answer}"
        );
    }
    drop(page);
}

#[test]
fn other_pages_cannot_open_a_websocket() {
    let page = page(show(), None, &[]);
    let own = format!("http://{}", page.address);
    for (headers, refused) in [
        (vec![("Origin", own.as_str())], None),
        (vec![("Origin", "http://evil.example")], Some(403)),
        (vec![("Origin", "null")], Some(403)),
        (
            vec![("Host", "evil.example"), ("Origin", "http://evil.example")],
            Some(403),
        ),
    ] {
        assert_eq!(
            Client::connect(page.address, "/ws", &headers).err(),
            refused,
            "{headers:?}"
        );
    }
}

#[test]
fn only_clients_that_present_the_token_have_rights() {
    let page = page(show(), Some("a secret"), &[]);
    for (path, rights) in [
        ("/ws", false),
        ("/ws?token=guess", false),
        ("/ws?token=a%20secret", true),
    ] {
        let mut client = Client::connect(page.address, path, &[]).expect("everyone may watch");
        assert_eq!(client.text()["rights"], rights, "{path}");
    }
}

/// Sends a seek and waits until the server has received it.
fn seek(client: &mut Client, t_s: f64) {
    client.send(&format!(r#"{{"do":"seek","t_s":{t_s}}}"#));
    client.until("player", |player| player["t_s"] == t_s);
}

#[test]
fn a_new_page_replaces_the_longest_idle_of_too_many() {
    let page = page(show(), None, &[]);
    let mut clients: Vec<Client> = (0..64).map(|_| open_viewer(&page)).collect();
    seek(&mut clients[0], 3.0);
    let mut newcomer = open_viewer(&page);
    assert_eq!(newcomer.text()["kind"], "hello");
    assert_eq!(clients[1].close_code(), Some(AGAIN), "the page learns why");
    clients.remove(1);
    clients.iter_mut().for_each(|client| seek(client, 4.0));
    seek(&mut newcomer, 4.0);
}

#[test]
fn those_who_only_look_keep_nobody_out_who_may_act() {
    let page = page(show(), Some("secret"), &[]);
    let come = || Client::connect(page.address, "/ws?token=secret", &[]).expect("a slot is free");
    let mut operators: Vec<Client> = (0..8).map(|_| come()).collect();
    let onlookers: Vec<Client> = (0..200).map(|_| open_viewer(&page)).collect();
    operators
        .iter_mut()
        .for_each(|operator| assert_eq!(operator.text()["rights"], true));
    operators[1..]
        .iter_mut()
        .for_each(|operator| seek(operator, 3.0));
    // One more page displaces another.
    let mut another = come();
    seek(&mut another, 3.0);
    assert_eq!(operators[0].close_code(), Some(AGAIN));
    operators[1..]
        .iter_mut()
        .for_each(|operator| seek(operator, 4.0));
    drop(onlookers);
}

#[test]
fn a_request_that_does_not_come_to_its_end_is_not_waited_for() {
    let page = page(show(), None, &[]);
    let end = now() + Duration::from_secs(25);
    let mut line = TcpStream::connect(page.address).expect("the server listens");
    line.set_read_timeout(Some(Duration::from_millis(100)))
        .expect("the timeout is valid");
    line.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\nX-Slow: ")
        .expect("the server listens");
    let is_cut =
        std::iter::from_fn(|| (now() < end).then(|| (line.write(b"x"), line.read(&mut [0; 64]))))
            .find_map(|tried| match tried {
                (Ok(_), Err(e))
                    if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
                {
                    None
                }
                (Ok(_), Ok(0)) | (Err(_), _) | (_, Err(_)) => Some(true),
                (_, Ok(_)) => None,
            });
    assert_eq!(
        is_cut,
        Some(true),
        "a byte from time to time kept the connection open"
    );
}

#[test]
fn pages_hear_of_the_end() {
    let (page, mut client) = visit(show());
    client.text();
    drop(page);
    assert!(client.is_hung_up_on());
}
