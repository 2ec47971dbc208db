//! The state of the running game, shared by all viewers.

use super::event_log::EventLog;
use super::frame_buffer::FrameBuffer;
use super::operating::Operating;
use super::steering::SteeringLocks;
use crate::page::chart::chart;
use bus::Bus;
use messages::external::GatewayStatus;
use messages::helm::HelmReport;
use messages::picture::{OwnBoat, Picture};
use messages::run_state::RunState;
use messages::topic::GameName;
use messages::water::Water;
use messages::{Frame, GameInfo};
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time without a frame after which a game whose sim publishes no run state counts as paused.
const STILL: Duration = Duration::from_secs(2);

/// The constant data of a game.
pub(super) struct LiveGame {
    pub(super) name: GameName,
    /// The sim's description.
    pub(super) info: GameInfo,
    /// The chart as JSON.
    pub(super) chart: Value,
}

/// A helm's report, encoded for pages.
#[derive(Clone, Debug)]
pub(super) struct HelmMessage {
    pub(super) light: String,
    /// The report with utilities, if any page requests them.
    pub(super) full: Option<String>,
}

/// The latest item for each vehicle. Viewers detect a new item by its address in memory.
pub(super) type Latest<T> = BTreeMap<VehicleId, Arc<T>>;

/// The shared state.
#[derive(Default)]
pub(super) struct LiveState {
    /// The game; kept after it has disappeared.
    pub(super) game: Option<Arc<LiveGame>>,
    /// The session, while the game is reachable.
    pub(super) bus: Option<Bus>,
    /// The number of games so far.
    pub(super) generation: u64,
    /// Whether the game has disappeared.
    pub(super) is_gone: bool,
    /// Why there is no game to show; empty before the first search.
    pub(super) missing: String,
    /// The run state, if the sim publishes it.
    pub(super) run: Option<RunState>,
    /// Increases with each change of the run state.
    pub(super) run_news: u64,
    pub(super) frames: FrameBuffer,
    pub(super) event_log: EventLog,
    pub(super) helms: Latest<HelmMessage>,
    pub(super) estimates: Latest<(OwnBoat, SimTime)>,
    pub(super) statuses: Latest<GatewayStatus>,
    pub(super) operating: Operating,
    pub(super) steering_locks: SteeringLocks,
    /// Set-points for steered boats: course (rad) and speed (m/s).
    pub(super) steering: BTreeMap<VehicleId, (f64, f64)>,
    /// By page: the selected boat, and whether utilities are requested.
    pub(super) selected: BTreeMap<u64, (VehicleId, bool)>,
    /// The pages that request the modes of all boats.
    pub(super) listed: BTreeSet<u64>,
    /// By vehicle: the mode that the helm last reported.
    pub(super) modes: Vec<Option<String>>,
    pub(super) modes_at_s: f64,
    /// Increases with each change of the modes.
    pub(super) modes_news: u64,
}

impl LiveGame {
    /// A game with its chart.
    pub(super) fn new(name: GameName, info: GameInfo, water: &Water) -> LiveGame {
        let chart = chart(&info.scenario, water);
        LiveGame { name, info, chart }
    }

    pub(super) fn scenario(&self) -> &Scenario {
        &self.info.scenario
    }

    pub(super) fn name_of(&self, vehicle: VehicleId) -> &str {
        &self.scenario().vehicles[vehicle.index()].name
    }

    pub(super) fn has_real_boats(&self) -> bool {
        self.scenario().externals().next().is_some()
    }
}

impl LiveState {
    /// Starts a new game. Discards the state of the previous one, including the selections of
    /// pages.
    pub(super) fn begin(&mut self, game: Arc<LiveGame>) {
        *self = LiveState {
            game: Some(game),
            generation: self.generation + 1,
            run_news: self.run_news + 1,
            event_log: EventLog::new(),
            ..LiveState::default()
        };
    }

    /// The current game, or an error if it has disappeared.
    pub(super) fn on(&self) -> Result<Arc<LiveGame>, String> {
        let game = self.game.clone().filter(|_| !self.is_gone);
        game.ok_or_else(|| "the game is no longer running".to_owned())
    }

    pub(super) fn end(&mut self) {
        (self.is_gone, self.run_news, self.bus) = (true, self.run_news + 1, None);
        self.steering_locks = SteeringLocks::default();
        self.steering.clear();
    }

