//! Inputs of a running game. They suffice to replay the game without its agents.

use crate::order::Order;
use crate::picture::Nav;
use crate::{Message, Stamp};
use primitives::id::VehicleId;
use primitives::time::SimTime;
use scenario::Scenario;
use serde::{Deserialize, Serialize};

/// One input of a game. The order of inputs matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Input {
    /// The teams received their pictures: boats observed and reported.
    Pictured,
    /// A vehicle received an order.
    Ordered {
        /// The vehicle.
        vehicle: VehicleId,
        /// The order.
        order: Order,
        /// Time of the answered picture; [`SimTime::NEVER`] if not recorded.
        given_at: SimTime,
    },
    /// A vehicle was made to hold.
    Held(VehicleId),
    /// A vehicle's agent was lost.
    AgentLost(VehicleId),
    /// A vehicle's agent is back.
    AgentBack(VehicleId),
    /// A gateway reported its boat's navigation.
    Reported {
        /// The boat.
        vehicle: VehicleId,
        /// The boat's navigation.
        nav: Nav,
        /// Time of the fix.
        fix_at: SimTime,
        /// Whether the fix is reliable.
        valid: bool,
    },
    /// The E-stop for all boats was set or released.
    EStopped(bool),
    /// A hold of all boats was set or released.
    Halted(bool),
    /// The game advanced to the next decision.
    Played,
}

impl Input {
    /// Whether the input fits this game: the game has the vehicle, and times are within bounds.
    pub fn is_of(self, scenario: &Scenario) -> bool {
        let has = |vehicle: VehicleId| vehicle.index() < scenario.vehicles.len();
        match self {
            Input::Held(vehicle) | Input::AgentLost(vehicle) | Input::AgentBack(vehicle) => {
                has(vehicle)
            }
            Input::Ordered {
                vehicle,
                given_at: at,
                ..
            }
            | Input::Reported {
                vehicle,
                fix_at: at,
                ..
            } => has(vehicle) && (SimTime(-SimTime::NEVER.0)..=SimTime::NEVER).contains(&at),
            Input::Pictured | Input::EStopped(_) | Input::Halted(_) | Input::Played => true,
        }
    }
}

/// All inputs of a game since the previous frame, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    /// The stamp of the resulting frame.
    pub stamp: Stamp,
    /// The inputs, in order.
    pub inputs: Vec<InputRecord>,
}

impl Inputs {
    /// The last version that did not record which pictures orders answer.
    const WITHOUT_GIVEN_AT: u8 = 1;

    /// All inputs; `None` for those that are unknown or belong to a different game.
    pub fn of(&self, scenario: &Scenario) -> impl Iterator<Item = Option<Input>> {
        let is_old = self.stamp.version <= Inputs::WITHOUT_GIVEN_AT;
        self.inputs.iter().map(move |record| {
            match record.input().filter(|input| input.is_of(scenario))? {
                Input::Ordered { vehicle, order, .. } if is_old => Some(Input::Ordered {
                    vehicle,
                    order,
                    given_at: SimTime::NEVER,
                }),
                input => Some(input),
            }
        })
    }
}

/// An input as numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InputRecord {
    /// The kind: a constant of `InputRecord.msg`.
    pub kind: u8,
    /// Vehicle index, or -1.
    pub vehicle: i32,
    /// Time of a report's fix or of the picture that an order answers, ns.
    pub at_ns: SimTime,
    /// The arguments, which depend on the kind.
    pub numbers: Vec<f64>,
}

impl From<Input> for InputRecord {
    fn from(input: Input) -> InputRecord {
        let record = |kind: u8, vehicle: Option<VehicleId>, numbers: &[f64]| InputRecord {
            kind,
            vehicle: vehicle.map_or(-1, |vehicle| i32::from(vehicle.0)),
            at_ns: SimTime::ZERO,
            numbers: numbers.to_vec(),
        };
        match input {
            Input::Ordered {
                vehicle,
                order,
                given_at,
            } => {
                let record = match order {
                    Order::Hold => record(0, Some(vehicle), &[]),
                    Order::Steer {
                        heading_rad,
                        speed_m_s,
                    } => record(1, Some(vehicle), &[heading_rad, speed_m_s]),
                    Order::Thrust { port, starboard } => {
                        record(2, Some(vehicle), &[port, starboard])
                    }
                    Order::Turn { by_rad, speed_m_s } => {
                        record(14, Some(vehicle), &[by_rad, speed_m_s])
                    }
                };
                InputRecord {
                    at_ns: given_at,
                    ..record
                }
            }
            Input::Pictured => record(3, None, &[]),
            Input::Held(vehicle) => record(4, Some(vehicle), &[]),
            Input::AgentLost(vehicle) => record(5, Some(vehicle), &[]),
            Input::AgentBack(vehicle) => record(6, Some(vehicle), &[]),
            Input::Reported {
                vehicle,
                nav,
                fix_at,
                valid,
            } => {
                let numbers = [
                    nav.north_m,
                    nav.east_m,
                    nav.psi_rad,
                    nav.surge_m_s,
                    nav.sway_m_s,
                    nav.yaw_rate_rad_s,
                ];
                InputRecord {
                    at_ns: fix_at,
                    ..record(if valid { 7 } else { 8 }, Some(vehicle), &numbers)
                }
            }
            Input::EStopped(stopped) => record(if stopped { 9 } else { 10 }, None, &[]),
            Input::Halted(halted) => record(if halted { 11 } else { 12 }, None, &[]),
            Input::Played => record(13, None, &[]),
        }
    }
}

