//! The results of a league: games played before are not repeated when new entries join.
//!
//! The file has one JSON line per game and is append-only. A game is identified by its parsed files
//! and its seed: changing a strategy yields new games, renaming it does not.

use super::plan::Plan;
use super::play::Record;
use crate::checksum::checksum;
use crate::pipeline::Game;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use thiserror::Error;

/// The last key of a line, which precedes the checksum of the rest of the line.
const SUM: &str = ",\"sum\":\"";

/// The known games of a league.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct League {
    /// Results by pairing, as in [`Plan::pairings`], and by seed, with their line number.
    known: BTreeMap<(String, u64), (usize, Result<Game, String>)>,
}

/// The JSON form of a game.
#[derive(Serialize, Deserialize)]
struct Line {
    pairing: String,
    /// The displayed names of the two entries.
    blue: String,
    red: String,
    seed: u64,
    #[serde(flatten)]
    outcome: Outcome,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Outcome {
    Game(Game),
    Failed(String),
}

/// An invalid line.
#[derive(Debug, Error)]
#[error("line {line} is not a league game: {why}")]
pub struct LeagueError {
    line: usize,
    why: String,
}

impl League {
    /// Parses the games in `text`. A last line without a newline is incomplete and is ignored.
    ///
    /// # Errors
    /// [`LeagueError`] if any other line is not a game.
    pub fn parse(text: &str) -> Result<League, LeagueError> {
        let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
        let game = |(line, text): (usize, &str)| {
            let failed = |why: String| LeagueError {
                line: line + 1,
                why,
            };
            let text = match text.rsplit_once(SUM) {
                // Lines of earlier versions have no checksum.
                None => text.to_owned(),
                Some((body, sum)) => Some(format!("{body}}}"))
                    .filter(|body| format!("{}\"}}", checksum(body)) == sum)
                    .ok_or_else(|| failed("its checksum does not match".to_owned()))?,
            };
            let Line {
                pairing,
                seed,
                outcome,
                ..
            } = serde_json::from_str(&text).map_err(|why| failed(why.to_string()))?;
            let result = match outcome {
                Outcome::Game(game) => Ok(game),
                Outcome::Failed(why) => Err(why),
            };
            Ok(((pairing, seed), (line, result)))
        };
        Ok(League {
            known: whole
                .lines()
                .enumerate()
                .map(game)
                .collect::<Result<_, _>>()?,
        })
    }

    /// The line of a game.
    ///
    /// # Panics
    /// If the game is not part of the plan to which these pairings belong.
    pub fn line(plan: &Plan, pairings: &[String], record: &Record) -> String {
        let [blue, red] = record
            .of
            .sides
            .map(|entry| plan.tournament().entries[entry].name.clone());
        let outcome = match record.result.clone() {
            Ok(game) => Outcome::Game(game),
            Err(why) => Outcome::Failed(why),
        };
        let pairing = pairings[plan.place_of(record.of) % pairings.len()].clone();
        let line = Line {
            pairing,
            blue,
            red,
            seed: record.of.seed,
            outcome,
        };
        let body = serde_json::to_string(&line).expect("its map keys are strings");
        let sum = checksum(&body);
        format!("{}{SUM}{sum}\"}}\n", &body[..body.len() - 1])
    }

    /// The known games of a plan, in the order in which they were played, and the indices of all
    /// others.
    pub fn split(&self, plan: &Plan, pairings: &[String]) -> (Vec<Record>, Vec<usize>) {
        let mut known = vec![];
        let mut new = vec![];
        for place in 0..plan.games() {
            let of = plan.match_at(place).0;
            match self
                .known
                .get(&(pairings[place % pairings.len()].clone(), of.seed))
            {
                Some((line, result)) => known.push((
                    line,
                    Record {
                        of,
                        result: result.clone(),
                    },
                )),
                None => new.push(place),
            }
        }
        known.sort_by_key(|(line, _)| *line);
        (known.into_iter().map(|(_, record)| record).collect(), new)
    }
}
