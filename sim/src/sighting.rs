//! Delayed and noisy sightings of other boats by a team's boats, within range and field of view.
//!
//! Used only if the rules limit sharing; otherwise everything is shown at once. A boat reports its
//! sightings, so over a radio link they are late or lost with the report. The error of a sighting,
//! and whether it is lost, is drawn once per decision for each team and sighted boat, whichever
//! boat of the team sees it.

use messages::picture::Contact;
use primitives::SimTime;
use primitives::angle::wrap_pi;
use primitives::frame::{Ned, Pose};
use primitives::reseed::TimedNoise;
use primitives::stream::Noise;
use rules::Sharing;
use scenario::Scenario;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

#[derive(Clone)]
pub(crate) struct Sightings {
    sharing: Sharing,
    /// Decisions between a sighting and its report.
    late: u64,
    /// Noises, by vehicle index.
    noises: Vec<TimedNoise>,
    /// The time between two decisions.
    decision: SimTime,
    pub(crate) state: SightingState,
    /// Reused buffers.
    spare: Vec<Vec<Contact>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SightingState {
    /// The true states at the decisions whose sightings may still be reported, oldest first.
    past: VecDeque<Truths>,
    /// The last report, by team and vehicle index.
    known: Vec<Vec<Option<Contact>>>,
}

/// The true state of every boat at one decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Truths {
    decision: u64,
    boats: Vec<Contact>,
}

impl Sightings {
    /// The sightings for this scenario, if the rules limit sharing.
    pub(crate) fn new(scenario: &Scenario) -> Option<Sightings> {
        let sharing = scenario.rules.sharing.clone();
        if sharing == Sharing::default() {
            return None;
        }
        let decision = scenario.decision();
        let seeds = scenario.seeds();
        let noise = |name: &str| seeds.noise(&format!("contact/{name}"));
        Some(Sightings {
            late: (sharing.delay_s / decision.as_s()).round() as u64,
            decision,
            state: SightingState {
                past: VecDeque::new(),
                known: vec![vec![None; scenario.vehicles.len()]; scenario.teams.len()],
            },
            spare: vec![],
            noises: scenario
                .vehicles
                .iter()
                .map(|vehicle| noise(&vehicle.name))
                .collect(),
            sharing,
        })
    }

    /// Records every boat's true state at a decision. Reports from before the decision `oldest` can
    /// no longer arrive.
    pub(crate) fn record_truth(
        &mut self,
        decision: u64,
        oldest: u64,
        boats: impl Iterator<Item = Contact>,
    ) {
        let oldest = oldest.saturating_sub(self.late);
        while let Some(past) = self.state.past.pop_front_if(|past| past.decision < oldest) {
            self.spare.push(past.boats);
        }
        // Reuse a buffer, so that a tick allocates nothing.
        let mut now = self.spare.pop().unwrap_or_default();
        now.clear();
        now.extend(boats);
        self.state.past.push_back(Truths {
            decision,
            boats: now,
        });
    }

    /// Applies the report that `seer` sent at `decision`: its team learns what `seer` had seen.
    pub(crate) fn show_sightings(&mut self, seer: usize, decision: u64) {
        let Sightings {
            sharing,
            late,
            noises,
            decision: length,
            state: SightingState { past, known },
            ..
        } = self;
        let seen_at = decision.checked_sub(*late);
        let Some(place) =
            seen_at.and_then(|at| past.binary_search_by_key(&at, |past| past.decision).ok())
        else {
            return;
        };
        let boats = &past[place].boats;
        let own = &boats[seer];
        let teams = known.len() as u64;
        let known = &mut known[own.team.index()];
        // Drawn by team, not by seer, so that two sightings of a boat do not average out the noise.
        let draw = 4 * (decision * teams + own.team.index() as u64);
        for (seen, known) in boats
            .iter()
            .zip(known)
            .filter(|(seen, _)| seen.team != own.team)
        {
            // Another boat may already have reported the same or a later sighting.
            let is_news = known.is_none_or(|known| known.seen_ns < seen.seen_ns);
            let noise = noises[seen.vehicle.index()].at(*length * decision as i64);
            if is_news && sees(sharing, own, seen) && noise.unit(draw) >= sharing.loss {
                *known = Some(blurred(sharing, *seen, noise, draw));
            }
        }
    }

    /// A team's knowledge of a vehicle at `now`.
    pub(crate) fn of(&self, team: usize, vehicle: usize, now: SimTime) -> Option<Contact> {
        let remembered =
            |contact: &Contact| now.as_s() - contact.seen_ns.as_s() <= self.sharing.memory_s;
        self.state.known[team][vehicle].filter(remembered)
    }
}

/// Whether one boat sees another.
fn sees(sharing: &Sharing, own: &Contact, other: &Contact) -> bool {
    let at = |contact: &Contact| Ned {
        north: contact.north_m,
        east: contact.east_m,
    };
    let is_near = sharing
        .range_m
        .is_none_or(|range_m| at(own).distance(at(other)) <= range_m);
    let pose = Pose {
        at: at(own),
        psi_rad: own.psi_rad,
    };
    let off_bow_rad = || wrap_pi(pose.at.bearing_rad(at(other)) - pose.psi_rad).abs();
    is_near
        && sharing
            .view_rad
            .is_none_or(|view_rad| off_bow_rad() <= 0.5 * view_rad)
}

fn blurred(sharing: &Sharing, seen: Contact, noise: Noise, draw: u64) -> Contact {
    // A normal pair uses the uniform numbers at twice its index; the offset keeps them apart from
    // those that are used directly.
    let (north, east) = noise.normal_pair(draw / 2 + (1 << 60));
    let (velocity_north, velocity_east) = noise.normal_pair(draw / 2 + 1 + (1 << 60));
    Contact {
        north_m: seen.north_m + sharing.noise_m * north,
        east_m: seen.east_m + sharing.noise_m * east,
        velocity_north_m_s: seen.velocity_north_m_s + sharing.velocity_noise_m_s * velocity_north,
        velocity_east_m_s: seen.velocity_east_m_s + sharing.velocity_noise_m_s * velocity_east,
        ..seen
    }
}
