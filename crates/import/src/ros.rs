//! Messages of ROS 1 and ROS 2: which topics belong to which boat, and what they measure.
//!
//! ROS uses x east, y north, and angles anticlockwise from east (REP 103); in a boat's own axes, x
//! is ahead and y to port.

use crate::{Found, Quantity};
use primitives::LatLon;
use primitives::math::atan2;
use recording::logs::name_of;
use std::collections::{BTreeMap, BTreeSet};

/// First parts of topic names that name a sensor or a node rather than a boat.
const NOT_BOATS: &[&str] = &[
    "ekf",
    "fix",
    "fmu",
    "global_position",
    "gnss",
    "gps",
    "imu",
    "localization",
    "mavros",
    "navigation",
    "odom",
    "odometry",
    "sensors",
    "ublox",
];

/// A measurement in a message.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Measured {
    /// A position on the globe.
    Fix(LatLon),
    /// Height above the ellipsoid, m.
    Height(f64),
    /// Position in the coordinate frame of the odometry: x, y and z, m.
    Place([f64; 3]),
    /// Compass heading, degrees.
    Heading(f64),
    /// Velocity ahead and to starboard, m/s.
    Velocity([f64; 2]),
    /// Yaw rate, degrees per second clockwise.
    YawRate(f64),
    /// A number, such as a command to a thruster.
    Number(f64),
}

/// The measurements of a bag, by topic.
#[derive(Default)]
pub(crate) struct Bag {
    topics: BTreeMap<String, Vec<(f64, Measured)>>,
    unreadable: u64,
}

/// How a message is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// ROS 1: packed, little endian.
    Packed,
    /// ROS 2: CDR, in which each number is aligned to its size.
    Cdr,
}

impl Bag {
    /// Adds a message that was recorded at `log_s`, if its type is supported. The type is written
    /// as in ROS 1 or 2, for example `nav_msgs/Odometry`.
    pub(crate) fn add(
        &mut self,
        topic: &str,
        message_type: &str,
        encoding: Encoding,
        log_s: f64,
        bytes: &[u8],
    ) {
        let (package, name) = message_type.split_once('/').unwrap_or_default();
        let name = name.strip_prefix("msg/").unwrap_or(name);
        // Commanded velocities have the same type as measured ones.
        let is_command = topic.contains("cmd");
        let Some(mut fields) = Fields::new(bytes, encoding) else {
            self.unreadable += 1;
            return;
        };
        let read = match (package, name) {
            ("nav_msgs", "Odometry") => fields.odometry(),
            ("sensor_msgs", "NavSatFix") => fields.fix(),
            ("sensor_msgs", "Imu") => fields.imu(),
            ("geometry_msgs", "TwistStamped") if !is_command => fields.twist(),
            ("std_msgs", "Float32") => fields
                .f32()
                .map(|number| (None, vec![Measured::Number(number)])),
            ("std_msgs", "Float64") => fields
                .f64()
                .map(|number| (None, vec![Measured::Number(number)])),
            _ => return,
        };
        let Some((stamp_s, measured)) = read else {
            self.unreadable += 1;
            return;
        };
        let at_s = stamp_s.filter(|stamp_s| *stamp_s > 0.0).unwrap_or(log_s);
        let rows = self.topics.entry(topic.to_owned()).or_default();
        rows.extend(measured.into_iter().map(|measured| (at_s, measured)));
    }

