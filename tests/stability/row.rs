//! A row of the page: one way in which path tracers fail, what this one does about it, and the test of that.

/// The part of the program that fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    Intersection,
    Shading,
    Transport,
    Numbers,
    Input,
}

impl Part {
    pub const ALL: [Self; 5] = [Self::Intersection, Self::Shading, Self::Transport, Self::Numbers, Self::Input];
}

/// One failure mode. Texts are Markdown, in whole sentences.
pub struct Row {
    pub part: Part,
    /// The test's name: `cargo test --test stability NAME`.
    pub name: &'static str,
    /// The heading on the page.
    pub title: &'static str,
    /// What fails in textbook code, and why.
    pub fails: &'static str,
    /// What is done about it here, or where it stands.
    pub remedy: &'static str,
    /// Where the remedy comes from: author, year.
    pub source: &'static str,
    /// The test: panics where it does not hold here, or where the textbook's method does not fail.
    pub run: fn() -> Finding,
}

/// What the test measured.
pub struct Finding {
    /// The textbook's figure, short.
    pub textbook: String,
    /// Ours, short.
    pub ours: String,
    /// What was done to get them: a sentence or two for the page.
    pub how: String,
    /// A picture, where looking beats reading.
    pub picture: Option<Picture>,
}

/// A file beside the page.
pub struct Picture {
    /// Ending of the file's name: "svg" or "png".
    pub ending: &'static str,
    pub bytes: Vec<u8>,
    /// What it shows.
    pub caption: String,
}

/// Families of statistical tests in the suite, at most: what the level of each is corrected for.
pub const ROW_FAMILIES: usize = 40;
