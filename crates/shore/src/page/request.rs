//! Requests of a page to its server, as `PROTOCOL.md` defines them.

use super::view::Access;
use messages::Control;
use messages::external::OperatorCommand;
use serde::Deserialize;

/// A message from a page, as it stands in `PROTOCOL.md`.
#[derive(Clone, Debug, PartialEq, Deserialize, strum::IntoStaticStr)]
#[serde(tag = "do", rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum PageRequest {
    /// A frame is drawn.
    Ack,
    /// Whose helm and estimate are wanted.
    Select {
        /// The vehicle's name.
        vehicle: Option<String>,
        /// Whether with utilities.
        #[serde(default)]
        functions: bool,
    },
    /// Whether the mode of every boat is wanted.
    Modes {
        /// Whether.
        wanted: bool,
    },
    /// The score over time, and curves of a boat. Of a recording only.
    Curves {
        /// The vehicle's name; none is the score alone.
        vehicle: Option<String>,
        /// To which other vehicle the range is wanted.
        other: Option<String>,
    },
    /// Something for the whole game.
    Control {
        /// What.
        what: Control,
    },
    /// So many simulated seconds a second.
    Speed {
        /// None is as fast as can be.
        factor: Option<f64>,
    },
    /// On by so many decisions.
    Step {
        /// May be negative.
        by: i64,
    },
    /// To another time.
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
    /// No longer steers it.
    LetGo {
        /// The vehicle's name.
        vehicle: String,
    },
    /// Commands a real boat.
    Operate {
        /// The vehicle's name.
        vehicle: String,
        /// What it is to do.
        command: OperatorCommand,
    },
    /// Has a real boat sail a mission by itself.
    Mission {
        /// The vehicle's name.
        vehicle: String,
        /// The text of a mission file.
        lines: String,
    },
}

impl PageRequest {
    /// Its name in the protocol.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.into()
    }

    /// The access that a page needs for it in a live game.
    #[must_use]
    pub fn needs(&self) -> Access {
        match self {
            PageRequest::Ack
            | PageRequest::Select { .. }
            | PageRequest::Modes { .. }
            | PageRequest::Curves { .. }
            | PageRequest::Step { .. }
            | PageRequest::Seek { .. } => Access::Watch,
            PageRequest::Control { .. }
            | PageRequest::Speed { .. }
            | PageRequest::Drive { .. }
            | PageRequest::LetGo { .. } => Access::Control,
            // As at the gateway, a page that may stop all boats may stop one.
            PageRequest::Operate { command, .. } if !command.needs_token() => Access::Control,
            PageRequest::Operate { .. } | PageRequest::Mission { .. } => Access::Operate,
        }
    }

    /// Whether it changes a live game.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.needs() > Access::Watch
    }
}

#[cfg(test)]
mod tests {
    use super::PageRequest;

    #[test]
    fn what_the_protocol_lists_is_understood() {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/src/page/request_cases.txt");
        for line in std::fs::read_to_string(cases).expect("the cases").lines() {
            let (text, want) = line.split_once(" is ").expect("a message, and what it is");
            let ask: PageRequest = serde_json::from_str(text).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(format!("{ask:?}"), want);
            assert!(text.contains(&format!("{:?}", ask.name())), "{text}");
        }
    }
}
