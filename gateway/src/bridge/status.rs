//! The status of a gateway, as numbers and strings.

use super::Bridge;
use crate::nmea::Operator;
use crate::protocol::{Command, named};
use crate::supervisor::{Cause, State};
use messages::external::GatewayStatus;
use primitives::SimTime;

/// Event counters.
#[derive(Clone, Debug, Default)]
pub(super) struct Counters {
    pub(super) orders: u64,
    pub(super) bad_orders: u64,
    pub(super) old_orders: u64,
    pub(super) orders_ahead: u64,
    pub(super) sent: u64,
}

impl Bridge {
    /// The current status, with the conditions missing at the last step. This changes no state, so
    /// queries do not affect a replay. The node adds the data that only it knows: link name,
    /// control port, latencies.
    pub fn status(&self, now: SimTime) -> GatewayStatus {
        let known = self
            .on_site
            .as_ref()
            .and_then(|site| site.estimator.nav(now));
        let battery = self.battery.volts(now);
        let text = |command: &Command| self.protocol.text(*command);
        let missing = self.conditions.missing().into_iter().map(Cause::missing);
        GatewayStatus {
            vehicle: self.plan.vehicle.clone(),
            control: None,
            at_s: now.as_s(),
            link: if self.link_up { "up" } else { "down" }.to_owned(),
            state: self.state_in_words(),
            missing: self
                .plan
                .preflight
                .missing()
                .into_iter()
                .cloned()
                .chain(missing)
                .collect(),
            alarms: self.alarms.texts(),
            failsafes: self.failsafes.clone(),
            mode: self.control.mode().map(|mode| mode.letter()),
            operator: self.control.operator().map(name_of),
            nav: known.map(|(nav, _)| nav),
            geofence: self.on_site.as_ref().map(|site| site.geofence_report(now)),
            nav_age_s: known.map(|(_, age_s)| age_s),
            mode_age_s: self.control.age_s(now),
            battery_v: battery.map(|(volts, _)| volts),
            battery_pct: self.battery.left_pct(),
            battery_age_s: battery.map(|(_, age_s)| age_s),
            last_sent: self
                .last_sent
                .as_ref()
                .map(|(_, command)| text(command))
                .unwrap_or_default(),
            would_send: self
                .plan
                .dry_run
                .then(|| self.would_send.as_ref().map(text).unwrap_or_default()),
            counts: self.counts(),
            latency_us: [None; 2],
        }
    }

    /// The supervisor's state as a string.
    pub(crate) fn state_in_words(&self) -> String {
        match self.supervisor.state() {
            State::EStopped => format!(
                "e-stopped (by an E-stop of {})",
                self.supervisor.stopped_by()
            ),
            // Keep the first word of the state: the stop commands, and possibly external programs,
            // parse it.
            state if self.protocol.is_uploading() => format!("{state}, uploading a mission"),
            state => state.to_string(),
        }
    }

    /// All counters by name.
    fn counts(&self) -> Vec<(String, u64)> {
        let counters = &self.counters;
        let [received, unknown] = self.protocol.counts();
        let known = named([
            ("orders", counters.orders),
            ("bad orders", counters.bad_orders),
            ("old orders", counters.old_orders),
            ("orders ahead of the game", counters.orders_ahead),
            ("commands out", counters.sent),
        ]);
        [received, known, unknown].concat()
    }
}

fn name_of(operator: Operator) -> String {
    match operator {
        Operator::Primary => "primary (1)".to_owned(),
        Operator::Secondary => "secondary (2): us".to_owned(),
        Operator::PrimaryBackup => "primary's backup link (3)".to_owned(),
        Operator::Rc => "remote control (5)".to_owned(),
        Operator::ObstacleAvoidance => "obstacle avoidance (6)".to_owned(),
        Operator::Other(number) => number.to_string(),
    }
}
