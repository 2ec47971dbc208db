//! Places and boats as strategies name them: fixed ones, and those that move with the game.

use crate::frame::Ned;
use serde::{Deserialize, Serialize};

/// A place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Place {
    /// Just there.
    At(Ned),
    /// A named point of the own team, such as `CFX`.
    Point(String),
    /// Something that follows the game.
    Mark(Mark),
    /// Where a boat is.
    Boat(Boat),
}

/// A place that follows the game, but is no boat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the table below says what each one is, for the reference page as well")]
pub enum Mark {
    OwnFlag,
    EnemyFlag,
    CapturePlace,
    UntagPlace,
}

/// A boat, by what it is just now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the table below says what each one is, for the reference page as well")]
pub enum Boat {
    NearestEnemy,
    NearestIntruder,
    NearestAttacker,
    FlagCarrier,
    Opponent,
    NearestMate,
    MateCarrier,
}

/// The marks: name in files, what it is.
const MARKS: [(Mark, &str, &str); 4] = [
    (Mark::OwnFlag, "own_flag", "The home of the own team's flag."),
    (Mark::EnemyFlag, "enemy_flag", "The home of the enemy's flag; of several the nearest that is there."),
    (Mark::CapturePlace, "capture_place", "Where the rules want a flag brought; of several the nearest."),
    (
        Mark::UntagPlace,
        "untag_place",
        "Where a tagged boat must come to play again; while it must leave that place first, the enemy's flag.",
    ),
];

/// The boats: name in files, what it is.
const BOATS: [(Boat, &str, &str); 7] = [
    (Boat::NearestEnemy, "nearest_enemy", "The nearest enemy that is not tagged."),
    (
        Boat::NearestIntruder,
        "nearest_intruder",
        "Of the enemies on the own side that are not tagged, the nearest to the own boat.",
    ),
    (
        Boat::NearestAttacker,
        "nearest_attacker",
        "Of the enemies that are not tagged, wherever they are, the nearest to the own flag.",
    ),
    (Boat::FlagCarrier, "flag_carrier", "The enemy that carries a flag of the own team; of several the nearest."),
    (
        Boat::Opponent,
        "opponent",
        "The enemy assigned to this boat: the one of the same rank, counted round where there are fewer enemies.",
    ),
    (Boat::NearestMate, "nearest_mate", "The nearest other boat of the own team."),
    (Boat::MateCarrier, "mate_carrier", "The other boat of the own team that carries a flag; of several the nearest."),
];

impl Mark {
    /// All marks, in the order in which they are explained.
    pub fn all() -> impl Iterator<Item = Mark> {
        MARKS.iter().map(|row| row.0)
    }

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        MARKS.iter().find(|row| row.0 == self).expect("the table has every mark").1
    }

    /// What it is.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        MARKS.iter().find(|row| row.0 == self).expect("the table has every mark").2
    }
}

impl Boat {
    /// All boats, in the order in which they are explained.
    pub fn all() -> impl Iterator<Item = Boat> {
        BOATS.iter().map(|row| row.0)
    }

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        BOATS.iter().find(|row| row.0 == self).expect("the table has every boat").1
    }

    /// What it is.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        BOATS.iter().find(|row| row.0 == self).expect("the table has every boat").2
    }
}

impl Place {
    /// The mark or boat called `name`; the named points of a field are not among them.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Place> {
        let mark = Mark::all().find(|mark| mark.name() == name).map(Place::Mark);
        mark.or_else(|| Boat::all().find(|boat| boat.name() == name).map(Place::Boat))
    }
}
