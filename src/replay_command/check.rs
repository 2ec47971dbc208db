//! Reruns a recorded game from its inputs and compares it with the recording.

use crate::recording_file;
use anyhow::{Result, bail};
use messages::Frame;
use messages::input::Inputs;
use primitives::codec;
use recording::{FRAME, INPUTS, Recording};
use rules::event::EventCursor;
use scenario::Scenario;
use serde_json::Value;
use sim::Contest;

/// The result of the comparison.
#[derive(Debug)]
pub(super) struct Verdict {
    pub(super) is_same: bool,
    /// The result, on one line.
    pub(super) text: String,
}

/// Reruns the game; calls `tell` after every frame.
pub(super) fn check(recording: &Recording, mut tell: impl FnMut()) -> Result<Verdict> {
    recording_file::check_inputs(recording)?;
    let scenario = recording.scenario();
    let mut contest = Contest::new(scenario, scenario.seed)?;
    let mut shown = EventCursor::default();
    let mut inputs = Vec::new();
    let mut frames = 0;
    let mut end_s = 0.0;
    let ticks = u64::from(scenario.ticks_per_decision);
    for message in recording
        .bag()
        .messages()
        .filter(|message| [FRAME, INPUTS].contains(&message.topic))
    {
        if message.topic == INPUTS {
            inputs.push(message.read::<Inputs>()?);
            continue;
        }
        // If the disk was too slow, a decision and all its inputs are missing.
        let seq = frames;
        let [given] = inputs.as_slice() else {
            bail!("{} inputs before frame {seq}, expected one", inputs.len())
        };
        if given.stamp.seq != seq {
            bail!(
                "decisions {seq} to {} are missing from this recording",
                given.stamp.seq.saturating_sub(1)
            );
        }
        let Some(understood) = given.of(scenario).collect::<Option<Vec<_>>>() else {
            bail!(
                "cannot decode an input at {:.1} s",
                given.stamp.valid_ns.as_s()
            );
        };
        understood.into_iter().for_each(|input| contest.give(input));
        let again = contest.frame(&mut shown);
        inputs.clear();
        if codec::encode(&again) != message.bytes {
            let recorded: Frame = message.read()?;
            let [what, then, now] = first_difference(&recorded, &again, scenario)?;
            let tick = recorded.stamp.seq * ticks;
            let at_s = recorded.stamp.valid_ns.as_s();
            let from = format!("DIFFERENT from tick {tick} on ({at_s:.1} s)");
            let text = format!("{from}: {what} was {then}, but is {now} in the rerun\n");
            return Ok(Verdict {
                is_same: false,
                text,
            });
        }
        frames += 1;
        tell();
        end_s = message.at.as_s();
    }
    if frames == 0 {
        bail!("it contains no frames");
    }
    let outcome = contest.outcome();
    let same = format!("identical: {frames} frames to {end_s:.1} s");
    let Some(ending) = recording.ending() else {
        let cut = if recording.is_cut() {
            "; the file ends abruptly there"
        } else {
            ""
        };
        return Ok(Verdict {
            is_same: true,
            text: format!("{same}{cut}\n"),
        });
    };
    if ending.outcome.ticks != outcome.ticks {
        bail!(
            "the game ended at tick {}, but the recording at {}",
            ending.outcome.ticks,
            outcome.ticks
        );
    }
    let recorded = &ending.outcome.digest;
    let again = &outcome.digest;
    let is_same = recorded == again;
    let text = if is_same {
        format!("{same}, digest {again}\n")
    } else {
        format!(
            "DIFFERENT at the end: {frames} frames agree, but the digest was {recorded} and is {again} in the rerun\n"
        )
    };
    Ok(Verdict { is_same, text })
}

/// The first difference between two frames: its name and both values.
fn first_difference(recorded: &Frame, again: &Frame, scenario: &Scenario) -> Result<[String; 3]> {
    let a = serde_json::to_value(recorded)?;
    let b = serde_json::to_value(again)?;
    let [path, a, b] = differing("", &a, &b)
        .unwrap_or_else(|| ["a number's last bit".into(), "?".into(), "?".into()]);
    // Replace a boat's index with its name.
    let name = path.strip_prefix(".vehicles.").and_then(|rest| {
        let (index, rest) = rest.split_once('.').unwrap_or((rest, ""));
        let vehicle = scenario.vehicles.get(index.parse::<usize>().ok()?)?;
        Some(format!("{} {rest}", vehicle.name))
    });
    Ok([
        name.unwrap_or_else(|| path.trim_start_matches('.').to_owned()),
        a,
        b,
    ])
}

