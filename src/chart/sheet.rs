//! What all pages have in common: one HTML file, which needs nothing beside it.
//!
//! Style and script stand in files of their own. A policy in the page forbids the browser to fetch anything.

use super::svg::escape;

const DOCUMENT: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A page in the making. What is not named text is HTML.
#[derive(Clone, Debug, Default)]
pub struct Sheet<'a> {
    /// Text of its heading.
    pub title: &'a str,
    /// What stands below it.
    pub summary: String,
    /// What stays in sight, such as a legend.
    pub bar: String,
    /// All sections but the last.
    pub sections: String,
    /// What it takes to repeat the measurements: names and values, as text.
    pub facts: &'a [(String, String)],
    /// The command line, as text.
    pub command: &'a str,
}

impl Sheet<'_> {
    /// The page as HTML.
    pub fn html(self) -> String {
        let parts = [
            ("title", escape(self.title)),
            ("style", dark_colours() + STYLE),
            ("repeat", self.repeat()),
            ("summary", self.summary),
            ("legend", self.bar),
            ("scenes", self.sections),
            ("script", SCRIPT.to_owned()),
        ];
        filled(DOCUMENT, &parts)
    }

    fn repeat(&self) -> String {
        let row = |(name, value): &(String, String)| {
            format!(r#"<tr><th scope="row">{}</th><td>{}</td></tr>"#, escape(name), escape(value))
        };
        let rows: String = self.facts.iter().map(row).collect();
        format!(
            r#"<section aria-label="How to repeat this"><h2>How to repeat this</h2><p><code>{}</code></p><div class="scroll"><table class="facts"><tbody>{rows}</tbody></table></div></section>"#,
            escape(self.command)
        )
    }
}

/// The template with each `{{name}}` replaced; what is filled in is not looked at again.
fn filled(template: &str, parts: &[(&str, String)]) -> String {
    let mut pieces = template.split("{{");
    let mut out = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or(("", piece));
        out.push_str(parts.iter().find(|part| part.0 == name).map_or("", |part| &part.1));
        out.push_str(rest);
    }
    out
}

/// Lines are lighter on a dark ground.
fn dark_colours() -> String {
    let rules: String =
        super::style::DARK_COLOURS.iter().enumerate().map(|(i, colour)| format!(".s{i}{{color:{colour}}}")).collect();
    format!("@media (prefers-color-scheme: dark) {{ {rules} }}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_filled_once() {
        let parts = [("a", "{{b}}".to_owned()), ("b", "x".to_owned())];
        assert_eq!(filled("<{{a}}|{{b}}|{{c}}>{{", &parts), "<{{b}}|x|>");
    }
}
