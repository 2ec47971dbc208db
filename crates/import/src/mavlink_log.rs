//! MAVLink: telemetry logs (`.tlog`), in which each frame follows its UNIX time.

use crate::format::TIMES_US;
use crate::servo::Servos;
use crate::{Found, ImportError, Quantity, bytes_of};
use gateway::mavlink::dialect::MavMessage;
use gateway::mavlink::{Framer, Received};
use primitives::LatLon;
use primitives::math::sin_cos_deg;
use std::collections::BTreeMap;
use std::path::Path;

/// The system number that ground stations use.
const GROUND_STATION: u8 = 255;

/// Reads a telemetry log, whose boats are named after their system numbers unless `boat` is given.
pub(crate) fn read(path: &Path, boat: Option<&str>) -> Result<Found, ImportError> {
    let bytes = bytes_of(path)?;
    let mut found = Found {
        has_utc: true,
        ..Found::default()
    };
    let mut vehicles = Vehicles::default();
    let mut framer = Framer::new();
    let (mut rest, mut skipped) = (&bytes[..], 0_u64);
    while let Some((time, frame)) = rest.split_first_chunk() {
        let time_us = u64::from_be_bytes(*time);
        let length = frame_length(frame).filter(|_| TIMES_US.contains(&time_us));
        let Some(length) = length else {
            // No frame starts here: try the next byte.
            skipped += 1;
            rest = &rest[1..];
            continue;
        };
        let at_s = 1e-6 * time_us as f64;
        let (frame, after) = frame.split_at(length.min(frame.len()));
        framer.interrupt();
        framer.push(frame, &mut |received| {
            let name = boat.map_or_else(|| format!("boat_{}", received.system), str::to_owned);
            vehicles.add(&mut found, &name, at_s, &received);
        });
        rest = after;
    }
    vehicles.note(&mut found);
    if skipped > 0 {
        found
            .notes
            .push(format!("ignored {skipped} bytes between frames"));
    }
    Ok(found)
}

/// The length of the frame at the start of these bytes; `None` if no frame starts here.
fn frame_length(bytes: &[u8]) -> Option<usize> {
    match *bytes {
        [0xFE, length, ..] => Some(usize::from(length) + 8),
        [0xFD, length, flags, ..] => {
            Some(usize::from(length) + 12 + if flags & 1 == 1 { 13 } else { 0 })
        }
        _ => None,
    }
}

/// The servo parameters of each system.
#[derive(Default)]
pub(crate) struct Vehicles {
    servos: BTreeMap<u8, Servos>,
    /// Whether servo outputs were read without their parameters.
    guesses: bool,
}

impl Vehicles {
    /// Adds a note if the functions of a boat's servo outputs were guessed.
    pub(crate) fn note(&self, found: &mut Found) {
        if self.guesses {
            found.notes.push(Servos::UNKNOWN.to_owned());
        }
    }

    /// Adds the measurements in a boat's message.
    pub(crate) fn add(
        &mut self,
        found: &mut Found,
        boat: &str,
        at_s: f64,
        Received {
            system, message, ..
        }: &Received,
    ) {
        if *system == GROUND_STATION {
            return;
        }
        let servos = self.servos.entry(*system).or_default();
        let mut push = |quantity, source, value: f64| {
            if value.is_finite() {
                found.logs.push(boat, quantity, source, (at_s, value));
            }
        };
        let place = |lat: i32, lon: i32| LatLon {
            lat_deg: 1e-7 * f64::from(lat),
            lon_deg: 1e-7 * f64::from(lon),
        };
        match message {
            MavMessage::GLOBAL_POSITION_INT(data) => {
                push(Quantity::North, 0, 0.01 * f64::from(data.vx));
                push(Quantity::East, 0, 0.01 * f64::from(data.vy));
                let at = place(data.lat, data.lon);
                found.positions.push(boat, 0, at_s, at);
            }
            MavMessage::GPS_RAW_INT(data) => {
                let (sin, cos) = sin_cos_deg(0.01 * f64::from(data.cog));
                let speed = 0.01 * f64::from(data.vel);
                // 65535: unknown.
                if data.vel != u16::MAX && data.cog != u16::MAX {
                    push(Quantity::North, 1, speed * cos);
                    push(Quantity::East, 1, speed * sin);
                }
                push(Quantity::Height, 0, 1e-3 * f64::from(data.alt));
                let at = place(data.lat, data.lon);
                found.positions.push(boat, 1, at_s, at);
            }
            MavMessage::ATTITUDE(data) => {
                push(Quantity::Heading, 0, f64::from(data.yaw).to_degrees());
                push(Quantity::YawRate, 0, f64::from(data.yawspeed).to_degrees());
            }
            MavMessage::PARAM_VALUE(data) => {
                let name = data.param_id.to_str().unwrap_or_default();
                servos.set(name, f64::from(data.param_value));
            }
            MavMessage::SERVO_OUTPUT_RAW(data) => {
                let outputs = [
                    data.servo1_raw,
                    data.servo2_raw,
                    data.servo3_raw,
                    data.servo4_raw,
                    data.servo5_raw,
                    data.servo6_raw,
                    data.servo7_raw,
                    data.servo8_raw,
                ];
                self.guesses |= !servos.are_known();
                if let Some([port, starboard]) = servos.thrusts_pct(&outputs) {
                    push(Quantity::Port, 0, port);
                    push(Quantity::Starboard, 0, starboard);
                }
            }
            _ => {}
        }
    }
}
