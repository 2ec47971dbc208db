//! A trained policy: the network in an ONNX file, with its observation and action spaces.

use crate::action::ActionSpace;
use crate::observation::ObservationSpace;
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use onnx::{Network, Port};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Maximum size of a model file, bytes: every agent receives it with the scenario.
pub const BYTES_MAX: u64 = 1 << 20;
/// Allowed periods of a policy, s.
pub const PERIODS_S: RangeInclusive<f64> = 0.01..=10.0;

/// Metadata keys of a model, one for each field of [`PolicySpec`].
const OBSERVATION: &str = "squall.observation";
const OBSERVATION_VERSION: &str = "squall.observation_version";
const ACTION: &str = "squall.action";
const PERIOD_S: &str = "squall.period_s";
/// Metadata key of the option names, in order, separated by commas.
const OPTIONS: &str = "squall.options";

/// A model's observations, actions and period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicySpec {
    /// The observation space.
    pub observation: ObservationSpace,
    /// The action space.
    pub action: ActionSpace,
    /// Time between decisions, s.
    pub period_s: f64,
}

/// A spec with optional fields; the model's metadata supplies the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PartialSpec {
    /// The observation space.
    pub observation: Option<ObservationSpace>,
    /// The action space.
    pub action: Option<ActionSpace>,
    /// Time between decisions, s.
    pub period_s: Option<f64>,
}

/// A policy ready for evaluation. Clones share the network's weights.
#[derive(Clone, Serialize, Deserialize)]
#[serde(into = "Sent", try_from = "Sent")]
pub struct PolicyModel {
    /// Its file's path, or another name for messages.
    pub name: String,
    /// Its observations, actions and period.
    pub spec: PolicySpec,
    /// Index of the network output with the action.
    output: usize,
    network: Network,
    bytes: Arc<[u8]>,
}

impl PolicyModel {
    /// Reads an ONNX file as a policy. Its metadata must supply the fields missing from `said`.
    ///
    /// # Errors
    /// If the network is invalid, a field is missing or contradicts `said`, or the inputs or
    /// outputs do not fit the spec. The message gives the values found and allowed.
    pub fn read(name: &str, bytes: &[u8], said: PartialSpec) -> Result<PolicyModel, String> {
        let network = Network::read(bytes).map_err(|error| error.to_string())?;
        let spec = spec_of(&network, said)?;
        check_input(&network, spec.observation)?;
        let output = output_of(&network, spec.action)?;
        Ok(PolicyModel {
            name: name.to_owned(),
            spec,
            output,
            network,
            bytes: bytes.into(),
        })
    }

    /// A separate copy of the network for evaluation.
    pub fn network(&self) -> Network {
        self.network.clone()
    }

    /// Index of the network output with the action: logits, an index, or components.
    pub fn output(&self) -> usize {
        self.output
    }

    /// The number of values of an observation.
    pub fn input_size(&self) -> usize {
        self.network.input_size()
    }

    /// The number of discrete actions; `None` if its actions are continuous.
    pub fn actions(&self) -> Option<usize> {
        let outputs = self.network.outputs()[self.output].size;
        // A single output is the index of the action.
        let action = self.spec.action;
        (action.is_discrete()).then(|| action.count().unwrap_or(outputs))
    }

    /// Whether its output is a logit for each discrete action.
    pub fn has_logits(&self) -> bool {
        self.actions() == Some(self.network.outputs()[self.output].size)
    }

    /// The names of its options, if they are in its metadata.
    pub fn options(&self) -> Option<Vec<&str>> {
        let names = self.network.metadata().get(OPTIONS)?;
        (self.spec.action == ActionSpace::Options).then(|| names.split(',').collect())
    }

    /// A discrete action as a string: "50 % speed, 45° to port", or the name of the option.
    pub fn words(&self, action: usize) -> String {
        let option = self
            .options()
            .and_then(|names| names.get(action).map(|name| (*name).to_owned()));
        option.unwrap_or_else(|| self.spec.action.words(action))
    }

