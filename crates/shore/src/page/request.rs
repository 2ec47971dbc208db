//! Requests from a page to its server, as defined in `PROTOCOL.md`.

use super::view::Access;
use messages::Control;
use messages::external::OperatorCommand;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A message from a page, as defined in `PROTOCOL.md`.
#[derive(Clone, Debug, PartialEq, Deserialize, strum::IntoStaticStr)]
#[serde(tag = "do", rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum PageRequest {
    /// A frame has been drawn.
    Ack,
    /// Selects a boat for `helm` and `estimate`.
    Select {
        /// The vehicle's name.
        vehicle: Option<String>,
        /// Whether to include utilities.
        #[serde(default)]
        functions: bool,
    },
    /// Requests the modes of all boats.
    Modes {
        /// False ends the request.
        wanted: bool,
    },
    /// Requests the score over time and a boat's curves; recordings only.
    Curves {
        /// The vehicle's name. `None` means only the score.
        vehicle: Option<String>,
    },
    /// Plays futures of a recording.
    WhatIf {
        /// The question. `None` stops the futures.
        question: Option<Question>,
    },
    /// Controls the whole game.
    Control {
        /// The command.
        what: Control,
    },
    /// Sets the speed, simulated seconds per second.
    Speed {
        /// `None` means unlimited.
        factor: Option<f64>,
    },
    /// Steps by a number of decisions.
    Step {
        /// Negative values step back.
        by: i64,
    },
    /// Jumps to a different time.
    Seek {
        /// Simulated time, s.
        t_s: f64,
    },
    /// Steers a boat.
    Drive {
        /// The vehicle's name.
        vehicle: String,
        /// Compass course, degrees.
        course_deg: f64,
        /// Speed, m/s.
        speed_m_s: f64,
    },
    /// Stops steering a boat.
    LetGo {
        /// The vehicle's name.
        vehicle: String,
    },
    /// Commands a real boat.
    Operate {
        /// The vehicle's name.
        vehicle: String,
        /// The command.
        command: OperatorCommand,
    },
    /// Lets a real boat follow a mission on its own.
    Mission {
        /// The vehicle's name.
        vehicle: String,
        /// The contents of a mission file.
        lines: String,
    },
}

/// A question about futures of a recorded game.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct Question {
    /// The moment from which the futures differ from the game, simulated s.
    pub at_s: f64,
    /// How many futures to play.
    pub futures: u32,
    /// Strategies by team.
    #[serde(default)]
    pub teams: BTreeMap<String, String>,
    /// Strategies by vehicle.
    #[serde(default)]
    pub vehicles: BTreeMap<String, String>,
    /// The sea from the moment on.
    #[serde(default)]
    pub sea: Option<String>,
}

impl PageRequest {
    /// The request's name in the protocol.
    pub fn name(&self) -> &'static str {
        self.into()
    }

    /// The access that the request needs in a live game, and for futures of a recording.
    pub fn needs(&self) -> Access {
        match self {
            PageRequest::Ack
            | PageRequest::Select { .. }
            | PageRequest::Modes { .. }
            | PageRequest::Curves { .. }
            | PageRequest::Step { .. }
            | PageRequest::Seek { .. } => Access::Watch,
            PageRequest::WhatIf { .. }
            | PageRequest::Control { .. }
            | PageRequest::Speed { .. }
            | PageRequest::Drive { .. }
            | PageRequest::LetGo { .. } => Access::Control,
            // As at the gateway: a page that may stop all boats may also stop one.
            PageRequest::Operate { command, .. } if !command.needs_token() => Access::Control,
            PageRequest::Operate { .. } | PageRequest::Mission { .. } => Access::Operate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::PageRequest;

    #[test]
    fn what_the_protocol_lists_is_understood() {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/src/page/request_cases.txt");
        for line in std::fs::read_to_string(cases)
            .expect("the cases can be read")
            .lines()
        {
            let (text, want) = line.split_once(" is ").expect("a message and its meaning");
            let ask: PageRequest =
                serde_json::from_str(text).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(format!("{ask:?}"), want);
            assert!(text.contains(&format!("{:?}", ask.name())), "{text}");
        }
    }
}
