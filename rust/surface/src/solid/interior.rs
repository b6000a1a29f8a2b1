//! A coarse grid that knows inside from outside away from the surface, so that points beyond the cut-off need no search.

use crate::mesh::triangles::Vec3;
use crate::tree::bvh::Tree;
use crate::tree::face::Face;

/// Cells along the longest side of the product's box. 16 to 64 work; more costs preparation, fewer leaves more points to the tree.
const CELLS: usize = 32;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    Unknown,
    /// May hold a piece of the surface.
    Surface,
    Outside,
    Inside,
}

/// What is known of a place without a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    Outside,
    Inside,
    NearSurface,
}

/// Cells over the product's box, about the tree's center.
#[derive(Debug, Clone)]
pub(crate) struct Interior {
    low: Vec3,
    size: f64,
    counts: [usize; 3],
    cells: Vec<Cell>,
}

impl Interior {
    /// Marks the cells of a closed product; `is_inside` answers for a point about the tree's center and is asked once for each connected room.
    pub(crate) fn new(tree: &Tree, mut is_inside: impl FnMut(Vec3) -> bool) -> Interior {
        let corners = || {
            tree.faces
                .iter()
                .flat_map(|f| [f.a, f.a + f.ab, f.a + f.ac])
        };
        let low = corners().fold(Vec3::repeat(f64::INFINITY), |m, p| m.inf(&p));
        let high = corners().fold(Vec3::repeat(f64::NEG_INFINITY), |m, p| m.sup(&p));
        let size = (high - low).amax() / CELLS as f64;
        let counts =
            [0, 1, 2].map(|k| ((high[k] - low[k]) / size).ceil().clamp(1.0, CELLS as f64) as usize);
        let cells = vec![Cell::Unknown; counts.iter().product()];
        let mut grid = Interior {
            low,
            size,
            counts,
            cells,
        };
        tree.faces.iter().for_each(|face| grid.mark(face));
        for start in 0..grid.cells.len() {
            if grid.cells[start] == Cell::Unknown {
                let state = if is_inside(grid.middle(start)) {
                    Cell::Inside
                } else {
                    Cell::Outside
                };
                grid.fill(start, state);
            }
        }
        grid
    }

    /// Where a point about the tree's center lies.
    pub(crate) fn place(&self, point: Vec3) -> Place {
        let at = (point - self.low) / self.size;
        if (0..3).any(|k| !(at[k] >= 0.0 && at[k] <= self.counts[k] as f64)) {
            return Place::Outside;
        }
        match self.cells[self.index([0, 1, 2].map(|k| self.clamp(at[k], k)))] {
            Cell::Outside => Place::Outside,
            Cell::Inside => Place::Inside,
            Cell::Surface | Cell::Unknown => Place::NearSurface,
        }
    }

    fn clamp(&self, at: f64, axis: usize) -> usize {
        // `as` saturates, so that places below the grid give 0.
        (at as usize).min(self.counts[axis] - 1)
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn split(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.counts;
        [index % nx, index / nx % ny, index / (nx * ny)]
    }

    fn middle(&self, index: usize) -> Vec3 {
        let at = self.split(index);
        self.low + Vec3::new(at[0] as f64 + 0.5, at[1] as f64 + 0.5, at[2] as f64 + 0.5) * self.size
    }

    /// Marks the cells in the face's box that its plane crosses; a little wider, so that rounding leaves no gap.
    fn mark(&mut self, face: &Face) {
        let corners =
            [face.a, face.a + face.ab, face.a + face.ac].map(|p| (p - self.low) / self.size);
        let low = corners[0].inf(&corners[1]).inf(&corners[2]);
        let high = corners[0].sup(&corners[1]).sup(&corners[2]);
        let first = [0, 1, 2].map(|k| self.clamp(low[k] - 1e-6, k));
        let last = [0, 1, 2].map(|k| self.clamp(high[k] + 1e-6, k));
        let reach = face.normal.abs().sum() * (0.5 + 1e-6);
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    let middle = Vec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5);
                    if (middle - corners[0]).dot(&face.normal).abs() <= reach {
                        let index = self.index([x, y, z]);
                        self.cells[index] = Cell::Surface;
                    }
                }
            }
        }
    }

    fn fill(&mut self, start: usize, state: Cell) {
        self.cells[start] = state;
        let mut pending = vec![start];
        while let Some(index) = pending.pop() {
            let at = self.split(index);
            for axis in 0..3 {
                for step in [usize::MAX, 1] {
                    let mut next = at;
                    next[axis] = at[axis].wrapping_add(step);
                    if next[axis] >= self.counts[axis] {
                        continue;
                    }
                    let next = self.index(next);
                    if self.cells[next] == Cell::Unknown {
                        self.cells[next] = state;
                        pending.push(next);
                    }
                }
            }
        }
    }
}
