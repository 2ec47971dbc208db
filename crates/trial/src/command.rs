//! Commands to a boat in a trial, and the units in which users write them.

use scenario::boat::{Boat, Drive, Kinematic, ThrustCurve, Thruster};
use sim::thruster::ThrusterModel;

/// A command to a boat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Command {
    /// Thrusters off.
    #[default]
    Hold,
    /// Each thruster's fraction of full ahead (1) or full astern (−1).
    Thrust {
        /// Port thruster.
        port: f64,
        /// Starboard thruster.
        starboard: f64,
    },
    /// Thrust and rudder of a kinematic boat, without its control loops.
    Impose {
        /// Thrust, per cent.
        thrust: f64,
        /// Rudder, per cent, positive to starboard.
        rudder: f64,
    },
    /// The front seat steers this heading at this speed.
    Steer {
        /// Desired heading, rad clockwise from north.
        heading_rad: f64,
        /// Desired speed, m/s.
        speed_m_s: f64,
    },
}

impl Command {
    /// The columns of [`Command::Hold`], which needs none and is compatible with the columns of any
    /// other command.
    pub(crate) const NO_COLUMNS: [&str; 2] = ["", ""];

    /// The columns for a command of this kind.
    pub(crate) fn columns(&self) -> [&'static str; 2] {
        match self {
            Command::Hold => Command::NO_COLUMNS,
            Command::Thrust { .. } => ["port_pct", "starboard_pct"],
            Command::Impose { .. } => ["thrust_pct", "rudder_pct"],
            Command::Steer { .. } => ["speed_m_s", "heading_order_deg"],
        }
    }

    /// The values in those columns.
    pub(crate) fn numbers(&self) -> [f64; 2] {
        match *self {
            Command::Hold => [0.0, 0.0],
            Command::Thrust { port, starboard } => [100.0 * port, 100.0 * starboard],
            Command::Impose { thrust, rudder } => [thrust, rudder],
            Command::Steer {
                heading_rad,
                speed_m_s,
            } => [
                speed_m_s,
                primitives::angle::compass_deg_from_rad(heading_rad),
            ],
        }
    }
}

/// A pair of columns that together form a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// Shaft speeds of a boat with a propeller curve, rad/s.
    RadS,
    /// Settings in per cent: as in a thrust table, or relative to a propeller's full ahead or
    /// astern.
    Pct,
    /// Thrusts, N, converted to settings by the inverse thrust curve.
    Newton,
    /// Thrust and rudder of a kinematic boat.
    ThrustRudder,
    /// Speed and heading, for the front seat.
    SpeedHeading,
}

impl Pair {
    /// All pairs.
    pub const ALL: [Pair; 5] = [
        Pair::RadS,
        Pair::Pct,
        Pair::ThrustRudder,
        Pair::SpeedHeading,
        Pair::Newton,
    ];

    /// The names of the two columns, in order.
    pub fn columns(self) -> [&'static str; 2] {
        match self {
            Pair::RadS => ["port_rad_s", "starboard_rad_s"],
            Pair::Pct => ["port_pct", "starboard_pct"],
            Pair::Newton => ["port_newton", "starboard_newton"],
            Pair::ThrustRudder => ["thrust_pct", "rudder_pct"],
            Pair::SpeedHeading => ["speed_m_s", "heading_deg"],
        }
    }
}

/// The commands that a kind of boat accepts, and their ranges.
#[derive(Clone, Debug)]
pub enum Engine {
    /// Two thrusters.
    Thrusters(Box<ThrusterModel>, Thruster),
    /// A throttle and a rudder.
    Kinematic(Kinematic),
}

impl Engine {
    /// The engine of `boat`.
    pub fn new(boat: &Boat) -> Engine {
        match &boat.drive {
            // The tick affects how an engine responds, not the commands it accepts.
            Drive::Thrusters { thruster, .. } => Engine::Thrusters(
                Box::new(ThrusterModel::new(thruster, 0.05)),
                thruster.clone(),
            ),
            Drive::Kinematic(kinematic) => Engine::Kinematic(kinematic.clone()),
        }
    }

