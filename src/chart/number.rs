//! Numbers in charts and tables.

/// Three significant digits: `0.0123`, `4.57`, `1,230`, `1.23e-5`.
pub fn figure(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    match rounded.abs() {
        size if (1e-3..1e3).contains(&size) => {
            let places = (2 - size.log10().floor() as i32).max(0) as usize;
            format!("{rounded:.places$}")
        }
        size if (1e3..1e6).contains(&size) => {
            let whole = rounded.abs() as u64;
            format!("{}{},{:03}", if rounded < 0.0 { "-" } else { "" }, whole / 1000, whole % 1000)
        }
        _ => format!("{rounded:.2e}"),
    }
}

/// A whole number with groups of three digits.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `digit` times ten to the `power`: plainly as `0.02`, or as `2·10⁻⁵`.
pub fn tick(digit: u32, power: i32, plain: bool) -> String {
    match (plain, digit) {
        (true, _) if power >= 0 => count(u64::from(digit).saturating_mul(10u64.saturating_pow(power.unsigned_abs()))),
        (true, _) => format!("{:.*}", power.unsigned_abs() as usize, f64::from(digit) * 10f64.powi(power)),
        (false, 1) => format!("10{}", raised(power)),
        (false, _) => format!("{digit}·10{}", raised(power)),
    }
}

fn raised(power: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    power.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits() {
        let found = [0.0, -0.0, 0.0123456, 4.567, 99.96, 999.6, 1234.5, -1234.5, 1.2345e-5, -0.5, 1e9].map(figure);
        let expected = ["0", "0", "0.0123", "4.57", "100", "1,000", "1,230", "-1,230", "1.23e-5", "-0.500", "1.00e9"];
        assert_eq!(found, expected);
        assert_eq!([f64::NAN, f64::INFINITY].map(figure), ["NaN", "inf"]);
        assert_eq!(figure(0.0009996), "0.00100");
    }

    #[test]
    fn ticks_are_plain_or_powers() {
        assert_eq!(tick(2, -2, true), "0.02");
        assert_eq!(tick(5, 3, true), "5,000");
        assert_eq!(tick(1, 0, true), "1");
        assert_eq!(tick(1, -12, false), "10⁻¹²");
        assert_eq!(tick(2, 30, false), "2·10³⁰");
        assert_eq!(tick(9, i32::MAX, true), count(u64::MAX), "no overflow");
        assert_eq!([0, 999, 1000, 1_234_567].map(count), ["0", "999", "1,000", "1,234,567"]);
    }
}
