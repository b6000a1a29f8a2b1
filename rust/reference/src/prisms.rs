//! Prisms extruded from skin triangles to bone: nodes, elements, shape functions at the integration points.

use std::collections::{BTreeMap, BTreeSet};

use thenar_surface::Vec3;

use crate::matrix3;
use crate::{ReferenceError, Tissue};

/// Nodes of a prism: three toward the bone, three above them.
pub const NODES: usize = 6;
/// Integration points of a prism: three in its plane, two across.
pub const POINTS: usize = 6;
/// Offset of the two points of Gauss across a prism, of 1.
const ACROSS: f64 = 0.577_350_269_189_625_8;
/// In-plane points of the triangle, area coordinates of the second and third corner (degree 2).
const IN_PLANE: [[f64; 2]; 3] = [
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
];

/// Smallest volume of a point over the largest of its prism: below it the columns nearly cross.
const LEAST_SHARE: f64 = 0.05;

/// Undeformed shape of a prism.
#[derive(Debug, Clone)]
pub struct Prism {
    /// Nodes: toward the bone, then above.
    pub nodes: [u32; NODES],
    /// Gradient of every node's shape function at every integration point, 1/mm.
    pub gradients: [[[f64; 3]; NODES]; POINTS],
    /// Volume of every integration point, mm3.
    pub weights: [f64; POINTS],
    /// Sum of those.
    pub volume: f64,
    /// Shear modulus, MPa.
    pub shear_modulus: f64,
    /// Exponent b of the stiffening.
    pub stiffening: f64,
}

/// Nodes of a group.
pub const GROUP_NODES: usize = 8;

/// Two prisms with a common side, or one without a partner: they share one mean dilatation. With one for every prism there would be two for
/// every node, and tissue that keeps its volume would lock.
#[derive(Debug, Clone, Copy)]
pub struct Group {
    /// Indices of the prisms; the second is `None` where the first stands alone.
    pub prisms: (u32, Option<u32>),
    /// Nodes of both, each once; `u32::MAX` where there are fewer.
    pub nodes: [u32; GROUP_NODES],
    /// For the nodes of each prism: their places in `nodes`.
    pub places: [[u8; NODES]; 2],
}

impl Group {
    fn new(prisms: &[Prism], first: u32, second: Option<u32>) -> Group {
        let mut nodes = [u32::MAX; GROUP_NODES];
        let mut places = [[0; NODES]; 2];
        let mut count = 0;
        for (prism, places) in std::iter::once(first).chain(second).zip(&mut places) {
            for (node, place) in prisms[prism as usize].nodes.iter().zip(places) {
                let at = nodes[..count]
                    .iter()
                    .position(|known| known == node)
                    .unwrap_or_else(|| {
                        nodes[count] = *node;
                        count += 1;
                        count - 1
                    });
                *place = at as u8;
            }
        }
        Group {
            prisms: (first, second),
            nodes,
            places,
        }
    }
}

/// Soft tissue as a mesh of prisms.
#[derive(Debug)]
pub struct PrismMesh {
    /// Nodes, layer by layer from bone to skin, mm.
    pub nodes: Vec<Vec3>,
    pub prisms: Vec<Prism>,
    pub groups: Vec<Group>,
    /// Skin vertices.
    pub skin_count: usize,
    /// Index of every node among those that move; `u32::MAX` for the others.
    pub free: Vec<u32>,
    pub free_count: usize,
    /// Skin vertices at whose triangles a prism is missing: its columns cross, as in a crease.
    pub folded: Vec<u32>,
}

impl PrismMesh {
    /// Extrudes the skin to its bone in `layers` layers.
    ///
    /// A prism whose columns cross has no volume and is left out; a node at which no prism is left does not move.
    ///
    /// # Errors
    /// [`ReferenceError::Tissue`] where nothing is left that could move.
    pub fn new(tissue: &Tissue, layers: usize) -> Result<PrismMesh, ReferenceError> {
        let n = tissue.skin.len();
        let level = |l: usize| {
            let t = l as f64 / layers as f64;
            let columns = tissue.bone.iter().zip(&tissue.skin);
            columns.map(move |(bone, skin)| bone * (1.0 - t) + skin * t)
        };
        let nodes: Vec<Vec3> = (0..=layers).flat_map(level).collect();
        let mut prisms = Vec::with_capacity(layers * tissue.triangles.len());
        let mut is_folded = vec![false; n];
        let mut is_used = vec![false; nodes.len()];
        for triangle in &tissue.triangles {
            let corners = triangle.map(|v| v as usize);
            let mean = |of: &[f64]| corners.map(|v| of[v]).iter().sum::<f64>() / 3.0;
            let law = (mean(&tissue.shear_modulus_mpa), mean(&tissue.stiffening));
            for layer in 0..layers {
                match Prism::new(&nodes, corners.map(|v| v + layer * n), n, law) {
                    Some(prism) => {
                        prism.nodes.iter().for_each(|k| is_used[*k as usize] = true);
                        prisms.push(prism);
                    }
                    None => corners.iter().for_each(|v| is_folded[*v] = true),
                }
            }
        }
        let mut free = vec![u32::MAX; nodes.len()];
        let mut free_count = 0;
        // A column's nodes follow each other: the matrix gets dense blocks.
        for v in (0..n).filter(|v| !tissue.is_held[*v]) {
            for node in (1..=layers)
                .map(|layer| v + layer * n)
                .filter(|node| is_used[*node])
            {
                free[node] = free_count;
                free_count += 1;
            }
        }
        prisms.retain(|prism| prism.nodes.iter().any(|k| free[*k as usize] != u32::MAX));
        if free_count == 0 {
            return Err(ReferenceError::Tissue {
                what: "tissue".to_owned(),
                found: "no skin vertex that can move".to_owned(),
                remedy: "hold fewer vertices, or put the bone under the skin: below every vertex, against its normal; triangles are turned outward",
            });
        }
        Ok(PrismMesh {
            nodes,
            groups: groups(&prisms),
            prisms,
            skin_count: n,
            free,
            free_count: free_count as usize,
            folded: (0..n as u32).filter(|v| is_folded[*v as usize]).collect(),
        })
    }

