//! A sample of a trial: the boat at one moment, and its columns in the file.

use super::command::Command;
use primitives::Ned;
use primitives::angle::compass_deg_from_rad;
use primitives::math::decimal;
use sim::hull::Planar;

/// The columns of a trial's file, in order.
pub const COLUMNS: [&str; 9] = [
    "t_s",
    "x_m",
    "y_m",
    "heading_deg",
    "surge_m_s",
    "sway_m_s",
    "yaw_rate_deg_s",
    "port_newton",
    "starboard_newton",
];

/// A boat at one moment of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time since the start of the trial, s.
    pub t_s: f64,
    /// Position of the midship point relative to the start, m.
    pub at: Ned,
    /// Heading, rad clockwise from north.
    pub psi_rad: f64,
    /// Velocity over the ground along the boat's axes.
    pub nu: Planar,
    /// Speed ahead through the water, m/s: without the current and the waves' orbital motion.
    pub surge_through_water_m_s: f64,
    /// Thrust of the port and the starboard thruster, N; NaN for a boat without thrusters.
    pub thrusts_newton: [f64; 2],
    /// The command from this moment on.
    pub command: Command,
}

impl Sample {
    /// The values of a row, in the units and the order of [`COLUMNS`].
    pub fn row(&self) -> [f64; 9] {
        [
            self.t_s,
            self.at.east,
            self.at.north,
            compass_deg_from_rad(self.psi_rad),
            self.nu.surge,
            self.nu.sway,
            self.nu.yaw.to_degrees(),
            self.thrusts_newton[0],
            self.thrusts_newton[1],
        ]
    }

    /// Speed over the ground, m/s.
    pub fn speed_m_s(&self) -> f64 {
        primitives::math::length(self.nu.surge, self.nu.sway)
    }
}

/// Writes samples as CSV: the columns of [`COLUMNS`] and, on request, the columns of the commands
/// as given, in per cent or as speed and heading.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(
    samples: &[Sample],
    with_orders: bool,
    out: impl std::io::Write,
) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    let orders = samples
        .iter()
        .map(|sample| sample.command.columns())
        .find(|heads| *heads != Command::NO_COLUMNS);
    let with_orders = with_orders && orders.is_some();
    let orders = orders
        .unwrap_or(Command::NO_COLUMNS)
        .into_iter()
        .filter(|_| with_orders);
    writer.write_record(COLUMNS.into_iter().chain(orders))?;
    for sample in samples {
        let orders = sample.command.numbers().into_iter().filter(|_| with_orders);
        let numbers = sample
            .row()
            .into_iter()
            .enumerate()
            .map(|(column, number)| text(number, column == 0));
        writer.write_record(numbers.chain(orders.map(|number| text(number, false))))?;
    }
    writer.flush()
}

/// Formats a number with its significant decimal places: a micrometre is far below the known
/// accuracy of any boat.
fn text(number: f64, is_time: bool) -> String {
    decimal(number, if is_time { 3 } else { 9 })
}
