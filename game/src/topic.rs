//! The key expressions of a game. Nothing else spells them.
//!
//! All keys begin with `squall/<game>/`, so that games on one network never meet.

use crate::id::{TeamId, VehicleId};
use crate::scenario::Scenario;

/// A game's name on the network: small letters, digits, `_` and `-`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GameName(String);

impl GameName {
    /// The name, if it can be part of a key.
    ///
    /// # Errors
    /// Says what is allowed.
    pub fn new(name: &str) -> Result<GameName, String> {
        let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
        if (1..=64).contains(&name.len()) && name.chars().all(allowed) {
            Ok(GameName(name.to_owned()))
        } else {
            Err(format!("game name {name:?} is not 1 to 64 of the characters a-z 0-9 _ -"))
        }
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// All topics of a game that match `pattern`, in which `*` stands for one word and `**` for any number of them.
#[must_use]
pub fn matching(game: &GameName, pattern: &str) -> String {
    format!("squall/{}/{pattern}", game.0)
}

/// A topic of a game by the name that recordings have for it; what comes from several is one of theirs.
#[must_use]
pub fn recorded(game: &GameName, name: &str) -> String {
    let several = if name.starts_with("say/") { "/*" } else { "" };
    format!("squall/{}/{name}{several}", game.0)
}

/// The truth for observers (publish).
#[must_use]
pub fn frame(game: &GameName) -> String {
    format!("squall/{}/frame", game.0)
}

/// A team's picture (publish).
#[must_use]
pub fn picture(game: &GameName, scenario: &Scenario, team: TeamId) -> String {
    format!("squall/{}/picture/{}", game.0, scenario.teams[team.index()].name)
}

/// An agent's orders (publish).
#[must_use]
pub fn orders(game: &GameName, agent: &str) -> String {
    format!("squall/{}/order/{agent}", game.0)
}

/// All agents' orders (subscribe).
#[must_use]
pub fn all_orders(game: &GameName) -> String {
    orders(game, "*")
}

/// What the minds of one agent process tell their team (publish).
#[must_use]
pub fn say(game: &GameName, scenario: &Scenario, team: TeamId, agent: &str) -> String {
    format!("squall/{}/say/{}/{agent}", game.0, scenario.teams[team.index()].name)
}

/// What all minds of a team tell each other (subscribe).
#[must_use]
pub fn all_say(game: &GameName, scenario: &Scenario, team: TeamId) -> String {
    say(game, scenario, team, "*")
}

/// What a policy outside proposes for a boat (publish).
#[must_use]
pub fn policy(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!("squall/{}/policy/{}", game.0, scenario.vehicles[vehicle.index()].name)
}

/// The helm report of a boat (query).
#[must_use]
pub fn helm(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!("squall/{}/helm/{}", game.0, scenario.vehicles[vehicle.index()].name)
}

/// Where a real boat is, from its gateway (publish).
#[must_use]
pub fn nav(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!("squall/{}/nav/{}", game.0, scenario.vehicles[vehicle.index()].name)
}

/// Where all real boats are (subscribe).
#[must_use]
pub fn all_nav(game: &GameName) -> String {
    format!("squall/{}/nav/*", game.0)
}

/// What a real boat is to do, from the sim (publish).
#[must_use]
pub fn external_order(game: &GameName, scenario: &Scenario, vehicle: VehicleId) -> String {
    format!("squall/{}/external/{}", game.0, scenario.vehicles[vehicle.index()].name)
}

/// The bytes between a gateway and its boat (publish).
#[must_use]
pub fn link(game: &GameName, vehicle: &str) -> String {
    format!("squall/{}/link/{vehicle}", game.0)
}

/// How a gateway and its boat are (publish).
#[must_use]
pub fn status(game: &GameName, vehicle: &str) -> String {
    format!("squall/{}/status/{vehicle}", game.0)
}

/// Where people ask something of a boat's gateway (query).
#[must_use]
pub fn operate(game: &GameName, vehicle: &str) -> String {
    format!("squall/{}/operate/{vehicle}", game.0)
}

/// How the run of the game stands (publish).
#[must_use]
pub fn run(game: &GameName) -> String {
    format!("squall/{}/run", game.0)
}

/// Everything that has happened so far (query).
#[must_use]
pub fn events(game: &GameName) -> String {
    format!("squall/{}/events", game.0)
}

/// The waves (query).
#[must_use]
pub fn water(game: &GameName) -> String {
    format!("squall/{}/water", game.0)
}

/// Where agents and gateways ask to join (query).
#[must_use]
pub fn join(game: &GameName) -> String {
    format!("squall/{}/join", game.0)
}

/// What the game is (query).
#[must_use]
pub fn scenario(game: &GameName) -> String {
    format!("squall/{}/scenario", game.0)
}

/// Where the game is controlled: what stops boats is published by anybody, everything else is asked of the sim (query).
#[must_use]
pub fn control(game: &GameName) -> String {
    format!("squall/{}/control", game.0)
}

/// That an E-stop is over, from the sim (publish).
#[must_use]
pub fn released(game: &GameName) -> String {
    format!("squall/{}/released", game.0)
}

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, strum::Display, strum::EnumString)]
#[strum(serialize_all = "snake_case")]
pub enum Part {
    /// The world and the referee.
    Sim,
    /// Minds.
    Agent,
    /// The way to a real boat.
    Gateway,
}

