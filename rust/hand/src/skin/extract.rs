//! Marching tetrahedra on the blocks of a grid that the skin crosses; closed and manifold by construction.

use super::soup::Soup;
use crate::flesh::{Flesh, MAX_SLOPE, MAX_STEP};
use rayon::prelude::*;
use std::collections::BTreeSet;
use thenar_surface::Vec3;

/// Cells along one side of a block, and blocks along one side of a super-block.
const BLOCK: usize = 4;
const SUPER: usize = 4;
/// Grid points along one side of a block.
const WIDE: usize = BLOCK + 1;
/// Crossings keep this share of an edge from its ends, so that no two fall together.
const END_SHARE: f64 = 0.03;

/// The six tetrahedra of a cell around its main diagonal; corners as bits x, y, z; all positively oriented.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 3, 2, 7],
    [0, 2, 6, 7],
    [0, 6, 4, 7],
    [0, 4, 5, 7],
    [0, 5, 1, 7],
];

struct Grid {
    origin: Vec3,
    step: f64,
    blocks: [usize; 3],
}

/// A crossing of a grid edge: the edge's key and where on it the skin lies.
#[derive(Clone, Copy)]
struct Crossing {
    key: u64,
    at: Vec3,
}

/// The skin at a grid step of `step` mm.
pub(crate) fn extract(flesh: &Flesh, step: f64) -> Soup {
    let grid = grid(flesh, step);
    let near: Vec<[usize; 3]> = super_blocks(&grid)
        .into_par_iter()
        .flat_map_iter(|b| near_blocks(flesh, &grid, b))
        .collect();
    weld(&follow(flesh, &grid, near))
}

/// Faces of the skin in the blocks of `front` and in every block it runs on into.
///
/// The field is no true distance: on the axis of a fingertip it reads the length of the cap (6 mm) where the skin beside it is half as far, so a
/// block that the skin grazes at a corner is taken for empty if its middle falls there. A block is therefore added whenever the grid points on the
/// side it shares with a marched one are not all inside or all outside.
fn follow(flesh: &Flesh, grid: &Grid, mut front: Vec<[usize; 3]>) -> Vec<[Crossing; 3]> {
    let mut known: BTreeSet<[usize; 3]> = front.iter().copied().collect();
    let mut faces = Vec::new();
    while !front.is_empty() {
        let marched: Vec<Marched> = front
            .into_par_iter()
            .map(|block| march(flesh, grid, block))
            .collect();
        front = Vec::new();
        for one in marched {
            faces.extend(one.faces);
            front.extend(one.onward.into_iter().filter(|&block| known.insert(block)));
        }
    }
    faces
}

fn grid(flesh: &Flesh, step: f64) -> Grid {
    let (low, high) = flesh.bounds();
    let side = step * BLOCK as f64;
    let blocks = [0, 1, 2].map(|i| ((high[i] - low[i]) / side).ceil() as usize);
    Grid {
        origin: low,
        step,
        blocks,
    }
}

fn super_blocks(grid: &Grid) -> Vec<[usize; 3]> {
    let count = grid.blocks.map(|n| n.div_ceil(SUPER));
    let mut all = Vec::with_capacity(count.iter().product());
    for i in 0..count[0] {
        for j in 0..count[1] {
            for k in 0..count[2] {
                all.push([i, j, k]);
            }
        }
    }
    all
}

/// True if the skin may cross the cube of `cells` cells whose lowest corner is the grid point `corner`.
fn may_cross(flesh: &Flesh, grid: &Grid, corner: [usize; 3], cells: usize) -> bool {
    let half = 0.5 * grid.step * cells as f64;
    let center = grid.point(corner) + Vec3::repeat(half);
    flesh.value(center).abs() <= MAX_SLOPE * half * 3.0_f64.sqrt() + MAX_STEP
}

fn near_blocks(flesh: &Flesh, grid: &Grid, super_block: [usize; 3]) -> Vec<[usize; 3]> {
    let mut near = Vec::new();
    if !may_cross(
        flesh,
        grid,
        super_block.map(|n| n * SUPER * BLOCK),
        SUPER * BLOCK,
    ) {
        return near;
    }
    for n in 0..SUPER * SUPER * SUPER {
        let inner = [n / (SUPER * SUPER), n / SUPER % SUPER, n % SUPER];
        let block: [usize; 3] = std::array::from_fn(|i| super_block[i] * SUPER + inner[i]);
        if (0..3).all(|i| block[i] < grid.blocks[i])
            && may_cross(flesh, grid, block.map(|n| n * BLOCK), BLOCK)
        {
            near.push(block);
        }
    }
    near
}

