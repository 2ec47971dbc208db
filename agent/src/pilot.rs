//! A mind whose decisions are made outside of it, by a trainer or a program: it shows what its boat knows as numbers, and does
//! what it is told.

use crate::helm::HelmMind;
use crate::mind::{Mind, Proposal};
use crate::observation::Observer;
use crate::own_motion::OwnMotion;
use crate::policy::{BoardPolicy, Chosen};
use crate::roles::role_of;
use crate::situation::{GameModel, Situation, TeamMessages};
use game::action::{Action, ActionSpace, SetPoint};
use game::helm::HelmReport;
use game::message::Word;
use game::observation::ObservationSpace;
use game::policy::PolicyModel;
use game::scenario::Scenario;
use game::strategy::{Fact, Mark, Place, Program, Proposer, Values};
use game::{Order, Picture, VehicleId};

/// How actions reach the boat.
enum Control {
    /// As they are: the set-point is the order.
    Direct(Box<Situation>),
    /// Through a helm, as a proposal that it weighs against safety.
    Helm(Box<HelmMind>),
}

/// What a policy sees and what it may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spaces {
    /// What it is given.
    pub observation: ObservationSpace,
    /// What it chooses from.
    pub action: ActionSpace,
}

/// A mind whose decisions are made outside.
pub struct Pilot {
    control: Control,
    observer: Observer,
    actions: ActionSpace,
    set_point: SetPoint,
    /// What decides instead of somebody outside.
    policy: Option<BoardPolicy>,
}

impl Pilot {
    /// Actions become orders as they are. A tagged boat is steered home all the same, since there is nothing else for it to do.
    #[must_use]
    pub fn direct(scenario: &Scenario, vehicle: VehicleId, spaces: Spaces) -> Pilot {
        let program = role_of(scenario, vehicle);
        let model = GameModel::new(scenario, vehicle, program);
        let motion = OwnMotion::new(scenario.boat_of(vehicle), model.speed_max_m_s, true);
        let team_messages = TeamMessages::new(program, &model.mates);
        let situation = Box::new(Situation::new(model, motion, program, team_messages));
        Pilot::new(Control::Direct(situation), spaces)
    }

    /// Actions are proposals to the helm of `program`, which has a behaviour of the kind `policy`.
    #[must_use]
    pub fn helm(scenario: &Scenario, vehicle: VehicleId, program: &Program, spaces: Spaces) -> Pilot {
        Pilot::new(Control::Helm(Box::new(HelmMind::new(scenario, vehicle, program))), spaces)
    }

    fn new(control: Control, spaces: Spaces) -> Pilot {
        let observer = Observer::new(spaces.observation, situation_of(&control));
        Pilot { observer, control, actions: spaces.action, set_point: SetPoint::default(), policy: None }
    }

    /// The same with its decisions made by a model.
    #[must_use]
    pub fn by_model(mut self, model: PolicyModel) -> Pilot {
        self.policy = Some(BoardPolicy::new(model));
        self
    }

    /// Asks the model, if there is one and it is time to.
    fn ask_model(&mut self, picture: &Picture) {
        let Some(policy) = self.policy.as_mut().filter(|policy| policy.is_due(picture.stamp.valid_ns)) else { return };
        match &mut self.control {
            Control::Direct(situation) => situation.look_ahead(picture),
            Control::Helm(helm) => helm.look_ahead(picture),
        }
        policy.look(situation_of(&self.control));
        if let Ok(chosen) = policy.chosen() {
            self.follow(chosen);
        } else {
            self.set_point = SetPoint::default();
        }
    }

    fn follow(&mut self, chosen: Chosen) {
        match (chosen, &mut self.control) {
            (Chosen::SetPoint(set_point), _) => self.set_point = set_point,
            (Chosen::Option(option), Control::Helm(helm)) => helm.choose(option),
            (Chosen::Option(_), Control::Direct(_)) => self.set_point = SetPoint::default(),
        }
    }

    /// Takes in the picture on which it will decide next, and gives the observation.
    pub fn observe(&mut self, picture: &Picture) -> &[f32] {
        match &mut self.control {
            Control::Direct(situation) => situation.look_ahead(picture),
            Control::Helm(helm) => helm.look_ahead(picture),
        }
        self.observer.observe(situation_of(&self.control))
    }

    /// Does this from the next decision on.
    pub fn act(&mut self, action: Action) {
        self.follow(Chosen::of(self.actions, action, situation_of(&self.control)));
    }

    /// Whether the boat does as it is told: a tagged one sails home, and one out of action lies still.
    #[must_use]
    pub fn obeys(&self) -> bool {
        let situation = situation_of(&self.control);
        !situation.own.tagged && situation.fact(Fact::Disabled) == 0.0
    }
}

fn situation_of(control: &Control) -> &Situation {
    match control {
        Control::Direct(situation) => situation,
        Control::Helm(helm) => helm.situation(),
    }
}

impl Mind for Pilot {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.ask_model(picture);
        let situation = match &mut self.control {
            Control::Direct(situation) => situation,
            Control::Helm(helm) => {
                // It holds until the next action, however long a period that is.
                let SetPoint { course_rad, speed_m_s } = self.set_point;
                helm.propose(Proposal { at: picture.stamp.valid_ns, course_rad, speed_m_s });
                return helm.decide(picture);
            }
        };
        if !situation.take(picture) {
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
        match &self.control {
            Control::Direct(_) => false,
            Control::Helm(helm) => helm.shares(),
        }
    }

    fn proposer(&self) -> Option<Proposer> {
        None
    }

    fn send(&self, messages: &mut Vec<Word>) {
        if let Control::Helm(helm) = &self.control {
            helm.send(messages);
        }
    }

    fn receive(&mut self, messages: &[Word]) {
        if let Control::Helm(helm) = &mut self.control {
            helm.receive(messages);
        }
    }

    fn pilot(&mut self) -> Option<&mut Pilot> {
        Some(self)
    }

    fn show(&mut self, shown: bool) {
        if let Control::Helm(helm) = &mut self.control {
            helm.show(shown);
        }
    }

    fn report(&self) -> Option<HelmReport> {
        match &self.control {
            Control::Direct(_) => None,
            Control::Helm(helm) => helm.report(),
        }
    }
}
