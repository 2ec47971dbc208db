//! Actions: a policy's choices for its boat at a decision.

use primitives::angle::wrap_pi;
use primitives::math;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::f64::consts::PI;
use std::fmt;

/// The actions that a policy can choose from.
#[expect(
    clippy::large_enum_variant,
    reason = "there are few spaces, and copies make them simpler to use"
)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ActionSpace {
    /// The actions of Pyquaticus.
    Pyquaticus,
    /// A turn and a speed.
    Continuous,
    /// The values of a strategy variable.
    Options,
    /// The actions of a table.
    #[serde(untagged)]
    Table(ActionTable),
}

// Not derived: an untagged variant's errors would not name the allowed values.
impl<'de> Deserialize<'de> for ActionSpace {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ActionSpace, D::Error> {
        struct NameOrTable;

        impl<'de> Visitor<'de> for NameOrTable {
            type Value = ActionSpace;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "pyquaticus, continuous, options, or a list of \
                     [fraction of the top speed, turn in degrees]",
                )
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<ActionSpace, E> {
                Ok(match Named::deserialize(name.into_deserializer())? {
                    Named::Pyquaticus => ActionSpace::Pyquaticus,
                    Named::Continuous => ActionSpace::Continuous,
                    Named::Options => ActionSpace::Options,
                })
            }

            fn visit_seq<A: SeqAccess<'de>>(self, actions: A) -> Result<ActionSpace, A::Error> {
                let table = ActionTable::deserialize(SeqAccessDeserializer::new(actions))?;
                Ok(ActionSpace::Table(table))
            }
        }

        deserializer.deserialize_any(NameOrTable)
    }
}

/// Action spaces by name.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Named {
    /// The actions of Pyquaticus: full or half speed in eight directions, and a stop.
    Pyquaticus,
    /// Two numbers from -1 to 1: the turn, in half turns clockwise, and the speed, from -1 (stop)
    /// to 1 (the boat's maximum).
    Continuous,
    /// The values of a strategy variable, which affect the strategy's rules and modes instead of
    /// steering the boat directly.
    Options,
}

impl JsonSchema for ActionSpace {
    fn schema_name() -> Cow<'static, str> {
        "ActionSpace".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Named::json_schema(generator)
    }
}

/// Turns and speeds to choose from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<[f64; 2]>", into = "Vec<[f64; 2]>")]
pub struct ActionTable {
    /// Fraction of the boat's top speed, and turn in degrees clockwise.
    actions: [[f64; 2]; ACTIONS_MAX],
    count: usize,
}

/// Maximum number of actions of a table.
const ACTIONS_MAX: usize = 64;

// Equality is reflexive, because the numbers are finite.
impl Eq for ActionTable {}

impl ActionTable {
    fn actions(&self) -> &[[f64; 2]] {
        &self.actions[..self.count]
    }
}

impl From<ActionTable> for Vec<[f64; 2]> {
    fn from(table: ActionTable) -> Vec<[f64; 2]> {
        table.actions().to_vec()
    }
}

impl TryFrom<Vec<[f64; 2]>> for ActionTable {
    type Error = String;

    fn try_from(given: Vec<[f64; 2]>) -> Result<ActionTable, String> {
        let count = given.len();
        if !(2..=ACTIONS_MAX).contains(&count) {
            return Err(format!("{count} actions, expected 2 to {ACTIONS_MAX}"));
        }
        let is_wrong = |[speed, turn_deg]: &[f64; 2]| {
            !((0.0..=1.0).contains(speed) && turn_deg.abs() <= 180.0)
        };
        if let Some([speed, turn_deg]) = given.iter().find(|action| is_wrong(action)) {
            return Err(format!(
                "the action [{speed}, {turn_deg}], expected [0 to 1, -180 to 180]"
            ));
        }
        let mut actions = [[0.0; 2]; ACTIONS_MAX];
        actions[..count].copy_from_slice(&given);
        Ok(ActionTable { actions, count })
    }
}

