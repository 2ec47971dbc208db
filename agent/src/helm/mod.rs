//! The helm of one boat: it goes by a strategy's program, and decides course and speed by interval programming.
//!
//! A decision is: take in the picture, apply the rules, choose the mode, ask every behaviour that may run what it wants,
//! and take the course and speed with the largest weighted sum of utilities. Values that behaviours post become known
//! when all have been asked, so that their order does not matter.

mod bid;
mod chart;
mod life;
mod report;
mod scene;
mod talk;

pub(crate) use bid::Bid;
pub(crate) use chart::Chart;
pub(crate) use scene::{Other, Scene, Spot};

use crate::behaviour::{Conduct, conduct_of};
use crate::ivp::{Choice, Decision, Grid, Problem, Wish};
use crate::{Mind, Proposal};
use bid::Entry;
use game::helm::HelmReport;
use game::message::Word;
use game::scenario::Scenario;
use game::strategy::{Expression, Moment, Program, Proposer, Rule, What, Who};
use game::{Event, Order, Picture, SimTime, VehicleId};
use life::Life;
use scene::Proposed;
use talk::Ears;

/// A behaviour at work.
struct Worker {
    life: Life,
    conduct: Box<dyn Conduct>,
    weight: f64,
}

/// What was decided last.
#[derive(Clone, Copy, Debug)]
enum Decided {
    /// Nothing yet, or the boat holds, and why.
    Hold(&'static str),
    /// A course and a speed.
    Steer(Choice),
}

/// A mind that goes by a program.
pub struct HelmMind {
    program: Program,
    scene: Scene,
    mode: Option<usize>,
    workers: Vec<Worker>,
    problem: Problem,
    entries: Vec<Entry>,
    /// Values posted in this decision, to be known when all behaviours have been asked.
    posted: Vec<(u16, f64)>,
    decided: Decided,
    /// Whether somebody looks.
    shown: bool,
}

impl HelmMind {
    /// The helm of a vehicle that goes by `program`.
    #[must_use]
    pub fn new(scenario: &Scenario, vehicle: VehicleId, program: &Program) -> HelmMind {
        let chart = Chart::new(scenario, vehicle, program);
        let grid = Grid::new(program.helm.courses, program.helm.speeds, chart.speed_max_m_s);
        let ears = Ears::new(program, &chart.mates);
        let worker = |task| Worker { life: Life::new(), conduct: conduct_of(task), weight: 0.0 };
        HelmMind {
            workers: program.behaviours.iter().map(|behaviour| worker(&behaviour.task)).collect(),
            scene: Scene::new(chart, program, ears),
            mode: None,
            problem: Problem::new(grid),
            entries: Vec::new(),
            posted: Vec::new(),
            decided: Decided::Hold("nothing decided yet"),
            shown: false,
            program: program.clone(),
        }
    }

    /// Rules give values to variables, one after the other.
    fn apply_rules(&mut self, picture: &Picture) {
        for rule in &self.program.rules {
            if is_due(rule, &self.scene, picture) {
                set(&mut self.scene, &rule.set, &mut self.posted);
            }
        }
    }

    fn choose_mode(&mut self) {
        let mode = self.program.leaf(&self.scene);
        let before = self.mode.replace(mode);
        if before == Some(mode) {
            return;
        }
        self.scene.mode_since = self.scene.now;
        // Modes that begin, outermost first; parents stand before their children.
        for (i, entered) in self.program.modes.iter().enumerate() {
            if is_within(&self.program, mode, i) && !before.is_some_and(|before| is_within(&self.program, before, i)) {
                set(&mut self.scene, &entered.enter, &mut self.posted);
            }
        }
    }

    /// Asks all behaviours; says whether one wants the boat stopped.
    fn ask_behaviours(&mut self, mode: usize) -> bool {
        let (scene, posted) = (&self.scene, &mut self.posted);
        let mut stop = false;
        self.problem.clear();
        self.entries.clear();
        for (i, (behaviour, worker)) in self.program.behaviours.iter().zip(&mut self.workers).enumerate() {
            let mut post = |moment: Moment| {
                let due = behaviour.posts.iter().filter(|post| post.at == moment);
                posted.extend(due.map(|post| (post.variable, post.value.value(scene))));
            };
            let may_run = behaviour.modes[mode] && behaviour.when.as_ref().is_none_or(|when| when.is_true(scene));
            if worker.life.allow(may_run, scene.now, &mut post) {
                worker.conduct.begin(scene);
            }
            worker.weight = 0.0;
            if !worker.life.runs() {
                continue;
            }
            worker.weight = behaviour.weight.value(scene);
            let mut bid = Bid::new(&mut self.problem, &mut self.entries, (i, worker.weight), self.shown);
            worker.conduct.act(scene, &mut bid);
            let Bid { active, reached, mut complete, .. } = bid;
            stop |= bid.stop;
            worker.life.asked(active, &mut post);
            let time_is_up =
                |duration: &game::strategy::Parameter| worker.life.running_s(scene.now) + 1e-9 >= duration.value(scene);
            let time_is_up = behaviour.duration_s.as_ref().is_some_and(time_is_up);
            if reached || time_is_up {
                post(Moment::Reach);
            }
            complete |= time_is_up;
            if complete {
                worker.life.complete(behaviour.perpetual, &mut post);
            }
        }
        for (variable, value) in self.posted.drain(..) {
            self.scene.variables[usize::from(variable)] = value;
        }
        stop
    }

