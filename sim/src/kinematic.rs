//! The point boat of MOOS: a throttle, a rudder and two PID loops, without mass.
//!
//! The model is uSimMarine with pMarinePID (moos-ivp, `SimEngine::propagate…` and `PIDEngine`) as
//! implemented in Pyquaticus. Its quirks are kept, because other projects train policies with it
//! and we must reproduce their numbers. For one step of `dt`:
//!
//! ```text
//! thrust  += PID_speed(v_wanted - v), or v_wanted * speed_factor;   below 0.01 it is 0
//! rudder   = PID_heading(error) while there is thrust, else 0
//! v_next   = map(thrust) (1 - turn_loss |rudder| / 100), within v - deceleration dt and v + acceleration dt
//! heading += ±rudder turn_rate / 100 (1 + (|thrust| - 50) / 50) dt + rotate dt;   no rudder where v_next is 0
//! v        = (v_next + v) / 2;   the position moves v dt along the circular mean of the old and new heading
//! ```
//!
//! Averaging old and new speed halves the acceleration limits: a configured 0.15 m/s² becomes
//! 0.075. The loops act once per step, not once per second: behaviour depends on `dt`, and the
//! reference numbers are for 0.1 s.

use crate::piecewise_linear::PiecewiseLinear;
use messages::Order;
use primitives::{Ned, Rotation, math};
use scenario::boat::{Kinematic, Pid};
use serde::{Deserialize, Serialize};

/// Thrust below which it counts as 0, per cent.
const THRUST_MIN: f64 = 0.01;
/// Maximum thrust and rudder in uSimMarine, whatever the limits of the loops, per cent.
const FULL: f64 = 100.0;

/// A point boat with precomputed constants.
#[derive(Clone, Debug)]
pub struct KinematicModel {
    boat: Kinematic,
    /// Speed, m/s, as a function of thrust, per cent.
    speed_of_thrust: PiecewiseLinear,
    /// Maximum rudder that the heading loop sets, per cent.
    rudder_max: f64,
    rotate_deg_s: f64,
}

/// The changing state of a point boat without its position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KinematicState {
    /// Speed through the water, m/s.
    pub speed_m_s: f64,
    /// Heading, degrees clockwise from north, −180 to 180, as in the reference.
    pub heading_deg: f64,
    /// Thrust, per cent.
    pub thrust: f64,
    /// Rudder, per cent to starboard.
    pub rudder: f64,
    speed_loop: Loop,
    heading_loop: Loop,
}

/// A point boat's motion in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KinematicMotion {
    /// Distance travelled, including drift, m.
    pub travel_m: Ned,
    /// Change of heading, rad clockwise.
    pub turn_rad: f64,
}

/// The state of a PID loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Loop {
    /// The last error; `None` before the first call, which has no derivative.
    error: Option<f64>,
    integral: f64,
}

impl Loop {
    /// The output for `error`, within ±`limit`.
    fn answer(&mut self, gains: Pid, error: f64, limit: f64, dt_s: f64) -> f64 {
        // As in PIDEngine, the first step has no derivative kick.
        let rate = self.error.map_or(0.0, |before| (error - before) / dt_s);
        self.error = Some(error);
        self.integral =
            (self.integral + gains.i * error * dt_s).clamp(-gains.i_limit, gains.i_limit);
        (gains.p * error + gains.d * rate + self.integral).clamp(-limit, limit)
    }
}

impl KinematicState {
    /// A boat at rest with this heading.
    pub fn at_rest(psi_rad: f64) -> KinematicState {
        KinematicState {
            heading_deg: wrap_180(psi_rad.to_degrees()),
            ..KinematicState::default()
        }
    }

    /// A boat in steady state with this heading, speed (m/s) and thrust (per cent), whose loops
    /// have no remaining errors.
    pub fn under_way(psi_rad: f64, speed_m_s: f64, thrust: f64) -> KinematicState {
        let settled = Loop {
            error: Some(0.0),
            integral: 0.0,
        };
        KinematicState {
            speed_m_s,
            thrust,
            speed_loop: settled,
            heading_loop: settled,
            ..KinematicState::at_rest(psi_rad)
        }
    }

    /// Heading, rad clockwise from north, −pi to pi.
    pub fn psi_rad(&self) -> f64 {
        self.heading_deg.to_radians()
    }

