//! The Surveyor's proprietary sentences: commands, reports and missions.

use super::layout::{BRIEF_THOUSANDTHS, Field, Format, HUNDREDTHS, Layout, TENTHS, WHOLE};
use super::mode::Mode;
use super::operator::Operator;
use primitives::LatLon;

/// `PSEAC`, a command from a back seat. The meaning of a field depends on the mode; every field
/// except the mode may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Command {
    /// The commanded mode.
    pub mode: Mode,
    /// Compass heading, degrees; in [`Mode::FileDownload`] the number of following lines.
    pub heading_deg: Option<f64>,
    /// Thrust in per cent of full thrust, positive ahead; in [`Mode::Speed`] the speed in knots.
    pub thrust: Option<f64>,
    /// Half of port thrust minus starboard thrust, per cent: positive turns to starboard.
    pub difference: Option<f64>,
    /// A switch such as `THR_ON`, else empty.
    pub words: String,
}

impl Command {
    /// Accepts four or more fields, because some real drivers send four and some six. In
    /// [`Mode::Thruster`], the heading is also a whole number.
    pub(super) fn layout(&mut self) -> Layout<'_> {
        // In a download without following lines, the three unused fields are zero.
        let zeros = |number: &Option<f64>| Format {
            width: if *number == Some(0.0) { 3 } else { 0 },
            ..WHOLE
        };
        let heading = Format {
            compass: true,
            brief: true,
            ..TENTHS
        };
        let (heading, thrust, difference) = match self.mode {
            Mode::FileDownload => (
                zeros(&self.heading_deg),
                zeros(&self.thrust),
                zeros(&self.difference),
            ),
            // Mode T uses whole numbers: one simulator of the boat reads integers, and keeps the
            // previous difference if the new one has decimal places.
            Mode::Thruster => (
                Format {
                    compass: true,
                    ..WHOLE
                },
                WHOLE,
                WHOLE,
            ),
            Mode::Speed => (heading, BRIEF_THOUSANDTHS, WHOLE),
            _ => (heading, WHOLE, WHOLE),
        };
        let fields = vec![
            Field::Address("PSEAC"),
            Field::Mode(&mut self.mode),
            Field::Number(&mut self.heading_deg, heading),
            Field::Number(&mut self.thrust, thrust),
            Field::Number(&mut self.difference, difference),
            Field::Text(&mut self.words),
        ];
        Layout {
            fields_min: 4,
            fields,
        }
    }

    /// The command as written: percentages are whole numbers.
    pub(crate) fn rounded(mut self) -> Command {
        round_percents(self.mode, &mut self.thrust, &mut self.difference);
        if self.mode == Mode::FileDownload {
            for number in [
                &mut self.heading_deg,
                &mut self.thrust,
                &mut self.difference,
            ] {
                *number = Some(
                    number
                        .filter(|number| number.is_finite())
                        .unwrap_or_default()
                        .round(),
                );
            }
        }
        self
    }
}

/// Rounds thrust and difference to whole percentages, halves away from zero; leaves a speed in
/// knots unchanged.
///
/// A thruster receives their sum. If rounding would take the sum above 100, the difference is
/// reduced, and the boat turns a little less.
fn round_percents(mode: Mode, thrust: &mut Option<f64>, difference: &mut Option<f64>) {
    let sum =
        |thrust: Option<f64>, difference: Option<f64>| Some(thrust?.abs() + difference?.abs());
    let whole_thrust = thrust.map(f64::round);
    let whole_difference = difference.map(f64::round);
    // 49.5 and 50.5 add up to 100 % but round to 50 and 51. It is not known how a boat handles more
    // than 100 %.
    let by_rounding = sum(*thrust, *difference).is_some_and(|sum| sum < 100.5)
        && sum(whole_thrust, whole_difference).is_some_and(|sum| sum > 100.0);
    *difference = whole_difference.map(|whole| {
        if by_rounding {
            whole - whole.signum()
        } else {
            whole
        }
    });
    if mode != Mode::Speed {
        *thrust = whole_thrust;
    }
}

