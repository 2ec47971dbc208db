//! A mind whose agent is killed during a game and returns: it starts afresh, as a restarted process
//! does.

use crate::helm::HelmMind;
use crate::mind::{Mind, Proposal};
use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use primitives::VehicleId;
use rules::Event;
use rules::event::EventRecord;
use scenario::Scenario;
use scenario::fault::FaultKind;
use scenario::strategy::{Program, Proposer};

/// The mind of a vehicle that follows `program`. If the scenario has faults that kill its agent,
/// the mind loses its memory at each.
pub(crate) fn helm_of(scenario: &Scenario, vehicle: VehicleId, program: &Program) -> Box<dyn Mind> {
    let is_killed =
        |fault: &scenario::fault::Fault| fault.kind == FaultKind::AgentLost && fault.vehicles.contains(&vehicle);
    let helm = HelmMind::new(scenario, vehicle, program);
    // Only if a fault requires it: a copy of the scenario for each boat would be too expensive in a
    // fleet.
    if !scenario.faults.iter().any(is_killed) {
        return Box::new(helm);
    }
    let (scenario, program) = (scenario.clone(), program.clone());
    let begin = Box::new(move || HelmMind::new(&scenario, vehicle, &program));
    Box::new(Restarted { vehicle, helm, begin, shown: false })
}

/// A helm that starts afresh when the picture says that its agent is back.
struct Restarted {
    vehicle: VehicleId,
    helm: HelmMind,
    begin: Box<dyn Fn() -> HelmMind + Send>,
    shown: bool,
}

impl Mind for Restarted {
    fn decide(&mut self, picture: &Picture) -> Order {
        let is_back =
            |record: &EventRecord| record.logged().is_some_and(|logged| logged.event == Event::AgentBack(self.vehicle));
        if picture.events.iter().any(is_back) {
            // The arena kills no process, and its result must match that of separate processes, so
            // the mind forgets what a process would.
            self.helm = (self.begin)();
            self.helm.show(self.shown);
        }
        self.helm.decide(picture)
    }

    fn shares(&self) -> bool {
        self.helm.shares()
    }

    fn proposer(&self) -> Option<Proposer> {
        self.helm.proposer()
    }

    fn send(&self, messages: &mut Vec<Word>) {
        self.helm.send(messages);
    }

    fn receive(&mut self, messages: &[Word]) {
        self.helm.receive(messages);
    }

    fn propose(&mut self, proposal: Proposal) {
        self.helm.propose(proposal);
    }

    fn show(&mut self, shown: bool) {
        self.shown = shown;
        self.helm.show(shown);
    }

    fn report(&self) -> Option<HelmReport> {
        self.helm.report()
    }
}
