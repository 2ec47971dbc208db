//! The situation: a helm's knowledge at a decision, in the terms that strategies use.

mod game_model;
mod interception;
mod moving_point;
mod team_messages;
mod team_view;
mod turn_estimate;

pub(crate) use interception::meeting_time_s;
pub(crate) use moving_point::MovingPoint;
pub use team_view::TeamView;

use crate::mind::Proposal;
use crate::own_motion::OwnMotion;
use game_model::GameModel;
pub(crate) use game_model::score_max;
use interception::Pair;
use messages::Picture;
use messages::picture::OwnBoat;
use primitives::frame::{Body, Rotation, ned_from_body};
use primitives::{FlagId, Ned, SimTime, VehicleId};
use rules::{Ability, TaggedBoat, UntagOn};
use scenario::Scenario;
use scenario::strategy::{Boat, Expression, Fact, Mark, Measure, Place, Program, Values};
use std::cell::OnceCell;
use std::sync::Arc;
use team_messages::TeamMessages;
use turn_estimate::turning_on;

/// Distance to an unknown object, m.
const NOWHERE_M: f64 = 1e9;
/// A boat that is tagged within this fraction of the untag radius from the centre must first leave
/// its untag place.
const WELL_INSIDE: f64 = 0.5;
/// Multiple of that radius beyond which the boat counts as having left.
const WELL_OUTSIDE: f64 = 1.2;

/// Another boat.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OtherBoat {
    pub(crate) vehicle: VehicleId,
    pub(crate) is_enemy: bool,
    /// Estimated current position.
    pub(crate) at: Ned,
    velocity: Velocity,
    pub(crate) psi_rad: f64,
    yaw_rate_rad_s: f64,
    /// The cached [`OtherBoat::turning_on`]; only in a large fleet.
    turned: Option<MovingPoint>,
    pub(crate) tagged: bool,
    /// Whether power play has put the boat out of action.
    pub(crate) disabled: bool,
    pub(crate) carrying: Option<FlagId>,
    /// The earliest time of the boat's next tag: for a teammate from its own messages; for enemies
    /// only if they tagged a boat of the team.
    pub(crate) tag_ready: SimTime,
    /// Age of the last observation, s; teammates report themselves in every picture.
    pub(crate) age_s: f64,
    /// Whether the boat is an enemy on the team's own side.
    pub(crate) intrudes: bool,
}

/// A velocity over the ground as received, m/s. It is rotated on demand, because only a few
/// velocities of a large team are needed.
#[derive(Clone, Copy, Debug)]
enum Velocity {
    Ned(Ned),
    /// Along the boat's axes.
    Body(Body),
}

impl OtherBoat {
    /// The boat's velocity over the ground, m/s.
    pub(crate) fn velocity(&self) -> Ned {
        match self.velocity {
            Velocity::Ned(velocity) => velocity,
            Velocity::Body(velocity) => {
                ned_from_body(Rotation::from_heading(self.psi_rad), velocity)
            }
        }
    }
}

/// The helm's current knowledge.
#[derive(Clone, Debug)]
pub(crate) struct Situation {
    pub(crate) model: GameModel,
    pub(crate) now: SimTime,
    pub(crate) step_s: f64,
    /// Whether a picture has been processed.
    begun: bool,
    /// Whether a previewed picture shows the boat itself.
    is_seen: Option<bool>,
    pub(crate) mode_since: SimTime,
    pub(crate) own: OwnBoat,
    pub(crate) at: Ned,
    /// The unit vector along the bow.
    pub(crate) ahead: Ned,
    /// The boat's velocity over the ground, m/s.
    pub(crate) velocity: Ned,
    /// The boat's response to orders.
    pub(crate) motion: OwnMotion,
    /// The knowledge of the whole team.
    pub(crate) view: Arc<TeamView>,
    pub(crate) variables: Vec<f64>,
    pub(crate) team_messages: TeamMessages,
    /// A policy's last proposal.
    pub(crate) proposed: Option<Proposal>,
    /// The carrier of each flag, if any.
    carriers: Vec<Option<VehicleId>>,
    score: f64,
    enemy_score: f64,
    /// The interception pairs, computed on first use in a decision.
    interception: OnceCell<Arc<[Pair]>>,
    interception_before: Arc<[Pair]>,
    /// Whether the boat was tagged inside its untag place, and must leave this place before it
    /// returns.
    leaving: bool,
}

