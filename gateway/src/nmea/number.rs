//! Numbers as they appear in sentences.

/// A finite number of the form `[+-]digits[.digits]`: no exponent, no `nan`, no `inf`.
pub(super) fn number(text: &str) -> Option<f64> {
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let (whole, decimals) = unsigned.split_once('.').unwrap_or((unsigned, "0"));
    // `parse` is not enough: it also accepts "inf", "nan" and exponents, which no sentence
    // contains.
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let number = if digits(whole) && digits(decimals) {
        text.parse::<f64>().ok()
    } else {
        None
    };
    number.filter(|number| number.is_finite())
}
