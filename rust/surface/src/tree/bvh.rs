//! The bounding-volume tree of a product: obvhs pairs the triangles, eight padded f32 boxes a node cull, faces in f64 answer.
//! The only file that knows obvhs and glam.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ploc::{PlocSearchDistance, SortPrecision};
use obvhs::{Boundable, BvhBuildParams};

use crate::mesh::triangles::Vec3;
use crate::tree::face::{Face, WIDTH};
use crate::tree::leaf::Leaf;

/// Part of the product's extent by which boxes are padded: rounding of a box and of a query within three extents to f32 stays below it.
const PADDING: f32 = 1e-6;

/// Triangles in a leaf, at most: as many as are bounded at a time.
const LEAF: u32 = WIDTH as u32;

/// Eight boxes, each over a leaf or another node, in f32 and in parts of the product's extent.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Node {
    pub low: [[f32; WIDTH]; 3],
    pub high: [[f32; WIDTH]; 3],
    /// What each box holds, packed as [`Child`] reads it.
    pub child: [u32; WIDTH],
    /// How many of the eight are used.
    pub used: u8,
}

/// What a box holds.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Child {
    /// Index of a node.
    Node(usize),
    /// Index of a leaf.
    Leaf(usize),
}

impl Child {
    const LEAF_BIT: u32 = 1 << 31;

    /// Unpacks: the highest bit tells a leaf.
    #[inline(always)]
    pub(crate) fn of(packed: u32) -> Child {
        match packed & Child::LEAF_BIT {
            0 => Child::Node(packed as usize),
            _ => Child::Leaf((packed ^ Child::LEAF_BIT) as usize),
        }
    }
}

/// A triangle to build the tree over.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Source {
    /// Index in the mesh.
    pub id: u32,
    /// Corners, mm.
    pub corners: [Vec3; 3],
    pub is_sheet: bool,
    /// Of a piece of a triangle, the whole triangle's unit normal: that of a thin piece has few digits.
    pub piece_of: Option<Vec3>,
}

/// Faces in the order of the tree's leaves, and boxes over them.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    /// Middle of the bounding box, mm; all coordinates inside are about it, so that far products keep their digits.
    pub center: Vec3,
    /// One over the largest extent, 1/mm.
    pub shrink: f64,
    pub nodes: Vec<Node>,
    pub leaves: Vec<Leaf>,
    pub faces: Vec<Face>,
    /// Where each triangle of the mesh went; `u32::MAX` where it has no area.
    pub slots: Vec<u32>,
}

/// A query: the point about the tree's center, and its box coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Query {
    pub point: Vec3,
    pub boxed: [f32; 3],
    /// A face to begin with, which only saves time.
    pub start: Option<u32>,
}

impl Tree {
    /// The faces of a leaf, the first of them at index `first`.
    pub(crate) fn leaf_faces(&self, leaf: usize) -> (usize, &[Face]) {
        let (first, count) = (
            self.leaves[leaf].first as usize,
            self.leaves[leaf].count as usize,
        );
        (first, &self.faces[first..first + count])
    }

    /// Builds the tree over the triangles (id, corners in mm) of a mesh of `triangles` triangles; at least one must be given.
    pub(crate) fn new(sound: &[Source], triangles: usize) -> Tree {
        let corners = || sound.iter().flat_map(|s| s.corners.iter());
        let low = corners().fold(Vec3::repeat(f64::INFINITY), |m, p| m.inf(p));
        let high = corners().fold(Vec3::repeat(f64::NEG_INFINITY), |m, p| m.sup(p));
        let (center, shrink) = ((low + high) / 2.0, 1.0 / (high - low).amax());
        let boxes: Vec<Aabb> = sound
            .iter()
            .map(|s| padded(&s.corners, &center, shrink))
            .collect();
        let bvh = build_bvh2(&boxes, build_params(), &mut std::time::Duration::default());
        let mut tree = Tree {
            center,
            shrink,
            nodes: Vec::new(),
            leaves: Vec::new(),
            faces: Vec::with_capacity(sound.len()),
            slots: vec![u32::MAX; triangles],
        };
        tree.widen(&bvh, sound);
        tree
    }

    /// Prepares a point, mm in the product's space.
    pub(crate) fn query(&self, point: Vec3) -> Query {
        self.local_query(point - self.center)
    }

    /// Prepares a point about the tree's center.
    pub(crate) fn local_query(&self, point: Vec3) -> Query {
        let boxed = point * self.shrink;
        Query {
            point,
            boxed: [boxed.x as f32, boxed.y as f32, boxed.z as f32],
            start: None,
        }
    }

