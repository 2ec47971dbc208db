//! The situation: a helm's knowledge at a decision, in the terms of strategies.

mod game_model;
mod interception;
mod moving_point;
mod team_messages;
mod turn_estimate;

pub(crate) use interception::meeting_time_s;
pub(crate) use moving_point::MovingPoint;

use crate::mind::Proposal;
use crate::own_motion::OwnMotion;
use game_model::GameModel;
pub(crate) use game_model::score_max;
use interception::{Interceptor, Intruder, Pair};
use messages::Picture;
use messages::picture::{Contact, OwnBoat};
use primitives::frame::{Body, Rotation, ned_from_body};
use primitives::{FlagId, Ned, SimTime, VehicleId};
use rules::event::{EventRecord, TagCause};
use rules::{Ability, Event, TaggedBoat, tag_wait_s};
use scenario::Scenario;
use scenario::strategy::{Boat, Expression, Fact, Mark, Measure, Place, Program, Values};
use std::cell::OnceCell;
use team_messages::TeamMessages;
use turn_estimate::{TurnEstimate, turning_on};

/// A contact is assumed to keep its velocity for this long and then to slow down, s.
const KEEPS_ON_S: f64 = 15.0;
/// A contact is assumed to be at rest after this long, s.
const STILL_AFTER_S: f64 = 30.0;
/// A boat of the team is dead reckoned after this time without a fix, s: at the usual delays it
/// moves less than a receiver errs, and to rotate the motion of a whole fleet takes time.
const LATE_S: f64 = 0.5;
/// Distance to anything unknown, m.
const NOWHERE_M: f64 = 1e9;
/// A boat this far inside its untagging place was tagged there and must leave it, as a fraction of
/// the radius.
const WELL_INSIDE: f64 = 0.5;
/// Fraction of the radius beyond which it counts as having left.
const WELL_OUTSIDE: f64 = 1.2;

/// Another boat.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OtherBoat {
    pub(crate) vehicle: VehicleId,
    pub(crate) is_enemy: bool,
    /// Its estimated position now.
    pub(crate) at: Ned,
    velocity: Velocity,
    pub(crate) psi_rad: f64,
    yaw_rate_rad_s: f64,
    pub(crate) tagged: bool,
    /// Whether power play has put it out of action.
    pub(crate) disabled: bool,
    pub(crate) carrying: Option<FlagId>,
    /// The earliest time of its next tag: from a mate's own messages; for enemies only if they
    /// tagged a boat of the team.
    pub(crate) tag_ready: SimTime,
    /// Age of the last observation, s; mates report themselves in every picture.
    pub(crate) age_s: f64,
    /// Whether it is an enemy on the team's own side.
    pub(crate) intrudes: bool,
}

/// A velocity over the ground as received, m/s. It is rotated on demand, because few boats of a
/// large team need it.
#[derive(Clone, Copy, Debug)]
enum Velocity {
    Ned(Ned),
    /// Along the boat's axes.
    Body(Body),
}

impl OtherBoat {
    /// Its velocity over the ground, m/s.
    pub(crate) fn velocity(&self) -> Ned {
        match self.velocity {
            Velocity::Ned(velocity) => velocity,
            Velocity::Body(velocity) => {
                ned_from_body(Rotation::from_heading(self.psi_rad), velocity)
            }
        }
    }

    /// Its position and velocity extrapolated through a brief continued turn.
    pub(crate) fn turning_on(&self) -> MovingPoint {
        turning_on(
            MovingPoint {
                at: self.at,
                velocity: self.velocity(),
            },
            self.yaw_rate_rad_s,
        )
    }
}

/// The way of a boat of the team since its last fix, at the velocity that it had then along its
/// axes.
#[derive(Clone, Copy, Debug)]
struct Track {
    fix: SimTime,
    velocity: Body,
    gone: Ned,
    until: SimTime,
}

