//! Requests of a page to its server, as `PROTOCOL.md` defines them.

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
    /// Something for the whole game.
    Control {
        /// What.
        what: PageCommand,
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
}

/// What can be asked of a whole game.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each says it itself; `game::message::Control` says what it does")]
pub enum PageCommand {
    Pause,
    Resume,
    Step,
    Halt,
    GoOn,
    EStop,
    Release,
    Stop,
}

impl PageRequest {
    /// What it is called on the wire.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.into()
    }

    /// Whether it changes a game that others play.
    #[must_use]
    pub fn acts(&self) -> bool {
        matches!(
            self,
            PageRequest::Control { .. }
                | PageRequest::Speed { .. }
                | PageRequest::Drive { .. }
                | PageRequest::LetGo { .. }
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{PageCommand, PageRequest};

    #[test]
    fn what_the_protocol_lists_is_understood() {
        for (text, want) in [
            (r#"{"do":"ack"}"#, PageRequest::Ack),
            (
                r#"{"do":"select","vehicle":null,"functions":false}"#,
                PageRequest::Select { vehicle: None, functions: false },
            ),
            (r#"{"do":"select","vehicle":"a"}"#, PageRequest::Select { vehicle: Some("a".into()), functions: false }),
            (r#"{"do":"control","what":"e_stop"}"#, PageRequest::Control { what: PageCommand::EStop }),
            (r#"{"do":"speed","factor":null}"#, PageRequest::Speed { factor: None }),
            (r#"{"do":"speed","factor":4}"#, PageRequest::Speed { factor: Some(4.0) }),
            (r#"{"do":"step","by":-1}"#, PageRequest::Step { by: -1 }),
            (r#"{"do":"seek","t_s":1}"#, PageRequest::Seek { t_s: 1.0 }),
            (
                r#"{"do":"drive","vehicle":"a","course_deg":90,"speed_m_s":1.5}"#,
                PageRequest::Drive { vehicle: "a".into(), course_deg: 90.0, speed_m_s: 1.5 },
            ),
            (r#"{"do":"let_go","vehicle":"a"}"#, PageRequest::LetGo { vehicle: "a".into() }),
        ] {
            let ask: PageRequest = serde_json::from_str(text).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(ask, want);
            assert!(text.contains(&format!("{:?}", ask.name())), "{text}");
        }
    }
}
