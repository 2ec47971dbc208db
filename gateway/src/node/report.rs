//! The reports of a running gateway: status, navigation and link bytes to the sim, and all of these
//! to the recording.

use super::error::NodeError;
use super::gateway_loop::GatewayLoop;
use crate::bridge::{Input, NavOut, Output};
use crate::protocol::named;
use bus::Publisher;
use messages::external::{GatewayStatus, LinkBytes, NavReport, Reported};
use messages::run_state::RecordingState;
use messages::{Message, Stamp};
use primitives::SimTime;
use recording::Entry;

/// The fault of a recording, if any.
pub(super) fn recording_fault(state: &RecordingState) -> Option<String> {
    match (&state.failed, state.dropped) {
        (Some(why), _) => Some(format!("recording to {} has stopped: {why}", state.file)),
        (None, 0) => None,
        (None, _) => Some("the recording is incomplete: the disk is too slow".to_owned()),
    }
}

impl GatewayLoop<'_> {
    /// The status of core and shell.
    pub(super) fn full_status(&self) -> GatewayStatus {
        let mut status = self.bridge.status(self.clock.now());
        status.control = self.port.map(|port| port.address.to_string());
        // The core knows whether the link is up; the shell knows why it is down.
        if status.link != "up" {
            status.link.clone_from(&self.counters.link);
        }
        status.latency_us = [
            self.counters.sentence_to_topic.summary_us(),
            self.counters.order_to_sentence.summary_us(),
        ];
        let lost = self
            .recorder
            .as_ref()
            .map_or(0, |recorder| recorder.state().dropped);
        status.counts.extend(named([
            ("nav reports", self.counters.reports),
            ("displaced writes", self.link.displaced()),
            ("calls dropped", self.input.calls.dropped()),
            ("messages not recorded", lost),
        ]));
        status.alarms.extend(self.counters.recording_fault.clone());
        status
    }

    /// Warns once if the recording ends before the gateway, or loses entries.
    pub(super) fn check_recording(&mut self) {
        let Some(fault) = self
            .recorder
            .as_ref()
            .and_then(|recorder| recording_fault(&recorder.state()))
        else {
            return;
        };
        if self.counters.recording_fault.as_ref() != Some(&fault) {
            self.warn(&fault);
            self.counters.recording_fault = Some(fault);
        }
    }

    /// Reports the status to the sim, which passes it on.
    pub(super) fn report_status(&self, status: &GatewayStatus) -> Result<(), NodeError> {
        if let (Some(ticket), Some(in_game)) = (self.counters.ticket, &self.in_game) {
            let json = serde_json::to_vec(status).expect("a status is JSON");
            in_game
                .status
                .send_raw(Reported::with_ticket(ticket, &json))?;
        }
        Ok(())
    }

    /// Publishes the bytes sent over the link, and records the whole step.
    pub(super) fn record_step(
        &mut self,
        now: SimTime,
        input: &Input,
        out: &Output,
    ) -> Result<(), NodeError> {
        let link_bytes = self.in_game.as_ref().map(|in_game| &in_game.link_bytes);
        // Encode the bytes only if there is a recorder or an observer; otherwise drop them here.
        let ticket = self
            .counters
            .ticket
            .filter(|_| link_bytes.is_some_and(Publisher::is_heard));
        if ticket.is_none() && self.recorder.is_none() {
            return Ok(());
        }
        for entry in self.encoder.step(now, self.counters.game_now, input, out) {
            if let (
                Some(ticket),
                Some(link_bytes),
                Entry::Message {
                    schema: Some(LinkBytes::SCHEMA),
                    bytes,
                    ..
                },
            ) = (ticket, link_bytes, &entry)
            {
                link_bytes.send_raw(Reported::with_ticket(ticket, bytes))?;
            }
            if let Some(recorder) = &self.recorder {
                recorder.record(entry);
            }
        }
        Ok(())
    }

    pub(super) fn report(&mut self, out: &NavOut) -> Result<(), NodeError> {
        let (Some(ticket), Some(in_game)) = (self.counters.ticket, &self.in_game) else {
            return Ok(());
        };
        self.counters.reports += 1;
        let stamp = Stamp {
            valid_ns: self.counters.game_now,
            seq: self.counters.reports,
            version: NavReport::VERSION,
        };
        let age_ns = SimTime::from_s(out.age_s).0;
        let report = NavReport {
            stamp,
            ticket,
            vehicle: in_game.vehicle,
            valid: out.valid,
            age_ns,
            nav: out.nav,
        };
        Ok(in_game.nav.send(&report)?)
    }
}
