//! `squall policy --submission`: a policy as an entry for the Maritime Capture the Flag
//! competition.

use anyhow::{Result, bail};
use command_line::output_file;
use scenario::action::ActionSpace;
use scenario::policy::PolicyModel;
use std::path::Path;

const SOLUTION: &str = include_str!("solution.py");
const CONFIG: &str = include_str!("gen_config.py");
/// Boats per team in the competition.
const TEAM: usize = 3;
/// Time between decisions in the competition, s.
const PERIOD_S: f64 = 1.0;

/// Writes the entry into `folder`. Returns a message for the user.
///
/// # Errors
/// If the competition does not provide the model's observations or accept its actions, or if a file
/// cannot be written.
pub(crate) fn write(model: &PolicyModel, is_sampled: bool, folder: &Path) -> Result<String> {
    let spec = model.spec;
    if spec.observation.edition().is_none() {
        bail!(
            "its observations are those of Squall, which the competition does not provide: expected a model \
             trained with observation = {{ kind = \"pyquaticus_2026\" }}, \"pyquaticus\" or \"pyquaticus_2023\""
        );
    }
    if spec.action == ActionSpace::Options {
        bail!(
            "it chooses options for Squall's helm, which the competition does not have: expected a model with \
             the actions \"pyquaticus\" or \"continuous\""
        );
    }
    let expected = spec.observation.size(TEAM - 1, TEAM);
    if model.input_size() != expected {
        bail!(
            "it has {} inputs, expected {expected}: the competition is {TEAM} against {TEAM}",
            model.input_size()
        );
    }
    if is_sampled && !model.has_logits() {
        bail!("it has no probabilities to sample, expected a model with a logit for each action");
    }
    let observation = serde_json::to_value(spec.observation)?;
    let python = |is: bool| if is { "True" } else { "False" };
    let network = model.network();
    let solution = SOLUTION
        .replace("@OBSERVATION@", observation["kind"].as_str().unwrap_or(""))
        .replace("@OUTPUT@", &network.outputs()[model.output()].name)
        .replace("@CONTINUOUS@", python(model.actions().is_none()))
        .replace("@SAMPLED@", python(is_sampled));
    let solution = match spec.action {
        ActionSpace::Table(table) => {
            let table = serde_json::to_string(&table)?;
            solution.replace("ACTIONS = None", &format!("ACTIONS = {table}"))
        }
        _ => solution,
    };
    output_file::make_folder(folder)?;
    for (name, bytes) in [
        ("solution.py", solution.as_bytes()),
        ("gen_config.py", CONFIG.as_bytes()),
        ("policy.onnx", model.bytes()),
    ] {
        output_file::write(&folder.join(name), "the entry", bytes)?;
    }
    let mut text = format!(
        "entry: {0}, to be packed with: cd {0} && zip -r ../entry.zip .\n",
        folder.display()
    );
    if (spec.period_s - PERIOD_S).abs() > 1e-9 {
        text += &format!(
            "note: it was trained to decide every {} s, but in the competition it decides every {PERIOD_S} s\n",
            spec.period_s
        );
    }
    Ok(text)
}
