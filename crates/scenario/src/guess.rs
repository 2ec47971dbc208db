//! Suggestions for unknown names.

/// The most similar of `choices`, at most two edits away from `name`.
pub(super) fn nearest<'a>(name: &str, choices: &[&'a str]) -> Option<&'a str> {
    let far = name.len().min(5) / 2;
    let distances = choices.iter().map(|choice| (strsim::levenshtein(name, choice), *choice));
    distances.filter(|(distance, _)| *distance <= far).min().map(|(_, choice)| choice)
}

/// The suggestion as the end of a message: ` (did you mean seed?)`; or an empty text.
#[must_use]
pub fn did_you_mean(name: &str, choices: &[&str]) -> String {
    nearest(name, choices).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default()
}
