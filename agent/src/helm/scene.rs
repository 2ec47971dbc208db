//! The scene: what the helm knows at this decision, in the words of strategies.

use super::chart::Chart;
use super::talk::Ears;
use game::picture::{Contact, OwnBoat};
use game::rules::Ability;
use game::strategy::{Boat, Expression, Fact, Mark, Measure, Place, Program, Values};
use game::{FlagId, Ned, Picture, SimTime, VehicleId};

/// A contact is thought to go on as it was seen for this long, s; then it slows down in thought ...
const REMEMBERED_S: f64 = 15.0;
/// ... and lies still after this long, s.
const STILL_AFTER_S: f64 = 30.0;
/// The distance of what is not there, m.
const NOWHERE_M: f64 = 1e9;
/// A boat this far within its untagging place, as a share of the radius, was tagged there and must leave it.
const WELL_INSIDE: f64 = 0.5;
/// It has left it at this share of the radius.
const WELL_OUTSIDE: f64 = 1.2;

/// Another boat.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Other {
    pub(crate) vehicle: VehicleId,
    pub(crate) is_enemy: bool,
    /// Where it is thought to be now.
    pub(crate) at: Ned,
    /// Its velocity over the ground, m/s.
    pub(crate) velocity: Ned,
    pub(crate) psi_rad: f64,
    pub(crate) tagged: bool,
    pub(crate) carrying: Option<FlagId>,
    /// Whether it is on the own team's side.
    pub(crate) on_own_side: bool,
}

/// A place, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    pub(crate) at: Ned,
    /// Velocity over the ground, m/s.
    pub(crate) velocity: Ned,
}

/// What somebody outside of the helm proposes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Proposed {
    pub(crate) at: SimTime,
    pub(crate) proposal: crate::Proposal,
}

/// What the helm knows now.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) chart: Chart,
    pub(crate) now: SimTime,
    pub(crate) step_s: f64,
    /// Whether it has taken in a picture.
    begun: bool,
    pub(crate) mode_since: SimTime,
    pub(crate) own: OwnBoat,
    pub(crate) at: Ned,
    /// The own velocity over the ground, m/s.
    pub(crate) velocity: Ned,
    /// All other boats that are known: mates first, then enemies, each in the scenario's order.
    pub(crate) others: Vec<Other>,
    pub(crate) variables: Vec<f64>,
    pub(crate) ears: Ears,
    pub(crate) proposed: Option<Proposed>,
    /// Who carries each flag, if anybody.
    carriers: Vec<Option<VehicleId>>,
    score: f64,
    enemy_score: f64,
    /// Tagged inside of its untagging place: it must leave before it can come home.
    leaving: bool,
}

impl Scene {
    pub(crate) fn new(chart: Chart, program: &Program, ears: Ears) -> Scene {
        Scene {
            own: OwnBoat {
                vehicle: chart.me,
                nav: game::picture::Nav::default(),
                fix_ns: SimTime::ZERO,
                imu: game::picture::Imu::default(),
                tagged: false,
                carrying: -1,
                disabled: false,
                outside: false,
                tag_ready_ns: SimTime::ZERO,
            },
            chart,
            now: SimTime::ZERO,
            begun: false,
            step_s: 0.0,
            mode_since: SimTime::ZERO,
            at: Ned::default(),
            velocity: Ned::default(),
            others: Vec::new(),
            variables: program.variables.iter().map(|variable| variable.initial).collect(),
            ears,
            proposed: None,
            carriers: Vec::new(),
            score: 0.0,
            enemy_score: 0.0,
            leaving: false,
        }
    }

