//! The helm of one boat: follows a strategy's program and decides course and speed by interval
//! programming.
//!
//! For a decision, the helm processes the picture, applies the rules, chooses the mode, runs every
//! behaviour that may run, and selects the course and speed with the largest weighted sum of
//! utilities. Values posted by behaviours take effect after all have run, so that their order does
//! not matter.

mod report;
mod run_state;
mod steadiness;

use crate::behaviour::{BehaviourLogic, BehaviourOutput, Functions, WeightedFunction, logic_of};
use crate::ivp::{Choice, Decision, Grid, Preference};
use crate::mind::{Mind, Proposal};
use crate::situation::{Situation, TeamView};
use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use primitives::VehicleId;
use rules::Event;
use rules::event::EventRecord;
use run_state::BehaviourRun;
use scenario::Scenario;
use scenario::fault::{Fault, FaultKind};
use scenario::strategy::{Expression, Moment, Parameter, Program, Proposer, Rule, Task, What, Who};
use std::sync::Arc;
use steadiness::Steadiness;

/// Speed up to which an order counts as an order to stand still, m/s.
const STANDING_M_S: f64 = 0.5;

/// A behaviour of the program.
#[derive(Clone)]
struct BehaviourInstance {
    run: BehaviourRun,
    logic: Box<dyn BehaviourLogic>,
    /// The behaviour's weight at the last decision; 0 if the behaviour did not run.
    weight: f64,
}

/// The last decision.
#[derive(Clone, Copy, Debug)]
enum Decided {
    /// No decision yet, or the boat holds, for the given reason.
    Hold(&'static str),
    /// A course and a speed.
    Steer(Choice),
}

/// A mind that follows a program.
#[derive(Clone)]
pub struct HelmMind {
    program: Program,
    pub(crate) situation: Situation,
    /// The mode of the last decision, by index in the program.
    pub(crate) mode: Option<usize>,
    instances: Vec<BehaviourInstance>,
    functions: Functions,
    /// Values posted at this decision; they take effect after all behaviours have run.
    posted: Vec<(u16, f64)>,
    decided: Decided,
    /// Creates the helm that replaces this one after a fault that kills the agent, if the scenario
    /// has such faults.
    restarted: Option<Arc<dyn Fn() -> HelmMind + Send + Sync>>,
}

impl HelmMind {
    /// The helm of a vehicle that follows `program`.
    pub fn new(scenario: &Scenario, vehicle: VehicleId, program: &Program) -> HelmMind {
        let situation = Situation::new(scenario, vehicle, program, program.helm.compensates_drift);
        let grid = Grid::new(
            program.helm.courses,
            program.helm.speeds,
            situation.model.speed_max_m_s,
        );
        let instance = |task| BehaviourInstance {
            run: BehaviourRun::new(),
            logic: logic_of(task),
            weight: 0.0,
        };
        HelmMind {
            instances: program
                .behaviours
                .iter()
                .map(|behaviour| instance(&behaviour.task))
                .collect(),
            situation,
            mode: None,
            functions: Functions::new(grid),
            posted: Vec::new(),
            decided: Decided::Hold("no decision yet"),
            program: program.clone(),
            restarted: None,
        }
    }

    /// Like [`HelmMind::new`], but loses its memory at each fault of the scenario that kills the
    /// vehicle's agent, as a restarted process does.
    pub(crate) fn restarting(
        scenario: &Scenario,
        vehicle: VehicleId,
        program: &Program,
    ) -> HelmMind {
        let mut helm = HelmMind::new(scenario, vehicle, program);
        let is_killed =
            |fault: &Fault| fault.kind == FaultKind::AgentLost && fault.vehicles.contains(&vehicle);
        // Keep the scenario only if a fault requires it: in a fleet, a copy for each boat would be
        // too expensive.
        if scenario.faults.iter().any(is_killed) {
            let scenario = scenario.clone();
            let program = program.clone();
            helm.restarted = Some(Arc::new(move || {
                HelmMind::new(&scenario, vehicle, &program)
            }));
        }
        helm
    }

    /// Starts afresh if the picture reports that the agent is back.
    fn restart_if_back(&mut self, picture: &Picture) {
        let back = Event::AgentBack(self.situation.model.me);
        let is_back =
            |record: &EventRecord| record.logged().is_some_and(|logged| logged.event == back);
        if let Some(restarted) = self
            .restarted
            .take_if(|_| picture.events.iter().any(is_back))
        {
            // The arena does not kill processes, and its result must match that of separate
            // processes, so the mind forgets what a restarted process would forget.
            let shown = self.functions.shown;
            *self = restarted();
            self.functions.shown = shown;
            self.restarted = Some(restarted);
        }
    }

    /// Observes the picture before deciding on it.
    pub(crate) fn preview(&mut self, picture: &Picture) {
        self.situation.preview(picture);
    }

    /// Selects the option requested from outside, if the program has options.
    pub(crate) fn choose(&mut self, option: usize) {
        if let Some(variable) = self
            .program
            .options()
            .filter(|variable| option < self.program.texts(*variable).len())
        {
            self.situation.variables[usize::from(variable)] = option as f64;
        }
    }

