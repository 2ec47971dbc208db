//! Checks the algorithm of a training run: exactly one, with a suitable action space.

use super::{Algorithm, CriticInput, Training};
use scenario::Document;

/// The tables of algorithms.
const TABLES: [&str; 3] = ["ppo", "td3", "dqn"];

pub(super) fn check(document: &Document<Training>) {
    let training = &document.raw;
    let mut said = TABLES.into_iter().filter(|table| document.has(table));
    if let (Some(one), Some(other)) = (said.next(), said.next()) {
        let message = format!(
            "{other} is a second algorithm besides {one}, expected only one of {}",
            TABLES.join(", ")
        );
        document.note(other, message);
        return;
    }
    let algorithm = training.algorithm();
    let name = algorithm.name();
    let action = training.action;
    if document.is_sound("action") && algorithm.is_discrete() != action.is_discrete() {
        let expected = if algorithm.is_discrete() {
            "\"pyquaticus\" or \"options\""
        } else {
            "\"continuous\""
        };
        let place = if document.has("action") {
            "action"
        } else {
            name
        };
        let found = serde_json::to_string(&action).unwrap_or_default();
        document.note(
            place,
            format!("action is {found}, expected {expected} with {name}"),
        );
    }
    if !matches!(algorithm, Algorithm::Ppo(_)) {
        check_ppo_alone(document, name);
    }
    let sizes = training.td3.map(|td3| (td3.warm_up, td3.buffer));
    if let Some((warm_up, buffer)) = sizes.or(training.dqn.map(|dqn| (dqn.warm_up, dqn.buffer)))
        && warm_up > buffer
        && document.is_sound(name)
    {
        let message = format!("warm_up is {warm_up}, expected at most buffer, which is {buffer}");
        document.note(&format!("{name}.warm_up"), message);
    }
}

fn check_ppo_alone(document: &Document<Training>, name: &str) {
    let critic = "network.critic";
    if document.is_sound(critic) && document.raw.network.critic != CriticInput::Observation {
        let message = format!("critic is \"truth\", expected \"observation\" with {name}");
        document.note(critic, message);
    }
    for i in 0..document.raw.stage.len() {
        let teacher = format!("stage.{i}.teacher");
        if document.has(&teacher) {
            let message =
                format!("teacher is set, expected none with {name}: only ppo imitates a teacher");
            document.note(&teacher, message);
        }
    }
}
