//! Facts and measures: the game's values available to expressions.

use serde::{Deserialize, Serialize};
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// The kind of a value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// True or false.
    Truth,
    /// A number.
    Number,
    /// One of these texts.
    Text(Vec<String>),
}

impl Kind {
    /// A truth if `is_truth`, otherwise a number.
    #[must_use]
    pub fn of(is_truth: bool) -> Kind {
        if is_truth { Kind::Truth } else { Kind::Number }
    }

    /// A value of this kind, as written in files.
    #[must_use]
    pub fn text_of(&self, value: f64) -> String {
        match self {
            Kind::Truth => (value != 0.0).to_string(),
            Kind::Number => value.to_string(),
            Kind::Text(texts) => texts.get(value as usize).cloned().unwrap_or_default(),
        }
    }
}

/// Something that is known of the game, as the own boat knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
pub enum Fact {
    /// The own boat is tagged.
    Tagged,
    /// The own boat carries a flag.
    HasFlag,
    /// The own boat is on its own team's side of the field.
    OwnSide,
    /// The own boat is outside of the field.
    Outside,
    /// The own boat is out of action by power play.
    Disabled,
    /// The own boat could tag now: it plays, and its last tag is long enough ago.
    CanTag,
    /// An enemy carries a flag of the own team.
    FlagTaken,
    /// A boat of the own team, this one included, carries a flag.
    EnemyFlagTaken,
    /// Another boat of the own team carries a flag.
    MateHasFlag,
    /// An enemy that is not tagged is on the own team's side of the field.
    EnemyInZone,
    /// How many such enemies there are.
    EnemiesInZone,
    /// How many enemies are known.
    Enemies,
    /// How many enemies are tagged.
    EnemiesTagged,
    /// How many other boats the own team has.
    Mates,
    /// How many of them are tagged.
    MatesTagged,
    /// The own boat's place in its team, from 0, in the order of the game file.
    Rank,
    /// The own team's points.
    Score,
    /// The enemy's points.
    EnemyScore,
    /// Time since the start of the game, s.
    TimeS,
    /// Time until the end of the game, s.
    TimeLeftS,
    /// Time since the present mode began, s.
    ModeS,
    /// Time since the decision before, s: to count up times.
    StepS,
    /// The own boat's speed over the ground, m/s.
    #[strum(serialize = "speed_m_s")]
    SpeedMS,
}

/// What can be asked about a place or a boat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
pub enum Measure {
    /// How far it is from the own boat, or the first from the second, m; 1e9 if there is no such thing.
    Distance,
    /// How fast that distance shrinks, m/s; negative while it grows; 0 if there is no such thing.
    Closing,
    /// How fast it goes over the ground, m/s; 0 if there is no such thing.
    Speed,
    /// Whether there is such a thing now.
    Known,
    /// Whether it is on the own team's side of the field.
    OnOwnSide,
    /// Whether it is a boat that is tagged.
    IsTagged,
    /// How many other boats of the own team are nearer to it than the own boat; those that are tagged or carry a flag do not
    /// count.
    MatesNearer,
}

impl Fact {
    /// Whether it is true or false rather than a number.
    #[must_use]
    pub fn is_truth(self) -> bool {
        use Fact::{
            CanTag, Disabled, EnemyFlagTaken, EnemyInZone, FlagTaken, HasFlag, MateHasFlag, Outside, OwnSide, Tagged,
        };
        let is_own = matches!(self, Tagged | HasFlag | OwnSide | Outside | Disabled | CanTag);
        is_own || matches!(self, FlagTaken | EnemyFlagTaken | MateHasFlag | EnemyInZone)
    }

    /// Whether it is a count, and so a whole number.
    #[must_use]
    pub fn is_whole(self) -> bool {
        !self.is_truth() && !matches!(self, Fact::TimeS | Fact::TimeLeftS | Fact::ModeS | Fact::StepS | Fact::SpeedMS)
    }
}

impl Measure {
    /// Whether it is true or false rather than a number.
    #[must_use]
    pub fn is_truth(self) -> bool {
        matches!(self, Measure::Known | Measure::OnOwnSide | Measure::IsTagged)
    }

    /// Whether it is a count, and so a whole number.
    #[must_use]
    pub fn is_whole(self) -> bool {
        self == Measure::MatesNearer
    }

    /// Whether it applies to two places.
    #[must_use]
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
