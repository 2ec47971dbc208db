//! A team's own part of the field: its side, its flags and its corners.

use super::Field;
use primitives::frame::Ned;
use primitives::id::{FlagId, TeamId};

impl Field {
    /// Whether `at` is on `team`'s own side; the scrimmage line is on both.
    #[inline]
    pub fn is_own_side(&self, team: TeamId, at: Ned) -> bool {
        self.zones
            .get(team.index())
            .is_some_and(|zone| zone.contains(at))
    }

    /// The homes of `team`'s own flags.
    #[inline]
    pub fn own_flags(&self, team: TeamId) -> impl Iterator<Item = (FlagId, Ned)> {
        let flags = self.flags.iter().enumerate();
        flags
            .filter(move |(_, flag)| flag.team == team)
            .map(|(i, flag)| (FlagId(i as u8), flag.home))
    }

    /// The home nearest to `at` among `team`'s own flags; `None` without flags.
    pub fn nearest_own_flag(&self, team: TeamId, at: Ned) -> Option<Ned> {
        at.nearest_of(self.own_flags(team).map(|(_, home)| home))
    }

    /// The corners of `team`'s own end.
    #[inline]
    pub fn own_corners(&self, team: TeamId) -> &[Ned] {
        self.own_corners
            .get(team.index())
            .map_or(&[], |corners| corners)
    }
}
