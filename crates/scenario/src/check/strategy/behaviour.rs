//! Checks behaviours: resolves names and expressions. The schema has already checked the other
//! values.

use super::scope::Scope;
use super::variable::set;
use crate::Kind;
use crate::action::ActionSpace;
use crate::guess::listed;
use crate::observation::ObservationSpace;
use crate::policy::{self, PartialSpec, PolicyModel};
use crate::raw;
use crate::schema::declared;
use crate::strategy::{
    Behaviour, Boat, Host, Kind as VariableKind, Mode, Moment, Named, Parameter, Place, Post, Task,
    Variable,
};
use primitives::frame::Ned;
use serde::Deserialize;
use serde_json::{Map, Value as Json, json};

/// Maximum number of behaviours of a program.
const MOST: usize = 1000;

/// Pairs of keys; the first value must not exceed the second.
const IN_ORDER: [(&str, &str); 3] = [
    ("inner_m", "outer_m"),
    ("cpa_min_m", "cpa_max_m"),
    ("inner_radius_m", "outer_radius_m"),
];

/// Checks the behaviours. If the modes do not form a tree, references to modes are not checked.
pub(super) fn behaviours(scope: &Scope<'_>, modes: Option<&[Mode]>) -> Vec<Behaviour> {
    let given = &scope.document.raw.behaviour;
    if given.is_empty() && scope.document.is_sound("behaviour") {
        scope.note_missing("roles", "roles or at least one [behaviour.NAME]");
    }
    if given.len() > MOST {
        let message = format!("has {} entries, expected at most {MOST}", given.len());
        scope.note("behaviour", &message);
    }
    let given = given.iter().take(MOST);
    let checked = given.filter_map(|(name, given)| one(scope, modes, name, &given.0));
    checked.collect()
}

fn one(scope: &Scope<'_>, modes: Option<&[Mode]>, name: &str, given: &Json) -> Option<Behaviour> {
    let path = format!("behaviour.{name}");
    scope.document.is_name(&path, "behaviour", name);
    let named = given["in"].as_array().map(Vec::as_slice);
    let modes = modes.map(|modes| in_modes(scope, &path, modes, named));
    let modes = modes.unwrap_or_default();
    let when = scope.condition(&format!("{path}.when"), given["when"].as_str());
    let posts = posts(scope, &path, given);
    let mut kinds = declared(Kind::STRATEGY)["definitions"].as_object()?.iter();
    let (variant, about) =
        kinds.find(|(_, about)| about["properties"]["kind"]["const"] == given["kind"])?;
    let mut keys = checked_table(scope, &path, given.as_object()?, about);
    check_order(scope, &path, &keys);
    if variant == "Loiter" {
        let shape = shape(scope, &path, &mut keys)?;
        keys.insert("shape".to_owned(), shape);
    }
    let is_policy = variant == "Policy";
    let sets = if is_policy {
        sets(scope, &path, &mut keys)?
    } else {
        None
    };
    let host = if is_policy {
        host(scope, &path, &mut keys, sets)?
    } else {
        None
    };
    let model = if is_policy && host.is_none() {
        model(scope, &path, &mut keys, sets)?
    } else {
        None
    };
    let is_sampled = keys.get("sampled") == Some(&json!(true));
    if is_sampled && !model.as_ref().is_some_and(PolicyModel::has_logits) {
        let expected = "is true, expected a model with a logit for each of several actions";
        return scope.refuse(&format!("{path}.sampled"), expected);
    }
    let is_direct = keys.get("direct") == Some(&json!(true));
    if is_direct && (model.is_none() && host.is_none() || sets.is_some()) {
        let expected = "is true, expected a model or an entry that chooses courses and speeds";
        return scope.refuse(&format!("{path}.direct"), expected);
    }
    let weight = parameter(&keys, "weight")?;
    let duration_s = parameter(&keys, "duration_s");
    let mut task: Task = serde_json::from_value(json!({ variant: keys })).ok()?;
    if let Task::Policy(policy) = &mut task {
        (policy.model, policy.host, policy.sets) = (model, host, sets);
    }
    Some(Behaviour {
        name: name.to_owned(),
        modes,
        when,
        weight,
        duration_s,
        perpetual: given["perpetual"].as_bool()?,
        posts,
        task,
    })
}

