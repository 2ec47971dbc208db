//! Messages from the server to pages, as defined in `PROTOCOL.md`.

use super::rose::Helm;
use super::view::Access;
use messages::external::GatewayStatus;
use messages::picture::OwnBoat;
use messages::run_state::RecordingState;
use primitives::SimTime;
use scenario::outcome::EventOutcome;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Curves over time of a recorded game. Unknown values are null.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Curves<'a> {
    pub(super) vehicle: Option<&'a str>,
    /// Times of the samples.
    pub(super) t_s: Vec<f64>,
    /// Points by team and sample.
    pub(super) score: Vec<Vec<u32>>,
    pub(super) boat: Option<BoatCurves>,
}

/// A boat's curves, by sample.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct BoatCurves {
    /// East and north of the datum.
    pub(super) x_m: Vec<f64>,
    pub(super) y_m: Vec<f64>,
    pub(super) speed_m_s: Vec<f64>,
    pub(super) ordered_speed_m_s: Vec<f64>,
    pub(super) heading_deg: Vec<f64>,
    pub(super) ordered_heading_deg: Vec<f64>,
    /// Course over the ground.
    pub(super) course_deg: Vec<f64>,
    pub(super) sway_m_s: Vec<f64>,
    pub(super) yaw_rate_deg_s: Vec<f64>,
    pub(super) port_newton: Vec<f64>,
    pub(super) starboard_newton: Vec<f64>,
    /// Distance to the nearest flag of the other team, wherever that flag is.
    pub(super) flag_m: Vec<f64>,
    /// Error of its own position estimate.
    pub(super) error_m: Vec<f64>,
}

/// The version of the protocol.
pub(super) const PROTOCOL: u32 = 1;

#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(super) enum PageMessage<'a> {
    Hello {
        protocol: u32,
        version: &'a str,
        mode: Mode,
        rights: bool,
        operates: bool,
        game: &'a str,
        about: Option<&'a str>,
        definitions: BTreeMap<&'static str, &'static str>,
        chart: &'a Value,
    },
    State {
        phase: &'a str,
        now_s: f64,
        pace: &'a str,
        speed: Option<f64>,
        rate: f64,
        minds: &'a [String],
        gateways: &'a [String],
        refused: u64,
        overruns: u64,
        recording: Option<&'a RecordingState>,
        frames_hz: f64,
        can_speed: bool,
    },
    Player {
        playing: bool,
        t_s: f64,
        speed: f64,
        from_s: f64,
        to_s: f64,
        cut: bool,
        file: &'a str,
    },
    Events {
        reset: bool,
        events: Vec<EventMessage<'a>>,
    },
    Helm {
        vehicle: &'a str,
        report: Option<&'a Helm>,
        reason: Option<&'a str>,
        computed: bool,
        agrees: Option<bool>,
    },
    Modes {
        at_s: f64,
        modes: &'a [Option<String>],
    },
    Curves(&'a Curves<'a>),
    WhatIf {
        done: u32,
        total: u32,
        result: Option<&'a Value>,
        failed: Option<&'a str>,
    },
    Estimate {
        vehicle: &'a str,
        x: f64,
        y: f64,
        heading_deg: f64,
        speed_m_s: f64,
        fix_age_s: f64,
        at_s: f64,
    },
    Status {
        vehicle: &'a str,
        status: &'a GatewayStatus,
    },
    Drive {
        vehicle: &'a str,
        by: Option<&'static str>,
    },
    Operated {
        vehicle: &'a str,
        command: &'a str,
        refused: Option<&'a str>,
    },
    Preparing {
        text: &'a str,
        failed: bool,
    },
    Refused {
        what: &'a str,
        reason: &'a str,
    },
}

/// The type of content that a page shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// A game in progress, where actions affect all pages.
    Live,
    /// A recording, with a separate playback for each page.
    Replay,
}

/// An event with a sentence that describes it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct EventMessage<'a> {
    #[serde(flatten)]
    event: &'a EventOutcome,
    text: String,
}

impl<'a> EventMessage<'a> {
    /// Converts an event.
    pub(super) fn new(event: &'a EventOutcome) -> EventMessage<'a> {
        let text = match (event.event.as_str(), &event.vehicle) {
            ("failsafe", Some(vehicle)) => format!("{vehicle} is in failsafe"),
            _ => event.sentence(),
        };
        EventMessage { event, text }
    }
}

/// A time in seconds, rounded: 120 instead of 120.00000000000001, which multiplication by 1e-9
/// would yield.
pub(super) fn seconds(time: SimTime) -> f64 {
    time.0 as f64 / 1e9
}

impl PageMessage<'_> {
    /// The first message to a page: the game and, optionally, a sentence about its origin.
    pub(super) fn hello<'a>(
        version: &'a str,
        mode: Mode,
        access: Access,
        (game, about): (&'a str, Option<&'a str>),
        chart: &'a Value,
    ) -> PageMessage<'a> {
        let definitions = messages::ros::DEFINITIONS.into_iter().collect();
        let rights = access >= Access::Control;
        let operates = access >= Access::Operate;
        PageMessage::Hello {
            protocol: PROTOCOL,
            version,
            mode,
            rights,
            operates,
            game,
            about,
            definitions,
            chart,
        }
    }

    /// A boat's estimated position.
    pub(super) fn estimate<'a>(vehicle: &'a str, boat: &OwnBoat, at: SimTime) -> PageMessage<'a> {
        let nav = &boat.nav;
        PageMessage::Estimate {
            vehicle,
            x: nav.east_m,
            y: nav.north_m,
            heading_deg: nav.psi_rad.to_degrees().rem_euclid(360.0),
            speed_m_s: nav.speed_m_s(),
            fix_age_s: seconds(SimTime(at.0.saturating_sub(boat.fix_ns.0))),
            at_s: seconds(at),
        }
    }

    pub(super) fn json(&self) -> String {
        serde_json::to_string(self).expect("a plain struct is JSON")
    }
}

#[cfg(test)]
mod tests {
    use super::{EventMessage, PageMessage};
    use scenario::outcome::EventOutcome;
    use serde_json::{Value, json};

    fn value(tell: &PageMessage<'_>) -> Value {
        serde_json::from_str(&tell.json()).expect("the message is JSON")
    }

    #[test]
    fn events_carry_a_sentence() {
        let event = |event: &str| EventOutcome {
            tick: 7,
            at_s: 0.35,
            event: event.into(),
            vehicle: Some("a".into()),
            other: Some("b".into()),
            team: None,
        };
        let tagged = event("tagged");
        let failsafe = event("failsafe");
        let tell = PageMessage::Events {
            reset: true,
            events: vec![EventMessage::new(&tagged), EventMessage::new(&failsafe)],
        };
        let want = json!({"tick": 7, "at_s": 0.35, "event": "tagged", "vehicle": "a", "other": "b",
            "text": "a is tagged by b"});
        assert_eq!(value(&tell)["kind"], "events");
        assert_eq!(value(&tell)["events"][0], want);
        assert_eq!(value(&tell)["events"][1]["text"], "a is in failsafe");
    }

    #[test]
    fn what_is_not_known_is_null_and_not_left_out() {
        let tell = value(&PageMessage::Drive {
            vehicle: "a",
            by: None,
        });
        assert_eq!(tell, json!({"kind": "drive", "vehicle": "a", "by": null}));
        let tell = value(&PageMessage::Helm {
            vehicle: "a",
            report: None,
            reason: Some("x"),
            computed: true,
            agrees: None,
        });
        assert_eq!(tell["report"], Value::Null);
        assert_eq!(tell["agrees"], Value::Null);
    }
}
