//! One page's look at a game.

use super::live_state::{LiveState, Play};
use super::{Command, SharedState};
use crate::page::ask::{Ask, Word};
use crate::page::show::{ESTIMATE_AGAIN, Guest, Room, Said, TELL_AGAIN, Viewer};
use crate::page::tell::{EventTell, Mode, Tell, seconds};
use axum::body::Bytes;
use game::VehicleId;
use game::message::Control;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Instant;

/// One page's look at a game.
pub(super) struct PageViewer {
    shared: Arc<SharedState>,
    guest: Guest,
    page: u64,
    /// Whose helm the page looks at, and whether with utilities: also in the next game, if it has that boat.
    wish: Option<(String, bool)>,
    told: Told,
}

/// What a page was told of one game.
#[derive(Default)]
struct Told {
    /// Which game it is.
    generation: u64,
    events: super::event_log::Bookmark,
    /// News of the run, and when.
    run: Option<(u64, Instant)>,
    /// Who has which wheel.
    wheels: BTreeMap<VehicleId, &'static str>,
    statuses: BTreeMap<VehicleId, u64>,
    helm: u64,
    estimate: Option<(u64, Instant)>,
    /// The newest frame; 0 is none.
    frame: u64,
    /// The frames of the past that come before it, once there is one.
    past: Option<VecDeque<Bytes>>,
}

impl PageViewer {
    pub(super) fn new(shared: Arc<SharedState>, guest: Guest, page: u64) -> PageViewer {
        PageViewer { shared, guest, page, wish: None, told: Told::default() }
    }

    /// Passes on what is wanted of the game that is on: the stage is kept meanwhile, so that it is not wanted of the next.
    fn control(&self, stage: &LiveState, control: Control) -> Result<(), String> {
        stage.on()?;
        self.send(Command::Control(control))
    }

    fn send(&self, command: Command) -> Result<(), String> {
        self.shared.commands.try_send(command).map_err(|_| "the network does not keep up: ask again".to_owned())
    }

    fn select(&mut self, vehicle: Option<&str>, functions: bool) -> Result<(), String> {
        self.wish = vehicle.map(|name| (name.to_owned(), functions));
        (self.told.helm, self.told.estimate) = (0, None);
        let mut stage = self.shared.stage();
        stage.selected.remove(&self.page);
        stage.select(self.page, self.wish.as_ref())
    }

    fn set_speed(&self, factor: Option<f64>) -> Result<(), String> {
        let stage = self.shared.stage();
        let play = stage.on()?;
        if play.has_real_boats() {
            return Err("a game with real boats keeps its pace".to_owned());
        }
        match factor {
            None if !play.is_lockstep() => {
                Err("only a game in lockstep goes as fast as can be: this one goes by the clock".to_owned())
            }
            Some(factor) if !Control::SPEEDS.contains(&factor) => {
                let (min, max) = (Control::SPEEDS.start(), Control::SPEEDS.end());
                Err(format!("the speed is {factor}, expected {min} to {max}"))
            }
            _ => self.control(&stage, Control::Speed(factor)),
        }
    }

    fn drive(&self, name: &str, course_deg: f64, speed_m_s: f64, now: Instant) -> Result<(), String> {
        let mut stage = self.shared.stage();
        let play = stage.on()?;
        let scenario = play.scenario();
        let vehicle = scenario.vehicle_named(name).map_err(|e| e.to_string())?;
        if !scenario.strategy_of(vehicle).is_steered() {
            return Err(format!("the strategy of {name} heeds no policy: it cannot be steered from here"));
        }
        if !course_deg.is_finite() || !speed_m_s.is_finite() {
            return Err("course and speed must be numbers".to_owned());
        }
        let speed_m_s = speed_m_s.clamp(0.0, scenario.boat_of(vehicle).speed_max_m_s());
        let course_rad = course_deg.rem_euclid(360.0).to_radians();
        let had = stage.wheels.holder(vehicle);
        if !stage.wheels.grip(vehicle, self.page, now) {
            return Err(format!("somebody else steers {name}"));
        }
        let is_news = stage.wheels.holder(vehicle) != had;
        let is_on_its_way = !stage.steering.is_empty();
        stage.steering.insert(vehicle, (course_rad, speed_m_s));
        drop(stage);
        if is_news {
            self.shared.news.ring();
        }
        if is_on_its_way { Ok(()) } else { self.send(Command::Steer) }
    }

