//! A mind controlled from outside by a trainer or a program: encodes its boat's knowledge as
//! numbers and applies the actions it receives.

use crate::helm::HelmMind;
use crate::mind::{Mind, Proposal};
use crate::observation::Observer;
use crate::own_motion::OwnMotion;
use crate::policy::{BoardPolicy, Chosen};
use crate::roles::role_of;
use crate::situation::{GameModel, Situation, TeamMessages};
use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use primitives::VehicleId;
use scenario::Scenario;
use scenario::action::{Action, ActionSpace, SetPoint};
use scenario::observation::ObservationSpace;
use scenario::policy::PolicyModel;
use scenario::strategy::{Fact, Mark, Place, Program, Proposer, Values};
use std::collections::BTreeMap;

/// How actions reach the boat.
enum Control {
    /// Directly: the set-point is the order.
    Direct(Box<Situation>),
    /// Through a helm, as a proposal that it weighs against safety.
    Helm(Box<HelmMind>),
    /// Actions are ignored: a strategy plays, and its actions serve as a demonstration.
    Taught(Box<Teacher>),
}

/// A strategy that plays in place of the policy that imitates it.
struct Teacher {
    helm: HelmMind,
    /// The option that each mode corresponds to, by mode index.
    options: Vec<Option<usize>>,
    /// Its first action since the last observation, if the policy could have chosen that action.
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

/// A mind whose decisions are made outside.
pub struct Pilot {
    control: Control,
    observer: Observer,
    actions: ActionSpace,
    set_point: SetPoint,
    /// A model that decides in place of an external source.
    policy: Option<BoardPolicy>,
}

impl Pilot {
    /// Actions become orders directly. A tagged boat is steered home regardless, because it can do
    /// nothing else.
    #[must_use]
    pub fn direct(scenario: &Scenario, vehicle: VehicleId, spaces: Spaces) -> Pilot {
        let program = role_of(scenario, vehicle);
        let model = GameModel::new(scenario, vehicle, program);
        // With the drift estimated, which is part of the observation even if nothing compensates
        // for it.
        let motion = OwnMotion::new(scenario.boat_of(vehicle), model.speed_max_m_s, true);
        let team_messages = TeamMessages::new(program, &model.mates);
        let situation = Box::new(Situation::new(model, motion, program, team_messages));
        Pilot::new(Control::Direct(situation), spaces)
    }

    /// Actions are proposals to the helm of `program`, which has a behaviour of kind `policy`.
    #[must_use]
    pub fn helm(scenario: &Scenario, vehicle: VehicleId, program: &Program, spaces: Spaces) -> Pilot {
        Pilot::new(Control::Helm(Box::new(HelmMind::new(scenario, vehicle, program))), spaces)
    }

    /// The strategy's program for this boat plays. [`Pilot::taught`] returns the action that a
    /// policy would have had to choose. `options` maps each mode path to its option.
    #[must_use]
    pub fn by_teacher(
        scenario: &Scenario,
        vehicle: VehicleId,
        program: &Program,
        options: &BTreeMap<String, usize>,
        spaces: Spaces,
    ) -> Pilot {
        let helm = HelmMind::new(scenario, vehicle, program);
        let options = (0..program.modes.len()).map(|mode| options.get(&program.path(mode)).copied()).collect();
        Pilot::new(Control::Taught(Box::new(Teacher { helm, options, did: None, is_observed: false })), spaces)
    }

    fn new(control: Control, spaces: Spaces) -> Pilot {
        let observer = Observer::new(spaces.observation, situation_of(&control));
        Pilot { observer, control, actions: spaces.action, set_point: SetPoint::default(), policy: None }
    }

    /// The same pilot, with decisions made by a model.
    #[must_use]
    pub fn by_model(mut self, model: PolicyModel) -> Pilot {
        self.policy = Some(BoardPolicy::new(model));
        self
    }

    /// Evaluates the model, if any, when its decision is due.
    fn ask_model(&mut self, picture: &Picture) {
        let Some(policy) = self.policy.as_mut().filter(|policy| policy.is_due(picture.stamp.valid_ns)) else { return };
        preview(&mut self.control, picture);
        policy.choose_if_due(situation_of(&self.control));
        if let Ok(chosen) = policy.chosen() {
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
            (Chosen::Option(option), Control::Helm(helm)) => helm.choose(option),
            (Chosen::Option(_), Control::Direct(_) | Control::Taught(_)) => self.set_point = SetPoint::default(),
        }
    }

    /// Takes in the picture for the next decision. Returns the observation.
    pub fn observe(&mut self, picture: &Picture) -> &[f32] {
        preview(&mut self.control, picture);
        if let Control::Taught(teacher) = &mut self.control {
            (teacher.did, teacher.is_observed) = (None, true);
        }
        self.observer.observe(situation_of(&self.control))
    }

