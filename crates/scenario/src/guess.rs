//! Suggestions for unknown names.

/// The most similar of `choices`: at most two edits away from `name`, ignoring case, or else the
/// one that shares most of its words.
pub(super) fn nearest<'a>(name: &str, choices: &[&'a str]) -> Option<&'a str> {
    let far = name.len().min(5) / 2;
    let name = name.to_lowercase();
    let distances = choices
        .iter()
        .map(|choice| (strsim::levenshtein(&name, &choice.to_lowercase()), *choice));
    let nearest = distances.filter(|(distance, _)| *distance <= far).min();
    let words: Vec<&str> = name.split('_').collect();
    let shared = |choice: &&'a str| {
        let shared = choice.split('_').filter(|word| words.contains(word));
        let shared: Vec<&str> = shared.collect();
        // A shared unit alone does not make names similar.
        let is_near = 2 * shared.len() > words.len().max(choice.split('_').count());
        (is_near && shared.iter().any(|word| word.len() > 2)).then_some((shared.len(), *choice))
    };
    nearest
        .or_else(|| choices.iter().filter_map(shared).max())
        .map(|(_, choice)| choice)
}

/// The suggestion as the end of a message: ` (did you mean seed?)`; empty without a suggestion.
pub fn did_you_mean(name: &str, choices: &[&str]) -> String {
    nearest(name, choices)
        .map(|guess| format!(" (did you mean {guess}?)"))
        .unwrap_or_default()
}

/// The choices with the suggestion: `seed, tick_s (did you mean seed?)`.
pub(super) fn listed(name: &str, choices: &[&str]) -> String {
    choices.join(", ") + &did_you_mean(name, choices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_other_capitals_a_slip_or_another_word_is_recognised() {
        let choices = [
            "tag_radius_m",
            "tag_cooldown_s",
            "grab_radius_m",
            "speed_m_s",
        ];
        for (name, guess) in [
            ("TAG_RADIUS_M", Some("tag_radius_m")),
            ("tag_radus_m", Some("tag_radius_m")),
            ("tag_range_m", Some("tag_radius_m")),
            ("noise_m_s", None),
            ("tag", None),
        ] {
            assert_eq!(nearest(name, &choices), guess, "{name}");
        }
    }
}
