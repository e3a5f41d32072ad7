//! Measurements as a table in CSV: one row per render. The only file that names the crate `csv`.

use crate::error::{Error, Problem, Result};
use crate::input;
use crate::output;
use csv::{ReaderBuilder, StringRecord, Terminator, WriterBuilder};
use std::collections::HashMap;
use std::path::Path;

/// The columns in the order in which they are written.
pub const COLUMNS: [&str; 9] = ["scene", "label", "spp", "seed", "seconds", "relmse", "relmse_trimmed", "mse", "flip"];
/// Columns that a table of another program must have.
pub const REQUIRED: [&str; 5] = ["scene", "label", "spp", "seconds", "relmse"];

/// One render: what it was, how long it took, and how far it is from the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the scene file without its ending.
    pub scene: String,
    /// Which line of the chart it belongs to, such as `mis xoshiro`.
    pub label: String,
    /// Samples per pixel, at least 1.
    pub spp: u64,
    /// Seed of the random numbers, where known.
    pub seed: Option<u64>,
    /// Wall seconds of the render alone, at least 0.
    pub seconds: f64,
    /// Mean over pixels and channels of (I - R)^2 / (R^2 + 0.01), less the reference's own noise. May be negative: then
    /// the image is nearer to the reference than this can tell.
    pub relmse: f64,
    /// The same without the worst 0.1 % of pixels.
    pub relmse_trimmed: Option<f64>,
    /// Mean over pixels and channels of (I - R)^2.
    pub mse: Option<f64>,
    /// Mean FLIP, 0 to 1.
    pub flip: Option<f64>,
}

/// Reads a table. Its columns may be in any order; those beyond [`REQUIRED`] may be absent or empty, others are passed
/// over.
///
/// # Errors
/// [`Error::Io`] where the file cannot be read, [`Error::Scene`] with all mistakes in it, each with its line and column.
pub fn read(path: &Path) -> Result<Vec<Row>> {
    let bytes = input::regular(path).map_err(|source| Error::Io { file: path.to_owned(), action: "read", source })?;
    let text = match std::str::from_utf8(&bytes) {
        Ok(text) => text,
        Err(error) => {
            let line = bytes.iter().take(error.valid_up_to()).filter(|&&b| b == b'\n').count() + 1;
            let problem =
                Table::new(path, "").problem(line, None, "bytes that are not UTF-8", "a table as CSV in UTF-8");
            return Err(Error::Scene(vec![problem]));
        }
    };
    parse(path, text)
}

/// Reads a table from `text`; `path` is named in messages.
///
/// # Errors
/// [`Error::Scene`] as [`read`].
pub fn parse(path: &Path, text: &str) -> Result<Vec<Row>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let table = Table::new(path, text);
    let mut reader = ReaderBuilder::new().flexible(true).has_headers(false).from_reader(text.as_bytes());
    let mut records = reader.records();
    let header = match records.next() {
        Some(Ok(header)) => header,
        _ => {
            let expected = format!("a line with the columns {}", COLUMNS.join(","));
            return Err(Error::Scene(vec![table.problem(1, None, "an empty file", &expected)]));
        }
    };
    let columns = table.columns(&header).map_err(Error::Scene)?;
    let (mut rows, mut problems) = (Vec::new(), Vec::new());
    for record in records {
        // Text that is UTF-8 and records of any length leave nothing that could fail.
        let Ok(record) = record else { continue };
        let line = record.position().map_or(0, |position| position.line() as usize);
        if record.len() != header.len() {
            let found = format!("{} fields", record.len());
            let expected = format!("{} as in the first line", header.len());
            problems.push(table.problem(line, None, &found, &expected));
            continue;
        }
        let mut fields = Fields { table: &table, columns: &columns, record: &record, line, problems: &mut problems };
        rows.extend(fields.row());
    }
    if problems.is_empty() { Ok(rows) } else { Err(Error::Scene(problems)) }
}

/// Writes a table; it is there whole or not at all.
///
/// # Errors
/// As [`output::write_text`].
pub fn write(path: &Path, rows: &[Row]) -> Result<()> {
    let fail = |error: String| Error::Output { file: path.to_owned(), reason: error };
    let mut writer = WriterBuilder::new().terminator(Terminator::Any(b'\n')).from_writer(Vec::new());
    writer.write_record(COLUMNS).map_err(|error| fail(error.to_string()))?;
    for row in rows {
        let error = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6e}"));
        let record = [
            row.scene.clone(),
            row.label.clone(),
            row.spp.to_string(),
            row.seed.map_or_else(String::new, |seed| seed.to_string()),
            format!("{:.6}", row.seconds),
            error(Some(row.relmse)),
            error(row.relmse_trimmed),
            error(row.mse),
            error(row.flip),
        ];
        writer.write_record(record).map_err(|error| fail(error.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|error| fail(error.to_string()))?;
    output::write_bytes(path, &bytes)
}

/// The file that is read, for messages.
struct Table<'a> {
    path: &'a Path,
    lines: Vec<&'a str>,
}

