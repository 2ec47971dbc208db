//! The set-points of an emulated ArduPilot boat, and how long they hold.

use crate::emulator::autopilot;
use crate::mavlink::dialect::{
    AttitudeTargetTypemask, MANUAL_CONTROL_DATA, MavFrame, PositionTargetTypemask, RC_CHANNELS_OVERRIDE_DATA,
    SET_ATTITUDE_TARGET_DATA, SET_POSITION_TARGET_GLOBAL_INT_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use messages::Order;
use primitives::angle::wrap_pi;
use primitives::{SimTime, math};
use std::f64::consts::PI;

/// A set-point of mode GUIDED is forgotten after this time, s, as is one of a remote control by MAVLink.
const HELD_S: f64 = 3.0;
/// A boat turns by the rate of turn as if it were to point where that leads in this time, s.
const TURN_LEAD_S: f64 = 1.0;
/// No boat is asked for more, m/s.
const SPEED_MAX_M_S: f64 = 100.0;

/// What is to be steered.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    /// A true heading, rad.
    Heading(f64),
    /// A rate of turn, rad/s.
    Turn(f64),
}

/// A speed, m/s, or as a share of the cruise speed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Speed {
    MetresPerSecond(f64),
    Share(f64),
}

/// The set-points in force.
#[derive(Clone, Debug, Default)]
pub(super) struct SetPoints {
    guided: Option<(SimTime, Course, Speed)>,
    /// The position to which it goes instead: latitude and longitude, 1e-7 degrees.
    destination: Option<(i32, i32)>,
    /// Throttle and steering, -1 to 1.
    manual: Option<(SimTime, f64, f64)>,
}

impl SetPoints {
    pub(super) fn forget(&mut self) {
        *self = SetPoints::default();
    }

    pub(super) fn take_attitude(&mut self, now: SimTime, target: &SET_ATTITUDE_TARGET_DATA) {
        let mask = target.type_mask;
        // Rover drops the whole message when it carries no throttle.
        if mask.contains(AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE) {
            return;
        }
        let speed = Speed::Share(f64::from(target.thrust).clamp(-1.0, 1.0));
        if mask.contains(AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE) {
            let [w, x, y, z] = target.q.map(f64::from);
            let heading_rad = math::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
            self.set(now, Course::Heading(heading_rad), speed);
        } else {
            self.set(now, Course::Turn(f64::from(target.body_yaw_rate)), speed);
        }
    }

    /// Velocity with a heading, a rate of turn, or neither: then the boat turns to where the velocity points. The boat's own heading
    /// counts in frames that turn with it. As Rover's `handle_set_position_target_local_ned`, with its sign of the speed.
    #[expect(deprecated, reason = "ground stations send the frames of the boat, and Rover takes them")]
    pub(super) fn take_velocity(&mut self, now: SimTime, target: &SET_POSITION_TARGET_LOCAL_NED_DATA, psi_rad: f64) {
        let ignores = |flag: PositionTargetTypemask| target.type_mask.intersects(flag);
        let velocity = PositionTargetTypemask::POSITION_TARGET_TYPEMASK_VX_IGNORE
            | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_VY_IGNORE;
        let position = PositionTargetTypemask::POSITION_TARGET_TYPEMASK_X_IGNORE
            | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_Y_IGNORE;
        let turned_rad = match target.coordinate_frame {
            MavFrame::MAV_FRAME_LOCAL_NED | MavFrame::MAV_FRAME_LOCAL_OFFSET_NED => 0.0,
            MavFrame::MAV_FRAME_BODY_NED | MavFrame::MAV_FRAME_BODY_OFFSET_NED => psi_rad,
            _ => return,
        };
        // Positions on the field are for others.
        if ignores(velocity) || !ignores(position) {
            return;
        }
        let has_yaw = !ignores(PositionTargetTypemask::POSITION_TARGET_TYPEMASK_YAW_IGNORE);
        let has_rate = !ignores(PositionTargetTypemask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE);
        let (x_m_s, y_m_s) = (f64::from(target.vx), f64::from(target.vy));
        let course = match (has_yaw, has_rate) {
            // Rover takes one or the other, and nothing when both are given.
            (true, true) => return,
            (true, false) => Course::Heading(f64::from(target.yaw) + turned_rad),
            (false, true) => Course::Turn(f64::from(target.yaw_rate)),
            (false, false) => Course::Heading(math::atan2(y_m_s, x_m_s) + turned_rad),
        };
        // The sign of x is that of the speed, in frames where x is to the north too.
        // This is the mistake in Rover/GCS_MAVLink_Rover.cpp that sent boats astern on
        // southward headings. It is imitated so that our closed loops show it if a yaw is ever
        // sent with a velocity again.
        let sign = if (has_yaw || has_rate) && x_m_s < 0.0 { -1.0 } else { 1.0 };
        self.set(now, course, Speed::MetresPerSecond(sign * math::length(x_m_s, y_m_s)));
    }