    /// Removes the velocity along the unit vector `out`, in both directions, and turns the boat in
    /// the direction of the remaining velocity. A boat that moves exactly against `out` stops and
    /// turns to starboard.
    pub fn slide_across(&mut self, out: Ned) {
        let along = Ned {
            north: -out.east,
            east: out.north,
        };
        let way_m_s = Rotation::from_heading(self.psi_rad())
            .ahead()
            .scaled(self.speed_m_s)
            .dot(along);
        let ahead = along.scaled(if way_m_s > 0.0 { 1.0 } else { -1.0 });
        self.divert(math::atan2(ahead.east, ahead.north), way_m_s.abs());
    }

    /// Sets heading and speed, for example after contact. The loops keep their state.
    pub fn divert(&mut self, psi_rad: f64, speed_m_s: f64) {
        self.heading_deg = wrap_180(psi_rad.to_degrees());
        self.speed_m_s = speed_m_s.max(0.0);
    }
}

impl KinematicModel {
    /// The model of `boat`.
    pub fn new(boat: &Kinematic) -> KinematicModel {
        KinematicModel {
            speed_of_thrust: PiecewiseLinear::new(&boat.thrust_map),
            rudder_max: boat.rudder_max.min(FULL),
            rotate_deg_s: boat.rotate_rad_s.to_degrees(),
            boat: boat.clone(),
        }
    }

    /// The thrust for this speed straight ahead, per cent: the inverse of the thrust map, clamped
    /// at its ends.
    pub fn thrust_for_speed(&self, speed_m_s: f64) -> f64 {
        math::interpolate(
            self.boat
                .thrust_map
                .iter()
                .map(|(thrust, speed_m_s)| (*speed_m_s, *thrust)),
            speed_m_s,
        )
    }

    /// Advances a boat by `dt_s` in a current of `drift_m_s`.
    ///
    /// The loops follow orders of course and speed. For an order of two thrusts (fractions of
    /// full), the loops do not run: thrust is half the sum of the two, and rudder half their
    /// difference. Hold means speed 0 on the current heading.
    pub fn step(
        &self,
        state: &mut KinematicState,
        command: Order,
        drift_m_s: Ned,
        dt_s: f64,
    ) -> KinematicMotion {
        self.control(state, command, dt_s);
        let v_next_m_s = self.next_speed(state, dt_s);
        let turn_deg = self.turn_deg(state, v_next_m_s, dt_s);
        let heading_deg = wrap_180(state.heading_deg + turn_deg);
        let v_mean_m_s = 0.5 * (v_next_m_s + state.speed_m_s);
        let way = circular_mean(state.heading_deg, heading_deg).scaled(v_mean_m_s);
        // Motion astern changes the position once and is then discarded: the reference keeps no
        // negative speed.
        state.speed_m_s = v_mean_m_s.clamp(0.0, self.boat.speed_max_m_s);
        state.heading_deg = heading_deg;
        KinematicMotion {
            travel_m: (way + drift_m_s).scaled(dt_s),
            turn_rad: turn_deg.to_radians(),
        }
    }

    /// Sets thrust and rudder (pMarinePID).
    fn control(&self, state: &mut KinematicState, command: Order, dt_s: f64) {
        let boat = &self.boat;
        let (wanted_m_s, error_deg) = match command {
            Order::Thrust { port, starboard } => {
                state.thrust = (0.5 * FULL * (port + starboard)).clamp(-FULL, FULL);
                state.rudder = (0.5 * FULL * (port - starboard)).clamp(-FULL, FULL);
                return;
            }
            Order::Steer {
                heading_rad,
                speed_m_s,
            } => (
                speed_m_s.min(boat.speed_max_m_s),
                wrap_180(heading_rad.to_degrees() - state.heading_deg),
            ),
            Order::Turn { by_rad, speed_m_s } => {
                (speed_m_s.min(boat.speed_max_m_s), by_rad.to_degrees())
            }
            Order::Hold => (0.0, 0.0),
        };
        // pMarinePID supports both a fixed factor from speed to thrust and a loop that changes the
        // previous thrust.
        let thrust = if boat.speed_factor > 0.0 {
            wanted_m_s * boat.speed_factor
        } else {
            let error_m_s = wanted_m_s - state.speed_m_s;
            state.thrust
                + state
                    .speed_loop
                    .answer(boat.speed_pid, error_m_s, boat.thrust_max, dt_s)
        };
        // The reference clips at zero, so a point boat never reverses its thrust to brake.
        state.thrust = if thrust < THRUST_MIN {
            0.0
        } else {
            thrust.min(boat.thrust_max)
        };
        // Without thrust the heading loop does not run and keeps its state.
        state.rudder = if state.thrust > 0.0 {
            state
                .heading_loop
                .answer(boat.heading_pid, error_deg, self.rudder_max, dt_s)
        } else {
            0.0
        };
    }

