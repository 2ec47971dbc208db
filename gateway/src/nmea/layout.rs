//! The layout of a sentence as a table: each kind lists its fields once, for reading and writing.

use super::date_time::{Date, TimeOfDay};
use super::mode::Mode;
use super::operator::Operator;
use super::talker::Talker;
use primitives::LatLon;

/// The fields of a sentence.
pub(super) struct Layout<'a> {
    /// Minimum number of data fields for reading.
    pub(super) fields_min: usize,
    /// The fields in order; those missing from a shorter sentence are read as empty.
    pub(super) fields: Vec<Field<'a>>,
}

/// One entry of a layout: a field, or several fields that form one value.
pub(super) enum Field<'a> {
    /// The address of a proprietary sentence.
    Address(&'static str),
    /// The address of a standard sentence: its talker and its kind.
    Standard(&'a mut Talker, &'static str),
    /// A constant: always written, ignored when read.
    Constant(&'static str),
    /// A unit: always written; any other unit is rejected.
    Unit(&'static str),
    /// An optional constant, and whether it is present.
    Optional(&'a mut bool, &'static str),
    /// An optional number.
    Number(&'a mut Option<f64>, Format),
    /// A required number, and the expected contents for the error message.
    Required(&'a mut f64, Format, &'static str),
    /// A number that is read but written as an empty field.
    ReadOnly(&'a mut Option<f64>),
    /// Two fields: a magnitude to one decimal place, and `E` if the number is positive or `W` if it
    /// is negative.
    East(&'a mut Option<f64>),
    /// An optional small integer, zero-padded to this width.
    Whole(&'a mut Option<u8>, usize),
    /// A fix quality: an empty field is read as 0.
    Quality(&'a mut u8),
    /// A waypoint number.
    Index(&'a mut u16),
    /// Free text.
    Text(&'a mut String),
    /// An optional letter.
    Letter(&'a mut Option<char>),
    /// The letter of a control mode.
    Mode(&'a mut Mode),
    /// An optional operator number.
    Operator(&'a mut Option<Operator>),
    /// `A` for a valid fix, `V` for an invalid one; the mode indicator comes this many fields
    /// later.
    ValidFix(&'a mut bool, usize),
    /// An optional time `hhmmss.ss`.
    Time(&'a mut Option<TimeOfDay>),
    /// An optional date `ddmmyy`.
    Date(&'a mut Option<Date>),
    /// Three fields: day, month, four-digit year.
    DayMonthYear(&'a mut Option<Date>),
    /// Four fields: an optional position, with this many decimal places of minutes.
    Position(&'a mut Option<LatLon>, u32),
    /// Four fields: a required position, with this many decimal places of minutes.
    Place(&'a mut LatLon, u32),
}

/// The format of a number.
#[derive(Clone, Copy)]
pub(super) struct Format {
    pub(super) decimals: usize,
    /// Minimum width, padded with zeros.
    pub(super) width: usize,
    /// Whether to normalise the number to [0, 360).
    pub(super) compass: bool,
    /// Whether to omit trailing zeros.
    pub(super) brief: bool,
}

/// Without decimal places.
pub(super) const WHOLE: Format = Format {
    decimals: 0,
    width: 0,
    compass: false,
    brief: false,
};
/// To one decimal place.
pub(super) const TENTHS: Format = Format {
    decimals: 1,
    ..WHOLE
};
/// To two decimal places.
pub(super) const HUNDREDTHS: Format = Format {
    decimals: 2,
    ..WHOLE
};
/// To three decimal places, without trailing zeros.
pub(super) const BRIEF_THOUSANDTHS: Format = Format {
    decimals: 3,
    brief: true,
    ..WHOLE
};
/// An angle in the format of most sentences: `005.0`.
pub(super) const COMPASS: Format = Format {
    compass: true,
    width: 5,
    ..TENTHS
};

impl Format {
    /// The digits of a number, never `-0`; empty for a missing or non-finite number.
    pub(super) fn text(self, number: Option<f64>) -> String {
        let Some(number) = number.filter(|number| number.is_finite()) else {
            return String::new();
        };
        let Format {
            decimals, width, ..
        } = self;
        let number = if self.compass {
            compass_deg(number, decimals)
        } else {
            number
        };
        let mut text = format!("{number:0width$.decimals$}");
        // Rounding turns small negative numbers into "-0.0", which strict readers reject.
        if text.starts_with('-') && !text.bytes().any(|byte| matches!(byte, b'1'..=b'9')) {
            text = format!("{:0width$.decimals$}", 0.0);
        }
        if self.brief && text.contains('.') {
            text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
        }
        text
    }
}

/// An angle normalised to [0, 360) that does not round up to 360 at this precision.
fn compass_deg(angle_deg: f64, decimals: usize) -> f64 {
    let turned = angle_deg.rem_euclid(360.0);
    let steps_per_deg = [1.0, 10.0, 100.0, 1000.0][decimals];
    // 359.97 would be rounded to 360.0, which some readers reject as a heading.
    if (turned * steps_per_deg).round() >= 360.0 * steps_per_deg {
        0.0
    } else {
        turned
    }
}
