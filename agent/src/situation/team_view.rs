//! A team's view: the knowledge that all boats of a team share about each other and other boats.
//!
//! A mind computes it from each picture. In a process with several boats of a team, the runner
//! computes it once for all of them: in a large fleet, it takes longer than the rest of a decision.

use super::game_model::TeamModel;
use super::interception::{self, Interceptor, Intruder, Pair};
use super::turn_estimate::{TurnEstimate, turning_on};
use super::{MovingPoint, OtherBoat, Velocity};
use messages::Picture;
use messages::picture::{Contact, OwnBoat};
use primitives::frame::{Body, ned_from_body};
use primitives::{FlagId, Ned, SimTime, TeamId, VehicleId};
use rules::event::{EventRecord, TagCause};
use rules::{Event, tag_wait_s};
use std::sync::{Arc, Mutex, PoisonError};

/// How long a contact is assumed to keep its velocity before it slows down, s.
const KEEPS_ON_S: f64 = 15.0;
/// Time after which a contact is assumed to be at rest, s.
const STILL_AFTER_S: f64 = 30.0;
/// Age of a teammate's fix beyond which its position is dead-reckoned, s. With the usual delays, a
/// boat moves by less than a receiver's error, and rotating the motion of a whole fleet takes time.
const LATE_S: f64 = 0.5;
/// Maximum number of boats that are compared with a place one by one.
const FEW: usize = 32;
/// Width of the rows into which a larger number of boats is sorted, m.
const ROW_M: f64 = 16.0;

/// The track of a boat of the team since its last fix, given its velocity at the fix along its
/// axes.
#[derive(Clone, Copy, Debug)]
struct Track {
    fix: SimTime,
    velocity: Body,
    gone: Ned,
    until: SimTime,
}

/// The knowledge that all boats of a team share about each other and other boats.
#[derive(Clone, Debug)]
pub struct TeamView {
    model: Arc<TeamModel>,
    now: SimTime,
    /// All known boats: the team's own first, then contacts, each in the picture's order.
    pub(super) boats: Vec<OtherBoat>,
    /// The number of the team's own boats.
    pub(super) own: usize,
    /// The boats, if many, by row from south to north, then from west to east: row, place, index.
    rows: Vec<(i64, Ned, usize)>,
    /// Tracks of the team's boats, by vehicle index.
    tracks: Vec<Option<Track>>,
    /// Turn estimates of contacts, by vehicle index.
    turns: Vec<Option<TurnEstimate>>,
    /// By vehicle index: the earliest time of the next tag, for enemies that tagged a boat of the
    /// team.
    tag_ready: Vec<SimTime>,
    /// Boats that power play has put out of action.
    disabled: Vec<VehicleId>,
    pairings: Pairings,
    /// The number of pictures so far, and the runner that owns the view; `None` for a single mind.
    pictures: u64,
    runner: Option<Arc<()>>,
}

/// Interception pairs of the current picture, with the previous pairs from which they follow.
#[derive(Debug, Default)]
struct Pairings(Mutex<Vec<[Arc<[Pair]>; 2]>>);

impl Clone for Pairings {
    /// Returns empty pairings: a copy would only save recomputing them.
    fn clone(&self) -> Pairings {
        Pairings::default()
    }
}

impl TeamView {
    /// Before the first picture.
    pub(super) fn new(model: Arc<TeamModel>) -> TeamView {
        TeamView {
            model,
            now: SimTime::ZERO,
            boats: Vec::new(),
            own: 0,
            rows: Vec::new(),
            tracks: Vec::new(),
            turns: Vec::new(),
            tag_ready: Vec::new(),
            disabled: Vec::new(),
            pairings: Pairings::default(),
            pictures: 0,
            runner: None,
        }
    }

    /// The same view, for all minds of a runner.
    pub(crate) fn shared(self) -> TeamView {
        TeamView {
            runner: Some(Arc::default()),
            ..self
        }
    }

    /// The same view, for one mind alone.
    pub(super) fn own(view: &mut Arc<TeamView>) -> &mut TeamView {
        let view = Arc::make_mut(view);
        view.runner = None;
        view
    }

    /// The team of the view.
    pub(crate) fn team(&self) -> TeamId {
        self.model.team
    }

    /// Whether this view is `before` after one more picture.
    pub(super) fn follows(&self, before: &TeamView) -> bool {
        self.pictures == before.pictures + 1
            && match (&self.runner, &before.runner) {
                _ if before.pictures == 0 => self.model == before.model,
                (Some(runner), Some(before)) => Arc::ptr_eq(runner, before),
                _ => false,
            }
    }

