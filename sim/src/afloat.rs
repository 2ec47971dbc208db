//! The sea of a game with some of its boats but without its rules, for `squall sim --afloat`.
//!
//! Emulated boats float in this water while their game treats them as real. Sea, boats and sensors
//! are as in the game. Tags, flags, radio and limits on sharing have no effect.

use crate::spawn::{self, NoStart};
use primitives::SimTime;
use rules::{Rules, Sharing, TaggedBoat};
use scenario::{Scenario, Source, StartPosition, UnknownVehicle};
use thiserror::Error;

/// The longest duration that a scenario file allows.
const DAY_S: f64 = 86_400.0;

/// A reason why the boats cannot be put in the water.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NotAfloat {
    /// A boat is not in the game.
    #[error(transparent)]
    Unknown(#[from] UnknownVehicle),
    /// The game itself cannot start.
    #[error(transparent)]
    NoStart(#[from] NoStart),
}

/// The sea of this game and seed, with the named boats at their starting positions.
///
/// # Errors
/// [`NotAfloat`] if a boat is not in the game, or the game cannot start.
pub fn afloat(scenario: &Scenario, seed: u64, names: &[String]) -> Result<Scenario, NotAfloat> {
    let scenario = scenario.of_seed(seed).map_err(NoStart::from)?;
    for name in names {
        scenario.vehicle_named(name)?;
    }
    // Compute the start positions of all boats of the game, so that the selected boats start where
    // the game expects them.
    let poses = spawn::start_positions(&scenario, seed).map_err(NoStart::from)?;
    let mut water = scenario.clone();
    for (vehicle, pose) in water.vehicles.iter_mut().zip(poses) {
        (vehicle.start_position, vehicle.source) = (StartPosition::At(pose), Source::Simulated);
    }
    water
        .vehicles
        .retain(|vehicle| names.contains(&vehicle.name));
    water.name = format!("{}_afloat", scenario.name);
    // The game's own link already delays the agents' messages; they must not be delayed twice.
    water.link = None;
    water.rules = without_consequences(&scenario.rules);
    // The random values have already been drawn, so the scenario must not be built again from the
    // files.
    water.recipe = None;
    Ok(water)
}

fn without_consequences(rules: &Rules) -> Rules {
    Rules {
        boundary_tags: false,
        obstacle_tag_m: 0.0,
        tagged_boat: TaggedBoat::DrivesItself,
        tagged_speed_factor: 1.0,
        outside_speed_factor: 1.0,
        sharing: Sharing::default(),
        flag_keepout_m: 0.0,
        win_score: None,
        time_limit: SimTime::from_s(DAY_S),
        power_play: SimTime::ZERO,
        ..rules.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Contest;
    use messages::Order;
    use std::path::Path;

    fn game(name: &str) -> Scenario {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/games/{name}.toml"));
        scenario::load(&path).unwrap_or_else(|problems| panic!("{problems}"))
    }

    #[test]
    fn boats_start_where_the_game_has_them_and_sail_alike() {
        let whole = Scenario {
            rules: without_consequences(&game("pav01_afloat").rules),
            ..game("pav01_afloat")
        };
        let names = ["blue_one".to_owned(), "red_one".to_owned()];
        let mut alone = Contest::new(
            &afloat(&whole, 7, &names).unwrap_or_else(|e| panic!("{e}")),
            7,
        )
        .unwrap_or_else(|e| panic!("{e}"));
        let mut all = Contest::new(
            &Scenario {
                link: None,
                ..whole.of_seed(7).unwrap_or_else(|e| panic!("{e}"))
            },
            7,
        )
        .unwrap_or_else(|e| panic!("{e}"));
        for contest in [&mut alone, &mut all] {
            let blue = contest
                .scenario()
                .vehicle_by_name("blue_one")
                .expect("the boat is in the game");
            for _ in 0..100 {
                let east = Order::Steer {
                    heading_rad: 1.0,
                    speed_m_s: 1.5,
                };
                contest
                    .order(blue, east, contest.now())
                    .expect("the order is valid");
                contest.advance();
            }
        }
        for name in &names {
            let pose = |contest: &Contest| {
                let vehicle = contest
                    .scenario()
                    .vehicle_by_name(name)
                    .expect("the boat is in the game");
                contest.world().state().boats[vehicle.index()].pose
            };
            assert_eq!(pose(&alone), pose(&all), "{name}");
        }
    }

    #[test]
    fn a_boat_that_is_not_in_the_game_is_refused() {
        let error = afloat(&game("mixed_2v2"), 1, &["green_one".to_owned()])
            .expect_err("the boat is not in the game");
        assert!(
            error
                .to_string()
                .contains("\"green_one\"; the vehicles are: blue_one, blue_two, red_one, red_two"),
            "{error}"
        );
    }
}