/// A table with its values checked; faulty ones are reported and left out.
fn checked_table(
    scope: &Scope<'_>,
    path: &str,
    given: &Map<String, Json>,
    about: &Json,
) -> Map<String, Json> {
    let mut table = Map::new();
    for (key, value) in given {
        let path = format!("{path}.{key}");
        let value = checked(scope, &path, value, &about["properties"][key]);
        table.extend(value.map(|value| (key.clone(), value)));
    }
    table
}

/// The checked value at `path`; `about` is the schema of the value in the file.
fn checked(scope: &Scope<'_>, path: &str, given: &Json, about: &Json) -> Option<Json> {
    let value = match (about["title"].as_str(), given) {
        (Some("a number or an expression"), _) => {
            serde_json::to_value(scope.parameter(path, given, about)?)
        }
        (Some("boat"), Json::String(name)) => serde_json::to_value(Boat::by_name(name)?),
        (Some("place"), Json::String(name)) => serde_json::to_value(Place::by_name(name)?),
        (Some("place"), _) => serde_json::to_value(Place::At(Ned::from_xy(
            given[0].as_f64()?,
            given[1].as_f64()?,
        ))),
        (_, Json::Array(items)) => {
            let items = items.iter().enumerate();
            let items = items
                .map(|(i, item)| checked(scope, &format!("{path}.{i}"), item, &about["items"]));
            Ok(items.collect::<Option<Json>>()?)
        }
        (_, Json::Object(table)) => Ok(checked_table(scope, path, table, about).into()),
        _ => Ok(given.clone()),
    };
    value.ok()
}

/// The parameter of this key, if it is given and valid.
fn parameter(keys: &Map<String, Json>, key: &str) -> Option<Parameter> {
    serde_json::from_value(keys.get(key)?.clone()).ok()
}

/// Reports pairs of numbers in the wrong order, if both are constants.
fn check_order(scope: &Scope<'_>, path: &str, keys: &Map<String, Json>) {
    let constant = |key: &str| parameter(keys, key)?.constant();
    for (low, high) in IN_ORDER {
        let (Some(least), Some(most)) = (constant(low), constant(high)) else {
            continue;
        };
        let given = [low, high]
            .into_iter()
            .find(|key| scope.document.has(&format!("{path}.{key}")));
        if let Some(given) = given.filter(|_| least > most) {
            let message = format!("{low} is {least}, expected at most {high}, which is {most}");
            scope.document.note(&format!("{path}.{given}"), message);
        }
    }
}

/// The shape of a loiter, from whichever of its keys is given.
fn shape(scope: &Scope<'_>, path: &str, keys: &mut Map<String, Json>) -> Option<Json> {
    let given = ["polygon", "ellipse"].map(|key| scope.document.has(&format!("{path}.{key}")));
    let ellipse = format!("{path}.ellipse");
    match given {
        [true, false] => keys
            .remove("polygon")
            .map(|corners| json!({ "Corners": corners })),
        [false, true] => keys
            .remove("ellipse")
            .map(|ellipse| json!({ "Ellipse": ellipse })),
        [true, true] => scope.refuse(&ellipse, "is given with polygon, expected one of them"),
        [false, false] => {
            scope.note_missing(&ellipse, "ellipse or polygon");
            None
        }
    }
}

