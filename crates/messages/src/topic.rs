//! The key expressions of a game; no other module contains any.
//!
//! All keys begin with `squall/<game>/`, so that games on one network do not interfere.

use crate::Role;
use crate::external::Reported;
use primitives::id::{TeamId, VehicleId};
use scenario::Scenario;

/// A game's name on the network: lower-case letters, digits, `_` and `-`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GameName(String);

impl GameName {
    /// Validates the name as part of a key.
    ///
    /// # Errors
    /// If the name is invalid; the message lists the allowed characters.
    pub fn new(name: &str) -> Result<GameName, String> {
        let allowed =
            |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
        if (1..=64).contains(&name.len()) && name.chars().all(allowed) {
            Ok(GameName(name.to_owned()))
        } else {
            Err(format!(
                "game name is {name:?}, expected 1 to 64 characters from a-z, 0-9, _ and -"
            ))
        }
    }

    /// The name.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// All topics of a game that match `pattern`: `*` matches one segment of the key, `**` any
/// number of segments.
pub fn matching(game: &GameName, pattern: &str) -> String {
    format!("squall/{}/{pattern}", game.0)
}

/// The true state for observers (publish).
pub fn frame(game: &GameName) -> String {
    format!("squall/{}/frame", game.0)
}

/// A team's picture (publish).
pub fn picture(game: &GameName, scenario: &Scenario, team: TeamId) -> String {
    format!(
        "squall/{}/picture/{}",
        game.0,
        scenario.teams[team.index()].name
    )
}

/// The orders of an agent that plays for these teams (publish).
pub fn orders(game: &GameName, scenario: &Scenario, teams: &[TeamId], agent: &str) -> String {
    match teams {
        [team] => format!(
            "squall/{}/order/{}/{agent}",
            game.0,
            scenario.teams[team.index()].name
        ),
        _ => format!("squall/{}/order/{agent}", game.0),
    }
}

/// All agents' orders (subscribe).
pub fn all_orders(game: &GameName) -> String {
    format!("squall/{}/order/**", game.0)
}

/// Messages between the minds of a team (publish, subscribe).
pub fn say(game: &GameName, scenario: &Scenario, team: TeamId) -> String {
    format!(
        "squall/{}/say/{}",
        game.0,
        scenario.teams[team.index()].name
    )
}

/// Proposals of an external policy for a boat (publish).
pub fn policy(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!(
        "squall/{}/policy/{}",
        game.0,
        scenario.vehicles[vehicle.index()].name
    )
}

/// The helm report of a boat (query).
pub fn helm(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!(
        "squall/{}/helm/{}",
        game.0,
        scenario.vehicles[vehicle.index()].name
    )
}

/// Navigation of a real boat, from its gateway (publish).
pub fn nav(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!(
        "squall/{}/nav/{}",
        game.0,
        scenario.vehicles[vehicle.index()].name
    )
}

/// Navigation of all real boats (subscribe).
pub fn all_nav(game: &GameName) -> String {
    format!("squall/{}/nav/*", game.0)
}

/// Commands for a real boat, from the sim (publish).
pub fn external_order(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!(
        "squall/{}/external/{}",
        game.0,
        scenario.vehicles[vehicle.index()].name
    )
}

/// Gateway reports for other nodes (publish). Only the sim receives them; it checks and forwards
/// them: see [`Reported`].
pub fn report(game: &GameName, what: Reported, vehicle: &str) -> String {
    format!("squall/{}/report/{what}/{vehicle}", game.0)
}

/// The bytes between a gateway and its boat, from the sim (publish).
pub fn link(game: &GameName, vehicle: &str) -> String {
    format!("squall/{}/link/{vehicle}", game.0)
}

/// Status of a gateway and its boat, from the sim (publish).
pub fn status(game: &GameName, vehicle: &str) -> String {
    format!("squall/{}/status/{vehicle}", game.0)
}

/// Operator commands to a boat's gateway (query).
pub fn operate(game: &GameName, vehicle: &str) -> String {
    format!("squall/{}/operate/{vehicle}", game.0)
}

/// Stop commands for a real boat, which need no token (publish).
pub fn stop(game: &GameName, vehicle: &str) -> String {
    format!("squall/{}/stop/{vehicle}", game.0)
}

/// The state of the game's run (publish).
pub fn run(game: &GameName) -> String {
    format!("squall/{}/run", game.0)
}

/// All events so far (query).
pub fn events(game: &GameName) -> String {
    format!("squall/{}/events", game.0)
}

/// The waves (query).
pub fn water(game: &GameName) -> String {
    format!("squall/{}/water", game.0)
}

/// Join requests for this role and these vehicles (query): agents use their team's key, gateways
/// their boat's. Agents of several teams, gateways of several boats, and requests with unknown or
/// no vehicles use one key per role.
pub fn join(game: &GameName, scenario: &Scenario, role: Role, vehicles: &[String]) -> String {
    let known = vehicles.iter().map(|name| scenario.vehicle_by_name(name));
    let place = match (role, known.collect::<Option<Vec<VehicleId>>>().as_deref()) {
        (Role::Agent, Some([first, others @ ..])) => {
            let team = scenario.team_of(*first);
            let is_of_team = others.iter().all(|other| scenario.team_of(*other) == team);
            is_of_team.then(|| &scenario.teams[team.index()].name)
        }
        (Role::Gateway, Some([boat])) => Some(&scenario.vehicles[boat.index()].name),
        _ => None,
    };
    let place = place.map(|name| format!("/{name}")).unwrap_or_default();
    format!("squall/{}/join/{role}{place}", game.0)
}

/// All join requests (query).
pub fn all_join(game: &GameName) -> String {
    format!("squall/{}/join/**", game.0)
}

/// The game's description (query).
pub fn scenario(game: &GameName) -> String {
    format!("squall/{}/scenario", game.0)
}

/// Control of the game: anyone may publish stops; all other commands are queries to the sim.
pub fn control(game: &GameName) -> String {
    format!("squall/{}/control", game.0)
}

/// Release of an E-stop, from the sim (publish).
pub fn released(game: &GameName) -> String {
    format!("squall/{}/released", game.0)
}

/// Presence of a game's sim (liveliness token).
pub fn alive(game: &GameName, sim: &str) -> String {
    format!("squall/{}/alive/sim/{sim}", game.0)
}

/// All sims of a game (liveliness).
pub fn all_alive(game: &GameName) -> String {
    alive(game, "*")
}

/// The sims of all games (liveliness).
pub fn everyone_alive() -> String {
    "squall/*/alive/sim/*".to_owned()
}

/// The game and the sim in an [`alive`] key.
pub fn parse_alive(key: &str) -> Option<(GameName, String)> {
    let (game, sim) = key.strip_prefix("squall/")?.split_once("/alive/sim/")?;
    Some((GameName::new(game).ok()?, sim.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_says_which_sim_is_alive() {
        let game = GameName::new("pav01-3f").expect("a good name");
        assert_eq!(parse_alive(&alive(&game, "a7")), Some((game, "a7".into())));
        for other in [
            "squall/x/alive/sim",
            "squall/x/frame",
            "other/x/alive/sim/a",
            "squall/x/alive/cat/a",
        ] {
            assert_eq!(parse_alive(other), None, "{other}");
        }
    }

    #[test]
    fn keys_name_game_team_and_boat() {
        let game = GameName::new("pav01").expect("a good name");
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../scenarios/games/pav01_vs_pav01.toml");
        let scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let red = TeamId(1);
        let two = VehicleId(1);
        for (key, want) in [
            (say(&game, &scenario, red), "squall/pav01/say/red"),
            (
                policy(&game, &scenario, two),
                "squall/pav01/policy/blue_two",
            ),
            (helm(&game, &scenario, two), "squall/pav01/helm/blue_two"),
            (nav(&game, &scenario, two), "squall/pav01/nav/blue_two"),
            (
                external_order(&game, &scenario, two),
                "squall/pav01/external/blue_two",
            ),
            (
                orders(&game, &scenario, &[red], "a7"),
                "squall/pav01/order/red/a7",
            ),
            (
                orders(&game, &scenario, &[TeamId(0), red], "a7"),
                "squall/pav01/order/a7",
            ),
        ] {
            assert_eq!(key, want);
        }
        for (role, vehicles, want) in [
            (
                Role::Agent,
                &["red_one", "red_two"][..],
                "squall/pav01/join/agent/red",
            ),
            (
                Role::Agent,
                &["red_one", "blue_two"],
                "squall/pav01/join/agent",
            ),
            (
                Role::Agent,
                &["red_one", "nobody"],
                "squall/pav01/join/agent",
            ),
            (Role::Agent, &[], "squall/pav01/join/agent"),
            (
                Role::Gateway,
                &["red_one"],
                "squall/pav01/join/gateway/red_one",
            ),
            (
                Role::Gateway,
                &["red_one", "red_two"],
                "squall/pav01/join/gateway",
            ),
        ] {
            let vehicles: Vec<String> = vehicles.iter().map(|name| (*name).to_owned()).collect();
            assert_eq!(join(&game, &scenario, role, &vehicles), want);
        }
    }

    #[test]
    fn names_that_would_break_a_key_are_refused() {
        for bad in ["", "a/b", "a*", "Game", "a b", "x?"] {
            assert!(GameName::new(bad).is_err(), "{bad}");
        }
    }
}
