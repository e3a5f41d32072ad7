//! Numbers as text: few digits, the same bytes every time.

/// `value` with at most five decimals, without trailing zeros and without a negative zero.
pub fn number(value: f64) -> String {
    let fixed = format!("{value:.5}");
    let short = fixed.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// The three components, separated by blanks.
pub fn triple(v: glam::DVec3) -> String {
    format!("{} {} {}", number(v.x), number(v.y), number(v.z))
}
