//! A mind controlled from outside by a trainer or a program: encodes its boat's knowledge as
//! numbers and applies the actions it receives.

use crate::helm::HelmMind;
use crate::mind::{Mind, Proposal};
use crate::observation::Observer;
use crate::policy::{BoardPolicy, Chosen};
use crate::roles::role_of;
use crate::situation::Situation;
use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use primitives::VehicleId;
use primitives::angle::wrap_pi;
use scenario::Scenario;
use scenario::action::{Action, ActionSpace, SetPoint};
use scenario::observation::ObservationSpace;
use scenario::policy::PolicyModel;
use scenario::strategy::{Fact, Mark, Place, Program, Values};
use std::collections::BTreeMap;

/// How actions reach the boat.
#[derive(Clone)]
enum Control {
    /// Directly: the boat turns as ordered until the next action, as in Pyquaticus.
    Direct(Box<Situation>),
    /// Through a helm, as a proposal weighed against safety; with a teacher, actions are ignored.
    Helm(Box<HelmMind>, Option<Teacher>),
}

/// Makes a helm play in place of the policy that imitates it: actions are ignored, and the helm's
/// own actions serve as a demonstration.
#[derive(Clone)]
struct Teacher {
    /// The option that each mode corresponds to, by mode index.
    options: Vec<Option<usize>>,
    /// The helm's first action since the last observation, if the policy could have chosen it.
    did: Option<Action>,
    is_observed: bool,
}

/// The observation and action spaces of a policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spaces {
    /// The observation space.
    pub observation: ObservationSpace,
    /// The action space.
    pub action: ActionSpace,
}

/// A mind whose decisions are made externally.
#[derive(Clone)]
pub struct Pilot {
    control: Control,
    observer: Observer,
    actions: ActionSpace,
    set_point: SetPoint,
    /// A model that decides in place of an external source.
    policy: Option<BoardPolicy>,
    /// Labels the boat's situations with a teacher's actions, which the boat does not carry out.
    adviser: Option<Box<Adviser>>,
}

/// A teacher that only demonstrates what it would do.
#[derive(Clone)]
struct Adviser {
    helm: HelmMind,
    teacher: Teacher,
}

impl Pilot {
    /// Actions become orders directly. A tagged boat is steered home regardless, because it can do
    /// nothing else.
    pub fn direct(scenario: &Scenario, vehicle: VehicleId, spaces: Spaces) -> Pilot {
        // The drift is estimated because it is part of the observation, although orders do not
        // compensate for it.
        let situation = Situation::new(scenario, vehicle, role_of(scenario, vehicle), true);
        Pilot::new(Control::Direct(Box::new(situation)), spaces)
    }

    /// Actions are proposals to the helm of `program`, which has a behaviour of kind `policy`.
    pub fn helm(
        scenario: &Scenario,
        vehicle: VehicleId,
        program: &Program,
        spaces: Spaces,
    ) -> Pilot {
        Pilot::new(
            Control::Helm(Box::new(HelmMind::new(scenario, vehicle, program)), None),
            spaces,
        )
    }

    /// Lets the strategy's program control this boat. [`Pilot::taught`] returns the action that a
    /// policy would have had to choose to match it. `options` maps each mode path to its option.
    pub fn by_teacher(
        scenario: &Scenario,
        vehicle: VehicleId,
        program: &Program,
        options: &BTreeMap<String, usize>,
        spaces: Spaces,
    ) -> Pilot {
        let teacher = Some(Teacher::new(program, options));
        Pilot::new(
            Control::Helm(Box::new(HelmMind::new(scenario, vehicle, program)), teacher),
            spaces,
        )
    }

    /// The same pilot, with a teacher that does not drive the boat: [`Pilot::taught`] returns what
    /// the strategy's program would do in the situations into which the pilot's own actions bring
    /// the boat. `options` as for [`Pilot::by_teacher`].
    pub fn advised_by(
        mut self,
        scenario: &Scenario,
        vehicle: VehicleId,
        program: &Program,
        options: &BTreeMap<String, usize>,
    ) -> Pilot {
        self.adviser = Some(Box::new(Adviser {
            helm: HelmMind::new(scenario, vehicle, program),
            teacher: Teacher::new(program, options),
        }));
        self
    }

