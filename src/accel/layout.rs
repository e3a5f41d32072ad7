//! How the tree lies in memory: nodes and leaves of eight, each column a SIMD register.

/// An inner node: eight boxes and where they lead.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Rows min x, min y, min z, max x, max y, max z. Unused lanes hold inverted boxes, which nothing hits.
    pub bounds: [[f32; 8]; 6],
    /// Index of a node, or [`super::LEAF`] and the index of a leaf.
    pub child: [u32; 8],
}

impl Node {
    pub fn empty() -> Self {
        let (lo, hi) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Self { bounds: [lo, lo, lo, hi, hi, hi], child: [0; 8] }
    }
    /// Sets a lane to a box, padded: the planes of pre-split boxes and of later arithmetic are rounded.
    pub fn set(&mut self, lane: usize, lo: [f32; 3], hi: [f32; 3], code: u32) {
        for axis in 0..3 {
            let pad = lo[axis].abs().max(hi[axis].abs()) * (4.0 * f32::EPSILON) + f32::MIN_POSITIVE;
            self.bounds[axis][lane] = lo[axis] - pad;
            self.bounds[axis + 3][lane] = hi[axis] + pad;
        }
        self.child[lane] = code;
    }
}

/// Up to eight triangles. Unused lanes repeat the last one.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Leaf {
    /// `corner[k][axis]` of eight triangles.
    pub corner: [[[f32; 8]; 3]; 3],
    /// Ids of the triangles.
    pub id: [u32; 8],
}

impl Leaf {
    /// The leaf of one to eight triangles.
    pub fn new(ids: &[u32], corners: &[[[f32; 3]; 3]]) -> Self {
        let id: [u32; 8] = std::array::from_fn(|i| ids[i.min(ids.len() - 1)]);
        let corner = std::array::from_fn(|k| std::array::from_fn(|axis| id.map(|t| corners[t as usize][k][axis])));
        Self { corner, id }
    }
}
