//! Converts positions on the globe to the field's plane, and velocities over the ground to the
//! boat's axes.

use gateway::geodesy::LocalFrame;
use primitives::LatLon;
use primitives::math::{atan2, length, sin_cos_deg};
use recording::logs::{Logs, Quantity};

/// Speed below which the course over ground says nothing about the heading, m/s.
const COURSE_MIN_M_S: f64 = 0.3;

/// Positions on the globe.
#[derive(Default)]
pub(crate) struct Positions(Vec<Position>);

struct Position {
    boat: String,
    source: u8,
    at_s: f64,
    at: LatLon,
}

impl Positions {
    /// Adds a position if it is valid. Position 0, 0 is not: receivers without a fix report it.
    pub(crate) fn push(&mut self, boat: &str, source: u8, at_s: f64, at: LatLon) {
        let is_on_globe = at.lat_deg.abs() <= 90.0 && at.lon_deg.abs() <= 180.0;
        if is_on_globe && (at.lat_deg, at.lon_deg) != (0.0, 0.0) {
            self.0.push(Position {
                boat: boat.to_owned(),
                source,
                at_s,
                at,
            });
        }
    }

    pub(crate) fn merge(&mut self, other: Positions) {
        self.0.extend(other.0);
    }

    pub(crate) fn shift(&mut self, by_s: f64) {
        self.0.iter_mut().for_each(|position| position.at_s += by_s);
    }

    /// Adds the positions to the logs, in metres from `datum`, or else from the logs' own datum, or
    /// else from the earliest position.
    pub(crate) fn place(self, logs: &mut Logs, datum: Option<LatLon>) {
        let first = self.0.iter().min_by(|a, b| a.at_s.total_cmp(&b.at_s));
        let Some(datum) = datum.or(logs.datum).or(first.map(|first| first.at)) else {
            return;
        };
        logs.datum = Some(datum);
        let frame = LocalFrame::new(datum);
        for Position {
            boat,
            source,
            at_s,
            at,
        } in self.0
        {
            let ned = frame.ned(at);
            logs.push(&boat, Quantity::X, source, (at_s, ned.east));
            logs.push(&boat, Quantity::Y, source, (at_s, ned.north));
        }
    }
}

/// Adds quantities derived from other measurements: velocities along the boat's axes from those
/// over the ground, and a heading from the course. Returns notes about estimates.
pub(crate) fn resolve_motion(logs: &mut Logs) -> Vec<String> {
    let mut notes = vec![];
    for boat in logs.boats() {
        let has = |logs: &Logs, quantity| logs.series(&boat, quantity).is_some();
        if !has(logs, Quantity::North) && !has(logs, Quantity::Speed) && !has(logs, Quantity::Surge)
        {
            add_speeds_of_track(logs, &boat);
            notes.push(format!("{boat}: no speed; estimated from its positions"));
        }
        if !has(logs, Quantity::Heading) && has(logs, Quantity::North) {
            let north = logs.series(&boat, Quantity::North).cloned();
            for (at_s, north) in north.into_iter().flatten() {
                let east = logs.at(&boat, Quantity::East, at_s).unwrap_or(0.0);
                if length(north, east) > COURSE_MIN_M_S {
                    let course_deg = atan2(east, north).to_degrees();
                    logs.push(&boat, Quantity::Heading, u8::MAX, (at_s, course_deg));
                }
            }
            logs.sort();
            notes.push(format!(
                "{boat}: no heading; its course over ground is used"
            ));
        }
        if has(logs, Quantity::Heading) && !has(logs, Quantity::Surge) {
            let north = logs.series(&boat, Quantity::North).cloned();
            for (at_s, north) in north.into_iter().flatten() {
                let east = logs.at(&boat, Quantity::East, at_s).unwrap_or(0.0);
                let heading_deg = logs.at(&boat, Quantity::Heading, at_s).unwrap_or(0.0);
                let (sin, cos) = sin_cos_deg(heading_deg);
                let surge = north * cos + east * sin;
                let sway = east * cos - north * sin;
                logs.push(&boat, Quantity::Surge, u8::MAX, (at_s, surge));
                logs.push(&boat, Quantity::Sway, u8::MAX, (at_s, sway));
            }
        }
    }
    notes
}

/// Adds velocities over the ground, computed from positions by central differences.
fn add_speeds_of_track(logs: &mut Logs, boat: &str) {
    for (axis, velocity) in [
        (Quantity::X, Quantity::East),
        (Quantity::Y, Quantity::North),
    ] {
        let track = logs.series(boat, axis).cloned().unwrap_or_default();
        for three in track.windows(3) {
            let span_s = three[2].0 - three[0].0;
            if span_s > 0.0 {
                let m_s = (three[2].1 - three[0].1) / span_s;
                logs.push(boat, velocity, u8::MAX, (three[1].0, m_s));
            }
        }
    }
}
