//! Helm reports of a recorded game: minds receive the recorded pictures again, and reach the same
//! decisions.

use agent::{Mind, MindRunner, mind_of};
use messages::helm::HelmReport;
use messages::picture::Picture;
use messages::{Order, PolicyProposal};
use primitives::{SimTime, TeamId, VehicleId};
use recording::{Recording, picture};
use scenario::Scenario;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The minds of a recorded game.
pub(crate) struct Minds {
    recording: Arc<Recording>,
    teams: Vec<Team>,
    /// The proposals for each vehicle, and their arrival times.
    proposals: BTreeMap<VehicleId, Vec<(SimTime, PolicyProposal)>>,
}

/// The minds of one team, advanced to their last decision.
struct Team {
    runner: MindRunner,
    /// Index of the picture for each decision.
    pictures: BTreeMap<u64, usize>,
}

impl Minds {
    pub(crate) fn new(recording: Arc<Recording>) -> Minds {
        let scenario = recording.scenario();
        let teams = (0..scenario.teams.len())
            .map(|team| Team::new(&recording, TeamId(team as u8)))
            .collect();
        let proposals = (0..scenario.vehicles.len())
            .map(VehicleId::at)
            .filter_map(|vehicle| {
                let topic = format!("policy/{}", scenario.vehicles[vehicle.index()].name);
                let messages = recording.bag().on(&topic);
                let proposals: Vec<_> = messages
                    .filter_map(|message| Some((message.at, message.read().ok()?)))
                    .collect();
                (!proposals.is_empty()).then_some((vehicle, proposals))
            });
        Minds {
            teams,
            proposals: proposals.collect(),
            recording: Arc::clone(&recording),
        }
    }

    /// The helm report with the utilities of all objective functions, and the order of the
    /// vehicle's mind when it repeats this decision, if possible.
    pub(crate) fn report_of(
        &mut self,
        vehicle: VehicleId,
        decision: u64,
    ) -> Option<(HelmReport, Order)> {
        let order = self.decide(vehicle, decision, true)?;
        Some((self.report(vehicle)?, order))
    }

    /// The helm report of the vehicle's mind for its last decision.
    pub(crate) fn report(&self, vehicle: VehicleId) -> Option<HelmReport> {
        let team = &self.teams[self.recording.scenario().team_of(vehicle).index()];
        team.runner.mind(vehicle).and_then(Mind::report)
    }

    /// The order of the vehicle's mind when it repeats this decision, if possible. If `shown`, its
    /// report includes the utilities of all objective functions, which takes most of the time.
    pub(crate) fn decide(
        &mut self,
        vehicle: VehicleId,
        decision: u64,
        shown: bool,
    ) -> Option<Order> {
        let index = self.recording.scenario().team_of(vehicle).index();
        if self.teams[index].runner.decided() > Some(decision) {
            // Minds cannot go backwards, so start again.
            self.teams[index] = Team::new(&self.recording, TeamId(index as u8));
        }
        let Team { runner, pictures } = &mut self.teams[index];
        // If a query about a teammate has already advanced the team to this decision, nothing is
        // left to do.
        let next = runner.decided().map_or(0, |last| last + 1);
        for (seq, place) in pictures
            .range(next..)
            .take_while(|(seq, _)| **seq <= decision)
        {
            let picture: Picture = self.recording.bag().message(*place).read().ok()?;
            let now = picture.stamp.valid_ns;
            for proposals in self.proposals.values() {
                let until = proposals.partition_point(|(at, _)| *at <= now);
                proposals[..until]
                    .last()
                    .iter()
                    .for_each(|(_, proposal)| runner.propose(proposal, picture.stamp));
            }
            runner
                .minds_mut()
                .for_each(|(_, mind)| mind.show(shown && *seq == decision));
            runner.decide(picture.stamp, |_| Some(&picture));
        }
        let is_decided = runner.decided() == Some(decision);
        let (_, order) = runner.orders().find(|(v, _)| is_decided && *v == vehicle)?;
        Some(order.check().unwrap_or_default())
    }
}

impl Team {
    fn new(recording: &Recording, team: TeamId) -> Team {
        let scenario: &Scenario = recording.scenario();
        let mates = (0..scenario.vehicles.len())
            .map(VehicleId::at)
            .filter(|v| scenario.team_of(*v) == team);
        let topic = picture(&scenario.teams[team.index()].name);
        let decision = |place: usize| {
            let picture: Picture = recording.bag().message(place).read().ok()?;
            Some((picture.stamp.seq, place))
        };
        Team {
            runner: MindRunner::new(mates.map(|vehicle| (vehicle, mind_of(scenario, vehicle)))),
            pictures: recording
                .bag()
                .places(&topic)
                .filter_map(decision)
                .collect(),
        }
    }
}
