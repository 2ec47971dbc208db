//! The referee: checks all boats once per tick and reports events.

use super::claim::Claim;
use super::{Resolution, Rules, Standing};
use crate::event::Event;
use crate::field::Field;
use primitives::frame::Leg;
use primitives::id::{TeamId, VehicleId};
use primitives::near::Pair;
use primitives::reseed::TimedNoise;
use primitives::stream::Stream;
use primitives::time::SimTime;

/// A game's referee. It never changes; only the [`Standing`] does.
#[derive(Clone, Debug)]
pub struct Referee {
    /// The rules of the game.
    pub rules: Rules,
    /// The field of the game.
    pub field: Field,
    /// The team of each vehicle, by vehicle index.
    pub team_of: Vec<TeamId>,
    /// The time at which each vehicle joins the game, by vehicle index.
    pub joins: Vec<SimTime>,
    /// Decides which tags succeed.
    pub tag_noise: TimedNoise,
}

/// The requests of one boat, under rules that require them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asks {
    /// Requests a tag.
    pub tag: bool,
    /// Requests a flag.
    pub grab: bool,
}

/// Scratch memory, reused at every check; it carries no state between checks.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    pub(super) claims: Vec<Claim>,
    pub(super) touching: Vec<(VehicleId, VehicleId)>,
}

/// The referee's view of one tick.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Motion in the last tick, by vehicle index.
    pub legs: &'a [Leg],
    /// Requests by vehicle index, if the rules require them:
    /// [`Acting::OnRequest`](super::Acting::OnRequest).
    pub asks: &'a [Asks],
    /// All pairs within [`Rules::reach_m`], and possibly others, in the order of
    /// [`primitives::near::Near`].
    pub near: &'a [Pair],
    /// Simulated time, later than at the last check.
    pub now: SimTime,
}

impl Referee {
    /// The standing before the start. Only power plays use `stream`.
    pub fn start(&self, stream: &mut Stream) -> Standing {
        let mut standing = Standing::new(self.team_of.len(), self.field.flags.len(), self.teams());
        self.draw_power_plays(&mut standing, stream);
        standing
    }

    /// Checks all boats and appends events.
    ///
    /// The phases are resolved in the order in which this function calls them. Each phase is judged
    /// by the standing at its start. The order of the boats therefore does not matter, and mirrored
    /// teams get mirrored results. Results of this check take effect at the next one: a flag
    /// brought home cannot be grabbed yet, a grabbed flag cannot be captured yet, and a tagged boat
    /// cannot be untagged yet. [`Resolution::InTurn`] uses a different order, for comparison with
    /// Pyquaticus.
    ///
    /// Nothing happens after the end of the game.
    pub fn advance(
        &self,
        standing: &mut Standing,
        notes: &mut Notes,
        look: &Look<'_>,
        events: &mut Vec<Event>,
    ) {
        if standing.over {
            return;
        }
        standing.now = look.now;
        let at = &|i: usize| look.legs[i].to;
        let tags = is_due(look.now, self.rules.tag_look_period);
        let flags = is_due(look.now, self.rules.flag_look_period);
        self.switch_disabled(standing, events);
        if tags {
            // Check the boundary first, because a boat that has left is out of the taggers' reach
            // but must still lose its flag.
            self.watch_boundary(standing, at, events);
            self.watch_obstacles(standing, at, events);
        }
        if flags && self.rules.resolution == Resolution::InTurn {
            self.grab(standing, notes, look, events);
        }
        if tags {
            // Tag before grabbing, because a boat tagged at the flag must not grab it. With
            // `InTurn`, as in Pyquaticus, boats listed first tag more often; that order is only for
            // comparison.
            self.tag(standing, notes, look, events);
        }
        if flags && self.rules.resolution == Resolution::AtOnce {
            self.grab(standing, notes, look, events);
        }
        if flags {
            self.capture(standing, notes, look, events);
            self.untag(standing, at, events);
        }
        if tags {
            self.watch_collisions(standing, notes, look.near, events);
        }
        self.watch_keepouts(standing, at, events);
        self.end(standing, events);
    }

    /// Retires a boat whose state became non-finite: it loses its flag and becomes an obstacle.
    pub fn retire(&self, standing: &mut Standing, vehicle: VehicleId, events: &mut Vec<Event>) {
        standing.vehicles[vehicle.index()].in_play = false;
        standing.drop_flag(vehicle, events);
    }

    /// The number of teams.
    pub(super) fn teams(&self) -> usize {
        let playing = self.team_of.iter().map(|team| team.index() + 1).max();
        self.field.zones.len().max(playing.unwrap_or(0))
    }
}

/// Whether a periodic check is due at `now`. With a period of 0, it always is.
fn is_due(now: SimTime, period: SimTime) -> bool {
    period <= SimTime::ZERO || now.0 % period.0 == 0
}