    /// Lets behaviours observe the situation and policies choose options, before rules apply.
    fn observe_situation(&mut self) {
        for instance in &mut self.instances {
            instance.logic.observe(&self.situation);
            if let Some((variable, option)) = instance.logic.option() {
                self.situation.variables[usize::from(variable)] = option as f64;
            }
        }
    }

    /// Applies the rules to the variables in order.
    fn apply_rules(&mut self, picture: &Picture) {
        for rule in &self.program.rules {
            if is_due(rule, &self.situation, picture) {
                // Unlike posts by behaviours, rules take effect from top to bottom: a later rule
                // sees the values set by an earlier one.
                set(&mut self.situation, &rule.set, &mut self.posted);
            }
        }
    }

    fn choose_mode(&mut self) {
        // The first part of a mode whose condition holds is active. The last part has no condition,
        // so exactly one leaf is active. In MOOS the last part that holds is active, and possibly
        // none.
        let mode = self.program.leaf(&self.situation);
        let before = self.mode.replace(mode);
        if before == Some(mode) {
            return;
        }
        self.situation.mode_since = self.situation.now;
        // Modes that begin, outermost first: parents precede their children.
        for (i, entered) in self.program.modes.iter().enumerate() {
            if is_within(&self.program, mode, i)
                && !before.is_some_and(|before| is_within(&self.program, before, i))
            {
                set(&mut self.situation, &entered.enter, &mut self.posted);
            }
        }
    }

    /// Runs all behaviours that may run. Returns whether one requires the boat to stop.
    fn run_behaviours(&mut self, mode: usize) -> bool {
        let situation = &self.situation;
        let posted = &mut self.posted;
        let mut stop = false;
        self.functions.clear();
        for (i, (behaviour, instance)) in self
            .program
            .behaviours
            .iter()
            .zip(&mut self.instances)
            .enumerate()
        {
            let mut post = |moment: Moment| {
                let due = behaviour.posts.iter().filter(|post| post.at == moment);
                posted.extend(due.map(|post| (post.variable, post.value.value(situation))));
            };
            let BehaviourInstance { run, logic, weight } = instance;
            let may_run = behaviour.modes[mode]
                && behaviour
                    .when
                    .as_ref()
                    .is_none_or(|when| when.is_true(situation));
            if run.allow(may_run, situation.now, &mut post) {
                logic.begin(situation);
            }
            *weight = 0.0;
            if !run.runs() {
                continue;
            }
            *weight = behaviour.weight.value(situation);
            let mut output = BehaviourOutput::new(&mut self.functions, i, *weight);
            logic.run(situation, &mut output);
            stop |= output.stop;
            let BehaviourOutput {
                active,
                reached,
                complete,
                ..
            } = output;
            run.produced(active, &mut post);
            let is_over = |duration: &Parameter| {
                run.running_s(situation.now) + 1e-9 >= duration.value(situation)
            };
            let time_is_up = behaviour.duration_s.as_ref().is_some_and(is_over);
            if reached || time_is_up {
                post(Moment::Reach);
            }
            if complete || time_is_up {
                run.complete(behaviour.perpetual, &mut post);
            }
        }
        for (variable, value) in self.posted.drain(..) {
            self.situation.variables[usize::from(variable)] = value;
        }
        stop
    }

    fn solve(&mut self, stop: bool) -> Decided {
        if stop {
            return Decided::Hold("stopped by a behaviour");
        }
        let problem = &mut self.functions.problem;
        if problem.is_empty() {
            return Decided::Hold("no behaviour has a preference");
        }
        // Without a preferred course, the decision would be the first course on the grid, which is
        // north.
        if !problem.decides_course {
            return Decided::Hold("no behaviour prefers a course");
        }
        if !problem.decides_speed {
            return Decided::Hold("no behaviour prefers a speed");
        }
        let last = match self.decided {
            Decided::Steer(choice) => Some(choice.decision),
            Decided::Hold(_) => None,
        };
        // The bonus is a fraction of the weights, at most a tenth (checked when the file is
        // loaded): it can delay a change of mind, but not outweigh safety. Edges do not count: they
        // do not move, so noise causes no changes of mind near them, and counting them would keep a
        // boat near an edge when it is needed elsewhere. Nor does an order to stand still near an
        // obstacle count: a way around is worth little more, so boats would wait in front of the
        // obstacle.
        let moves = |function: &&WeightedFunction| {
            !matches!(
                self.program.behaviours[function.behaviour].task,
                Task::OpRegion(_)
            )
        };
        let is_obstacle = |function: &WeightedFunction| {
            let task = &self.program.behaviours[function.behaviour].task;
            matches!(task, Task::AvoidObstacle(_))
        };
        let last = last.filter(|last| {
            problem.grid().speed_m_s(last.speed) > STANDING_M_S
                || !self.functions.list.iter().any(is_obstacle)
        });
        let weights: f64 = self
            .functions
            .list
            .iter()
            .filter(moves)
            .map(|function| function.weight)
            .sum();
        let steadiness = last.and_then(|last| {
            Steadiness::new(problem, last, self.program.helm.hysteresis * weights)
        });
        let nav = &self.situation.own.nav;
        let speed_m_s = nav.surge_m_s - self.situation.motion.drift().dot(self.situation.ahead);
        // Ties go to the course and speed nearest to the boat's current motion, so that the start
        // of the grid has no influence.
        let choice = problem.solve(Preference {
            course_rad: nav.psi_rad,
            speed_m_s,
        });
        Decided::Steer(steadiness.map_or(choice, |steadiness| {
            steadiness.without(problem.grid(), choice)
        }))
    }