    fn let_go(&self, name: &str) -> Result<(), String> {
        let mut stage = self.shared.stage();
        let vehicle = stage.on()?.scenario().vehicle_named(name).map_err(|e| e.to_string())?;
        let had = stage.wheels.let_go(vehicle, self.page);
        drop(stage);
        if had {
            self.shared.news.ring();
        }
        Ok(())
    }
}

impl Viewer for PageViewer {
    fn mode(&self) -> Mode {
        Mode::Live
    }

    fn ask(&mut self, ask: &Ask, now: Instant) -> Result<(), String> {
        match ask {
            Ask::Ack => Ok(()),
            Ask::Select { vehicle, functions } => self.select(vehicle.as_deref(), *functions),
            Ask::Control { what } => self.control(&self.shared.stage(), control(*what)),
            Ask::Speed { factor } => self.set_speed(*factor),
            Ask::Drive { vehicle, course_deg, speed_m_s } => self.drive(vehicle, *course_deg, *speed_m_s, now),
            Ask::LetGo { vehicle } => self.let_go(vehicle),
            Ask::Step { .. } | Ask::Seek { .. } => Err("a game that is being played cannot be wound".to_owned()),
        }
    }

    fn say(&mut self, now: Instant, room: Room) -> Option<Said> {
        let mut stage = self.shared.stage();
        let play = stage.play.clone()?;
        if self.told.generation != stage.generation {
            self.told = Told { generation: stage.generation, ..Told::default() };
            // The boat may not be in this game; then the page selects another.
            drop(stage.select(self.page, self.wish.as_ref()));
            let hello =
                Tell::hello(&play.notice.version, Mode::Live, self.guest.rights, play.name.as_str(), &play.chart);
            return Some(Said::Text(hello.json()));
        }
        let told = &mut self.told;
        let text = told
            .say_events(&stage)
            .or_else(|| told.say_run(&stage, &play, now))
            .or_else(|| told.say_wheel(&stage, &play, self.page))
            .or_else(|| told.say_status(&stage, &play))
            .or_else(|| if room == Room::All { told.say_selected(&stage, &play, self.page, now) } else { None });
        match text {
            Some(text) => Some(Said::Text(text)),
            None if room >= Room::Frames => told.say_frame(&stage),
            None => None,
        }
    }

    fn due(&self, now: Instant) -> Option<Instant> {
        let run = self.told.run.map(|(_, at)| at + TELL_AGAIN);
        let estimate = self.told.estimate.map(|(_, at)| at + ESTIMATE_AGAIN).filter(|at| *at > now);
        run.into_iter().chain(estimate).min()
    }
}

impl Drop for PageViewer {
    fn drop(&mut self) {
        let mut stage = self.shared.stage();
        stage.selected.remove(&self.page);
        stage.wheels.leave(self.page);
        drop(stage);
        self.shared.news.ring();
    }
}

impl Told {
    fn say_events(&mut self, stage: &LiveState) -> Option<String> {
        let (reset, unread, mark) = stage.event_log.unread(self.events)?;
        self.events = mark;
        Some(Tell::Events { reset, events: unread.map(EventTell::new).collect() }.json())
    }

    fn say_run(&mut self, stage: &LiveState, play: &Play, now: Instant) -> Option<String> {
        let is_told =
            |(news, at): (u64, Instant)| news == stage.run_news && now.saturating_duration_since(at) < TELL_AGAIN;
        if self.run.is_some_and(is_told) {
            return None;
        }
        self.run = Some((stage.run_news, now));
        let run = stage.run.clone().unwrap_or_default();
        let is_told = stage.run.is_some();
        let tell = Tell::State {
            phase: stage.phase(now),
            now_s: if is_told { run.now_s } else { seconds(stage.roll.stamp.valid_ns) },
            pace: if is_told { &run.pace } else { &play.notice.pace },
            speed: run.speed,
            rate: run.rate,
            minds: &run.minds,
            gateways: &run.gateways,
            refused: run.refused,
            overruns: run.overruns,
            recording: run.recording.as_ref(),
            frames_hz: stage.roll.rate_hz(now),
            can_speed: !play.has_real_boats(),
        };
        Some(tell.json())
    }

