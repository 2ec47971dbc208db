//! The latency of a command from `send` to the boat's socket. Run it by hand, alone, and in release
//! mode: `cargo test --release -p squall-gateway --test link latency -- --ignored --nocapture`.

use crate::event_log::patient;
use crate::tcp_client::joined;
use gateway::link::LinkEvent;
use std::collections::BTreeMap;
use std::io::Read;
use std::time::{Duration, Instant};

const COMMANDS: u64 = 5000;

#[test]
#[ignore = "a measurement"]
#[expect(clippy::print_stdout, reason = "a measurement is for people")]
fn a_command_reaches_the_system_and_the_boat_soon() {
    let (link, log, mut boat, _listener) = joined(patient());
    let mut sent_at = Vec::new();
    let mut to_boat = Vec::new();
    for tag in 0..COMMANDS {
        let start = Instant::now();
        sent_at.push(start);
        link.send(b"$PSEAC,T,0,20,-10,*22\r\n".to_vec(), tag);
        boat.read_exact(&mut [0; 23]).unwrap();
        to_boat.push(start.elapsed());
        // Sleep in between, as at 10 Hz.
        std::thread::sleep(Duration::from_micros(500));
    }
    log.written(COMMANDS - 1);
    let written: BTreeMap<u64, Instant> = log.all().into_iter().filter_map(|(_, event)| written(&event)).collect();
    let to_system = written.iter().map(|(tag, at)| *at - sent_at[*tag as usize]).collect();
    println!("send to written: {}", quantiles(to_system));
    println!("send to the boat's read: {}", quantiles(to_boat));
}

fn written(event: &LinkEvent) -> Option<(u64, Instant)> {
    if let LinkEvent::Written { tag, at } = event { Some((*tag, *at)) } else { None }
}

fn quantiles(mut times: Vec<Duration>) -> String {
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    format!("p50 {:?}, p99 {:?}, max {:?} of {}", at(0.5), at(0.99), at(1.0), times.len())
}
