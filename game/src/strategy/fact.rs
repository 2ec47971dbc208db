//! Facts: what conditions may ask of the game.

use super::expression::Measure;
use serde::{Deserialize, Serialize};

/// What kind of value something has.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// True or false.
    Truth,
    /// A number.
    Number,
    /// One of these texts.
    Text(Vec<String>),
}

/// Something that is known of the game, as the own boat knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the table below says what each one is, for the reference page as well")]
pub enum Fact {
    Tagged,
    HasFlag,
    OwnSide,
    Outside,
    Disabled,
    CanTag,
    FlagTaken,
    EnemyFlagTaken,
    MateHasFlag,
    EnemyInZone,
    EnemiesInZone,
    Enemies,
    EnemiesTagged,
    Mates,
    MatesTagged,
    Rank,
    Score,
    EnemyScore,
    TimeS,
    TimeLeftS,
    ModeS,
    StepS,
    SpeedMS,
}

/// The facts: name in files, whether it is a truth, smallest value it can have, what it says.
const FACTS: [(Fact, &str, bool, f64, &str); 23] = [
    (Fact::Tagged, "tagged", true, 0.0, "The own boat is tagged."),
    (Fact::HasFlag, "has_flag", true, 0.0, "The own boat carries a flag."),
    (Fact::OwnSide, "own_side", true, 0.0, "The own boat is on its own team's side of the field."),
    (Fact::Outside, "outside", true, 0.0, "The own boat is outside of the field."),
    (Fact::Disabled, "disabled", true, 0.0, "The own boat is out of action by power play."),
    (Fact::CanTag, "can_tag", true, 0.0, "The own boat could tag now: it plays, and its last tag is long enough ago."),
    (Fact::FlagTaken, "flag_taken", true, 0.0, "An enemy carries a flag of the own team."),
    (Fact::EnemyFlagTaken, "enemy_flag_taken", true, 0.0, "A boat of the own team, this one included, carries a flag."),
    (Fact::MateHasFlag, "mate_has_flag", true, 0.0, "Another boat of the own team carries a flag."),
    (
        Fact::EnemyInZone,
        "enemy_in_zone",
        true,
        0.0,
        "An enemy that is not tagged is on the own team's side of the field.",
    ),
    (Fact::EnemiesInZone, "enemies_in_zone", false, 0.0, "How many such enemies there are."),
    (Fact::Enemies, "enemies", false, 0.0, "How many enemies are known."),
    (Fact::EnemiesTagged, "enemies_tagged", false, 0.0, "How many enemies are tagged."),
    (Fact::Mates, "mates", false, 0.0, "How many other boats the own team has."),
    (Fact::MatesTagged, "mates_tagged", false, 0.0, "How many of them are tagged."),
    (Fact::Rank, "rank", false, 0.0, "The own boat's place in its team, from 0, in the order of the game file."),
    (Fact::Score, "score", false, 0.0, "The own team's points."),
    (Fact::EnemyScore, "enemy_score", false, 0.0, "The enemy's points."),
    (Fact::TimeS, "time_s", false, 0.0, "Time since the start of the game, s."),
    (Fact::TimeLeftS, "time_left_s", false, 0.0, "Time until the end of the game, s."),
    (Fact::ModeS, "mode_s", false, 0.0, "Time since the present mode began, s."),
    (Fact::StepS, "step_s", false, 0.0, "Time since the decision before, s: to count up times."),
    (Fact::SpeedMS, "speed_m_s", false, 0.0, "The own boat's speed over the ground, m/s."),
];

/// The measures: name in files, whether it is a truth, smallest value, what it says.
const MEASURES: [(Measure, &str, bool, f64, &str); 4] = [
    (Measure::Distance, "distance", false, 0.0, "How far it is from the own boat, m; 1e9 if there is no such thing."),
    (
        Measure::Closing,
        "closing",
        false,
        f64::NEG_INFINITY,
        "How fast the distance to it shrinks, m/s; negative while it grows; 0 if there is no such thing.",
    ),
    (Measure::Known, "known", true, 0.0, "Whether there is such a thing now."),
    (Measure::OnOwnSide, "on_own_side", true, 0.0, "Whether it is on the own team's side of the field."),
];

impl Fact {
    /// All facts, in the order in which they are explained.
    pub fn all() -> impl Iterator<Item = Fact> {
        FACTS.iter().map(|row| row.0)
    }

    fn row(self) -> &'static (Fact, &'static str, bool, f64, &'static str) {
        FACTS.iter().find(|row| row.0 == self).expect("the table has every fact")
    }

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().1
    }

    /// Whether it is true or false rather than a number.
    #[must_use]
    pub fn is_truth(self) -> bool {
        self.row().2
    }

    /// Whether it counts something, and so is a whole number.
    #[must_use]
    pub fn is_whole(self) -> bool {
        !self.is_truth() && !matches!(self, Fact::TimeS | Fact::TimeLeftS | Fact::ModeS | Fact::StepS | Fact::SpeedMS)
    }

    /// The smallest value it can have.
    #[must_use]
    pub fn least(self) -> f64 {
        self.row().3
    }

    /// What it says.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        self.row().4
    }
}

impl Measure {
    /// All measures, in the order in which they are explained.
    pub fn all() -> impl Iterator<Item = Measure> {
        MEASURES.iter().map(|row| row.0)
    }

    fn row(self) -> &'static (Measure, &'static str, bool, f64, &'static str) {
        MEASURES.iter().find(|row| row.0 == self).expect("the table has every measure")
    }

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().1
    }

    /// Whether it is true or false rather than a number.
    #[must_use]
    pub fn is_truth(self) -> bool {
        self.row().2
    }

    /// The smallest value it can have.
    #[must_use]
    pub fn least(self) -> f64 {
        self.row().3
    }

    /// What it says.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        self.row().4
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fact_and_measure_has_its_own_name() {
        let mut names: Vec<&str> = Fact::all().map(Fact::name).chain(Measure::all().map(Measure::name)).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), FACTS.len() + MEASURES.len());
        // The last of each enumeration is in the table, and so are all before it.
        assert_eq!(Fact::all().max(), Some(Fact::SpeedMS));
        assert_eq!(Fact::all().count(), Fact::SpeedMS as usize + 1);
        assert_eq!(Measure::all().count(), Measure::OnOwnSide as usize + 1);
    }
}
