//! One page's view of a running game.

use super::live_state::{HelmMessage, Latest, LiveGame, LiveState};
use super::operating::Operated;
use super::{Command, SharedState, operating, stopping};
use crate::page::message::{EventMessage, Mode, PageMessage, seconds};
use crate::page::request::PageRequest;
use crate::page::view::{
    Access, Budget, ESTIMATE_INTERVAL, MODES_INTERVAL, Outgoing, SEND_INTERVAL, Viewer,
};
use messages::Control;
use messages::external::{GatewayStatus, OperatorCommand};
use messages::picture::OwnBoat;
use primitives::{SimTime, VehicleId};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Instant;

pub(super) struct PageViewer {
    shared: Arc<SharedState>,
    access: Access,
    page: u64,
    /// The selected boat, and whether utilities are requested. Kept for the next game if it has a
    /// boat with this name.
    selection: Option<(String, bool)>,
    wants_modes: bool,
    sent: Sent,
}

/// The data already sent to a page about one game.
#[derive(Default)]
struct Sent {
    /// The number of the game.
    generation: u64,
    /// Why no game is shown.
    missing: String,
    events: super::event_log::EventCursor,
    /// Number of the last run state sent, and when.
    run: Option<(u64, Instant)>,
    /// Steering locks as last sent, by boat.
    steering_locks: BTreeMap<VehicleId, &'static str>,
    statuses: Latest<GatewayStatus>,
    helm: Option<Arc<HelmMessage>>,
    estimate: Option<(Arc<(OwnBoat, SimTime)>, Instant)>,
    /// Number of the last modes sent, and when.
    modes: Option<(u64, Instant)>,
    /// Number of the newest frame sent; 0 for none.
    frame: u64,
    /// Past frames to send before the first current one.
    past: Option<VecDeque<Outgoing>>,
}

impl PageViewer {
    pub(super) fn new(shared: Arc<SharedState>, access: Access, page: u64) -> PageViewer {
        PageViewer {
            shared,
            access,
            page,
            selection: None,
            wants_modes: false,
            sent: Sent::default(),
        }
    }

    /// Forwards a command to this game. The state stays locked meanwhile, so that the next game
    /// cannot receive it.
    fn control(&self, state: &LiveState, control: Control) -> Result<(), String> {
        if control.stops() {
            return stopping::stop(&self.shared, state, control);
        }
        let game = state.on()?;
        if control == Control::Release && game.has_real_boats() && self.access < Access::Operate {
            return Err("only a page with the operator's token can release real boats".to_owned());
        }
        if control == Control::Release {
            self.shared.stops.cancel(None);
        }
        self.send(Command::Control(control))
    }

    fn send(&self, command: Command) -> Result<(), String> {
        if self.shared.commands.offer(command) {
            return Ok(());
        }
        Err("the network is too slow: try again".to_owned())
    }

    fn select(&mut self, vehicle: Option<&str>, functions: bool) -> Result<(), String> {
        self.selection = vehicle.map(|name| (name.to_owned(), functions));
        (self.sent.helm, self.sent.estimate) = (None, None);
        let mut state = self.shared.state.lock();
        state.selected.remove(&self.page);
        state.select(self.page, self.selection.as_ref())
    }

    fn list(&mut self, wanted: bool) {
        (self.wants_modes, self.sent.modes) = (wanted, None);
        let mut state = self.shared.state.lock();
        if wanted {
            state.listed.insert(self.page)
        } else {
            state.listed.remove(&self.page)
        };
    }

    fn set_speed(&self, factor: Option<f64>) -> Result<(), String> {
        let state = self.shared.state.lock();
        let game = state.on()?;
        if game.has_real_boats() {
            return Err("the speed of a game with real boats cannot be changed".to_owned());
        }
        match factor {
            None if game.info.pace != "lockstep" => {
                Err("only a game in lockstep can run at unlimited speed".to_owned())
            }
            Some(factor) if !Control::SPEEDS.contains(&factor) => {
                let min = Control::SPEEDS.start();
                let max = Control::SPEEDS.end();
                Err(format!("the speed is {factor}, expected {min} to {max}"))
            }
            _ => self.control(&state, Control::Speed(factor)),
        }
    }

