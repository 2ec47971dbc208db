//! A trained policy: the network of an ONNX file, and what it is given and chooses.

use crate::action::ActionSpace;
use crate::observation::ObservationSpace;
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use onnx::{Network, NetworkError, Port};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::Arc;
use thiserror::Error;

/// The largest model file, bytes: it goes to every agent with the scenario.
pub const BYTES_MAX: u64 = 1 << 20;
/// How long a decision of a policy may hold, s.
pub const PERIODS_S: RangeInclusive<f64> = 0.01..=10.0;

/// The entries of a model's metadata that are read, by [`PolicySpec`]'s fields.
const OBSERVATION: &str = "squall.observation";
const OBSERVATION_VERSION: &str = "squall.observation_version";
const ACTION: &str = "squall.action";
const PERIOD_S: &str = "squall.period_s";
/// The entry with the names of options, in order, with a comma between them.
const OPTIONS: &str = "squall.options";

/// What a model is given, what it chooses, and how often.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicySpec {
    /// The numbers that it is given.
    pub observation: ObservationSpace,
    /// What it chooses.
    pub action: ActionSpace,
    /// The time from one decision to the next, s.
    pub period_s: f64,
}

/// The same as far as somebody says it; the rest is in the model's metadata.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PartialSpec {
    /// The numbers that it is given.
    pub observation: Option<ObservationSpace>,
    /// What it chooses.
    pub action: Option<ActionSpace>,
    /// The time from one decision to the next, s.
    pub period_s: Option<f64>,
}

impl PartialSpec {
    /// Whether a spec says all of this.
    #[must_use]
    pub fn is_part_of(&self, spec: &PolicySpec) -> bool {
        self.observation.is_none_or(|observation| observation == spec.observation)
            && self.action.is_none_or(|action| action == spec.action)
            && self.period_s.is_none_or(|period_s| period_s == spec.period_s)
    }
}

/// A policy that can be asked. Clones share the network's weights.
#[derive(Clone)]
pub struct PolicyModel {
    /// Its file, as it was found.
    pub name: String,
    /// What it is given and chooses.
    pub spec: PolicySpec,
    /// Which of the network's outputs makes the action.
    output: usize,
    network: Network,
    bytes: Arc<[u8]>,
}

/// Why a file is no policy. Each text says what was found, and what is allowed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PolicyError {
    /// It is no network that can be evaluated.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// An entry of its metadata cannot be read.
    #[error("its metadata has {key} = {found:?}, expected {expected}")]
    Metadata {
        /// The entry.
        key: &'static str,
        /// What it says.
        found: String,
        /// What it may say.
        expected: String,
    },
    /// Nobody says what it is given or chooses.
    #[error("its metadata has no {key}, expected it there or {said_by} here")]
    Unsaid {
        /// The entry that is missing.
        key: &'static str,
        /// Who might have said it instead.
        said_by: &'static str,
    },
    /// It was made for something else.
    #[error("its metadata has {key} = {found}, expected {expected}, which is said here")]
    Contradiction {
        /// The entry.
        key: &'static str,
        /// What it says.
        found: String,
        /// What is said in the other place.
        expected: String,
    },
    /// It has more inputs than one, or one of another size.
    #[error("it takes {found}, expected {expected}")]
    Input {
        /// Its inputs.
        found: String,
        /// What they may be.
        expected: String,
    },
    /// None of its outputs makes an action, or several do.
    #[error("it gives {found}, expected {expected}")]
    Output {
        /// Its outputs.
        found: String,
        /// What they may be.
        expected: String,
    },
}

impl PolicyModel {
    /// Reads an ONNX file as a policy. What `said` leaves open, its metadata has to say.
    ///
    /// # Errors
    /// [`PolicyError`]: if it is no network, says other than `said`, or nothing, or has other inputs and outputs than it says.
    pub fn read(name: &str, bytes: &[u8], said: PartialSpec) -> Result<PolicyModel, PolicyError> {
        let network = Network::read(bytes)?;
        let spec = spec_of(&network, said)?;
        check_input(&network, spec.observation)?;
        let output = output_of(&network, spec.action)?;
        Ok(PolicyModel { name: name.to_owned(), spec, output, network, bytes: bytes.into() })
    }

    /// A network of its own, to be asked.
    #[must_use]
    pub fn network(&self) -> Network {
        self.network.clone()
    }

