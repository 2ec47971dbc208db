//! Converts Squall's coordinates to those of REP 103: north-east-down with headings clockwise from
//! north becomes east-north-up with yaw anticlockwise from east. Body axes to starboard and down
//! become axes to port and up (`base_link`).

use crate::message::{
    Header, Imu, NavSatFix, Odometry, Pose, Quaternion, TransformStamped, Twist, TwistStamped,
    Vector3,
};
use messages::picture::{self, Nav, OwnBoat};
use messages::{Stamp, VehicleTruth};
use primitives::frame::LatLon;
use primitives::{Ned, SimTime, math};
use std::f64::consts::FRAC_PI_2;

/// The coordinate frame of the field: east, north and up from its datum.
pub const MAP: &str = "map";

/// The motion of a boat: measured or true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The time of the motion.
    pub at: SimTime,
    /// The time of the position fix.
    pub fix: SimTime,
    /// Position and motion over the ground.
    pub nav: Nav,
    /// Height above calm water, m.
    pub heave_m: f64,
    /// Roll, starboard down, rad.
    pub roll_rad: f64,
    /// Pitch, bow up, rad.
    pub pitch_rad: f64,
    /// Measurements of gyro and accelerometers; `None` for the true motion.
    pub imu: Option<picture::Imu>,
}

impl Motion {
    /// The motion that a boat has measured itself.
    pub fn measured(stamp: Stamp, boat: &OwnBoat) -> Motion {
        let (at, nav) = (stamp.valid_ns, boat.nav);
        // Boats do not measure roll and pitch: level is the best estimate.
        Motion {
            at,
            fix: boat.fix_ns,
            nav,
            heave_m: 0.0,
            roll_rad: 0.0,
            pitch_rad: 0.0,
            imu: Some(boat.imu),
        }
    }

    /// The true motion of a boat.
    pub fn truth(stamp: Stamp, boat: &VehicleTruth) -> Motion {
        let VehicleTruth {
            nav,
            heave_m,
            roll_rad,
            pitch_rad,
            ..
        } = *boat;
        Motion {
            at: stamp.valid_ns,
            fix: stamp.valid_ns,
            nav,
            heave_m,
            roll_rad,
            pitch_rad,
            imu: None,
        }
    }

    fn header(&self, frame: &str) -> Header {
        Header {
            stamp: self.at.into(),
            frame_id: frame.to_owned(),
        }
    }

    /// Position and orientation of `base_link` in [`MAP`].
    pub fn pose(&self) -> Pose {
        let [x, y, _] = enu(self.nav.at());
        // Roll keeps its sign, because the forward axis is the same in both conventions. Pitch
        // changes its sign, because its axis points to port instead of starboard.
        Pose {
            position: [x, y, self.heave_m],
            orientation: quaternion(self.roll_rad, -self.pitch_rad, FRAC_PI_2 - self.nav.psi_rad),
        }
    }

    /// `nav_msgs/Odometry`: the pose in [`MAP`] and the twist in `base_link`.
    pub fn odometry(&self, base_link: &str) -> Odometry {
        let Nav {
            surge_m_s,
            sway_m_s,
            yaw_rate_rad_s,
            ..
        } = self.nav;
        let twist = Twist {
            linear: [surge_m_s, -sway_m_s, 0.0],
            angular: [0.0, 0.0, -yaw_rate_rad_s],
        };
        let header = self.header(MAP);
        Odometry {
            header,
            child_frame_id: base_link.to_owned(),
            pose: self.pose(),
            twist,
            ..Odometry::default()
        }
    }

    /// The transform from [`MAP`] to `base_link`.
    pub fn transform(&self, base_link: &str) -> TransformStamped {
        let header = self.header(MAP);
        TransformStamped {
            header,
            child_frame_id: base_link.to_owned(),
            transform: self.pose(),
        }
    }

    /// `geometry_msgs/TwistStamped`: the velocity over the ground in [`MAP`].
    pub fn velocity(&self) -> TwistStamped {
        let angular = [0.0, 0.0, -self.nav.yaw_rate_rad_s];
        TwistStamped {
            header: self.header(MAP),
            twist: Twist {
                linear: enu(self.nav.velocity_m_s()),
                angular,
            },
        }
    }

    /// `sensor_msgs/NavSatFix` of this position, with the time of the fix.
    pub fn fix(&self, base_link: &str, LatLon { lat_deg, lon_deg }: LatLon) -> NavSatFix {
        const GPS: u16 = 1;
        let header = Header {
            stamp: self.fix.into(),
            frame_id: base_link.to_owned(),
        };
        NavSatFix {
            header,
            service: GPS,
            latitude: lat_deg,
            longitude: lon_deg,
            ..NavSatFix::default()
        }
    }

