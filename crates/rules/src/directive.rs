//! Directives: constraints that the rules impose on a boat, enforced by the world or a gateway.

use super::{Referee, Standing, TaggedBoat};
use primitives::frame::Ned;
use primitives::id::VehicleId;

/// The constraint that the rules impose on one boat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Directive {
    /// The boat follows its mind, up to this fraction of its top speed.
    Free {
        /// Between 0 and 1.
        speed_factor: f64,
    },
    /// The boat is tagged and driven straight home at this fraction of its top speed; its mind is
    /// ignored.
    DrivenHome {
        /// The untag place.
        to: Ned,
        /// Between 0 and 1.
        speed_factor: f64,
    },
    /// The boat holds and its mind is ignored: it is out of action, or permanently out of play.
    Hold,
}

impl Referee {
    /// The constraint on a boat at `at`. The lower of two speed limits applies.
    #[inline]
    pub fn directive(&self, standing: &Standing, vehicle: VehicleId, at: Ned) -> Directive {
        let boat = &standing.vehicles[vehicle.index()];
        if boat.disabled || !boat.in_play {
            return Directive::Hold;
        }
        let limit = |applies, factor| if applies { factor } else { 1.0_f64 };
        let speed_factor = limit(boat.tagged, self.rules.tagged_speed_factor)
            .min(limit(boat.outside, self.rules.outside_speed_factor));
        let driven = boat.tagged && self.rules.tagged_boat == TaggedBoat::IsDriven;
        let home = || {
            self.rules
                .untag_place(&self.field, self.team_of[vehicle.index()], at, standing.now)
        };
        match driven.then(home).flatten() {
            Some(to) => Directive::DrivenHome { to, speed_factor },
            None => Directive::Free { speed_factor },
        }
    }
}