    /// Which of the network's outputs makes the action: a logit for each, the number of the action, or its numbers.
    #[must_use]
    pub fn output(&self) -> usize {
        self.output
    }

    /// How many numbers it is given.
    #[must_use]
    pub fn input_size(&self) -> usize {
        self.network.input_size()
    }

    /// How many discrete actions it chooses among; none if its actions are continuous.
    #[must_use]
    pub fn actions(&self) -> Option<usize> {
        let outputs = self.network.outputs()[self.output].size;
        // One number is that of the action itself.
        self.spec.action.is_discrete().then(|| self.spec.action.count().unwrap_or(outputs))
    }

    /// What the options that it chooses among are called, if its metadata says it.
    #[must_use]
    pub fn options(&self) -> Option<Vec<&str>> {
        let names = self.network.metadata().get(OPTIONS)?;
        (self.spec.action == ActionSpace::Options).then(|| names.split(',').collect())
    }

    /// What a discrete action is: "50 % speed, 45° to port", or the name of the option.
    #[must_use]
    pub fn words(&self, action: usize) -> String {
        let option = self.options().and_then(|names| names.get(action).map(|name| (*name).to_owned()));
        option.unwrap_or_else(|| self.spec.action.words(action))
    }

    /// The bytes of its file.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl PolicySpec {
    /// As entries of a model's metadata.
    #[must_use]
    pub fn metadata(&self) -> [(String, String); 4] {
        [
            (OBSERVATION, json(&self.observation)),
            (OBSERVATION_VERSION, self.observation.version().to_string()),
            (ACTION, unquoted(&json(&self.action))),
            (PERIOD_S, self.period_s.to_string()),
        ]
        .map(|(key, value)| (key.to_owned(), value))
    }
}

/// The names of options as an entry of a model's metadata.
#[must_use]
pub fn options_metadata(names: &[String]) -> (String, String) {
    (OPTIONS.to_owned(), names.join(","))
}

/// What a network is given and chooses, by what is said of it and by its metadata.
fn spec_of(network: &Network, said: PartialSpec) -> Result<PolicySpec, PolicyError> {
    let entry = |key: &str| network.metadata().get(key);
    let wrong = |key: &'static str, found: &str, expected: String| PolicyError::Metadata {
        key,
        found: found.to_owned(),
        expected,
    };
    let observation = entry(OBSERVATION).map(|text| {
        serde_json::from_str::<ObservationSpace>(text).map_err(|error| {
            let example = json(&ObservationSpace::Squall { mates: 1, enemies: 2, frames: 1 });
            wrong(OBSERVATION, text, format!("an observation space such as {example} ({error})"))
        })
    });
    let observation = agreed(OBSERVATION, "observation", observation.transpose()?, said.observation)?;
    if let Some(version) = entry(OBSERVATION_VERSION)
        && *version != observation.version().to_string()
    {
        return Err(wrong(OBSERVATION_VERSION, version, format!("{}, which is this program's", observation.version())));
    }
    let action = entry(ACTION).map(|text| {
        serde_json::from_value::<ActionSpace>(text.as_str().into())
            .map_err(|error| wrong(ACTION, text, format!("an action space ({error})")))
    });
    let action = agreed(ACTION, "action", action.transpose()?, said.action)?;
    let period_s = entry(PERIOD_S).map(|text| {
        let number = text.parse::<f64>().ok().filter(|number| PERIODS_S.contains(number));
        let allowed = || format!("{} to {} s", PERIODS_S.start(), PERIODS_S.end());
        number.ok_or_else(|| wrong(PERIOD_S, text, allowed()))
    });
    // The one thing that a policy bears to be changed.
    let period_s = match (said.period_s, period_s.transpose()?) {
        (Some(period_s), _) | (None, Some(period_s)) => period_s,
        (None, None) => return Err(PolicyError::Unsaid { key: PERIOD_S, said_by: "period_s" }),
    };
    Ok(PolicySpec { observation, action, period_s })
}

/// What the metadata and somebody else say, if one of them does and they do not differ.
fn agreed<T: PartialEq + Serialize>(
    key: &'static str,
    said_by: &'static str,
    found: Option<T>,
    said: Option<T>,
) -> Result<T, PolicyError> {
    match (found, said) {
        (Some(found), Some(said)) if found != said => {
            Err(PolicyError::Contradiction { key, found: json(&found), expected: json(&said) })
        }
        (_, Some(one)) | (Some(one), None) => Ok(one),
        (None, None) => Err(PolicyError::Unsaid { key, said_by }),
    }
}