    /// `sensor_msgs/Imu` in `base_link`. A covariance that begins with -1 marks a missing part.
    pub fn imu(&self, base_link: &str) -> Imu {
        let missing = [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let orientation = self.pose().orientation;
        let imu = Imu {
            header: self.header(base_link),
            orientation,
            ..Imu::default()
        };
        let Some(measured) = self.imu else {
            let angular_velocity = [0.0, 0.0, -self.nav.yaw_rate_rad_s];
            return Imu {
                angular_velocity,
                linear_acceleration_covariance: missing,
                ..imu
            };
        };
        let flu = |ahead, starboard: f64, down: f64| [ahead, -starboard, -down];
        Imu {
            angular_velocity: flu(
                measured.roll_rate_rad_s,
                measured.pitch_rate_rad_s,
                measured.yaw_rate_rad_s,
            ),
            linear_acceleration: flu(
                measured.ahead_m_s2,
                measured.starboard_m_s2,
                measured.down_m_s2,
            ),
            ..imu
        }
    }
}

/// Converts a horizontal vector to east, north and up.
pub fn enu(vector: Ned) -> Vector3 {
    [vector.east, vector.north, 0.0]
}

/// The orientation after a roll about x, a pitch about y and a yaw about z, all about fixed axes.
pub fn quaternion(roll_rad: f64, pitch_rad: f64, yaw_rad: f64) -> Quaternion {
    let [(sr, cr), (sp, cp), (sy, cy)] =
        [roll_rad, pitch_rad, yaw_rad].map(|angle| math::sin_cos(angle / 2.0));
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A boat 3 m north and 4 m east of the datum, with a heading of 30 degrees. It moves at 2 m/s
    /// ahead and 0.5 m/s to starboard, and turns clockwise.
    fn motion() -> Motion {
        let nav = Nav {
            north_m: 3.0,
            east_m: 4.0,
            psi_rad: 30_f64.to_radians(),
            surge_m_s: 2.0,
            sway_m_s: 0.5,
            yaw_rate_rad_s: 0.1,
        };
        let (roll_rad, pitch_rad) = (5_f64.to_radians(), 10_f64.to_radians());
        let at = SimTime(12_250_000_000);
        Motion {
            at,
            fix: SimTime(12_000_000_000),
            nav,
            heave_m: 0.2,
            roll_rad,
            pitch_rad,
            imu: None,
        }
    }

    fn close(got: Vector3, want: [f64; 3]) {
        let differs = got
            .iter()
            .zip(want)
            .any(|(got, want)| (got - want).abs() > 1e-9);
        assert!(!differs, "{got:?}, expected {want:?}");
    }

    /// `vector`, turned by the quaternion.
    fn turned([qx, qy, qz, qw]: Quaternion, vector: Vector3) -> Vector3 {
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let once = cross([qx, qy, qz], vector);
        let twice = cross([qx, qy, qz], once);
        std::array::from_fn(|i| vector[i] + 2.0 * (qw * once[i] + twice[i]))
    }

    #[test]
    fn the_field_is_east_north_up() {
        let pose = motion().pose();
        close(pose.position, [4.0, 3.0, 0.2]);
        let level = Motion {
            roll_rad: 0.0,
            pitch_rad: 0.0,
            ..motion()
        }
        .pose()
        .orientation;
        // 30 degrees clockwise from north is 60 degrees anticlockwise from east.
        close(turned(level, [1.0, 0.0, 0.0]), [0.5, 0.75_f64.sqrt(), 0.0]);
        close(
            turned(level, [0.0, 1.0, 0.0]),
            [-(0.75_f64.sqrt()), 0.5, 0.0],
        );
    }

    #[test]
    fn the_bow_rises_and_the_starboard_side_sinks_as_at_sea() {
        let orientation = motion().pose().orientation;
        let bow = turned(orientation, [1.0, 0.0, 0.0]);
        let sine_of_10_deg = 0.173_648_177_666_930_33;
        assert!((bow[2] - sine_of_10_deg).abs() < 1e-9, "{bow:?}");
        let port = turned(orientation, [0.0, 1.0, 0.0]);
        assert!(port[2] > 0.08, "starboard is down: {port:?}");
    }

    #[test]
    fn the_body_is_forward_port_up() {
        let odometry = motion().odometry("b/base_link");
        close(odometry.twist.linear, [2.0, -0.5, 0.0]);
        close(odometry.twist.angular, [0.0, 0.0, -0.1]);
        let (frames, stamp) = (
            (odometry.header.frame_id, odometry.child_frame_id),
            odometry.header.stamp,
        );
        assert_eq!(frames, ("map".to_owned(), "b/base_link".to_owned()));
        assert_eq!((stamp.sec, stamp.nanosec), (12, 250_000_000));
        // Ahead is (cos 30, sin 30) in north and east, starboard (-sin 30, cos 30).
        let (north, east) = (2.0 * 0.75_f64.sqrt() - 0.25, 1.0 + 0.5 * 0.75_f64.sqrt());
        let velocity = motion().velocity().twist;
        close(velocity.linear, [east, north, 0.0]);
        // A clockwise turn, to starboard, is negative about an axis that points up.
        close(velocity.angular, [0.0, 0.0, -0.1]);
        close(motion().imu("b").angular_velocity, [0.0, 0.0, -0.1]);
    }

    #[test]
    fn a_boat_at_rest_feels_gravity_upwards() {
        let imu = picture::Imu {
            down_m_s2: -9.81,
            starboard_m_s2: 0.3,
            pitch_rate_rad_s: 0.2,
            yaw_rate_rad_s: 0.1,
            ..picture::Imu::default()
        };
        let imu = Motion {
            imu: Some(imu),
            ..motion()
        }
        .imu("b/base_link");
        close(imu.linear_acceleration, [0.0, -0.3, 9.81]);
        close(imu.angular_velocity, [0.0, -0.2, -0.1]);
        assert_eq!(
            motion().imu("b").linear_acceleration_covariance[0],
            -1.0,
            "the truth has no accelerometer"
        );
    }

    #[test]
    fn a_fix_has_the_time_of_the_fix() {
        let at = LatLon {
            lat_deg: 42.0,
            lon_deg: -71.0,
        };
        let fix = motion().fix("b/base_link", at);
        assert_eq!(
            (fix.latitude, fix.longitude, fix.header.stamp.sec),
            (42.0, -71.0, 12)
        );
    }
}