impl Situation {
    /// The situation before the first picture. `compensates` states whether the drift is estimated.
    pub(crate) fn new(
        scenario: &Scenario,
        vehicle: VehicleId,
        program: &Program,
        compensates: bool,
    ) -> Situation {
        let model = GameModel::new(scenario, vehicle, program);
        Situation {
            own: OwnBoat::new(model.me, messages::picture::Nav::default()),
            motion: OwnMotion::new(scenario.boat_of(vehicle), model.speed_max_m_s, compensates),
            team_messages: TeamMessages::new(program, &model.mates),
            view: Arc::new(TeamView::new(Arc::clone(&model.of_team))),
            model,
            now: SimTime::ZERO,
            begun: false,
            is_seen: None,
            step_s: 0.0,
            mode_since: SimTime::ZERO,
            at: Ned::default(),
            ahead: Ned::default(),
            velocity: Ned::default(),
            variables: program
                .variables
                .iter()
                .map(|variable| variable.initial)
                .collect(),
            proposed: None,
            carriers: Vec::new(),
            score: 0.0,
            enemy_score: 0.0,
            interception: OnceCell::new(),
            interception_before: Arc::default(),
            leaving: false,
        }
    }

    /// Processes the picture for the next decision in advance.
    pub(crate) fn preview(&mut self, picture: &Picture) {
        self.is_seen = Some(self.apply_picture(picture, None));
    }

    /// Processes the newest picture unless a preview has done so. Returns whether it shows the boat
    /// itself. `view` is the team's view of it, if known.
    pub(crate) fn update(&mut self, picture: &Picture, view: Option<&Arc<TeamView>>) -> bool {
        self.is_seen
            .take()
            .unwrap_or_else(|| self.apply_picture(picture, view))
    }

    fn apply_picture(&mut self, picture: &Picture, view: Option<&Arc<TeamView>>) -> bool {
        let Some(own) = picture.own(self.model.me) else {
            return false;
        };
        let now = picture.stamp.valid_ns;
        // Use the pictures' own time, so that a lost picture means a longer step and a repeated one
        // a step of zero.
        self.step_s = if self.begun {
            (now - self.now).as_s().max(0.0)
        } else {
            0.0
        };
        (self.now, self.begun) = (now, true);
        self.own = *own;
        self.ahead = own.nav.pose().rotation().ahead();
        self.motion.observe(
            own,
            self.step_s,
            !(own.disabled || own.tagged && self.model.rules.tagged_boat == TaggedBoat::IsDriven),
        );
        // Use the team's view only if this boat has seen exactly the same pictures.
        match view.filter(|view| view.follows(&self.view)) {
            Some(view) => self.view = Arc::clone(view),
            None => TeamView::own(&mut self.view).take_in(picture),
        }
        if let Some(own) = self.view.own_boat(self.model.me) {
            (self.at, self.velocity) = (own.at, own.velocity());
        }
        if let Some(pairs) = self.interception.take() {
            self.interception_before = pairs;
        }
        self.carriers.clear();
        self.carriers.extend(
            picture
                .flags
                .iter()
                .map(|flag| u16::try_from(flag.carrier).ok().map(VehicleId)),
        );
        let ours = picture.score.get(self.model.team.index()).copied();
        self.score = f64::from(ours.unwrap_or(0));
        self.enemy_score = picture.score.iter().copied().map(f64::from).sum::<f64>() - self.score;
        // Use hysteresis: with a single limit, position noise would toggle the state.
        let (centre, radius_m) = self.model.untag_circle(self.at, now);
        let from_home = self.at.distance(centre) / radius_m;
        self.leaving = own.tagged
            && self.model.rules.untag_on != UntagOn::Never
            && (from_home < WELL_INSIDE || self.leaving && from_home <= WELL_OUTSIDE);
        true
    }

    /// The boat extrapolated through a brief continued turn.
    pub(crate) fn turning_on(&self) -> MovingPoint {
        turning_on(
            MovingPoint {
                at: self.at,
                velocity: self.velocity,
            },
            self.own.nav.yaw_rate_rad_s,
        )
    }

    /// All other known boats: teammates first, then enemies, each in the scenario's order.
    pub(crate) fn others(&self) -> impl Iterator<Item = &OtherBoat> {
        self.mates().chain(&self.view.boats[self.view.own..])
    }

    /// Calls `each` with the index and the distance (m) of every other boat within this distance,
    /// in any order.
    pub(crate) fn near(&self, reach_m: f64, mut each: impl FnMut(usize, f64)) {
        self.view.near(self.at, reach_m, |i, distance_m| {
            if i >= self.view.own || self.other(i).vehicle != self.model.me {
                each(i, distance_m);
            }
        });
    }

    /// A boat by an index from [`Situation::near`].
    pub(crate) fn other(&self, i: usize) -> &OtherBoat {
        &self.view.boats[i]
    }

    pub(crate) fn enemies(&self) -> impl Iterator<Item = &OtherBoat> {
        let contacts = self.view.boats[self.view.own..].iter();
        contacts.filter(|other| other.is_enemy)
    }