impl<'a> Table<'a> {
    fn new(path: &'a Path, text: &'a str) -> Self {
        Self { path, lines: text.lines().collect() }
    }

    /// A mistake in a line, in its field of that index where one is at fault.
    fn problem(&self, line: usize, field: Option<usize>, found: &str, expected: &str) -> Problem {
        let text = self.lines.get(line.wrapping_sub(1)).copied().unwrap_or_default();
        // Where a field is quoted, commas do not tell where the others begin.
        let before = field
            .filter(|_| !text.contains('"'))
            .map_or(0, |field| text.split(',').take(field).map(|before| before.chars().count() + 1).sum());
        Problem {
            file: self.path.to_owned(),
            place: Some((line, before + 1)),
            path: String::new(),
            found: found.to_owned(),
            expected: expected.to_owned(),
            hint: None,
        }
    }

    /// Where each known column is.
    fn columns(&self, header: &StringRecord) -> std::result::Result<HashMap<&'static str, usize>, Vec<Problem>> {
        let (mut columns, mut problems) = (HashMap::new(), Vec::new());
        for (index, name) in header.iter().enumerate() {
            let Some(&known) = COLUMNS.iter().find(|known| known.eq_ignore_ascii_case(name.trim())) else { continue };
            if columns.insert(known, index).is_some() {
                problems.push(self.problem(1, Some(index), &format!("the column {known} again"), "each column once"));
            }
        }
        for name in REQUIRED.iter().filter(|name| !columns.contains_key(*name)) {
            let expected = format!("a line with {} at least", REQUIRED.join(","));
            problems.push(self.problem(1, None, &format!("no column {name}"), &expected));
        }
        if problems.is_empty() { Ok(columns) } else { Err(problems) }
    }
}

/// A record on its way to a row.
struct Fields<'a> {
    table: &'a Table<'a>,
    columns: &'a HashMap<&'static str, usize>,
    record: &'a StringRecord,
    line: usize,
    problems: &'a mut Vec<Problem>,
}

