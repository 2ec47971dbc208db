//! Progress messages of a running game, shown on the terminal. For `squall run`, a sim prints each
//! as a line of JSON. The last message is the report of the game.

use crate::contest::Contest;
use messages::refusal::Refusals;
use rules::event::EventCursor;
use scenario::Outcome;
use scenario::outcome::EventOutcome;
use serde::{Deserialize, Serialize};

/// A progress message.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum ProgressMessage {
    /// The hub is open: nodes can join.
    Open {
        /// The game's name on the network.
        game: String,
        /// The endpoint for nodes on this machine.
        endpoint: String,
    },
    /// Some nodes are missing.
    Waiting {
        /// The vehicles without an agent, by name.
        agents: Vec<String>,
        /// The real boats not yet reported by a gateway, by name.
        gateways: Vec<String>,
    },
    /// The game starts.
    Started,
    /// An event of the game.
    Event(EventOutcome),
    /// Regular progress, about ten times per second.
    Progress(Progress),
    /// The final report.
    Done(Box<Report>),
}

/// The report of a game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The result of the game.
    pub outcome: Outcome,
    /// How the game was run.
    pub run: Run,
}

/// Results that depend on the machines and the network, not on the game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The pace of the game.
    pub pace: String,
    /// Wall-clock duration, s.
    pub wall_s: f64,
    /// Refused messages from agents and gateways.
    pub refused: Refusals,
    /// Decisions that began late (real time only).
    pub overruns: u64,
    /// Whether the game was stopped early.
    pub cut_short: bool,
    /// Boats whose competition entry failed to decide.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub entry_faults: Vec<EntryFaults>,
    /// Why the recording is incomplete or missing, if it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording_problem: Option<String>,
}

/// Decisions for which a boat's competition entry gave no action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EntryFaults {
    /// The boat's name.
    pub boat: String,
    /// The first fault.
    pub first: String,
    /// The number of such decisions.
    pub count: u64,
}

/// The state of a running game.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Progress {
    /// Simulated time, s.
    pub now_s: f64,
    /// Latest possible end of the game, s.
    pub end_s: f64,
    /// Teams with their points.
    pub score: Vec<(String, u32)>,
    /// Recent speed, simulated seconds per second.
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
    /// Reports the events since the last call, then progress.
    pub fn progress(
        &mut self,
        contest: &Contest,
        (rate, refused): (f64, u64),
        tell: &mut dyn FnMut(ProgressMessage),
    ) {
        let scenario = contest.scenario();
        // Report events first, so that an event appears before the score that it changes.
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

    /// Reports the remaining events after the end of the game.
    pub fn rest(mut self, outcome: &Outcome, tell: &mut dyn FnMut(ProgressMessage)) {
        let rest = self.reported.read(&outcome.events).iter();
        rest.for_each(|event| tell(ProgressMessage::Event(event.clone())));
    }
}
