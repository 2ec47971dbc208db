//! Real inputs: the scenario files in the tree, and a short game with all its messages.

use messages::water::{PlaneWave, Water};
use messages::{
    Frame, GameInfo, Message, Orders, Picture, PolicyProposal, Say, Stamp, VehicleOrder, Word,
};
use primitives::VehicleId;
use recording::{Decision, Ending, Entry, Header, Writer};
use rules::event::EventCursor;
use scenario::Scenario;
use std::io::Cursor;
use std::path::PathBuf;

/// The folder with the scenario files.
pub fn scenarios() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

/// A game in the tree.
///
/// # Panics
/// If no game has this name.
pub fn scenario(name: &str) -> Scenario {
    let file = scenarios().join("games").join(name).with_extension("toml");
    scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

/// A game between two teams of two boats each, one real and one simulated.
pub fn mixed() -> Scenario {
    scenario("mixed_2v2")
}

/// The results of a short game.
pub struct Played {
    /// The scenario.
    pub scenario: Scenario,
    /// The decisions as observers and minds receive them.
    pub decisions: Vec<Decision>,
    /// The minds' orders as one agent sends them.
    pub orders: Vec<Orders>,
    /// The boats' team messages.
    pub says: Vec<Say>,
    /// The end of the game.
    pub ending: Ending,
}

/// Plays the first decisions of a game without real boats.
///
/// # Panics
/// If the game cannot be played.
pub fn played(scenario: Scenario, decisions: u64) -> Played {
    let mut contest = sim::Contest::new(&scenario, scenario.seed).expect("the game starts");
    let mut runner = arena::runner_of(agent::minds_of(&scenario));
    let mut cursor = EventCursor::default();
    let mut kept = Vec::new();
    let mut orders = Vec::new();
    let mut says = Vec::new();
    contest.keep_inputs();
    for _ in 0..decisions {
        arena::decide(&mut contest, &mut runner);
        let pictures: Vec<Picture> = contest.last_pictures().to_vec();
        orders.extend(runner.answer(7));
        let stamp = Stamp {
            version: Say::VERSION,
            ..pictures[0].stamp
        };
        let word = Word {
            vehicle: VehicleId(0),
            key: 5,
            value: 0.5,
        };
        says.push(Say {
            stamp,
            words: [&[word], runner.sent()].concat(),
        });
        contest.advance();
        let frame: Frame = contest.frame(&mut cursor);
        kept.push(Decision {
            frame: frame.into(),
            pictures,
            inputs: contest.take_inputs(),
        });
    }
    let ending = Ending {
        outcome: contest.outcome(),
        ..Ending::default()
    };
    Played {
        scenario,
        decisions: kept,
        orders,
        says,
        ending,
    }
}

impl Played {
    /// The sim's description of the game.
    pub fn info(&self) -> GameInfo {
        GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: "lockstep".to_owned(),
            scenario: self.scenario.clone(),
        }
    }

    /// The game's recording, with additional entries.
    ///
    /// # Panics
    /// If the recording cannot be written.
    pub fn recording(&self, others: &[Entry]) -> Vec<u8> {
        let wave = PlaneWave {
            amplitude_m: 0.1,
            wavenumber_rad_m: 1.0,
            omega_rad_s: 3.1,
            ..PlaneWave::default()
        };
        let header = Header {
            commit: "c0ffee".to_owned(),
            game: "fuzz-1".to_owned(),
            began_utc_ns: 1_700_000_000_000_000_000,
            info: self.info(),
            water: Water { waves: vec![wave] },
        };
        let mut writer = Writer::begin(Cursor::new(Vec::new()), &header.opening()).expect("memory");
        let decisions = self
            .decisions
            .iter()
            .map(|decision| Entry::Decision(Box::new(decision.clone())));
        for entry in decisions.chain(others.iter().cloned()) {
            writer
                .write(&entry, 1_700_000_000_000_000_000)
                .expect("memory");
        }
        writer
            .end(self.ending.facts())
            .expect("memory")
            .into_inner()
    }
}

/// A policy proposal for a boat.
pub fn proposal() -> PolicyProposal {
    let stamp = Stamp {
        version: PolicyProposal::VERSION,
        ..Stamp::default()
    };
    PolicyProposal {
        stamp,
        vehicle: VehicleId(0),
        course_rad: 1.0,
        speed_m_s: 1.5,
    }
}

/// One order of each kind.
pub fn orders() -> [VehicleOrder; 3] {
    let thrust = messages::Order::Thrust {
        port: 0.5,
        starboard: -0.5,
    };
    let steer = messages::Order::Steer {
        heading_rad: 1.0,
        speed_m_s: 1.0,
    };
    [messages::Order::Hold, steer, thrust].map(|order| VehicleOrder::new(VehicleId(0), order))
}
