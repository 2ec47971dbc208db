//! Replays a recording through the codec and the supervisor.

use crate::bridge::{Bridge, Event, Input, Output, Plan};
use crate::config::default_gateway;
use crate::record::{EVENT, INPUT, RecordedEvent, RecordedInput, link_topic};
use messages::external::{GatewayStatus, LinkBytes};
use primitives::SimTime;
use recording::{Bag, Kind, RecordedMessage, RecordingError};
use serde_json::Value;

/// The result of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// The gateway's plan.
    pub plan: Plan,
    /// The number of inputs.
    pub inputs: u64,
    /// Bytes from the boat.
    pub bytes_in: u64,
    /// Bytes to the boat.
    pub bytes_out: u64,
    /// Time between the first and last input.
    pub lasted: SimTime,
    /// The events of the replay.
    pub events: Vec<(SimTime, Event)>,
    /// The final state.
    pub status: GatewayStatus,
    /// The first difference from the recording.
    pub difference: Option<Difference>,
    /// Whether the file is truncated.
    pub is_cut: bool,
}

/// A difference between a recording and its replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The time of the difference, by the gateway's clock.
    pub at: SimTime,
    /// The recorded output.
    pub recorded: String,
    /// The replayed output.
    pub replayed: String,
}

/// A step of the core, as recorded.
struct RecordedStep {
    at: SimTime,
    input: Input,
    out: Vec<u8>,
    events: Vec<Event>,
}

/// The plan of a recording. Settings added since the recording take their default values.
fn plan_of(text: &str) -> Result<Plan, serde_json::Error> {
    let mut plan: Value = serde_json::from_str(text)?;
    if let Some(gateway) = plan.get_mut("gateway") {
        complete(gateway, &serde_json::to_value(default_gateway())?);
    }
    serde_json::from_value(plan)
}

/// Adds missing entries of tables.
fn complete(table: &mut Value, defaults: &Value) {
    let (Value::Object(table), Value::Object(defaults)) = (table, defaults) else {
        return;
    };
    for (key, default) in defaults {
        match table.get_mut(key) {
            Some(value) => complete(value, default),
            None => drop(table.insert(key.clone(), default.clone())),
        }
    }
}

/// Replays a recording.
///
/// # Errors
/// [`RecordingError`] for anything except a valid recording of a gateway, complete or truncated.
pub fn replay(bag: &Bag) -> Result<Replay, RecordingError> {
    if bag.kind != Kind::Gateway {
        return Err(RecordingError::Kind {
            wanted: Kind::Gateway,
            found: bag.kind,
        });
    }
    let plan = plan_of(bag.fact("plan"))
        .map_err(|e| RecordingError::Foreign(format!("cannot parse its plan: {e}")))?;
    let steps = steps(bag, &link_topic(&plan.vehicle))?;
    let is_cut = bag.is_cut;
    let mut bridge = Bridge::new(plan.clone());
    let mut bytes_in = 0;
    let mut bytes_out = 0;
    let mut events = Vec::new();
    let mut difference = None;
    for (i, step) in steps.iter().enumerate() {
        let mut out = Output::default();
        bridge.process(step.at, &step.input, &mut out);
        if let Input::Bytes(bytes) = &step.input {
            bytes_in += bytes.len() as u64;
        }
        bytes_out += out.bytes.len() as u64;
        // A truncated file may lack some outputs of the last step.
        let is_whole = !is_cut || i + 1 < steps.len();
        if difference.is_none() && is_whole {
            difference = differing(step, &out);
        }
        events.extend(out.events.into_iter().map(|event| (step.at, event)));
    }
    let ends = steps
        .first()
        .zip(steps.last())
        .map_or((SimTime::ZERO, SimTime::ZERO), |(a, b)| (a.at, b.at));
    Ok(Replay {
        plan,
        inputs: steps.len() as u64,
        bytes_in,
        bytes_out,
        lasted: ends.1 - ends.0,
        events,
        status: bridge.status(ends.1),
        difference,
        is_cut,
    })
}

fn differing(step: &RecordedStep, out: &Output) -> Option<Difference> {
    let text = |bytes: &[u8]| {
        String::from_utf8_lossy(bytes)
            .replace("\r\n", " ")
            .trim_end()
            .to_owned()
    };
    // Compare bytes to the boat first, then events: a difference in events often follows from one
    // in the bytes.
    let said = |events: &[Event]| format!("{events:?}");
    let pairs = [
        (text(&step.out), text(&out.bytes)),
        (said(&step.events), said(&out.events)),
    ];
    let (recorded, replayed) = pairs
        .into_iter()
        .find(|(recorded, replayed)| recorded != replayed)?;
    Some(Difference {
        at: step.at,
        recorded,
        replayed,
    })
}

/// The steps of the core.
fn steps(bag: &Bag, link_topic: &str) -> Result<Vec<RecordedStep>, RecordingError> {
    let mut steps = Vec::new();
    bag.messages()
        .try_for_each(|message| add_step(&mut steps, link_topic, &message))?;
    Ok(steps)
}

/// Adds one message to its step.
fn add_step(
    steps: &mut Vec<RecordedStep>,
    link_topic: &str,
    message: &RecordedMessage<'_>,
) -> Result<(), RecordingError> {
    let begun = |input: Input| RecordedStep {
        at: message.at,
        input,
        out: vec![],
        events: vec![],
    };
    match message.topic {
        INPUT => steps.push(begun(message.read_json::<RecordedInput>()?.input)),
        EVENT => match (
            message.read_json::<RecordedEvent>()?.event,
            steps.last_mut(),
        ) {
            // Compare only outputs of the core.
            (Event::Remark(_), _) | (_, None) => {}
            (event, Some(step)) => step.events.push(event),
        },
        topic if topic == link_topic => {
            let LinkBytes { outward, data, .. } = message.read()?;
            match (outward, steps.last_mut()) {
                (false, _) => steps.push(begun(Input::Bytes(data))),
                (true, Some(step)) => step.out.extend(data),
                (true, None) => {}
            }
        }
        _ => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_from_before_some_settings_is_read_with_their_defaults_and_keeps_its_own() {
        let mut gateway = default_gateway();
        gateway.order_ttl_s = 2.5;
        gateway.control.echo_s = 4.0;
        let plan = Plan {
            arms_itself: true,
            ..Plan::new("blue_one", gateway)
        };
        let mut told = serde_json::to_value(&plan).unwrap();
        assert_eq!(plan_of(&told.to_string()).unwrap(), plan);
        let gateway = told["gateway"].as_object_mut().unwrap();
        assert!(gateway.remove("currents").is_some() && gateway.remove("startup_words").is_some());
        assert!(
            gateway["control"]
                .as_object_mut()
                .unwrap()
                .remove("echo_thrust_pct")
                .is_some()
        );
        assert_eq!(plan_of(&told.to_string()).unwrap(), plan);
        told.as_object_mut().unwrap().remove("vehicle");
        assert!(plan_of(&told.to_string()).is_err_and(|e| e.to_string().contains("vehicle")));
    }
}
