//! A recorded game played again from what it was given, beside what was recorded.

use anyhow::{Result, bail};
use game::codec;
use game::input::{Input, Inputs};
use game::message::Frame;
use serde_json::Value;
use shore::recording::{FRAME, INPUTS, Recording};
use sim::rerun::Rerun;

/// What came of it.
#[derive(Debug)]
pub(super) struct Verdict {
    frames: usize,
    end_s: f64,
    is_cut: bool,
    difference: Option<Difference>,
    /// Digests in the end: recorded and played again. None where the file ends abruptly.
    digests: Option<[String; 2]>,
}

/// Where the game first goes another way.
#[derive(Debug)]
struct Difference {
    tick: u64,
    at_s: f64,
    /// What differs, and both values.
    what: String,
    recorded: String,
    again: String,
}

impl Verdict {
    pub(super) fn is_same(&self) -> bool {
        self.difference.is_none() && self.digests.as_ref().is_none_or(|[recorded, again]| recorded == again)
    }

    pub(super) fn text(&self) -> String {
        let Verdict { frames, end_s, is_cut, .. } = self;
        let cut = if *is_cut { "; the file ends abruptly there" } else { "" };
        if let Some(Difference { tick, at_s, what, recorded, again }) = &self.difference {
            return format!(
                "DIFFERENT from tick {tick} on ({at_s:.1} s): {what} was {recorded}, played again it is {again}\n"
            );
        }
        match &self.digests {
            Some([recorded, again]) if recorded != again => {
                format!(
                    "DIFFERENT in the end: {frames} frames agree, but the digest was {recorded}, now it is {again}\n"
                )
            }
            Some([digest, _]) => {
                format!("the same: {frames} frames to {end_s:.1} s to the last bit, digest {digest}\n")
            }
            None => format!("the same: {frames} frames to {end_s:.1} s to the last bit{cut}\n"),
        }
    }
}

/// Plays the game again.
pub(super) fn check(recording: &Recording) -> Result<Verdict> {
    let scenario = &recording.header().notice.scenario;
    let mut rerun = Rerun::new(scenario)?;
    let (mut inputs, mut next_input) = (Vec::new(), 0_u32);
    let mut verdict = Verdict { frames: 0, end_s: 0.0, is_cut: recording.is_cut(), difference: None, digests: None };
    let ticks = u64::from(scenario.ticks_per_decision);
    for said in recording.messages().filter(|said| [FRAME, INPUTS].contains(&said.topic)) {
        if said.topic == INPUTS {
            if said.number != next_input {
                bail!("{} inputs are missing before {:.1} s", said.number.wrapping_sub(next_input), said.at.as_s());
            }
            next_input = said.number.wrapping_add(1);
            inputs.extend(read(&said.read::<Inputs>()?)?);
            continue;
        }
        let again = rerun.frame_after(inputs.drain(..));
        if codec::encode(&again) != said.bytes {
            let recorded: Frame = said.read()?;
            let [what, then, now] = first_difference(&recorded, &again, scenario)?;
            let (tick, at_s) = (recorded.stamp.seq * ticks, recorded.stamp.valid_ns.as_s());
            verdict.difference = Some(Difference { tick, at_s, what, recorded: then, again: now });
            return Ok(verdict);
        }
        verdict.frames += 1;
        verdict.end_s = said.at.as_s();
    }
    verdict.digests = recording.ending().map(|ending| [ending.outcome.digest.clone(), rerun.outcome().digest]);
    if let Some(dropped) = recording.ending().map(|ending| ending.dropped).filter(|dropped| *dropped > 0) {
        bail!("{dropped} messages are missing in this recording: it cannot be played again");
    }
    Ok(verdict)
}

fn read(inputs: &Inputs) -> Result<Vec<Input>> {
    let known = inputs.inputs.iter().map(|record| record.input());
    match known.collect::<Option<Vec<Input>>>() {
        Some(inputs) => Ok(inputs),
        None => bail!("an input at {:.1} s is not understood", inputs.stamp.valid_ns.as_s()),
    }
}

/// What differs first between two frames: its name, and both values.
fn first_difference(recorded: &Frame, again: &Frame, scenario: &game::Scenario) -> Result<[String; 3]> {
    let (a, b) = (serde_json::to_value(recorded)?, serde_json::to_value(again)?);
    let [path, a, b] = differing("", &a, &b).unwrap_or_else(|| ["a number's last bit".into(), "?".into(), "?".into()]);
    // A boat by its name.
    let name = path.strip_prefix(".vehicles.").and_then(|rest| {
        let (index, rest) = rest.split_once('.').unwrap_or((rest, ""));
        let vehicle = scenario.vehicles.get(index.parse::<usize>().ok()?)?;
        Some(format!("{} {rest}", vehicle.name))
    });
    Ok([name.unwrap_or_else(|| path.trim_start_matches('.').to_owned()), a, b])
}

fn differing(path: &str, a: &Value, b: &Value) -> Option<[String; 3]> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            a.iter().find_map(|(key, value)| differing(&format!("{path}.{key}"), value, b.get(key)?))
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            a.iter().zip(b).enumerate().find_map(|(i, (a, b))| differing(&format!("{path}.{i}"), a, b))
        }
        (a, b) if a == b => None,
        (a, b) => Some([path.to_owned(), a.to_string(), b.to_string()]),
    }
}