    /// The enemies that play, or will play again.
    fn opponents(&self) -> impl Iterator<Item = &OtherBoat> {
        let plays_again = self.model.rules.untag_on != UntagOn::Never;
        self.enemies()
            .filter(move |enemy| plays_again || !enemy.tagged)
    }

    /// The enemies on the team's own side that are not tagged.
    fn intruders(&self) -> impl Iterator<Item = &OtherBoat> {
        self.enemies().filter(|enemy| enemy.is_intruder())
    }

    fn mates(&self) -> impl Iterator<Item = &OtherBoat> {
        let own = self.view.boats[..self.view.own].iter();
        own.filter(|mate| mate.vehicle != self.model.me)
    }

    /// The boat that `boat` currently refers to.
    pub(crate) fn boat(&self, boat: Boat) -> Option<&OtherBoat> {
        let of_ours =
            |other: &&OtherBoat| other.carrying.is_some_and(|flag| self.is_own_flag(flag));
        match boat {
            Boat::NearestEnemy => nearest(self.at, self.enemies().filter(|enemy| !enemy.tagged)),
            Boat::NearestIntruder => nearest(self.at, self.intruders()),
            Boat::NearestAttacker => {
                let attackers = self.enemies().filter(|enemy| !enemy.tagged);
                attackers.min_by(|a, b| {
                    self.flag_distance_squared(a.at)
                        .total_cmp(&self.flag_distance_squared(b.at))
                })
            }
            Boat::NearestDefender => nearest(self.enemy_flag(), self.opponents()),
            Boat::AssignedIntruder => {
                let pairs = self
                    .interception
                    .get_or_init(|| self.view.pairs_after(&self.interception_before));
                let mine = pairs
                    .iter()
                    .find(|pair| pair.interceptor == self.model.me)?;
                self.enemies().find(|enemy| enemy.vehicle == mine.intruder)
            }
            Boat::FlagCarrier => nearest(self.at, self.enemies().filter(of_ours)),
            Boat::Opponent => {
                let enemies = &self.model.enemies;
                let assigned =
                    (!enemies.is_empty()).then(|| enemies[self.model.rank % enemies.len()]);
                self.opponents()
                    .find(|enemy| Some(enemy.vehicle) == assigned)
            }
            Boat::NearestMate => nearest(self.at, self.mates()),
            Boat::MateCarrier => {
                nearest(self.at, self.mates().filter(|mate| mate.carrying.is_some()))
            }
        }
    }

    /// The squared distance of a place from the team's nearest flag, m².
    fn flag_distance_squared(&self, at: Ned) -> f64 {
        let home = self.model.own_flag_near(at, self.now);
        home.distance_squared(at)
    }

    /// The untagged teammates without a flag.
    fn free_mates(&self) -> impl Iterator<Item = &OtherBoat> {
        self.mates()
            .filter(|mate| !mate.tagged && mate.carrying.is_none())
    }

    /// The current position and velocity of a place.
    pub(crate) fn locate(&self, place: &Place) -> Option<MovingPoint> {
        let still = |at: Ned| {
            Some(MovingPoint {
                at,
                velocity: Ned::default(),
            })
        };
        match place {
            Place::At(at) => still(*at),
            Place::Point(name) => self.model.point(name).and_then(still),
            Place::Mark(mark) => still(self.mark(*mark)),
            Place::Boat(boat) => self.boat(*boat).map(|other| MovingPoint {
                at: other.at,
                velocity: other.velocity(),
            }),
        }
    }

    fn mark(&self, mark: Mark) -> Ned {
        match mark {
            Mark::OwnFlag => self.model.own_flag_near(self.at, self.now),
            Mark::EnemyFlag => self.enemy_flag(),
            Mark::CapturePlace => self.model.capture_place(self.at, self.now),
            Mark::UntagPlace if self.leaving => self.enemy_flag(),
            Mark::UntagPlace => self.model.untag_place(self.at, self.now),
        }
    }

