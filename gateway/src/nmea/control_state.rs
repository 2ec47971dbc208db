//! `PSEAD`, the control state: which command the boat follows, and whose.

use super::command::whole_percents;
use super::field::Fields;
use super::{Line, Mode, ParseError};
use serde::{Deserialize, Serialize};

/// `PSEAD`.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlState {
    /// What the boat does.
    pub mode: Mode,
    /// The heading it was told, degrees magnetic.
    pub heading_deg: Option<f64>,
    /// The thrust it was told, percent; in [`Mode::Speed`] the speed in knots.
    pub thrust: Option<f64>,
    /// The thrust difference it was told, percent.
    pub difference: Option<f64>,
    /// The switch it was told last, else empty.
    pub words: String,
    /// How the command came through: a letter of T, F, R and N.
    pub transmission: Option<char>,
    /// The operator this report was sent to.
    pub sent_to: Option<u8>,
    /// Who is in control.
    pub operator: Option<Operator>,
}

/// Who commands a boat, by the number on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Operator {
    /// 1: the operator's station on shore.
    Primary,
    /// 2: the backseat, which is us.
    Secondary,
    /// 3: the operator's station by its second link.
    PrimaryBackup,
    /// 5: the remote control in somebody's hands.
    Rc,
    /// 6: the boat's own obstacle avoidance.
    ObstacleAvoidance,
    /// Any other number.
    Other(u8),
}

impl Operator {
    /// The number on the wire.
    #[must_use]
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

    /// The operator of a number.
    #[must_use]
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

impl ControlState {
    /// Reads the mode, and of the other fields as many as there are.
    pub(super) fn read(fields: &Fields) -> Result<ControlState, ParseError> {
        fields.at_least(1)?;
        Ok(ControlState {
            mode: Mode::read(fields, 1)?,
            heading_deg: fields.number(2)?,
            thrust: fields.number(3)?,
            difference: fields.number(4)?,
            words: fields.text(5).to_owned(),
            transmission: fields.text(6).chars().next(),
            sent_to: fields.whole(7)?,
            operator: fields.whole(8)?.map(Operator::from_number),
        })
    }

    pub(super) fn write(&self, mut line: Line) {
        let (thrust, difference) = whole_percents(self.thrust, self.difference);
        line.fixed(self.mode.letter().encode_utf8(&mut [0; 4]));
        line.compass(self.heading_deg, 0, 1);
        match self.mode {
            Mode::Speed => line.brief(self.thrust, 3),
            _ => line.number(thrust, 0),
        }
        line.number(difference, 0);
        line.words(&self.words);
        line.letter(self.transmission);
        line.words(&self.sent_to.map_or_else(String::new, |number| number.to_string()));
        line.words(&self.operator.map_or_else(String::new, |operator| operator.number().to_string()));
        line.end();
    }
}
