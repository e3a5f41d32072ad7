//! One ray, one box and one triangle at a time, without lanes: what a traversal costs that knows nothing of batches or
//! registers. The baseline of the other kernels, and an oracle of theirs that shares the tree and the formulas alone.

use super::layout::{Leaf, Node};
use super::ray::Prepared;
use super::triangle::Sheared;
use super::{Bvh, Hit, LEAF, Ray};
use crate::lanes::{Lanes, MAX_LANES, Mask};

/// Traverses a tree with one ray at a time; holds the stack between rays.
#[derive(Clone, Debug, Default)]
pub struct Scalar {
    /// Where the ray enters what is yet to be visited, and its code.
    stack: Vec<(f32, u32)>,
}

impl Scalar {
    /// Room for any traversal of `bvh`.
    pub fn new(bvh: &Bvh) -> Self {
        Self { stack: Vec::with_capacity(bvh.stack_bound) }
    }

    /// The nearest hit.
    pub fn closest(&mut self, bvh: &Bvh, ray: &Ray) -> Hit {
        self.trace::<f32, false>(bvh, ray)
    }

    /// Whether anything is hit.
    pub fn any(&mut self, bvh: &Bvh, ray: &Ray) -> bool {
        self.trace::<f32, true>(bvh, ray).is_some()
    }

    /// Either, in a lane of form `L`.
    pub(crate) fn trace<L: Lanes, const ANY: bool>(&mut self, bvh: &Bvh, ray: &Ray) -> Hit {
        let mut hit = Hit::miss(ray.t_max);
        if bvh.is_empty() {
            return hit;
        }
        let (tree, prepared) = (bvh.tree_for::<ANY>(), Prepared::new(ray));
        let pad = prepared.pad(tree.slack);
        self.stack.clear();
        self.stack.push((0.0, 0));
        while let Some((near, code)) = self.stack.pop() {
            if near > hit.t + pad {
                continue;
            }
            if code & LEAF == 0 {
                self.push::<L>(tree.node(code), &prepared, hit.t + pad);
                continue;
            }
            meet::<L>(tree.leaf(code), &prepared, &mut hit);
            if ANY && hit.is_some() {
                break;
            }
        }
        hit
    }

    /// Pushes the children that the ray meets, the nearest last.
    fn push<L: Lanes>(&mut self, node: &Node, ray: &Prepared, end: f32) {
        let first = self.stack.len();
        for lane in 0..MAX_LANES {
            let (mut near, mut far) = (L::splat(0.0), L::splat(end));
            for axis in 0..3 {
                let to = |row: usize| {
                    L::splat(node.plane(row as u32, lane)).mul_add(L::splat(ray.inv(axis)), L::splat(-ray.off(row)))
                };
                let (lower, upper) = (to(axis), to(axis + 3));
                near = near.max(lower.min(upper));
                far = far.min(lower.max(upper));
            }
            if near.le(far).any() {
                let near = number(near);
                let mut at = self.stack.len();
                self.stack.push((near, node.child(lane)));
                while at > first && self.stack[at - 1].0 < near {
                    self.stack.swap(at - 1, at);
                    at -= 1;
                }
            }
        }
    }
}

/// Takes what is nearer in a leaf, of equally near triangles that of the smaller id.
fn meet<L: Lanes>(leaf: &Leaf, ray: &Prepared, hit: &mut Hit) {
    for (lane, id) in leaf.distinct() {
        let ray_ = Sheared::<L>::splat(ray, hit.t);
        let met = ray_.test(|k, axis| L::splat(leaf.coordinate(k, ray.axis(axis), lane)));
        let Some((_, t, u, v)) = met.filter(|met| met.0.any()) else { continue };
        let [t, u, v] = [t, u, v].map(number);
        if t < hit.t || (t == hit.t && hit.is_some() && id < hit.triangle) {
            *hit = Hit { t, u, v, triangle: id };
        }
    }
}

/// The number in a lane.
fn number<L: Lanes>(lane: L) -> f32 {
    lane.array().as_ref()[0]
}
