//! One page's look at a recording.

use super::Reel;
use super::helm_thread::HelmRequest;
use super::player::Player;
use crate::page::ask::{Ask, Word};
use crate::page::show::{ESTIMATE_AGAIN, Guest, HELM_AGAIN, Room, Said, TELL_AGAIN, TRAIL_S, TRAIL_STEP_S, Viewer};
use crate::page::tell::{EventTell, Mode, Tell, seconds};
use game::external::GatewayStatus;
use game::scenario::Source;
use game::{SimTime, VehicleId};
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Where in a frame the number of its decision stands: after the encapsulation and the time.
const DECISION: std::ops::Range<usize> = 12..20;
/// A page is not told of frames more often than this, however fast it plays.
const FRAME_AGAIN: Duration = Duration::from_millis(10);

/// One page's look at a recording.
pub(super) struct PageViewer {
    reel: Arc<Reel>,
    guest: Guest,
    reader: u64,
    player: Player,
    greeted: bool,
    /// Whether the page was given all events.
    told_events: bool,
    /// The player as it was told last, and when.
    told_player: Option<(Player, Instant)>,
    /// The frame that was shown last.
    shown: Option<usize>,
    /// The frames of the past to be given before the next.
    past: VecDeque<usize>,
    selected: Option<(VehicleId, bool)>,
    wished: Option<(HelmRequest, Instant)>,
    estimated: Option<(usize, Instant)>,
    /// The real boats, with what was told of each.
    gateways: Vec<(VehicleId, Option<GatewayStatus>)>,
    /// For which frame they were looked at last, and when.
    looked: Option<(usize, Instant)>,
    /// What of that is still to be told.
    statuses: VecDeque<String>,
}

impl PageViewer {
    pub(super) fn new(reel: Arc<Reel>, guest: Guest, reader: u64) -> PageViewer {
        let times = reel.film.frame_times();
        let (from, to) = (times.first().copied().unwrap_or_default(), times.last().copied().unwrap_or_default());
        let vehicles = reel.film.notice().scenario.vehicles.iter().enumerate();
        let external = vehicles.filter(|(_, vehicle)| vehicle.source == Source::External);
        let gateways = external.map(|(i, _)| (VehicleId::at(i), None)).collect();
        PageViewer {
            reel,
            guest,
            reader,
            player: Player::new(from, to),
            greeted: false,
            told_events: false,
            told_player: None,
            shown: None,
            past: VecDeque::new(),
            selected: None,
            wished: None,
            estimated: None,
            gateways,
            looked: None,
            statuses: VecDeque::new(),
        }
    }

    /// The frame to be shown at this moment: the last one that is not of the future.
    fn frame_at(&self, moment: SimTime) -> Option<usize> {
        let times = self.reel.film.frame_times();
        let after = times.partition_point(|time| *time <= moment);
        after.checked_sub(1).or(if times.is_empty() { None } else { Some(0) })
    }

    fn jump(&mut self, moment: SimTime, now: Instant) {
        self.player.seek(moment, now);
        self.shown = None;
        self.past = self.frame_at(self.player.at(now)).map(|frame| self.trail(frame)).unwrap_or_default();
    }

    /// The frames of the past that lead to this one.
    fn trail(&self, frame: usize) -> VecDeque<usize> {
        let times = self.reel.film.frame_times();
        let steps = (TRAIL_S / TRAIL_STEP_S) as i64;
        let moments = (1..=steps).rev().map(|back| times[frame] - SimTime::from_s(TRAIL_STEP_S) * back);
        let mut trail: VecDeque<usize> =
            moments.filter(|moment| *moment >= times[0]).filter_map(|moment| self.frame_at(moment)).collect();
        trail.make_contiguous().sort_unstable();
        let mut last = None;
        trail.retain(|one| *one < frame && last.replace(*one) != Some(*one));
        trail
    }

    fn step(&mut self, by: i64, now: Instant) {
        self.player.pause(now);
        let times = self.reel.film.frame_times();
        let Some(frame) = self.frame_at(self.player.at(now)) else { return };
        let to = (frame as i64).saturating_add(by).clamp(0, times.len() as i64 - 1) as usize;
        let (one_on, moment) = (to == frame + 1, times[to]);
        if one_on {
            self.player.seek(moment, now);
        } else {
            self.jump(moment, now);
        }
    }

