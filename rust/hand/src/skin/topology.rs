//! Who is next to whom: a closed triangle mesh as half-edges, each with its twin.

use super::soup::Soup;
use thenar_surface::Vec3;

/// No half-edge: its triangle is gone.
pub(super) const GONE: u32 = u32::MAX;

/// Half-edge `3 t + k` runs from corner `k` of triangle `t` to its next corner.
pub(super) struct Topology {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Twin of each half-edge; [`GONE`] for deleted triangles.
    pub twins: Vec<u32>,
    /// One half-edge that leaves each vertex; [`GONE`] for deleted vertices.
    pub leaving: Vec<u32>,
}

pub(super) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

pub(super) fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Topology {
    /// The half-edges of a soup, or `None` if it is not closed and manifold along its edges.
    pub fn new(soup: Soup) -> Option<Topology> {
        let Soup {
            positions,
            triangles,
        } = soup;
        let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(triangles.len() * 3);
        for (t, triangle) in triangles.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                edges.push((a.min(b), a.max(b), (3 * t + k) as u32));
            }
        }
        edges.sort_unstable();
        let mut twins = vec![GONE; triangles.len() * 3];
        if !edges.len().is_multiple_of(2) {
            return None;
        }
        for pair in edges.chunks_exact(2) {
            let (first, second) = (pair[0], pair[1]);
            let start = |h: u32| triangles[h as usize / 3][h as usize % 3];
            if (first.0, first.1) != (second.0, second.1) || start(first.2) == start(second.2) {
                return None;
            }
            twins[first.2 as usize] = second.2;
            twins[second.2 as usize] = first.2;
        }
        let mut leaving = vec![GONE; positions.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            for k in 0..3 {
                leaving[triangle[k] as usize] = (3 * t + k) as u32;
            }
        }
        Some(Topology {
            positions,
            triangles,
            twins,
            leaving,
        })
    }

    pub fn start(&self, h: u32) -> u32 {
        self.triangles[h as usize / 3][h as usize % 3]
    }

    pub fn end(&self, h: u32) -> u32 {
        self.start(next(h))
    }

    pub fn twin(&self, h: u32) -> u32 {
        self.twins[h as usize]
    }

    pub fn is_alive(&self, h: u32) -> bool {
        self.twins[h as usize] != GONE
    }

    pub fn position(&self, v: u32) -> Vec3 {
        self.positions[v as usize]
    }

    pub fn length(&self, h: u32) -> f64 {
        (self.position(self.start(h)) - self.position(self.end(h))).norm()
    }

    /// Half-edges that leave `v`, in clockwise order.
    pub fn spokes(&self, v: u32) -> Spokes<'_> {
        let first = self.leaving[v as usize];
        Spokes {
            topology: self,
            first,
            at: Some(first).filter(|&h| h != GONE),
        }
    }

    pub fn valence(&self, v: u32) -> usize {
        self.spokes(v).count()
    }

    /// Drops what was deleted and renumbers.
    pub fn into_soup(self) -> Soup {
        let mut place = vec![GONE; self.positions.len()];
        let mut positions = Vec::new();
        for (v, position) in self.positions.iter().enumerate() {
            if self.leaving[v] != GONE {
                place[v] = positions.len() as u32;
                positions.push(*position);
            }
        }
        let alive = (0..self.triangles.len()).filter(|&t| self.twins[3 * t] != GONE);
        let triangles = alive
            .map(|t| self.triangles[t].map(|v| place[v as usize]))
            .collect();
        Soup {
            positions,
            triangles,
        }
    }
}

/// See [`Topology::spokes`].
pub(super) struct Spokes<'a> {
    topology: &'a Topology,
    first: u32,
    at: Option<u32>,
}

impl Iterator for Spokes<'_> {
    type Item = u32;

    fn next(&mut self) -> Option<u32> {
        let h = self.at?;
        let turned = next(self.topology.twin(h));
        self.at = Some(turned).filter(|&h| h != self.first);
        Some(h)
    }
}
