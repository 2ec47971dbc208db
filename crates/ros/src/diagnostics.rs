//! `diagnostic_msgs/DiagnosticArray`: the status of the bridge itself, and of the gateways of real
//! and emulated boats.

use crate::message::{DiagnosticArray, DiagnosticStatus, Header};
use messages::external::GatewayStatus;
use messages::refusal::Refusals;
use primitives::SimTime;
use std::time::Duration;

// Levels, as in `diagnostic_msgs/DiagnosticStatus`.
const OK: u8 = 0;
const WARN: u8 = 1;
const ERROR: u8 = 2;
const STALE: u8 = 3;

/// Silence after which a gateway counts as stale. Gateways report once a second.
const SILENCE: Duration = Duration::from_secs(3);

/// The bridge's own status.
pub fn bridge(game: &str, boats: &[String], refused: Refusals) -> DiagnosticStatus {
    let (level, message) = match refused.total() {
        0 => (OK, format!("in game {game}")),
        _ => (WARN, format!("refused messages: {refused}")),
    };
    let values = vec![
        ("game".to_owned(), game.to_owned()),
        ("drives".to_owned(), boats.join(", ")),
    ];
    DiagnosticStatus {
        level,
        name: "squall: ROS 2 bridge".to_owned(),
        message,
        values,
        ..DiagnosticStatus::default()
    }
}

/// The status of a boat's gateway; `age` is the time since it was received.
pub fn gateway(status: &GatewayStatus, age: Duration) -> DiagnosticStatus {
    let newest = status
        .failsafes
        .last()
        .map(|failsafe| failsafe.cause.as_str())
        .unwrap_or_default();
    let (level, message) = if age > SILENCE {
        (STALE, format!("no status for {:.0} s", age.as_secs_f64()))
    } else if status.link != "up" {
        (ERROR, format!("link: {}", status.link))
    } else if status.state.starts_with("failsafe") {
        (ERROR, format!("failsafe: {newest}"))
    } else if !status.alarms.is_empty() {
        (WARN, status.alarms.join("; "))
    } else {
        (OK, status.state.clone())
    };
    let number = |value: Option<f64>| value.map(|value| format!("{value:.2}")).unwrap_or_default();
    let mut values = vec![
        ("state".to_owned(), status.state.clone()),
        ("link".to_owned(), status.link.clone()),
        ("missing for arming".to_owned(), status.missing.join("; ")),
        ("alarms".to_owned(), status.alarms.join("; ")),
        ("last failsafe".to_owned(), newest.to_owned()),
        ("age of the fix, s".to_owned(), number(status.nav_age_s)),
        ("battery, V".to_owned(), number(status.battery_v)),
        (
            "clearance to the geofence, m".to_owned(),
            number(status.geofence.as_ref().and_then(|f| f.clearance_m)),
        ),
        ("last sentence".to_owned(), status.last_sent.clone()),
    ];
    values.extend(
        status
            .counts
            .iter()
            .map(|(name, count)| (name.clone(), count.to_string())),
    );
    let name = format!("squall: gateway of {}", status.vehicle);
    DiagnosticStatus {
        level,
        name,
        message,
        hardware_id: status.vehicle.clone(),
        values,
    }
}

/// A message with these statuses, stamped with the game time.
pub fn array(at: SimTime, status: Vec<DiagnosticStatus>) -> DiagnosticArray {
    DiagnosticArray {
        header: Header {
            stamp: at.into(),
            frame_id: String::new(),
        },
        status,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::external::FailsafeReport;
    use messages::refusal::Refusal;

    #[test]
    fn the_worst_condition_sets_the_level() {
        let good = GatewayStatus {
            vehicle: "b".into(),
            link: "up".into(),
            state: "armed".into(),
            ..Default::default()
        };
        let failsafes = vec![FailsafeReport {
            at_s: 1.0,
            cause: "leak".into(),
        }];
        let failed = GatewayStatus {
            state: "failsafe".into(),
            failsafes,
            ..good.clone()
        };
        let alarmed = GatewayStatus {
            alarms: vec!["leak".into()],
            ..good.clone()
        };
        let cut = GatewayStatus {
            link: "unplugged".into(),
            ..alarmed.clone()
        };
        for (status, age_s, level, message) in [
            (&good, 0, OK, "armed"),
            (&alarmed, 0, WARN, "leak"),
            (&failed, 0, ERROR, "failsafe: leak"),
            (&cut, 0, ERROR, "link: unplugged"),
            (&good, 4, STALE, "no status for 4 s"),
        ] {
            let got = gateway(status, Duration::from_secs(age_s));
            assert_eq!(
                (got.level, got.message.as_str(), got.hardware_id.as_str()),
                (level, message, "b")
            );
        }
    }

    #[test]
    fn refused_messages_are_a_warning() {
        assert_eq!(bridge("pond", &[], Refusals::default()).level, OK);
        let warned = bridge(
            "pond",
            &["b".to_owned()],
            Refusals::from([(Refusal::Garbage, 2)]),
        );
        assert_eq!(
            (warned.level, warned.message.as_str()),
            (WARN, "refused messages: 2 x malformed")
        );
    }
}
