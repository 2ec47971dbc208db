//! What a team is shown of other boats: seen by one of its own within range and view, some time ago, not quite there.
//!
//! Only games whose rules limit sharing come here; otherwise everything is shown at once.

use crate::world::World;
use game::angle::wrap_pi;
use game::frame::{Ned, Pose};
use game::link::Sharing;
use game::picture::Contact;
use game::stream::Noise;
use game::{Scenario, SimTime};
use std::collections::VecDeque;

/// Sightings of a game, by all teams.
pub(crate) struct Sightings {
    sharing: Sharing,
    /// Decisions between a sighting and its report.
    late: usize,
    /// The truth about every boat at the last decisions, the oldest first.
    past: VecDeque<Vec<Contact>>,
    /// By team and vehicle: the last report.
    known: Vec<Vec<Option<Contact>>>,
    /// By vehicle.
    noises: Vec<Noise>,
}

impl Sightings {
    /// Those of this scenario, if its rules limit what is shown.
    pub(crate) fn new(scenario: &Scenario) -> Option<Sightings> {
        let sharing = scenario.rules.sharing.clone();
        if sharing == Sharing::default() {
            return None;
        }
        let decision_s = scenario.tick.as_s() * f64::from(scenario.ticks_per_decision);
        let late = (sharing.delay_s / decision_s).round() as usize;
        let noise = |name: &str| Noise::new(scenario.seed, &format!("contact/{name}"));
        Some(Sightings {
            late,
            past: (0..=late).map(|_| Vec::with_capacity(scenario.vehicles.len())).collect(),
            known: vec![vec![None; scenario.vehicles.len()]; scenario.teams.len()],
            noises: scenario.vehicles.iter().map(|vehicle| noise(&vehicle.name)).collect(),
            sharing,
        })
    }

    /// Looks round at one decision. `contact` gives the truth about a vehicle.
    pub(crate) fn look(&mut self, world: &World, decision: u64, contact: impl Fn(usize) -> Contact) {
        let count = world.state().boats.len();
        if let Some(mut oldest) = self.past.pop_front() {
            oldest.clear();
            oldest.extend((0..count).map(contact));
            self.past.push_back(oldest);
        }
        let (Some(then), true) = (self.past.front(), decision >= self.late as u64) else { return };
        let teams = self.known.len();
        for seen in then {
            for (team, known) in self.known.iter_mut().enumerate().filter(|(team, _)| *team != seen.team.index()) {
                let is_own = |other: &&Contact| other.team.index() == team;
                let draw = 4 * (decision * teams as u64 + team as u64);
                let noise = self.noises[seen.vehicle.index()];
                let is_seen = then.iter().filter(is_own).any(|own| sees(&self.sharing, own, seen));
                if is_seen && noise.unit(draw) >= self.sharing.loss {
                    known[seen.vehicle.index()] = Some(blurred(&self.sharing, *seen, noise, draw));
                }
            }
        }
    }

    /// What a team knows of a vehicle by `now`.
    pub(crate) fn of(&self, team: usize, vehicle: usize, now: SimTime) -> Option<Contact> {
        let remembered = |contact: &Contact| now.as_s() - contact.seen_ns.as_s() <= self.sharing.memory_s;
        self.known[team][vehicle].filter(remembered)
    }
}

/// Whether one boat sees another.
fn sees(sharing: &Sharing, own: &Contact, other: &Contact) -> bool {
    let at = |contact: &Contact| Ned { north: contact.north_m, east: contact.east_m };
    let is_near = sharing.range_m.is_none_or(|range_m| at(own).distance(at(other)) <= range_m);
    let pose = Pose { at: at(own), psi_rad: own.psi_rad };
    let off_bow_rad = || wrap_pi(pose.at.bearing_rad(at(other)) - pose.psi_rad).abs();
    is_near && sharing.view_rad.is_none_or(|view_rad| off_bow_rad() <= 0.5 * view_rad)
}

fn blurred(sharing: &Sharing, seen: Contact, noise: Noise, draw: u64) -> Contact {
    // Pairs of other counts than the units: a pair takes the units of twice its count.
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