    fn drive(
        &self,
        name: &str,
        course_deg: f64,
        speed_m_s: f64,
        now: Instant,
    ) -> Result<(), String> {
        let mut state = self.shared.state.lock();
        let game = state.on()?;
        let scenario = game.scenario();
        let vehicle = scenario.vehicle_named(name).map_err(|e| e.to_string())?;
        if !scenario.strategy_of(vehicle).is_steered() {
            return Err(format!(
                "{name} cannot be driven: its strategy does not accept an external policy"
            ));
        }
        if !course_deg.is_finite() || !speed_m_s.is_finite() {
            return Err("course and speed must be finite".to_owned());
        }
        let speed_m_s = speed_m_s.clamp(0.0, scenario.boat_of(vehicle).speed_max_m_s());
        let course_rad = course_deg.rem_euclid(360.0).to_radians();
        let had = state.steering_locks.holder(vehicle);
        if !state.steering_locks.acquire(vehicle, self.page, now) {
            return Err(format!("another page is driving {name}"));
        }
        let is_news = state.steering_locks.holder(vehicle) != had;
        let is_on_its_way = !state.steering.is_empty();
        state.steering.insert(vehicle, (course_rad, speed_m_s));
        drop(state);
        if is_news {
            self.shared.news.send_replace(());
        }
        if is_on_its_way {
            Ok(())
        } else {
            self.send(Command::Steer)
        }
    }

    fn operate(&self, name: &str, command: OperatorCommand) -> Result<(), String> {
        operating::operate(
            &self.shared,
            &mut self.shared.state.lock(),
            self.page,
            name,
            command,
        )
    }

    fn release(&self, name: &str) -> Result<(), String> {
        let mut state = self.shared.state.lock();
        let vehicle = state
            .on()?
            .scenario()
            .vehicle_named(name)
            .map_err(|e| e.to_string())?;
        let had = state.steering_locks.release(vehicle, self.page);
        drop(state);
        if had {
            self.shared.news.send_replace(());
        }
        Ok(())
    }
}

impl Viewer for PageViewer {
    fn mode(&self) -> Mode {
        Mode::Live
    }

    fn ask(&mut self, ask: &PageRequest, now: Instant) -> Result<(), String> {
        match ask {
            PageRequest::Ack => Ok(()),
            PageRequest::Select { vehicle, functions } => {
                self.select(vehicle.as_deref(), *functions)
            }
            PageRequest::Modes { wanted } => {
                self.list(*wanted);
                Ok(())
            }
            PageRequest::Speed { factor }
            | PageRequest::Control {
                what: Control::Speed(factor),
            } => self.set_speed(*factor),
            PageRequest::Control { what } => self.control(&self.shared.state.lock(), *what),
            PageRequest::Drive {
                vehicle,
                course_deg,
                speed_m_s,
            } => self.drive(vehicle, *course_deg, *speed_m_s, now),
            PageRequest::LetGo { vehicle } => self.release(vehicle),
            PageRequest::Operate { vehicle, command } => self.operate(vehicle, command.clone()),
            PageRequest::Mission { vehicle, lines } => {
                let mission = (self.shared.read_mission)(lines)?;
                self.operate(vehicle, OperatorCommand::Mission(mission))
            }
            PageRequest::Step { .. } | PageRequest::Seek { .. } => {
                Err("a running game cannot be rewound".to_owned())
            }
            PageRequest::Curves { .. } => {
                Err("curves need a recording: this game is still running".to_owned())
            }
            PageRequest::WhatIf { .. } => {
                Err("futures need a recording: this game is still running".to_owned())
            }
        }
    }

