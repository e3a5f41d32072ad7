//! Entity ids: an entity is a number, a component a column indexed by it.

/// A triangle of the world, in the order of objects and their `f` lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TriangleId(pub u32);

/// A row in the table of one kind of lobe: the kind in the upper four bits, the row below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LobeId(pub u32);

impl LobeId {
    const ROW_BITS: u32 = 28;
    /// Row `row` of the table of kind number `kind`; `None` where either is too large.
    pub fn new(kind: usize, row: usize) -> Option<Self> {
        (kind < 16 && row < 1 << Self::ROW_BITS).then_some(Self((kind as u32) << Self::ROW_BITS | row as u32))
    }
    /// Number of the kind.
    #[inline(always)]
    pub fn kind(self) -> usize {
        (self.0 >> Self::ROW_BITS) as usize
    }
    /// Row in the table of its kind.
    #[inline(always)]
    pub fn row(self) -> usize {
        (self.0 & ((1 << Self::ROW_BITS) - 1)) as usize
    }
}