    /// Node of a skin vertex.
    pub fn skin_node(&self, vertex: usize) -> usize {
        self.nodes.len() - self.skin_count + vertex
    }
}

/// Pairs prisms of one layer across a common side; what finds no partner stands alone.
fn groups(prisms: &[Prism]) -> Vec<Group> {
    let neighbors = neighbors(prisms);
    let mut degree: Vec<usize> = neighbors.iter().map(Vec::len).collect();
    // Those with few partners to choose from are paired first, so that few are left alone.
    let mut waiting: BTreeSet<(usize, u32)> = degree.iter().copied().zip(0..).collect();
    let mut groups = Vec::with_capacity(prisms.len() / 2 + 1);
    while let Some((_, first)) = waiting.pop_first() {
        leave(first, &neighbors, &mut degree, &mut waiting);
        let free = |other: &&u32| waiting.contains(&(degree[**other as usize], **other));
        let choices = neighbors[first as usize].iter().filter(free);
        let second = choices
            .min_by_key(|other| (degree[**other as usize], **other))
            .copied();
        if let Some(second) = second {
            waiting.remove(&(degree[second as usize], second));
            leave(second, &neighbors, &mut degree, &mut waiting);
        }
        groups.push(Group::new(prisms, first, second));
    }
    groups
}

/// One choice fewer for the neighbors of a prism that is taken.
fn leave(
    taken: u32,
    neighbors: &[Vec<u32>],
    degree: &mut [usize],
    waiting: &mut BTreeSet<(usize, u32)>,
) {
    for other in &neighbors[taken as usize] {
        let of = &mut degree[*other as usize];
        let is_waiting = waiting.remove(&(*of, *other));
        *of = of.saturating_sub(1);
        if is_waiting {
            waiting.insert((*of, *other));
        }
    }
}

/// Prisms of the same layer that have a side in common with each.
fn neighbors(prisms: &[Prism]) -> Vec<Vec<u32>> {
    let sides = |prism: &Prism| {
        let nodes = prism.nodes;
        (0..3).map(move |k| {
            let (a, b) = (nodes[k], nodes[(k + 1) % 3]);
            [a.min(b), a.max(b)]
        })
    };
    let mut by_side: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for (index, prism) in (0..).zip(prisms) {
        for side in sides(prism) {
            by_side.entry(side).or_default().push(index);
        }
    }
    let of = |(index, prism)| {
        let beyond = sides(prism).flat_map(|side| by_side[&side].iter().copied());
        beyond.filter(move |other| *other != index).collect()
    };
    (0..).zip(prisms).map(of).collect()
}

impl Prism {
    /// `None` where the prism has no volume at one of its points.
    fn new(
        nodes: &[Vec3],
        low: [usize; 3],
        step: usize,
        (shear_modulus, stiffening): (f64, f64),
    ) -> Option<Prism> {
        let numbers = [
            low[0],
            low[1],
            low[2],
            low[0] + step,
            low[1] + step,
            low[2] + step,
        ];
        let corners = numbers.map(|k| nodes[k]);
        let mut prism = Prism {
            nodes: numbers.map(|k| k as u32),
            gradients: [[[0.0; 3]; NODES]; POINTS],
            weights: [0.0; POINTS],
            volume: 0.0,
            shear_modulus,
            stiffening,
        };
        let points = IN_PLANE
            .iter()
            .flat_map(|plane| [-ACROSS, ACROSS].map(|height| (*plane, height)));
        for (g, (plane, height)) in points.enumerate() {
            let local = local_gradients(plane, height);
            let mut jacobian = [[0.0; 3]; 3];
            for (corner, gradient) in corners.iter().zip(&local) {
                for (i, row) in jacobian.iter_mut().enumerate() {
                    for (j, value) in row.iter_mut().enumerate() {
                        *value += corner[i] * gradient[j];
                    }
                }
            }
            let (inverse, determinant) = matrix3::inverse(&jacobian);
            if determinant <= 1e-9 {
                return None;
            }
            prism.weights[g] = determinant / 6.0;
            for (out, gradient) in prism.gradients[g].iter_mut().zip(&local) {
                for (j, value) in out.iter_mut().enumerate() {
                    *value = (0..3).map(|k| gradient[k] * inverse[k][j]).sum();
                }
            }
        }
        prism.volume = prism.weights.iter().sum();
        let (least, most) = prism
            .weights
            .iter()
            .fold((f64::INFINITY, 0.0), |(l, m), w| {
                (f64::min(l, *w), f64::max(m, *w))
            });
        (least > LEAST_SHARE * most).then_some(prism)
    }
}

/// Gradients of the six shape functions in the prism's own coordinates (two of the triangle, one from -1 to 1 across).
fn local_gradients([second, third]: [f64; 2], height: f64) -> [[f64; 3]; NODES] {
    const CORNER: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let share = [1.0 - second - third, second, third];
    std::array::from_fn(|k| {
        let (corner, sign) = (k % 3, if k < 3 { -1.0 } else { 1.0 });
        let across = (1.0 + sign * height) / 2.0;
        [
            CORNER[corner][0] * across,
            CORNER[corner][1] * across,
            share[corner] * sign / 2.0,
        ]
    })
}
