//! One page's view of a recording.

use super::SharedReplay;
use super::playback::Playback;
use super::query_thread::{HelmRequest, Query};
use crate::page::message::{EventMessage, Mode, PageMessage, seconds};
use crate::page::request::PageRequest;
use crate::page::view::{
    Access, Budget, ESTIMATE_INTERVAL, HELM_INTERVAL, MODES_INTERVAL, Outgoing, SEND_INTERVAL,
    TRAIL_S, TRAIL_STEP_S, Viewer,
};
use messages::Control;
use messages::external::GatewayStatus;
use primitives::{SimTime, VehicleId};
use recording::Header;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The bytes of a frame that contain its decision number: after the encapsulation and the time.
const DECISION: std::ops::Range<usize> = 12..20;
/// Minimum interval between frames at any playback speed.
const FRAME_AGAIN: Duration = Duration::from_millis(10);

pub(super) struct PageViewer {
    shared: Arc<SharedReplay>,
    viewer: u64,
    playback: Playback,
    /// The first messages to the page: what it shows, and all events.
    greeting: VecDeque<String>,
    /// The playback as last sent, and when.
    sent_playback: Option<(Playback, Instant)>,
    shown: Option<usize>,
    /// Past frames to send before the next one.
    past: VecDeque<usize>,
    selected: Option<(VehicleId, bool)>,
    requested: Option<(HelmRequest, Instant)>,
    estimated: Option<(usize, Instant)>,
    /// Whether the modes of all boats are requested; the decision for which they were last
    /// requested, and when.
    wants_modes: bool,
    requested_modes: Option<(u64, Instant)>,
    /// The real boats, each with the last status sent.
    gateways: Vec<(VehicleId, Option<GatewayStatus>)>,
    /// The frame for which statuses were last read, and when.
    looked: Option<(usize, Instant)>,
    statuses: VecDeque<String>,
}

impl PageViewer {
    pub(super) fn new(shared: Arc<SharedReplay>, access: Access, viewer: u64) -> PageViewer {
        let times = &shared.source.frame_times;
        let from = times.first().copied().unwrap_or_default();
        let to = times.last().copied().unwrap_or_default();
        let Header { game, info, .. } = shared.source.recording.header();
        let gateways = info
            .scenario
            .externals()
            .map(|vehicle| (vehicle, None))
            .collect();
        let hello = PageMessage::hello(
            &info.version,
            Mode::Replay,
            access,
            (game, shared.about.as_deref()),
            &shared.chart,
        );
        let events = shared.source.events.iter().map(EventMessage::new).collect();
        PageViewer {
            viewer,
            playback: Playback::new(from, to),
            greeting: VecDeque::from([
                hello.json(),
                PageMessage::Events {
                    reset: true,
                    events,
                }
                .json(),
            ]),
            sent_playback: None,
            shown: None,
            past: VecDeque::new(),
            selected: None,
            requested: None,
            estimated: None,
            wants_modes: false,
            requested_modes: None,
            gateways,
            looked: None,
            statuses: VecDeque::new(),
            shared,
        }
    }

    /// The frame to show at a moment: the last one at or before it.
    fn frame_at(&self, moment: SimTime) -> Option<usize> {
        let times = &self.shared.source.frame_times;
        let after = times.partition_point(|time| *time <= moment);
        after
            .checked_sub(1)
            .or(if times.is_empty() { None } else { Some(0) })
    }

    fn jump(&mut self, moment: SimTime, now: Instant) {
        self.playback.seek(moment, now);
        self.shown = None;
        self.past = self
            .frame_at(self.playback.at(now))
            .map(|frame| self.trail(frame))
            .unwrap_or_default();
    }

    /// The past frames that lead to this one.
    fn trail(&self, frame: usize) -> VecDeque<usize> {
        let times = &self.shared.source.frame_times;
        let steps = (TRAIL_S / TRAIL_STEP_S) as i64;
        let moments = (1..=steps)
            .rev()
            .map(|back| times[frame] - SimTime::from_s(TRAIL_STEP_S) * back);
        let mut trail: VecDeque<usize> = moments
            .filter(|moment| *moment >= times[0])
            .filter_map(|moment| self.frame_at(moment))
            .collect();
        trail.make_contiguous().sort_unstable();
        let mut last = None;
        trail.retain(|one| *one < frame && last.replace(*one) != Some(*one));
        trail
    }

