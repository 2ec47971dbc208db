//! Requests: what a boat asks the referee for, where the rules want it to ask.

use super::Rules;
use crate::field::Field;
use crate::frame::Ned;
use crate::id::VehicleId;
use crate::picture::Picture;

/// What a boat asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asks {
    /// For a tag.
    pub tag: bool,
    /// For a flag.
    pub grab: bool,
}

/// What the boats of a team ask for by its picture, as pRangeEvent of the Aquaticus missions does: whoever believes to be
/// in reach asks, since a request that is refused costs nothing.
pub fn asks_of<'a>(rules: &Rules, field: &'a Field, picture: &'a Picture) -> impl Iterator<Item = (VehicleId, Asks)> {
    let (tag_m, grab_m) = (rules.tag_radius_m, rules.grab_radius_m);
    picture.own.iter().map(move |boat| {
        let at = boat.nav.at();
        let is_near = |other: Ned, reach_m: f64| at.distance_squared(other) < reach_m * reach_m;
        let opponents = picture.contacts.iter().filter(|contact| contact.team.0 != picture.team && !contact.tagged);
        let mut flags = field.flags.iter().filter(|flag| flag.team.0 != picture.team);
        let asks = Asks {
            tag: opponents.into_iter().any(|other| is_near(Ned { north: other.north_m, east: other.east_m }, tag_m)),
            grab: flags.any(|flag| is_near(flag.home, grab_m)),
        };
        (boat.vehicle, asks)
    })
}