impl InputRecord {
    /// Decodes the input, if kind and numbers are known.
    pub fn input(&self) -> Option<Input> {
        let vehicle = u16::try_from(self.vehicle).ok().map(VehicleId);
        let ordered = |order| {
            Some(Input::Ordered {
                vehicle: vehicle?,
                order,
                given_at: self.at_ns,
            })
        };
        Some(match (self.kind, self.numbers.as_slice()) {
            (0, []) => ordered(Order::Hold)?,
            (1, &[heading_rad, speed_m_s]) => ordered(Order::Steer {
                heading_rad,
                speed_m_s,
            })?,
            (2, &[port, starboard]) => ordered(Order::Thrust { port, starboard })?,
            (3, []) => Input::Pictured,
            (4, []) => Input::Held(vehicle?),
            (5, []) => Input::AgentLost(vehicle?),
            (6, []) => Input::AgentBack(vehicle?),
            (
                kind @ 7..=8,
                &[
                    north_m,
                    east_m,
                    psi_rad,
                    surge_m_s,
                    sway_m_s,
                    yaw_rate_rad_s,
                ],
            ) => Input::Reported {
                vehicle: vehicle?,
                nav: Nav {
                    north_m,
                    east_m,
                    psi_rad,
                    surge_m_s,
                    sway_m_s,
                    yaw_rate_rad_s,
                },
                fix_at: self.at_ns,
                valid: kind == 7,
            },
            (kind @ 9..=10, []) => Input::EStopped(kind == 9),
            (kind @ 11..=12, []) => Input::Halted(kind == 11),
            (13, []) => Input::Played,
            (14, &[by_rad, speed_m_s]) => ordered(Order::Turn { by_rad, speed_m_s })?,
            _ => return None,
        })
    }
}

impl Message for Inputs {
    const SCHEMA: &'static str = "squall_msgs/msg/Inputs";
    const VERSION: u8 = 2;
    const OLDEST: u8 = Inputs::WITHOUT_GIVEN_AT;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_comes_back_from_its_record() {
        let vehicle = VehicleId(3);
        let nav = Nav {
            north_m: 1.0,
            east_m: 2.0,
            psi_rad: 3.0,
            surge_m_s: 4.0,
            sway_m_s: 5.0,
            yaw_rate_rad_s: 6.0,
        };
        for input in [
            Input::Pictured,
            Input::Ordered {
                vehicle,
                order: Order::Hold,
                given_at: SimTime::ZERO,
            },
            Input::Ordered {
                vehicle,
                order: Order::Steer {
                    heading_rad: 0.5,
                    speed_m_s: 2.0,
                },
                given_at: SimTime(7),
            },
            Input::Ordered {
                vehicle,
                order: Order::Thrust {
                    port: -1.0,
                    starboard: 0.25,
                },
                given_at: SimTime(7),
            },
            Input::Ordered {
                vehicle,
                order: Order::Turn {
                    by_rad: -3.0,
                    speed_m_s: 2.0,
                },
                given_at: SimTime(7),
            },
            Input::Held(vehicle),
            Input::AgentLost(vehicle),
            Input::AgentBack(vehicle),
            Input::Reported {
                vehicle,
                nav,
                fix_at: SimTime(7),
                valid: true,
            },
            Input::Reported {
                vehicle,
                nav,
                fix_at: SimTime(-7),
                valid: false,
            },
            Input::EStopped(true),
            Input::EStopped(false),
            Input::Halted(true),
            Input::Halted(false),
            Input::Played,
        ] {
            let record = InputRecord::from(input);
            assert_eq!(record.input(), Some(input), "{record:?}");
            assert_eq!(
                InputRecord {
                    numbers: vec![0.0; 9],
                    ..record
                }
                .input(),
                None,
                "{input:?}"
            );
        }
        assert_eq!(
            InputRecord {
                kind: 15,
                ..InputRecord::default()
            }
            .input(),
            None
        );
        assert_eq!(
            InputRecord {
                kind: 4,
                vehicle: -1,
                ..InputRecord::default()
            }
            .input(),
            None
        );
    }
}