    fn step(&mut self, by: i64, now: Instant) {
        self.playback.pause(now);
        let times = &self.shared.source.frame_times;
        let Some(frame) = self.frame_at(self.playback.at(now)) else {
            return;
        };
        let to = (frame as i64)
            .saturating_add(by)
            .clamp(0, times.len() as i64 - 1) as usize;
        let one_on = to == frame + 1;
        let moment = times[to];
        if one_on {
            self.playback.seek(moment, now);
        } else {
            self.jump(moment, now);
        }
    }

    fn play(&mut self, now: Instant) {
        let before = self.playback.at(now);
        self.playback.play(now);
        if self.playback.at(now) < before {
            self.jump(self.playback.at(now), now);
        }
    }

    fn next_playback(&mut self, now: Instant) -> Option<Outgoing> {
        self.playback.end(now);
        let is_sent = |(sent, at): &(Playback, Instant)| {
            let recently = now.saturating_duration_since(*at) < SEND_INTERVAL;
            *sent == self.playback && (recently || !self.playback.is_playing())
        };
        if self.sent_playback.as_ref().is_some_and(is_sent) {
            return None;
        }
        self.sent_playback = Some((self.playback.clone(), now));
        let source = &self.shared.source;
        let times = &self.shared.source.frame_times;
        let tell = PageMessage::Player {
            playing: self.playback.is_playing(),
            t_s: seconds(self.playback.at(now)),
            speed: self.playback.speed,
            from_s: times.first().map_or(0.0, |time| seconds(*time)),
            to_s: times.last().map_or(0.0, |time| seconds(*time)),
            cut: source.recording.is_cut(),
            file: &source.file,
        };
        Some(Outgoing::Text(tell.json()))
    }

    fn next_helm(&mut self, frame: usize, now: Instant) -> Option<Outgoing> {
        let (vehicle, functions) = self.selected?;
        let request = HelmRequest {
            vehicle,
            decision: self.decision(frame)?,
            functions,
        };
        let is_due = self.requested.is_none_or(|(before, at)| {
            let chosen_anew = (before.vehicle, before.functions) != (vehicle, functions);
            before != request && (chosen_anew || now.saturating_duration_since(at) >= HELM_INTERVAL)
        });
        if is_due {
            self.requested = Some((request, now));
            self.shared
                .queries
                .request(self.viewer, Query::Helm(request));
        }
        let (answered, text) = self.shared.queries.take_helm(self.viewer)?;
        (answered.vehicle == vehicle).then_some(Outgoing::Text(text))
    }

    /// The next message with all boats' modes, or with curves.
    fn next_other(&mut self, frame: usize, now: Instant) -> Option<Outgoing> {
        let is_due = |(before, at): (u64, Instant), decision| {
            before != decision && now.saturating_duration_since(at) >= MODES_INTERVAL
        };
        if let Some(decision) = self.decision(frame).filter(|_| self.wants_modes)
            && self
                .requested_modes
                .is_none_or(|requested| is_due(requested, decision))
        {
            self.requested_modes = Some((decision, now));
            let at = self.shared.source.frame_times[frame];
            self.shared
                .queries
                .request(self.viewer, Query::Modes(decision, at));
        }
        let futures = self.shared.futures.as_ref();
        self.shared
            .queries
            .take_other(self.viewer)
            .or_else(|| futures?.take(self.viewer))
            .map(Outgoing::Text)
    }

    fn request_curves(&self, vehicle: Option<&str>) -> Result<(), String> {
        let named = |name: &str| {
            self.shared
                .source
                .recording
                .scenario()
                .vehicle_named(name)
                .map_err(|e| e.to_string())
        };
        self.shared
            .queries
            .request(self.viewer, Query::Curves(vehicle.map(named).transpose()?));
        Ok(())
    }

