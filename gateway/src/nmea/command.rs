//! `PSEAC`, the command: what a backseat tells the boat to do.

use super::field::Fields;
use super::{Line, Mode, ParseError};

/// `PSEAC`. What a field means depends on the mode, and any but the mode may be empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// What to do.
    pub mode: Mode,
    /// Compass heading, degrees; in [`Mode::FileDownload`] the number of lines to come.
    pub heading_deg: Option<f64>,
    /// Thrust in percent of the most, ahead positive; in [`Mode::Speed`] the speed in knots.
    pub thrust: Option<f64>,
    /// Half of port thrust less starboard thrust, percent: positive turns to starboard.
    pub difference: Option<f64>,
    /// A switch such as `THR_ON`, else empty.
    pub words: String,
}

impl Command {
    /// Reads four fields and more: of real drivers some send four, some six.
    pub(super) fn read(fields: &Fields) -> Result<Command, ParseError> {
        fields.at_least(4)?;
        Ok(Command {
            mode: Mode::read(fields, 1)?,
            heading_deg: fields.number(2)?,
            thrust: fields.number(3)?,
            difference: fields.number(4)?,
            words: fields.text(5).to_owned(),
        })
    }

    /// Writes five fields. Percents are whole numbers, and in [`Mode::Thruster`] so is the heading: there are
    /// boats that read nothing else, and keep the value they had.
    pub(super) fn write(&self, mut line: Line) {
        let (thrust, difference) = whole_percents(self.thrust, self.difference);
        line.fixed(self.mode.letter().encode_utf8(&mut [0; 4]));
        match self.mode {
            Mode::FileDownload => {
                for number in [self.heading_deg, thrust, difference] {
                    let number = number.filter(|number| number.is_finite()).unwrap_or_default().round();
                    // No lines to come, and what has no meaning here, are three zeros.
                    let width = if number == 0.0 { 3 } else { 0 };
                    line.padded(Some(number), width, 0);
                }
            }
            Mode::Thruster => {
                line.compass(self.heading_deg, 0, 0);
                line.number(thrust, 0);
                line.number(difference, 0);
            }
            Mode::Speed => {
                line.brief(self.compass_deg(), 1);
                line.brief(self.thrust, 3);
                line.number(difference, 0);
            }
            _ => {
                line.brief(self.compass_deg(), 1);
                line.number(thrust, 0);
                line.number(difference, 0);
            }
        }
        line.words(&self.words);
        line.end();
    }

    fn compass_deg(&self) -> Option<f64> {
        self.heading_deg.map(|heading_deg| super::line::compass_deg(heading_deg, 1))
    }
}

impl Mode {
    /// The mode whose letter is field `at`.
    pub(super) fn read(fields: &Fields, at: usize) -> Result<Mode, ParseError> {
        let mut letters = fields.text(at).chars();
        let mode = letters.next().and_then(Mode::from_letter).filter(|_| letters.next().is_none());
        mode.ok_or_else(|| fields.wrong(at, "the letter of a control mode"))
    }
}

/// Thrust and difference as whole percents, halves away from zero.
///
/// A thruster gets their sum, so where rounding takes that past 100 the boat turns a little less.
pub(super) fn whole_percents(thrust: Option<f64>, difference: Option<f64>) -> (Option<f64>, Option<f64>) {
    let (Some(thrust), Some(difference)) = (thrust, difference) else {
        return (thrust.map(f64::round), difference.map(f64::round));
    };
    let (whole_thrust, whole_difference) = (thrust.round(), difference.round());
    let by_rounding = thrust.abs() + difference.abs() < 100.5 && whole_thrust.abs() + whole_difference.abs() > 100.0;
    let excess = if by_rounding { whole_difference.signum() } else { 0.0 };
    (Some(whole_thrust), Some(whole_difference - excess))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_never_asks_a_thruster_for_more_than_all() {
        for (thrust, difference, want) in [
            (40.0, 14.16667, (40.0, 14.0)),
            (49.5, 50.5, (50.0, 50.0)),
            (49.5, -50.5, (50.0, -50.0)),
            (-99.5, 0.5, (-100.0, 0.0)),
            (99.5, -0.5, (100.0, 0.0)),
            (0.5, 99.5, (1.0, 99.0)),
            (20.5, -10.5, (21.0, -11.0)),
            // What was too much before stays for others to refuse.
            (80.0, 40.0, (80.0, 40.0)),
            (101.0, 0.0, (101.0, 0.0)),
        ] {
            let (got_thrust, got_difference) = whole_percents(Some(thrust), Some(difference));
            assert_eq!((got_thrust, got_difference), (Some(want.0), Some(want.1)), "{thrust}, {difference}");
        }
    }
}