    /// Becomes a copy of `before`, except for the parts that the next picture replaces.
    pub(crate) fn remember(&mut self, before: &TeamView) {
        self.tracks.clone_from(&before.tracks);
        self.turns.clone_from(&before.turns);
        self.tag_ready.clone_from(&before.tag_ready);
        self.disabled.clone_from(&before.disabled);
        self.pictures = before.pictures;
    }

    /// Processes the next picture.
    pub(crate) fn take_in(&mut self, picture: &Picture) {
        let now = picture.stamp.valid_ns;
        self.now = now;
        self.pictures += 1;
        self.note_events(picture);
        let pairings = self.pairings.0.get_mut();
        pairings.unwrap_or_else(PoisonError::into_inner).clear();
        self.boats.clear();
        self.own = picture.own.len();
        for mate in &picture.own {
            let (at, velocity) = self.reckoned(mate, now);
            self.boats.push(OtherBoat {
                vehicle: mate.vehicle,
                is_enemy: false,
                at,
                // In games of 20 against 20 or more, rotating all velocities to the field's frame
                // measurably slowed down decisions, and only a few are needed.
                velocity: Velocity::Body(velocity),
                psi_rad: mate.nav.psi_rad,
                yaw_rate_rad_s: mate.nav.yaw_rate_rad_s,
                turned: None,
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
            self.boats.push(OtherBoat {
                vehicle: contact.vehicle,
                is_enemy,
                at,
                velocity: Velocity::Ned(velocity),
                psi_rad: contact.psi_rad,
                yaw_rate_rad_s: turn.yaw_rate_rad_s(now),
                turned: None,
                tagged: contact.tagged,
                disabled: self.disabled.contains(&contact.vehicle),
                carrying: u8::try_from(contact.carrying).ok().map(FlagId),
                tag_ready: self.tag_ready.get(i).copied().unwrap_or_default(),
                age_s: (now - contact.seen_ns).as_s(),
                intrudes: is_enemy && self.model.is_own_side(at),
            });
        }
        self.sort();
    }

    /// One of the team's own boats.
    pub(super) fn own_boat(&self, vehicle: VehicleId) -> Option<&OtherBoat> {
        self.boats[..self.own]
            .iter()
            .find(|boat| boat.vehicle == vehicle)
    }

    /// The current position of a boat of the team, and its velocity along its axes. While fixes
    /// drop out or a link is silent, the boat moves on, so its position is dead-reckoned with its
    /// headings, which do not drop out.
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

    /// Prepares for many queries about many boats.
    fn sort(&mut self) {
        self.rows.clear();
        if self.boats.len() <= FEW {
            return;
        }
        for (i, boat) in self.boats.iter_mut().enumerate() {
            boat.turned = Some(boat.turning_on());
            self.rows.push((row(boat.at.north), boat.at, i));
        }
        self.rows
            .sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.east.total_cmp(&b.1.east)));
    }

