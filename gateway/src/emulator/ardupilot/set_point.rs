//! The set-points of an emulated ArduPilot boat, and their lifetime.

use crate::emulator::autopilot;
use crate::mavlink::dialect::{
    AttitudeTargetTypemask, MANUAL_CONTROL_DATA, MavFrame, PositionTargetTypemask,
    RC_CHANNELS_OVERRIDE_DATA, SET_ATTITUDE_TARGET_DATA, SET_POSITION_TARGET_GLOBAL_INT_DATA,
    SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use messages::Order;
use primitives::angle::wrap_pi;
use primitives::frame::{Ned, Pose, Rotation};
use primitives::{SimTime, math};
use std::f64::consts::PI;

/// Lifetime of a set-point in mode GUIDED, and of remote control input over MAVLink, s.
const HELD_S: f64 = 3.0;
/// Rover's message when a set-point in mode GUIDED expires.
pub(super) const FORGOTTEN: &str = "target not received last 3secs, stopping";
/// A boat ordered to turn at a rate steers to the heading that it reaches at this rate in this
/// time, s.
const TURN_LEAD_S: f64 = 1.0;
/// Minimum commanded speed on the way to a position, m/s.
pub(super) const SPEED_MIN_M_S: f64 = 0.05;
/// Maximum commanded speed, m/s.
const SPEED_MAX_M_S: f64 = 100.0;

/// The steering target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// A true heading, rad.
    Heading(f64),
    /// A rate of turn, rad/s.
    Turn(f64),
}

/// The bits of `type_mask` with which a set-point ignores position, velocity, acceleration, yaw and
/// rate of turn; those of z do not matter to a boat.
const POSITION: u16 = 0b11;
const VELOCITY: u16 = 0b1_1000;
const ACCELERATION: u16 = 0b1100_0000;
const YAW: u16 = 0b100_0000_0000;
const YAW_RATE: u16 = 0b1000_0000_0000;

/// The contents of a message.
struct Target {
    mask: PositionTargetTypemask,
    /// The position, if valid.
    place: Option<Ned>,
    /// Velocity along the axes of the message's frame, m/s.
    velocity: [f32; 2],
    /// Yaw in that frame, rad, and rate of turn, rad/s.
    yaw: [f32; 2],
    /// The true heading of the first axis of the frame, rad.
    frame_rad: f64,
}

/// Whether positions in a frame are given as latitude and longitude.
#[expect(deprecated, reason = "ground stations send the older frames, too")]
pub(super) fn is_global(frame: MavFrame) -> bool {
    matches!(
        frame,
        MavFrame::MAV_FRAME_GLOBAL
            | MavFrame::MAV_FRAME_GLOBAL_INT
            | MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT
            | MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
            | MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT
            | MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT
    )
}

/// The set-points in force.
#[derive(Clone, Debug, Default)]
pub(super) struct SetPoints {
    /// In mode GUIDED: when the set-point arrived, the steering target, and the speed, m/s.
    pub(super) guided: Option<(SimTime, Course, f64)>,
    /// The destination in mode GUIDED, if a position was commanded.
    destination: Option<Ned>,
    /// The commanded speed on the way to the destination, if any, m/s.
    speed_m_s: Option<f64>,
    /// The input of a remote control over MAVLink: throttle and steering, -1 to 1.
    pub(super) manual: Option<(SimTime, f64, f64)>,
}

impl SetPoints {
    pub(super) fn forget(&mut self) {
        *self = SetPoints::default();
    }

    /// Whether a set-point in mode GUIDED has just expired.
    pub(super) fn expires(&mut self, now: SimTime) -> bool {
        self.guided
            .take_if(|(at, ..)| (now - *at).as_s() > HELD_S)
            .is_some()
    }

