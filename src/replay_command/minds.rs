//! What helms thought in a recorded game: minds are shown the recorded pictures again, and think the same.

use agent::{Mind, Proposal, mind_of};
use game::input::{Input, Inputs};
use game::message::{PolicyProposal, Word};
use game::picture::Picture;
use game::{Order, Scenario, SimTime, TeamId, VehicleId};
use recording::{INPUTS, Recording, picture};
use shore::page::HelmAnswer;
use shore::page::replay::Helms;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The minds of a recorded game.
pub(super) struct Minds {
    recording: Arc<Recording>,
    teams: Vec<Team>,
    /// The orders of each decision, as recorded, by vehicle.
    orders: BTreeMap<u64, Vec<(VehicleId, Order)>>,
    /// What was proposed for each vehicle, and when it came.
    proposals: BTreeMap<VehicleId, Vec<(SimTime, PolicyProposal)>>,
}

/// The minds of one team, as far as they have thought.
struct Team {
    seated: Vec<(VehicleId, Box<dyn Mind>)>,
    words: Vec<Word>,
    /// The places of the pictures, by decision.
    pictures: BTreeMap<u64, usize>,
    /// The decision they thought about last, and what they ordered.
    last: Option<(u64, Vec<(VehicleId, Order)>)>,
}

impl Minds {
    pub(super) fn new(recording: Arc<Recording>) -> Minds {
        let scenario = &recording.header().notice.scenario;
        let teams = (0..scenario.teams.len()).map(|team| Team::new(&recording, TeamId(team as u8))).collect();
        let mut orders = BTreeMap::new();
        // Inputs stand with the frame that came of them, one decision later.
        let inputs = recording.on(INPUTS).filter_map(|said| said.read::<Inputs>().ok());
        for Inputs { stamp, inputs } in inputs {
            let ordered = inputs.iter().filter_map(|record| match record.input() {
                Some(Input::Ordered { vehicle, order }) => Some((vehicle, order)),
                _ => None,
            });
            orders.insert(stamp.seq.saturating_sub(1), ordered.collect());
        }
        let proposals = (0..scenario.vehicles.len()).map(VehicleId::at).filter_map(|vehicle| {
            let topic = format!("policy/{}", scenario.vehicles[vehicle.index()].name);
            let said: Vec<_> = recording.on(&topic).filter_map(|said| Some((said.at, said.read().ok()?))).collect();
            (!said.is_empty()).then_some((vehicle, said))
        });
        Minds { teams, orders, proposals: proposals.collect(), recording: Arc::clone(&recording) }
    }

    /// What the vehicle's mind ordered at a decision when it thought again, if it could.
    fn think(&mut self, vehicle: VehicleId, decision: u64) -> Option<Order> {
        let index = self.recording.header().notice.scenario.team_of(vehicle).index();
        if self.teams[index].last.as_ref().is_some_and(|(last, _)| *last > decision) {
            // Minds do not think backwards.
            self.teams[index] = Team::new(&self.recording, TeamId(index as u8));
        }
        let team = &mut self.teams[index];
        let next = team.last.as_ref().map_or(0, |(last, _)| last + 1);
        // A mate may be asked about the decision that the team thought about last: then nothing is ahead.
        let ahead = team.pictures.range(next..).take_while(|(seq, _)| **seq <= decision);
        let ahead: Vec<(u64, usize)> = ahead.map(|(seq, place)| (*seq, *place)).collect();
        for (seq, place) in ahead {
            let picture: Picture = self.recording.message(place).read().ok()?;
            team.decide(&picture, &self.proposals, seq == decision);
        }
        let (last, orders) = team.last.as_ref()?;
        let order = orders.iter().find(|(v, _)| *v == vehicle).map(|(_, order)| *order);
        order.filter(|_| *last == decision)
    }
}

impl Team {
    fn new(recording: &Recording, team: TeamId) -> Team {
        let scenario: &Scenario = &recording.header().notice.scenario;
        let mates = (0..scenario.vehicles.len()).map(VehicleId::at).filter(|v| scenario.team_of(*v) == team);
        let topic = picture(&scenario.teams[team.index()].name);
        let decision = |place: usize| {
            let picture: Picture = recording.message(place).read().ok()?;
            Some((picture.stamp.seq, place))
        };
        Team {
            seated: mates.map(|vehicle| (vehicle, mind_of(scenario, vehicle))).collect(),
            words: Vec::new(),
            pictures: recording.places(&topic).filter_map(decision).collect(),
            last: None,
        }
    }

    /// Decides as at the table of an agent: what mates said after the decision before is heard, then proposals.
    fn decide(
        &mut self,
        picture: &Picture,
        proposals: &BTreeMap<VehicleId, Vec<(SimTime, PolicyProposal)>>,
        shown: bool,
    ) {
        let now = picture.stamp.valid_ns;
        let mut orders = Vec::new();
        for (vehicle, mind) in &mut self.seated {
            if !self.words.is_empty() {
                mind.hear(&self.words);
            }
            let said = proposals.get(vehicle).map_or(&[][..], Vec::as_slice);
            let until = said.partition_point(|(at, _)| *at <= now);
            if let Some((_, PolicyProposal { stamp, course_rad, speed_m_s, .. })) = said[..until].last() {
                let proposal = Proposal { course_rad: *course_rad, speed_m_s: *speed_m_s };
                mind.propose(stamp.valid_ns.min(now), proposal);
            }
            mind.show(shown);
            orders.push((*vehicle, mind.decide(picture).check().unwrap_or_default()));
        }
        self.words.clear();
        self.seated.iter().for_each(|(_, mind)| mind.say(&mut self.words));
        self.last = Some((picture.stamp.seq, orders));
    }
}

impl Helms for Minds {
    fn report(&mut self, vehicle: VehicleId, decision: u64, _functions: bool) -> HelmAnswer {
        let Some(order) = self.think(vehicle, decision) else {
            let reason = "no picture of this moment was recorded".to_owned();
            return HelmAnswer { reason: Some(reason), computed: true, ..HelmAnswer::default() };
        };
        let index = self.recording.header().notice.scenario.team_of(vehicle).index();
        let mind = self.teams[index].seated.iter().find(|(v, _)| *v == vehicle).map(|(_, mind)| mind);
        let recorded = self.orders.get(&decision).and_then(|orders| orders.iter().rev().find(|(v, _)| *v == vehicle));
        HelmAnswer {
            report: mind.and_then(|mind| mind.report()),
            reason: None,
            computed: true,
            agrees: recorded.map(|(_, recorded)| *recorded == order),
        }
    }
}