    /// Takes the newest picture in; `false` if the own boat is not in it.
    pub(crate) fn take(&mut self, picture: &Picture) -> bool {
        let Some(own) = picture.own(self.chart.me) else { return false };
        let now = picture.stamp.valid_ns;
        self.step_s = if self.begun { (now - self.now).as_s().max(0.0) } else { 0.0 };
        (self.now, self.begun) = (now, true);
        self.own = *own;
        self.at = own.nav.at();
        self.velocity = velocity_of(own);
        self.others.clear();
        for mate in picture.own.iter().filter(|boat| boat.vehicle != self.chart.me) {
            let at = mate.nav.at();
            self.others.push(Other {
                vehicle: mate.vehicle,
                is_enemy: false,
                at,
                velocity: velocity_of(mate),
                psi_rad: mate.nav.psi_rad,
                tagged: mate.tagged,
                carrying: mate.carried_flag(),
                on_own_side: self.chart.is_own_side(at),
            });
        }
        for contact in &picture.contacts {
            let (at, velocity) = reckoned(contact, now);
            self.others.push(Other {
                vehicle: contact.vehicle,
                is_enemy: contact.team != self.chart.team,
                at,
                velocity,
                psi_rad: contact.psi_rad,
                tagged: contact.tagged,
                carrying: u8::try_from(contact.carrying).ok().map(FlagId),
                on_own_side: self.chart.is_own_side(at),
            });
        }
        self.carriers.clear();
        self.carriers.extend(picture.flags.iter().map(|flag| u16::try_from(flag.carrier).ok().map(VehicleId)));
        let (ours, all) = (picture.score.get(self.chart.team.index()).copied(), picture.score.iter().sum::<u32>());
        self.score = f64::from(ours.unwrap_or(0));
        self.enemy_score = f64::from(all) - self.score;
        let from_home = self.at.distance(self.chart.untag_place(self.at)) / self.chart.untag_radius_m;
        self.leaving = own.tagged && (from_home < WELL_INSIDE || self.leaving && from_home <= WELL_OUTSIDE);
        true
    }

    /// The enemies.
    pub(crate) fn enemies(&self) -> impl Iterator<Item = &Other> {
        self.others.iter().filter(|other| other.is_enemy)
    }

    /// The enemies on the own side that are not tagged.
    fn intruders(&self) -> impl Iterator<Item = &Other> {
        self.enemies().filter(|enemy| !enemy.tagged && enemy.on_own_side)
    }

    /// The mates.
    fn mates(&self) -> impl Iterator<Item = &Other> {
        self.others.iter().filter(|other| !other.is_enemy)
    }

    /// The boat that `boat` is just now.
    pub(crate) fn boat(&self, boat: Boat) -> Option<&Other> {
        let of_ours = |other: &&Other| other.carrying.is_some_and(|flag| self.is_own_flag(flag));
        let home = self.chart.own_flag();
        match boat {
            Boat::NearestEnemy => nearest(self.at, self.enemies().filter(|enemy| !enemy.tagged)),
            Boat::NearestIntruder => nearest(self.at, self.intruders()),
            Boat::NearestAttacker => nearest(home, self.enemies().filter(|enemy| !enemy.tagged)),
            Boat::FlagCarrier => nearest(self.at, self.enemies().filter(of_ours)),
            Boat::Opponent => {
                let enemies = &self.chart.enemies;
                let assigned = (!enemies.is_empty()).then(|| enemies[self.chart.rank % enemies.len()]);
                self.enemies().find(|enemy| Some(enemy.vehicle) == assigned)
            }
            Boat::NearestMate => nearest(self.at, self.mates()),
            Boat::MateCarrier => nearest(self.at, self.mates().filter(|mate| mate.carrying.is_some())),
        }
    }

    /// Where a place is now.
    pub(crate) fn spot(&self, place: &Place) -> Option<Spot> {
        let still = |at: Ned| Some(Spot { at, velocity: Ned::default() });
        match place {
            Place::At(at) => still(*at),
            Place::Point(name) => self.chart.point(name).and_then(still),
            Place::Mark(mark) => still(self.mark(*mark)),
            Place::Boat(boat) => self.boat(*boat).map(|other| Spot { at: other.at, velocity: other.velocity }),
        }
    }

    fn mark(&self, mark: Mark) -> Ned {
        match mark {
            Mark::OwnFlag => self.chart.own_flag(),
            Mark::EnemyFlag => self.enemy_flag(),
            Mark::CapturePlace => self.chart.capture_place(self.at),
            Mark::UntagPlace if self.leaving => self.enemy_flag(),
            Mark::UntagPlace => self.chart.untag_place(self.at),
        }
    }

    /// The nearest flag to attack that is home, or the nearest of all.
    fn enemy_flag(&self) -> Ned {
        let targets = self.chart.targets.iter();
        let key = |(flag, home): &&(FlagId, Ned)| {
            let is_gone = self.carriers.get(flag.index()).is_some_and(Option::is_some);
            (is_gone, self.at.distance_squared(*home))
        };
        let best = targets.min_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        best.map_or(self.at, |(_, home)| *home)
    }

    fn is_own_flag(&self, flag: FlagId) -> bool {
        self.chart.own_flags.iter().any(|(own, _)| *own == flag)
    }

    /// Who carries a flag.
    fn carried(&self, flag: FlagId) -> Option<VehicleId> {
        self.carriers.get(flag.index()).copied().flatten()
    }
}

