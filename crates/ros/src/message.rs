//! ROS 2 messages that the bridge sends and receives. The fields, their order and their units are
//! those of the `.msg` files in ROS 2 Jazzy.

#![expect(
    missing_docs,
    reason = "the fields are those of the standard definitions, which document them"
)]

use messages::{Frame, Message, Picture, VehicleOrder};
use primitives::SimTime;
use serde::{Deserialize, Serialize};

/// A message with a ROS 2 type.
pub trait RosMessage {
    /// The full name of the type, for example `std_msgs/msg/Header`.
    const TYPE: &'static str;
}

/// The covariance of a pose or a twist. All zeros mean unknown.
pub type Covariance = [[f64; 6]; 6];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

impl From<SimTime> for Time {
    fn from(at: SimTime) -> Time {
        const SECOND: i64 = 1_000_000_000;
        let sec = i32::try_from(at.0.div_euclid(SECOND)).unwrap_or(i32::MAX);
        Time {
            sec,
            nanosec: u32::try_from(at.0.rem_euclid(SECOND)).unwrap_or(0),
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

/// A vector or point: x, y and z.
pub type Vector3 = [f64; 3];
/// An orientation: x, y, z and w.
pub type Quaternion = [f64; 4];

/// A pose, or a transform: both have this layout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Pose {
    pub position: Vector3,
    pub orientation: Quaternion,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    pub linear: Vector3,
    pub angular: Vector3,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Clock {
    pub clock: Time,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Odometry {
    pub header: Header,
    pub child_frame_id: String,
    pub pose: Pose,
    pub pose_covariance: Covariance,
    pub twist: Twist,
    pub twist_covariance: Covariance,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NavSatFix {
    pub header: Header,
    pub status: i8,
    pub service: u16,
    pub latitude: f64,
    pub longitude: f64,
    pub altitude: f64,
    pub position_covariance: [f64; 9],
    pub position_covariance_type: u8,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Imu {
    pub header: Header,
    pub orientation: Quaternion,
    pub orientation_covariance: [f64; 9],
    pub angular_velocity: Vector3,
    pub angular_velocity_covariance: [f64; 9],
    pub linear_acceleration: Vector3,
    pub linear_acceleration_covariance: [f64; 9],
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TwistStamped {
    pub header: Header,
    pub twist: Twist,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: String,
    pub transform: Pose,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TfMessage {
    pub transforms: Vec<TransformStamped>,
}

/// Red, green, blue and opacity, 0 to 1.
pub type Color = [f32; 4];

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Marker {
    pub header: Header,
    pub ns: String,
    pub id: i32,
    pub kind: i32,
    pub action: i32,
    pub pose: Pose,
    pub scale: Vector3,
    pub color: Color,
    pub lifetime: Time,
    pub frame_locked: bool,
    pub points: Vec<Vector3>,
    pub colors: Vec<Color>,
    pub texture_resource: String,
    pub texture: (Header, String, Vec<u8>),
    pub uv_coordinates: Vec<[f32; 2]>,
    pub text: String,
    pub mesh_resource: String,
    pub mesh_file: (String, Vec<u8>),
    pub mesh_use_embedded_materials: bool,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MarkerArray {
    pub markers: Vec<Marker>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DiagnosticStatus {
    pub level: u8,
    pub name: String,
    pub message: String,
    pub hardware_id: String,
    /// Keys and values.
    pub values: Vec<(String, String)>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DiagnosticArray {
    pub header: Header,
    pub status: Vec<DiagnosticStatus>,
}

/// The response of `std_srvs/srv/SetBool` and `std_srvs/srv/Trigger`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Done {
    pub success: bool,
    pub message: String,
}

impl RosMessage for Clock {
    const TYPE: &'static str = "rosgraph_msgs/msg/Clock";
}
impl RosMessage for Odometry {
    const TYPE: &'static str = "nav_msgs/msg/Odometry";
}
impl RosMessage for NavSatFix {
    const TYPE: &'static str = "sensor_msgs/msg/NavSatFix";
}
impl RosMessage for Imu {
    const TYPE: &'static str = "sensor_msgs/msg/Imu";
}
impl RosMessage for Twist {
    const TYPE: &'static str = "geometry_msgs/msg/Twist";
}
impl RosMessage for TwistStamped {
    const TYPE: &'static str = "geometry_msgs/msg/TwistStamped";
}
impl RosMessage for TfMessage {
    const TYPE: &'static str = "tf2_msgs/msg/TFMessage";
}
impl RosMessage for MarkerArray {
    const TYPE: &'static str = "visualization_msgs/msg/MarkerArray";
}
impl RosMessage for DiagnosticArray {
    const TYPE: &'static str = "diagnostic_msgs/msg/DiagnosticArray";
}
impl RosMessage for Frame {
    const TYPE: &'static str = Frame::SCHEMA;
}
impl RosMessage for Picture {
    const TYPE: &'static str = Picture::SCHEMA;
}
impl RosMessage for VehicleOrder {
    const TYPE: &'static str = "squall_msgs/msg/VehicleOrder";
}
