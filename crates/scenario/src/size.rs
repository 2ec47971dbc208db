//! Limits on numbers, and products of numbers, that determine how much memory a game needs or that
//! its calculations rely on.

use crate::Scenario;
use crate::boat::Drive;
use crate::policy::PolicyModel;
use crate::sensor::MOST_PERIODS_LATE;
use crate::strategy::Helm;
use std::ops::RangeInclusive;

/// Maximum number of vehicles of a game.
pub(crate) const VEHICLES_MAX: usize = 10_000;
/// Limits on the numbers of a helm's courses and speeds.
pub(crate) const COURSES_MIN: usize = 8;
pub(crate) const COURSES_MAX: usize = 3600;
pub(crate) const SPEEDS_MIN: usize = 2;
pub(crate) const SPEEDS_MAX: usize = 1000;
/// Maximum number of wave components.
pub(crate) const COMPONENTS_MAX: u32 = 1024;
/// Maximum number of candidate decisions (courses by speeds) of all boats together. Each may need 4
/// bytes in its helm, 512 MB in total.
const CANDIDATES_MAX: usize = 1 << 27;
/// Maximum number of values that all policies together observe. Each may need 8 bytes.
const OBSERVED_MAX: usize = 1 << 26;

impl Scenario {
    /// Checks the limits of this module.
    ///
    /// # Errors
    /// The first violation, as a string.
    pub(crate) fn check_sizes(&self) -> Result<(), String> {
        let (vehicles, tick_ns) = (self.vehicles.len(), self.tick.0);
        let ticks = self.ticks_per_decision;
        within("the number of vehicles", vehicles, 0..=VEHICLES_MAX)?;
        within("the physics tick in ns", tick_ns, 1_000_000..=500_000_000)?;
        within(
            "the number of physics ticks per decision",
            ticks,
            1..=10_000,
        )?;
        if let Some(waves) = &self.sea.waves {
            let count = waves.components;
            within("the number of wave components", count, 1..=COMPONENTS_MAX)?;
        }
        if let Some(eddies) = &self.sea.current.random_eddies {
            within("the number of random eddies", eddies.count, 0..=100)?;
        }
        for boat in &self.boats {
            let of = |what: &str| format!("{what} of {}", boat.name);
            if let Some(gps) = &boat.sensors.gps {
                let allowed = 0.0..=MOST_PERIODS_LATE * gps.period_s;
                within(&of("gps.latency_s"), gps.latency_s, allowed)?;
            }
            if let Drive::Thrusters { thruster, .. } = &boat.drive {
                within(&of("thruster.slew_per_s"), thruster.slew_per_s, 0.0..=1e9)?;
            }
        }
        for program in self.strategies.iter().flat_map(|strategy| &strategy.roles) {
            let of = |what: &str| format!("{what} of {}", program.name);
            let Helm {
                courses, speeds, ..
            } = program.helm;
            within(&of("helm.courses"), courses, COURSES_MIN..=COURSES_MAX)?;
            within(&of("helm.speeds"), speeds, SPEEDS_MIN..=SPEEDS_MAX)?;
        }
        let mut candidates = 0;
        let mut observed = 0;
        for vehicle in &self.vehicles {
            let roles = &self.strategies[vehicle.strategy].roles;
            let helms = roles.iter().map(|role| role.helm);
            let sizes = helms.map(|helm| helm.courses * helm.speeds);
            candidates += sizes.max().unwrap_or(0);
            // The number of all boats is an upper bound on the teammates or enemies of one.
            let size = |model: &PolicyModel| model.spec.observation.size(0, vehicles);
            let sizes = roles.iter().map(|role| role.models().map(size).sum());
            observed += sizes.max().unwrap_or(0_usize);
        }
        let what = "helm.courses times helm.speeds, summed over all boats,";
        within(what, candidates, 0..=CANDIDATES_MAX)?;
        let what = "the number of values that all policies observe";
        within(what, observed, 0..=OBSERVED_MAX)
    }
}

fn within<T: PartialOrd + std::fmt::Display>(
    what: &str,
    found: T,
    allowed: RangeInclusive<T>,
) -> Result<(), String> {
    let (min, max) = (allowed.start(), allowed.end());
    let is_within = allowed.contains(&found);
    is_within
        .then_some(())
        .ok_or_else(|| format!("{what} is {found}, expected {min} to {max}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::time::SimTime;

    /// A check, and a change that violates it.
    type Case = (&'static str, fn(&mut Scenario));

    #[test]
    fn a_game_that_would_exhaust_memory_is_refused_with_the_number() {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../scenarios/games/surveyor_2v2.toml");
        let sound = crate::load(&file).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(sound.check_received(), Ok(()));
        let cases: [Case; 8] = [
            ("gps.latency_s of", |game| {
                let gps = game.boats[0].sensors.gps.as_mut();
                gps.expect("it has a receiver").latency_s = 65_535.0;
            }),
            ("helm.courses of", |game| {
                game.strategies[0].roles[0].helm.courses = 65_536
            }),
            ("helm.speeds of", |game| {
                game.strategies[0].roles[0].helm.speeds = 0
            }),
            ("times helm.speeds, summed over all boats, is 14", |game| {
                let helm = &mut game.strategies[game.vehicles[0].strategy].roles[0].helm;
                (helm.courses, helm.speeds) = (3600, 1000);
                game.vehicles = vec![game.vehicles[0].clone(); 40];
            }),
            ("the number of vehicles is 40000", |game| {
                game.vehicles = vec![game.vehicles[0].clone(); 40_000]
            }),
            ("the physics tick in ns is 0", |game| game.tick = SimTime(0)),
            ("ticks per decision is 0, expected 1 to", |game| {
                game.ticks_per_decision = 0
            }),
            ("wave components is 4294967295", |game| {
                game.sea.waves.as_mut().expect("there are waves").components = u32::MAX;
            }),
        ];
        for (part, change) in cases {
            let mut game = sound.clone();
            change(&mut game);
            let refused = game.check_received().expect_err(part);
            assert!(refused.contains(part), "{refused}");
        }
    }
}
