//! Measurements of other programs, or of other builds of this one, on the same axes.

use super::Row;
use super::curve::labels;
use std::path::Path;

/// Rows that were imported, and what was not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imported {
    /// Rows of scenes of the chart, under labels of their own.
    pub rows: Vec<Row>,
    /// Scenes that the chart does not have, and how many rows each of them has.
    pub others: Vec<(String, usize)>,
}

impl Imported {
    /// Adds the rows of a file at `path`. A label that is `taken`, or was imported from another file, gets the file's
    /// name in brackets, or that of its folder where the file is called `chart.csv`.
    pub fn add(&mut self, path: &Path, rows: Vec<Row>, scenes: &[String], taken: &[String]) {
        let known = |label: &String, imported: &[String]| taken.contains(label) || imported.contains(label);
        let before = labels(&self.rows);
        let source = source(path);
        let mut renamed: Vec<(String, String)> = Vec::new();
        for label in labels(&rows) {
            let mut name = label.clone();
            let mut number = 1;
            while known(&name, &before) || renamed.iter().any(|(_, new)| *new == name) {
                let suffix = if number == 1 { String::new() } else { format!(" {number}") };
                name = format!("{label} ({source}{suffix})");
                number += 1;
            }
            renamed.push((label, name));
        }
        for mut row in rows {
            if scenes.contains(&row.scene) {
                if let Some((_, name)) = renamed.iter().find(|(label, _)| *label == row.label) {
                    row.label.clone_from(name);
                }
                self.rows.push(row);
            } else {
                match self.others.iter_mut().find(|(scene, _)| *scene == row.scene) {
                    Some((_, count)) => *count += 1,
                    None => self.others.push((row.scene, 1)),
                }
            }
        }
    }
}

/// What a file is called among others.
fn source(path: &Path) -> String {
    let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let own = stem(path).filter(|name| name != "chart");
    own.or_else(|| stem(path.parent()?)).unwrap_or_else(|| "imported".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, label: &str) -> Row {
        let (scene, label) = (scene.to_owned(), label.to_owned());
        Row { scene, label, spp: 1, seed: None, seconds: 1.0, relmse: 1.0, relmse_trimmed: None, mse: None, flip: None }
    }

    #[test]
    fn labels_are_never_mixed() {
        let (scenes, taken) = (["a".to_owned()], ["mis".to_owned()]);
        let mut imported = Imported::default();
        let mut add = |path: &str, labels: &[&str]| {
            let rows = labels.iter().map(|label| row("a", label)).collect();
            imported.add(Path::new(path), rows, &scenes, &taken);
            imported.rows.split_off(imported.rows.len() - labels.len()).into_iter().fold(
                Vec::new(),
                |mut names, row| {
                    names.push(row.label.clone());
                    imported.rows.push(row);
                    names
                },
            )
        };
        assert_eq!(add("x/peer.csv", &["other", "mis", "other"]), ["other", "mis (peer)", "other"]);
        assert_eq!(add("old/chart.csv", &["mis", "path"]), ["mis (old)", "path"]);
        assert_eq!(
            add("peer.csv", &["mis", "other", "mis (peer)"]),
            ["mis (peer 2)", "other (peer)", "mis (peer) (peer)"]
        );
        assert_eq!(add("chart.csv", &["mis"]), ["mis (imported)"]);
    }

    #[test]
    fn scenes_are_matched_by_name() {
        let mut imported = Imported::default();
        let rows = vec![row("a", "x"), row("b", "x"), row("b", "y"), row("c", "x")];
        imported.add(Path::new("p.csv"), rows, &["a".to_owned()], &[]);
        assert_eq!(imported.rows, [row("a", "x")]);
        assert_eq!(imported.others, [("b".to_owned(), 2), ("c".to_owned(), 1)]);
    }
}