    /// Assigns the topics to boats: to `only` if given, or else to the boat named in the first part
    /// of the topic. If no boat is named, all topics belong to the boat `stem`.
    pub(crate) fn found(self, only: Option<&str>, stem: &str) -> Found {
        let mut found = Found::default();
        let is_place = |(_, measured): &(f64, Measured)| {
            matches!(measured, Measured::Fix(_) | Measured::Place(_))
        };
        let with_place = self
            .topics
            .iter()
            .filter(|(_, rows)| rows.iter().any(is_place));
        let boats: BTreeSet<&str> = with_place
            .filter_map(|(topic, _)| namespace(topic))
            .collect();
        let mut ignored = BTreeSet::new();
        for (topic, rows) in &self.topics {
            let named = namespace(topic);
            let boat = match (only, named, boats.len()) {
                (Some(only), ..) => only.to_owned(),
                (_, Some(named), _) if boats.contains(named) => name_of(named),
                // There is only one boat, so it owns the topics outside its namespace too.
                (_, _, 1) => name_of(boats.first().copied().unwrap_or_default()),
                (_, _, 0) => stem.to_owned(),
                _ => {
                    ignored.insert(topic.as_str());
                    continue;
                }
            };
            add_topic(&mut found, &boat, topic, rows);
        }
        let first_s = self.topics.values().flatten().map(|(at_s, _)| *at_s);
        found.has_utc = first_s.fold(f64::INFINITY, f64::min) > 1e8;
        if !ignored.is_empty() {
            let topics: Vec<&str> = ignored.into_iter().collect();
            let note = format!(
                "ignored topics that belong to no boat: {}",
                topics.join(", ")
            );
            found.notes.push(note);
        }
        if self.unreadable > 0 {
            let note = format!(
                "ignored {} messages that cannot be decoded",
                self.unreadable
            );
            found.notes.push(note);
        }
        found
    }
}

/// The first part of a topic, which may name a boat. `None` if it names a sensor or a node, or is
/// the only part.
fn namespace(topic: &str) -> Option<&str> {
    let (first, _) = topic.trim_start_matches('/').split_once('/')?;
    (!NOT_BOATS.contains(&first)).then_some(first)
}

fn add_topic(found: &mut Found, boat: &str, topic: &str, rows: &[(f64, Measured)]) {
    // True poses from simulators take precedence over a filter's estimates.
    let source = if topic.contains("truth") { 0 } else { 1 };
    let logs = &mut found.logs;
    for (at_s, measured) in rows {
        let mut push = |quantity, source, value: f64| {
            if value.is_finite() {
                logs.push(boat, quantity, source, (*at_s, value));
            }
        };
        match *measured {
            Measured::Fix(at) => found.positions.push(boat, source, *at_s, at),
            Measured::Height(height) => push(Quantity::Height, source, height),
            // Each boat's odometry has its own origin, so positions on the globe take precedence.
            Measured::Place([x, y, height]) => {
                push(Quantity::X, 10, x);
                push(Quantity::Y, 10, y);
                push(Quantity::Height, 10, height);
            }
            Measured::Heading(deg) => push(Quantity::Heading, source, deg),
            Measured::Velocity([surge, sway]) => {
                push(Quantity::Surge, source, surge);
                push(Quantity::Sway, source, sway);
            }
            Measured::YawRate(deg_s) => push(Quantity::YawRate, source, deg_s),
            Measured::Number(_) => {}
        }
    }
    add_thrust(found, boat, topic, rows);
}

/// Adds the commands of a thruster, if the topic's name states its side.
fn add_thrust(found: &mut Found, boat: &str, topic: &str, rows: &[(f64, Measured)]) {
    let side = match topic {
        _ if topic.contains("left") || topic.contains("port") => Quantity::Port,
        _ if topic.contains("right") || topic.contains("starboard") => Quantity::Starboard,
        _ => return,
    };
    let numbers = rows.iter().filter_map(|(at_s, measured)| match measured {
        Measured::Number(number) if number.is_finite() => Some((*at_s, *number)),
        _ => None,
    });
    let numbers: Vec<(f64, f64)> = numbers.collect();
    let most = numbers
        .iter()
        .fold(0.0, |most, (_, number)| f64::max(most, number.abs()));
    if most > 100.0 {
        let note =
            format!("{topic}: ignored commands up to {most:.0}; expected -1 to 1, or per cent");
        found.notes.push(note);
        return;
    }
    let pct_per_unit = if most <= 1.0 { 100.0 } else { 1.0 };
    for (at_s, number) in numbers {
        let point = (at_s, pct_per_unit * number);
        found.logs.push(boat, side, 0, point);
    }
}

/// The time in a message's header, s, and its measurements.
type Read = Option<(Option<f64>, Vec<Measured>)>;

/// Reads the fields of a message in order. Its methods return `None` if the message is too short.
struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
    is_big_endian: bool,
}