impl Grid {
    fn point(&self, index: [usize; 3]) -> Vec3 {
        self.origin + Vec3::new(index[0] as f64, index[1] as f64, index[2] as f64) * self.step
    }

    fn key(&self, index: [usize; 3]) -> u64 {
        let wide = self.blocks.map(|n| (n * BLOCK + 1) as u64);
        (index[0] as u64 * wide[1] + index[1] as u64) * wide[2] + index[2] as u64
    }
}

/// The skin inside one block, and the neighbours it runs on into.
struct Marched {
    faces: Vec<[Crossing; 3]>,
    onward: Vec<[usize; 3]>,
}

fn march(flesh: &Flesh, grid: &Grid, block: [usize; 3]) -> Marched {
    let corner = block.map(|n| n * BLOCK);
    let shift = |i: usize, j: usize, k: usize| [corner[0] + i, corner[1] + j, corner[2] + k];
    let mut values = [0.0; WIDE * WIDE * WIDE];
    for (n, value) in values.iter_mut().enumerate() {
        *value = flesh.value(grid.point(shift(n / (WIDE * WIDE), n / WIDE % WIDE, n % WIDE)));
    }
    let mut faces = Vec::new();
    for n in 0..BLOCK * BLOCK * BLOCK {
        let cell = [n / (BLOCK * BLOCK), n / BLOCK % BLOCK, n % BLOCK];
        let corners: [([usize; 3], f64); 8] = std::array::from_fn(|c| {
            let [i, j, k] = [
                cell[0] + (c & 1),
                cell[1] + (c >> 1 & 1),
                cell[2] + (c >> 2 & 1),
            ];
            (shift(i, j, k), values[(i * WIDE + j) * WIDE + k])
        });
        let inside = corners.iter().filter(|corner| corner.1 < 0.0).count();
        if inside > 0 && inside < 8 {
            TETRAHEDRA
                .iter()
                .for_each(|t| cut_tetrahedron(grid, t.map(|c| corners[c]), &mut faces));
        }
    }
    Marched {
        faces,
        onward: onward(grid, block, &values),
    }
}

/// Neighbours of a block across those of its sides whose grid points lie partly inside and partly outside the flesh.
fn onward(grid: &Grid, block: [usize; 3], values: &[f64]) -> Vec<[usize; 3]> {
    let mut neighbors = Vec::new();
    for (axis, end) in (0..6).map(|n| (n / 2, n % 2)) {
        let side = (0..WIDE * WIDE).map(|n| {
            let mut at = [end * BLOCK; 3];
            at[(axis + 1) % 3] = n / WIDE;
            at[(axis + 2) % 3] = n % WIDE;
            values[(at[0] * WIDE + at[1]) * WIDE + at[2]] < 0.0
        });
        let inside = side.filter(|&is_inside| is_inside).count();
        let mut neighbor = block.map(|n| n as isize);
        neighbor[axis] += 2 * end as isize - 1;
        let is_in_grid = (0..3).all(|i| (0..grid.blocks[i] as isize).contains(&neighbor[i]));
        if is_in_grid && inside > 0 && inside < WIDE * WIDE {
            neighbors.push(neighbor.map(|n| n as usize));
        }
    }
    neighbors
}

/// Triangles of the skin inside one positively oriented tetrahedron, facing out of the flesh.
fn cut_tetrahedron(
    grid: &Grid,
    mut corners: [([usize; 3], f64); 4],
    faces: &mut Vec<[Crossing; 3]>,
) {
    let inside = corners.iter().filter(|c| c.1 < 0.0).count();
    // Bubble the inside corners to the front and count the swaps: an odd count mirrors the tetrahedron.
    let mut swaps = 0;
    for _ in 0..3 {
        for k in 0..3 {
            if corners[k].1 >= 0.0 && corners[k + 1].1 < 0.0 {
                corners.swap(k, k + 1);
                swaps += 1;
            }
        }
    }
    let cross = |a: usize, b: usize| grid.crossing(corners[a], corners[b]);
    let mut emit = |face: [Crossing; 3]| {
        faces.push(if swaps % 2 == 0 {
            face
        } else {
            [face[0], face[2], face[1]]
        })
    };
    match inside {
        1 => emit([cross(0, 1), cross(0, 2), cross(0, 3)]),
        2 => {
            emit([cross(0, 2), cross(0, 3), cross(1, 3)]);
            emit([cross(0, 2), cross(1, 3), cross(1, 2)]);
        }
        3 => emit([cross(3, 0), cross(3, 1), cross(3, 2)]),
        _ => {}
    }
}