    /// A position to go to; velocities and headings that come with it are for others.
    pub(super) fn take_destination(&mut self, target: &SET_POSITION_TARGET_GLOBAL_INT_DATA) {
        let position = PositionTargetTypemask::POSITION_TARGET_TYPEMASK_X_IGNORE
            | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_Y_IGNORE;
        if !target.type_mask.intersects(position) {
            (self.guided, self.destination) = (None, Some((target.lat_int, target.lon_int)));
        }
    }

    /// The position to which it goes in mode GUIDED, if it goes to one.
    pub(super) fn destination(&self) -> Option<(i32, i32)> {
        self.destination
    }

    /// The heading that is ordered in mode GUIDED, whole degrees, as version 4.7 shows it (earlier ones show 0); 0 without one.
    pub(super) fn nav_bearing(&self, now: SimTime) -> i16 {
        match self.guided {
            Some((at, Course::Heading(heading_rad), _)) if (now - at).as_s() <= HELD_S => {
                // Rover 4.7 shows whole degrees here, cut off and not rounded; earlier versions
                // always 0.
                wrap_pi(heading_rad).to_degrees() as i16
            }
            _ => 0,
        }
    }

    /// What is not finite is not followed.
    fn set(&mut self, now: SimTime, course: Course, speed: Speed) {
        let (Course::Heading(steered) | Course::Turn(steered)) = course;
        let (Speed::MetresPerSecond(driven) | Speed::Share(driven)) = speed;
        if steered.is_finite() && driven.is_finite() {
            (self.guided, self.destination) = (Some((now, course, speed)), None);
        }
    }

    /// Steering is the axis y, throttle the axis z, from 0 to 1000 with rest at 500, or x where that is set.
    pub(super) fn take_manual(&mut self, now: SimTime, control: &MANUAL_CONTROL_DATA) {
        let throttle = 0.002 * (f64::from(control.z) - 500.0);
        self.manual = Some((now, throttle.clamp(-1.0, 1.0), (0.001 * f64::from(control.y)).clamp(-1.0, 1.0)));
    }

    /// Steering is channel 1, throttle channel 3, 1000 to 2000 µs with rest at 1500; 0 is no override.
    pub(super) fn take_channels(&mut self, now: SimTime, channels: &RC_CHANNELS_OVERRIDE_DATA) {
        let share = |us: u16| if us == 0 || us == u16::MAX { 0.0 } else { 0.002 * (f64::from(us) - 1500.0) };
        let (throttle, steering) = (share(channels.chan3_raw), share(channels.chan1_raw));
        self.manual = Some((now, throttle.clamp(-1.0, 1.0), steering.clamp(-1.0, 1.0)));
    }

    pub(super) fn manual(&self, now: SimTime) -> Order {
        match self.manual {
            Some((at, throttle, steering)) if (now - at).as_s() <= HELD_S => {
                autopilot::thrust(100.0 * throttle, 100.0 * steering)
            }
            _ => Order::Hold,
        }
    }

    pub(super) fn guided(&self, now: SimTime, cruise_m_s: f64, psi_rad: f64) -> Order {
        let Some((_, course, speed)) = self.guided.filter(|(at, ..)| (now - *at).as_s() <= HELD_S) else {
            return Order::Hold;
        };
        let speed_m_s = match speed {
            Speed::MetresPerSecond(speed_m_s) => speed_m_s,
            Speed::Share(share) => share * cruise_m_s,
        };
        match course {
            Course::Heading(heading_rad) if speed_m_s < 0.0 => {
                autopilot::astern(speed_m_s, wrap_pi(heading_rad - psi_rad))
            }
            Course::Turn(rate_rad_s) if speed_m_s < 0.0 => autopilot::astern(speed_m_s, rate_rad_s * TURN_LEAD_S),
            Course::Heading(heading_rad) => autopilot::steer(Some(heading_rad), Some(speed_m_s)),
            // A set-point of zero is what our gateway stops a boat with: it must rest and not
            // hold a heading.
            Course::Turn(0.0) if speed_m_s == 0.0 => Order::Hold,
            Course::Turn(rate_rad_s) => {
                let by_rad = (rate_rad_s * TURN_LEAD_S).clamp(-PI, PI);
                Order::Turn { by_rad, speed_m_s: speed_m_s.min(SPEED_MAX_M_S) }
            }
        }
    }
}