    /// The speed from thrust and rudder, within the acceleration limits (uSimMarine).
    fn next_speed(&self, state: &KinematicState, dt_s: f64) -> f64 {
        let boat = &self.boat;
        let raw_m_s = self.speed_of_thrust.at(state.thrust)
            * (1.0 - boat.turn_loss * state.rudder.abs() / FULL);
        let limit = |rate_m_s2: f64| {
            if rate_m_s2 > 0.0 {
                rate_m_s2 * dt_s
            } else {
                f64::INFINITY
            }
        };
        let least = state.speed_m_s - limit(boat.deceleration_max_m_s2);
        let most = state.speed_m_s + limit(boat.acceleration_max_m_s2);
        // Not `clamp`, which panics on NaN; a later check handles NaN.
        raw_m_s.min(most).max(least)
    }

    /// Change of heading by rudder and bias (uSimMarine).
    fn turn_deg(&self, state: &KinematicState, v_next_m_s: f64, dt_s: f64) -> f64 {
        let rudder = if v_next_m_s == 0.0 { 0.0 } else { state.rudder };
        let side = if state.thrust < 0.0 { -1.0 } else { 1.0 };
        // More thrust turns faster: at 100 % twice as fast as at 50 %.
        let more = 1.0 + (state.thrust.abs() - 50.0) / 50.0;
        side * rudder * (self.boat.turn_rate / 100.0) * dt_s * more + self.rotate_deg_s * dt_s
    }
}

/// Wraps degrees to −180 to 180 by whole turns. Both ends are included, because the reference
/// distinguishes them.
fn wrap_180(angle_deg: f64) -> f64 {
    if angle_deg > 180.0 {
        angle_deg - 360.0 * ((angle_deg - 180.0) / 360.0).ceil()
    } else if angle_deg < -180.0 {
        angle_deg + 360.0 * ((-180.0 - angle_deg) / 360.0).ceil()
    } else {
        angle_deg
    }
}