    fn solve(&mut self, stop: bool) -> Decided {
        if stop {
            return Decided::Hold("stopped by a behaviour");
        }
        if self.problem.is_empty() {
            return Decided::Hold("no behaviour asks for anything");
        }
        if !self.problem.decides_course() {
            return Decided::Hold("no behaviour asks for a course");
        }
        if !self.problem.decides_speed() {
            return Decided::Hold("no behaviour asks for a speed");
        }
        let last = match self.decided {
            Decided::Steer(choice) => Some(choice.decision),
            Decided::Hold(_) => None,
        };
        let hysteresis = self.program.helm.hysteresis;
        let nav = &self.scene.own.nav;
        Decided::Steer(self.problem.solve(Wish {
            course_rad: nav.psi_rad,
            speed_m_s: nav.surge_m_s,
            keep: last.filter(|_| hysteresis > 0.0).map(|last| (last, hysteresis)),
        }))
    }

    fn order(&self) -> Order {
        match self.decided {
            Decided::Hold(_) => Order::Hold,
            Decided::Steer(Choice { decision: Decision { course, speed }, .. }) => Order::Steer {
                heading_rad: game::angle::wrap_pi(self.problem.grid().course_rad(usize::from(course))),
                speed_m_s: self.problem.grid().speed_m_s(usize::from(speed)),
            },
        }
    }
}

impl Mind for HelmMind {
    fn decide(&mut self, picture: &Picture) -> Order {
        if !self.scene.take(picture) {
            self.decided = Decided::Hold("the picture does not show the own boat");
            self.entries.clear();
            self.workers.iter_mut().for_each(|worker| worker.weight = 0.0);
            return Order::Hold;
        }
        self.apply_rules(picture);
        self.choose_mode();
        let stop = self.mode.is_none_or(|mode| self.ask_behaviours(mode));
        self.decided = self.solve(stop);
        self.order()
    }

    fn talks(&self) -> bool {
        self.scene.ears.talks()
    }

    fn proposer(&self) -> Option<Proposer> {
        self.program.proposer()
    }

    fn say(&self, words: &mut Vec<Word>) {
        self.scene.ears.say(self.scene.chart.me, &self.scene.variables, words);
    }

    fn hear(&mut self, words: &[Word]) {
        self.scene.ears.hear(words);
    }

    fn propose(&mut self, at: SimTime, proposal: Proposal) {
        self.scene.proposed = Some(Proposed { at, proposal });
    }

    fn show(&mut self, shown: bool) {
        self.shown = shown;
    }

    fn report(&self) -> Option<HelmReport> {
        Some(self.reported())
    }
}

/// Whether `mode` is `whole` or a part of it.
fn is_within(program: &Program, mode: usize, whole: usize) -> bool {
    mode == whole || program.modes[mode].parent.is_some_and(|parent| is_within(program, parent, whole))
}

/// Gives values to variables: all are worked out before the first is given.
fn set(scene: &mut Scene, values: &[(u16, Expression)], scratch: &mut Vec<(u16, f64)>) {
    scratch.clear();
    scratch.extend(values.iter().map(|(variable, value)| (*variable, value.value(scene))));
    for (variable, value) in scratch.drain(..) {
        scene.variables[usize::from(variable)] = value;
    }
}

fn is_due(rule: &Rule, scene: &Scene, picture: &Picture) -> bool {
    let happened = rule.on.is_none_or(|trigger| {
        let events = picture.events.iter().filter_map(|record| record.logged());
        events
            .flat_map(|logged| happening(logged.event, trigger.what))
            .flatten()
            .any(|vehicle| who(scene, vehicle) == trigger.who)
    });
    happened && rule.when.as_ref().is_none_or(|when| when.is_true(scene))
}

/// The boats that do or suffer this, if the event is it.
fn happening(event: Event, what: What) -> [Option<VehicleId>; 2] {
    use game::event::TagCause;
    let one = match (what, event) {
        (What::Collides, Event::Collided { first, second, .. }) => return [Some(first), Some(second)],
        (What::Grabs, Event::Grabbed { vehicle, .. })
        | (What::Captures, Event::Captured { vehicle, .. })
        | (What::LosesFlag, Event::FlagReturned { vehicle, .. })
        | (What::IsTagged, Event::Tagged { vehicle, .. })
        | (What::IsUntagged, Event::Untagged { vehicle })
        | (What::LeavesField, Event::LeftField { vehicle })
        | (What::ReturnsToField, Event::ReturnedToField { vehicle })
        | (What::Tags, Event::Tagged { cause: TagCause::Opponent(vehicle), .. }) => Some(vehicle),
        _ => None,
    };
    [one, None]
}

fn who(scene: &Scene, vehicle: VehicleId) -> Who {
    if vehicle == scene.chart.me {
        Who::I
    } else if scene.chart.mates.contains(&vehicle) {
        Who::Mate
    } else {
        Who::Enemy
    }
}