    fn say_wheel(&mut self, stage: &LiveState, play: &Play, page: u64) -> Option<String> {
        let by = |vehicle| stage.wheels.holder(vehicle).map(|holder| if holder == page { "you" } else { "other" });
        let mut known = self.wheels.keys().copied().chain(stage.wheels.held());
        let vehicle = known.find(|vehicle| self.wheels.get(vehicle).copied() != by(*vehicle))?;
        match by(vehicle) {
            Some(who) => self.wheels.insert(vehicle, who),
            None => self.wheels.remove(&vehicle),
        };
        Some(Tell::Drive { vehicle: play.name_of(vehicle), by: by(vehicle) }.json())
    }

    fn say_status(&mut self, stage: &LiveState, play: &Play) -> Option<String> {
        let is_news = |told: &BTreeMap<VehicleId, u64>, vehicle, number| told.get(vehicle) != Some(number);
        let (vehicle, status) = stage.statuses.iter().find(|(v, status)| is_news(&self.statuses, v, &status.number))?;
        self.statuses.insert(*vehicle, status.number);
        Some(Tell::Status { vehicle: play.name_of(*vehicle), status: &status.value }.json())
    }

    /// What is known of the boat that the page has selected.
    fn say_selected(&mut self, stage: &LiveState, play: &Play, page: u64, now: Instant) -> Option<String> {
        let (vehicle, functions) = *stage.selected.get(&page)?;
        if let Some(helm) = stage.helms.get(&vehicle).filter(|helm| helm.number != self.helm) {
            let text = if functions { helm.value.full.as_ref() } else { Some(&helm.value.light) };
            if let Some(text) = text {
                self.helm = helm.number;
                return Some(text.clone());
            }
        }
        let estimate = stage.estimates.get(&vehicle)?;
        let is_told = |(number, at): (u64, Instant)| {
            number == estimate.number || now.saturating_duration_since(at) < ESTIMATE_AGAIN
        };
        if self.estimate.is_some_and(is_told) {
            return None;
        }
        self.estimate = Some((estimate.number, now));
        let (boat, at) = &estimate.value;
        Some(Tell::estimate(play.name_of(vehicle), boat, *at).json())
    }

    /// The newest frame, before the first of all those of the past.
    fn say_frame(&mut self, stage: &LiveState) -> Option<Said> {
        if stage.roll.count == self.frame {
            return None;
        }
        if let Some(past) = self.past.get_or_insert_with(|| stage.roll.past()).pop_front() {
            return Some(Said::Past(past));
        }
        self.frame = stage.roll.count;
        Some(Said::Now(stage.roll.newest()))
    }
}

/// What a page's word means to a game.
fn control(word: Word) -> Control {
    match word {
        Word::Pause => Control::Pause,
        Word::Resume => Control::Resume,
        Word::Step => Control::Step,
        Word::Halt => Control::Halt,
        Word::GoOn => Control::GoOn,
        Word::EStop => Control::EStop,
        Word::Release => Control::Release,
        Word::Stop => Control::Stop,
    }
}

#[cfg(test)]
mod tests {
    use super::super::live_state::HelmTold;
    use super::*;
    use crate::page::clock;
    use game::message::{Frame, GameInfo};
    use game::topic::GameName;
    use game::water::Water;
    use std::path::Path;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn what_is_told_of_the_selected_boat_waits_until_there_is_room() {
        let shared = Arc::new(SharedState::new(sync_channel(1).0));
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/pav01_vs_pav01.toml");
        let (scenario, now) = (game::scenario::load(&file).unwrap(), clock::now());
        let notice = GameInfo { version: String::new(), pace: "lockstep".to_owned(), scenario };
        let name = GameName::new("pond").unwrap();
        shared.stage().begin(Arc::new(Play::new(name, notice, &Water::default())));
        let mut look = PageViewer::new(Arc::clone(&shared), Guest { rights: false }, 1);
        let mut say = |room| std::iter::from_fn(|| look.say(now, room)).collect::<Vec<Said>>();
        say(Room::None);
        shared.stage().select(1, Some(&("red_one".to_owned(), false))).unwrap();
        let light = "what it thinks".to_owned();
        shared.stage().take_helm(VehicleId(2), HelmTold { light: light.clone(), full: None });
        shared.stage().roll.take(&Frame::default(), &[], now);
        assert_eq!(say(Room::None), []);
        assert_eq!(say(Room::Frames), [Said::now(&[])]);
        assert_eq!(say(Room::All), [Said::Text(light)]);
    }
}
