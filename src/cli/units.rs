//! Numbers for people.

use std::time::Duration;

/// `11,312`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| str::from_utf8(group).unwrap_or_default()).collect();
    groups.join(",")
}

/// `1 light`, `11,312 lights`.
pub fn counted(n: u64, one: &str) -> String {
    format!("{} {one}{}", count(n), if n == 1 { "" } else { "s" })
}

/// `1 sample per pixel`, `64 samples per pixel`.
pub fn per_pixel(spp: u32) -> String {
    format!("{} per pixel", counted(u64::from(spp), "sample"))
}

/// Three digits, a space and a prefix, to be followed by the unit: `4.91 M`, `312 k`, `17 `.
pub fn si(value: f64) -> String {
    scaled(value, &[" ", " k", " M", " G", " T"])
}

/// `1.91 MB`.
pub fn bytes(n: u64) -> String {
    scaled(n as f64, &[" B", " kB", " MB", " GB", " TB"])
}

fn scaled(value: f64, units: &[&str]) -> String {
    let mut value = value;
    let mut unit = 0;
    // 999.5 rounds to 1000, which the next unit shows in three digits.
    while value >= 999.5 && unit + 1 < units.len() {
        value /= 1000.0;
        unit += 1;
    }
    let places = match value {
        _ if unit == 0 && value.fract() == 0.0 => 0,
        v if v < 9.995 => 2,
        v if v < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.places$}{}", units[unit])
}

/// `0.012 s`, `3.41 s`, `2 min 05 s`, `3 h 07 min`.
pub fn time(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let whole = seconds.round() as u64;
    match seconds {
        s if s < 1.0 => format!("{s:.3} s"),
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 99.95 => format!("{s:.1} s"),
        _ if whole < 3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

/// As [`time`], in whole seconds.
pub fn rough_time(rough: Duration) -> String {
    match rough.as_secs_f64().ceil() as u64 {
        seconds @ 0..100 => format!("{seconds} s"),
        seconds => time(Duration::from_secs(seconds)),
    }
}

/// `value` with four significant digits, without zeros at the end.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if (1e-4..1e7).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// A number per second; 0 of no time.
pub fn rate(n: u64, time: Duration) -> f64 {
    let seconds = time.as_secs_f64();
    if seconds > 0.0 { n as f64 / seconds } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_groups_of_three() {
        assert_eq!([0, 999, 1000, 1_234_567].map(count), ["0", "999", "1,000", "1,234,567"]);
        assert_eq!(counted(1, "light"), "1 light");
        assert_eq!(counted(0, "light"), "0 lights");
    }

    #[test]
    fn three_digits_and_a_prefix() {
        assert_eq!([0.0, 17.0, 0.5, 999.4, 999.6].map(si), ["0 ", "17 ", "0.50 ", "999 ", "1.00 k"]);
        assert_eq!([12_345.0, 4.91e6, 2e13].map(si), ["12.3 k", "4.91 M", "20.0 T"]);
        assert_eq!([0, 999, 1_910_000].map(bytes), ["0 B", "999 B", "1.91 MB"]);
    }

    #[test]
    fn times_change_their_unit() {
        let t = |seconds| time(Duration::from_secs_f64(seconds));
        assert_eq!(
            [0.0124, 3.414, 12.34, 125.4, 11_220.0].map(t),
            ["0.012 s", "3.41 s", "12.3 s", "2 min 05 s", "3 h 07 min"]
        );
        assert_eq!(rough_time(Duration::from_millis(1100)), "2 s");
        assert_eq!(rough_time(Duration::from_secs(125)), "2 min 05 s");
    }

    #[test]
    fn short_numbers() {
        assert_eq!([0.0, -0.0, 1.0, -0.99999994, 38.5, 1e-9].map(short), ["0", "0", "1", "-1", "38.5", "1e-9"]);
        assert_eq!([123_456.0, 1e12].map(short), ["123500", "1e12"]);
    }
}