    /// A frame's decision number.
    fn decision(&self, frame: usize) -> Option<u64> {
        let bytes = self.shared.source.frame_bytes(frame);
        Some(u64::from_le_bytes(bytes.get(DECISION)?.try_into().ok()?))
    }

    /// Whether the view has changed since this request.
    fn is_outdated(&self, request: HelmRequest) -> bool {
        let decision = self.shown.and_then(|frame| self.decision(frame));
        decision.is_some_and(|decision| decision != request.decision)
    }

    fn next_estimate(&mut self, frame: usize, now: Instant) -> Option<Outgoing> {
        let (vehicle, _) = self.selected?;
        let is_sent = |(sent, at): (usize, Instant)| {
            sent == frame || now.saturating_duration_since(at) < ESTIMATE_INTERVAL
        };
        if self.estimated.is_some_and(is_sent) {
            return None;
        }
        self.estimated = Some((frame, now));
        let boat = self.shared.source.estimate(vehicle, frame)?;
        let at = self.shared.source.frame_times[frame];
        let name = &self.shared.source.recording.scenario().vehicles[vehicle.index()].name;
        Some(Outgoing::Text(
            PageMessage::estimate(name, &boat, at).json(),
        ))
    }

    fn next_status(&mut self, frame: usize, now: Instant) -> Option<Outgoing> {
        let is_sent = |(sent, at): (usize, Instant)| {
            sent == frame || now.saturating_duration_since(at) < SEND_INTERVAL
        };
        if self.statuses.is_empty() && !self.looked.is_some_and(is_sent) {
            self.looked = Some((frame, now));
            let source = &self.shared.source;
            let at = self.shared.source.frame_times[frame];
            for (vehicle, sent) in &mut self.gateways {
                let status = source.status(*vehicle, at);
                if status == *sent {
                    continue;
                }
                if let Some(status) = &status {
                    let name = &source.recording.scenario().vehicles[vehicle.index()].name;
                    self.statuses.push_back(
                        PageMessage::Status {
                            vehicle: name,
                            status,
                        }
                        .json(),
                    );
                }
                *sent = status;
            }
        }
        self.statuses.pop_front().map(Outgoing::Text)
    }

    /// The next past frame for trails, or the current frame if not yet shown.
    fn next_frame(&mut self, now: Instant) -> Option<Outgoing> {
        let frame = self.frame_at(self.playback.at(now))?;
        if self.shown == Some(frame) {
            return None;
        }
        if let Some(past) = self.past.pop_front() {
            return Some(Outgoing::past(&self.shared.source.frame_bytes(past)));
        }
        self.shown = Some(frame);
        Some(Outgoing::now(&self.shared.source.frame_bytes(frame)))
    }
}

impl Viewer for PageViewer {
    fn mode(&self) -> Mode {
        Mode::Replay
    }

    fn ask(&mut self, ask: &PageRequest, now: Instant) -> Result<(), String> {
        match ask {
            PageRequest::Ack => {}
            PageRequest::Select { vehicle: None, .. } => self.selected = None,
            PageRequest::Select {
                vehicle: Some(name),
                functions,
            } => {
                let vehicle = self
                    .shared
                    .source
                    .recording
                    .scenario()
                    .vehicle_named(name)
                    .map_err(|e| e.to_string())?;
                let is_other = self.selected.is_none_or(|(before, _)| before != vehicle);
                self.selected = Some((vehicle, *functions));
                if is_other {
                    (self.requested, self.estimated) = (None, None);
                }
            }
            PageRequest::Modes { wanted } => {
                self.wants_modes = *wanted;
                self.requested_modes = None;
            }
            PageRequest::Curves { vehicle } => self.request_curves(vehicle.as_deref())?,
            PageRequest::WhatIf { question } => {
                let thread = self.shared.futures.as_ref();
                let thread = thread.ok_or("this game cannot be continued")?;
                thread.request(self.viewer, question.clone());
            }
            PageRequest::Control {
                what: Control::Pause,
            } => self.playback.pause(now),
            PageRequest::Control {
                what: Control::Resume,
            } => self.play(now),
            PageRequest::Control {
                what: Control::Step,
            } => self.step(1, now),
            PageRequest::Step { by } => self.step(*by, now),
            PageRequest::Seek { t_s } if t_s.is_finite() => self.jump(SimTime::from_s(*t_s), now),
            PageRequest::Speed { factor }
                if factor.is_none_or(|factor| factor.is_finite() && factor > 0.0) =>
            {
                self.playback.set_speed(*factor, now);
            }
            PageRequest::Seek { .. } => return Err("the time is not finite".to_owned()),
            PageRequest::Speed { .. } => {
                return Err("the speed is not a positive finite number".to_owned());
            }
            PageRequest::Control { .. }
            | PageRequest::Drive { .. }
            | PageRequest::LetGo { .. }
            | PageRequest::Operate { .. }
            | PageRequest::Mission { .. } => {
                return Err("a recording does not support this".to_owned());
            }
        }
        Ok(())
    }

