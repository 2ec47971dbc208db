//! The asker: asks a game for what is not published, in a thread of its own, since answers take their time.

use super::Theatre;
use super::stage::Play;
use crate::page::clock;
use crate::page::rose::HelmAnswer;
use crate::page::show::HELM_AGAIN;
use bus::{Board, Bus};
use game::VehicleId;
use game::helm::{HelmQuestion, HelmReport};
use game::outcome::EventOutcome;
use game::topic;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often to see whether there is something to ask.
const ROUND: Duration = Duration::from_millis(50);
/// How long a helm may think about its answer.
const HELM_ANSWER: Duration = Duration::from_secs(1);
/// How long the sim may collect its events.
const EVENTS_ANSWER: Duration = Duration::from_secs(3);

/// Asks one game.
pub(super) struct Asker<'a> {
    theatre: &'a Theatre,
    bus: Bus,
    play: Arc<Play>,
}

impl Asker<'_> {
    pub(super) fn new(theatre: &Theatre, bus: Bus, play: Arc<Play>) -> Asker<'_> {
        Asker { theatre, bus, play }
    }

    /// Asks until the game is left.
    pub(super) fn ask(&self, left: &Board<bool>) {
        let mut asked: BTreeMap<VehicleId, (Instant, bool)> = BTreeMap::new();
        while !left.wait(ROUND, |left| *left) {
            self.ask_events();
            let wanted = self.theatre.stage().wanted();
            asked.retain(|vehicle, _| wanted.contains_key(vehicle));
            for (vehicle, functions) in wanted {
                let now = clock::now();
                let is_due = asked
                    .get(&vehicle)
                    .is_none_or(|(at, with)| now.saturating_duration_since(*at) >= HELM_AGAIN || (functions && !with));
                if is_due {
                    asked.insert(vehicle, (now, functions));
                    self.ask_helm(vehicle, functions);
                }
            }
        }
    }

    /// All that has happened, where something of it was missed.
    fn ask_events(&self) {
        if !self.theatre.stage().chronicle.is_to_ask(clock::now()) {
            return;
        }
        let answer = self.bus.ask(&topic::events(&self.play.name), Vec::new(), EVENTS_ANSWER);
        // An older sim does not answer; then frames are all there is.
        let events = answer.ok().flatten().and_then(|bytes| serde_json::from_slice::<Vec<EventOutcome>>(&bytes).ok());
        if let Some(events) = events {
            self.theatre.stage().chronicle.rewrite(events);
            self.theatre.news.ring();
        }
    }

    fn ask_helm(&self, vehicle: VehicleId, functions: bool) {
        let question = serde_json::to_vec(&HelmQuestion { functions }).unwrap_or_default();
        let key = topic::helm(&self.play.name, self.play.scenario(), vehicle);
        let answer = self.bus.ask(&key, question, HELM_ANSWER).ok().flatten();
        let name = self.play.name_of(vehicle);
        let answer = match answer.map(|bytes| serde_json::from_slice::<Option<HelmReport>>(&bytes)) {
            Some(Ok(Some(report))) => HelmAnswer { report: Some(report), ..HelmAnswer::default() },
            Some(Ok(None)) => because(format!("the mind of {name} goes by no helm")),
            Some(Err(_)) => because(format!("the mind of {name} is of another version of Squall")),
            None => because(format!("nobody minds {name} now")),
        };
        self.theatre.stage().take_helm(vehicle, functions, answer);
        self.theatre.news.ring();
    }
}

fn because(reason: String) -> HelmAnswer {
    HelmAnswer { reason: Some(reason), ..HelmAnswer::default() }
}