impl Fields<'_> {
    fn row(&mut self) -> Option<Row> {
        let scene = self.text("scene");
        let label = self.text("label");
        let spp =
            self.number("spp", true, "a whole number from 1", |n| n >= 1.0 && n < 2f64.powi(53) && n.fract() == 0.0);
        let seed = self.seed();
        let seconds = self.number("seconds", true, "a finite number from 0", |n| n.is_finite() && n >= 0.0);
        let mut error = |name, required| self.number(name, required, "a finite number", f64::is_finite);
        let relmse = error("relmse", true);
        let [relmse_trimmed, mse, flip] = ["relmse_trimmed", "mse", "flip"].map(|name| error(name, false));
        let (spp, seconds, relmse) = (spp? as u64, seconds?, relmse?);
        Some(Row { scene: scene?, label: label?, spp, seed, seconds, relmse, relmse_trimmed, mse, flip })
    }

    fn field(&self, name: &str) -> Option<(usize, &str)> {
        let &index = self.columns.get(name)?;
        let text = self.record.get(index)?.trim();
        (!text.is_empty()).then_some((index, text))
    }

    fn wrong(&mut self, name: &str, expected: &str) {
        let index = self.columns.get(name).copied();
        let found = match self.field(name) {
            Some((_, text)) => format!("{text:?}"),
            None => "nothing".to_owned(),
        };
        let mut problem = self.table.problem(self.line, index, &found, expected);
        problem.path = name.to_owned();
        self.problems.push(problem);
    }

    fn text(&mut self, name: &str) -> Option<String> {
        let text = self.field(name).map(|(_, text)| text.to_owned());
        if text.is_none() {
            self.wrong(name, "a name");
        }
        text
    }

    fn number(&mut self, name: &str, required: bool, expected: &str, fits: fn(f64) -> bool) -> Option<f64> {
        let number = match self.field(name) {
            None if !required => return None,
            field => field.and_then(|(_, text)| text.parse().ok()).filter(|&number| fits(number)),
        };
        if number.is_none() {
            self.wrong(name, expected);
        }
        number
    }

    fn seed(&mut self) -> Option<u64> {
        let seed = self.field("seed")?.1.parse().ok();
        if seed.is_none() {
            self.wrong("seed", "a whole number");
        }
        seed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn row(spp: u64, seed: u64) -> Row {
        Row {
            scene: "a, b".into(),
            label: "mis \"x\"".into(),
            spp,
            seed: Some(seed),
            seconds: 0.125,
            relmse: -1.5e-7,
            relmse_trimmed: Some(3.25e-3),
            mse: None,
            flip: Some(0.5),
        }
    }

    fn parsed(text: &str) -> Result<Vec<Row>> {
        parse(Path::new("a.csv"), text)
    }

    #[test]
    fn rows_come_back_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let rows = [row(1, 0), row(1 << 40, u64::MAX)];
        write(&path, &rows).unwrap();
        assert_eq!(read(&path).unwrap(), rows);
        let text = fs::read_to_string(&path).unwrap();
        let first = "scene,label,spp,seed,seconds,relmse,relmse_trimmed,mse,flip\n\
                     \"a, b\",\"mis \"\"x\"\"\",1,0,0.125000,-1.500000e-7,3.250000e-3,,5.000000e-1\n";
        assert!(text.starts_with(first), "{text}");
        write(&path, &read(&path).unwrap()).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text, "written again it is the same");
    }

    #[test]
    fn other_programs_need_not_know_all_columns_nor_their_order() {
        let header = "\u{feff}relmse, SPP ,extra,label,seconds,scene";
        let rows = parsed(&format!("{header}\r\n2e-3,16,x,other,0.5,room\r\n\r\n1,4.0,,b,0,r\r\n")).unwrap();
        assert_eq!(rows.len(), 2);
        let Row { scene, label, spp, seed, seconds, relmse, relmse_trimmed, mse, flip } = &rows[0];
        assert_eq!((scene.as_str(), label.as_str(), *spp, *seed), ("room", "other", 16, None));
        assert_eq!((*seconds, *relmse, *relmse_trimmed, *mse, *flip), (0.5, 2e-3, None, None, None));
        assert_eq!((rows[1].spp, rows[1].seconds), (4, 0.0));
        assert_eq!(parsed("scene,label,spp,seconds,relmse\n").unwrap(), []);
    }

    #[test]
    fn every_mistake_is_named_with_its_line_and_column() {
        let fails = |text: &str, expected: &[&str]| {
            let found = parsed(text).unwrap_err().to_string();
            let found: Vec<&str> = found.lines().collect();
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (found, part) in found.iter().zip(expected) {
                assert!(found.contains(part), "{part} in {found}");
            }
        };
        fails("", &["a.csv:1:1: found an empty file, expected a line with the columns scene,label"]);
        fails("scene,label,spp\n", &["1:1: found no column seconds", "found no column relmse"]);
        fails("scene,label,spp,seconds,relmse,spp\n", &["1:32: found the column spp again"]);
        let header = "scene,label,spp,seconds,relmse\n";
        fails(&format!("{header}a,b,1,1\n"), &["a.csv:2:1: found 4 fields, expected 5"]);
        fails(
            &format!("{header}a,b,0,1,1\n,,x,nan,inf\na,b,1.5,-1,\n"),
            &[
                "a.csv:2:5: spp: found \"0\", expected a whole number from 1",
                "a.csv:3:1: scene: found nothing, expected a name",
                "a.csv:3:2: label: found nothing",
                "a.csv:3:3: spp: found \"x\"",
                "a.csv:3:5: seconds: found \"nan\", expected a finite number",
                "a.csv:3:9: relmse: found \"inf\"",
                "a.csv:4:5: spp: found \"1.5\"",
                "a.csv:4:9: seconds: found \"-1\"",
                "a.csv:4:12: relmse: found nothing",
            ],
        );
        fails("scene,label,spp,seconds,relmse,seed\na,b,1,1,1,-3\n", &["2:11: seed: found \"-3\""]);
    }

    #[test]
    fn files_that_are_no_table_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let fails = |bytes: &[u8], part: &str| {
            let path = folder.path().join("a.csv");
            fs::write(&path, bytes).unwrap();
            let found = read(&path).unwrap_err().to_string();
            assert!(found.contains(part), "{found}");
        };
        fails(b"scene,label\nab\xff\n", "a.csv:2:1: found bytes that are not UTF-8");
        fails(b"\x89PNG\r\n\x1a\n\0\0", "not UTF-8");
        fails(b"\xef\xbb\xbf", "an empty file");
        assert!(read(folder.path()).unwrap_err().to_string().contains("cannot read"));
        assert!(read(&folder.path().join("none.csv")).unwrap_err().to_string().contains("cannot read"));
    }
}
