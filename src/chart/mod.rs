//! Error against time and samples: the sweep of renders, its table, and the charts and the page that are made of it.
//!
//! A sweep is a list of [`Task`]s. Each gives a [`Row`]: what was rendered, how long it took, how far the image is from a
//! [`Reference`]. Everything that is drawn is made of rows, so that those of other programs can stand among them.

pub mod axis;
pub mod bars;
pub mod board;
pub mod curve;
pub mod draw;
pub mod figures;
pub mod folder;
pub mod forecast;
pub mod gallery;
pub mod heat;
pub mod import;
pub mod legend;
pub mod machine;
pub mod number;
pub mod page;
pub mod panel;
pub mod plot;
pub mod raster;
pub mod reference;
pub mod roof;
pub mod row;
pub mod setup;
pub mod sheet;
pub mod spans;
pub mod style;
pub mod svg;
pub mod sweep;
pub mod table;

pub use curve::{Metric, SceneCurves, curves};
pub use figures::{Figures, Reach, figures};
pub use folder::{Folder, Kept};
pub use forecast::Forecast;
pub use gallery::{Gallery, Picture, Scale};
pub use import::Imported;
pub use legend::Legend;
pub use machine::{Build, Machine};
pub use page::Page;
pub use reference::Reference;
pub use row::Row;
pub use setup::{ReferenceSetup, SceneSetup, Setup};
pub use sheet::Sheet;
pub use sweep::{Series, Task};