/// The helm's current knowledge.
#[derive(Clone, Debug)]
pub(crate) struct Situation {
    pub(crate) model: GameModel,
    pub(crate) now: SimTime,
    pub(crate) step_s: f64,
    /// Whether a picture has been processed.
    begun: bool,
    /// For a previewed picture: whether it shows the boat itself.
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
    /// All other known boats: mates first, then enemies, each in the scenario's order.
    pub(crate) others: Vec<OtherBoat>,
    /// Tracks of the team's boats, by vehicle index.
    tracks: Vec<Option<Track>>,
    /// Turn estimates of contacts, by vehicle index.
    turns: Vec<Option<TurnEstimate>>,
    /// By vehicle index: the earliest time of the next tag of enemies that tagged a boat of the
    /// team.
    tag_ready: Vec<SimTime>,
    /// Boats that power play has put out of action.
    disabled: Vec<VehicleId>,
    pub(crate) variables: Vec<f64>,
    pub(crate) team_messages: TeamMessages,
    /// A policy's last proposal.
    pub(crate) proposed: Option<Proposal>,
    /// The carrier of each flag, if any.
    carriers: Vec<Option<VehicleId>>,
    score: f64,
    enemy_score: f64,
    /// The interception pairs, computed on first use in a decision.
    interception: OnceCell<Vec<Pair>>,
    interception_before: Vec<Pair>,
    /// Whether the boat was tagged inside its untagging place and must leave it before it can come
    /// home.
    leaving: bool,
}