    /// The nearest flag to attack that is at home, or else the nearest of all.
    fn enemy_flag(&self) -> Ned {
        let home = |flag: &FlagId| self.model.field.flags[flag.index()].home(self.now);
        let targets = self.model.targets.iter();
        let targets = targets.map(|flag| (*flag, home(flag)));
        let key = |(flag, home): &(FlagId, Ned)| {
            (
                self.carried(*flag).is_some(),
                self.at.distance_squared(*home),
            )
        };
        let best = targets.min_by(|a, b| {
            let a = key(a);
            let b = key(b);
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        best.map_or(self.at, |(_, home)| home)
    }

    fn is_own_flag(&self, flag: FlagId) -> bool {
        self.model.own_flags.contains(&flag)
    }

    /// The carrier of a flag.
    fn carried(&self, flag: FlagId) -> Option<VehicleId> {
        self.carriers.get(flag.index()).copied().flatten()
    }
}

impl Values for Situation {
    fn fact(&self, fact: Fact) -> f64 {
        let truth = |is: bool| f64::from(u8::from(is));
        let count = |n: usize| n as f64;
        match fact {
            Fact::Tagged => truth(self.own.tagged),
            Fact::HasFlag => truth(self.own.carried_flag().is_some()),
            Fact::OwnSide => truth(self.model.is_own_side(self.at)),
            Fact::Outside => truth(self.own.outside),
            Fact::Disabled => truth(self.own.disabled),
            Fact::CanTag => truth(Ability::from(&self.own).may_tag(self.now)),
            Fact::FlagTaken => truth(
                self.model
                    .own_flags
                    .iter()
                    .any(|flag| self.carried(*flag).is_some()),
            ),
            Fact::EnemyFlagTaken => truth(
                self.model
                    .targets
                    .iter()
                    .any(|flag| self.carried(*flag).is_some()),
            ),
            Fact::MateHasFlag => {
                let by_mate = |flag: FlagId| {
                    self.carried(flag)
                        .is_some_and(|carrier| carrier != self.model.me)
                };
                truth(self.model.targets.iter().any(|flag| by_mate(*flag)))
            }
            Fact::EnemyInZone => truth(self.intruders().next().is_some()),
            Fact::EnemiesInZone => count(self.intruders().count()),
            Fact::Enemies => count(self.enemies().count()),
            Fact::EnemiesTagged => count(self.enemies().filter(|enemy| enemy.tagged).count()),
            Fact::Mates => count(self.model.mates.len()),
            Fact::MatesTagged => count(self.mates().filter(|mate| mate.tagged).count()),
            Fact::Rank => count(self.model.rank),
            Fact::Score => self.score,
            Fact::EnemyScore => self.enemy_score,
            Fact::TimeS => self.now.as_s(),
            Fact::TimeLeftS => (self.model.rules.time_limit - self.now).as_s().max(0.0),
            Fact::ModeS => (self.now - self.mode_since).as_s(),
            Fact::StepS => self.step_s,
            Fact::SpeedMS => self.velocity.length(),
        }
    }

    fn variable(&self, index: u16) -> f64 {
        self.variables
            .get(usize::from(index))
            .copied()
            .unwrap_or(0.0)
    }

    fn measure(&self, measure: Measure, place: &Place) -> f64 {
        let point = self.locate(place);
        let truth = |is: bool| f64::from(u8::from(is));
        match measure {
            Measure::Distance | Measure::Closing => {
                let own = MovingPoint {
                    at: self.at,
                    velocity: self.velocity,
                };
                between(measure, Some(own), point)
            }
            Measure::Speed => point.map_or(0.0, |point| point.velocity.length()),
            Measure::Known => truth(point.is_some()),
            Measure::OnOwnSide => {
                truth(point.is_some_and(|point| self.model.is_own_side(point.at)))
            }
            Measure::IsTagged => match place {
                Place::Boat(boat) => truth(self.boat(*boat).is_some_and(|boat| boat.tagged)),
                _ => 0.0,
            },
            Measure::MatesNearer => point.map_or(0.0, |point| {
                let own = self.at.distance_squared(point.at);
                self.free_mates()
                    .filter(|mate| mate.at.distance_squared(point.at) < own)
                    .count() as f64
            }),
        }
    }

    fn between(&self, measure: Measure, from: &Place, to: &Place) -> f64 {
        between(measure, self.locate(from), self.locate(to))
    }

    fn mates(&self, condition: &Expression) -> f64 {
        self.team_messages.count(condition)
    }
}

/// A measure between two places, or its default if either place is unknown.
fn between(measure: Measure, from: Option<MovingPoint>, to: Option<MovingPoint>) -> f64 {
    let points = from.zip(to);
    match measure {
        // The default is far away, but finite: expressions may subtract, and infinity minus
        // infinity is NaN.
        Measure::Distance => points.map_or(NOWHERE_M, |(from, to)| from.at.distance(to.at)),
        Measure::Closing => points.map_or(0.0, |(from, to)| closing_m_s(from, to)),
        _ => 0.0,
    }
}

fn closing_m_s(from: MovingPoint, to: MovingPoint) -> f64 {
    let line = to.at - from.at;
    let distance_m = line.length();
    if distance_m < 1e-6 {
        return 0.0;
    }
    (from.velocity - to.velocity).dot(line) / distance_m
}

/// The boat nearest to `at`; ties go to the first.
fn nearest<'a>(at: Ned, others: impl Iterator<Item = &'a OtherBoat>) -> Option<&'a OtherBoat> {
    others.min_by(|a, b| {
        at.distance_squared(a.at)
            .total_cmp(&at.distance_squared(b.at))
    })
}
