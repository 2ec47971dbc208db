//! Team talk: variables that a strategy shares, told to mates and heard from them.

use super::scene::Scene;
use game::VehicleId;
use game::message::Word;
use game::strategy::{Expression, Fact, Kind, Measure, Place, Program, Values, Variable};
use xxhash_rust::xxh3::xxh3_64;

/// What one mate last said.
#[derive(Clone, Debug)]
struct Heard {
    mate: VehicleId,
    /// By variable of the own program: its value at the mate, if it ever said so.
    values: Vec<Option<f64>>,
}

/// What was heard from all mates.
#[derive(Clone, Debug)]
pub(crate) struct Ears {
    /// By variable: under which key it is told, if it is shared.
    keys: Vec<Option<u64>>,
    heard: Vec<Heard>,
}

impl Ears {
    pub(crate) fn new(program: &Program, mates: &[VehicleId]) -> Ears {
        let keys: Vec<Option<u64>> =
            program.variables.iter().map(|variable| variable.shared.then(|| key_of(variable))).collect();
        let heard = |mate: &VehicleId| Heard { mate: *mate, values: vec![None; keys.len()] };
        Ears { heard: mates.iter().map(heard).collect(), keys }
    }

    /// Whether anything is shared.
    pub(crate) fn talks(&self) -> bool {
        self.keys.iter().any(Option::is_some)
    }

    /// Takes in what mates said; words of others and about unknown variables are nothing to us.
    pub(crate) fn hear(&mut self, words: &[Word]) {
        for word in words.iter().filter(|word| word.value.is_finite()) {
            let variable = self.keys.iter().position(|key| *key == Some(word.key));
            // Mates are in the scenario's order.
            let mate = self.heard.binary_search_by_key(&word.vehicle, |heard| heard.mate);
            if let (Some(variable), Ok(mate)) = (variable, mate) {
                self.heard[mate].values[variable] = Some(word.value);
            }
        }
    }

    /// Says the own values of all shared variables.
    pub(crate) fn say(&self, me: VehicleId, variables: &[f64], words: &mut Vec<Word>) {
        let shared = self.keys.iter().zip(variables).filter_map(|(key, value)| key.map(|key| (key, *value)));
        words.extend(shared.map(|(key, value)| Word { vehicle: me, key, value }));
    }

    /// How many mates there are for which `condition` holds; one that has not said all that it asks for does not count.
    pub(crate) fn count(&self, scene: &Scene, condition: &Expression) -> f64 {
        let holds = |heard: &&Heard| {
            let mut complete = true;
            condition.walk(&mut |part| {
                if let Expression::Variable(index) = part {
                    complete &= heard.values.get(usize::from(*index)).is_some_and(Option::is_some);
                }
            });
            complete && condition.is_true(&Mate { heard, scene })
        };
        self.heard.iter().filter(holds).count() as f64
    }
}

/// A shared variable is the same to two programs if its name and everything that it can be are the same.
fn key_of(variable: &Variable) -> u64 {
    let kind = match &variable.kind {
        Kind::Truth => "truth".to_owned(),
        Kind::Number => "number".to_owned(),
        Kind::Text(values) => values.join(","),
    };
    xxh3_64(format!("{} {kind}", variable.name).as_bytes())
}

/// A mate's variables in the own scene.
struct Mate<'a> {
    heard: &'a Heard,
    scene: &'a Scene,
}

impl Values for Mate<'_> {
    fn fact(&self, fact: Fact) -> f64 {
        self.scene.fact(fact)
    }
    fn variable(&self, index: u16) -> f64 {
        self.heard.values.get(usize::from(index)).copied().flatten().unwrap_or(0.0)
    }
    fn measure(&self, measure: Measure, place: &Place) -> f64 {
        self.scene.measure(measure, place)
    }
    fn mates(&self, _condition: &Expression) -> f64 {
        0.0
    }
}
