//! Whether a game depends on its seed.

use super::{Scenario, StartPosition, Vehicle};
use crate::link::Link;
use crate::sea::{Gusts, Sea};
use crate::sensor::{Compass, Gps, Imu, Sensors};
use crate::strategy::{Assignment, Task};
use primitives::time::SimTime;
use rules::Sharing;

impl Scenario {
    /// Whether any value depends on the seed. Otherwise every seed gives the same game.
    pub fn is_random(&self) -> bool {
        let starts_somewhere =
            |vehicle: &Vehicle| matches!(vehicle.start_position, StartPosition::Somewhere { .. });
        self.recipe.is_some()
            || self.vehicles.iter().any(starts_somewhere)
            || self.deals_roles()
            || self.samples_actions()
            || self.rules.power_play > SimTime::ZERO
            || is_chance(self.rules.tag_probability)
            || is_random_sea(&self.sea)
            || self.link.as_ref().is_some_and(is_random_link)
            || is_random_sharing(&self.rules.sharing)
            || self
                .boats
                .iter()
                .any(|boat| are_random_sensors(&boat.sensors))
    }

    /// Whether the number of boats depends on the seed.
    pub fn draws_fleets(&self) -> bool {
        let mut drawn = self.drawn.iter();
        drawn.any(|drawn| drawn.parameter.starts_with("game/fleet."))
    }

    /// Whether a team assigns different roles to its boats in a random order.
    fn deals_roles(&self) -> bool {
        let fellows = |(i, one): (usize, &Vehicle)| {
            let others = self.vehicles[..i]
                .iter()
                .filter(|other| other.team == one.team && other.strategy == one.strategy);
            let strategy = &self.strategies[one.strategy];
            strategy.assignment == Assignment::Seeded
                && strategy.roles.len() > 1
                && others.count() > 0
        };
        self.vehicles.iter().enumerate().any(fellows)
    }

    /// Whether a policy draws its actions. A competition entry may draw too.
    fn samples_actions(&self) -> bool {
        let roles = self.strategies.iter().flat_map(|strategy| &strategy.roles);
        let mut behaviours = roles.flat_map(|role| &role.behaviours);
        behaviours.any(|behaviour| match &behaviour.task {
            Task::Policy(policy) => policy.sampled || policy.host.is_some(),
            _ => false,
        })
    }
}

fn is_random_sea(sea: &Sea) -> bool {
    let gusts = sea.wind.as_ref().is_some_and(|wind| match wind.gusts {
        Gusts::None => false,
        Gusts::OrnsteinUhlenbeck { intensity, .. } => intensity > 0.0 && wind.speed_10m_m_s > 0.0,
    });
    let current = &sea.current;
    let wander = current.wander.is_some_and(|wander| wander.sigma_m_s > 0.0);
    let eddies = current.random_eddies.is_some_and(|eddies| eddies.count > 0);
    gusts || wander || eddies || sea.waves.as_ref().is_some_and(|waves| waves.hs_m > 0.0)
}

fn is_random_link(link: &Link) -> bool {
    // With a good-link time of 0 s the link never turns bad.
    let turns_bad = link.loss.good_time_s > 0.0 && link.loss.bad > 0.0;
    link.jitter_s > 0.0 || is_chance(link.loss.good) || turns_bad
}

fn is_random_sharing(sharing: &Sharing) -> bool {
    sharing.noise_m > 0.0 || sharing.velocity_noise_m_s > 0.0 || is_chance(sharing.loss)
}

fn is_chance(share: f64) -> bool {
    share > 0.0 && share < 1.0
}

fn are_random_sensors(sensors: &Sensors) -> bool {
    let gps = |gps: &Gps| {
        let errors = [gps.bias_m, gps.noise_m, gps.velocity_noise_m_s];
        let events = [
            gps.dropout.rate_per_s,
            gps.freeze.rate_per_s,
            gps.jump.rate_per_s,
        ];
        errors.into_iter().chain(events).any(|size| size > 0.0)
    };
    let compass = |compass: &Compass| compass.noise_rad > 0.0;
    let imu = |imu: &Imu| {
        let errors = [
            imu.gyro_noise_rad_s,
            imu.gyro_bias_rad_s,
            imu.accelerometer_noise_m_s2,
            imu.accelerometer_bias_m_s2,
        ];
        errors.into_iter().any(|size| size > 0.0)
    };
    sensors.gps.as_ref().is_some_and(gps)
        || sensors.compass.as_ref().is_some_and(compass)
        || sensors.imu.as_ref().is_some_and(imu)
}