impl Grid {
    fn crossing(&self, a: ([usize; 3], f64), b: ([usize; 3], f64)) -> Crossing {
        let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
        let direction = (0..3).map(|i| (b.0[i] - a.0[i]) << i).sum::<usize>() as u64;
        let t = (a.1 / (a.1 - b.1)).clamp(END_SHARE, 1.0 - END_SHARE);
        let at = self.point(a.0) * (1.0 - t) + self.point(b.0) * t;
        Crossing {
            key: self.key(a.0) * 8 + direction,
            at,
        }
    }
}

fn weld(faces: &[[Crossing; 3]]) -> Soup {
    let mut crossings: Vec<Crossing> = faces.iter().flatten().copied().collect();
    crossings.sort_unstable_by_key(|c| c.key);
    crossings.dedup_by_key(|c| c.key);
    let index = |c: &Crossing| crossings.partition_point(|other| other.key < c.key) as u32;
    let triangles = faces
        .iter()
        .map(|face| [index(&face[0]), index(&face[1]), index(&face[2])])
        .collect();
    Soup {
        positions: crossings.iter().map(|c| c.at).collect(),
        triangles,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::Skeleton;
    use crate::skin::topology::Topology;

    #[test]
    fn nothing_is_skipped() {
        let flesh = Flesh::new(&Skeleton::new(189.0, 87.0));
        let step = 2.6;
        let skipped = extract(&flesh, step);
        let grid = grid(&flesh, step);
        let mut faces = Vec::new();
        for n in 0..grid.blocks.iter().product() {
            let [_, wide, deep] = grid.blocks;
            let block = [n / (wide * deep), n / deep % wide, n % deep];
            faces.extend(march(&flesh, &grid, block).faces);
        }
        let full = weld(&faces);
        assert_eq!(skipped.positions, full.positions);
        assert_eq!(skipped.triangles.len(), full.triangles.len());
    }

    /// The middle of one block lies on the axis of the little finger's tip, where the field reads -6.2 mm; the skin is 3.4 mm away and grazes it.
    #[test]
    fn a_fingertip_that_grazes_a_block_leaves_no_hole() {
        let flesh = Flesh::new(&Skeleton::new(167.25599395728915, 76.12799697864457));
        let step = 0.5 * 2.3001469187093293;
        let grid = grid(&flesh, step);
        let seeds = super_blocks(&grid)
            .into_iter()
            .flat_map(|b| near_blocks(&flesh, &grid, b));
        let faces: Vec<[Crossing; 3]> = seeds.flat_map(|b| march(&flesh, &grid, b).faces).collect();
        assert!(
            Topology::new(weld(&faces)).is_none(),
            "the seeds alone close the skin; this person no longer shows the fault"
        );
        assert!(Topology::new(extract(&flesh, step)).is_some());
    }

    #[test]
    fn one_block_of_the_skin_leads_to_all_of_it() {
        let flesh = Flesh::new(&Skeleton::new(189.0, 87.0));
        let grid = grid(&flesh, 2.6);
        let seed = super_blocks(&grid)
            .into_iter()
            .flat_map(|b| near_blocks(&flesh, &grid, b))
            .find(|&b| !march(&flesh, &grid, b).faces.is_empty())
            .expect("a block that the skin crosses");
        let followed = weld(&follow(&flesh, &grid, vec![seed]));
        assert_eq!(followed.positions, extract(&flesh, 2.6).positions);
    }

    #[test]
    fn the_raw_skin_is_closed() {
        let flesh = Flesh::new(&Skeleton::new(159.0, 69.0));
        assert!(Topology::new(extract(&flesh, 1.3)).is_some());
    }

    #[test]
    fn a_soup_with_a_hole_is_refused() {
        let flesh = Flesh::new(&Skeleton::new(189.0, 87.0));
        let mut soup = extract(&flesh, 3.0);
        soup.triangles.pop();
        assert!(Topology::new(soup).is_none());
    }
}