    fn next_message(&mut self, now: Instant, budget: Budget) -> Option<Outgoing> {
        let mut state = self.shared.state.lock();
        let Some(game) = state.game.clone() else {
            let is_new = self.sent.missing != state.missing;
            self.sent.missing.clone_from(&state.missing);
            let missing = PageMessage::Preparing {
                text: &state.missing,
                failed: true,
            };
            return is_new.then(|| Outgoing::Text(missing.json()));
        };
        if self.sent.generation != state.generation {
            self.sent = Sent {
                generation: state.generation,
                ..Sent::default()
            };
            // This game may not have the boat; then the page selects a different one.
            drop(state.select(self.page, self.selection.as_ref()));
            if self.wants_modes {
                state.listed.insert(self.page);
            }
            let hello = PageMessage::hello(
                &game.info.version,
                Mode::Live,
                self.access,
                (game.name.as_str(), None),
                &game.chart,
            );
            return Some(Outgoing::Text(hello.json()));
        }
        let reply = state.operating.reply(self.page);
        let sent = &mut self.sent;
        let text = reply
            .map(
                |Operated {
                     vehicle,
                     command,
                     refused,
                 }| {
                    let vehicle = game.name_of(vehicle);
                    let refused = refused.as_deref();
                    PageMessage::Operated {
                        vehicle,
                        command,
                        refused,
                    }
                    .json()
                },
            )
            .or_else(|| sent.next_events(&state))
            .or_else(|| sent.next_run(&state, &game, now))
            .or_else(|| sent.next_steering(&state, &game, self.page))
            .or_else(|| sent.next_status(&state, &game))
            .or_else(|| {
                if budget == Budget::All {
                    sent.next_selected(&state, &game, self.page, now)
                } else {
                    None
                }
            })
            .or_else(|| {
                if budget == Budget::All && self.wants_modes {
                    sent.next_modes(&state, now)
                } else {
                    None
                }
            });
        match text {
            Some(text) => Some(Outgoing::Text(text)),
            None if budget >= Budget::Frames => sent.next_frame(&state),
            None => None,
        }
    }

    fn due(&self, now: Instant) -> Option<Instant> {
        let run = self.sent.run.map(|(_, at)| at + SEND_INTERVAL);
        let estimate = self
            .sent
            .estimate
            .as_ref()
            .map(|(_, at)| *at + ESTIMATE_INTERVAL)
            .filter(|at| *at > now);
        let modes = self
            .sent
            .modes
            .filter(|_| self.wants_modes)
            .map(|(_, at)| at + MODES_INTERVAL)
            .filter(|at| *at > now);
        run.into_iter().chain(estimate).chain(modes).min()
    }
}

impl Drop for PageViewer {
    fn drop(&mut self) {
        let mut state = self.shared.state.lock();
        state.selected.remove(&self.page);
        state.listed.remove(&self.page);
        state.steering_locks.release_all(self.page);
        state.operating.forget(self.page);
        drop(state);
        self.shared.news.send_replace(());
    }
}

impl Sent {
    fn next_events(&mut self, state: &LiveState) -> Option<String> {
        let (reset, unread, cursor) = state.event_log.unread(self.events)?;
        self.events = cursor;
        Some(
            PageMessage::Events {
                reset,
                events: unread.map(EventMessage::new).collect(),
            }
            .json(),
        )
    }

    fn next_run(&mut self, state: &LiveState, game: &LiveGame, now: Instant) -> Option<String> {
        let is_sent = |(news, at): (u64, Instant)| {
            news == state.run_news && now.saturating_duration_since(at) < SEND_INTERVAL
        };
        if self.run.is_some_and(is_sent) {
            return None;
        }
        self.run = Some((state.run_news, now));
        let run = state.run.clone().unwrap_or_default();
        let is_sent = state.run.is_some();
        let tell = PageMessage::State {
            phase: state.phase(now),
            now_s: if is_sent {
                run.now_s
            } else {
                seconds(state.frames.stamp.valid_ns)
            },
            pace: if is_sent { &run.pace } else { &game.info.pace },
            speed: run.speed,
            rate: run.rate,
            minds: &run.minds,
            gateways: &run.gateways,
            refused: run.refused,
            overruns: run.overruns,
            recording: run.recording.as_ref(),
            frames_hz: state.frames.rate_hz(now),
            can_speed: !game.has_real_boats(),
        };
        Some(tell.json())
    }

    fn next_steering(&mut self, state: &LiveState, game: &LiveGame, page: u64) -> Option<String> {
        let by = |vehicle| {
            state
                .steering_locks
                .holder(vehicle)
                .map(|holder| if holder == page { "you" } else { "other" })
        };
        let mut known = self
            .steering_locks
            .keys()
            .copied()
            .chain(state.steering_locks.held());
        let vehicle =
            known.find(|vehicle| self.steering_locks.get(vehicle).copied() != by(*vehicle))?;
        match by(vehicle) {
            Some(who) => self.steering_locks.insert(vehicle, who),
            None => self.steering_locks.remove(&vehicle),
        };
        Some(
            PageMessage::Drive {
                vehicle: game.name_of(vehicle),
                by: by(vehicle),
            }
            .json(),
        )
    }

