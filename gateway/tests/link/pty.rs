//! Links that provide a pseudo-terminal.

use crate::event_log::{LIMIT, close, listen, patient, read};
use gateway::link::{BoatLink, Link, LinkAddress, LinkError};
use serial2::{KeepSettings, SerialPort};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::time::{Duration, Instant};

/// Opens a terminal without changing its settings, as `cat` would.
fn attach(path: impl AsRef<Path>) -> SerialPort {
    let mut reader = SerialPort::open(path, KeepSettings).unwrap();
    reader.set_read_timeout(LIMIT).unwrap();
    reader
}

fn line(number: u64) -> Vec<u8> {
    format!("{number:06}\n").into_bytes()
}

#[test]
fn bytes_go_both_ways_unchanged() {
    let (link, log) = listen("pty");
    log.up(0);
    let mut reader = attach(link.reach());
    // Line endings and control characters are passed through unchanged.
    let all: Vec<u8> = (0..=255).collect();
    link.send(all.clone(), 1);
    assert_eq!(read(&mut reader, 256), all);
    log.written(1);
    reader.write_all(&all).unwrap();
    log.received(&all);
}

#[test]
fn who_comes_late_gets_what_is_new() {
    let (link, log) = listen("pty");
    let (_, start) = log.up(0);
    let mut sent_at = Vec::new();
    while start.elapsed() < Duration::from_millis(1500) {
        let number = sent_at.len() as u64;
        sent_at.push(Instant::now());
        link.send(line(number), number);
        // The data rate of a talkative boat.
        pause(Duration::from_millis(5));
    }
    let mut reader = attach(link.reach());
    let attached = Instant::now();
    let first: usize = String::from_utf8(read(&mut reader, 7))
        .unwrap()
        .trim()
        .parse()
        .unwrap();
    let age = attached - sent_at[first];
    assert!(
        age < Duration::from_millis(700),
        "{age:?} old: {first} of {}",
        sent_at.len()
    );
}

#[test]
fn what_nobody_reads_does_not_stay() {
    let (link, log) = listen("pty");
    log.up(0);
    // Attached, but not reading.
    let mut reader = attach(link.reach());
    link.send(b"stale".to_vec(), 0);
    log.written(0);
    let unread = || rustix::io::ioctl_fionread(&reader).unwrap();
    wait_for("some of it unread", || unread() > 0);
    wait_for("none of it unread", || unread() == 0);
    link.send(b"fresh".to_vec(), 1);
    assert_eq!(read(&mut reader, 5), b"fresh");
}

#[test]
fn nobody_on_it_blocks_nothing() {
    let (link, log) = listen("pty");
    let (_, start) = log.up(0);
    let mut tag = 0;
    while start.elapsed() < Duration::from_millis(1500) {
        let sent_at = Instant::now();
        link.send(vec![b'x'; 20_000], tag);
        assert!(
            sent_at.elapsed() < Duration::from_millis(200),
            "{:?}",
            sent_at.elapsed()
        );
        tag += 1;
        pause(Duration::from_millis(5));
    }
    assert!(link.displaced() > 0);
    let reader = attach(link.reach());
    link.send(b"fresh".to_vec(), tag);
    let mut got = Vec::new();
    while !got.ends_with(b"fresh") {
        let mut some = [0; 4096];
        let count = reader.read(&mut some).unwrap();
        got.extend_from_slice(&some[..count]);
    }
    assert_eq!(
        log.all().iter().filter_map(crate::event_log::up).count(),
        1,
        "nothing is lost because of it"
    );
    close(link);
}

#[test]
fn a_reader_that_keeps_up_gets_everything() {
    let (link, log) = listen("pty");
    log.up(0);
    let mut reader = attach(link.reach());
    for number in 0..200 {
        link.send(line(number), number);
        assert_eq!(read(&mut reader, 7), line(number));
        pause(Duration::from_millis(5));
    }
    assert_eq!(link.displaced(), 0);
}

#[test]
fn a_symlink_leads_to_it_over_an_old_one_and_goes_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let boat = folder.path().join("boat");
    symlink("/dev/pts/none", &boat).unwrap();
    let (link, log) = listen(&format!("pty://{}", boat.display()));
    log.up(0);
    assert_eq!(fs::read_link(&boat).unwrap(), Path::new(&link.reach()));
    let mut reader = attach(&boat);
    link.send(b"ahoy".to_vec(), 0);
    assert_eq!(read(&mut reader, 4), b"ahoy");
    drop(link);
    assert!(fs::symlink_metadata(&boat).is_err(), "the symlink stays");
}

#[test]
fn a_symlink_that_is_somebody_elses_by_now_stays() {
    let folder = tempfile::tempdir().unwrap();
    let boat = folder.path().join("boat");
    let (first, _) = listen(&format!("pty://{}", boat.display()));
    let (second, _) = listen(&format!("pty://{}", boat.display()));
    drop(first);
    assert_eq!(fs::read_link(&boat).unwrap(), Path::new(&second.reach()));
}

#[test]
fn nothing_but_an_old_symlink_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("letter");
    fs::write(&file, "dear").unwrap();
    for path in [
        file.clone(),
        folder.path().to_owned(),
        folder.path().join("no/such/folder"),
    ] {
        let address = LinkAddress::Pty {
            link: Some(path.clone()),
        };
        let refused = Link::open(&address, patient(), drop)
            .err()
            .expect("it is in the way");
        assert!(matches!(refused, LinkError::Symlink { .. }), "{refused}");
        assert!(
            refused.to_string().contains(&path.display().to_string()),
            "{refused}"
        );
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), "dear");
}

fn pause(length: Duration) {
    std::thread::sleep(length);
}

fn wait_for(what: &str, is_there: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_there() {
        assert!(start.elapsed() < LIMIT, "no {what} within {LIMIT:?}");
        pause(Duration::from_millis(1));
    }
}