    /// The bytes of its file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl PolicySpec {
    /// The spec as metadata entries of a model.
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

/// The names of options as a metadata entry of a model.
pub fn options_metadata(names: &[String]) -> (String, String) {
    (OPTIONS.to_owned(), names.join(","))
}

/// The spec of a network from `said` and its metadata.
fn spec_of(network: &Network, said: PartialSpec) -> Result<PolicySpec, String> {
    let entry = |key: &str| network.metadata().get(key);
    let wrong = |key: &str, found: &str, expected: String| {
        format!("its metadata has {key} = {found:?}, expected {expected}")
    };
    let observation = entry(OBSERVATION).map(|text| {
        serde_json::from_str::<ObservationSpace>(text).map_err(|error| {
            let example = r#"{"kind":"squall","mates":1,"enemies":2,"frames":1}"#;
            let expected = format!("an observation space such as {example} ({error})");
            wrong(OBSERVATION, text, expected)
        })
    });
    let observation = observation.transpose()?;
    let observation = agreed(OBSERVATION, "observation", observation, said.observation)?;
    let own_version = observation.version();
    if let Some(version) = entry(OBSERVATION_VERSION)
        && *version != own_version.to_string()
    {
        let expected = format!("{own_version}, which is this program's");
        return Err(wrong(OBSERVATION_VERSION, version, expected));
    }
    let action = entry(ACTION).map(|text| {
        serde_json::from_str::<ActionSpace>(text)
            .or_else(|_| serde_json::from_value(text.as_str().into()))
            .map_err(|error| wrong(ACTION, text, format!("an action space ({error})")))
    });
    let action = agreed(ACTION, "action", action.transpose()?, said.action)?;
    let period_s = entry(PERIOD_S).map(|text| {
        let number = text.parse::<f64>().ok();
        let number = number.filter(|number| PERIODS_S.contains(number));
        let allowed = || format!("{} to {} s", PERIODS_S.start(), PERIODS_S.end());
        number.ok_or_else(|| wrong(PERIOD_S, text, allowed()))
    });
    // The only field that may differ from the metadata.
    let period_s = match (said.period_s, period_s.transpose()?) {
        (Some(period_s), _) | (None, Some(period_s)) => period_s,
        (None, None) => return Err(unsaid(PERIOD_S, "period_s")),
    };
    Ok(PolicySpec {
        observation,
        action,
        period_s,
    })
}

/// The value from the metadata or from `said`, if at least one provides it and they do not differ.
fn agreed<T: PartialEq + Serialize>(
    key: &str,
    said_by: &str,
    found: Option<T>,
    said: Option<T>,
) -> Result<T, String> {
    match (found, said) {
        (Some(found), Some(said)) if found != said => {
            let found = json(&found);
            let said = json(&said);
            Err(format!(
                "its metadata has {key} = {found}, expected {said}, as stated here"
            ))
        }
        (_, Some(one)) | (Some(one), None) => Ok(one),
        (None, None) => Err(unsaid(key, said_by)),
    }
}

/// The message if neither the metadata nor the user specifies a field.
fn unsaid(key: &str, said_by: &str) -> String {
    format!("its metadata has no {key}, expected it there or {said_by} here")
}

fn check_input(network: &Network, observation: ObservationSpace) -> Result<(), String> {
    let inputs = listed(network.inputs());
    let wrong = |expected: &str| Err(format!("its inputs are {inputs}, expected {expected}"));
    let [input] = network.inputs() else {
        return wrong("one input");
    };
    match observation.edition() {
        // The size for a 1-against-1 game, and the additional size for each other boat.
        Some(_) => {
            let least = observation.size(0, 1);
            let other = observation.size(1, 1) - observation.size(0, 1);
            if input.size < least || !(input.size - least).is_multiple_of(other) {
                let expected = format!("{least} numbers, or {other} more for each other boat");
                return wrong(&expected);
            }
        }
        None => {
            let size = observation.size(0, 0);
            if input.size != size {
                return wrong(&format!("{size} numbers for {}", json(&observation)));
            }
        }
    }
    Ok(())
}

/// The index of the output with the action: the only output of the right size, or else the only
/// scalar, which is an action's index. Of several scalars, for example an action and a value, it is
/// the only integer. For options, it is the only output with more than one number.
fn output_of(network: &Network, action: ActionSpace) -> Result<usize, String> {
    let of = |is_it: &dyn Fn(&Port) -> bool| -> Vec<usize> {
        let outputs = network.outputs().iter().enumerate();
        let fitting = outputs.filter(|(_, port)| is_it(port));
        fitting.map(|(i, _)| i).collect()
    };
    let outputs = listed(network.outputs());
    let wrong = |expected: &str| Err(format!("its outputs are {outputs}, expected {expected}"));
    if action == ActionSpace::Options {
        let [output] = of(&|port| port.size > 1)[..] else {
            return wrong("one output with a number for each of two or more options");
        };
        return Ok(output);
    }
    let numbers = action.outputs();
    let whole = of(&|port| port.size == numbers);
    let has_index = action.count().is_some();
    let mut index = of(&|port| port.size == 1 && has_index && whole.is_empty());
    if index.len() > 1 {
        index.retain(|i| network.outputs()[*i].is_integer);
    }
    match (whole.as_slice(), index.as_slice()) {
        ([output], _) | ([], [output]) => Ok(*output),
        _ => {
            let action = json(&action);
            let or_index = if has_index {
                ", or else one with the index of the action"
            } else {
                ""
            };
            wrong(&format!(
                "one output of {numbers} numbers for the action space {action}{or_index}"
            ))
        }
    }
}

/// Inputs or outputs, listed for a message.
fn listed(ports: &[Port]) -> String {
    let shown = ports.iter().take(8);
    let shown = shown.map(|port| format!("{:?} of {} numbers", port.name, port.size));
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
        f.debug_struct("PolicyModel")
            .field("name", &self.name)
            .field("spec", &self.spec)
            .finish_non_exhaustive()
    }
}

/// The serialised form for agents and recordings.
#[derive(Serialize, Deserialize)]
struct Sent {
    name: String,
    spec: PolicySpec,
    /// The file in Base64.
    onnx: String,
}

impl From<PolicyModel> for Sent {
    fn from(model: PolicyModel) -> Sent {
        Sent {
            onnx: BASE64.encode(&model.bytes),
            name: model.name,
            spec: model.spec,
        }
    }
}

impl TryFrom<Sent> for PolicyModel {
    type Error = String;

    fn try_from(Sent { name, spec, onnx }: Sent) -> Result<PolicyModel, String> {
        let bytes = BASE64.decode(onnx).map_err(|error| error.to_string())?;
        let (length, period_s) = (bytes.len(), spec.period_s);
        if length as u64 > BYTES_MAX {
            return Err(format!(
                "a model of {length} bytes, expected at most {BYTES_MAX}"
            ));
        }
        if !PERIODS_S.contains(&period_s) {
            let (least_s, most_s) = (PERIODS_S.start(), PERIODS_S.end());
            return Err(format!(
                "a period of {period_s} s, expected {least_s} to {most_s} s"
            ));
        }
        let said = PartialSpec {
            observation: Some(spec.observation),
            action: Some(spec.action),
            period_s: Some(period_s),
        };
        PolicyModel::read(&name, &bytes, said)
    }
}
