//! Patterns of sources and variables in subscriptions.

use crate::wire::Msg;

/// The patterns of a subscription for sources and variables, and its interval. MOOS clients
/// separate them with commas, `pymoos2` with blanks.
pub(crate) fn patterns(msg: &Msg) -> [String; 3] {
    let text = msg.as_text().unwrap_or_default();
    let value = |name: &str| {
        let words = text
            .split([',', ' '])
            .filter_map(|word| word.split_once('='));
        words
            .filter(|(key, _)| key.trim().eq_ignore_ascii_case(name))
            .map(|(_, value)| value.trim().to_owned())
            .next()
    };
    let pattern = |name| value(name).unwrap_or_else(|| "*".to_owned());
    [
        pattern("AppPattern"),
        pattern("VarPattern"),
        value("Interval").unwrap_or_default(),
    ]
}

/// Whether a pattern matches: `*` matches any characters, `?` one.
pub(crate) fn matches(pattern: &str, text: &str) -> bool {
    let (pattern, text) = (pattern.as_bytes(), text.as_bytes());
    let (mut p, mut t) = (0, 0);
    // Where to resume after the last star, which then covers one more character.
    let mut resume = None;
    while t < text.len() {
        match pattern.get(p) {
            Some(b'*') => {
                resume = Some((p + 1, t));
                p += 1;
            }
            Some(wanted) if *wanted == b'?' || *wanted == text[t] => (p, t) = (p + 1, t + 1),
            _ => {
                let Some((after_star, under_star)) = resume else {
                    return false;
                };
                resume = Some((after_star, under_star + 1));
                (p, t) = (after_star, under_star + 1);
            }
        }
    }
    pattern[p..].iter().all(|rest| *rest == b'*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_and_question_marks_match() {
        for (pattern, text, want) in [
            ("*", "", true),
            ("a*c", "abcbc", true),
            ("a*c", "ab", false),
            ("", "a", false),
        ] {
            assert_eq!(matches(pattern, text), want, "{pattern} {text}");
        }
    }
}
