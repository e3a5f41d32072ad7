//! The page `docs/stability.md`: made of the rows' texts and of what their tests found.

use crate::common::{full, meshes::repository};
use crate::row::{Finding, Part, Row};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

const INTRODUCTION: &str = "\
Path tracers fail at known places. For each: what fails in textbook code, what is done about it here, and a test in which the
textbook's method fails and this program holds. This page is written by the tests; every figure on it is one that they
measured. `cargo test` runs them in a short form.

All remedies together cost 0 to 4 % of the rays per second and 3 to 6 % of renders: [what, and why](decisions/remedies.md).

```
cargo test --test stability       # all rows, short form, with their figures
cargo test --test stability NAME  # one
WAVETRACE_FULL=1 WAVETRACE_STABILITY_PAGE=docs cargo test --test stability -- --test-threads 1 # the long form, and this page
```
";

/// The text of a row that does not depend on what was measured.
fn prose(row: &Row) -> String {
    let Row { name, title, fails, remedy, source, .. } = row;
    format!("### {title}\n\n{fails}\n\n**Here.** {remedy} *Source: {source}.*\n\n**Test** `{name}`. ")
}

/// Anchor of a heading, as it is made from its text.
fn anchor(title: &str) -> String {
    let kept = title.chars().filter(|c| c.is_alphanumeric() || " -".contains(*c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// Holds the page in the repository to the texts of the rows.
pub fn check(rows: &[Row]) -> Result<(), String> {
    let page =
        std::fs::read_to_string(repository("docs/stability.md")).map_err(|e| format!("docs/stability.md: {e}"))?;
    let stale: Vec<&str> = rows.iter().filter(|row| !page.contains(&prose(row))).map(|row| row.name).collect();
    let headings = page.lines().filter(|line| line.starts_with("### ")).count();
    match (stale.is_empty(), headings == rows.len()) {
        (true, true) => Ok(()),
        (true, false) => Err(format!("docs/stability.md has {headings} rows, the suite {}", rows.len())),
        (false, _) => Err(format!("docs/stability.md does not say what the suite does of: {}", stale.join(", "))),
    }
}

/// Writes the page and its pictures into a folder of documents. All tests must have run and held.
pub fn write(rows: &[Row], findings: &BTreeMap<&str, Finding>, folder: &Path) -> Result<(), String> {
    let found = |row| findings.get(&row).ok_or_else(|| format!("no page: `{row}` has not held"));
    // Before anything is written.
    rows.iter().try_for_each(|row| found(row.name).map(drop))?;
    let failed = |path: &Path, e: std::io::Error| format!("{}: {e}", path.display());
    let mut page = format!("# Where path tracers fail\n\n{INTRODUCTION}\n");
    let form = if full() { "long" } else { "short" };
    let machine = std::env::consts::ARCH;
    let _ = writeln!(page, "Figures: {form} form, {machine}, {}, {} rows.\n", wavetrace::lanes::simd(), rows.len());
    let (mut table, mut body) = (String::new(), String::new());
    let pictures = folder.join("images/stability");
    std::fs::create_dir_all(&pictures).map_err(|e| failed(&pictures, e))?;
    for part in Part::ALL {
        let of_part: Vec<&Row> = rows.iter().filter(|row| row.part == part).collect();
        if of_part.is_empty() {
            continue;
        }
        let _ = writeln!(body, "## {part:?}\n");
        for row in of_part {
            let Finding { textbook, ours, how, picture } = found(row.name)?;
            let _ = writeln!(table, "| {part:?} | [{}](#{}) | {textbook} | {ours} |", row.title, anchor(row.title));
            let _ = writeln!(body, "{}{how}\n\n- Textbook: {textbook}\n- Here: {ours}\n", prose(row));
            if let Some(picture) = picture {
                let file = format!("{}.{}", row.name, picture.ending);
                let path = pictures.join(&file);
                std::fs::write(&path, &picture.bytes).map_err(|e| failed(&path, e))?;
                let _ = writeln!(body, "![{}](images/stability/{file})\n", picture.caption);
            }
        }
    }
    let _ = writeln!(page, "| part | what fails | textbook | here |\n|---|---|---|---|\n{table}\n{}", body.trim_end());
    let path = folder.join("stability.md");
    std::fs::write(&path, page).map_err(|e| failed(&path, e))
}
