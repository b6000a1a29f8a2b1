//! Which vertices share an edge.

use crate::mesh::triangles::Mesh;

/// Vertices around each vertex, along edges of the mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adjacency {
    starts: Vec<u32>,
    neighbors: Vec<u32>,
}

impl Adjacency {
    /// Collects the neighbors of every vertex.
    pub fn new(mesh: &Mesh) -> Adjacency {
        let edges = mesh.edges();
        let mut starts = vec![0u32; mesh.positions().len() + 1];
        for &[a, b] in &edges {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut neighbors = vec![0u32; 2 * edges.len()];
        // Sorted edges fill the lower neighbors of a vertex before the higher ones, each in order: first all [a, v], then all [v, b].
        for ascending in [false, true] {
            for &[a, b] in &edges {
                let (at, other) = if ascending { (a, b) } else { (b, a) };
                neighbors[next[at as usize] as usize] = other;
                next[at as usize] += 1;
            }
        }
        Adjacency { starts, neighbors }
    }

    /// From what lies around one after the other, in any order and as often as it is met.
    pub(crate) fn of(around: impl Iterator<Item = Vec<u32>>) -> Adjacency {
        let (mut starts, mut neighbors) = (vec![0], Vec::new());
        for mut others in around {
            others.sort_unstable();
            others.dedup();
            neighbors.extend(others);
            starts.push(neighbors.len() as u32);
        }
        Adjacency { starts, neighbors }
    }

    /// How many vertices there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices that share an edge with vertex `i`, in ascending order.
    pub fn neighbors(&self, i: usize) -> &[u32] {
        &self.neighbors[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}