impl<'a> Fields<'a> {
    fn new(bytes: &'a [u8], encoding: Encoding) -> Option<Fields<'a>> {
        let fields = |bytes, is_big_endian| Fields {
            bytes,
            at: 0,
            encoding,
            is_big_endian,
        };
        match (encoding, bytes) {
            (Encoding::Packed, bytes) => Some(fields(bytes, false)),
            // Plain CDR, version 1.
            (Encoding::Cdr, [0, order @ (0 | 1), _, _, bytes @ ..]) => {
                Some(fields(bytes, *order == 0))
            }
            _ => None,
        }
    }

    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        if self.encoding == Encoding::Cdr {
            self.at = self.at.next_multiple_of(N);
        }
        let mut bytes: [u8; N] = *self.bytes.get(self.at..)?.first_chunk()?;
        self.at += N;
        if self.is_big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.number().map(u32::from_le_bytes)
    }

    fn f32(&mut self) -> Option<f64> {
        self.number()
            .map(|bytes| f64::from(f32::from_le_bytes(bytes)))
    }

    fn f64(&mut self) -> Option<f64> {
        self.number().map(f64::from_le_bytes)
    }

    fn f64s<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Some(numbers)
    }

    fn skip_text(&mut self) -> Option<()> {
        let length = self.u32()? as usize;
        self.at = self.at.checked_add(length)?;
        Some(())
    }

    /// The time of a `std_msgs/Header`, s.
    fn header(&mut self) -> Option<f64> {
        if self.encoding == Encoding::Packed {
            self.u32()?;
        }
        let (seconds, ns) = (self.u32()?, self.u32()?);
        self.skip_text()?;
        Some(f64::from(seconds) + 1e-9 * f64::from(ns))
    }

    fn odometry(&mut self) -> Read {
        let stamp_s = self.header()?;
        self.skip_text()?;
        let place = self.f64s()?;
        let heading = heading(self.f64s()?);
        self.f64s::<36>()?;
        let [ahead, to_port, _] = self.f64s()?;
        let [.., yaw_rate] = self.f64s::<3>()?;
        let mut measured = vec![
            Measured::Place(place),
            Measured::Velocity([ahead, -to_port]),
            Measured::YawRate(-yaw_rate.to_degrees()),
        ];
        measured.extend(heading);
        Some((Some(stamp_s), measured))
    }

    fn fix(&mut self) -> Read {
        let stamp_s = self.header()?;
        let status = i8::from_le_bytes(self.number()?);
        self.number::<2>()?;
        let [lat_deg, lon_deg, height] = self.f64s()?;
        let at = LatLon { lat_deg, lon_deg };
        let measured = vec![Measured::Fix(at), Measured::Height(height)];
        // Status -1: no fix.
        let has_fix = status >= 0;
        Some((Some(stamp_s), if has_fix { measured } else { vec![] }))
    }

    fn imu(&mut self) -> Read {
        let stamp_s = self.header()?;
        let orientation = self.f64s()?;
        let covariance = self.f64s::<9>()?;
        let [.., yaw_rate] = self.f64s::<3>()?;
        // A covariance that begins with -1: the sensor does not measure the orientation.
        let heading = heading(orientation).filter(|_| covariance[0] != -1.0);
        let mut measured = vec![Measured::YawRate(-yaw_rate.to_degrees())];
        measured.extend(heading);
        Some((Some(stamp_s), measured))
    }

    fn twist(&mut self) -> Read {
        let stamp_s = self.header()?;
        let [ahead, to_port, _] = self.f64s()?;
        let [.., yaw_rate] = self.f64s::<3>()?;
        let velocity = Measured::Velocity([ahead, -to_port]);
        let yaw_rate = Measured::YawRate(-yaw_rate.to_degrees());
        Some((Some(stamp_s), vec![velocity, yaw_rate]))
    }
}

/// The heading of an orientation x, y, z, w; `None` if this is not a unit quaternion.
fn heading([x, y, z, w]: [f64; 4]) -> Option<Measured> {
    let yaw_rad = atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    let is_rotation = (x * x + y * y + z * z + w * w - 1.0).abs() < 0.1;
    is_rotation.then(|| Measured::Heading((90.0 - yaw_rad.to_degrees()).rem_euclid(360.0)))
}
