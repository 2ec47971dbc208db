//! Team messages: variables that a strategy shares, sent to mates and received from them.

use messages::Word;
use primitives::VehicleId;
use scenario::strategy::{Expression, Kind, Program, Values, Variable};
use xxhash_rust::xxh3::xxh3_64;

/// What one mate sent last.
#[derive(Clone, Debug)]
struct MateVariables {
    mate: VehicleId,
    /// By variable of the own program: its value at the mate, if it was ever received.
    values: Vec<Option<f64>>,
}

/// The messages received from all mates.
#[derive(Clone, Debug)]
pub(crate) struct TeamMessages {
    /// By variable: under which key it is sent, if it is shared.
    keys: Vec<Option<u64>>,
    mates: Vec<MateVariables>,
}

impl TeamMessages {
    pub(crate) fn new(program: &Program, mates: &[VehicleId]) -> TeamMessages {
        let keys: Vec<Option<u64>> =
            program.variables.iter().map(|variable| variable.shared.then(|| key_of(variable))).collect();
        let of = |mate: &VehicleId| MateVariables { mate: *mate, values: vec![None; keys.len()] };
        TeamMessages { mates: mates.iter().map(of).collect(), keys }
    }

    /// Whether anything is shared.
    pub(crate) fn shares(&self) -> bool {
        self.keys.iter().any(Option::is_some)
    }

    /// Takes in what mates sent; words of others and about unknown variables are ignored.
    pub(crate) fn receive(&mut self, messages: &[Word]) {
        for word in messages.iter().filter(|word| word.value.is_finite()) {
            let variable = self.keys.iter().position(|key| *key == Some(word.key));
            // Mates are in the scenario's order.
            let mate = self.mates.binary_search_by_key(&word.vehicle, |from| from.mate);
            if let (Some(variable), Ok(mate)) = (variable, mate) {
                self.mates[mate].values[variable] = Some(word.value);
            }
        }
    }

    /// Adds the own values of all shared variables.
    pub(crate) fn send(&self, me: VehicleId, variables: &[f64], messages: &mut Vec<Word>) {
        let shared = self.keys.iter().zip(variables).filter_map(|(key, value)| key.map(|key| (key, *value)));
        messages.extend(shared.map(|(key, value)| Word { vehicle: me, key, value }));
    }

    /// How many mates there are for which `condition` holds; one that has not sent all that it asks for does not count.
    pub(crate) fn count(&self, condition: &Expression) -> f64 {
        let holds = |from: &&MateVariables| {
            let mut complete = true;
            condition.walk(&mut |part| {
                let is_known = |index: u16| from.values.get(usize::from(index)).is_some_and(Option::is_some);
                complete &= part.as_variable().is_none_or(is_known);
            });
            complete && condition.is_true(*from)
        };
        self.mates.iter().filter(holds).count() as f64
    }
}

/// A shared variable is the same to two programs if its name and everything that it can be are the same.
fn key_of(variable: &Variable) -> u64 {
    let kind = match &variable.kind {
        Kind::Truth => "truth".to_owned(),
        Kind::Number => "number".to_owned(),
        Kind::Text(values) => values.join(","),
    };
    // A hash in place of the name: two strategies of one team need not list the same variables,
    // and a word on the wire has a fixed size.
    xxh3_64(format!("{} {kind}", variable.name).as_bytes())
}

/// Of mates nothing is known but their shared variables.
impl Values for MateVariables {
    fn variable(&self, index: u16) -> f64 {
        self.values.get(usize::from(index)).copied().flatten().unwrap_or(0.0)
    }
}
