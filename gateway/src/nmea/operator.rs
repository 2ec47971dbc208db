//! The operator that commands a boat.

use serde::{Deserialize, Serialize};

/// The operator that commands a boat, by its number on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Operator {
    /// 1: the operator station on shore.
    Primary,
    /// 2: the back seat, which is the gateway.
    Secondary,
    /// 3: the operator station through its second link.
    PrimaryBackup,
    /// 5: a handheld remote control.
    Rc,
    /// 6: the boat's own obstacle avoidance.
    ObstacleAvoidance,
    /// Any other number.
    Other(u8),
}

impl Operator {
    /// The number on the wire.
    pub fn number(self) -> u8 {
        match self {
            Operator::Primary => 1,
            Operator::Secondary => 2,
            Operator::PrimaryBackup => 3,
            Operator::Rc => 5,
            Operator::ObstacleAvoidance => 6,
            Operator::Other(number) => number,
        }
    }

    /// The operator with a number.
    pub fn from_number(number: u8) -> Operator {
        match number {
            1 => Operator::Primary,
            2 => Operator::Secondary,
            3 => Operator::PrimaryBackup,
            5 => Operator::Rc,
            6 => Operator::ObstacleAvoidance,
            other => Operator::Other(other),
        }
    }
}
