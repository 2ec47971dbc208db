//! What a running game reports: one JSON line each from the sim's process to `run`, the same for the screen.

use game::event::{EventCursor, Logged};
use game::outcome::EventOutcome;
use serde::{Deserialize, Serialize};
use sim::Contest;
use sim::node::{News, Report};

/// One message.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "tell")]
pub(crate) enum ProgressMessage {
    /// Nodes can join.
    Open {
        /// The game's name on the network.
        game: String,
        /// Where to connect.
        endpoint: String,
    },
    /// Somebody is not there yet.
    Waiting {
        /// The vehicles without an agent, by name.
        missing: Vec<String>,
        /// The real boats that no gateway has reported the position of, by name.
        gateways: Vec<String>,
    },
    /// The game begins.
    Started,
    /// Something happened.
    Event(EventOutcome),
    /// How it stands.
    Progress(Progress),
    /// How it ended.
    Done(Box<Report>),
}

/// How a game stands.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Progress {
    /// Simulated time, s.
    pub(crate) now_s: f64,
    /// The end of the game at the latest, s.
    pub(crate) end_s: f64,
    /// Team and points.
    pub(crate) score: Vec<(String, u32)>,
    /// Simulated seconds a second.
    pub(crate) rate: f64,
    /// Refused from agents so far.
    pub(crate) refused: u64,
}

/// Turns what happens into tellings, each event once.
#[derive(Default)]
pub(crate) struct Teller {
    told: EventCursor,
}

impl Teller {
    /// The events since last time, then how the game stands.
    pub(crate) fn progress(&mut self, contest: &Contest, rate: f64, refused: u64) -> Vec<ProgressMessage> {
        let scenario = contest.scenario();
        let names = scenario.teams.iter().map(|team| team.name.clone());
        let mut tellings = self.events(contest);
        tellings.push(ProgressMessage::Progress(Progress {
            now_s: contest.now().as_s(),
            end_s: scenario.rules.time_limit.as_s(),
            score: names.zip(contest.score().iter().copied()).collect(),
            rate,
            refused,
        }));
        tellings
    }

    fn events(&mut self, contest: &Contest) -> Vec<ProgressMessage> {
        let name = |logged: &Logged| ProgressMessage::Event(EventOutcome::new(contest.scenario(), logged));
        self.told.read(contest.events()).iter().map(name).collect()
    }

    /// What a sim node's news come to. Where it is open, only its shell knows.
    pub(crate) fn news(&mut self, news: &News<'_>) -> Vec<ProgressMessage> {
        match news {
            News::Open => vec![],
            News::Waiting { agents, gateways } => {
                let [missing, gateways] =
                    [agents, gateways].map(|names| names.iter().map(|name| (*name).to_owned()).collect());
                vec![ProgressMessage::Waiting { missing, gateways }]
            }
            News::Started => vec![ProgressMessage::Started],
            News::Progress { contest, rate, refused } => self.progress(contest, *rate, *refused),
        }
    }

    /// The end of a game: the events not told yet, then the report.
    pub(crate) fn done(&mut self, report: Report) -> Vec<ProgressMessage> {
        let rest = self.told.read(&report.outcome.events).to_vec();
        let mut tellings: Vec<ProgressMessage> = rest.into_iter().map(ProgressMessage::Event).collect();
        tellings.push(ProgressMessage::Done(Box::new(report)));
        tellings
    }
}