    /// The mean throttle of `TrialBoat::settings`, as a fraction of full.
    pub(crate) fn throttle(&self, settings: [f64; 2]) -> f64 {
        match self {
            Engine::Thrusters(model, _) => {
                let share = |setting: f64| setting / model.setting_of_share(setting.signum()).abs();
                0.5 * (share(settings[0]) + share(settings[1]))
            }
            Engine::Kinematic(_) => settings[0] / 100.0,
        }
    }

    /// The allowed range of each of the two columns.
    ///
    /// # Errors
    /// If the boat does not accept them. The message names the missing part and the accepted
    /// columns.
    pub fn ranges(&self, pair: Pair) -> Result<[(f64, f64); 2], String> {
        match (self, pair) {
            (Engine::Thrusters(_, thruster), Pair::RadS) => match &thruster.curve {
                ThrustCurve::Propeller(propeller) => Ok([(-propeller.n_min_rad_s, propeller.n_max_rad_s); 2]),
                ThrustCurve::Table { .. } => Err("the boat has a thrust table and no propeller curve, expected \
                     port_pct,starboard_pct or port_newton,starboard_newton"
                    .to_owned()),
            },
            (Engine::Thrusters(_, thruster), Pair::Pct) => match &thruster.curve {
                ThrustCurve::Table { points } => Ok([(100.0 * points[0].0, 100.0 * points[points.len() - 1].0); 2]),
                ThrustCurve::Propeller(_) => Ok([(-100.0, 100.0); 2]),
            },
            (Engine::Thrusters(model, _), Pair::Newton) => Ok([(model.newton_min, model.newton_max); 2]),
            (Engine::Thrusters(..), Pair::ThrustRudder) => Err("the boat has two thrusters and no rudder, expected \
                 port_rad_s,starboard_rad_s, port_pct,starboard_pct, port_newton,starboard_newton or \
                 speed_m_s,heading_deg"
                .to_owned()),
            (Engine::Kinematic(_), Pair::RadS | Pair::Pct | Pair::Newton) => {
                Err("the boat is kinematic and has no thrusters, expected thrust_pct,rudder_pct or \
                     speed_m_s,heading_deg"
                    .to_owned())
            }
            (Engine::Kinematic(_), Pair::ThrustRudder) => Ok([(-100.0, 100.0); 2]),
            (_, Pair::SpeedHeading) => Ok([(0.0, 100.0), (-720.0, 720.0)]),
        }
    }

    /// The command for two numbers within [`Engine::ranges`].
    pub fn command(&self, pair: Pair, [a, b]: [f64; 2]) -> Command {
        match (self, pair) {
            (_, Pair::ThrustRudder) => Command::Impose {
                thrust: a,
                rudder: b,
            },
            (_, Pair::SpeedHeading) => Command::Steer {
                heading_rad: b.to_radians(),
                speed_m_s: a,
            },
            (Engine::Thrusters(model, thruster), _) => {
                let share = |number: f64| share(model, thruster, pair, number).clamp(-1.0, 1.0);
                Command::Thrust {
                    port: share(a),
                    starboard: share(b),
                }
            }
            (Engine::Kinematic(_), _) => Command::Hold,
        }
    }
}

/// Converts a number in a thruster's column to a fraction of full ahead or astern.
fn share(model: &ThrusterModel, thruster: &Thruster, pair: Pair, number: f64) -> f64 {
    let setting = match (pair, &thruster.curve) {
        (Pair::Pct, ThrustCurve::Propeller(_)) => return number / 100.0,
        (Pair::Pct, ThrustCurve::Table { .. }) => number / 100.0,
        (Pair::Newton, _) => model.setting(number),
        _ => number,
    };
    let full = model
        .setting_of_share(if setting < 0.0 { -1.0 } else { 1.0 })
        .abs();
    if full > 0.0 { setting / full } else { 0.0 }
}
