//! The asker: asks a game for what is not published, in a thread of its own, since answers take their time.

use super::Theatre;
use super::stage::{HelmTold, Play};
use crate::page::clock;
use crate::page::rose::{HelmAnswer, helm_text};
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
/// No more than one part in so many of the time is spent on the answers of a helm.
const SHARE: u32 = 5;
/// How long the sim may collect its events.
const EVENTS_ANSWER: Duration = Duration::from_secs(3);

/// Asks one game.
pub(super) struct Asker<'a> {
    theatre: &'a Theatre,
    bus: Bus,
    play: Arc<Play>,
}

/// A question that was asked of a helm.
struct Asked {
    start: Instant,
    functions: bool,
    took: Duration,
}

impl Asked {
    /// Whether to ask again. In lockstep a game waits while a mind answers: a long answer is asked for less often.
    fn is_due_again(&self, functions: bool, now: Instant) -> bool {
        let rest = HELM_AGAIN.max(self.took * SHARE);
        (functions && !self.functions) || now.saturating_duration_since(self.start) >= rest
    }
}

impl Asker<'_> {
    pub(super) fn new(theatre: &Theatre, bus: Bus, play: Arc<Play>) -> Asker<'_> {
        Asker { theatre, bus, play }
    }

    /// Asks until the game is left.
    pub(super) fn ask(&self, left: &Board<bool>) {
        let mut asked: BTreeMap<VehicleId, Asked> = BTreeMap::new();
        while !left.wait(ROUND, |left| *left) {
            self.ask_events();
            let wanted = self.theatre.stage().wanted();
            asked.retain(|vehicle, _| wanted.contains_key(vehicle));
            for (vehicle, functions) in wanted {
                let start = clock::now();
                if asked.get(&vehicle).is_none_or(|asked| asked.is_due_again(functions, start)) {
                    self.ask_helm(vehicle, functions);
                    let took = clock::now().saturating_duration_since(start);
                    asked.insert(vehicle, Asked { start, functions, took });
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
        // Long work with a long report, for which the stage is not kept from others.
        let full = functions.then(|| helm_text(self.play.scenario(), vehicle, true, answer.clone()));
        let light = helm_text(self.play.scenario(), vehicle, false, answer);
        self.theatre.stage().take_helm(vehicle, HelmTold { light, full });
        self.theatre.news.ring();
    }
}

fn because(reason: String) -> HelmAnswer {
    HelmAnswer { reason: Some(reason), ..HelmAnswer::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_answers_are_asked_for_less_often() {
        let start = clock::now();
        let later = |ms| start + Duration::from_millis(ms);
        let asked = |took_ms| Asked { start, functions: false, took: Duration::from_millis(took_ms) };
        assert!(!asked(1).is_due_again(false, later(499)) && asked(1).is_due_again(false, later(500)));
        assert!(!asked(400).is_due_again(false, later(1999)) && asked(400).is_due_again(false, later(2000)));
        assert!(asked(400).is_due_again(true, later(1)), "somebody wants utilities too");
    }
}
