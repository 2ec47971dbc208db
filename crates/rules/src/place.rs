//! Capture and untag places.
//!
//! The referee uses these functions to judge, and agents use them to steer. They depend only on the
//! field, the rules, a position and, since flags may move, the time.

use super::{CaptureAt, Rules, SideJudged, UntagAt};
use crate::field::{Field, Flag};
use primitives::frame::{Leg, Ned};
use primitives::id::TeamId;
use primitives::time::SimTime;

impl Rules {
    /// The position that decides a boat's side.
    #[inline]
    pub fn side_place(&self, leg: Leg) -> Ned {
        match self.side_judged {
            SideJudged::AfterMove => leg.to,
            SideJudged::BeforeMove => leg.from,
        }
    }

    /// Whether a carrier of `team` that has moved along `leg` is at a capture place.
    pub fn is_capture_place(&self, field: &Field, team: TeamId, leg: Leg, now: SimTime) -> bool {
        match self.capture_at {
            CaptureAt::OwnSide => field.is_own_side(team, self.side_place(leg)),
            CaptureAt::OwnFlag => {
                let reach_m = |flag: &Flag| self.radii_of(flag).capture_m;
                is_near_own_flag(field, team, (leg.to, now), reach_m)
            }
            CaptureAt::OwnCorners => is_near_own_corner(field, team, leg.to, self.capture_radius_m),
        }
    }

    /// Target of a carrier of `team` at `at`: the nearest capture place or, with `OwnSide`, its
    /// nearest own flag. `None` on a field without flags or corners of that team.
    pub fn capture_place(&self, field: &Field, team: TeamId, at: Ned, now: SimTime) -> Option<Ned> {
        match self.capture_at {
            CaptureAt::OwnFlag | CaptureAt::OwnSide => {
                field.nearest_own_flag(team, at, now).map(|(_, home)| home)
            }
            CaptureAt::OwnCorners => {
                field.inside_own_corner(team, at, corner_inset_m(self.capture_radius_m))
            }
        }
    }

    /// Whether a tagged boat of `team` at `at` is untagged there.
    #[inline]
    pub fn is_untag_place(&self, field: &Field, team: TeamId, at: Ned, now: SimTime) -> bool {
        match self.untag_at {
            UntagAt::OwnFlag => {
                let reach_m = |flag: &Flag| self.radii_of(flag).untag_m;
                is_near_own_flag(field, team, (at, now), reach_m)
            }
            UntagAt::OwnCorners => is_near_own_corner(field, team, at, self.untag_radius_m),
        }
    }

    /// Target of a tagged boat of `team` at `at`: the nearest untag place. `None` on a field
    /// without flags or corners of that team.
    pub fn untag_place(&self, field: &Field, team: TeamId, at: Ned, now: SimTime) -> Option<Ned> {
        match self.untag_at {
            UntagAt::OwnFlag => field.nearest_own_flag(team, at, now).map(|(_, home)| home),
            UntagAt::OwnCorners => {
                field.inside_own_corner(team, at, corner_inset_m(self.untag_radius_m))
            }
        }
    }

    /// The untag circle of `team` with the nearest centre: centre and radius in m.
    pub fn untag_circle(
        &self,
        field: &Field,
        team: TeamId,
        at: Ned,
        now: SimTime,
    ) -> Option<(Ned, f64)> {
        match self.untag_at {
            UntagAt::OwnFlag => {
                let (flag, home) = field.nearest_own_flag(team, at, now)?;
                Some((home, self.radii_of(flag).untag_m))
            }
            UntagAt::OwnCorners => {
                let corner = at.nearest_of(field.own_corners(team).iter().copied())?;
                Some((corner, self.untag_radius_m))
            }
        }
    }
}

#[inline]
fn is_near_own_flag(
    field: &Field,
    team: TeamId,
    (at, now): (Ned, SimTime),
    reach_m: impl Fn(&Flag) -> f64,
) -> bool {
    field.own_flags(team).any(|(_, flag)| {
        let reach_m = reach_m(flag);
        at.distance_squared(flag.home(now)) < reach_m * reach_m
    })
}

#[inline]
fn is_near_own_corner(field: &Field, team: TeamId, at: Ned, radius_m: f64) -> bool {
    field
        .own_corners(team)
        .iter()
        .any(|corner| at.distance_squared(*corner) < radius_m * radius_m)
}

/// Inset from both edges for boats that must come within `radius_m` of a corner, m. Half the radius
/// is 10 m in the 2026 competition, and leaves a margin of 0.3 of the radius.
fn corner_inset_m(radius_m: f64) -> f64 {
    0.5 * radius_m
}
