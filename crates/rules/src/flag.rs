//! Flags: grabbed within a radius, captured at the capture place, returned home when lost.

use super::claim::{Claim, settle};
use super::{Acting, Look, Notes, Referee, Resolution, Standing, TagChoice};
use crate::event::Event;
use primitives::id::{FlagId, VehicleId};

impl Referee {
    /// Gives flags to opponents within reach, on request if the rules require it. No boat carries
    /// two flags.
    ///
    /// A boat claims the nearest available flag; [`Resolution`] decides between several boats at
    /// one flag. Except with `InTurn`, a flag that came home at this check is not yet available.
    pub(super) fn grab(
        &self,
        standing: &mut Standing,
        notes: &mut Notes,
        look: &Look<'_>,
        events: &mut Vec<Event>,
    ) {
        notes.claims.clear();
        for (on, (flag, state)) in self.field.flags.iter().zip(&standing.flags).enumerate() {
            let has_just_come =
                state.moved_at == standing.now && self.rules.resolution == Resolution::AtOnce;
            if state.carrier.is_some() || has_just_come {
                continue;
            }
            let reach_m = self.rules.radii_of(flag).grab_m;
            let home = flag.home(standing.now);
            for (by, boat) in standing.vehicles.iter().enumerate() {
                if self.team_of[by] == flag.team || !boat.acts() || boat.carrying.is_some() {
                    continue;
                }
                let asks = self.rules.tags_and_grabs == Acting::Automatic || look.asks[by].grab;
                let distance_squared = look.legs[by].to.distance_squared(home);
                if asks && distance_squared < reach_m * reach_m {
                    notes.claims.push(Claim {
                        by: by as u16,
                        on: on as u16,
                        distance_squared,
                        carries: false,
                    });
                }
            }
        }
        if notes.claims.is_empty() {
            return;
        }
        let resolution = self.rules.resolution;
        settle(&mut notes.claims, TagChoice::Nearest, resolution, |_| false);
        for claim in &notes.claims {
            let vehicle = VehicleId(claim.by);
            let flag = FlagId(claim.on as u8);
            standing.vehicles[vehicle.index()].carrying = Some(flag);
            let state = &mut standing.flags[flag.index()];
            (state.carrier, state.moved_at) = (Some(vehicle), standing.now);
            standing.award(self.team_of[vehicle.index()], self.rules.points.grab);
            events.push(Event::Grabbed { vehicle, flag });
        }
    }

    /// Scores the flags at the capture place and returns them home. A flag grabbed at this check
    /// can be captured at the next check at the earliest.
    ///
    /// With `capture_needs_own_flag`, all flags of the carrier's own team must be home after the
    /// grabs and before the captures of this check.
    pub(super) fn capture(
        &self,
        standing: &mut Standing,
        notes: &mut Notes,
        look: &Look<'_>,
        events: &mut Vec<Event>,
    ) {
        notes.claims.clear();
        for (on, state) in standing.flags.iter().enumerate() {
            let Some(carrier) = state.carrier.filter(|_| state.moved_at != standing.now) else {
                continue;
            };
            let team = self.team_of[carrier.index()];
            let here = look.legs[carrier.index()];
            let own_flags_home = || {
                self.field
                    .own_flags(team)
                    .all(|(own, _)| standing.flags[own.index()].carrier.is_none())
            };
            if standing.vehicles[carrier.index()].acts()
                && self
                    .rules
                    .is_capture_place(&self.field, team, here, standing.now)
                && (!self.rules.capture_needs_own_flag || own_flags_home())
            {
                notes.claims.push(Claim {
                    by: carrier.0,
                    on: on as u16,
                    distance_squared: 0.0,
                    carries: false,
                });
            }
        }
        for claim in &notes.claims {
            let vehicle = VehicleId(claim.by);
            let flag = FlagId(claim.on as u8);
            standing.bring_home(flag);
            standing.vehicles[vehicle.index()].carrying = None;
            standing.award(self.team_of[vehicle.index()], self.rules.points.capture);
            events.push(Event::Captured { vehicle, flag });
        }
    }
}

impl Standing {
    /// Returns a carrier's flag home.
    pub(super) fn drop_flag(&mut self, vehicle: VehicleId, events: &mut Vec<Event>) {
        if let Some(flag) = self.vehicles[vehicle.index()].carrying.take() {
            self.bring_home(flag);
            events.push(Event::FlagReturned { vehicle, flag });
        }
    }

    fn bring_home(&mut self, flag: FlagId) {
        let state = &mut self.flags[flag.index()];
        (state.carrier, state.moved_at) = (None, self.now);
    }
}
