//! `PSEAA`, the attitude: how the boat lies in the water, and its compass.

use super::field::Fields;
use super::{Line, ParseError};

/// `PSEAA`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Pitch, degrees. Which way is positive is not published.
    pub pitch_deg: Option<f64>,
    /// Roll, degrees.
    pub roll_deg: Option<f64>,
    /// Heading by the compass: magnetic, degrees.
    pub heading_deg: Option<f64>,
    /// Heave, m. Read, but never written: boats leave it blank, and readers are used to that.
    pub heave_m: Option<f64>,
    /// Temperature of the electronics box, degrees Celsius.
    pub box_c: Option<f64>,
    /// Acceleration ahead, in units of gravity.
    pub accel_ahead_g: Option<f64>,
    /// Acceleration to starboard.
    pub accel_starboard_g: Option<f64>,
    /// Acceleration down: -1 at rest.
    pub accel_down_g: Option<f64>,
    /// Rate of turn, degrees a second.
    pub yaw_rate_deg_s: Option<f64>,
}

impl Attitude {
    /// Reads pitch, roll and heading, and of the other fields as many as there are.
    pub(super) fn read(fields: &Fields) -> Result<Attitude, ParseError> {
        fields.at_least(3)?;
        Ok(Attitude {
            pitch_deg: fields.number(1)?,
            roll_deg: fields.number(2)?,
            heading_deg: fields.number(3)?,
            heave_m: fields.number(4)?,
            box_c: fields.number(5)?,
            accel_ahead_g: fields.number(6)?,
            accel_starboard_g: fields.number(7)?,
            accel_down_g: fields.number(8)?,
            yaw_rate_deg_s: fields.number(9)?,
        })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.number(self.pitch_deg, 1);
        line.number(self.roll_deg, 1);
        line.compass(self.heading_deg, 0, 1);
        line.empty();
        line.number(self.box_c, 1);
        for number in [self.accel_ahead_g, self.accel_starboard_g, self.accel_down_g, self.yaw_rate_deg_s] {
            line.number(number, 2);
        }
        line.end();
    }
}
