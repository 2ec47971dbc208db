//! Behaviours, checked: what all of them have in common.

use super::expression::{Wanted, expression};
use super::task::{Keys, task};
use super::variable::set;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::explain::nearest;
use crate::scenario::raw::{At, RawBehaviour, RawCommon, RawStrategy, RawTask};
use crate::strategy::{Behaviour, Mode, Moment, Post, Variable};

/// The most behaviours of a program.
const MOST: usize = 1000;

/// Checks the behaviours. Where modes make no tree, nobody asks which of them are meant.
pub(super) fn behaviours(
    diagnostics: &mut Diagnostics,
    variables: &[Variable],
    modes: Option<&[(usize, Mode)]>,
    raw: &RawStrategy,
    start: usize,
) -> Vec<Behaviour> {
    let given = raw.behaviour.0.as_slice();
    if given.is_empty() {
        diagnostics.note_missing(start, "roles", "it, or at least one [behaviour.NAME]");
    }
    if given.len() > MOST {
        diagnostics.note(given[MOST].at, format!("behaviour has {} entries, expected at most {MOST}", given.len()));
    }
    given.iter().take(MOST).filter_map(|given| one(diagnostics, variables, modes, given)).collect()
}

fn one(
    diagnostics: &mut Diagnostics,
    variables: &[Variable],
    modes: Option<&[(usize, Mode)]>,
    given: &At<RawBehaviour>,
) -> Option<Behaviour> {
    let RawBehaviour { name, common, task: raw_task } = &given.value;
    let modes = modes.map(|modes| in_modes(diagnostics, modes, common)).unwrap_or_default();
    let when = common.when.as_ref().and_then(|when| expression(diagnostics, variables, "when", when, Wanted::Truth));
    let posts = posts(diagnostics, variables, common);
    let mut keys = Keys { diagnostics, variables, owner: given.at, name };
    let default = match raw_task {
        Some(RawTask::OpRegion(_) | RawTask::AvoidCollision(_) | RawTask::AvoidObstacle(_)) => 300.0,
        _ => 100.0,
    };
    let weight = keys.number("weight", common.weight.as_ref(), (0.0, 1000.0), default);
    let duration = (0.0, 86400.0);
    let duration_s = match (&common.duration_s, raw_task) {
        (None, Some(RawTask::Timer(_))) => Some(keys.required("duration_s", None, duration)),
        (None, _) => None,
        (Some(given), _) => Some(keys.number("duration_s", Some(given), duration, 0.0)),
    };
    let task = task(&mut keys, raw_task.as_ref()?)?;
    let perpetual = common.perpetual.as_ref().is_some_and(|perpetual| perpetual.value);
    Some(Behaviour { name: name.clone(), modes, when, weight, duration_s, perpetual, posts, task })
}

/// The modes in which a behaviour may run, by mode.
fn in_modes(diagnostics: &mut Diagnostics, modes: &[(usize, Mode)], common: &RawCommon) -> Vec<bool> {
    let Some(given) = &common.r#in else { return vec![true; modes.len()] };
    if given.value.is_empty() {
        diagnostics.note(given.at, "in has 0 entries, expected at least one mode");
    }
    let mut allowed = vec![false; modes.len()];
    for name in &given.value {
        match modes.iter().position(|(_, mode)| mode.name == name.value) {
            Some(mode) => allowed[mode] = true,
            None => {
                let names: Vec<&str> = modes.iter().map(|(_, mode)| mode.name.as_str()).collect();
                let guess = nearest(&name.value, &names).map(|guess| format!(" (did you mean {guess}?)"));
                let (names, guess) = (names.join(", "), guess.unwrap_or_default());
                diagnostics.note(name.at, format!("in has {:?}, expected one of the modes {names}{guess}", name.value));
            }
        }
    }
    // Parents stand before their parts.
    for (i, (_, mode)) in modes.iter().enumerate() {
        allowed[i] |= mode.parent.is_some_and(|parent| allowed[parent]);
    }
    allowed
}

fn posts(diagnostics: &mut Diagnostics, variables: &[Variable], common: &RawCommon) -> Vec<Post> {
    let moments = [
        (Moment::Run, &common.on_run),
        (Moment::Idle, &common.on_idle),
        (Moment::Active, &common.on_active),
        (Moment::Inactive, &common.on_inactive),
        (Moment::Reach, &common.on_reach),
        (Moment::Complete, &common.on_complete),
    ];
    let mut posts = vec![];
    for (at, given) in moments {
        let set = set(diagnostics, variables, given.as_ref());
        posts.extend(set.into_iter().map(|(variable, value)| Post { at, variable, value }));
    }
    posts
}
