//! What a file says about the image in it.

/// Key of the entry, with the value `true`, that marks an image whose rendering was interrupted. Files of complete
/// images do not have it.
pub const PARTIAL: &str = "wavetrace:partial";

/// Text entries written into every image file, such as `Software`, `scene`, `spp` and `seed`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Keys and values, in order. A later entry replaces an earlier one of the same key. Keys are cut to what all
    /// formats can hold: 79 printable ASCII characters without `=` and `#`; others become `_`.
    pub entries: Vec<(String, String)>,
    /// Whether the rendering was interrupted; adds [`PARTIAL`].
    pub partial: bool,
}

impl Metadata {
    /// From the entries of a file.
    pub(super) fn from_entries(entries: impl IntoIterator<Item = (String, String)>) -> Self {
        let (partial, entries): (Vec<_>, Vec<_>) = entries.into_iter().partition(|(key, _)| key == PARTIAL);
        Self { entries, partial: partial.iter().any(|(_, value)| value == "true") }
    }

    /// From the lines of a header, as [`Self::lines`] makes them; what is no `key=value` is left out.
    pub(super) fn from_lines<'a>(lines: impl IntoIterator<Item = &'a [u8]>) -> Self {
        let lines = lines.into_iter().map(String::from_utf8_lossy);
        let pairs = lines.filter_map(|line| line.split_once('=').map(|(k, v)| (k.to_owned(), v.to_owned())));
        Self::from_entries(pairs)
    }

    /// The value of an entry.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        self.entries.iter().rev().find(|entry| entry.0 == key).map(|entry| entry.1.as_str())
    }

    /// The entries as a format can hold them, [`PARTIAL`] last. A key that the format reserves for itself gets the
    /// prefix `wavetrace:`.
    pub(super) fn named(&self, reserved: impl Fn(&str) -> bool) -> Vec<(String, String)> {
        let mut named: Vec<(String, String)> = Vec::new();
        for (key, value) in &self.entries {
            let mut key = clean_key(key);
            if reserved(&key) {
                key = clean_key(&format!("wavetrace:{key}"));
            }
            let value = value.replace('\0', " ");
            if key == PARTIAL {
                continue;
            }
            match named.iter_mut().find(|(known, _)| *known == key) {
                Some(entry) => entry.1 = value,
                None => named.push((key, value)),
            }
        }
        if self.partial {
            named.push((PARTIAL.to_owned(), "true".to_owned()));
        }
        named
    }

    /// As [`Self::named`], one `key=value` line each without line ends, for formats whose header is lines of text.
    pub(super) fn lines(&self, reserved: impl Fn(&str) -> bool) -> Vec<String> {
        let one_line = |text: String| text.replace(|c: char| c.is_control(), " ");
        self.named(reserved).into_iter().map(|(key, value)| format!("{key}={}", one_line(value))).collect()
    }
}

/// PNG is the strictest: 1 to 79 characters, no space at either end, no two in a row.
fn clean_key(key: &str) -> String {
    let allowed = |c: char| (c.is_ascii_graphic() && c != '=' && c != '#') || c == ' ';
    let printable: String = key.chars().map(|c| if allowed(c) { c } else { '_' }).collect();
    let spaced = printable.split_whitespace().collect::<Vec<_>>().join(" ");
    match spaced.get(..79).unwrap_or(&spaced).trim_end() {
        "" => "unnamed".to_owned(),
        key => key.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata(entries: &[(&str, &str)], partial: bool) -> Metadata {
        Metadata { entries: entries.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect(), partial }
    }

    #[test]
    fn keys_fit_every_format() {
        assert_eq!(clean_key("Software"), "Software");
        assert_eq!(clean_key("  a\tb  c=d#é "), "a_b c_d__");
        assert_eq!(clean_key(""), "unnamed");
        assert_eq!(clean_key(&"k".repeat(200)), "k".repeat(79));
        assert_eq!(clean_key(&format!("{} tail", "k".repeat(78))), "k".repeat(78));
    }

    #[test]
    fn reserved_repeated_and_forged_keys() {
        let entries = [("type", "a"), ("spp", "1"), ("spp", "2"), (PARTIAL, "true")];
        let expected = [("wavetrace:type", "a"), ("spp", "2")].map(|(k, v)| (k.to_owned(), v.to_owned()));
        assert_eq!(metadata(&entries, false).named(|key| key == "type"), expected);
    }

    #[test]
    fn a_value_cannot_add_a_line() {
        let lines = metadata(&[("scene", "a\nFORMAT=x\r\0")], true).lines(|_| false);
        assert_eq!(lines, ["scene=a FORMAT=x  ", "wavetrace:partial=true"]);
    }
}