fn differing(path: &str, a: &Value, b: &Value) -> Option<[String; 3]> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => a
            .iter()
            .find_map(|(key, value)| differing(&format!("{path}.{key}"), value, b.get(key)?)),
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => a
            .iter()
            .zip(b)
            .enumerate()
            .find_map(|(i, (a, b))| differing(&format!("{path}.{i}"), a, b)),
        (a, b) if a == b => None,
        (a, b) => Some([path.to_owned(), a.to_string(), b.to_string()]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::input::Input;
    use messages::{GameInfo, Order};
    use primitives::{SimTime, VehicleId};
    use recording::{Decision, Ending, Entry, Header, Writer};
    use rules::event::EventCursor;
    use std::io::Cursor;

    /// The first second of a game whose pictures are not recorded; `change` may omit decisions.
    fn recorded(change: impl Fn(Decision) -> Option<Decision>) -> Recording {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("scenarios/games/attack_1v1.toml");
        let scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let header = Header {
            commit: String::new(),
            game: "made_up".to_owned(),
            began_utc_ns: 0,
            info: GameInfo {
                version: primitives::VERSION.to_owned(),
                pace: String::new(),
                scenario: scenario.clone(),
            },
            water: messages::water::Water::default(),
        };
        let mut writer = Writer::begin(Cursor::new(Vec::new()), &header.opening()).expect("memory");
        let mut written = EventCursor::default();
        let watch = |contest: &mut sim::Contest| {
            contest.keep_inputs();
            let frame = contest.frame(&mut written).into();
            let decision = Decision {
                frame,
                pictures: vec![],
                inputs: contest.take_inputs(),
            };
            if let Some(decision) = change(decision) {
                writer
                    .write(&Entry::Decision(Box::new(decision)), 0)
                    .expect("memory");
            }
            contest.decision() < 10
        };
        let outcome =
            arena::play_watched(&scenario, agent::minds_of(&scenario), scenario.seed, watch)
                .expect("it starts");
        let ending = Ending {
            outcome,
            ..Ending::default()
        };
        let file = writer.end(ending.facts()).expect("memory").into_inner();
        Recording::of(file).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The game with one additional input at the end of its fifth decision.
    fn with(input: Input) -> Recording {
        recorded(|mut decision| {
            if decision.frame.stamp.seq == 5 {
                decision.inputs.insert(decision.inputs.len() - 1, input);
            }
            Some(decision)
        })
    }

    fn refused(recording: &Recording) -> String {
        check(recording, || {})
            .expect_err("it cannot be played again")
            .to_string()
    }

    #[test]
    fn what_was_played_is_played_again() {
        let verdict = check(&recorded(Some), || {}).unwrap_or_else(|e| panic!("{e}"));
        assert!(verdict.is_same, "{}", verdict.text);
        assert!(
            verdict
                .text
                .starts_with("identical: 11 frames to 1.0 s, digest ")
        );
    }

    #[test]
    fn another_order_is_found_at_the_tick_after_it() {
        let order = Order::Thrust {
            port: 1.0,
            starboard: -1.0,
        };
        let input = Input::Ordered {
            vehicle: VehicleId(0),
            order,
            given_at: SimTime::from_s(0.4),
        };
        let verdict = check(&with(input), || {}).unwrap_or_else(|e| panic!("{e}"));
        assert!(!verdict.is_same);
        let name = recorded(Some).scenario().vehicles[0].name.clone();
        assert!(
            verdict
                .text
                .starts_with(&format!("DIFFERENT from tick 10 on (0.5 s): {name} ")),
            "{}",
            verdict.text
        );
    }

    #[test]
    fn what_cannot_be_played_again_is_refused_with_the_reason() {
        let nobody = Input::Held(VehicleId(200));
        assert_eq!(refused(&with(nobody)), "cannot decode an input at 0.5 s");
        let gap = recorded(|decision| {
            Some(decision).filter(|decision| ![5, 6].contains(&decision.frame.stamp.seq))
        });
        assert_eq!(
            refused(&gap),
            "decisions 5 to 6 are missing from this recording"
        );
        let end =
            recorded(|decision| Some(decision).filter(|decision| decision.frame.stamp.seq != 10));
        assert_eq!(
            refused(&end),
            "the game ended at tick 20, but the recording at 18"
        );
        assert_eq!(refused(&recorded(|_| None)), "it contains no frames");
    }
}
