//! Numbers as sentences carry them.

/// A finite number of the form `[+-]digits[.digits]`: no exponent, no `nan`, no `inf`.
pub(super) fn number(text: &str) -> Option<f64> {
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let (whole, decimals) = unsigned.split_once('.').unwrap_or((unsigned, "0"));
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let number = if digits(whole) && digits(decimals) { text.parse::<f64>().ok() } else { None };
    number.filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_digits_with_a_sign_and_a_point_at_most() {
        for (text, want) in [("0", 0.0), ("000", 0.0), ("-33.2", -33.2), ("+1.5", 1.5), ("012.70", 12.7)] {
            assert_eq!(number(text), Some(want), "{text:?}");
        }
        for text in ["", "-", ".5", "5.", "1e3", "1_000", "nan", "NaN", "inf", "-infinity", "--1", "1.2.3", "0x10", "١"]
        {
            assert_eq!(number(text), None, "{text:?}");
        }
        assert_eq!(number(&"9".repeat(400)), None, "a number past every f64");
    }
}
