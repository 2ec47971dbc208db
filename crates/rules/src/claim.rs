//! Claims: competing attempts by boats in one tick, and their outcomes.

use super::{Resolution, TagChoice};
use std::cmp::Ordering;

/// Boat `by` claims `on`, a boat to tag or a flag to grab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claim {
    pub(super) by: u16,
    pub(super) on: u16,
    pub(super) distance_squared: f64,
    /// Whether `on` is a boat that carries a flag.
    pub(super) carries: bool,
}

impl Claim {
    fn nearer(&self, other: &Claim) -> Ordering {
        self.distance_squared.total_cmp(&other.distance_squared)
    }
}

/// Reduces the claims to those that succeed.
///
/// Each boat claims one target, by `choice`. `AtOnce`: of all boats that claim the same target, the
/// nearest gets it; the others lose nothing and may claim again at the next check. Granted claims
/// are ordered by target. `InTurn`: each boat in turn gets the first target by `choice` that no
/// earlier boat has claimed without failing, and no other. Granted claims, failed ones included,
/// are ordered by boat. Ties go to the lower index.
pub(super) fn settle(
    claims: &mut Vec<Claim>,
    choice: TagChoice,
    resolution: Resolution,
    fails: impl Fn(&Claim) -> bool,
) {
    claims.sort_unstable_by(|x, y| {
        let wanted = match choice {
            TagChoice::Nearest => x.nearer(y),
            TagChoice::First => Ordering::Equal,
            TagChoice::CarrierFirst => y.carries.cmp(&x.carries).then(x.nearer(y)),
        };
        x.by.cmp(&y.by).then(wanted).then(x.on.cmp(&y.on))
    });
    match resolution {
        Resolution::AtOnce => {
            claims.dedup_by_key(|claim| claim.by);
            claims.sort_unstable_by(|x, y| x.on.cmp(&y.on).then(x.nearer(y)).then(x.by.cmp(&y.by)));
            claims.dedup_by_key(|claim| claim.on);
        }
        Resolution::InTurn => {
            let mut granted = 0;
            for i in 0..claims.len() {
                let claim = claims[i];
                let blocks =
                    |other: &Claim| other.by == claim.by || other.on == claim.on && !fails(other);
                if !claims[..granted].iter().any(blocks) {
                    claims[granted] = claim;
                    granted += 1;
                }
            }
            claims.truncate(granted);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Resolution::{AtOnce, InTurn};
    use TagChoice::{CarrierFirst, First, Nearest};

    /// The granted claims, as boat and target. Boat 9 fails, and target 7 carries a flag.
    fn settled(
        claims: &[(u16, u16, f64)],
        choice: TagChoice,
        resolution: Resolution,
    ) -> Vec<(u16, u16)> {
        let claim = |&(by, on, distance_squared)| Claim {
            by,
            on,
            distance_squared,
            carries: on == 7,
        };
        let mut claims: Vec<Claim> = claims.iter().map(claim).collect();
        settle(&mut claims, choice, resolution, |claim| claim.by == 9);
        claims.iter().map(|claim| (claim.by, claim.on)).collect()
    }

    #[test]
    fn each_gets_one_thing_and_each_thing_goes_to_the_nearest() {
        let two = [(0, 5, 4.0), (0, 6, 1.0)];
        assert_eq!(settled(&two, Nearest, AtOnce), [(0, 6)]);
        assert_eq!(settled(&two, First, AtOnce), [(0, 5)]);
        let carrier = [(0, 6, 1.0), (0, 7, 4.0), (1, 6, 3.0), (1, 5, 2.0)];
        assert_eq!(settled(&carrier, CarrierFirst, AtOnce), [(1, 5), (0, 7)]);
        let one = [(0, 5, 4.0), (1, 5, 1.0)];
        assert_eq!(settled(&one, Nearest, AtOnce), [(1, 5)]);
        assert_eq!(settled(&one, First, AtOnce), [(1, 5)]);
        let equals = [(1, 6, 1.0), (1, 5, 1.0), (0, 5, 1.0)];
        assert_eq!(settled(&equals, Nearest, AtOnce), [(0, 5)]);
        let no_second_choice = [(0, 5, 1.0), (1, 5, 2.0), (1, 6, 3.0)];
        assert_eq!(settled(&no_second_choice, Nearest, AtOnce), [(0, 5)]);
        let each_its_own = [(1, 5, 1.0), (0, 6, 2.0)];
        assert_eq!(settled(&each_its_own, Nearest, AtOnce), [(1, 5), (0, 6)]);
        assert_eq!(settled(&[], Nearest, AtOnce), []);
        let nearest_fails = [(9, 5, 1.0), (10, 5, 2.0)];
        assert_eq!(settled(&nearest_fails, Nearest, AtOnce), [(9, 5)]);
    }

    #[test]
    fn in_turn_each_gets_what_earlier_boats_leave() {
        let one = [(0, 5, 4.0), (1, 5, 1.0)];
        assert_eq!(settled(&one, Nearest, InTurn), [(0, 5)]);
        let two = [(0, 5, 4.0), (0, 6, 1.0)];
        assert_eq!(settled(&two, Nearest, InTurn), [(0, 6)]);
        assert_eq!(settled(&two, First, InTurn), [(0, 5)]);
        let left = [(1, 5, 1.0), (1, 6, 3.0), (0, 5, 2.0)];
        assert_eq!(settled(&left, First, InTurn), [(0, 5), (1, 6)]);
        let first_fails = [(9, 5, 1.0), (10, 5, 2.0), (11, 5, 3.0)];
        assert_eq!(settled(&first_fails, First, InTurn), [(9, 5), (10, 5)]);
    }
}
