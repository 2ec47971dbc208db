//! A team's own part of the field: its side, its flags and its corners.

use super::{Field, Flag};
use primitives::frame::Ned;
use primitives::id::{FlagId, TeamId};
use primitives::time::SimTime;

impl Field {
    /// Whether `at` is on `team`'s own side; the scrimmage line is on both.
    #[inline]
    pub fn is_own_side(&self, team: TeamId, at: Ned) -> bool {
        self.zones
            .get(team.index())
            .is_some_and(|zone| zone.contains(at))
    }

    /// The flags of `team`.
    #[inline]
    pub fn own_flags(&self, team: TeamId) -> impl Iterator<Item = (FlagId, &Flag)> {
        let flags = self.flags.iter().enumerate();
        flags
            .filter(move |(_, flag)| flag.team == team)
            .map(|(i, flag)| (FlagId(i as u8), flag))
    }

    /// The flag of `team` with the home nearest to `at`, and that home; `None` without flags.
    pub fn nearest_own_flag(&self, team: TeamId, at: Ned, now: SimTime) -> Option<(&Flag, Ned)> {
        let flags = self.own_flags(team).map(|(_, flag)| (flag, flag.home(now)));
        flags.min_by(|(_, x), (_, y)| at.distance_squared(*x).total_cmp(&at.distance_squared(*y)))
    }

    /// The corners of `team`'s own end.
    #[inline]
    pub fn own_corners(&self, team: TeamId) -> &[Ned] {
        self.own_corners
            .get(team.index())
            .map_or(&[], |corners| corners)
    }
}