    fn play(&mut self, now: Instant) {
        let before = self.player.at(now);
        self.player.play(now);
        if self.player.at(now) < before {
            self.jump(self.player.at(now), now);
        }
    }

    fn say_player(&mut self, now: Instant) -> Option<Said> {
        self.player.end(now);
        let is_told = |(told, at): &(Player, Instant)| {
            let recently = now.saturating_duration_since(*at) < TELL_AGAIN;
            *told == self.player && (recently || !self.player.is_playing())
        };
        if self.told_player.as_ref().is_some_and(is_told) {
            return None;
        }
        self.told_player = Some((self.player.clone(), now));
        let (film, times) = (&self.reel.film, self.reel.film.frame_times());
        let tell = Tell::Player {
            playing: self.player.is_playing(),
            t_s: seconds(self.player.at(now)),
            speed: self.player.speed(),
            from_s: times.first().map_or(0.0, |time| seconds(*time)),
            to_s: times.last().map_or(0.0, |time| seconds(*time)),
            cut: film.is_cut(),
            file: film.file(),
        };
        Some(Said::Text(tell.json()))
    }

    fn say_helm(&mut self, frame: usize, now: Instant) -> Option<Said> {
        let (vehicle, functions) = self.selected?;
        let wish = HelmRequest { vehicle, decision: self.decision(frame)?, functions };
        let is_due = self.wished.is_none_or(|(before, at)| {
            let chosen_anew = (before.vehicle, before.functions) != (vehicle, functions);
            before != wish && (chosen_anew || now.saturating_duration_since(at) >= HELM_AGAIN)
        });
        if is_due {
            self.wished = Some((wish, now));
            self.reel.desk.wish(self.reader, wish);
        }
        let (answered, text) = self.reel.desk.take(self.reader)?;
        (answered.vehicle == vehicle).then_some(Said::Text(text))
    }

    /// The decision that a frame is of.
    fn decision(&self, frame: usize) -> Option<u64> {
        let bytes = self.reel.film.frame_bytes(frame).get(DECISION)?;
        Some(u64::from_le_bytes(bytes.try_into().ok()?))
    }

    /// Whether something else is shown than what was wished for last.
    fn is_outdated(&self, wish: HelmRequest) -> bool {
        let decision = self.shown.and_then(|frame| self.decision(frame));
        decision.is_some_and(|decision| decision != wish.decision)
    }

    fn say_estimate(&mut self, frame: usize, now: Instant) -> Option<Said> {
        let (vehicle, _) = self.selected?;
        let is_told =
            |(told, at): (usize, Instant)| told == frame || now.saturating_duration_since(at) < ESTIMATE_AGAIN;
        if self.estimated.is_some_and(is_told) {
            return None;
        }
        self.estimated = Some((frame, now));
        let boat = self.reel.film.estimate(vehicle, frame)?;
        let at = self.reel.film.frame_times()[frame];
        let name = &self.reel.film.notice().scenario.vehicles[vehicle.index()].name;
        Some(Said::Text(Tell::estimate(name, &boat, at).json()))
    }

    fn say_status(&mut self, frame: usize, now: Instant) -> Option<Said> {
        let is_told = |(told, at): (usize, Instant)| told == frame || now.saturating_duration_since(at) < TELL_AGAIN;
        if self.statuses.is_empty() && !self.looked.is_some_and(is_told) {
            self.looked = Some((frame, now));
            let (film, at) = (&self.reel.film, self.reel.film.frame_times()[frame]);
            for (vehicle, told) in &mut self.gateways {
                let status = film.status(*vehicle, at);
                if status == *told {
                    continue;
                }
                if let Some(status) = &status {
                    let name = &film.notice().scenario.vehicles[vehicle.index()].name;
                    self.statuses.push_back(Tell::Status { vehicle: name, status }.json());
                }
                *told = status;
            }
        }
        self.statuses.pop_front().map(Said::Text)
    }

    /// The frame for the page's trails or for now, if it is not shown yet.
    fn say_frame(&mut self, now: Instant) -> Option<Said> {
        let frame = self.frame_at(self.player.at(now))?;
        if self.shown == Some(frame) {
            return None;
        }
        if let Some(past) = self.past.pop_front() {
            return Some(Said::past(self.reel.film.frame_bytes(past)));
        }
        self.shown = Some(frame);
        Some(Said::now(self.reel.film.frame_bytes(frame)))
    }
}