    fn next_status(&mut self, state: &LiveState, game: &LiveGame) -> Option<String> {
        let is_sent = |vehicle, status| {
            self.statuses
                .get(vehicle)
                .is_some_and(|sent| Arc::ptr_eq(sent, status))
        };
        let (vehicle, status) = state
            .statuses
            .iter()
            .find(|(vehicle, status)| !is_sent(vehicle, status))?;
        self.statuses.insert(*vehicle, Arc::clone(status));
        Some(
            PageMessage::Status {
                vehicle: game.name_of(*vehicle),
                status,
            }
            .json(),
        )
    }

    /// The next message about the selected boat.
    fn next_selected(
        &mut self,
        state: &LiveState,
        game: &LiveGame,
        page: u64,
        now: Instant,
    ) -> Option<String> {
        let (vehicle, functions) = *state.selected.get(&page)?;
        let is_sent = |helm: &Arc<HelmMessage>| {
            self.helm
                .as_ref()
                .is_some_and(|sent| Arc::ptr_eq(sent, helm))
        };
        if let Some(helm) = state.helms.get(&vehicle).filter(|helm| !is_sent(helm)) {
            let text = if functions {
                helm.full.as_ref()
            } else {
                Some(&helm.light)
            };
            if let Some(text) = text {
                self.helm = Some(Arc::clone(helm));
                return Some(text.clone());
            }
        }
        let estimate = state.estimates.get(&vehicle)?;
        let is_sent = |(sent, at): &(Arc<_>, Instant)| {
            Arc::ptr_eq(sent, estimate) || now.saturating_duration_since(*at) < ESTIMATE_INTERVAL
        };
        if self.estimate.as_ref().is_some_and(is_sent) {
            return None;
        }
        self.estimate = Some((Arc::clone(estimate), now));
        let (boat, at) = &**estimate;
        Some(PageMessage::estimate(game.name_of(vehicle), boat, *at).json())
    }

    /// The modes of all boats, if any has changed.
    fn next_modes(&mut self, state: &LiveState, now: Instant) -> Option<String> {
        let is_sent = |(news, at): (u64, Instant)| {
            news == state.modes_news || now.saturating_duration_since(at) < MODES_INTERVAL
        };
        if state.modes.is_empty() || self.modes.is_some_and(is_sent) {
            return None;
        }
        self.modes = Some((state.modes_news, now));
        Some(
            PageMessage::Modes {
                at_s: state.modes_at_s,
                modes: &state.modes,
            }
            .json(),
        )
    }

    /// The newest frame or, before the first one, the next past frame.
    fn next_frame(&mut self, state: &LiveState) -> Option<Outgoing> {
        if state.frames.count == self.frame {
            return None;
        }
        if let Some(past) = self
            .past
            .get_or_insert_with(|| state.frames.past())
            .pop_front()
        {
            return Some(past);
        }
        self.frame = state.frames.count;
        state.frames.newest.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::rose::tests::scenario;
    use bus::{clock, inbox};
    use messages::topic::GameName;
    use messages::water::Water;
    use messages::{Frame, GameInfo};

    #[test]
    fn what_is_told_of_the_selected_boat_waits_until_there_is_room() {
        let shared = Arc::new(
            SharedState::new(inbox(1).0, Box::new(|_| ()), |_| Err(String::new())).unwrap(),
        );
        let scenario = scenario();
        let now = clock::now();
        let info = GameInfo {
            version: String::new(),
            pace: "lockstep".to_owned(),
            scenario,
        };
        let name = GameName::new("pond").unwrap();
        shared
            .state
            .lock()
            .begin(Arc::new(LiveGame::new(name, info, &Water::default())));
        let mut viewer = PageViewer::new(Arc::clone(&shared), Access::Watch, 1);
        let mut say = |budget| {
            std::iter::from_fn(|| viewer.next_message(now, budget)).collect::<Vec<Outgoing>>()
        };
        say(Budget::None);
        shared
            .state
            .lock()
            .select(1, Some(&("red_one".to_owned(), false)))
            .unwrap();
        let light = "a helm report".to_owned();
        let helm = HelmMessage {
            light: light.clone(),
            full: None,
        };
        shared
            .state
            .lock()
            .helms
            .insert(VehicleId(2), Arc::new(helm));
        shared.state.lock().frames.take(&Frame::default(), &[], now);
        assert_eq!(say(Budget::None), []);
        assert_eq!(say(Budget::Frames), [Outgoing::now(&[])]);
        assert_eq!(say(Budget::All), [Outgoing::Text(light)]);
    }
}