/// The unit vector half-way between two headings.
// Not at half the sum, which would point north for headings on both sides of south.
fn circular_mean(a_deg: f64, b_deg: f64) -> Ned {
    let [a, b] = [a_deg, b_deg].map(|deg: f64| Rotation::from_heading(deg.to_radians()));
    Rotation::from_heading(math::atan2(a.sin + b.sin, a.cos + b.cos)).ahead()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A boat with simple numbers: thrust in per cent equals speed in cm/s, with no limits or
    /// losses.
    fn plain() -> Kinematic {
        let none = Pid {
            p: 0.0,
            i: 0.0,
            d: 0.0,
            i_limit: 0.0,
        };
        Kinematic {
            speed_max_m_s: 1.0,
            thrust_map: vec![(-100.0, -1.0), (100.0, 1.0)],
            thrust_max: 100.0,
            rudder_max: 100.0,
            turn_rate: 10.0,
            turn_loss: 0.0,
            rotate_rad_s: 0.0,
            acceleration_max_m_s2: 0.0,
            deceleration_max_m_s2: 0.0,
            speed_factor: 100.0,
            speed_pid: none,
            heading_pid: Pid { p: 1.0, ..none },
        }
    }

    fn step(boat: &Kinematic, state: &mut KinematicState, command: Order) -> KinematicMotion {
        KinematicModel::new(boat).step(state, command, Ned::default(), 0.1)
    }

    fn ahead(speed_m_s: f64) -> Order {
        Order::Steer {
            heading_rad: 0.0,
            speed_m_s,
        }
    }

    #[test]
    fn it_asks_no_more_than_its_highest_speed() {
        let mut state = KinematicState::default();
        step(&plain(), &mut state, ahead(f64::INFINITY));
        assert_eq!(state.thrust, 100.0);
    }

    #[test]
    fn drift_carries_it_along_and_nothing_else() {
        let drift = Ned {
            north: 0.3,
            east: -0.2,
        };
        let model = KinematicModel::new(&plain());
        let command = Order::Steer {
            heading_rad: 1.0,
            speed_m_s: 0.8,
        };
        let mut still = KinematicState::default();
        let mut adrift = KinematicState::default();
        for _ in 0..50 {
            let a = model.step(&mut still, command, Ned::default(), 0.1);
            let b = model.step(&mut adrift, command, drift, 0.1);
            assert!((b.travel_m - a.travel_m).distance(drift.scaled(0.1)) < 1e-15);
            assert_eq!(still, adrift);
        }
    }

    #[test]
    fn without_thrust_there_is_no_rudder_and_without_way_no_turn() {
        let mut state = KinematicState {
            speed_m_s: 1.0,
            ..KinematicState::default()
        };
        step(
            &plain(),
            &mut state,
            Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 0.0,
            },
        );
        assert_eq!((state.thrust, state.rudder), (0.0, 0.0));
        let mut state = KinematicState::default();
        let motion = step(
            &plain(),
            &mut state,
            Order::Thrust {
                port: 1.0,
                starboard: -1.0,
            },
        );
        assert_eq!((motion.turn_rad, state.rudder), (0.0, 100.0));
    }

    #[test]
    fn astern_the_rudder_turns_the_other_way_and_no_way_is_kept() {
        let mut state = KinematicState::default();
        let motion = step(
            &plain(),
            &mut state,
            Order::Thrust {
                port: -0.5,
                starboard: -1.0,
            },
        );
        assert_eq!((state.thrust, state.rudder), (-75.0, 25.0));
        let want_deg: f64 = -25.0 * 0.1 * 0.1 * 1.5;
        assert!(
            (motion.turn_rad - want_deg.to_radians()).abs() < 1e-15,
            "{}",
            motion.turn_rad
        );
        assert!(
            motion.travel_m.north < 0.0 && state.speed_m_s == 0.0,
            "{motion:?}"
        );
    }

    #[test]
    fn a_bias_turns_it_even_at_rest() {
        let mut boat = plain();
        boat.rotate_rad_s = 0.02;
        let mut state = KinematicState::at_rest(3.135);
        for _ in 0..10 {
            step(&boat, &mut state, Order::Hold);
        }
        let turned = primitives::angle::wrap_pi(state.psi_rad() - 3.135);
        assert!(
            (turned - 0.02).abs() < 1e-12 && state.psi_rad() < 0.0,
            "{turned}"
        );
    }

    #[test]
    fn angles_keep_the_border_they_came_to() {
        for (input_deg, want_deg) in [
            (180.0, 180.0),
            (-180.0, -180.0),
            (181.0, -179.0),
            (-181.0, 179.0),
            (540.0, 180.0),
            (-540.0, -180.0),
            (725.0, 5.0),
        ] {
            assert_eq!(wrap_180(input_deg), want_deg, "{input_deg}");
        }
    }

    #[test]
    fn the_thrust_for_a_speed_is_the_map_backwards() {
        let mut boat = plain();
        boat.thrust_map = vec![
            (-100.0, -2.0),
            (0.0, 0.0),
            (40.0, 1.0),
            (80.0, 3.0),
            (100.0, 3.0),
        ];
        let model = KinematicModel::new(&boat);
        for (speed_m_s, want) in [
            (-9.0, -100.0),
            (-1.0, -50.0),
            (0.0, 0.0),
            (0.5, 20.0),
            (2.0, 60.0),
            (9.0, 100.0),
        ] {
            assert_eq!(model.thrust_for_speed(speed_m_s), want, "{speed_m_s}");
        }
    }

    #[test]
    fn a_boat_under_way_feels_the_derivative_of_its_first_error() {
        let mut boat = plain();
        boat.heading_pid = Pid {
            d: 0.1,
            ..boat.heading_pid
        };
        let turn = Order::Steer {
            heading_rad: 0.2,
            speed_m_s: 1.0,
        };
        let mut rested = KinematicState::at_rest(0.0);
        let mut sailing = KinematicState::under_way(0.0, 1.0, 100.0);
        step(&boat, &mut rested, turn);
        step(&boat, &mut sailing, turn);
        assert!(
            (sailing.rudder - 2.0 * rested.rudder).abs() < 1e-9,
            "{} and {}",
            sailing.rudder,
            rested.rudder
        );
    }

    #[test]
    fn bad_numbers_come_out_as_bad_numbers() {
        let mut state = KinematicState {
            heading_deg: f64::NAN,
            ..KinematicState::default()
        };
        for _ in 0..3 {
            step(&plain(), &mut state, ahead(1.0));
            assert!(state.psi_rad().is_nan());
        }
    }
}
