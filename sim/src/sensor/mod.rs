//! A boat's sensors: satellite navigation, compass, gyro and accelerometers.
//!
//! Start with [`SensorModel::read`]. A sensor that a boat's file omits is perfect: it reports the
//! true values bit for bit. Sensors keep their memory in their state, which is plain numbers and
//! part of the world's snapshot. Random values are looked up by the number of the fix or reading,
//! in the noises `gps/<vehicle>`, `compass/<vehicle>` and `imu/<vehicle>`.

pub mod compass;
pub mod gps;
pub mod imu;
mod truth;

pub use truth::Truth;

use compass::{CompassModel, CompassState};
use gps::{GpsModel, GpsState};
use imu::{ImuModel, ImuReading, ImuState};
use messages::picture::Nav;
use primitives::SimTime;
use primitives::frame::{Body, Rotation, body_from_ned};
use primitives::reseed::Seeds;
use scenario::fault::FaultSpan;
use scenario::sensor::Sensors;
use serde::{Deserialize, Serialize};

/// The measurements of a boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Navigation: position and velocity of the last fix, with the velocity converted to body axes
    /// by the current compass heading.
    pub nav: Nav,
    /// Time of the last fix.
    pub fix_at: SimTime,
    /// Gyro and accelerometers.
    pub imu: ImuReading,
}

/// The constants of one boat's sensors.
#[derive(Clone, Debug)]
pub struct SensorModel {
    gps: Option<GpsModel>,
    compass: Option<CompassModel>,
    imu: Option<ImuModel>,
}

/// The changing state of a boat's sensors. The default is the state before the game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SensorState {
    gps: GpsState,
    compass: CompassState,
    imu: ImuState,
}

impl SensorState {
    /// The compass error at its last reading, rad. The front seat steers off course by this angle.
    pub fn heading_error_rad(&self) -> f64 {
        self.compass.error_rad
    }
}

impl SensorModel {
    /// The sensors of the boat named `vehicle`, read every `tick`, with these faults.
    pub fn new(
        sensors: &Sensors,
        tick: SimTime,
        seeds: &Seeds,
        vehicle: &str,
        faults: &[FaultSpan],
    ) -> SensorModel {
        let compass = |compass| CompassModel::new(compass, tick, seeds, vehicle, faults);
        SensorModel {
            gps: sensors
                .gps
                .as_ref()
                .map(|gps| GpsModel::new(gps, tick, seeds, vehicle, faults)),
            compass: sensors.compass.as_ref().map(compass),
            imu: sensors
                .imu
                .as_ref()
                .map(|imu| ImuModel::new(imu, tick, seeds, vehicle)),
        }
    }

    /// The measurements at `now`. Must be called at time 0 and then every `tick` of
    /// [`SensorModel::new`], in order.
    pub fn read(&self, state: &mut SensorState, truth: &Truth, now: SimTime) -> Reading {
        let psi_rad = match &self.compass {
            None => truth.pose.psi_rad,
            Some(compass) => compass.read(&mut state.compass, truth, now),
        };
        let imu = match &self.imu {
            None => ImuReading::of(truth),
            Some(imu) => imu.read(&mut state.imu, truth, now),
        };
        let (at, velocity, fix_at) = match &self.gps {
            None => (
                truth.pose.at,
                Body {
                    ahead: truth.nu.surge,
                    starboard: truth.nu.sway,
                },
                now,
            ),
            // A receiver measures over the ground, north and east. The components in body axes
            // depend on the compass, so a compass error shows up as leeway.
            Some(gps) => {
                let fix = gps.read(&mut state.gps, truth, now);
                (
                    fix.position,
                    body_from_ned(Rotation::from_heading(psi_rad), fix.velocity_m_s),
                    fix.at,
                )
            }
        };
        // Without an inertial unit, use the true rate: an omitted sensor is perfect.
        let yaw_rate_rad_s = if self.imu.is_some() {
            imu.gyro_rad_s[2]
        } else {
            truth.nu.yaw
        };
        let nav = Nav {
            north_m: at.north,
            east_m: at.east,
            psi_rad,
            surge_m_s: velocity.ahead,
            sway_m_s: velocity.starboard,
            yaw_rate_rad_s,
        };
        Reading { nav, fix_at, imu }
    }
}