/// The key for actions in a file: a named space, or a table.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only the schema is used")]
#[schemars(extend("x-expected" = "pyquaticus, continuous, options, or a list of [fraction of the top speed, turn in degrees]"))]
pub(crate) enum ActionKey {
    Named(Named),
    Table(#[schemars(length(min = 2, max = 64))] Vec<TableAction>),
}

/// A fraction of the boat's top speed, and a turn in degrees clockwise.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "only the schema is used")]
pub(crate) struct TableAction(
    #[schemars(range(min = 0, max = 1))] f64,
    #[schemars(range(min = -180, max = 180))] f64,
);

/// A policy's choice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// The index of one of several actions.
    Discrete(usize),
    /// Numbers from -1 to 1; values outside are clamped.
    Continuous([f32; 2]),
}

impl Action {
    /// The discrete action sampled from the softmax of these logits; `unit` is a uniform random
    /// number from 0 to 1.
    pub fn drawn(logits: &[f32], unit: f64) -> Action {
        let mut below = 0.0;
        let all = probabilities(logits);
        let drawn = all.iter().position(|probability| {
            below += f64::from(*probability);
            unit < below
        });
        // Rounding may leave the sum just below 1.
        drawn.map_or_else(|| Action::likeliest(logits), Action::Discrete)
    }

    /// The discrete action with the largest logit; ties go to the first.
    pub fn likeliest(logits: &[f32]) -> Action {
        Action::Discrete(
            (1..logits.len()).fold(0, |best, i| if logits[i] > logits[best] { i } else { best }),
        )
    }
}

impl ActionSpace {
    /// A discrete action as a string: "50 % speed, 45° to port".
    pub fn words(self, action: usize) -> String {
        if self == ActionSpace::Options {
            return format!("option {action}");
        }
        let asked = self.set_point(Action::Discrete(action), 0.0, 1.0);
        let speed = match asked.speed_m_s {
            0.0 => return "stop".to_owned(),
            1.0 => "full speed".to_owned(),
            share => format!("{:.0} % speed", 100.0 * share),
        };
        match asked.turn_rad.to_degrees().round() {
            0.0 => format!("{speed}, straight on"),
            turn_deg if turn_deg.abs() >= 180.0 => format!("{speed}, about"),
            turn_deg if turn_deg > 0.0 => format!("{speed}, {turn_deg:.0}° to starboard"),
            turn_deg => format!("{speed}, {:.0}° to port", -turn_deg),
        }
    }
}

/// The softmax of the logits: the probability of each action.
pub fn probabilities(logits: &[f32]) -> Vec<f32> {
    let most = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let parts = logits
        .iter()
        .map(|logit| math::exp(f64::from(logit - most)));
    let parts: Vec<f64> = parts.collect();
    let sum: f64 = parts.iter().sum();
    parts.iter().map(|part| (part / sum) as f32).collect()
}

/// The set-point that an action requests from a boat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SetPoint {
    /// Desired turn, rad clockwise, -pi to pi: half a turn to port and half a turn to starboard are
    /// different requests.
    pub turn_rad: f64,
    /// Desired course after this turn from the heading at the decision, rad clockwise from north.
    pub course_rad: f64,
    /// Desired speed, m/s.
    pub speed_m_s: f64,
}

/// Number of turns at each speed, from half a turn to starboard to nearly half a turn to port.
const TURNS: usize = 8;
/// Speeds of the discrete actions, as fractions of the top speed.
const SPEEDS: [f64; 2] = [1.0, 0.5];

impl ActionSpace {
    /// Number of discrete actions; `None` for continuous actions, and for options, whose number
    /// depends on a strategy.
    pub fn count(self) -> Option<usize> {
        match self {
            ActionSpace::Pyquaticus => Some(SPEEDS.len() * TURNS + 1),
            ActionSpace::Table(table) => Some(table.count),
            ActionSpace::Continuous | ActionSpace::Options => None,
        }
    }

    /// Number of a policy's outputs: one logit for each discrete action, or one number for each
    /// dimension; for options, the minimum.
    pub fn outputs(self) -> usize {
        self.count().unwrap_or(2)
    }

    /// Whether actions are discrete.
    pub fn is_discrete(self) -> bool {
        self != ActionSpace::Continuous
    }