    /// Sets a heading or a rate of turn, with a fraction of the maximum speed (m/s).
    ///
    /// # Errors
    /// The reason if Rover ignores it.
    pub(super) fn take_attitude(
        &mut self,
        now: SimTime,
        target: &SET_ATTITUDE_TARGET_DATA,
        speed_max_m_s: f64,
    ) -> Result<(), &'static str> {
        let mask = target.type_mask;
        // Rover drops the whole message if it contains no throttle.
        if mask.contains(AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE) {
            return Err("set-point ignored: it has no throttle");
        }
        let speed_m_s = f64::from(target.thrust).clamp(-1.0, 1.0) * speed_max_m_s;
        let no_rate = AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE;
        let course = if mask.contains(no_rate) {
            let [w, x, y, z] = target.q.map(f64::from);
            Course::Heading(math::atan2(
                2.0 * (w * z + x * y),
                1.0 - 2.0 * (y * y + z * z),
            ))
        } else {
            Course::Turn(f64::from(target.body_yaw_rate))
        };
        self.set(now, course, speed_m_s)
    }

    /// Sets a position relative to the origin or the boat, or a velocity. The boat's own heading
    /// matters in frames that rotate with the boat.
    ///
    /// # Errors
    /// The reason if Rover ignores it.
    #[expect(
        deprecated,
        reason = "ground stations use frames that move with the boat, and Rover accepts them"
    )]
    pub(super) fn take_local(
        &mut self,
        now: SimTime,
        target: &SET_POSITION_TARGET_LOCAL_NED_DATA,
        (pose, origin): (Pose, Ned),
        speed_max_m_s: f64,
    ) -> Result<(), &'static str> {
        let offset = Ned {
            north: f64::from(target.x),
            east: f64::from(target.y),
        };
        let (frame_rad, place) = match target.coordinate_frame {
            MavFrame::MAV_FRAME_LOCAL_NED => (0.0, origin + offset),
            MavFrame::MAV_FRAME_LOCAL_OFFSET_NED => (0.0, pose.at + offset),
            MavFrame::MAV_FRAME_BODY_NED | MavFrame::MAV_FRAME_BODY_OFFSET_NED => {
                let ahead = Rotation::from_heading(pose.psi_rad);
                let turned =
                    ahead.ahead().scaled(offset.north) + ahead.starboard().scaled(offset.east);
                (pose.psi_rad, pose.at + turned)
            }
            _ => return Err("set-point ignored: unsupported frame"),
        };
        let target = Target {
            mask: target.type_mask,
            place: Some(place),
            velocity: [target.vx, target.vy],
            yaw: [target.yaw, target.yaw_rate],
            frame_rad,
        };
        self.follow(now, &target, speed_max_m_s)
    }

    /// Sets a position on the globe, `place`, or a velocity.
    ///
    /// # Errors
    /// The reason if Rover ignores it.
    pub(super) fn take_global(
        &mut self,
        now: SimTime,
        target: &SET_POSITION_TARGET_GLOBAL_INT_DATA,
        place: Option<Ned>,
        speed_max_m_s: f64,
    ) -> Result<(), &'static str> {
        if !is_global(target.coordinate_frame) {
            return Err("set-point ignored: unsupported frame");
        }
        let target = Target {
            mask: target.type_mask,
            place,
            velocity: [target.vx, target.vy],
            yaw: [target.yaw, target.yaw_rate],
            frame_rad: 0.0,
        };
        self.follow(now, &target, speed_max_m_s)
    }

    /// Sets a position, or a speed with a rate of turn or a heading. Without a separate heading,
    /// that of the velocity is used. Follows Rover's `handle_set_position_target_local_ned`,
    /// including the sign that it gives the speed.
    fn follow(
        &mut self,
        now: SimTime,
        target: &Target,
        speed_max_m_s: f64,
    ) -> Result<(), &'static str> {
        let has = |bits: u16| target.mask.bits() & bits == 0;
        if has(POSITION) {
            let is_taken = target.place.is_some_and(|place| self.go_to(place));
            return is_taken
                .then_some(())
                .ok_or("set-point ignored: invalid position");
        }
        if has(ACCELERATION) {
            return Err("set-point ignored: set ACC_IGNORE in mask");
        }
        let [x_m_s, y_m_s] = target
            .velocity
            .map(|v| if has(VELOCITY) { v.into() } else { 0.0 });
        let [yaw_rad, rate_rad_s] = target.yaw.map(f64::from);
        let course = match (has(YAW), has(YAW_RATE)) {
            // Rover ignores a message with both a yaw and a yaw rate.
            (true, true) => return Err("set-point ignored: yaw and yaw rate"),
            (true, false) => Course::Heading(yaw_rad + target.frame_rad),
            (false, true) => Course::Turn(rate_rad_s),
            (false, false) if !has(VELOCITY) => {
                return Err("set-point ignored: mask without a target");
            }
            (false, false) => Course::Heading(math::atan2(y_m_s, x_m_s) + target.frame_rad),
        };
        // The speed takes the sign of x, even in frames where x points north. This bug in
        // Rover/GCS_MAVLink_Rover.cpp sent boats astern on southward headings. It is imitated so
        // that our closed-loop tests detect a yaw sent with a velocity.
        let is_astern = (has(YAW) || has(YAW_RATE)) && x_m_s < 0.0;
        let sign = if is_astern { -1.0 } else { 1.0 };
        self.set(
            now,
            course,
            sign * math::length(x_m_s, y_m_s).min(speed_max_m_s),
        )
    }

    /// Goes to a position; returns whether it is valid.
    pub(super) fn go_to(&mut self, place: Ned) -> bool {
        if place.is_finite() {
            (self.guided, self.destination) = (None, Some(place));
        }
        place.is_finite()
    }

    /// Sets the speed (m/s) on the way to a position. Returns `false` if there is no position or
    /// the speed is too low.
    pub(super) fn set_speed(&mut self, speed_m_s: f64) -> bool {
        let is_taken = self.destination.is_some() && speed_m_s >= SPEED_MIN_M_S;
        if is_taken {
            self.speed_m_s = Some(speed_m_s);
        }
        is_taken
    }

    /// The destination in mode GUIDED, if any, and the commanded speed, m/s.
    pub(super) fn destination(&self) -> Option<(Ned, Option<f64>)> {
        self.destination.map(|place| (place, self.speed_m_s))
    }

    /// The ordered heading in mode GUIDED, whole degrees, as version 4.7 shows it (earlier versions
    /// show 0); 0 if there is none.
    pub(super) fn nav_bearing(&self, now: SimTime) -> i16 {
        match self.guided {
            Some((at, Course::Heading(heading_rad), _)) if (now - at).as_s() <= HELD_S => {
                // Truncated, not rounded.
                wrap_pi(heading_rad).to_degrees() as i16
            }
            _ => 0,
        }
    }

    fn set(&mut self, now: SimTime, course: Course, speed_m_s: f64) -> Result<(), &'static str> {
        let (Course::Heading(steered) | Course::Turn(steered)) = course;
        if !steered.is_finite() || !speed_m_s.is_finite() {
            return Err("set-point ignored: a value is not finite");
        }
        (self.guided, self.destination) = (Some((now, course, speed_m_s)), None);
        Ok(())
    }

    /// Manual control: steering is the y axis and throttle the z axis, both -1000 to 1000 with rest
    /// at 0.
    pub(super) fn take_manual(&mut self, now: SimTime, control: &MANUAL_CONTROL_DATA) {
        let [steering, throttle] =
            [control.y, control.z].map(|axis| (0.001 * f64::from(axis)).clamp(-1.0, 1.0));
        self.manual = Some((now, throttle, steering));
    }

    /// RC override: steering is channel 1, throttle channel 3, 1000 to 2000 µs with rest at 1500; 0
    /// means no override.
    pub(super) fn take_channels(&mut self, now: SimTime, channels: &RC_CHANNELS_OVERRIDE_DATA) {
        let [steering, throttle] = [channels.chan1_raw, channels.chan3_raw].map(|us| match us {
            0 | u16::MAX => 0.0,
            us => (0.002 * (f64::from(us) - 1500.0)).clamp(-1.0, 1.0),
        });
        self.manual = Some((now, throttle, steering));
    }

    pub(super) fn manual(&self, now: SimTime) -> Order {
        match self.manual {
            Some((at, throttle, steering)) if (now - at).as_s() <= HELD_S => {
                // PILOT_STEER_TYPE 0: astern, the same stick position turns the boat the other way,
                // as in a car.
                let side = if throttle < 0.0 { -1.0 } else { 1.0 };
                autopilot::thrust(100.0 * throttle, 100.0 * side * steering)
            }
            _ => Order::Hold,
        }
    }

    /// The order from the set-point in mode GUIDED, if any.
    pub(super) fn guided(&self, psi_rad: f64) -> Option<Order> {
        let (_, course, speed_m_s) = self.guided?;
        Some(match course {
            Course::Heading(heading_rad) if speed_m_s < 0.0 => {
                autopilot::astern(speed_m_s, wrap_pi(heading_rad - psi_rad))
            }
            Course::Turn(rate_rad_s) if speed_m_s < 0.0 => {
                autopilot::astern(speed_m_s, rate_rad_s * TURN_LEAD_S)
            }
            Course::Heading(heading_rad) => autopilot::steer(Some(heading_rad), Some(speed_m_s)),
            // Our gateway stops a boat with a set-point of zero: the boat must rest, not hold a
            // heading.
            Course::Turn(0.0) if speed_m_s == 0.0 => Order::Hold,
            Course::Turn(rate_rad_s) => {
                let by_rad = (rate_rad_s * TURN_LEAD_S).clamp(-PI, PI);
                Order::Turn {
                    by_rad,
                    speed_m_s: speed_m_s.min(SPEED_MAX_M_S),
                }
            }
        })
    }
}
