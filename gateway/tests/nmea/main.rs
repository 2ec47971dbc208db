//! Tests the NMEA codec with bytes from real boats, with noise, and by round trips.

mod edge_cases;
mod framing;
mod golden;
mod round_trip;
mod sentences;

use gateway::nmea::Framer;

/// The bodies that a new framer extracts from `bytes`.
fn bodies(bytes: &[u8]) -> Vec<String> {
    let mut found = Vec::new();
    Framer::new().push(bytes, &mut |body| found.push(body.to_owned()));
    found
}
