//! Conditions that every game must satisfy, whatever fails.

use crate::plan::{FIRST_AGENT, Plan, SIM};
use crate::play::Played;
use messages::refusal::Refusal;
use parking_lot::Mutex;
use scenario::outcome::Outcome;
use sim::node::{Pace, Report};
use simulated_network::{Fault, Verdict};
use std::collections::BTreeMap;
use std::time::Duration;

/// Margin for retransmission and transport: without deliberate loss, then with it.
const SENT_AGAIN: Duration = Duration::from_millis(1000);
const SENT_OFTEN: Duration = Duration::from_millis(2000);
/// Extra delay until an effect that is due within patience becomes visible.
const SHOWS: Duration = Duration::from_millis(1500);
/// After the last fault, all nodes are back within the network's lease, patience and this margin.
const BACK: Duration = Duration::from_secs(8);
/// All nodes exit within this time after the game: an agent that never found it searches for a
/// minute.
const LEFT: Duration = Duration::from_secs(75);

/// The errors of a game; empty if there are none.
pub(crate) fn faults_of(plan: &Plan, played: &Played) -> Vec<String> {
    let mut wrong = played.monitor.wrong.clone();
    if played.run.verdict != Verdict::Ended {
        wrong.push(format!(
            "{:?} after {:?}",
            played.run.verdict, played.run.time
        ));
        return wrong;
    }
    match &played.sim {
        Some(Ok(report)) => {
            wrong.extend(check_digest(plan, played, report));
            wrong.extend(unjust_losses(plan, played, &report.outcome));
            wrong.extend(check_presence(plan, played));
        }
        Some(Err(e)) => wrong.push(format!("the sim ends with {e}")),
        None if plan.kills(SIM) => {}
        None => wrong.push("the sim has no result".to_owned()),
    }
    wrong.extend(check_ends(plan, played));
    wrong
}

impl Plan {
    fn kills(&self, node: usize) -> bool {
        self.faults
            .iter()
            .any(|(_, fault)| matches!(fault, Fault::Kill { node: who, .. } if *who == node))
    }

    /// When the real boat must be back whatever happened to it; `None` if there is none, or if a
    /// node that it needs never restarts.
    pub(crate) fn real_boat_is_back(&self) -> Option<Duration> {
        let is_gone = |(_, fault): &(Duration, Fault)| matches!(fault, Fault::Kill { node, restart: None } if [SIM, self.gateway()].contains(node));
        let comes = self.has_real_boat() && !self.faults.iter().any(is_gone);
        comes.then(|| self.faults_end() + self.conditions.lease + BACK)
    }

    fn agent_of(&self, boat: usize) -> usize {
        let has = |boats: &Vec<usize>| boats.contains(&boat);
        FIRST_AGENT
            + self
                .agents
                .iter()
                .position(has)
                .expect("every boat has an agent")
    }
}

/// The results of undisturbed games in one process, by game, seed and length. Orders that arrive in
/// time never expire.
static UNDISTURBED: Mutex<BTreeMap<(usize, u64, u32), String>> = Mutex::new(BTreeMap::new());

fn undisturbed(plan: &Plan) -> String {
    let key = (plan.game, plan.game_seed, plan.duration_s);
    if let Some(known) = UNDISTURBED.lock().get(&key) {
        return known.clone();
    }
    let scenario = plan.scenario();
    let outcome = arena::play(&scenario, agent::minds_of(&scenario), plan.game_seed)
        .unwrap_or_else(|e| panic!("{e}"));
    UNDISTURBED.lock().insert(key, outcome.digest.clone());
    outcome.digest
}

fn has_lost_agents(outcome: &Outcome) -> bool {
    outcome
        .events
        .iter()
        .any(|event| event.event == "agent_lost")
}

/// A lockstep game must equal the game played without a network, unless an agent was lost.
fn check_digest(plan: &Plan, played: &Played, report: &Report) -> Option<String> {
    let words_lost = plan.talks() && played.refused.of(Refusal::TeamMessageMissing) > 0;
    let is_other =
        plan.forges() || has_lost_agents(&report.outcome) || words_lost || report.run.cut_short;
    if plan.pace != Pace::Lockstep || is_other {
        return None;
    }
    let want = undisturbed(plan);
    let got = &report.outcome.digest;
    (*got != want).then(|| format!("digest {got} is not that of the undisturbed game, {want}"))
}