    /// Applies this action from the next decision on.
    pub fn act(&mut self, action: Action) {
        self.follow(Chosen::of(self.actions, action, situation_of(&self.control)));
    }

    /// Whether actions take effect: a tagged boat drives home, and one out of action stays still.
    #[must_use]
    pub fn obeys(&self) -> bool {
        let situation = situation_of(&self.control);
        !situation.own.tagged && situation.fact(Fact::Disabled) == 0.0
    }

    /// The teacher's decision at the last observation as an action; `None` without a teacher, or if
    /// no action corresponds to it.
    #[must_use]
    pub fn taught(&self) -> Option<Action> {
        match &self.control {
            Control::Taught(teacher) => teacher.did,
            Control::Direct(_) | Control::Helm(_) => None,
        }
    }
}

impl Teacher {
    fn decide(&mut self, picture: &Picture, actions: ActionSpace) -> Order {
        let order = self.helm.decide(picture);
        if std::mem::take(&mut self.is_observed) {
            self.did = match actions {
                ActionSpace::Options => self.helm.mode().and_then(|mode| self.options[mode]).map(Action::Discrete),
                ActionSpace::Pyquaticus | ActionSpace::Continuous => self.steered(order, actions),
            };
        }
        order
    }

    fn steered(&self, order: Order, actions: ActionSpace) -> Option<Action> {
        // A teacher's hold is not among the policy's actions, so imitation skips such a decision.
        let Order::Steer { heading_rad, speed_m_s } = order else { return None };
        let situation = self.helm.situation();
        let asked = SetPoint { course_rad: heading_rad, speed_m_s };
        actions.nearest(asked, situation.own.nav.psi_rad, situation.model.speed_max_m_s)
    }
}

/// Takes in the picture for the next decision.
fn preview(control: &mut Control, picture: &Picture) {
    match control {
        Control::Direct(situation) => situation.preview(picture),
        Control::Helm(helm) => helm.preview(picture),
        Control::Taught(teacher) => teacher.helm.preview(picture),
    }
}

fn helm_of(control: &Control) -> Option<&HelmMind> {
    match control {
        Control::Direct(_) => None,
        Control::Helm(helm) => Some(helm),
        Control::Taught(teacher) => Some(&teacher.helm),
    }
}

fn helm_of_mut(control: &mut Control) -> Option<&mut HelmMind> {
    match control {
        Control::Direct(_) => None,
        Control::Helm(helm) => Some(helm),
        Control::Taught(teacher) => Some(&mut teacher.helm),
    }
}

fn situation_of(control: &Control) -> &Situation {
    match control {
        Control::Direct(situation) => situation,
        Control::Helm(helm) => helm.situation(),
        Control::Taught(teacher) => teacher.helm.situation(),
    }
}

impl Mind for Pilot {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.ask_model(picture);
        let situation = match &mut self.control {
            Control::Direct(situation) => situation,
            Control::Helm(helm) => {
                // Valid until the next action, however long the period.
                let SetPoint { course_rad, speed_m_s } = self.set_point;
                helm.propose(Proposal { at: picture.stamp.valid_ns, course_rad, speed_m_s });
                return helm.decide(picture);
            }
            Control::Taught(teacher) => return teacher.decide(picture, self.actions),
        };
        if !situation.update(picture) {
            return Order::Hold;
        }
        let SetPoint { course_rad, speed_m_s } = self.set_point;
        if !situation.own.tagged {
            return Order::Steer { heading_rad: course_rad, speed_m_s };
        }
        let home = situation.locate(&Place::Mark(Mark::UntagPlace)).map_or(situation.at, |point| point.at);
        let (heading_rad, speed_m_s) =
            situation.motion.steer(situation.at.bearing_rad(home), situation.model.speed_max_m_s);
        situation.motion.order(heading_rad, speed_m_s)
    }

    fn shares(&self) -> bool {
        helm_of(&self.control).is_some_and(Mind::shares)
    }

    fn proposer(&self) -> Option<Proposer> {
        None
    }

    fn send(&self, messages: &mut Vec<Word>) {
        if let Some(helm) = helm_of(&self.control) {
            helm.send(messages);
        }
    }

    fn receive(&mut self, messages: &[Word]) {
        if let Some(helm) = helm_of_mut(&mut self.control) {
            helm.receive(messages);
        }
    }

    fn show(&mut self, shown: bool) {
        if let Some(helm) = helm_of_mut(&mut self.control) {
            helm.show(shown);
        }
    }

    fn report(&self) -> Option<HelmReport> {
        helm_of(&self.control).and_then(Mind::report)
    }
}