impl Situation {
    /// Before the first picture. `compensates` is whether the drift is estimated.
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
            model,
            now: SimTime::ZERO,
            begun: false,
            is_seen: None,
            step_s: 0.0,
            mode_since: SimTime::ZERO,
            at: Ned::default(),
            ahead: Ned::default(),
            velocity: Ned::default(),
            others: Vec::new(),
            tracks: Vec::new(),
            turns: Vec::new(),
            tag_ready: Vec::new(),
            disabled: Vec::new(),
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
            interception_before: Vec::new(),
            leaving: false,
        }
    }

    /// Processes the picture for the next decision in advance.
    pub(crate) fn preview(&mut self, picture: &Picture) {
        self.is_seen = Some(self.apply_picture(picture));
    }

    /// Processes the newest picture unless a preview has done so. Returns whether it shows the boat
    /// itself.
    pub(crate) fn update(&mut self, picture: &Picture) -> bool {
        self.is_seen
            .take()
            .unwrap_or_else(|| self.apply_picture(picture))
    }

    fn apply_picture(&mut self, picture: &Picture) -> bool {
        let Some(own) = picture.own(self.model.me) else {
            return false;
        };
        let now = picture.stamp.valid_ns;
        // By the pictures' own time, so that a lost one means a longer step and a repeated one a
        // step of zero.
        self.step_s = if self.begun {
            (now - self.now).as_s().max(0.0)
        } else {
            0.0
        };
        (self.now, self.begun) = (now, true);
        self.own = *own;
        self.ahead = own.nav.pose().rotation().ahead();
        let (at, velocity) = self.reckoned(own, now);
        (self.at, self.velocity) = (at, ned_from_body(own.nav.pose().rotation(), velocity));
        self.motion.observe(
            own,
            self.step_s,
            !(own.disabled || own.tagged && self.model.rules.tagged_boat == TaggedBoat::IsDriven),
        );
        self.note_events(picture);
        self.others.clear();
        let me = self.model.me;
        for mate in picture.own.iter().filter(|boat| boat.vehicle != me) {
            let (at, velocity) = self.reckoned(mate, now);
            self.others.push(OtherBoat {
                vehicle: mate.vehicle,
                is_enemy: false,
                at,
                // In games of 20 against 20 and more, rotating all of them to the field's frame
                // measurably slowed decisions, and few are needed.
                velocity: Velocity::Body(velocity),
                psi_rad: mate.nav.psi_rad,
                yaw_rate_rad_s: mate.nav.yaw_rate_rad_s,
                tagged: mate.tagged,
                disabled: mate.disabled,
                carrying: mate.carried_flag(),
                tag_ready: mate.tag_ready_ns,
                age_s: 0.0,
                intrudes: false,
            });
        }
        for contact in &picture.contacts {
            let (at, velocity) = dead_reckoned(contact, now);
            let is_enemy = contact.team != self.model.team;
            let i = contact.vehicle.index();
            self.turns.resize(self.turns.len().max(i + 1), None);
            let turn = TurnEstimate::seen(self.turns[i], contact);
            self.turns[i] = Some(turn);
            self.others.push(OtherBoat {
                vehicle: contact.vehicle,
                is_enemy,
                at,
                velocity: Velocity::Ned(velocity),
                psi_rad: contact.psi_rad,
                yaw_rate_rad_s: turn.yaw_rate_rad_s(now),
                tagged: contact.tagged,
                disabled: self.disabled.contains(&contact.vehicle),
                carrying: u8::try_from(contact.carrying).ok().map(FlagId),
                tag_ready: self.tag_ready.get(i).copied().unwrap_or_default(),
                age_s: (now - contact.seen_ns).as_s(),
                intrudes: is_enemy && self.model.is_own_side(at),
            });
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
        // With hysteresis: at a single limit, position noise would toggle the state.
        let from_home =
            self.at.distance(self.model.untag_centre(self.at)) / self.model.rules.untag_radius_m;
        self.leaving =
            own.tagged && (from_home < WELL_INSIDE || self.leaving && from_home <= WELL_OUTSIDE);
        true
    }

    /// The position of a boat of the team now, and its velocity along its axes. Fixes drop out for
    /// seconds, and links are silent; headings do not drop out, and the last position is one that
    /// the boat has left.
    fn reckoned(&mut self, boat: &OwnBoat, now: SimTime) -> (Ned, Body) {
        let i = boat.vehicle.index();
        let fix = boat.fix_ns;
        self.tracks.resize(self.tracks.len().max(i + 1), None);
        let mut track = self.tracks[i]
            .filter(|track| track.fix == fix)
            .unwrap_or(Track {
                fix,
                velocity: Body {
                    ahead: boat.nav.surge_m_s,
                    starboard: boat.nav.sway_m_s,
                },
                gone: Ned::default(),
                until: fix,
            });
        if (LATE_S..KEEPS_ON_S).contains(&(now - fix).as_s()) {
            let velocity = ned_from_body(boat.nav.pose().rotation(), track.velocity);
            track.gone = track.gone + velocity.scaled((now - track.until).as_s());
            track.until = now;
        }
        self.tracks[i] = Some(track);
        (boat.nav.at() + track.gone, track.velocity)
    }

    /// Records which enemies have tagged a boat of the team, and so cannot tag again for a while,
    /// and which boats are out of action.
    fn note_events(&mut self, picture: &Picture) {
        for logged in picture.events.iter().filter_map(EventRecord::logged) {
            match logged.event {
                Event::Tagged {
                    cause: TagCause::Opponent(by),
                    ..
                } => {
                    let i = by.index();
                    self.tag_ready
                        .resize(self.tag_ready.len().max(i + 1), SimTime::ZERO);
                    self.tag_ready[i] = self.model.rules.tag_ready_after(logged.at);
                }
                Event::Disabled(vehicle) => self.disabled.push(vehicle),
                Event::Enabled(vehicle) => self.disabled.retain(|other| *other != vehicle),
                _ => {}
            }
        }
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

    pub(crate) fn enemies(&self) -> impl Iterator<Item = &OtherBoat> {
        self.others.iter().filter(|other| other.is_enemy)
    }

    /// The enemies on the team's own side that are not tagged.
    fn intruders(&self) -> impl Iterator<Item = &OtherBoat> {
        self.enemies()
            .filter(|enemy| !enemy.tagged && enemy.intrudes)
    }

    fn mates(&self) -> impl Iterator<Item = &OtherBoat> {
        self.others.iter().filter(|other| !other.is_enemy)
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
            Boat::NearestDefender => nearest(self.enemy_flag(), self.enemies()),
            Boat::AssignedIntruder => {
                let pairs = self.interception.get_or_init(|| self.intercepted());
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
                self.enemies().find(|enemy| Some(enemy.vehicle) == assigned)
            }
            Boat::NearestMate => nearest(self.at, self.mates()),
            Boat::MateCarrier => {
                nearest(self.at, self.mates().filter(|mate| mate.carrying.is_some()))
            }
        }
    }

    /// The squared distance of a place from the team's nearest flag, m².
    fn flag_distance_squared(&self, at: Ned) -> f64 {
        self.model.own_flag_near(at).distance_squared(at)
    }

    /// Computes the interception pairs.
    fn intercepted(&self) -> Vec<Pair> {
        let intruder = |boat: &OtherBoat| Intruder {
            vehicle: boat.vehicle,
            at: boat.at,
            velocity: boat.velocity(),
        };
        let mut intruders: Vec<Intruder> = self.intruders().map(intruder).collect();
        // By the flag nearest to each intruder, not the one nearest to this boat, so that all boats
        // of the team find the same order. By their distance to the flag in the whole team's
        // knowledge, so that every mate computes the same pairs.
        intruders.sort_by(|a, b| {
            self.flag_distance_squared(a.at)
                .total_cmp(&self.flag_distance_squared(b.at))
        });
        let boat = |vehicle: VehicleId, at: Ned, tag_ready: SimTime| Interceptor {
            vehicle,
            at,
            speed_m_s: self.model.boat_speeds_m_s[vehicle.index()],
            unready_s: tag_wait_s(tag_ready, self.now),
        };
        let is_free = !self.own.tagged && self.own.carried_flag().is_none();
        let own = is_free.then(|| boat(self.model.me, self.at, self.own.tag_ready_ns));
        let mates = self
            .free_mates()
            .map(|mate| boat(mate.vehicle, mate.at, mate.tag_ready));
        let mut interceptors: Vec<Interceptor> = mates.chain(own).collect();
        interceptors.sort_by_key(|boat| boat.vehicle);
        interception::assign(&interceptors, &intruders, &self.interception_before)
    }

    /// The untagged mates without a flag.
    fn free_mates(&self) -> impl Iterator<Item = &OtherBoat> {
        self.mates()
            .filter(|mate| !mate.tagged && mate.carrying.is_none())
    }

    /// The present position and velocity of a place.
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
            Mark::OwnFlag => self.model.own_flag_near(self.at),
            Mark::EnemyFlag => self.enemy_flag(),
            Mark::CapturePlace => self.model.capture_place(self.at),
            Mark::UntagPlace if self.leaving => self.enemy_flag(),
            Mark::UntagPlace => self.model.untag_place(self.at),
        }
    }

    /// The nearest flag to attack that is home, or else the nearest of all.
    fn enemy_flag(&self) -> Ned {
        let targets = self.model.targets.iter();
        let key = |(flag, home): &&(FlagId, Ned)| {
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
        best.map_or(self.at, |(_, home)| *home)
    }

    fn is_own_flag(&self, flag: FlagId) -> bool {
        self.model.own_flags.iter().any(|(own, _)| *own == flag)
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
                    .any(|(flag, _)| self.carried(*flag).is_some()),
            ),
            Fact::EnemyFlagTaken => truth(
                self.model
                    .targets
                    .iter()
                    .any(|(flag, _)| self.carried(*flag).is_some()),
            ),
            Fact::MateHasFlag => {
                let by_mate = |flag: FlagId| {
                    self.carried(flag)
                        .is_some_and(|carrier| carrier != self.model.me)
                };
                truth(self.model.targets.iter().any(|(flag, _)| by_mate(*flag)))
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

/// A measure between two places, or its default if one is unknown.
fn between(measure: Measure, from: Option<MovingPoint>, to: Option<MovingPoint>) -> f64 {
    let points = from.zip(to);
    match measure {
        // Far away, not infinite: expressions may subtract, and infinity minus infinity is NaN.
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

/// The estimated position and velocity of a contact now: constant velocity, then slowing down, then
/// at rest.
fn dead_reckoned(contact: &Contact, now: SimTime) -> (Ned, Ned) {
    let seen = Ned {
        north: contact.north_m,
        east: contact.east_m,
    };
    let velocity = Ned {
        north: contact.velocity_north_m_s,
        east: contact.velocity_east_m_s,
    };
    let age_s = (now - contact.seen_ns).as_s().max(0.0);
    let slowing_s = (age_s - KEEPS_ON_S).clamp(0.0, STILL_AFTER_S - KEEPS_ON_S);
    let left = 1.0 - slowing_s / (STILL_AFTER_S - KEEPS_ON_S);
    // The integral of a speed that is constant up to the first time and then falls linearly.
    let gone_s = age_s.min(KEEPS_ON_S) + slowing_s * 0.5 * (1.0 + left);
    (seen + velocity.scaled(gone_s), velocity.scaled(left))
}

/// The boat nearest to `at`; ties go to the first.
fn nearest<'a>(at: Ned, others: impl Iterator<Item = &'a OtherBoat>) -> Option<&'a OtherBoat> {
    others.min_by(|a, b| {
        at.distance_squared(a.at)
            .total_cmp(&at.distance_squared(b.at))
    })
}