    /// A squared distance, mm2, as a bound for squared box distances, rounded up.
    pub(crate) fn box_bound(&self, squared: f64) -> f32 {
        (squared * self.shrink * self.shrink * 1.000_01) as f32 + f32::MIN_POSITIVE
    }

    /// Folds the binary tree into nodes of eight, parents first, and lines the faces up under them.
    fn widen(&mut self, bvh: &Bvh2, sound: &[Source]) {
        let mut pending = vec![(0usize, None)];
        while let Some((from, slot)) = pending.pop() {
            let at = self.nodes.len();
            if let Some((parent, lane)) = slot {
                let parent: &mut Node = &mut self.nodes[parent];
                parent.child[lane] = at as u32;
            }
            let members = eight_below(bvh, from);
            let mut node = Node::empty();
            for (lane, &member) in members.iter().enumerate() {
                let below = &bvh.nodes[member];
                node.set_box(lane, below.aabb());
                if below.is_leaf() {
                    node.child[lane] = Child::LEAF_BIT | self.leaves.len() as u32;
                    let first = self.faces.len();
                    let range =
                        below.first_index as usize..(below.first_index + below.prim_count) as usize;
                    bvh.primitive_indices[range]
                        .iter()
                        .for_each(|&i| self.add_face(&sound[i as usize]));
                    self.leaves
                        .push(Leaf::new(&self.faces[first..], first, self.shrink));
                } else {
                    pending.push((member, Some((at, lane))));
                }
            }
            node.used = members.len() as u8;
            self.nodes.push(node);
        }
    }

    fn add_face(
        &mut self,
        &Source {
            id,
            corners,
            is_sheet,
            piece_of,
        }: &Source,
    ) {
        let [a, b, c] = corners.map(|p| p - self.center);
        let (ab, ac) = (b - a, c - a);
        self.slots[id as usize] = self.faces.len() as u32;
        self.faces.push(Face {
            a,
            ab,
            ac,
            normal: piece_of.unwrap_or_else(|| ab.cross(&ac).normalize()),
            id,
            is_sheet,
            is_piece: piece_of.is_some(),
        });
    }
}

impl Node {
    fn empty() -> Node {
        let (low, high) = ([[f32::INFINITY; WIDTH]; 3], [[f32::NEG_INFINITY; WIDTH]; 3]);
        Node {
            low,
            high,
            child: [0; WIDTH],
            used: 0,
        }
    }

    fn set_box(&mut self, lane: usize, b: &Aabb) {
        for axis in 0..3 {
            self.low[axis][lane] = b.min[axis];
            self.high[axis][lane] = b.max[axis];
        }
    }

    /// Squared distance of a query to each of the eight boxes, in parts of the extent; unused ones give infinity.
    #[inline(always)]
    pub(crate) fn box_distances(&self, p: &[f32; 3]) -> [f32; WIDTH] {
        let mut squared = [0f32; WIDTH];
        for axis in 0..3 {
            for lane in 0..WIDTH {
                let (below, above) = (
                    self.low[axis][lane] - p[axis],
                    p[axis] - self.high[axis][lane],
                );
                let outside = if below > above { below } else { above };
                let outside = if outside > 0.0 { outside } else { 0.0 };
                squared[lane] += outside * outside;
            }
        }
        squared
    }
}

/// Up to eight nodes of the binary tree below `from`, opened by surface, largest first.
fn eight_below(bvh: &Bvh2, from: usize) -> Vec<usize> {
    let mut members = vec![from];
    while members.len() < WIDTH {
        let area = |i: &usize| bvh.nodes[*i].aabb().half_area();
        let open = members
            .iter()
            .enumerate()
            .filter(|(_, i)| !bvh.nodes[**i].is_leaf());
        let Some((lane, &inner)) = open.max_by(|a, b| area(a.1).total_cmp(&area(b.1))) else {
            break;
        };
        let first = bvh.nodes[inner].first_index as usize;
        members[lane] = first;
        members.push(first + 1);
    }
    members
}

fn padded(corners: &[Vec3; 3], center: &Vec3, shrink: f64) -> Aabb {
    let small = corners.map(|p| (p - center) * shrink);
    let mut b = Aabb::INVALID;
    for p in small {
        b.extend(Vec3A::new(p.x as f32, p.y as f32, p.z as f32));
    }
    Aabb::new(b.min - PADDING, b.max + PADDING).aabb()
}

fn build_params() -> BvhBuildParams {
    BvhBuildParams {
        pre_split: false,
        ploc_search_distance: PlocSearchDistance::Low,
        search_depth_threshold: 2,
        reinsertion_batch_ratio: 0.02,
        post_collapse_reinsertion_batch_ratio_multiplier: 0.0,
        sort_precision: SortPrecision::U64,
        max_prims_per_leaf: LEAF,
        collapse_traversal_cost: 3.0,
    }
}