/// A node that is there (liveliness token).
#[must_use]
pub fn alive(game: &GameName, part: Part, node: &str) -> String {
    format!("squall/{}/alive/{part}/{node}", game.0)
}

/// All nodes of one kind in a game (liveliness).
#[must_use]
pub fn all_alive(game: &GameName, part: Part) -> String {
    alive(game, part, "*")
}

/// All nodes of all games (liveliness).
#[must_use]
pub fn everyone_alive() -> String {
    "squall/*/alive/*/*".to_owned()
}

/// The game, part and node that an [`alive`] key names.
#[must_use]
pub fn parse_alive(key: &str) -> Option<(GameName, Part, String)> {
    let mut words = key.strip_prefix("squall/")?.split('/');
    let game = GameName::new(words.next()?).ok()?;
    if words.next()? != "alive" {
        return None;
    }
    let part = words.next()?.parse().ok()?;
    Some((game, part, words.next()?.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_says_who_is_alive_where() {
        let game = GameName::new("pav01-3f").expect("a good name");
        assert_eq!(parse_alive(&alive(&game, Part::Agent, "a7")), Some((game, Part::Agent, "a7".into())));
        for other in ["squall/x/alive/sim", "squall/x/frame", "other/x/alive/sim/a", "squall/x/alive/cat/a"] {
            assert_eq!(parse_alive(other), None, "{other}");
        }
    }

    #[test]
    fn keys_name_game_team_and_boat() {
        let game = GameName::new("pav01").expect("a good name");
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/pav01_vs_pav01.toml");
        let scenario = crate::scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let (red, two) = (TeamId(1), VehicleId(1));
        for (key, want) in [
            (say(&game, &scenario, red, "a7"), "squall/pav01/say/red/a7"),
            (all_say(&game, &scenario, red), "squall/pav01/say/red/*"),
            (policy(&game, &scenario, two), "squall/pav01/policy/blue_two"),
            (helm(&game, &scenario, two), "squall/pav01/helm/blue_two"),
            (nav(&game, &scenario, two), "squall/pav01/nav/blue_two"),
            (external_order(&game, &scenario, two), "squall/pav01/external/blue_two"),
        ] {
            assert_eq!(key, want);
        }
    }

    #[test]
    fn names_that_would_break_a_key_are_refused() {
        for bad in ["", "a/b", "a*", "Game", "a b", "x?"] {
            assert!(GameName::new(bad).is_err(), "{bad}");
        }
    }
}
