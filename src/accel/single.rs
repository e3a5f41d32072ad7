//! One ray at a time (kernel A): the node's eight boxes at once, nearest first. For stragglers and as the oracle.

use super::boxes::{Met, enter};
use super::layout::Node;
use super::ray::Prepared;
use super::triangle::{any_in_leaf, closest_in_leaf};
use super::{Bvh, Hit, LEAF, Ray};
use crate::lanes::{Kernel, LanesU32, Wide, dispatch};

/// Traverses a tree with one ray at a time; holds the stack between rays.
#[derive(Clone, Debug)]
pub struct Single {
    near: Vec<f32>,
    codes: Vec<u32>,
}

impl Single {
    /// Room for any traversal of `bvh`.
    pub fn new(bvh: &Bvh) -> Self {
        Self { near: vec![0.0; bvh.stack_bound], codes: vec![0; bvh.stack_bound] }
    }

    /// The nearest hit.
    pub fn closest(&mut self, bvh: &Bvh, ray: &Ray) -> Hit {
        dispatch(One::<false> { tracer: self, bvh, ray })
    }

    /// Whether anything is hit.
    pub fn any(&mut self, bvh: &Bvh, ray: &Ray) -> bool {
        dispatch(One::<true> { tracer: self, bvh, ray }).is_some()
    }

    /// [`Self::closest`] with lanes of form `W`.
    #[inline(always)]
    pub(crate) fn closest_as<W: Wide>(&mut self, bvh: &Bvh, ray: &Ray) -> Hit {
        let mut hit = Hit::miss(ray.t_max);
        if bvh.is_empty() {
            return hit;
        }
        let (tree, prepared) = (bvh.tree(), Prepared::new(ray));
        let pad = prepared.pad(tree.slack);
        self.near[0] = 0.0;
        self.codes[0] = 0;
        let mut top = 1;
        while top > 0 {
            top -= 1;
            if self.near[top] > hit.t + pad {
                continue;
            }
            let code = self.codes[top];
            if code & LEAF != 0 {
                hit = closest_in_leaf::<W>(tree.leaf(code), &prepared, &hit);
            } else {
                top += self.push::<W>(tree.node(code), &prepared, hit.t + pad, top);
            }
        }
        hit
    }

    /// [`Self::any`] with lanes of form `W`.
    #[inline(always)]
    pub(crate) fn any_as<W: Wide>(&mut self, bvh: &Bvh, ray: &Ray) -> bool {
        if bvh.is_empty() {
            return false;
        }
        let (tree, prepared) = (bvh.tree(), Prepared::new(ray));
        self.codes[0] = 0;
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let code = self.codes[top];
            if code & LEAF != 0 {
                if any_in_leaf::<W>(tree.leaf(code), &prepared, ray.t_max) {
                    return true;
                }
            } else {
                let node = tree.node(code);
                let met = Met::new(enter::<W>(node, &prepared, ray.t_max), node.order(prepared.octant()));
                met.codes(node.children::<W>()).store(&mut self.codes[top..]);
                top += met.count();
            }
        }
        false
    }

    /// Pushes the children that the ray meets, the one to visit first on top, and returns how many.
    #[inline(always)]
    fn push<W: Wide>(&mut self, node: &Node, ray: &Prepared, t_max: f32, top: usize) -> usize {
        let met = Met::new(enter::<W>(node, ray, t_max), node.order(ray.octant()));
        met.near().store(&mut self.near[top..]);
        met.codes(node.children::<W>()).store(&mut self.codes[top..]);
        met.count()
    }
}

/// One ray for the kernel.
struct One<'a, const ANY: bool> {
    tracer: &'a mut Single,
    bvh: &'a Bvh,
    ray: &'a Ray,
}

impl<const ANY: bool> Kernel for One<'_, ANY> {
    type Out = Hit;
    #[inline(always)]
    fn run<W: Wide>(self) -> Hit {
        if !ANY {
            return self.tracer.closest_as::<W>(self.bvh, self.ray);
        }
        let triangle = if self.tracer.any_as::<W>(self.bvh, self.ray) { 0 } else { Hit::NONE };
        Hit { triangle, ..Hit::miss(self.ray.t_max) }
    }
}