    fn next_message(&mut self, now: Instant, budget: Budget) -> Option<Outgoing> {
        if let Some(text) = self.greeting.pop_front() {
            return Some(Outgoing::Text(text));
        }
        if let Some(said) = self.next_playback(now) {
            return Some(said);
        }
        if let Some(frame) = self.shown {
            let selected = if budget == Budget::All {
                self.next_helm(frame, now)
                    .or_else(|| self.next_estimate(frame, now))
                    .or_else(|| self.next_other(frame, now))
            } else {
                None
            };
            if let Some(said) = selected.or_else(|| self.next_status(frame, now)) {
                return Some(said);
            }
        }
        if budget >= Budget::Frames {
            self.next_frame(now)
        } else {
            None
        }
    }

    fn due(&self, now: Instant) -> Option<Instant> {
        let playing = self.playback.is_playing();
        let times = &self.shared.source.frame_times;
        let next = self
            .shown
            .and_then(|frame| times.get(frame + 1))
            .and_then(|time| self.playback.when(*time));
        let sent = self
            .sent_playback
            .as_ref()
            .filter(|_| playing)
            .map(|(_, at)| *at + SEND_INTERVAL);
        // Messages delayed because one of the same kind was sent shortly before.
        let is_old = |frame: usize| self.shown.is_some_and(|shown| shown != frame);
        let selected = self.selected.is_some();
        let estimate = self
            .estimated
            .filter(|(frame, _)| selected && is_old(*frame))
            .map(|(_, at)| at + ESTIMATE_INTERVAL);
        let helm = self
            .requested
            .filter(|(request, _)| selected && self.is_outdated(*request))
            .map(|(_, at)| at + HELM_INTERVAL);
        let status = self
            .looked
            .filter(|(frame, _)| is_old(*frame))
            .map(|(_, at)| at + SEND_INTERVAL);
        let is_old_mode =
            |decision| self.shown.and_then(|frame| self.decision(frame)) != Some(decision);
        let modes = self
            .requested_modes
            .filter(|(decision, _)| self.wants_modes && is_old_mode(*decision));
        let modes = modes.map(|(_, at)| at + MODES_INTERVAL);
        let due = [next, sent, estimate, helm, status, modes]
            .into_iter()
            .flatten()
            .min();
        due.map(|due| due.max(now + FRAME_AGAIN))
    }
}

impl Drop for PageViewer {
    fn drop(&mut self) {
        self.shared.queries.remove(self.viewer);
        if let Some(futures) = &self.shared.futures {
            futures.request(self.viewer, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::{Frame, Message};

    #[test]
    fn the_number_of_a_frame_stands_where_it_is_looked_for() {
        let mut frame = Frame::default();
        (frame.stamp.seq, frame.stamp.version) = (0x0102_0304_0506, Frame::VERSION);
        let bytes = primitives::codec::encode(&frame);
        assert_eq!(bytes[DECISION], 0x0102_0304_0506_u64.to_le_bytes());
    }
}