    fn order(&mut self) -> Order {
        match self.decided {
            Decided::Hold(_) => {
                // An order given before a hold says nothing about the current heading offset.
                self.situation.motion.hold();
                Order::Hold
            }
            Decided::Steer(Choice {
                decision: Decision { course, speed },
                ..
            }) => {
                let grid = self.functions.problem.grid();
                let heading_rad = grid.course_rad(course);
                let speed_m_s = grid.speed_m_s(speed);
                self.situation.motion.order(heading_rad, speed_m_s)
            }
        }
    }
}

impl Mind for HelmMind {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.decide_in_team(picture, None)
    }

    fn team_view(&self) -> Option<TeamView> {
        Some(TeamView::clone(&self.situation.view))
    }

    fn decide_in_team(&mut self, picture: &Picture, view: Option<&Arc<TeamView>>) -> Order {
        self.restart_if_back(picture);
        if !self.situation.update(picture, view) {
            self.decided = Decided::Hold("this boat is missing from the picture");
            self.situation.motion.hold();
            self.functions.clear();
            self.instances
                .iter_mut()
                .for_each(|instance| instance.weight = 0.0);
            return Order::Hold;
        }
        self.observe_situation();
        self.apply_rules(picture);
        self.choose_mode();
        let stop = self.mode.is_none_or(|mode| self.run_behaviours(mode));
        self.decided = self.solve(stop);
        self.order()
    }

    fn fork(&self) -> Option<Box<dyn Mind>> {
        Some(Box::new(self.clone()))
    }

    fn shares(&self) -> bool {
        self.situation.team_messages.shares()
    }

    fn proposer(&self) -> Option<Proposer> {
        self.program.proposer()
    }

    fn send(&self, messages: &mut Vec<Word>) {
        self.situation.team_messages.send(
            self.situation.model.me,
            &self.situation.variables,
            messages,
        );
    }

    fn receive(&mut self, messages: &[Word]) {
        self.situation.team_messages.receive(messages);
    }

    fn propose(&mut self, proposal: Proposal) {
        self.situation.proposed = Some(proposal);
    }

    fn show(&mut self, shown: bool) {
        self.functions.shown = shown;
    }

    fn report(&self) -> Option<HelmReport> {
        Some(self.reported())
    }
}

/// Whether `mode` is `whole` or a part of it.
fn is_within(program: &Program, mode: usize, whole: usize) -> bool {
    mode == whole
        || program.modes[mode]
            .parent
            .is_some_and(|parent| is_within(program, parent, whole))
}

/// Assigns values to variables. Evaluates all expressions before the first assignment.
fn set(situation: &mut Situation, values: &[(u16, Expression)], scratch: &mut Vec<(u16, f64)>) {
    scratch.clear();
    scratch.extend(
        values
            .iter()
            .map(|(variable, value)| (*variable, value.value(situation))),
    );
    for (variable, value) in scratch.drain(..) {
        situation.variables[usize::from(variable)] = value;
    }
}

fn is_due(rule: &Rule, situation: &Situation, picture: &Picture) -> bool {
    // Use the picture's events rather than comparing facts: if a picture is lost, its events arrive
    // with the next.
    let happened = rule.on.is_none_or(|trigger| {
        let events = picture.events.iter().filter_map(|record| record.logged());
        events
            .flat_map(|logged| happening(logged.event, trigger.what))
            .flatten()
            .any(|vehicle| who(situation, vehicle) == trigger.who)
    });
    happened
        && rule
            .when
            .as_ref()
            .is_none_or(|when| when.is_true(situation))
}

/// The boats involved in an event, if it is of the given kind.
fn happening(event: Event, what: What) -> [Option<VehicleId>; 2] {
    match (what, event) {
        (What::Collides, Event::Collided { .. }) => [event.vehicle(), event.other()],
        (What::Tags, Event::Tagged { .. }) => [event.other(), None],
        (What::Grabs, Event::Grabbed { .. })
        | (What::Captures, Event::Captured { .. })
        | (What::LosesFlag, Event::FlagReturned { .. })
        | (What::IsTagged, Event::Tagged { .. })
        | (What::IsUntagged, Event::Untagged(_))
        | (What::LeavesField, Event::LeftField(_))
        | (What::ReturnsToField, Event::ReturnedToField(_)) => [event.vehicle(), None],
        _ => [None, None],
    }
}

fn who(situation: &Situation, vehicle: VehicleId) -> Who {
    if vehicle == situation.model.me {
        Who::I
    } else if situation.model.mates.contains(&vehicle) {
        Who::Mate
    } else {
        Who::Enemy
    }
}
