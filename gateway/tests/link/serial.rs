//! Links to a serial line, with a pseudo-terminal as the boat's end.

use crate::event_log::{connect, listen, patient, wait};
use gateway::link::{BoatLink, LinkEvent};
use serial2::SerialPort;
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::time::{Duration, Instant};

#[test]
fn bytes_go_both_ways_and_a_hang_up_is_survived() {
    let folder = tempfile::tempdir().unwrap();
    let device = folder.path().join("ttyBOAT");
    let pty = format!("pty://{}", device.display());
    let (boat, boat_log) = listen(&pty);
    let (link, log) = connect(
        &format!("serial://{}?baud=4800", device.display()),
        patient(),
    );
    log.up(0);
    let all: Vec<u8> = (0..=255).collect();
    link.send(all.clone(), 3);
    boat_log.received(&all);
    log.written(3);
    boat.send(all.clone(), 0);
    log.received(&all);

    drop(boat);
    log.down(0);
    // The symlink was removed with the terminal.
    let reason = log.until("failure", |events| {
        events.iter().find_map(|(_, event)| match event {
            LinkEvent::Failed { reason, .. } => Some(reason.clone()),
            _ => None,
        })
    });
    assert!(
        reason.contains("ttyBOAT") && reason.contains("No such file"),
        "{reason}"
    );

    let (_boat, boat_log) = listen(&pty);
    assert_eq!(log.up(1).0, 1);
    link.send(b"again".to_vec(), 4);
    boat_log.received(b"again");
}

#[test]
fn what_is_no_serial_line_is_tried_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("letter");
    std::fs::write(&file, "dear").unwrap();
    let (_link, log) = connect(&format!("serial://{}", file.display()), patient());
    log.until("second failure", |events| {
        events.iter().filter_map(wait).nth(1)
    });
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "dear");
}

#[test]
fn a_slow_line_gets_the_newest_rather_than_all_in_order() {
    let (boat, boat_log) = listen("pty");
    let (link, log) = connect(&format!("serial://{}?baud=4800", boat.reach()), patient());
    log.up(0);
    // Each takes 100 ms on the line, and the first is already being sent.
    link.send(vec![0; 48], 0);
    log.written(0);
    for tag in 1..50 {
        link.send(vec![tag; 48], tag.into());
    }
    log.written(49);
    let wanted: Vec<u8> = [[0; 48], [49; 48]].concat();
    boat_log.received(&wanted);
    assert_eq!(link.displaced(), 48);
}

#[test]
fn a_line_that_takes_nothing_for_two_seconds_is_opened_anew() {
    let (silent, _slave) = SerialPort::pair().unwrap();
    let name = rustix::pty::ptsname(&silent, Vec::new()).unwrap();
    let path = std::path::Path::new(OsStr::from_bytes(name.as_bytes()));
    let (link, log) = connect(
        &format!("serial://{}?baud=115200", path.display()),
        patient(),
    );
    log.up(0);
    let start = Instant::now();
    link.send(vec![b'x'; 1 << 20], 0);
    let (reason, down) = log.down(0);
    assert!(reason.contains("no data accepted for 2s"), "{reason}");
    assert!(
        down - start > Duration::from_secs(2) && down - start < Duration::from_secs(4),
        "{:?}",
        down - start
    );
    log.up(1);
}
