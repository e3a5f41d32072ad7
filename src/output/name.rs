//! The name of an image that nobody named. The only file that names `jiff`.

use std::time::SystemTime;

use jiff::{Timestamp, civil, tz::TimeZone};

/// A date and a time of day on the local clock.
pub type LocalTime = civil::DateTime;

/// The local clock's reading; UTC where the system's time zone is not known.
#[must_use]
pub fn local_now() -> LocalTime {
    // A clock set beyond the year 9999 is the only failure; a strange name then is better than no image.
    Timestamp::try_from(SystemTime::now()).unwrap_or_default().to_zoned(TimeZone::system()).datetime()
}

/// `YY_MM_DD-hh_mm_ss.png`, 24-hour clock.
#[must_use]
pub fn default_name(now: LocalTime) -> String {
    let (year, month, day) = (now.year().rem_euclid(100), now.month(), now.day());
    let (hour, minute, second) = (now.hour(), now.minute(), now.second());
    format!("{year:02}_{month:02}_{day:02}-{hour:02}_{minute:02}_{second:02}.png")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_two_digits() {
        assert_eq!(default_name(civil::date(2026, 1, 2).at(3, 4, 5, 999_999_999)), "26_01_02-03_04_05.png");
        assert_eq!(default_name(civil::date(1999, 12, 31).at(23, 59, 59, 0)), "99_12_31-23_59_59.png");
        assert_eq!(default_name(civil::date(-1, 12, 31).at(0, 0, 0, 0)).len(), "YY_MM_DD-hh_mm_ss.png".len());
    }
}
