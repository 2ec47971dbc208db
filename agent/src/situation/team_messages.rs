//! Team messages: the variables that a strategy shares with teammates.

use messages::Word;
use primitives::VehicleId;
use scenario::strategy::{Expression, Kind, Program, Values, Variable};
use xxhash_rust::xxh3::xxh3_64;

/// The last values received from one teammate.
#[derive(Clone, Debug)]
struct MateVariables {
    mate: VehicleId,
    /// Each of this program's variables as last received from the teammate, if ever.
    values: Vec<Option<f64>>,
}

/// The messages received from all teammates.
#[derive(Clone, Debug)]
pub(crate) struct TeamMessages {
    /// By variable: the key under which it is sent, if it is shared.
    keys: Vec<Option<u64>>,
    mates: Vec<MateVariables>,
}

impl TeamMessages {
    pub(crate) fn new(program: &Program, mates: &[VehicleId]) -> TeamMessages {
        let keys: Vec<Option<u64>> = program
            .variables
            .iter()
            .map(|variable| variable.shared.then(|| key_of(variable)))
            .collect();
        let of = |mate: &VehicleId| MateVariables {
            mate: *mate,
            values: vec![None; keys.len()],
        };
        TeamMessages {
            mates: mates.iter().map(of).collect(),
            keys,
        }
    }

    /// Whether any variable is shared.
    pub(crate) fn shares(&self) -> bool {
        self.keys.iter().any(Option::is_some)
    }

    /// Receives teammates' messages. Ignores other boats and unknown variables.
    pub(crate) fn receive(&mut self, messages: &[Word]) {
        for word in messages.iter().filter(|word| word.value.is_finite()) {
            let variable = self.keys.iter().position(|key| *key == Some(word.key));
            // Teammates are in the scenario's order.
            let mate = self
                .mates
                .binary_search_by_key(&word.vehicle, |from| from.mate);
            if let (Some(variable), Ok(mate)) = (variable, mate) {
                self.mates[mate].values[variable] = Some(word.value);
            }
        }
    }

    /// Adds the values of all shared variables.
    pub(crate) fn send(&self, me: VehicleId, variables: &[f64], messages: &mut Vec<Word>) {
        let shared = self
            .keys
            .iter()
            .zip(variables)
            .filter_map(|(key, value)| key.map(|key| (key, *value)));
        messages.extend(shared.map(|(key, value)| Word {
            vehicle: me,
            key,
            value,
        }));
    }

    /// The number of teammates for which `condition` holds. A teammate without all required values
    /// does not count.
    pub(crate) fn count(&self, condition: &Expression) -> f64 {
        let holds = |from: &&MateVariables| {
            let mut complete = true;
            condition.walk(&mut |part| {
                let is_known = |index: u16| {
                    from.values
                        .get(usize::from(index))
                        .is_some_and(Option::is_some)
                };
                complete &= part.as_variable().is_none_or(is_known);
            });
            complete && condition.is_true(*from)
        };
        self.mates.iter().filter(holds).count() as f64
    }
}

/// The key of a variable: two programs share a variable if its name and possible values are the
/// same.
fn key_of(variable: &Variable) -> u64 {
    let kind = match &variable.kind {
        Kind::Truth => "truth".to_owned(),
        Kind::Number => "number".to_owned(),
        Kind::Text(values) => values.join(","),
    };
    // A hash of name and kind: two strategies of one team need not list the same variables, and a
    // hash has a fixed size on the wire.
    xxh3_64(format!("{} {kind}", variable.name).as_bytes())
}

/// Only the shared variables of teammates are known.
impl Values for MateVariables {
    fn variable(&self, index: u16) -> f64 {
        self.values
            .get(usize::from(index))
            .copied()
            .flatten()
            .unwrap_or(0.0)
    }
}