    fn new(control: Control, spaces: Spaces) -> Pilot {
        let observer = Observer::new(spaces.observation, control.situation());
        Pilot {
            observer,
            control,
            actions: spaces.action,
            set_point: SetPoint::default(),
            policy: None,
            adviser: None,
        }
    }

    /// The same pilot, with decisions made by a model: its most likely actions, or sampled actions.
    pub fn by_model(mut self, model: PolicyModel, is_sampled: bool) -> Pilot {
        self.policy = Some(BoardPolicy::new(model, is_sampled));
        self
    }

    /// Evaluates the model, if any, when its decision is due.
    fn ask_model(&mut self, picture: &Picture) {
        let Some(policy) = self
            .policy
            .as_mut()
            .filter(|policy| policy.is_due(picture.stamp.valid_ns))
        else {
            return;
        };
        self.control.preview(picture);
        policy.choose_if_due(self.control.situation());
        if let Ok(chosen) = policy.chosen {
            self.follow(chosen);
        } else {
            // If the model outputs a non-finite value, the boat stops: otherwise the last action
            // would continue forever.
            self.set_point = SetPoint::default();
        }
    }

    fn follow(&mut self, chosen: Chosen) {
        match (chosen, &mut self.control) {
            (Chosen::SetPoint(set_point), _) => self.set_point = set_point,
            (Chosen::Option(option), Control::Helm(helm, None)) => helm.choose(option),
            (Chosen::Option(_), _) => self.set_point = SetPoint::default(),
        }
    }

    /// Processes the picture for the next decision. Returns the observation.
    pub fn observe(&mut self, picture: &Picture) -> &[f32] {
        self.control.preview(picture);
        if let Some(teacher) = self.teacher_mut() {
            (teacher.did, teacher.is_observed) = (None, true);
        }
        self.observer.observe(self.control.situation())
    }

    /// Applies this action from the next decision on.
    pub fn act(&mut self, action: Action) {
        self.follow(Chosen::of(self.actions, action, self.situation()));
    }

    /// Applies this turn and speed from the next decision on.
    pub(crate) fn steer(&mut self, set_point: SetPoint) {
        self.set_point = set_point;
    }

    /// The boat's knowledge.
    pub(crate) fn situation(&self) -> &Situation {
        self.control.situation()
    }

    /// Whether actions take effect: a tagged boat drives home, and a boat out of action stays
    /// still.
    pub fn obeys(&self) -> bool {
        let situation = self.control.situation();
        !situation.own.tagged && situation.fact(Fact::Disabled) == 0.0
    }

    /// The teacher's decision at the last observation as an action; `None` without a teacher, or if
    /// no action corresponds to it.
    pub fn taught(&self) -> Option<Action> {
        match (&self.control, &self.adviser) {
            (Control::Helm(_, Some(teacher)), _) => teacher.did,
            (_, Some(adviser)) => adviser.teacher.did,
            _ => None,
        }
    }

    fn teacher_mut(&mut self) -> Option<&mut Teacher> {
        match (&mut self.control, &mut self.adviser) {
            (Control::Helm(_, Some(teacher)), _) => Some(teacher),
            (_, Some(adviser)) => Some(&mut adviser.teacher),
            _ => None,
        }
    }

    /// The helm that exchanges messages with teammates.
    fn helm_of_messages(&self) -> Option<&HelmMind> {
        let advising = self.adviser.as_ref().map(|adviser| &adviser.helm);
        self.control.helm().or(advising)
    }
}

impl Teacher {
    fn new(program: &Program, options: &BTreeMap<String, usize>) -> Teacher {
        Teacher {
            options: (0..program.modes.len())
                .map(|mode| options.get(&program.path(mode)).copied())
                .collect(),
            did: None,
            is_observed: false,
        }
    }