    /// The action nearest to this turn (rad clockwise) and speed, the inverse of
    /// [`ActionSpace::set_point`]; `None` for options.
    pub fn nearest(self, turn_rad: f64, speed_m_s: f64, speed_max_m_s: f64) -> Option<Action> {
        let share = (speed_m_s / speed_max_m_s).clamp(0.0, 1.0);
        if self == ActionSpace::Continuous {
            return Some(Action::Continuous(
                [turn_rad / PI, 2.0 * share - 1.0].map(|number| number as f32),
            ));
        }
        // A turn of one radian counts as much as the whole speed range. A stop has no turn.
        let off = |action: usize| {
            let asked = self.set_point(Action::Discrete(action), 0.0, 1.0);
            let by_turn = if asked.speed_m_s == 0.0 {
                0.0
            } else {
                wrap_pi(asked.turn_rad - turn_rad)
            };
            let by_speed = asked.speed_m_s - share;
            by_turn * by_turn + by_speed * by_speed
        };
        (0..self.count()?)
            .min_by(|a, b| off(*a).total_cmp(&off(*b)))
            .map(Action::Discrete)
    }

    /// The turn and speed of an action for a boat with this heading and top speed. Actions of a
    /// different space, non-finite actions and options mean a stop.
    pub fn set_point(self, action: Action, heading_rad: f64, speed_max_m_s: f64) -> SetPoint {
        let (turn_rad, share) = match (self, action) {
            (ActionSpace::Pyquaticus, Action::Discrete(i)) if i < SPEEDS.len() * TURNS => (
                PI - (i % TURNS) as f64 * 2.0 * PI / TURNS as f64,
                SPEEDS[i / TURNS],
            ),
            (ActionSpace::Table(table), Action::Discrete(i)) if i < table.count => {
                let [speed, turn_deg] = table.actions()[i];
                (turn_deg.to_radians(), speed)
            }
            (ActionSpace::Continuous, Action::Continuous([turn, speed]))
                if turn.is_finite() && speed.is_finite() =>
            {
                let [turn, speed] = [turn, speed].map(|number| f64::from(number).clamp(-1.0, 1.0));
                (turn * PI, 0.5 * (1.0 + speed))
            }
            _ => (0.0, 0.0),
        };
        SetPoint {
            turn_rad,
            course_rad: wrap_pi(heading_rad + turn_rad),
            speed_m_s: share * speed_max_m_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Action, ActionSpace};

    #[test]
    fn the_discrete_actions_are_those_of_pyquaticus() {
        let space = ActionSpace::Pyquaticus;
        let turns_deg = [180.0, 135.0, 90.0, 45.0, 0.0, -45.0, -90.0, -135.0];
        let speeds_m_s = [2.0, 1.0].into_iter();
        let want = speeds_m_s.flat_map(|speed_m_s| turns_deg.map(|deg| (speed_m_s, deg)));
        let want = want.chain([(0.0, 0.0)]);
        assert_eq!(space.count(), Some(17));
        for (i, (speed_m_s, turn_deg)) in want.enumerate() {
            let got = space.set_point(Action::Discrete(i), 1.0, 2.0);
            let off_rad = got.turn_rad - f64::to_radians(turn_deg);
            let off_course_rad =
                primitives::angle::wrap_pi(got.course_rad - 1.0 - f64::to_radians(turn_deg));
            assert!(
                off_rad.abs().max(off_course_rad.abs()) < 1e-12
                    && (got.speed_m_s - speed_m_s).abs() < 1e-12,
                "{i}: {got:?}"
            );
        }
    }

    #[test]
    fn a_table_s_actions_are_its_own_and_faulty_tables_are_refused() {
        let read = serde_json::from_str::<ActionSpace>;
        let text = "[[1.0,-0.25],[0.5,180.0],[0.0,0.0]]";
        let space = read(text).expect("it is a table");
        assert_eq!(serde_json::to_string(&space).expect("JSON"), text);
        assert_eq!(
            (space.count(), space.outputs(), space.is_discrete()),
            (Some(3), 3, true)
        );
        for (i, want) in [
            (0, (3.0, -0.25)),
            (1, (1.5, 180.0)),
            (2, (0.0, 0.0)),
            (3, (0.0, 0.0)),
        ] {
            let got = space.set_point(Action::Discrete(i), 1.0, 3.0);
            assert_eq!(
                (got.speed_m_s, got.turn_rad),
                (want.0, f64::to_radians(want.1))
            );
        }
        assert_eq!(space.words(1), "50 % speed, about");
        assert_eq!(space.nearest(3.0, 1.4, 3.0), Some(Action::Discrete(1)));
        for wrong in [
            "[[1,0]]",
            "[[1.1,0],[0,0]]",
            "[[1,0],[0,181]]",
            "[[1,0],[0]]",
            "\"x\"",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
        let many = serde_json::to_string(&vec![[0.5, 0.0]; 65]).expect("JSON");
        assert!(read(&many).is_err());
    }

    #[test]
    fn the_nearest_action_is_the_one_that_asked() {
        let fastest_m_s = 3.0;
        let space = ActionSpace::Pyquaticus;
        for action in (0..17).map(Action::Discrete) {
            let asked = space.set_point(action, 2.5, fastest_m_s);
            let nearest = space.nearest(asked.turn_rad, asked.speed_m_s, fastest_m_s);
            assert_eq!(nearest, Some(action));
        }
        let space = ActionSpace::Continuous;
        for asked in [[-0.25, 0.5], [1.0, 1.0], [-1.0, 1.0]] {
            let wanted = space.set_point(Action::Continuous(asked), 2.5, fastest_m_s);
            assert_eq!(
                space.nearest(wanted.turn_rad, wanted.speed_m_s, fastest_m_s),
                Some(Action::Continuous(asked))
            );
        }
        // A slow turn of 10 degrees to starboard, and almost zero speed in any direction.
        for (space, turn_deg, speed_m_s, want) in [
            (ActionSpace::Pyquaticus, 10.0, 1.4, Some(12)),
            (ActionSpace::Pyquaticus, 70.0, 0.1, Some(16)),
            (ActionSpace::Options, 10.0, 1.4, None),
        ] {
            assert_eq!(
                space.nearest(f64::to_radians(turn_deg), speed_m_s, fastest_m_s),
                want.map(Action::Discrete)
            );
        }
    }

    #[test]
    fn actions_are_drawn_as_often_as_their_probabilities_say() {
        let logits = [1.0_f32, 2.0, 0.5].map(f32::ln);
        let mut counts = [0; 3];
        for i in 0..700 {
            let Action::Discrete(action) = Action::drawn(&logits, (f64::from(i) + 0.5) / 700.0)
            else {
                panic!("no discrete action")
            };
            counts[action] += 1;
        }
        assert_eq!(counts, [200, 400, 100]);
    }

    #[test]
    fn an_action_is_told_in_words() {
        let words = |action| ActionSpace::Pyquaticus.words(action);
        for (action, want) in [
            (0, "full speed, about"),
            (4, "full speed, straight on"),
            (9, "50 % speed, 135° to starboard"),
            (6, "full speed, 90° to port"),
            (16, "stop"),
            (99, "stop"),
        ] {
            assert_eq!(words(action), want);
        }
    }

    #[test]
    fn continuous_actions_stay_within_their_limits_and_nonsense_stops_the_boat() {
        let of = |turn, speed| {
            ActionSpace::Continuous.set_point(Action::Continuous([turn, speed]), 0.5, 3.0)
        };
        assert!((of(0.0, 1.0).course_rad - 0.5).abs() < 1e-12 && of(0.0, 9.0).speed_m_s == 3.0);
        assert!((of(0.5, 0.0).course_rad - 0.5 - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(of(0.0, 0.0).speed_m_s, 1.5);
        assert_eq!(of(f32::NAN, 1.0).speed_m_s, 0.0);
        assert_eq!(
            ActionSpace::Pyquaticus
                .set_point(Action::Discrete(99), 0.5, 3.0)
                .speed_m_s,
            0.0
        );
        assert_eq!(
            ActionSpace::Continuous
                .set_point(Action::Discrete(0), 0.5, 3.0)
                .speed_m_s,
            0.0
        );
    }
}
