//! Facts and measures: the values of the game that expressions can use.

use serde::{Deserialize, Serialize};
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// The kind of a value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// True or false.
    Truth,
    /// A number.
    Number,
    /// One of these strings.
    Text(Vec<String>),
}

impl Kind {
    /// A Boolean if `is_truth`, otherwise a number.
    pub fn of(is_truth: bool) -> Kind {
        if is_truth { Kind::Truth } else { Kind::Number }
    }

    /// A value of this kind, as written in files.
    pub fn text_of(&self, value: f64) -> String {
        match self {
            Kind::Truth => (value != 0.0).to_string(),
            Kind::Number => value.to_string(),
            Kind::Text(texts) => texts.get(value as usize).cloned().unwrap_or_default(),
        }
    }
}

/// A value of the game, as the boat knows it.
#[derive(VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fact {
    /// The boat is tagged.
    Tagged,
    /// The boat carries a flag.
    HasFlag,
    /// The boat is on its own side of the field.
    OwnSide,
    /// The boat is outside the field.
    Outside,
    /// The boat is out of action.
    Disabled,
    /// The boat may tag now: it is in play, and its cooldown is over.
    CanTag,
    /// An enemy carries one of the team's flags.
    FlagTaken,
    /// The boat or a teammate carries a flag.
    EnemyFlagTaken,
    /// A teammate carries a flag.
    MateHasFlag,
    /// An untagged enemy is on the team's side.
    EnemyInZone,
    /// Number of untagged enemies on the team's side.
    EnemiesInZone,
    /// Number of known enemies.
    Enemies,
    /// Number of tagged enemies.
    EnemiesTagged,
    /// Number of teammates.
    Mates,
    /// Number of tagged teammates.
    MatesTagged,
    /// Index in the team, from 0, in the order of the game file.
    Rank,
    /// Points of the team.
    Score,
    /// Points of the enemy.
    EnemyScore,
    /// Time since the start, s.
    TimeS,
    /// Time to the end, s.
    TimeLeftS,
    /// Time since the mode began, s.
    ModeS,
    /// Time since the last decision, s; for summing durations.
    StepS,
    /// Speed over the ground, m/s.
    #[strum(serialize = "speed_m_s")]
    SpeedMS,
}

/// A property of a place or a boat.
#[derive(VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Measure {
    /// Distance from the boat, or between two places, m; 1e9 if unknown.
    Distance,
    /// Rate at which the distance decreases, m/s; 0 if unknown.
    Closing,
    /// Speed over the ground, m/s; 0 if unknown.
    Speed,
    /// Whether the place currently exists.
    Known,
    /// Whether it is on the team's side.
    OnOwnSide,
    /// Whether it is a tagged boat.
    IsTagged,
    /// Number of teammates nearer to it than this boat, except tagged boats and carriers.
    MatesNearer,
}

impl Fact {
    /// Whether it is a Boolean rather than a number.
    pub fn is_truth(self) -> bool {
        use Fact::{
            CanTag, Disabled, EnemyFlagTaken, EnemyInZone, FlagTaken, HasFlag, MateHasFlag,
            Outside, OwnSide, Tagged,
        };
        let is_own = matches!(
            self,
            Tagged | HasFlag | OwnSide | Outside | Disabled | CanTag
        );
        is_own || matches!(self, FlagTaken | EnemyFlagTaken | MateHasFlag | EnemyInZone)
    }

    /// Whether it is an integer.
    pub fn is_whole(self) -> bool {
        !self.is_truth()
            && !matches!(
                self,
                Fact::TimeS | Fact::TimeLeftS | Fact::ModeS | Fact::StepS | Fact::SpeedMS
            )
    }
}

impl Measure {
    /// Whether it is a Boolean rather than a number.
    pub fn is_truth(self) -> bool {
        matches!(
            self,
            Measure::Known | Measure::OnOwnSide | Measure::IsTagged
        )
    }

    /// Whether it is an integer.
    pub fn is_whole(self) -> bool {
        self == Measure::MatesNearer
    }

    /// Whether it applies to two places.
    pub fn is_of_two(self) -> bool {
        matches!(self, Measure::Distance | Measure::Closing)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Named;
    use super::*;

    #[test]
    fn every_fact_and_measure_has_its_own_name_and_a_meaning() {
        let mut names: Vec<&str> = [Fact::names(), Measure::names()].concat();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        for fact in Fact::all() {
            assert!(fact.meaning().ends_with('.'), "{fact:?}");
            assert_eq!(Fact::by_name(fact.name()), Some(*fact));
        }
        assert_eq!(Fact::SpeedMS.name(), "speed_m_s");
    }
}