impl Values for Scene {
    fn fact(&self, fact: Fact) -> f64 {
        let truth = |is: bool| f64::from(u8::from(is));
        let count = |n: usize| n as f64;
        match fact {
            Fact::Tagged => truth(self.own.tagged),
            Fact::HasFlag => truth(self.own.carried_flag().is_some()),
            Fact::OwnSide => truth(self.chart.is_own_side(self.at)),
            Fact::Outside => truth(self.own.outside),
            Fact::Disabled => truth(self.own.disabled),
            Fact::CanTag => truth(Ability::from(&self.own).may_tag(self.now)),
            Fact::FlagTaken => truth(self.chart.own_flags.iter().any(|(flag, _)| self.carried(*flag).is_some())),
            Fact::EnemyFlagTaken => truth(self.chart.targets.iter().any(|(flag, _)| self.carried(*flag).is_some())),
            Fact::MateHasFlag => {
                let by_mate = |flag: FlagId| self.carried(flag).is_some_and(|carrier| carrier != self.chart.me);
                truth(self.chart.targets.iter().any(|(flag, _)| by_mate(*flag)))
            }
            Fact::EnemyInZone => truth(self.intruders().next().is_some()),
            Fact::EnemiesInZone => count(self.intruders().count()),
            Fact::Enemies => count(self.enemies().count()),
            Fact::EnemiesTagged => count(self.enemies().filter(|enemy| enemy.tagged).count()),
            Fact::Mates => count(self.chart.mates.len()),
            Fact::MatesTagged => count(self.mates().filter(|mate| mate.tagged).count()),
            Fact::Rank => count(self.chart.rank),
            Fact::Score => self.score,
            Fact::EnemyScore => self.enemy_score,
            Fact::TimeS => self.now.as_s(),
            Fact::TimeLeftS => (self.chart.time_limit - self.now).as_s().max(0.0),
            Fact::ModeS => (self.now - self.mode_since).as_s(),
            Fact::StepS => self.step_s,
            Fact::SpeedMS => self.velocity.length(),
        }
    }

    fn variable(&self, index: u16) -> f64 {
        self.variables.get(usize::from(index)).copied().unwrap_or(0.0)
    }

    fn measure(&self, measure: Measure, place: &Place) -> f64 {
        let spot = self.spot(place);
        match measure {
            Measure::Distance => spot.map_or(NOWHERE_M, |spot| self.at.distance(spot.at)),
            Measure::Closing => spot.map_or(0.0, |spot| self.closing_m_s(spot)),
            Measure::Known => f64::from(u8::from(spot.is_some())),
            Measure::OnOwnSide => f64::from(u8::from(spot.is_some_and(|spot| self.chart.is_own_side(spot.at)))),
        }
    }

    fn mates(&self, condition: &Expression) -> f64 {
        self.ears.count(self, condition)
    }
}

impl Scene {
    /// How fast the distance to a spot shrinks, m/s.
    fn closing_m_s(&self, spot: Spot) -> f64 {
        let line = spot.at - self.at;
        let distance_m = line.length();
        if distance_m < 1e-6 {
            return 0.0;
        }
        (self.velocity - spot.velocity).dot(line) / distance_m
    }
}

/// Velocity over the ground, m/s.
fn velocity_of(boat: &OwnBoat) -> Ned {
    boat.nav.velocity_m_s()
}

/// Where a contact is thought to be now, and how fast: it goes on as seen, then slows down and lies still.
fn reckoned(contact: &Contact, now: SimTime) -> (Ned, Ned) {
    let seen = Ned { north: contact.north_m, east: contact.east_m };
    let velocity = Ned { north: contact.velocity_north_m_s, east: contact.velocity_east_m_s };
    let age_s = (now - contact.seen_ns).as_s().max(0.0);
    let slowing_s = (age_s - REMEMBERED_S).clamp(0.0, STILL_AFTER_S - REMEMBERED_S);
    let left = 1.0 - slowing_s / (STILL_AFTER_S - REMEMBERED_S);
    // The integral of a speed that is full up to the first time and falls in proportion from there.
    let gone_s = age_s.min(REMEMBERED_S) + slowing_s * 0.5 * (1.0 + left);
    (seen + velocity.scaled(gone_s), velocity.scaled(left))
}

/// The one nearest to `at`; of two equally near the first.
fn nearest<'a>(at: Ned, others: impl Iterator<Item = &'a Other>) -> Option<&'a Other> {
    others.min_by(|a, b| at.distance_squared(a.at).total_cmp(&at.distance_squared(b.at)))
}
