//! The options of `wavetrace profile`.

use crate::cli::args::RenderArgs;
use crate::cli::bench::{Knob, setting, settings, twice};
use crate::cli::values::size;
use clap::{Args, value_parser};
use std::path::PathBuf;

/// Arguments of `wavetrace profile`.
#[derive(Debug, Args)]
pub struct ProfileArgs {
    /// The scene
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,
    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..), default_value_t = 16,
        allow_negative_numbers = true)]
    pub spp: u32,
    /// Pixels across and down, in place of the camera's
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<(u32, u32)>,
    /// A setting of the render, as `bench sweep` has them; repeatable
    #[arg(long, value_name = "KNOB=VALUE", value_parser = setting)]
    pub set: Vec<Knob>,
    /// Folder for index.html
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// No messages but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl ProfileArgs {
    /// What the render is told.
    ///
    /// # Errors
    /// What was found and what was expected, in the words of the command line.
    pub fn render(&self) -> Result<RenderArgs, (String, String)> {
        if let Some(name) = twice(&self.set) {
            return Err((format!("{name} twice"), "each knob once".to_owned()));
        }
        let spp = self.spp.to_string();
        let mut all: Vec<(&str, &str)> = self
            .set
            .iter()
            .flat_map(|knob| knob.values.iter().map(|value| (knob.name.as_str(), value.as_str())))
            .collect();
        if all.iter().all(|(name, _)| *name != "spp") {
            all.push(("spp", &spp));
        }
        settings(&self.scene, &all).map_err(|expected| {
            (all.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(", "), expected)
        })
    }
}
