//! The picture of a team: its own boats, its contacts, the flags, the score.
//!
//! An agent bases its decisions on the picture alone, which is the same at sea and in simulation.

use primitives::frame::{Body, Ned, Pose, ned_from_body};
use primitives::id::{FlagId, TeamId, VehicleId};
use primitives::math;
use primitives::stamp::{Message, Stamp};
use primitives::time::SimTime;
use rules::Ability;
use rules::event::EventRecord;
use serde::{Deserialize, Serialize};

/// The knowledge of one team at one decision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Time and decision that orders must answer.
    pub stamp: Stamp,
    /// Index of the team.
    pub team: u8,
    /// The team's own boats, by ascending vehicle index.
    pub own: Vec<OwnBoat>,
    /// The other boats as the team knows them, by ascending vehicle index.
    pub contacts: Vec<Contact>,
    /// Flags, by flag index.
    pub flags: Vec<FlagView>,
    /// Points, by team.
    pub score: Vec<u32>,
    /// Events since the previous picture that involve the team's boats or flag, and the end of the
    /// game.
    pub events: Vec<EventRecord>,
    /// Whether the game is over.
    pub over: bool,
}

/// A boat's own navigation: its position and motion over the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Nav {
    /// North of the datum, m.
    pub north_m: f64,
    /// East of the datum, m.
    pub east_m: f64,
    /// Heading, rad clockwise from north.
    pub psi_rad: f64,
    /// Velocity ahead over the ground, m/s.
    pub surge_m_s: f64,
    /// Velocity to starboard over the ground, m/s.
    pub sway_m_s: f64,
    /// Yaw rate, rad/s clockwise.
    pub yaw_rate_rad_s: f64,
}

impl Nav {
    /// The position.
    pub fn at(&self) -> Ned {
        Ned {
            north: self.north_m,
            east: self.east_m,
        }
    }

    /// Position and heading.
    pub fn pose(&self) -> Pose {
        Pose {
            at: self.at(),
            psi_rad: self.psi_rad,
        }
    }

    /// Speed over the ground, m/s.
    pub fn speed_m_s(&self) -> f64 {
        math::length(self.surge_m_s, self.sway_m_s)
    }

    /// Velocity over the ground, m/s.
    pub fn velocity_m_s(&self) -> Ned {
        ned_from_body(
            self.pose().rotation(),
            Body {
                ahead: self.surge_m_s,
                starboard: self.sway_m_s,
            },
        )
    }
}

/// Gyro and accelerometers, along the boat's axes: ahead, to starboard, down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Imu {
    /// Rotation rate about the forward axis, rad/s.
    pub roll_rate_rad_s: f64,
    /// Rotation rate about the starboard axis, rad/s.
    pub pitch_rate_rad_s: f64,
    /// Rotation rate about the downward axis, rad/s.
    pub yaw_rate_rad_s: f64,
    /// Specific force ahead, m/s².
    pub ahead_m_s2: f64,
    /// Specific force to starboard, m/s².
    pub starboard_m_s2: f64,
    /// Specific force down, m/s²: the negative of gravity at rest.
    pub down_m_s2: f64,
}

/// One of the team's own boats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OwnBoat {
    /// Vehicle index.
    pub vehicle: VehicleId,
    /// Navigation as measured by the boat's sensors.
    pub nav: Nav,
    /// Time of the last satellite fix used, ns.
    pub fix_ns: SimTime,
    /// Gyro and accelerometers.
    pub imu: Imu,
    /// Whether the boat is tagged.
    pub tagged: bool,
    /// The flag that the boat carries, or -1.
    pub carrying: i16,
    /// Whether the boat is out of action.
    pub disabled: bool,
    /// Whether the boat is outside the field.
    pub outside: bool,
    /// Time from which the boat may tag again, ns.
    pub tag_ready_ns: SimTime,
}

/// A boat of an opposing team, as known to this team.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Vehicle index.
    pub vehicle: VehicleId,
    /// The boat's team.
    pub team: TeamId,
    /// Time of the sighting, ns.
    pub seen_ns: SimTime,
    /// North of the datum, m.
    pub north_m: f64,
    /// East of the datum, m.
    pub east_m: f64,
    /// Heading, rad clockwise from north.
    pub psi_rad: f64,
    /// Velocity over the ground towards north, m/s.
    pub velocity_north_m_s: f64,
    /// Velocity over the ground towards east, m/s.
    pub velocity_east_m_s: f64,
    /// Whether the boat is tagged.
    pub tagged: bool,
    /// The flag that the boat carries, or -1.
    pub carrying: i16,
}

/// One flag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FlagView {
    /// The vehicle that carries the flag, or -1 if the flag is at home.
    pub carrier: i32,
}

impl Message for Picture {
    const SCHEMA: &'static str = "squall_msgs/msg/Picture";
    const VERSION: u8 = 2;
}

