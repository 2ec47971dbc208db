//! Sentences of the NMEA 0183 standard: fixes, headings, time.

use super::date_time::{Date, TimeOfDay};
use super::layout::{COMPASS, Field, HUNDREDTHS, Layout, TENTHS};
use super::talker::Talker;
use primitives::LatLon;

/// `GGA`, a fix: time, position and quality.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gga {
    /// The sender.
    pub talker: Talker,
    /// Time of the fix.
    pub time: Option<TimeOfDay>,
    /// Position of the antenna.
    pub at: Option<LatLon>,
    /// The fix quality, see [`super::FixQuality`]. An empty field is 0.
    pub quality: u8,
    /// Satellites used.
    pub satellites: Option<u8>,
    /// Horizontal dilution of precision.
    pub hdop: Option<f64>,
    /// Height of the antenna above the geoid, m.
    pub altitude_m: Option<f64>,
    /// Height of the geoid above the ellipsoid, m.
    pub geoid_m: Option<f64>,
}

impl Gga {
    /// 14 fields. The last one, the reference station, must be empty: a driver used with these
    /// boats counts fields after dropping one trailing empty field, and reads no position if there
    /// is a station.
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let fields = vec![
            Field::Standard(&mut self.talker, "GGA"),
            Field::Time(&mut self.time),
            Field::Position(&mut self.at, 5),
            Field::Quality(&mut self.quality),
            Field::Whole(&mut self.satellites, 2),
            Field::Number(&mut self.hdop, HUNDREDTHS),
            Field::Number(&mut self.altitude_m, TENTHS),
            Field::Unit("M"),
            Field::Number(&mut self.geoid_m, TENTHS),
            Field::Unit("M"),
            Field::Constant(""),
            Field::Constant(""),
        ];
        Layout {
            fields_min: 6,
            fields,
        }
    }
}

/// `RMC`, a fix with course, speed and date: the minimum for a chart plotter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rmc {
    /// The sender.
    pub talker: Talker,
    /// Time of the fix.
    pub time: Option<TimeOfDay>,
    /// Whether the receiver marks the fix as valid.
    pub valid: bool,
    /// Position of the antenna.
    pub at: Option<LatLon>,
    /// Speed over ground, knots.
    pub speed_kn: Option<f64>,
    /// Course over ground, degrees true; `None` at rest.
    pub course_deg: Option<f64>,
    /// Date of the fix.
    pub date: Option<Date>,
}

impl Rmc {
    /// 12 fields: without magnetic variation, and with the mode indicator "autonomous" or "not
    /// valid".
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let mode = fix_mode(self.valid);
        let fields = vec![
            Field::Standard(&mut self.talker, "RMC"),
            Field::Time(&mut self.time),
            Field::ValidFix(&mut self.valid, 10),
            Field::Position(&mut self.at, 5),
            Field::Number(&mut self.speed_kn, HUNDREDTHS),
            Field::Number(&mut self.course_deg, COMPASS),
            Field::Date(&mut self.date),
            Field::Constant(""),
            Field::Constant(""),
            Field::Constant(mode),
        ];
        // At least nine fields: before version 2.3 of the standard, there was no mode at the end.
        Layout {
            fields_min: 9,
            fields,
        }
    }
}

/// The mode indicator of a fix: autonomous, or not valid.
fn fix_mode(valid: bool) -> &'static str {
    if valid { "A" } else { "N" }
}

/// `VTG`, course and speed over ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vtg {
    /// The sender.
    pub talker: Talker,
    /// Course over ground, degrees true; `None` at rest, which does not mean north.
    pub course_true_deg: Option<f64>,
    /// Course over ground, degrees magnetic.
    pub course_magnetic_deg: Option<f64>,
    /// Speed over ground, knots.
    pub speed_kn: Option<f64>,
    /// Speed over ground, km/h.
    pub speed_km_h: Option<f64>,
    /// Whether a ninth field holds the mode indicator; boats of 2024 omit it.
    pub with_mode: bool,
}

impl Vtg {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let mode = fix_mode(self.speed_kn.or(self.speed_km_h).is_some());
        let fields = vec![
            Field::Standard(&mut self.talker, "VTG"),
            Field::Number(&mut self.course_true_deg, COMPASS),
            Field::Unit("T"),
            Field::Number(&mut self.course_magnetic_deg, COMPASS),
            Field::Unit("M"),
            Field::Number(&mut self.speed_kn, HUNDREDTHS),
            Field::Unit("N"),
            Field::Number(&mut self.speed_km_h, HUNDREDTHS),
            Field::Unit("K"),
            Field::Optional(&mut self.with_mode, mode),
        ];
        Layout {
            fields_min: 8,
            fields,
        }
    }
}

/// `HDT`, the true heading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hdt {
    /// The sender.
    pub talker: Talker,
    /// Heading, degrees true.
    pub heading_deg: Option<f64>,
}

impl Hdt {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let heading = Field::Number(&mut self.heading_deg, COMPASS);
        Layout {
            fields_min: 1,
            fields: vec![
                Field::Standard(&mut self.talker, "HDT"),
                heading,
                Field::Unit("T"),
            ],
        }
    }
}

/// `HDG`, the magnetic heading with deviation and variation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hdg {
    /// The sender.
    pub talker: Talker,
    /// The sensor's heading, degrees.
    pub heading_deg: Option<f64>,
    /// Deviation, caused by the boat's own iron, degrees, east positive.
    pub deviation_deg: Option<f64>,
    /// Variation (declination), degrees, east positive.
    pub variation_deg: Option<f64>,
}

impl Hdg {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let fields = vec![
            Field::Standard(&mut self.talker, "HDG"),
            Field::Number(&mut self.heading_deg, COMPASS),
            Field::East(&mut self.deviation_deg),
            Field::East(&mut self.variation_deg),
        ];
        Layout {
            fields_min: 1,
            fields,
        }
    }
}

/// `ZDA`, time and date.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zda {
    /// The sender.
    pub talker: Talker,
    /// Time, UTC.
    pub time: Option<TimeOfDay>,
    /// Date, UTC.
    pub date: Option<Date>,
}

impl Zda {
    /// The local time zone is UTC.
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let fields = vec![
            Field::Standard(&mut self.talker, "ZDA"),
            Field::Time(&mut self.time),
            Field::DayMonthYear(&mut self.date),
            Field::Constant("00"),
            Field::Constant("00"),
        ];
        Layout {
            fields_min: 4,
            fields,
        }
    }
}