/// `PSEAA`, the attitude: pitch, roll, heave and compass heading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Pitch, degrees. The positive direction is not published.
    pub pitch_deg: Option<f64>,
    /// Roll, degrees.
    pub roll_deg: Option<f64>,
    /// Compass heading: magnetic, degrees.
    pub heading_deg: Option<f64>,
    /// Heave, m. Read but never written: boats leave the field blank, and readers expect this.
    pub heave_m: Option<f64>,
    /// Temperature of the electronics box, degrees Celsius.
    pub box_c: Option<f64>,
    /// Forward acceleration, in units of gravity.
    pub accel_ahead_g: Option<f64>,
    /// Acceleration to starboard, in units of gravity.
    pub accel_starboard_g: Option<f64>,
    /// Acceleration down, in units of gravity: -1 at rest.
    pub accel_down_g: Option<f64>,
    /// Rate of turn, degrees a second.
    pub yaw_rate_deg_s: Option<f64>,
}

impl Attitude {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let fields = vec![
            Field::Address("PSEAA"),
            Field::Number(&mut self.pitch_deg, TENTHS),
            Field::Number(&mut self.roll_deg, TENTHS),
            Field::Number(
                &mut self.heading_deg,
                Format {
                    compass: true,
                    ..TENTHS
                },
            ),
            // Write it blank: boats omit heave, and a public client rejects a sentence in which
            // this field contains only a space.
            Field::ReadOnly(&mut self.heave_m),
            Field::Number(&mut self.box_c, TENTHS),
            Field::Number(&mut self.accel_ahead_g, HUNDREDTHS),
            Field::Number(&mut self.accel_starboard_g, HUNDREDTHS),
            Field::Number(&mut self.accel_down_g, HUNDREDTHS),
            Field::Number(&mut self.yaw_rate_deg_s, HUNDREDTHS),
        ];
        Layout {
            fields_min: 3,
            fields,
        }
    }
}

/// `PSEAB`, the battery: voltage, charge, and the current of each consumer. The unit of charge is
/// not published.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Battery {
    /// Voltage, V.
    pub volts: Option<f64>,
    /// Remaining charge.
    pub charge: Option<f64>,
    /// Current, A.
    pub amps: Option<f64>,
    /// Temperature, degrees Celsius.
    pub celsius: Option<f64>,
    /// Charge used since the counter was reset.
    pub charge_used: Option<f64>,
    /// The time of day when the counter was reset, as sent; often empty.
    pub reset_time: String,
    /// The date when the counter was reset, `ddmmyy` as sent; often empty.
    pub reset_date: String,
    /// Voltage of the port battery.
    pub port_volts: Option<f64>,
    /// Voltage of the starboard battery.
    pub starboard_volts: Option<f64>,
    /// Current of the electronics, A.
    pub system_amps: Option<f64>,
    /// Current of the port thruster, A.
    pub port_amps: Option<f64>,
    /// Current of the starboard thruster, A.
    pub starboard_amps: Option<f64>,
    /// Current of the port bilge pump, A.
    pub port_bilge_amps: Option<f64>,
    /// Current of the starboard bilge pump, A.
    pub starboard_bilge_amps: Option<f64>,
    /// The hour meter.
    pub hours: Option<f64>,
}

impl Battery {
    /// Writes 15 fields, because real drivers reject any other number. When reading, the two fuel
    /// gauges after the 15th field are ignored.
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let fields = vec![
            Field::Address("PSEAB"),
            Field::Number(&mut self.volts, TENTHS),
            Field::Number(&mut self.charge, WHOLE),
            Field::Number(&mut self.amps, TENTHS),
            Field::Number(&mut self.celsius, TENTHS),
            Field::Number(&mut self.charge_used, WHOLE),
            Field::Text(&mut self.reset_time),
            Field::Text(&mut self.reset_date),
            Field::Number(&mut self.port_volts, TENTHS),
            Field::Number(&mut self.starboard_volts, TENTHS),
            Field::Number(&mut self.system_amps, TENTHS),
            Field::Number(&mut self.port_amps, TENTHS),
            Field::Number(&mut self.starboard_amps, TENTHS),
            Field::Number(&mut self.port_bilge_amps, TENTHS),
            Field::Number(&mut self.starboard_bilge_amps, TENTHS),
            Field::Number(&mut self.hours, WHOLE),
        ];
        Layout {
            fields_min: 1,
            fields,
        }
    }
}