/// The variable that receives a policy's option, if it has options.
fn sets(scope: &Scope<'_>, path: &str, keys: &mut Map<String, Json>) -> Option<Option<u16>> {
    let Some(Json::String(name)) = keys.remove("sets") else {
        return Some(None);
    };
    let at = format!("{path}.sets");
    let of_texts = |variable: &&Variable| matches!(&variable.kind, VariableKind::Text(_));
    match scope.variable(&name) {
        Some((index, variable)) if of_texts(&variable) => Some(Some(index)),
        _ => {
            let known = scope.variables.iter().filter(of_texts);
            let known: Vec<&str> = known.map(|variable| variable.name.as_str()).collect();
            let expected = match known.as_slice() {
                [] => "a variable with `values`, but [variables] has none".to_owned(),
                known => format!("one of the string variables, {}", listed(&name, known)),
            };
            scope.refuse(&at, &format!("is {name:?}, expected {expected}"))
        }
    }
}

/// The reason why a model does not suit a policy that sets this variable, if any.
fn misfit(scope: &Scope<'_>, model: &PolicyModel, sets: Option<u16>) -> Option<String> {
    let has_options = model.spec.action == ActionSpace::Options;
    let Some(variable) = sets.map(|index| &scope.variables[usize::from(index)]) else {
        let why = "it chooses among options, expected `sets` with a variable for its choice";
        return has_options.then(|| why.to_owned());
    };
    let VariableKind::Text(texts) = &variable.kind else {
        return None;
    };
    if !has_options {
        return Some(format!(
            "it chooses a course and a speed, expected one that chooses a value of {}",
            variable.name
        ));
    }
    let names = model.options();
    let found = names.as_ref().map_or_else(
        || model.actions().unwrap_or_default().to_string(),
        |names| names.join(", "),
    );
    let is_fit = names.map_or(model.actions() == Some(texts.len()), |names| {
        names == *texts
    });
    (!is_fit).then(|| {
        let expected = format!(
            "the {} values of {}: {}",
            texts.len(),
            variable.name,
            texts.join(", ")
        );
        format!("its options are {found}, expected {expected}")
    })
}

/// The competition entry that a policy refers to, if any.
fn host(
    scope: &Scope<'_>,
    path: &str,
    keys: &mut Map<String, Json>,
    sets: Option<u16>,
) -> Option<Option<Host>> {
    let [host, python, limit_s] = ["host", "python", "limit_s"].map(|key| keys.remove(key));
    let given = |keys: &[&str]| {
        let mut keys = keys.iter();
        let found = keys.find(|key| scope.document.has(&format!("{path}.{key}")));
        found.map(|key| format!("{path}.{key}"))
    };
    let Some(Json::String(host)) = host else {
        return given(&["python", "limit_s"]).map_or(Some(None), |key| {
            scope.refuse(&key, "is given without host, which it requires")
        });
    };
    let others = given(&["model", "action", "by"]);
    if let Some(key) = others.or_else(|| sets.and_then(|_| given(&["sets"]))) {
        return scope.refuse(&key, "is given with host, expected one of them");
    }
    let observation = keys.remove("observation");
    let observation = observation.and_then(|space| serde_json::from_value(space).ok());
    let known = [
        ObservationSpace::Pyquaticus,
        ObservationSpace::Pyquaticus2026,
    ];
    if observation.is_some_and(|space| !known.contains(&space)) {
        let expected =
            "is of a different kind, expected pyquaticus or pyquaticus_2026 for an entry";
        return scope.refuse(&format!("{path}.observation"), expected);
    }
    let found = scope.document.resolve(&format!("{path}.host"), &host);
    let files = &scope.document.loader.files;
    // Stored files come from a different process: never run programs at paths that they contain.
    let is_allowed = !files.is_stored();
    if is_allowed && !found.join("solution.py").is_file() && !found.is_file() {
        let expected = "expected a folder with solution.py, or that file";
        return scope.refuse(&format!("{path}.host"), &format!("is {host:?}, {expected}"));
    }
    Some(Some(Host {
        path: found.display().to_string(),
        python: python.map_or("python3".to_owned(), |name| {
            name.as_str().unwrap_or_default().to_owned()
        }),
        limit_s: limit_s.and_then(|limit| limit.as_f64()).unwrap_or(1.0),
        observation,
        period_s: keys.remove("period_s").and_then(|period| period.as_f64()),
        is_allowed,
    }))
}

