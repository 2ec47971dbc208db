//! Orders: requests from a mind to its boat.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// One order for one boat, in force until the next one or until it expires.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Order {
    /// Zero thrust: the safe order, and the order of a boat without an agent.
    #[default]
    Hold,
    /// The front seat's controllers steer this heading.
    Steer {
        /// Desired heading, radians clockwise from north.
        heading_rad: f64,
        /// Desired speed ahead over the ground, m/s; at least 0.
        speed_m_s: f64,
    },
    /// Sets both thrusters directly, each from -1 (full astern) to 1 (full ahead).
    Thrust {
        /// Port thruster.
        port: f64,
        /// Starboard thruster.
        starboard: f64,
    },
    /// The front seat's controllers turn continuously: at every tick, the ordered heading differs
    /// from the current one by this angle.
    Turn {
        /// Change of heading, radians clockwise, -pi to pi: half-turns to port and to starboard are
        /// different orders.
        by_rad: f64,
        /// Desired speed ahead over the ground, m/s; at least 0.
        speed_m_s: f64,
    },
}

/// Reason why an order is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum BadOrder {
    /// A number is NaN or infinite.
    #[error("a number is not finite")]
    NotFinite,
    /// A number is outside the permitted range.
    #[error(
        "a number is out of range (heading ±1000 rad, turn ±pi rad, speed 0 to 100 m/s, thrust ±1)"
    )]
    OutOfRange,
}

impl Order {
    /// Checks that every number is in range.
    ///
    /// # Errors
    /// [`BadOrder`] states the defect.
    pub fn check(self) -> Result<Order, BadOrder> {
        let (a, b, range_ok) = match self {
            Order::Hold => return Ok(self),
            Order::Steer {
                heading_rad,
                speed_m_s,
            } => (
                heading_rad,
                speed_m_s,
                (0.0..=100.0).contains(&speed_m_s) && heading_rad.abs() <= 1e3,
            ),
            Order::Turn { by_rad, speed_m_s } => (
                by_rad,
                speed_m_s,
                (0.0..=100.0).contains(&speed_m_s) && by_rad.abs() <= std::f64::consts::PI,
            ),
            Order::Thrust { port, starboard } => {
                (port, starboard, port.abs() <= 1.0 && starboard.abs() <= 1.0)
            }
        };
        if !(a.is_finite() && b.is_finite()) {
            return Err(BadOrder::NotFinite);
        }
        if range_ok {
            Ok(self)
        } else {
            Err(BadOrder::OutOfRange)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_orders_with_sound_numbers_pass() {
        let steer = |heading_rad, speed_m_s| Order::Steer {
            heading_rad,
            speed_m_s,
        };
        let turn = |by_rad, speed_m_s| Order::Turn { by_rad, speed_m_s };
        let thrust = |port, starboard| Order::Thrust { port, starboard };
        for (order, want) in [
            (Order::Hold, Ok(())),
            (steer(1.0, 2.0), Ok(())),
            (thrust(-1.0, 1.0), Ok(())),
            (turn(std::f64::consts::PI, 2.0), Ok(())),
            (turn(-std::f64::consts::PI, 2.0), Ok(())),
            (turn(3.2, 2.0), Err(BadOrder::OutOfRange)),
            (turn(0.0, -0.1), Err(BadOrder::OutOfRange)),
            (turn(f64::NAN, 2.0), Err(BadOrder::NotFinite)),
            (steer(f64::NAN, 2.0), Err(BadOrder::NotFinite)),
            (steer(1.0, f64::INFINITY), Err(BadOrder::NotFinite)),
            (steer(1.0, -0.1), Err(BadOrder::OutOfRange)),
            (thrust(1.01, 0.0), Err(BadOrder::OutOfRange)),
            (thrust(0.0, f64::NAN), Err(BadOrder::NotFinite)),
        ] {
            assert_eq!(order.check().map(|_| ()), want, "{order:?}");
        }
    }
}
