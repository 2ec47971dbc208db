//! The layout of a sentence as a table: each kind lists its fields once, and that table both reads and writes it.

use super::date_time::{Date, TimeOfDay};
use super::mode::Mode;
use super::operator::Operator;
use super::talker::Talker;
use super::wind::{SpeedUnit, WindReference};
use primitives::LatLon;

/// What a sentence consists of.
pub(super) struct Layout<'a> {
    /// Fewest data fields with which it is read.
    pub(super) fields_min: usize,
    /// Its fields in order; those that a shorter sentence lacks are read as empty.
    pub(super) fields: Vec<Field<'a>>,
}

/// One entry of a layout: a field, or a few that mean something only together.
pub(super) enum Field<'a> {
    /// The address of a maker's own sentence.
    Address(&'static str),
    /// The address of a standard sentence: its talker and its kind.
    Standard(&'a mut Talker, &'static str),
    /// Always written so; ignored when it is read.
    Constant(&'static str),
    /// A unit: always written, and refused when it is another one.
    Unit(&'static str),
    /// A constant that may be missing, and whether it is there.
    Optional(&'a mut bool, &'static str),
    /// A number, if there is one.
    Number(&'a mut Option<f64>, Format),
    /// A number without which the sentence is refused, and what is expected there.
    Required(&'a mut f64, Format, &'static str),
    /// A number that is read but written as an empty field.
    ReadOnly(&'a mut Option<f64>),
    /// Two fields: a size with one decimal, and `E` for a positive or `W` for a negative number.
    East(&'a mut Option<f64>),
    /// A small whole number, if there is one, with zeros before it up to this width.
    Whole(&'a mut Option<u8>, usize),
    /// A fix quality: an empty field is 0.
    Quality(&'a mut u8),
    /// The number of a waypoint.
    Index(&'a mut u16),
    /// Free text.
    Text(&'a mut String),
    /// One letter, if there is one.
    Letter(&'a mut Option<char>),
    /// The letter of a control mode.
    Mode(&'a mut Mode),
    /// The number of an operator, if there is one.
    Operator(&'a mut Option<Operator>),
    /// `A` for valid data, `V` for others.
    Valid(&'a mut bool),
    /// The same of a fix, whose mode is the field that comes this many fields later.
    ValidFix(&'a mut bool, usize),
    /// A time `hhmmss.ss`, if there is one.
    Time(&'a mut Option<TimeOfDay>),
    /// A date `ddmmyy`, if there is one.
    Date(&'a mut Option<Date>),
    /// Three fields: day, month, year with four digits.
    DayMonthYear(&'a mut Option<Date>),
    /// Four fields: a position, if there is one, with so many decimals of minutes.
    Position(&'a mut Option<LatLon>, u32),
    /// Four fields: a position without which the sentence is refused, with so many decimals of minutes.
    Place(&'a mut LatLon, u32),
    /// `R` or `T`.
    WindReference(&'a mut WindReference),
    /// Two fields: a speed, m/s, in the unit whose letter follows.
    WindSpeed(&'a mut Option<f64>, &'a mut SpeedUnit),
    /// Four fields: one speed in knots and again in km/h. It is read from km/h where there are no knots.
    KnotsAndKmH(&'a mut Option<f64>),
}

/// How a number is written.
#[derive(Clone, Copy)]
pub(super) struct Format {
    decimals: usize,
    /// Zeros before it up to this width.
    width: usize,
    /// Whether it is brought into 0 (included) to 360 (excluded).
    compass: bool,
    /// Whether zeros at its end are left out.
    brief: bool,
}

/// Without decimals.
pub(super) const WHOLE: Format = Format { decimals: 0, width: 0, compass: false, brief: false };
/// With one decimal.
pub(super) const TENTHS: Format = Format { decimals: 1, ..WHOLE };
/// With two decimals.
pub(super) const HUNDREDTHS: Format = Format { decimals: 2, ..WHOLE };
/// With three decimals, without the zeros at the end.
pub(super) const BRIEF_THOUSANDTHS: Format = Format { decimals: 3, brief: true, ..WHOLE };
/// An angle as most sentences have it: `005.0`.
pub(super) const COMPASS: Format = TENTHS.compass().wide(5);

impl Format {
    pub(super) const fn compass(self) -> Format {
        Format { compass: true, ..self }
    }

    pub(super) const fn brief(self) -> Format {
        Format { brief: true, ..self }
    }

    pub(super) const fn wide(self, width: usize) -> Format {
        Format { width, ..self }
    }

    /// The text of a number, never `-0`; nothing for a missing or non-finite number.
    pub(super) fn text(self, number: Option<f64>) -> String {
        let Some(number) = number.filter(|number| number.is_finite()) else { return String::new() };
        let Format { decimals, width, .. } = self;
        let number = if self.compass { compass_deg(number, decimals) } else { number };
        let mut text = format!("{number:0width$.decimals$}");
        // Rounding makes "-0.0" of small negative numbers, which strict readers refuse.
        if text.starts_with('-') && !text.bytes().any(|byte| matches!(byte, b'1'..=b'9')) {
            text = format!("{:0width$.decimals$}", 0.0);
        }
        if self.brief && text.contains('.') {
            text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
        }
        text
    }
}

/// An angle brought into 0 to 360, such that rounding to so many decimals does not make it 360.
fn compass_deg(angle_deg: f64, decimals: usize) -> f64 {
    let turned = angle_deg.rem_euclid(360.0);
    let steps_per_deg = [1.0, 10.0, 100.0, 1000.0][decimals];
    // Rounded, 359.97 would be printed as 360.0, which is no heading for some readers.
    if (turned * steps_per_deg).round() >= 360.0 * steps_per_deg { 0.0 } else { turned }
}
