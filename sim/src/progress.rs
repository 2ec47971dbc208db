//! What is reported while a game is played: shown on the terminal, and by a sim as one JSON line each for `squall run`.

use crate::contest::Contest;
use crate::report::Report;
use rules::event::EventCursor;
use scenario::Outcome;
use scenario::outcome::EventOutcome;
use serde::{Deserialize, Serialize};

/// One message.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum ProgressMessage {
    /// The hub listens: nodes can join.
    Open {
        /// The game's name on the network.
        game: String,
        /// Where nodes on this machine can connect.
        endpoint: String,
    },
    /// Somebody is not there yet.
    Waiting {
        /// The vehicles without an agent, by name.
        agents: Vec<String>,
        /// The real boats that no gateway has reported the position of, by name.
        gateways: Vec<String>,
    },
    /// The game begins.
    Started,
    /// Something happened.
    Event(EventOutcome),
    /// Some time has passed: ten times a second or so.
    Progress(Progress),
    /// How it ended.
    Done(Box<Report>),
}

/// How a game stands.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Progress {
    /// Simulated time, s.
    pub now_s: f64,
    /// The end of the game at the latest, s.
    pub end_s: f64,
    /// Team and points.
    pub score: Vec<(String, u32)>,
    /// Simulated seconds a second, lately.
    pub rate: f64,
    /// Messages refused so far.
    pub refused: u64,
}

/// Reports each event once.
#[derive(Default)]
pub struct Reporter {
    reported: EventCursor,
}

impl Reporter {
    /// The events since last time, then how the game stands.
    pub fn progress(&mut self, contest: &Contest, (rate, refused): (f64, u64), tell: &mut dyn FnMut(ProgressMessage)) {
        let scenario = contest.scenario();
        // Events before the progress: a line that says who has scored is shown before the score
        // that it changes.
        let news = self.reported.read(contest.events()).iter();
        news.for_each(|logged| tell(ProgressMessage::Event(EventOutcome::new(scenario, logged))));
        let teams = scenario.teams.iter().map(|team| team.name.clone());
        tell(ProgressMessage::Progress(Progress {
            now_s: contest.now().as_s(),
            end_s: scenario.rules.time_limit.as_s(),
            score: teams.zip(contest.score().iter().copied()).collect(),
            rate,
            refused,
        }));
    }

    /// The events that are left when the game has ended.
    pub fn rest(mut self, outcome: &Outcome, tell: &mut dyn FnMut(ProgressMessage)) {
        let rest = self.reported.read(&outcome.events).iter();
        rest.for_each(|event| tell(ProgressMessage::Event(event.clone())));
    }
}
