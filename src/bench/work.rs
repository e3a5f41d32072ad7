//! How many nodes and leaves the kernels visit, as it was last accepted. All kernels find the same hits; what they visit for them is what
//! rays cost, and no test of hits sees it. The trees are part of it: their builders, what a leaf costs, the order of children.
//!
//! Who means to change it says so by new figures: a test that fails prints them. `wavetrace bench` tells whether they pay. Accepted on
//! Linux with AVX2 and FMA.

use super::kernel::{Query, Tracer};
use super::sets::{Options, RaySet, SetKind, make};
use super::{Kernel, RayRecord, room};
use crate::accel::work::visits;
use crate::accel::{BatchTracer, BuildOptions, Bvh, Many, Quality, Ray, Scalar, Single, Streams, Tiles};
use crate::lanes::simd;

/// A set of rays by the kernel of a name.
fn trace(kernel: &str, bvh: &Bvh, rays: &[RayRecord], query: Query) {
    fn batch(mut kernel: impl BatchTracer, bvh: &Bvh, rays: &[RayRecord], query: Query) {
        match query {
            Query::Any => kernel.any(bvh, rays.len(), rays, |_, _| ()),
            _ => kernel.closest(bvh, rays.len(), rays, |_, _| ()),
        }
    }
    match kernel {
        "many" => return batch(Many::new(), bvh, rays, query),
        "stream" => return batch(Streams::new(), bvh, rays, query),
        "tile" => return batch(Tiles::new(), bvh, rays, query),
        _ => {}
    }
    let (mut single, mut scalar) = (Single::new(bvh), Scalar::new(bvh));
    for r in rays {
        let ray = Ray { origin: r.origin, direction: r.direction, t_max: r.t_max };
        let _ = match (kernel, query) {
            ("single", Query::Any) => single.any(bvh, &ray),
            ("single", _) => single.closest(bvh, &ray).is_some(),
            (_, Query::Any) => scalar.any(bvh, &ray),
            _ => scalar.closest(bvh, &ray).is_some(),
        };
    }
}

/// Triangles of a room, how its tree is built, and what the kernels visit: nodes and leaves for each set of rays.
fn table() -> String {
    let rooms = [
        (36, Quality::Balanced, 8),
        (2_000, Quality::Fast, 8),
        (2_000, Quality::Balanced, 8),
        (2_000, Quality::Best, 8),
        (2_000, Quality::Balanced, 1),
        (50_000, Quality::Balanced, 8),
    ];
    let mut lines = Vec::new();
    for (triangles, quality, leaf) in rooms {
        let corners = super::mesh::corners(&room(triangles, 1));
        let bvh = Bvh::build_with(&corners, &BuildOptions { quality, leaf, threads: 1 }).unwrap();
        let (nodes, leaves) = bvh.counts();
        lines.push(format!("{triangles} triangles, {quality:?}, leaves of {leaf}: {nodes} nodes, {leaves} leaves"));
        let tracer = Tracer { bvh: &bvh, kernel: Kernel::Single, threads: 1 };
        let options = Options { res: 64, ..Options::default() };
        let kinds = [SetKind::Primary, SetKind::Shadow, SetKind::Shuffled];
        let (sets, _) = make(&corners, &tracer, &options, &kinds).unwrap();
        for RaySet { kind, rays } in &sets {
            let mut line = format!("{} {}:", rays.len(), kind.name());
            for kernel in ["scalar", "single", "many", "stream", "tile"] {
                let [nodes, leaves] = visits(|| trace(kernel, &bvh, rays, kind.query()));
                line += &format!(" {kernel} {nodes} {leaves}");
            }
            lines.push(line);
        }
    }
    lines.join("\n")
}

const ACCEPTED: &str = "\
36 triangles, Balanced, leaves of 8: 3 nodes, 22 leaves
4096 primary: scalar 5103 4869 single 5103 4969 many 5103 4969 stream 144 104 tile 1614 1498
4096 shadow: scalar 4837 1044 single 4837 1048 many 4837 1048 stream 108 77 tile 517 186
4096 shuffled: scalar 5276 5068 single 5276 5139 many 5276 5139 stream 482 390 tile 482 390
2000 triangles, Fast, leaves of 8: 86 nodes, 496 leaves
4096 primary: scalar 27128 5114 single 27292 5157 many 27400 5166 stream 1348 643 tile 7522 1926
4096 shadow: scalar 19780 2911 single 19788 2929 many 19788 2929 stream 1260 507 tile 2417 886
4096 shuffled: scalar 22584 6785 single 22662 6786 many 22833 6793 stream 7007 4259 tile 7007 4259
2000 triangles, Balanced, leaves of 8: 79 nodes, 480 leaves
4096 primary: scalar 24278 5097 single 24304 5145 many 24527 5197 stream 1317 627 tile 7209 1853
4096 shadow: scalar 18179 2940 single 18374 2957 many 18374 2957 stream 1129 519 tile 2136 884
4096 shuffled: scalar 21722 6784 single 21723 6761 many 21898 6783 stream 6738 4155 tile 6738 4155
2000 triangles, Best, leaves of 8: 81 nodes, 497 leaves
4096 primary: scalar 25740 5094 single 25839 5103 many 25998 5159 stream 1282 623 tile 7455 1840
4096 shadow: scalar 18757 2834 single 19033 2885 many 19033 2885 stream 1224 513 tile 2253 842
4096 shuffled: scalar 21785 6659 single 21813 6672 many 21944 6689 stream 6864 4078 tile 6864 4078
2000 triangles, Balanced, leaves of 1: 397 nodes, 2002 leaves
4096 primary: scalar 28524 9477 single 28627 9589 many 29063 9590 stream 3345 2602 tile 10842 4641
4096 shadow: scalar 20817 5092 single 21015 5126 many 21015 5126 stream 2629 1862 tile 6265 3203
4096 shuffled: scalar 27887 12542 single 27838 12434 many 28106 12434 stream 12550 10422 tile 12550 10422
50000 triangles, Balanced, leaves of 8: 1904 nodes, 12678 leaves
4096 primary: scalar 35699 6029 single 35749 6057 many 36094 6059 stream 6737 3898 tile 24023 6512
4096 shadow: scalar 27243 3771 single 27285 3804 many 27285 3804 stream 27285 3804 tile 27718 4669
4096 shuffled: scalar 35487 8205 single 35508 8227 many 35743 8229 stream 20644 8121 tile 20644 8121";

#[test]
fn what_is_visited_is_what_was_accepted() {
    // Others round otherwise, and may enter another box.
    if simd() != "avx2+fma" || cfg!(not(target_os = "linux")) {
        return;
    }
    let found = table();
    assert!(found == ACCEPTED, "visited:\n{found}\n\naccepted:\n{ACCEPTED}");
}
