//! placeholder
use super::Bvh;
/// Placeholder.
#[derive(Clone, Debug)]
pub struct Many;
impl Many {
    /// Placeholder.
    pub fn new(_bvh: &Bvh) -> Self { Self }
}
