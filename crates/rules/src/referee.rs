//! The referee: looks at all boats once a tick and says what happened.

use super::claim::Claim;
use super::{Asks, Resolution, Rules, Standing};
use crate::event::Event;
use crate::field::Field;
use primitives::frame::Leg;
use primitives::id::{TeamId, VehicleId};
use primitives::near::Pair;
use primitives::stream::Stream;
use primitives::time::SimTime;

/// Who judges a game: constant while it is played. What changes is the [`Standing`].
#[derive(Clone, Debug)]
pub struct Referee {
    pub(super) rules: Rules,
    pub(super) field: Field,
    pub(super) team_of: Vec<TeamId>,
}

/// The referee's notepad: its memory is used again at every look, and holds nothing from one to the next.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    pub(super) claims: Vec<Claim>,
    pub(super) touching: Vec<(VehicleId, VehicleId)>,
}

/// What the referee sees when it looks.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// By vehicle.
    pub legs: &'a [Leg],
    /// By vehicle, where the rules want boats to ask: [`Acting::OnRequest`](super::Acting::OnRequest).
    pub asks: &'a [Asks],
    /// All pairs within [`Rules::reach_m`] or more, in the order of [`primitives::near::Near`].
    pub near: &'a [Pair],
    /// Later than the last look.
    pub now: SimTime,
}

impl Referee {
    /// The referee of games by these rules on this field; `team_of` is by vehicle.
    #[must_use]
    pub fn new(rules: Rules, field: Field, team_of: Vec<TeamId>) -> Referee {
        Referee { rules, field, team_of }
    }

    /// By which rules.
    #[must_use]
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// On which field.
    #[must_use]
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// Each vehicle's team, by vehicle.
    #[must_use]
    pub fn team_of(&self) -> &[TeamId] {
        &self.team_of
    }

    /// How the game stands before it begins. The boats' power plays are drawn from `stream`; without
    /// such a rule nothing is drawn.
    pub fn start(&self, stream: &mut Stream) -> Standing {
        let mut standing = Standing::new(self.team_of.len(), self.field.flags.len(), self.teams());
        self.draw_power_plays(&mut standing, stream);
        standing
    }

    /// Looks at all boats and appends what happened.
    ///
    /// The order of the list below is the order of resolution. Every phase is judged from how things
    /// stood when it began, whatever the order of the boats, so that mirrored teams get mirrored results.
    /// What a boat did or suffered at this look is nothing to build on until the next one: a flag
    /// that was brought home is not grabbed yet, a flag that was grabbed is not captured yet, a boat
    /// that was tagged is not freed yet. [`Resolution::InTurn`] is another order, for comparing games with
    /// those of Pyquaticus.
    ///
    /// Once the game is over, nothing happens any more.
    pub fn advance(&self, standing: &mut Standing, notes: &mut Notes, look: &Look<'_>, events: &mut Vec<Event>) {
        if standing.over {
            return;
        }
        standing.now = look.now;
        let at = &|i: usize| look.legs[i].to;
        let tags = is_due(look.now, self.rules.tag_look_period);
        let flags = is_due(look.now, self.rules.flag_look_period);
        self.switch_power_plays(standing, events);
        if tags {
            // First: a boat that has left is out of the taggers' reach, and loses its flag all
            // the same.
            self.watch_boundary(standing, at, events);
        }
        if flags && self.rules.resolution == Resolution::InTurn {
            self.grab(standing, notes, look, events);
        }
        if tags {
            // Before grabs: a boat that is tagged at the flag does not take it. In turn, as
            // Pyquaticus has it, whoever is listed first has more tags; so that is for
            // comparison only.
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

    /// Takes a boat out of the game (its numbers went bad): it loses its flag, and is only something to
    /// bump into from now on.
    pub fn retire(&self, standing: &mut Standing, vehicle: VehicleId, events: &mut Vec<Event>) {
        standing.vehicles[vehicle.index()].in_play = false;
        standing.drop_flag(vehicle, events);
    }

    /// How many teams there are.
    pub(super) fn teams(&self) -> usize {
        let playing = self.team_of.iter().map(|team| team.index() + 1).max();
        self.field.zones.len().max(playing.unwrap_or(0))
    }
}

/// Whether something is looked at now that is looked at so often; at every look if there is no time between.
fn is_due(now: SimTime, period: SimTime) -> bool {
    period <= SimTime::ZERO || now.0 % period.0 == 0
}
