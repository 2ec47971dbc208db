//! A made-up recording.

use game::external::GatewayStatus;
use game::helm::HelmReport;
use game::message::{Frame, GameInfo, Message, Stamp, VehicleTruth};
use game::outcome::EventOutcome;
use game::picture::{FlagView, Nav, OwnBoat};
use game::water::Water;
use game::{Scenario, SimTime, VehicleId};
use shore::page::HelmAnswer;
use shore::page::replay::{Helms, ReplaySource};

pub(crate) struct MadeUp {
    notice: GameInfo,
    water: Water,
    times: Vec<SimTime>,
    frames: Vec<Vec<u8>>,
    events: Vec<EventOutcome>,
}

pub(crate) fn scenario(file: &str) -> Scenario {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games").join(file);
    game::scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

/// The frame of a decision in a game of ten decisions a second.
pub(crate) fn frame(scenario: &Scenario, seq: u64) -> Frame {
    Frame {
        stamp: Stamp { valid_ns: SimTime(100_000_000 * seq as i64), seq, version: Frame::VERSION },
        vehicles: vec![VehicleTruth::default(); scenario.vehicles.len()],
        flags: vec![FlagView { carrier: -1 }; scenario.field.flags.len()],
        score: vec![0; scenario.teams.len()],
        ..Frame::default()
    }
}

/// The decision that a frame on the wire is of.
pub(crate) fn seq_of(wire: &[u8]) -> u64 {
    game::codec::decode::<Frame>(&wire[1..]).expect("frames are CDR").stamp.seq
}

pub(crate) fn own_boat(vehicle: VehicleId) -> OwnBoat {
    let nav = Nav { north_m: 3.0, east_m: 4.0, psi_rad: std::f64::consts::FRAC_PI_2, surge_m_s: 1.5, ..Nav::default() };
    OwnBoat::new(vehicle, nav)
}

pub(crate) fn report(vehicle: VehicleId) -> HelmReport {
    HelmReport {
        vehicle,
        at: SimTime::ZERO,
        program: "made_up".to_owned(),
        mode: "sailing".to_owned(),
        course_deg: Some(90.0),
        speed_m_s: Some(1.0),
        hold: None,
        value: None,
        courses: 2,
        speeds: 2,
        speed_max_m_s: 2.0,
        behaviours: vec![],
        variables: vec![],
        functions: vec![],
    }
}

impl MadeUp {
    /// A recording of two minutes.
    pub(crate) fn new() -> MadeUp {
        MadeUp::of(1201)
    }

    /// A recording of so many frames.
    pub(crate) fn of(frames: u64) -> MadeUp {
        let scenario = scenario("pav01_vs_pav01.toml");
        let frames: Vec<Frame> = (0..frames).map(|seq| frame(&scenario, seq)).collect();
        let event = |tick: u64, event: &str| EventOutcome {
            tick,
            at_s: tick as f64 * 0.05,
            event: event.to_owned(),
            vehicle: Some("blue_one".to_owned()),
            other: None,
            team: None,
        };
        MadeUp {
            notice: GameInfo { version: game::VERSION.to_owned(), pace: "lockstep".to_owned(), scenario },
            water: Water::default(),
            times: frames.iter().map(|frame| frame.stamp.valid_ns).collect(),
            frames: frames.iter().map(game::codec::encode).collect(),
            events: vec![event(20, "untagged"), event(60, "failsafe")],
        }
    }
}

impl ReplaySource for MadeUp {
    fn info(&self) -> &GameInfo {
        &self.notice
    }
    fn game(&self) -> &str {
        "made_up"
    }
    fn file(&self) -> &str {
        "made_up.mcap"
    }
    fn is_cut(&self) -> bool {
        true
    }
    fn water(&self) -> &Water {
        &self.water
    }
    fn frame_times(&self) -> &[SimTime] {
        &self.times
    }
    fn frame_bytes(&self, frame: usize) -> &[u8] {
        &self.frames[frame]
    }
    fn events(&self) -> &[EventOutcome] {
        &self.events
    }
    fn estimate(&self, vehicle: VehicleId, _: usize) -> Option<OwnBoat> {
        Some(own_boat(vehicle))
    }
    fn status(&self, _: VehicleId, _: SimTime) -> Option<GatewayStatus> {
        None
    }
}

/// Helms that remember nothing but which decision they were asked about.
pub(crate) struct Rememberer;

impl Helms for Rememberer {
    fn report(&mut self, vehicle: VehicleId, decision: u64, _: bool) -> HelmAnswer {
        let mode = format!("sailing:{decision}");
        let report = Some(HelmReport { mode, ..report(vehicle) });
        HelmAnswer { report, reason: None, computed: true, agrees: Some(true) }
    }
}
