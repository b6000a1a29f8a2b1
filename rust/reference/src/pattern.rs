//! Place of every element's stiffness in the sparse matrix.

use rayon::prelude::*;

use crate::prism_energy::Element;
use crate::prisms::{GROUP_NODES, PrismMesh};

/// Pairs of a group's nodes, each once.
const PAIRS: usize = GROUP_NODES * (GROUP_NODES + 1) / 2;

/// Lower half of the stiffness matrix, column by column, in blocks of three by three of the nodes that move.
pub struct Pattern {
    /// First entry of every column (3 n + 1).
    pub columns: Vec<usize>,
    /// Row of every entry, rising in a column.
    pub rows: Vec<usize>,
    /// For every group and pair of its nodes: the rank of the later node among the nodes below the earlier one's diagonal; `u32::MAX`
    /// where one of them is fixed.
    ranks: Vec<[u32; PAIRS]>,
}

impl Pattern {
    pub fn new(mesh: &PrismMesh) -> Pattern {
        let mut below: Vec<Vec<u32>> = vec![Vec::new(); mesh.free_count];
        for group in &mesh.groups {
            for (low, high) in pairs().filter_map(|pair| ordered(mesh, &group.nodes, pair)) {
                if low != high {
                    below[low as usize].push(high);
                }
            }
        }
        below.par_iter_mut().for_each(|list| {
            list.sort_unstable();
            list.dedup();
        });
        let mut columns = vec![0];
        let mut rows = Vec::new();
        for (node, list) in below.iter().enumerate() {
            for j in 0..3 {
                rows.extend((j..3).map(|i| 3 * node + i));
                rows.extend(
                    list.iter()
                        .flat_map(|k| (0..3).map(move |i| 3 * *k as usize + i)),
                );
                columns.push(rows.len());
            }
        }
        let ranks = mesh.groups.par_iter().map(|group| {
            let mut ranks = [u32::MAX; PAIRS];
            for (rank, pair) in ranks.iter_mut().zip(pairs()) {
                if let Some((low, high)) = ordered(mesh, &group.nodes, pair) {
                    let list = &below[low as usize];
                    *rank = list.binary_search(&high).map_or(0, |found| found as u32);
                }
            }
            ranks
        });
        let ranks = ranks.collect();
        Pattern {
            columns,
            rows,
            ranks,
        }
    }

    /// Entry of row `i` of a node and column `j` of the node `low`; `rank` that of a later node, `None` for the node itself (i >= j).
    fn entry(&self, low: usize, (i, j): (usize, usize), rank: Option<u32>) -> usize {
        let first = self.columns[3 * low + j];
        match rank {
            None => first + i - j,
            Some(rank) => first + 3 - j + 3 * rank as usize + i,
        }
    }

    /// Adds the elements' stiffness to `values`, group by group: the same bits for any number of threads.
    pub fn add(&self, mesh: &PrismMesh, elements: &[Element], values: &mut [f64]) {
        for ((group, ranks), element) in mesh.groups.iter().zip(&self.ranks).zip(elements) {
            for ((a, b), rank) in pairs().zip(ranks) {
                let (first, second) = (free(mesh, group.nodes[a]), free(mesh, group.nodes[b]));
                if first == u32::MAX || second == u32::MAX {
                    continue;
                }
                let (low, high, is_same) = if first <= second {
                    (a, b, a == b)
                } else {
                    (b, a, false)
                };
                let column = first.min(second) as usize;
                for j in 0..3 {
                    for i in if is_same { j } else { 0 }..3 {
                        let (p, q) = (3 * high + i, 3 * low + j);
                        let value = element.stiffness[p.max(q)][p.min(q)];
                        values[self.entry(column, (i, j), (!is_same).then_some(*rank))] += value;
                    }
                }
            }
        }
    }

    /// Adds a stiffness (N/mm, symmetric) on one node that moves.
    pub fn add_node(&self, node: usize, stiffness: &[[f64; 3]; 3], values: &mut [f64]) {
        for j in 0..3 {
            for i in j..3 {
                values[self.entry(node, (i, j), None)] += stiffness[i][j];
            }
        }
    }

    /// The symmetric matrix of these values times a vector.
    pub fn times(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; vector.len()];
        for (column, ends) in self.columns.windows(2).enumerate() {
            let below = ends[0] + 1..ends[1];
            let by = vector[column];
            let mut own = values[ends[0]] * by;
            for (row, value) in self.rows[below.clone()].iter().zip(&values[below]) {
                product[*row] += value * by;
                own += value * vector[*row];
            }
            product[column] += own;
        }
        product
    }

    /// Entries on the diagonal.
    pub fn diagonal(&self) -> &[usize] {
        &self.columns[..self.columns.len() - 1]
    }
}

fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..GROUP_NODES).flat_map(|a| (0..=a).map(move |b| (a, b)))
}

/// The two nodes of a pair among those that move, the earlier one first.
fn ordered(
    mesh: &PrismMesh,
    nodes: &[u32; GROUP_NODES],
    (a, b): (usize, usize),
) -> Option<(u32, u32)> {
    let (first, second) = (free(mesh, nodes[a]), free(mesh, nodes[b]));
    (first != u32::MAX && second != u32::MAX).then(|| (first.min(second), first.max(second)))
}

/// Index of a node among those that move; `u32::MAX` for a node that does not, or a place of a group that is empty.
fn free(mesh: &PrismMesh, node: u32) -> u32 {
    mesh.free.get(node as usize).copied().unwrap_or(u32::MAX)
}
