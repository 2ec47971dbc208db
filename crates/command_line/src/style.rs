//! Terminal colours: teams, and the severity of messages. They are omitted on output if the
//! terminal cannot show them.

use scenario::Scenario;
use std::collections::BTreeMap;

/// The colours of the first and the second team.
const TEAMS: [&str; 2] = ["\x1b[94m", "\x1b[91m"];
const BAD: &str = "\x1b[1;31m";
const WARNING: &str = "\x1b[33m";
const GOOD: &str = "\x1b[32m";
const PLAIN: &str = "\x1b[0m";

/// A string in a team's colour.
pub fn team(team: usize, text: &str) -> String {
    within(TEAMS[team % TEAMS.len()], text)
}

/// A string in the colour of failures.
pub fn bad(text: &str) -> String {
    within(BAD, text)
}

/// A string in the colour of possible failures.
pub fn warning(text: &str) -> String {
    within(WARNING, text)
}

/// A string in the colour of success.
pub fn good(text: &str) -> String {
    within(GOOD, text)
}

fn within(colour: &str, text: &str) -> String {
    format!("{colour}{text}{PLAIN}")
}

/// The names of a game's teams and boats.
#[derive(Default)]
pub struct Names(BTreeMap<String, usize>);

impl Names {
    /// The names in this scenario.
    pub fn of(scenario: &Scenario) -> Names {
        let teams = scenario
            .teams
            .iter()
            .enumerate()
            .map(|(i, team)| (team.name.clone(), i));
        let boats = scenario
            .vehicles
            .iter()
            .map(|vehicle| (vehicle.name.clone(), vehicle.team.index()));
        Names(boats.chain(teams).collect())
    }

    /// `text` with each of these names in its team's colour.
    pub fn paint(&self, text: &str) -> String {
        let is_end = |character: char| !(character.is_ascii_alphanumeric() || character == '_');
        let word = |piece: &str| {
            let (word, rest) = piece.split_at(piece.find(is_end).unwrap_or(piece.len()));
            self.0
                .get(word)
                .map_or_else(|| piece.to_owned(), |index| team(*index, word) + rest)
        };
        text.split_inclusive(is_end).map(word).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_their_teams_colours_and_other_words_none() {
        let names = Names(
            [
                ("blue".to_owned(), 0),
                ("blue_1".to_owned(), 0),
                ("red".to_owned(), 1),
            ]
            .into(),
        );
        for (text, want) in [
            ("", ""),
            (
                "  1.0 s  blue_1 grabs the red flag\n",
                "  1.0 s  \x1b[94mblue_1\x1b[0m grabs the \x1b[91mred\x1b[0m flag\n",
            ),
            (
                "blue 3  red 4",
                "\x1b[94mblue\x1b[0m 3  \x1b[91mred\x1b[0m 4",
            ),
            (
                "blue_12 blueish tired red",
                "blue_12 blueish tired \x1b[91mred\x1b[0m",
            ),
        ] {
            assert_eq!(names.paint(text), want);
        }
    }
}