/// No boat may lose an agent that was connected.
fn unjust_losses(plan: &Plan, played: &Played, outcome: &Outcome) -> Vec<String> {
    if plan.forges() {
        return vec![];
    }
    let is_lossy = plan.conditions.loss > 0.0 || plan.conditions.damaged.0 > 0.0;
    let margin = if is_lossy { SENT_OFTEN } else { SENT_AGAIN };
    let enough = plan.patience().saturating_sub(margin);
    // A suspended sim must not report its agents as lost; cutting off the sim cuts off all others.
    let is_excused = |node: usize| {
        let absent = plan.longest_absence(node, node == SIM);
        absent > Duration::ZERO && absent >= enough
    };
    let lost = outcome
        .events
        .iter()
        .filter(|event| event.event == "agent_lost");
    let mut wrong = Vec::new();
    for event in lost {
        let name = event.vehicle.clone().unwrap_or_default();
        let boat = played
            .scenario
            .vehicle_by_name(&name)
            .expect("a boat of the game")
            .index();
        if !is_excused(plan.agent_of(boat)) && !is_excused(SIM) {
            wrong.push(format!(
                "{name} lost its agent at {} s of the game, although it was connected",
                event.at_s
            ));
        }
    }
    wrong
}

/// A killed agent is reported lost within patience, and all agents are present after the faults.
fn check_presence(plan: &Plan, played: &Played) -> Vec<String> {
    let mut wrong = Vec::new();
    let Some((first_frame, last_frame)) = played.monitor.frames else {
        return wrong;
    };
    let sim_is_well = plan.longest_absence(SIM, false).is_zero();
    let all_are_back =
        plan.faults_end().max(first_frame) + plan.conditions.lease + plan.patience() + BACK;
    for (boat, lost) in played.monitor.lost.iter().enumerate() {
        let node = plan.agent_of(boat);
        let died = plan.faults.iter().find_map(|(at, fault)| match fault {
            Fault::Kill {
                node: who,
                restart: None,
            } if *who == node => Some(*at),
            _ => None,
        });
        match died {
            Some(died) => {
                let due = died + plan.patience() + SHOWS;
                let is_in_time = lost.is_some_and(|(first, _)| first <= due);
                if sim_is_well && died > first_frame && last_frame > due && !is_in_time {
                    wrong.push(format!("boat {boat} lost its agent at {died:?}, and was seen without it at {lost:?}"));
                }
            }
            None => {
                let late = lost.filter(|(_, last)| *last > all_are_back);
                if let Some((_, last)) = late.filter(|_| !plan.forges()) {
                    wrong.push(format!(
                        "boat {boat} has no agent at {last:?}, although faults were over at {:?}",
                        plan.faults_end()
                    ));
                }
            }
        }
    }
    wrong
}

/// No node exits during the game, and all exit after it.
fn check_ends(plan: &Plan, played: &Played) -> Vec<String> {
    let mut wrong = Vec::new();
    let ended = |name: &str| {
        played
            .run
            .ends
            .iter()
            .rfind(|end| end.node == name)
            .map(|end| end.at)
    };
    let Some(sim_ended) = ended("sim") else {
        return vec!["the sim never ends".to_owned()];
    };
    if played.run.time > sim_ended.max(plan.faults_end()) + LEFT {
        wrong.push(format!(
            "the sim ended at {sim_ended:?}, the last node at {:?}",
            played.run.time
        ));
    }
    for (agent, result) in &played.agents {
        let Err(reason) = result else { continue };
        let end = played
            .run
            .ends
            .iter()
            .find(|end| end.node == format!("agent {agent}") && !end.was_killed);
        let is_early = end.is_some_and(|end| end.at < sim_ended);
        if is_early && !plan.forges() {
            wrong.push(format!("agent {agent} exits during the game: {reason}"));
        } else if plan.faults.is_empty() && !plan.forges() {
            // Even without faults, some messages are lost.
            wrong.push(format!(
                "agent {agent} misses the end of the game: {reason}"
            ));
        }
    }
    wrong
}
