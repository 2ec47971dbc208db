//! `PSEAB`, the battery: volts, charge, and who draws how much.

use super::field::Fields;
use super::{Line, ParseError};

/// `PSEAB`. In which unit the boat counts charge is not published.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Battery {
    /// Voltage, V.
    pub volts: Option<f64>,
    /// Charge that is left.
    pub charge: Option<f64>,
    /// Current, A.
    pub amps: Option<f64>,
    /// Temperature, degrees Celsius.
    pub celsius: Option<f64>,
    /// Charge used since the counter was reset.
    pub charge_used: Option<f64>,
    /// When the counter was reset: the time of day as sent, often empty.
    pub reset_time: String,
    /// When the counter was reset: the date `ddmmyy` as sent, often empty.
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
    /// Reads as many fields as there are; the two fuel gauges after the 15th are left.
    pub(super) fn read(fields: &Fields) -> Result<Battery, ParseError> {
        fields.at_least(1)?;
        Ok(Battery {
            volts: fields.number(1)?,
            charge: fields.number(2)?,
            amps: fields.number(3)?,
            celsius: fields.number(4)?,
            charge_used: fields.number(5)?,
            reset_time: fields.text(6).to_owned(),
            reset_date: fields.text(7).to_owned(),
            port_volts: fields.number(8)?,
            starboard_volts: fields.number(9)?,
            system_amps: fields.number(10)?,
            port_amps: fields.number(11)?,
            starboard_amps: fields.number(12)?,
            port_bilge_amps: fields.number(13)?,
            starboard_bilge_amps: fields.number(14)?,
            hours: fields.number(15)?,
        })
    }

    /// Writes 15 fields: real drivers refuse any other number of them.
    pub(super) fn write(&self, mut line: Line) {
        line.number(self.volts, 1);
        line.number(self.charge, 0);
        line.number(self.amps, 1);
        line.number(self.celsius, 1);
        line.number(self.charge_used, 0);
        line.words(&self.reset_time);
        line.words(&self.reset_date);
        let amps =
            [self.system_amps, self.port_amps, self.starboard_amps, self.port_bilge_amps, self.starboard_bilge_amps];
        for number in [self.port_volts, self.starboard_volts].into_iter().chain(amps) {
            line.number(number, 1);
        }
        line.number(self.hours, 0);
        line.end();
    }
}