/// The model that a policy refers to, if any.
fn model(
    scope: &Scope<'_>,
    path: &str,
    keys: &mut Map<String, Json>,
    sets: Option<u16>,
) -> Option<Option<PolicyModel>> {
    let [file, observation, action, period_s] =
        ["model", "observation", "action", "period_s"].map(|key| keys.remove(key));
    let given = |key: &str| scope.document.has(&format!("{path}.{key}"));
    let at = format!("{path}.model");
    let Some(file) = file.as_ref().and_then(Json::as_str) else {
        let of_models = ["observation", "action", "period_s"]
            .into_iter()
            .find(|key| given(key));
        return of_models.map_or(Some(None), |key| {
            let message = "is given without model, which it requires";
            scope.refuse(&format!("{path}.{key}"), message)
        });
    };
    let mut used = ["model", "observation", "action", "period_s"].iter();
    if !used.all(|key| scope.document.is_sound(&format!("{path}.{key}"))) {
        return None;
    }
    if given("by") {
        let message = "is given with model, expected one of them";
        return scope.refuse(&format!("{path}.by"), message);
    }
    let said = PartialSpec {
        observation: observation.and_then(|space| serde_json::from_value(space).ok()),
        action: action.and_then(|space| serde_json::from_value(space).ok()),
        period_s: period_s.as_ref().and_then(Json::as_f64),
    };
    let path = scope.document.resolve(&at, file);
    let files = &scope.document.loader.files;
    let bytes = files.read(&path, policy::BYTES_MAX);
    let model = bytes
        .map_err(|error| format!("it cannot be read ({error}), expected an ONNX file"))
        .and_then(|bytes| PolicyModel::read(&path.display().to_string(), &bytes, said));
    match model.and_then(|model| misfit(scope, &model, sets).map_or(Ok(model), Err)) {
        Ok(model) => Some(Some(model)),
        Err(why) => scope.refuse(&at, &format!("is {file:?}: {why}")),
    }
}

/// Whether a behaviour may run in each mode.
fn in_modes(scope: &Scope<'_>, path: &str, modes: &[Mode], given: Option<&[Json]>) -> Vec<bool> {
    let Some(given) = given else {
        return vec![true; modes.len()];
    };
    let mut allowed = vec![false; modes.len()];
    let given = given.iter().map(|name| name.as_str().unwrap_or_default());
    for (i, name) in given.enumerate().filter(|(_, name)| !name.is_empty()) {
        match modes.iter().position(|mode| mode.name == name) {
            Some(mode) => allowed[mode] = true,
            None => {
                let names: Vec<&str> = modes.iter().map(|mode| mode.name.as_str()).collect();
                let expected = listed(name, &names);
                let message =
                    format!("`in` contains {name:?}, expected one of the modes {expected}");
                scope.document.note(&format!("{path}.in.{i}"), message);
            }
        }
    }
    // Parents precede their children.
    for (i, mode) in modes.iter().enumerate() {
        allowed[i] |= mode.parent.is_some_and(|parent| allowed[parent]);
    }
    allowed
}

fn posts(scope: &Scope<'_>, path: &str, given: &Json) -> Vec<Post> {
    let mut posts = vec![];
    for at in Moment::all() {
        let values = raw::Values::deserialize(&given[at.name()]).unwrap_or_default();
        let set = set(scope, &format!("{path}.{}", at.name()), &values);
        posts.extend(set.into_iter().map(|(variable, value)| Post {
            at: *at,
            variable,
            value,
        }));
    }
    posts
}