    /// Calls `each` with the index and the distance (m) of every boat within this distance of a
    /// place, in any order.
    pub(super) fn near(&self, at: Ned, reach_m: f64, mut each: impl FnMut(usize, f64)) {
        // Avoid the square root for boats that are far away.
        let far_m2 = reach_m * reach_m * (1.0 + 1e-9);
        let mut look = |i: usize, there: Ned| {
            let squared = at.distance_squared(there);
            if squared <= far_m2 && squared.sqrt() < reach_m {
                each(i, squared.sqrt());
            }
        };
        if self.rows.is_empty() {
            let boats = self.boats.iter().enumerate();
            return boats.for_each(|(i, boat)| look(i, boat.at));
        }
        let [first, last] = [-reach_m, reach_m].map(|by_m| row(at.north + by_m));
        let [west, east] = [-reach_m, reach_m].map(|by_m| at.east + by_m);
        let mut rest = &self.rows[self.rows.partition_point(|boat| boat.0 < first)..];
        while let Some(row) = rest.first().map(|boat| boat.0).filter(|row| *row <= last) {
            let (boats, others) = rest.split_at(rest.partition_point(|boat| boat.0 == row));
            let start = boats.partition_point(|boat| boat.1.east < west);
            boats[start..]
                .iter()
                .take_while(|boat| boat.1.east <= east)
                .for_each(|(_, there, i)| look(*i, *there));
            rest = others;
        }
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

    /// The interception pairs that follow from `before`.
    pub(super) fn pairs_after(&self, before: &Arc<[Pair]>) -> Arc<[Pair]> {
        let mut known = self
            .pairings
            .0
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // Boats of a team that requested pairs at the same decisions have the same pairs. A boat
        // that did not, because it was tagged, gets its own pairs until the pairs agree again.
        let same = known
            .iter()
            .find(|[other, _]| Arc::ptr_eq(other, before) || other == before);
        if let Some([_, pairs]) = same {
            return Arc::clone(pairs);
        }
        let new = self.intercepted(before);
        let same = known.iter().find(|[_, pairs]| **pairs == *new);
        let pairs = same.map_or_else(|| new.into(), |[_, pairs]| Arc::clone(pairs));
        known.push([Arc::clone(before), Arc::clone(&pairs)]);
        pairs
    }

    /// Computes the interception pairs.
    fn intercepted(&self, before: &[Pair]) -> Vec<Pair> {
        let contacts = self.boats[self.own..].iter();
        let mut intruders: Vec<(f64, Intruder)> = contacts
            .filter(|boat| boat.is_intruder())
            .map(|boat| {
                let intruder = Intruder {
                    vehicle: boat.vehicle,
                    at: boat.at,
                    velocity: boat.velocity(),
                };
                let flag = self.model.own_flag_near(boat.at, self.now);
                (flag.distance_squared(boat.at), intruder)
            })
            .collect();
        // Order by distance to the flag nearest to each intruder, not nearest to a boat, and use
        // the whole team's knowledge, so that all boats of the team compute the same order and
        // pairs.
        intruders.sort_by(|a, b| a.0.total_cmp(&b.0));
        let intruders: Vec<Intruder> = intruders.into_iter().map(|(_, boat)| boat).collect();
        let own = self.boats[..self.own].iter();
        let mut interceptors: Vec<Interceptor> = own
            .filter(|boat| !boat.tagged && boat.carrying.is_none())
            .map(|boat| Interceptor {
                vehicle: boat.vehicle,
                at: boat.at,
                speed_m_s: self.model.boat_speeds_m_s[boat.vehicle.index()],
                unready_s: tag_wait_s(boat.tag_ready, self.now),
            })
            .collect();
        interceptors.sort_by_key(|boat| boat.vehicle);
        interception::assign(&interceptors, &intruders, before)
    }
}

impl OtherBoat {
    /// The boat's position and velocity, extrapolated through a brief continued turn.
    pub(crate) fn turning_on(&self) -> MovingPoint {
        self.turned.unwrap_or_else(|| {
            let here = MovingPoint {
                at: self.at,
                velocity: self.velocity(),
            };
            turning_on(here, self.yaw_rate_rad_s)
        })
    }

    /// Whether the boat is an untagged enemy on the team's own side.
    pub(super) fn is_intruder(&self) -> bool {
        self.is_enemy && !self.tagged && self.intrudes
    }
}

fn row(north_m: f64) -> i64 {
    (north_m / ROW_M).floor() as i64
}

/// The estimated current position and velocity of a contact: constant velocity, then slowing down,
/// then at rest.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::situation::game_model::GameModel;
    use messages::picture::Nav;
    use primitives::stream::Stream;
    use std::path::Path;

    #[test]
    fn the_boats_found_near_a_place_are_those_within_reach() {
        let game =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/fleet_20v20.toml");
        let scenario: scenario::Scenario = scenario::load(&game).unwrap_or_else(|e| panic!("{e}"));
        let me = VehicleId(0);
        let model = GameModel::new(&scenario, me, crate::roles::role_of(&scenario, me));
        let mut view = TeamView::new(model.of_team);
        let mut stream = Stream::new(1, "near");
        for count in [3, FEW, FEW + 1, 400] {
            let boat = |i| {
                let mut at_m = || match i {
                    0 => 1e300,
                    _ => stream.between(-150.0, 150.0),
                };
                let nav = Nav {
                    north_m: at_m(),
                    east_m: -at_m(),
                    ..Nav::default()
                };
                OwnBoat::new(VehicleId(i as u16), nav)
            };
            let picture = Picture {
                own: (0..count).map(boat).collect(),
                ..Picture::default()
            };
            view.take_in(&picture);
            for (at, reach_m) in [(1, 40.0), (2, 1e9), (0, 40.0), (1, 0.0), (1, f64::NAN)] {
                let at = view.boats[at].at;
                let mut got = vec![];
                view.near(at, reach_m, |i, distance_m| got.push((i, distance_m)));
                got.sort_by_key(|(i, _)| *i);
                let distances = view.boats.iter().map(|boat| at.distance(boat.at));
                let want = distances.enumerate().filter(|(_, m)| *m < reach_m);
                assert_eq!(got, want.collect::<Vec<_>>(), "{count} boats, {reach_m} m");
            }
        }
    }
}