    /// Records the helm's order.
    fn see(&mut self, helm: &HelmMind, order: Order, actions: ActionSpace) {
        if std::mem::take(&mut self.is_observed) {
            self.did = match actions {
                ActionSpace::Options => helm
                    .mode
                    .and_then(|mode| self.options[mode])
                    .map(Action::Discrete),
                _ => steered(&helm.situation, order, actions),
            };
        }
    }
}

/// The action nearest to an order.
fn steered(situation: &Situation, order: Order, actions: ActionSpace) -> Option<Action> {
    // A teacher's hold is not among the policy's actions, so imitation skips such a decision.
    let Order::Steer {
        heading_rad,
        speed_m_s,
    } = order
    else {
        return None;
    };
    let turn_rad = wrap_pi(heading_rad - situation.own.nav.psi_rad);
    actions.nearest(turn_rad, speed_m_s, situation.model.speed_max_m_s)
}

impl Control {
    /// Processes the picture for the next decision.
    fn preview(&mut self, picture: &Picture) {
        match self {
            Control::Direct(situation) => situation.preview(picture),
            Control::Helm(helm, _) => helm.preview(picture),
        }
    }

    fn situation(&self) -> &Situation {
        match self {
            Control::Direct(situation) => situation,
            Control::Helm(helm, _) => &helm.situation,
        }
    }

    fn helm(&self) -> Option<&HelmMind> {
        if let Control::Helm(helm, _) = self {
            Some(helm)
        } else {
            None
        }
    }
}

impl Mind for Pilot {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.ask_model(picture);
        if let Some(adviser) = &mut self.adviser {
            let order = adviser.helm.decide(picture);
            adviser.teacher.see(&adviser.helm, order, self.actions);
            // The boat does not follow this order, so its motion says nothing about its handling.
            adviser.helm.situation.motion.hold();
        }
        let SetPoint {
            turn_rad,
            course_rad,
            speed_m_s,
        } = self.set_point;
        let situation = match &mut self.control {
            Control::Direct(situation) => situation,
            Control::Helm(helm, None) => {
                // Valid until the next action, regardless of the period.
                helm.propose(Proposal {
                    at: picture.stamp.valid_ns,
                    course_rad,
                    speed_m_s,
                });
                return helm.decide(picture);
            }
            Control::Helm(helm, Some(teacher)) => {
                let order = helm.decide(picture);
                teacher.see(helm, order, self.actions);
                return order;
            }
        };
        if !situation.update(picture, None) {
            return Order::Hold;
        }
        if !situation.own.tagged {
            return Order::Turn {
                by_rad: turn_rad,
                speed_m_s,
            };
        }
        let home = situation
            .locate(&Place::Mark(Mark::UntagPlace))
            .map_or(situation.at, |point| point.at);
        let (heading_rad, speed_m_s) = situation.motion.steer(
            situation.at.bearing_rad(home),
            situation.model.speed_max_m_s,
        );
        situation.motion.order(heading_rad, speed_m_s)
    }

    fn fork(&self) -> Option<Box<dyn Mind>> {
        Some(Box::new(self.clone()))
    }

    fn shares(&self) -> bool {
        self.helm_of_messages().is_some_and(Mind::shares)
    }

    fn send(&self, messages: &mut Vec<Word>) {
        if let Some(helm) = self.helm_of_messages() {
            helm.send(messages);
        }
    }

    fn receive(&mut self, messages: &[Word]) {
        match (&mut self.control, &mut self.adviser) {
            (Control::Helm(helm, _), _) => helm.receive(messages),
            (_, Some(adviser)) => adviser.helm.receive(messages),
            _ => {}
        }
    }

    fn show(&mut self, shown: bool) {
        if let Control::Helm(helm, _) = &mut self.control {
            helm.show(shown);
        }
    }

    fn report(&self) -> Option<HelmReport> {
        self.control.helm().and_then(Mind::report)
    }
}
