//! The boats' requests to the referee, for rules that require requests.

use messages::Picture;
use primitives::{Ned, VehicleId};
use rules::{Asks, Field, Rules};

/// The requests that a team's boats make based on their picture, as with pRangeEvent in the
/// Aquaticus missions. Every boat that believes it is in range makes a request, since a refusal
/// costs nothing.
pub(super) fn asks_of<'a>(
    rules: &Rules,
    field: &'a Field,
    picture: &'a Picture,
) -> impl Iterator<Item = (VehicleId, Asks)> {
    let tag_m = rules.tag_radius_m;
    let now = picture.stamp.valid_ns;
    picture.own.iter().map(move |boat| {
        let at = boat.nav.at();
        let is_near = |other: Ned, reach_m: f64| at.distance_squared(other) < reach_m * reach_m;
        let opponents = picture
            .contacts
            .iter()
            .filter(|contact| contact.team.0 != picture.team && !contact.tagged);
        let mut flags = field
            .flags
            .iter()
            .filter(|flag| flag.team.0 != picture.team);
        let asks = Asks {
            tag: opponents.into_iter().any(|other| {
                is_near(
                    Ned {
                        north: other.north_m,
                        east: other.east_m,
                    },
                    tag_m,
                )
            }),
            grab: flags.any(|flag| is_near(flag.home(now), rules.radii_of(flag).grab_m)),
        };
        (boat.vehicle, asks)
    })
}