/// `PSEAD`, the control state: the command that the boat follows, and its operator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ControlState {
    /// The boat's mode.
    pub mode: Mode,
    /// The commanded heading, degrees magnetic.
    pub heading_deg: Option<f64>,
    /// The commanded thrust, per cent; in [`Mode::Speed`] the speed in knots.
    pub thrust: Option<f64>,
    /// The commanded thrust difference, per cent.
    pub difference: Option<f64>,
    /// The last switch received, else empty.
    pub words: String,
    /// How the command arrived: one of the letters T, F, R and N.
    pub transmission: Option<char>,
    /// The operator this report was sent to.
    pub sent_to: Option<u8>,
    /// The operator in control.
    pub operator: Option<Operator>,
}

impl ControlState {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let thrust = if self.mode == Mode::Speed {
            BRIEF_THOUSANDTHS
        } else {
            WHOLE
        };
        let fields = vec![
            Field::Address("PSEAD"),
            Field::Mode(&mut self.mode),
            Field::Number(
                &mut self.heading_deg,
                Format {
                    compass: true,
                    ..TENTHS
                },
            ),
            Field::Number(&mut self.thrust, thrust),
            Field::Number(&mut self.difference, WHOLE),
            Field::Text(&mut self.words),
            Field::Letter(&mut self.transmission),
            Field::Whole(&mut self.sent_to, 0),
            Field::Operator(&mut self.operator),
        ];
        Layout {
            fields_min: 1,
            fields,
        }
    }

    /// The state as written: percentages are whole numbers.
    pub(super) fn rounded(mut self) -> ControlState {
        round_percents(self.mode, &mut self.thrust, &mut self.difference);
        self
    }
}

/// `PSEAG`, the boat's error code. `N` means no error; the meaning of other codes is not published.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BoatError {
    /// The code as sent.
    pub code: String,
}

impl BoatError {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        Layout {
            fields_min: 1,
            fields: vec![Field::Address("PSEAG"), Field::Text(&mut self.code)],
        }
    }
}

/// `PSEAR`, the settings of a mission: the throttle between its waypoints. All other fields are
/// constant in every known sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MissionSettings {
    /// Throttle, per cent.
    pub throttle_pct: f64,
}

impl MissionSettings {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let fields = vec![
            // Only the meaning of the throttle is known; the constants are those of a working
            // public driver.
            Field::Address("PSEAR"),
            Field::Constant("0"),
            Field::Constant("000"),
            Field::Required(&mut self.throttle_pct, WHOLE, "a throttle in per cent"),
            Field::Constant("0"),
            Field::Constant("000"),
        ];
        Layout {
            fields_min: 3,
            fields,
        }
    }

    /// The settings as written: the throttle is a whole percentage.
    pub(super) fn rounded(self) -> MissionSettings {
        MissionSettings {
            throttle_pct: self.throttle_pct.round(),
        }
    }
}

/// `OIWPL`, a waypoint of a mission being uploaded. Four decimal places of minutes resolve 0.1 m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waypoint {
    /// The waypoint's position.
    pub at: LatLon,
    /// The waypoint's number; 0 is the emergency recovery point.
    pub index: u16,
}

impl Waypoint {
    pub(super) fn layout(&mut self) -> Layout<'_> {
        let place = Field::Place(&mut self.at, 4);
        Layout {
            fields_min: 5,
            fields: vec![
                Field::Address("OIWPL"),
                place,
                Field::Index(&mut self.index),
            ],
        }
    }
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
            // Leave a command that was already out of range for others to reject.
            (80.0, 40.0, (80.0, 40.0)),
            (101.0, 0.0, (101.0, 0.0)),
        ] {
            let mut got_thrust = Some(thrust);
            let mut got_difference = Some(difference);
            round_percents(Mode::Thruster, &mut got_thrust, &mut got_difference);
            assert_eq!(
                (got_thrust, got_difference),
                (Some(want.0), Some(want.1)),
                "{thrust}, {difference}"
            );
        }
    }
}
