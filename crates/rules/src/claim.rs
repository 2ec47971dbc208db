//! Claims: competing attempts of boats in one tick, and their outcomes.

use super::{Resolution, TagChoice};
use std::cmp::Ordering;

/// Boat `by` claims `on`, a boat to tag or a flag to grab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claim {
    pub(super) by: u16,
    pub(super) on: u16,
    pub(super) distance_squared: f64,
}

impl Claim {
    fn nearer(&self, other: &Claim) -> Ordering {
        self.distance_squared.total_cmp(&other.distance_squared)
    }
}

/// Reduces the claims to those that succeed.
///
/// Each boat claims one target, the nearest or the first. `AtOnce`: of all boats that claim the
/// same target, the nearest gets it; the others lose nothing and may claim again at the next check.
/// Granted claims are ordered by target. `InTurn`: a boat gets its target unless an earlier boat
/// has claimed it and does not fail, and claims nothing else. Granted claims, failed ones included,
/// are ordered by boat. Ties go to the lower index.
pub(super) fn settle(
    claims: &mut Vec<Claim>,
    choice: TagChoice,
    resolution: Resolution,
    fails: impl Fn(&Claim) -> bool,
) {
    claims.sort_unstable_by(|x, y| {
        let wanted = if choice == TagChoice::Nearest {
            x.nearer(y)
        } else {
            Ordering::Equal
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

    #[test]
    fn each_gets_one_thing_and_each_thing_goes_to_the_nearest() {
        let near = TagChoice::Nearest;
        let first = TagChoice::First;
        let at_once = Resolution::AtOnce;
        let in_turn = Resolution::InTurn;
        for (name, claims, choice, resolution, want) in [
            (
                "one reaches for two",
                vec![(0, 5, 4.0), (0, 6, 1.0)],
                near,
                at_once,
                vec![(0, 6)],
            ),
            (
                "one takes the first",
                vec![(0, 6, 1.0), (0, 5, 4.0)],
                first,
                at_once,
                vec![(0, 5)],
            ),
            (
                "two reach for one",
                vec![(0, 5, 4.0), (1, 5, 1.0)],
                near,
                at_once,
                vec![(1, 5)],
            ),
            (
                "two reach for the first",
                vec![(0, 5, 4.0), (1, 5, 1.0)],
                first,
                at_once,
                vec![(1, 5)],
            ),
            (
                "equals",
                vec![(1, 6, 1.0), (1, 5, 1.0), (0, 5, 1.0)],
                near,
                at_once,
                vec![(0, 5)],
            ),
            (
                "no second choice",
                vec![(0, 5, 1.0), (1, 5, 2.0), (1, 6, 3.0)],
                near,
                at_once,
                vec![(0, 5)],
            ),
            (
                "each its own",
                vec![(1, 5, 1.0), (0, 6, 2.0)],
                near,
                at_once,
                vec![(1, 5), (0, 6)],
            ),
            ("nobody", vec![], near, at_once, vec![]),
            (
                "in turn, two reach for one",
                vec![(0, 5, 4.0), (1, 5, 1.0)],
                near,
                in_turn,
                vec![(0, 5)],
            ),
            (
                "in turn, one takes the nearest",
                vec![(0, 5, 4.0), (0, 6, 1.0)],
                near,
                in_turn,
                vec![(0, 6)],
            ),
            (
                "in turn, one takes the first",
                vec![(0, 6, 1.0), (0, 5, 4.0)],
                first,
                in_turn,
                vec![(0, 5)],
            ),
            (
                "in turn, what is left",
                vec![(1, 5, 1.0), (1, 6, 3.0), (0, 5, 2.0)],
                first,
                in_turn,
                vec![(0, 5), (1, 6)],
            ),
            (
                "in turn, after a failure",
                vec![(9, 5, 1.0), (10, 5, 2.0), (11, 5, 3.0)],
                first,
                in_turn,
                vec![(9, 5), (10, 5)],
            ),
            (
                "the nearest fails",
                vec![(9, 5, 1.0), (10, 5, 2.0)],
                near,
                at_once,
                vec![(9, 5)],
            ),
        ] {
            let claim = |(by, on, distance_squared)| Claim {
                by,
                on,
                distance_squared,
            };
            let mut claims: Vec<Claim> = claims.into_iter().map(claim).collect();
            settle(&mut claims, choice, resolution, |claim| claim.by == 9);
            assert_eq!(
                claims
                    .iter()
                    .map(|claim| (claim.by, claim.on))
                    .collect::<Vec<_>>(),
                want,
                "{name}"
            );
        }
    }
}
