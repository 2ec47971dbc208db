//! The parser's complaints in the words of these files: which key, what was found, what is allowed.

pub(super) use super::guess::nearest;

/// Rewords a complaint about the entry `key`.
pub(super) fn explain(complaint: &str, key: &str) -> String {
    if let Some(rest) = complaint.strip_prefix("unknown field `") {
        let (name, rest) = rest.split_once('`').unwrap_or((rest, ""));
        return with_choices(&format!("{name} is unknown"), name, rest);
    }
    if let Some(rest) = complaint.strip_prefix("unknown variant `") {
        let (name, rest) = rest.split_once('`').unwrap_or((rest, ""));
        return with_choices(&format!("{key} is {name:?}"), name, rest);
    }
    let parts = complaint
        .strip_prefix("invalid type: ")
        .or_else(|| complaint.strip_prefix("invalid value: "))
        .or_else(|| complaint.strip_prefix("invalid "))
        .and_then(|rest| rest.rsplit_once(", expected "));
    match parts {
        Some((found, expected)) => {
            format!("{key} is {}, expected {}", found_in_words(found), wanted_in_words(expected))
        }
        None => format!("{key}: {complaint}"),
    }
}

/// `what`, then what is allowed as the tail of the complaint lists it, then what may have been meant.
fn with_choices(what: &str, name: &str, tail: &str) -> String {
    let choices: Vec<&str> = tail.split('`').skip(1).step_by(2).collect();
    let expected = if choices.len() > 1 { "one of " } else { "" };
    let guess = nearest(name, &choices).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
    format!("{what}, expected {expected}{}{guess}", choices.join(", "))
}

fn found_in_words(found: &str) -> String {
    match found {
        "sequence" => "a list".into(),
        "map" => "a table".into(),
        _ if found.starts_with("string ") => format!("the string {}", &found["string ".len()..]),
        _ if found.starts_with("length ") => format!("of {found}"),
        _ => found.split('`').nth(1).unwrap_or(found).into(),
    }
}

fn wanted_in_words(wanted: &str) -> &str {
    match wanted {
        "f64" => "a number",
        "i64" => "a whole number",
        "a sequence" => "a list",
        "a map" => "a table",
        _ if wanted.starts_with("struct ") => "a table",
        _ => wanted,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn complaints_name_key_found_and_allowed() {
        for (complaint, want) in [
            ("invalid type: string \"fast\", expected f64", "mass_kg is the string \"fast\", expected a number"),
            ("invalid type: integer `3`, expected a string", "mass_kg is 3, expected a string"),
            ("invalid type: sequence, expected struct Hull", "mass_kg is a list, expected a table"),
            (
                "invalid length 3, expected a pair of numbers [a, b]",
                "mass_kg is of length 3, expected a pair of numbers [a, b]",
            ),
            (
                "unknown field `seid`, expected one of `seed`, `base`",
                "seid is unknown, expected one of seed, base (did you mean seed?)",
            ),
            ("unknown variant `x`, expected `all` or `none`", "mass_kg is \"x\", expected one of all, none"),
            ("something else", "mass_kg: something else"),
        ] {
            assert_eq!(explain(complaint, "mass_kg"), want);
        }
    }
}