    pub(super) fn take_frame(&mut self, frame: &Frame, cdr: &[u8], now: Instant) {
        let Some(game) = self.game.clone() else {
            return;
        };
        if !is_of(frame, game.scenario()) {
            return;
        }
        if self.frames.take(frame, cdr, now) {
            self.event_log.note_gap();
        }
        for event in frame.logged(game.scenario()) {
            self.event_log
                .add(EventOutcome::new(game.scenario(), &event));
        }
    }

    pub(super) fn take_run(&mut self, run: RunState) {
        let gist = |run: &RunState| {
            let recording = run
                .recording
                .as_ref()
                .map(|recording| (recording.file.clone(), recording.failed.clone()));
            (
                run.phase,
                run.speed,
                run.minds.clone(),
                run.gateways.clone(),
                recording,
            )
        };
        let is_news = self
            .run
            .as_ref()
            .is_none_or(|before| gist(before) != gist(&run));
        self.run_news += u64::from(is_news);
        self.run = Some(run);
    }

    pub(super) fn take_picture(&mut self, picture: &Picture) {
        let selected: Vec<VehicleId> = self
            .selected
            .values()
            .map(|(vehicle, _)| *vehicle)
            .collect();
        for boat in picture
            .own
            .iter()
            .filter(|boat| selected.contains(&boat.vehicle))
        {
            self.estimates
                .insert(boat.vehicle, Arc::new((*boat, picture.stamp.valid_ns)));
        }
    }

    /// Selects a boat's helm for a page, with or without utilities.
    pub(super) fn select(
        &mut self,
        page: u64,
        selection: Option<&(String, bool)>,
    ) -> Result<(), String> {
        let (Some((name, functions)), Some(game)) = (selection, &self.game) else {
            return Ok(());
        };
        let vehicle = game
            .scenario()
            .vehicle_named(name)
            .map_err(|e| e.to_string())?;
        self.selected.insert(page, (vehicle, *functions));
        Ok(())
    }

    /// The selected boats, and whether any page requests utilities.
    pub(super) fn wanted(&self) -> BTreeMap<VehicleId, bool> {
        let mut wanted = BTreeMap::new();
        for (vehicle, functions) in self.selected.values() {
            *wanted.entry(*vehicle).or_insert(false) |= functions;
        }
        wanted
    }

    /// The boats whose modes any page requests.
    pub(super) fn listed(&self) -> Vec<VehicleId> {
        let count = self
            .game
            .as_ref()
            .filter(|_| !self.listed.is_empty())
            .map_or(0, |game| game.scenario().vehicles.len());
        (0..count).map(VehicleId::at).collect()
    }

    /// Stores the mode in a helm's report, if any.
    pub(super) fn take_mode(&mut self, vehicle: VehicleId, report: Option<&HelmReport>) {
        let Some(game) = &self.game else { return };
        self.modes.resize(game.scenario().vehicles.len(), None);
        let Some(known) = self.modes.get_mut(vehicle.index()) else {
            return;
        };
        let mode = report
            .map(|report| report.mode.clone())
            .filter(|mode| !mode.is_empty());
        self.modes_at_s = report.map_or(self.modes_at_s, |report| report.at.as_s());
        self.modes_news += u64::from(*known != mode);
        *known = mode;
    }

    /// Drops data of boats that no page selects any longer.
    pub(super) fn forget_unwanted(&mut self) {
        let wanted = self.wanted();
        self.helms.retain(|vehicle, _| wanted.contains_key(vehicle));
        self.estimates
            .retain(|vehicle, _| wanted.contains_key(vehicle));
    }

    /// The phase of the run, in the protocol's terms.
    pub(super) fn phase(&self, now: Instant) -> &'static str {
        let still = self
            .frames
            .came
            .is_none_or(|came| now.saturating_duration_since(came) > STILL);
        match (&self.run, self.is_gone) {
            (_, true) => "gone",
            (Some(run), _) => run.phase.into(),
            // Older sims publish no run state.
            (None, _) if self.frames.is_over => "over",
            (None, _) if self.frames.count == 0 => "waiting",
            (None, _) if still => "paused",
            (None, _) => "playing",
        }
    }
}

/// Whether a frame matches the game in time, boats, flags and teams.
fn is_of(frame: &Frame, scenario: &Scenario) -> bool {
    (SimTime::ZERO..SimTime::NEVER).contains(&frame.stamp.valid_ns)
        && frame.vehicles.len() == scenario.vehicles.len()
        && frame.flags.len() == scenario.field.flags.len()
        && frame.score.len() == scenario.teams.len()
}