fn check_input(network: &Network, observation: ObservationSpace) -> Result<(), PolicyError> {
    let wrong = |expected: String| PolicyError::Input { found: listed(network.inputs()), expected };
    let [input] = network.inputs() else { return Err(wrong("one input".to_owned())) };
    match observation {
        // The numbers of a game of 1 against 1, and of each other boat.
        ObservationSpace::Pyquaticus => {
            let (least, other) = (observation.size(0, 1), observation.size(1, 1) - observation.size(0, 1));
            if input.size < least || !(input.size - least).is_multiple_of(other) {
                return Err(wrong(format!("{least} numbers, or {other} more for each other boat")));
            }
        }
        ObservationSpace::Squall { .. } => {
            let size = observation.size(0, 0);
            if input.size != size {
                return Err(wrong(format!("{size} numbers for {}", json(&observation))));
            }
        }
    }
    Ok(())
}

/// The output that makes an action: the only one of the right size, or else the only one with the number of an action. Options are as
/// many as it has numbers.
fn output_of(network: &Network, action: ActionSpace) -> Result<usize, PolicyError> {
    let of_size = |size: usize| -> Vec<usize> {
        let outputs = network.outputs().iter().enumerate();
        outputs.filter(|(_, port)| port.size == size).map(|(i, _)| i).collect()
    };
    if action == ActionSpace::Options {
        let several: Vec<usize> = (0..network.outputs().len()).filter(|i| network.outputs()[*i].size > 1).collect();
        let expected = "one output with a number for each of two options or more".to_owned();
        let [output] = several[..] else {
            return Err(PolicyError::Output { found: listed(network.outputs()), expected });
        };
        return Ok(output);
    }
    let numbers = action.outputs();
    let whole = of_size(numbers);
    let index = if action.count().is_some() && whole.is_empty() { of_size(1) } else { vec![] };
    match (whole.as_slice(), index.as_slice()) {
        ([output], _) | ([], [output]) => Ok(*output),
        _ => {
            let or_index = if action.count().is_some() { ", or else one with the number of the action" } else { "" };
            let expected = format!("one output of {numbers} numbers for the action space {}{or_index}", json(&action));
            Err(PolicyError::Output { found: listed(network.outputs()), expected })
        }
    }
}

/// Inputs or outputs, as a message has them.
fn listed(ports: &[Port]) -> String {
    let shown = ports.iter().take(8).map(|port| format!("{:?} of {} numbers", port.name, port.size));
    shown.collect::<Vec<_>>().join(", ") + if ports.len() > 8 { ", …" } else { "" }
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

fn unquoted(text: &str) -> String {
    text.trim_matches('"').to_owned()
}

impl PartialEq for PolicyModel {
    fn eq(&self, other: &PolicyModel) -> bool {
        (&self.name, self.spec, &self.bytes) == (&other.name, other.spec, &other.bytes)
    }
}

impl fmt::Debug for PolicyModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PolicyModel").field("name", &self.name).field("spec", &self.spec).finish_non_exhaustive()
    }
}

/// As it goes to agents and into recordings.
#[derive(Serialize, Deserialize)]
struct Sent {
    name: String,
    spec: PolicySpec,
    /// The file in Base64.
    onnx: String,
}

impl Serialize for PolicyModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Sent { name: self.name.clone(), spec: self.spec, onnx: BASE64.encode(&self.bytes) }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for PolicyModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<PolicyModel, D::Error> {
        let Sent { name, spec: PolicySpec { observation, action, period_s }, onnx } = Sent::deserialize(deserializer)?;
        let bytes = BASE64.decode(onnx).map_err(D::Error::custom)?;
        if bytes.len() as u64 > BYTES_MAX {
            return Err(D::Error::custom(format!("a model of {} bytes, expected at most {BYTES_MAX}", bytes.len())));
        }
        if !PERIODS_S.contains(&period_s) {
            return Err(D::Error::custom(format!("a period of {period_s} s, expected {PERIODS_S:?}")));
        }
        let said = PartialSpec { observation: Some(observation), action: Some(action), period_s: Some(period_s) };
        PolicyModel::read(&name, &bytes, said).map_err(D::Error::custom)
    }
}
