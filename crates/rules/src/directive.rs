//! Directives: what the rules impose on a boat, for the world or a gateway to enforce.

use super::{Referee, Standing, TaggedBoat};
use primitives::frame::Ned;
use primitives::id::VehicleId;

/// What the rules impose on one boat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Directive {
    /// It does as its mind says, at no more than this share of its top speed.
    Free {
        /// Between 0 and 1.
        speed_factor: f64,
    },
    /// It is tagged and driven straight home, whatever its mind says, at this share of its top speed.
    DrivenHome {
        /// Where it is freed.
        to: Ned,
        /// Between 0 and 1.
        speed_factor: f64,
    },
    /// It holds, whatever its mind says: out of action, or out of play for good.
    Hold,
}

impl Referee {
    /// What the rules impose on a boat that is at `at`. Of two limits to its speed the lower one holds.
    #[inline]
    #[must_use]
    pub fn directive(&self, standing: &Standing, vehicle: VehicleId, at: Ned) -> Directive {
        let boat = &standing.vehicles[vehicle.index()];
        if boat.disabled || !boat.in_play {
            return Directive::Hold;
        }
        let limit = |applies, factor| if applies { factor } else { 1.0_f64 };
        let speed_factor = limit(boat.tagged, self.rules.tagged_speed_factor)
            .min(limit(boat.outside, self.rules.outside_speed_factor));
        let driven = boat.tagged && self.rules.tagged_boat == TaggedBoat::IsDriven;
        let home = || self.rules.untag_place(&self.field, self.team_of[vehicle.index()], at);
        match driven.then(home).flatten() {
            Some(to) => Directive::DrivenHome { to, speed_factor },
            None => Directive::Free { speed_factor },
        }
    }
}