impl Viewer for PageViewer {
    fn mode(&self) -> Mode {
        Mode::Replay
    }

    fn ask(&mut self, ask: &Ask, now: Instant) -> Result<(), String> {
        match ask {
            Ask::Ack => {}
            Ask::Select { vehicle: None, .. } => self.selected = None,
            Ask::Select { vehicle: Some(name), functions } => {
                let vehicle = self.reel.film.notice().scenario.vehicle_named(name).map_err(|e| e.to_string())?;
                let is_other = self.selected.is_none_or(|(before, _)| before != vehicle);
                self.selected = Some((vehicle, *functions));
                if is_other {
                    (self.wished, self.estimated) = (None, None);
                }
            }
            Ask::Control { what: Word::Pause } => self.player.pause(now),
            Ask::Control { what: Word::Resume } => self.play(now),
            Ask::Control { what: Word::Step } => self.step(1, now),
            Ask::Step { by } => self.step(*by, now),
            Ask::Seek { t_s } if t_s.is_finite() => self.jump(SimTime::from_s(*t_s), now),
            Ask::Speed { factor } if factor.is_none_or(|factor| factor.is_finite() && factor > 0.0) => {
                self.player.set_speed(*factor, now);
            }
            Ask::Seek { .. } | Ask::Speed { .. } => return Err("not a number that makes sense".to_owned()),
            Ask::Control { .. } | Ask::Drive { .. } | Ask::LetGo { .. } => return Err("this is a recording".to_owned()),
        }
        Ok(())
    }

    fn say(&mut self, now: Instant, room: Room) -> Option<Said> {
        let film = Arc::clone(&self.reel.film);
        if !std::mem::replace(&mut self.greeted, true) {
            let version = &film.notice().version;
            let hello = Tell::hello(version, Mode::Replay, self.guest.rights, film.game(), &self.reel.chart);
            return Some(Said::Text(hello.json()));
        }
        if !std::mem::replace(&mut self.told_events, true) {
            let events = film.events().iter().map(EventTell::new).collect();
            return Some(Said::Text(Tell::Events { reset: true, events }.json()));
        }
        if let Some(said) = self.say_player(now) {
            return Some(said);
        }
        if let Some(frame) = self.shown {
            let selected = if room == Room::All {
                self.say_helm(frame, now).or_else(|| self.say_estimate(frame, now))
            } else {
                None
            };
            if let Some(said) = selected.or_else(|| self.say_status(frame, now)) {
                return Some(said);
            }
        }
        if room >= Room::Frames { self.say_frame(now) } else { None }
    }

    fn due(&self, now: Instant) -> Option<Instant> {
        let playing = self.player.is_playing();
        let times = self.reel.film.frame_times();
        let next = self.shown.and_then(|frame| times.get(frame + 1)).and_then(|time| self.player.when(*time));
        let told = self.told_player.as_ref().filter(|_| playing).map(|(_, at)| *at + TELL_AGAIN);
        // What was held back because the same was told shortly before.
        let is_old = |frame: usize| self.shown.is_some_and(|shown| shown != frame);
        let selected = self.selected.is_some();
        let estimate =
            self.estimated.filter(|(frame, _)| selected && is_old(*frame)).map(|(_, at)| at + ESTIMATE_AGAIN);
        let helm = self.wished.filter(|(wish, _)| selected && self.is_outdated(*wish)).map(|(_, at)| at + HELM_AGAIN);
        let status = self.looked.filter(|(frame, _)| is_old(*frame)).map(|(_, at)| at + TELL_AGAIN);
        let due = [next, told, estimate, helm, status].into_iter().flatten().min();
        due.map(|due| due.max(now + FRAME_AGAIN))
    }
}

impl Drop for PageViewer {
    fn drop(&mut self) {
        self.reel.desk.leave(self.reader);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::message::{Frame, Message};

    #[test]
    fn the_number_of_a_frame_stands_where_it_is_looked_for() {
        let mut frame = Frame::default();
        (frame.stamp.seq, frame.stamp.version) = (0x0102_0304_0506, Frame::VERSION);
        let bytes = game::codec::encode(&frame);
        assert_eq!(bytes[DECISION], 0x0102_0304_0506_u64.to_le_bytes());
    }
}
