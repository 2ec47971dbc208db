//! Tags: a boat on its own side tags intruders within reach.

use super::claim::{Claim, settle};
use super::{Ability, Acting, Look, Notes, Referee, Standing};
use crate::event::{Event, TagCause};
use primitives::id::VehicleId;
use primitives::near::Pair;

impl Referee {
    /// Tags intruders as soon as possible: automatically, or on request once the tagger believes
    /// that the intruder is within reach.
    ///
    /// Each tagger claims one intruder; [`super::Resolution`] decides between several taggers of
    /// the same intruder. Only the chosen tagger gets the cooldown, and the points if the tag
    /// succeeds: the others' attempts cost nothing.
    pub(super) fn tag(
        &self,
        standing: &mut Standing,
        notes: &mut Notes,
        look: &Look<'_>,
        events: &mut Vec<Event>,
    ) {
        let reach_squared = self.rules.tag_radius_m * self.rules.tag_radius_m;
        notes.claims.clear();
        for &Pair {
            a,
            b,
            distance_squared,
        } in look.near
        {
            if distance_squared >= reach_squared {
                continue;
            }
            for (by, on) in [(a, b), (b, a)] {
                if self.may_tag(standing, usize::from(by), usize::from(on), look) {
                    notes.claims.push(Claim {
                        by,
                        on,
                        distance_squared,
                        carries: standing.vehicles[usize::from(on)].carrying.is_some(),
                    });
                }
            }
        }
        if notes.claims.is_empty() {
            return;
        }
        let noise = self.tag_noise.at(standing.now);
        // Time in nanoseconds plus a boat's index differs for every attempt: checks are at least 1
        // ms apart, and a boat makes one attempt per check.
        let first = standing.now.0 as u64;
        let fails = |claim: &Claim| {
            noise.unit(first.wrapping_add(claim.by.into())) >= self.rules.tag_probability
        };
        settle(
            &mut notes.claims,
            self.rules.tag_choice,
            self.rules.resolution,
            fails,
        );
        for claim in &notes.claims {
            let tagger = VehicleId(claim.by);
            let target = VehicleId(claim.on);
            standing.vehicles[tagger.index()].tag_ready = self.rules.tag_ready_after(standing.now);
            if fails(claim) {
                continue;
            }
            standing.put_tag(target, TagCause::Opponent(tagger), events);
            standing.drop_flag(target, events);
            standing.award(self.team_of[tagger.index()], self.rules.points.tag);
        }
    }

    /// Whether `tagger` may tag `target`, ignoring the distance between them.
    ///
    /// Both must be on the tagger's own side, and the target not on *its* own side. The scrimmage
    /// line belongs to both sides: a boat on it is safe but can tag, so no boat is ever both tagger
    /// and target.
    fn may_tag(&self, standing: &Standing, tagger: usize, target: usize, look: &Look<'_>) -> bool {
        let by = &standing.vehicles[tagger];
        let on = &standing.vehicles[target];
        let own = self.team_of[tagger];
        let other = self.team_of[target];
        let at = |i: usize| self.rules.side_place(look.legs[i]);
        let able = own != other && by.in_play && Ability::from(by).may_tag(standing.now);
        let asks = self.rules.tags_and_grabs == Acting::Automatic || look.asks[tagger].tag;
        able && asks
            && on.in_play
            && !on.tagged
            && !on.outside
            && self.field.is_own_side(own, at(tagger))
            && self.field.is_own_side(own, at(target))
            && !self.field.is_own_side(other, at(target))
    }
}

impl Standing {
    pub(super) fn put_tag(&mut self, vehicle: VehicleId, cause: TagCause, events: &mut Vec<Event>) {
        let boat = &mut self.vehicles[vehicle.index()];
        boat.tagged = true;
        boat.tagged_at = self.now;
        events.push(Event::Tagged { vehicle, cause });
    }
}