impl Picture {
    /// Maximum magnitude of numbers in a picture, in the units of the message. The helm's functions
    /// accept ten times as much, for sums and differences of a few such numbers.
    const NUMBER_MAX: f64 = 1e6;

    /// Removes boats with a non-finite or out-of-range number and returns their count. A mind can
    /// still use the remaining ones.
    pub fn remove_bad_numbers(&mut self) -> u64 {
        let count = |picture: &Picture| picture.own.len() + picture.contacts.len();
        let before = count(self);
        let is_sound = |numbers: &[f64]| {
            numbers
                .iter()
                .all(|number| number.abs() <= Picture::NUMBER_MAX)
        };
        self.own.retain(|OwnBoat { nav, imu, .. }| {
            let Nav {
                north_m,
                east_m,
                psi_rad,
                surge_m_s,
                sway_m_s,
                yaw_rate_rad_s,
            } = *nav;
            let Imu {
                roll_rate_rad_s,
                pitch_rate_rad_s,
                yaw_rate_rad_s: gyro_rad_s,
                ..
            } = *imu;
            is_sound(&[
                north_m,
                east_m,
                psi_rad,
                surge_m_s,
                sway_m_s,
                yaw_rate_rad_s,
            ]) && is_sound(&[roll_rate_rad_s, pitch_rate_rad_s, gyro_rad_s])
                && is_sound(&[imu.ahead_m_s2, imu.starboard_m_s2, imu.down_m_s2])
        });
        self.contacts.retain(|contact| {
            let Contact {
                north_m,
                east_m,
                psi_rad,
                velocity_north_m_s,
                velocity_east_m_s,
                ..
            } = *contact;
            is_sound(&[
                north_m,
                east_m,
                psi_rad,
                velocity_north_m_s,
                velocity_east_m_s,
            ])
        });
        (before - count(self)) as u64
    }

    /// The team's own boat `vehicle`; `None` if it belongs to a different team.
    pub fn own(&self, vehicle: VehicleId) -> Option<&OwnBoat> {
        self.own
            .binary_search_by_key(&vehicle, |boat| boat.vehicle)
            .ok()
            .map(|i| &self.own[i])
    }
}

impl OwnBoat {
    /// A boat in play; only its navigation is known.
    pub fn new(vehicle: VehicleId, nav: Nav) -> OwnBoat {
        OwnBoat {
            vehicle,
            nav,
            fix_ns: SimTime::ZERO,
            imu: Imu::default(),
            tagged: false,
            carrying: -1,
            disabled: false,
            outside: false,
            tag_ready_ns: SimTime::ZERO,
        }
    }

    /// The flag that the boat carries.
    pub fn carried_flag(&self) -> Option<FlagId> {
        u8::try_from(self.carrying).ok().map(FlagId)
    }
}

/// Encodes an optional flag as in the messages: -1 for `None`.
pub fn number_of_flag(flag: Option<FlagId>) -> i16 {
    flag.map_or(-1, |flag| i16::from(flag.0))
}

impl From<&OwnBoat> for Ability {
    fn from(boat: &OwnBoat) -> Ability {
        let OwnBoat {
            tagged,
            disabled,
            outside,
            tag_ready_ns: tag_ready,
            ..
        } = *boat;
        Ability {
            tagged,
            disabled,
            outside,
            tag_ready,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boats_with_bad_numbers_are_taken_out_and_counted_and_the_others_stay() {
        let contact = Contact {
            vehicle: VehicleId(2),
            team: TeamId(1),
            seen_ns: SimTime::ZERO,
            north_m: 1.0,
            east_m: -2.0,
            psi_rad: 3.0,
            velocity_north_m_s: 0.0,
            velocity_east_m_s: -1e6,
            tagged: false,
            carrying: -1,
        };
        let own = OwnBoat::new(VehicleId(0), Nav::default());
        let good = Picture {
            own: vec![own],
            contacts: vec![contact],
            ..Picture::default()
        };
        let mut picture = good.clone();
        assert_eq!((picture.remove_bad_numbers(), &picture), (0, &good));
        for bad in [f64::NAN, f64::INFINITY, -1.1e6] {
            let nav = Nav {
                yaw_rate_rad_s: bad,
                ..Nav::default()
            };
            let imu = Imu {
                down_m_s2: bad,
                ..Imu::default()
            };
            picture
                .own
                .extend([OwnBoat { nav, ..own }, OwnBoat { imu, ..own }]);
            picture.contacts.extend([
                Contact {
                    psi_rad: bad,
                    ..contact
                },
                Contact {
                    velocity_east_m_s: bad,
                    ..contact
                },
            ]);
        }
        assert_eq!((picture.remove_bad_numbers(), &picture), (12, &good));
    }
}
