//! Screened diffusion on a graph, `(1 + c L) x = b`: Chebyshev iteration with a coarse correction; linear in `b`.

use std::collections::VecDeque;

use nalgebra::{Cholesky, DMatrix, Dyn};

/// Four sums that are diffused together: weighted normals and weights, whose ratio is an average.
pub type Sums = [f64; 4];

/// Accuracy of the result: a fixed number of steps reaches it for any input, so that the result turns with it.
pub const ACCURACY: f64 = 1e-3;

/// Strength from which a coarse correction on groups is used: Chebyshev steps grow with its root.
const STRONG: f64 = 500.0;
/// Groups, about; as many equations are solved at once. 128 to 512 serve.
const GROUPS: usize = 256;
/// Rounds of groups and single values that reach [`ACCURACY`], and what is left of the differences within a group after each.
const ROUNDS: usize = 5;
const LEFT: f64 = 0.02;
const FREE: u32 = u32::MAX;

/// Neighbors one after the other, with the diagonal of `1 + c L`.
pub struct Graph {
    strength: f64,
    diagonal: Vec<f64>,
    /// One past the last neighbor of each.
    ends: Vec<u32>,
    /// Those that are unknown too.
    pub neighbors: Vec<u32>,
}

impl Graph {
    /// An empty one, with room for so many values, which pull at their neighbors with `strength` c.
    pub fn new(strength: f64, values: usize) -> Self {
        Graph {
            strength,
            diagonal: Vec::with_capacity(values),
            ends: Vec::with_capacity(values),
            neighbors: Vec::with_capacity(6 * values),
        }
    }

    /// Ends the list of the next value's neighbors, of which there are `degree`; those that are not listed are in `b`.
    pub fn end(&mut self, degree: usize) {
        self.diagonal.push(1.0 + self.strength * degree as f64);
        self.ends.push(self.neighbors.len() as u32);
    }

    fn beside(&self, k: usize) -> &[u32] {
        let first = k.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.neighbors[first as usize..self.ends[k] as usize]
    }

    /// A bound on the largest eigenvalue of `1 + c L`; the least is 1 at least.
    ///
    /// That of L is at most a degree and the mean of those beside it (Merris, A note on Laplacian graph eigenvalues, 1998); where some
    /// neighbors are not among the values, all the more so.
    fn highest(&self) -> f64 {
        let c_degree = |k: usize| self.diagonal[k] - 1.0;
        let sum = |k: usize| {
            let beside = self.beside(k).iter().map(|&j| c_degree(j as usize));
            let mean = beside.sum::<f64>() / c_degree(k).max(f64::MIN_POSITIVE);
            c_degree(k) + self.strength * mean
        };
        1.0 + (0..self.diagonal.len()).map(sum).fold(0.0, f64::max)
    }
}

/// Solves `(1 + c L) x = b` with the graph's Laplacian L.
pub fn diffuse(b: &[Sums], graph: &Graph) -> Vec<Sums> {
    let mut x = vec![Sums::default(); b.len()];
    let is_strong = graph.strength >= STRONG;
    let Some(groups) = is_strong.then(|| Groups::new(graph)).flatten() else {
        chebyshev(graph, b, (1.0, ACCURACY), &mut x);
        return x;
    };
    for _ in 0..ROUNDS {
        groups.correct(graph, b, &mut x);
        chebyshev(graph, b, (groups.lowest, LEFT), &mut x);
    }
    x
}

/// Chebyshev's iteration, which leaves `left` of the error in what belongs to eigenvalues from `low` on, and no more of the rest.
///
/// Its steps do not depend on `b`.
fn chebyshev(graph: &Graph, b: &[Sums], (low, left): (f64, f64), x: &mut [Sums]) {
    let high = graph.highest();
    let (middle, half) = (0.5 * (high + low), 0.5 * (high - low).max(1e-12));
    let steps = (0.5 * (high / low).sqrt() * (2.0 / left).ln()).ceil() as usize;
    let mut step = vec![Sums::default(); b.len()];
    let mut rho = half / middle;
    for k in 0..=steps {
        let next = if k == 0 {
            rho
        } else {
            1.0 / (2.0 * middle / half - rho)
        };
        let (keep, gain) = if k == 0 {
            (0.0, 1.0 / middle)
        } else {
            (next * rho, 2.0 * next / half)
        };
        advance(graph, b, (keep, gain), (x, &mut step));
        rho = next;
    }
}

/// One of Chebyshev's steps: `step` becomes `keep` of itself and `gain` of the residual, and is added to `x`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn advance(
    graph: &Graph,
    b: &[Sums],
    (keep, gain): (f64, f64),
    (x, step): (&mut [Sums], &mut [Sums]),
) {
    let mut from = 0;
    let all = graph.ends.iter().zip(&graph.diagonal).zip(b).zip(&*x);
    for ((((&to, own), b), here), step) in all.zip(&mut *step) {
        let mut around = [0.0; 4];
        for &j in &graph.neighbors[from as usize..to as usize] {
            let there = x[j as usize];
            for axis in 0..4 {
                around[axis] += there[axis];
            }
        }
        let mut next = *step;
        for axis in 0..4 {
            let residual = b[axis] - own * here[axis] + graph.strength * around[axis];
            next[axis] = keep * next[axis] + gain * residual;
        }
        *step = next;
        from = to;
    }
    let (x, step) = (x.as_flattened_mut(), step.as_flattened());
    for (x, step) in x.iter_mut().zip(step) {
        *x += step;
    }
}

/// Values that are moved together, and the equations between such groups.
struct Groups {
    of: Vec<u32>,
    equations: Cholesky<f64, Dyn>,
    /// Least eigenvalue that belongs to differences within groups.
    lowest: f64,
}

impl Groups {
    /// None where rounding leaves the equations indefinite.
    fn new(graph: &Graph) -> Option<Groups> {
        let count = graph.ends.len();
        let (of, groups) = grouped(graph, count.div_ceil(GROUPS));
        let mut sizes = vec![0.0; groups];
        of.iter().for_each(|&g| sizes[g as usize] += 1.0);
        let mut matrix = DMatrix::zeros(groups, groups);
        for k in 0..count {
            let (own, beside) = (of[k] as usize, graph.beside(k));
            matrix[(own, own)] += graph.diagonal[k] - graph.strength * beside.len() as f64;
            for &j in beside {
                let other = of[j as usize] as usize;
                if other != own {
                    // A difference between groups is spread over all edges from middle to middle.
                    let steps = 0.5 * (f64::sqrt(sizes[own]) + f64::sqrt(sizes[other]));
                    matrix[(own, own)] += graph.strength / steps;
                    matrix[(own, other)] -= graph.strength / steps;
                }
            }
        }
        // As on a lattice of triangles, for waves of two groups' width.
        let width = (count as f64 / groups.max(1) as f64).sqrt();
        let wave = std::f64::consts::PI / width;
        Some(Groups {
            of,
            equations: Cholesky::new(matrix)?,
            lowest: 1.0 + 1.5 * graph.strength * wave * wave,
        })
    }

    /// Moves groups so that what is left of the equations sums to nothing in each.
    fn correct(&self, graph: &Graph, b: &[Sums], x: &mut [Sums]) {
        let mut left = DMatrix::zeros(self.equations.l_dirty().nrows(), 4);
        for (k, b) in b.iter().enumerate() {
            for axis in 0..4 {
                let around = graph.beside(k).iter().map(|&j| x[j as usize][axis]);
                let pull = graph.strength * around.sum::<f64>();
                left[(self.of[k] as usize, axis)] +=
                    b[axis] - graph.diagonal[k] * x[k][axis] + pull;
            }
        }
        self.equations.solve_mut(&mut left);
        for (x, &group) in x.iter_mut().zip(&self.of) {
            for axis in 0..4 {
                x[axis] += left[(group as usize, axis)];
            }
        }
    }
}

/// Groups of up to `size` values that hang together, each begun where the last ones ended; the group of each value, and how many.
fn grouped(graph: &Graph, size: usize) -> (Vec<u32>, usize) {
    let count = graph.ends.len();
    let mut of = vec![FREE; count];
    let (mut groups, mut edge, mut next) = (0u32, VecDeque::new(), 0..count as u32);
    while let Some(seed) = edge.pop_front().or_else(|| next.next()) {
        if of[seed as usize] != FREE {
            continue;
        }
        let mut members = vec![seed];
        of[seed as usize] = groups;
        let mut at = 0;
        while at < members.len() {
            for &j in graph.beside(members[at] as usize) {
                if of[j as usize] == FREE {
                    if members.len() < size {
                        of[j as usize] = groups;
                        members.push(j);
                    } else {
                        edge.push_back(j);
                    }
                }
            }
            at += 1;
        }
        // A scrap goes to a group that it touches.
        let beside = members.iter().flat_map(|&k| graph.beside(k as usize));
        let mut others = beside.map(|&j| of[j as usize]);
        let host = others.find(|&g| g != FREE && g != groups);
        match host.filter(|_| members.len() * 4 < size) {
            Some(host) => members.iter().for_each(|&k| of[k as usize] = host),
            None => groups += 1,
        }
    }
    (of, groups as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice of triangles, `side` by `side`, with holes, numbered row by row.
    fn lattice(side: u32, strength: f64) -> Graph {
        let is_there = |i: i64, j: i64| {
            let within = |k: i64| (0..i64::from(side)).contains(&k);
            within(i) && within(j) && (i * 7 + j * 13) % 41 != 0
        };
        let mut number = vec![FREE; (side * side) as usize];
        let all = || (0..i64::from(side)).flat_map(|j| (0..i64::from(side)).map(move |i| (i, j)));
        let place = |(i, j): (i64, i64)| (j * i64::from(side) + i) as usize;
        let mut count = 0;
        for at in all().filter(|&(i, j)| is_there(i, j)) {
            number[place(at)] = count;
            count += 1;
        }
        let mut graph = Graph::new(strength, count as usize);
        for (i, j) in all().filter(|&(i, j)| is_there(i, j)) {
            let ways = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, -1), (-1, 1)];
            let beside = ways.map(|(x, y)| (i + x, j + y));
            let before = graph.neighbors.len();
            let beside = beside.into_iter().filter(|&(i, j)| is_there(i, j));
            graph.neighbors.extend(beside.map(|at| number[place(at)]));
            graph.end(graph.neighbors.len() - before);
        }
        graph
    }

    #[test]
    fn groups_lead_to_what_single_values_do() {
        for strength in [600.0, 30_000.0] {
            let graph = lattice(150, strength);
            let count = graph.ends.len();
            let value = |k: usize| {
                let (row, column) = ((k / 150) as f64, (k % 150) as f64);
                let edge = if k % 150 < 60 { 1.0 } else { -0.3 };
                [1.0, edge, (0.07 * row).sin(), (0.9 * column).cos() * edge]
            };
            let b: Vec<Sums> = (0..count).map(value).collect();
            let mut wanted = vec![Sums::default(); count];
            chebyshev(&graph, &b, (1.0, 1e-9), &mut wanted);
            let found = diffuse(&b, &graph);
            let most = wanted
                .iter()
                .flatten()
                .fold(0.0, |m, x| f64::max(m, x.abs()));
            let off = wanted.iter().flatten().zip(found.iter().flatten());
            let off = off.fold(0.0, |m, (a, b)| f64::max(m, (a - b).abs()));
            assert!(off < ACCURACY * most, "{strength}: {off} of {most}");
        }
    }

    #[test]
    fn no_eigenvalue_is_above_the_bound() {
        // A lattice with holes, all of it and a part whose edge pulls at values that are known.
        let whole = lattice(9, 30.0);
        let part = {
            let mut part = Graph::new(30.0, 0);
            let is_in = |k: u32| k >= 20;
            for k in (0..whole.ends.len() as u32).filter(|k| is_in(*k)) {
                let beside = whole.beside(k as usize);
                let inside = beside.iter().filter(|j| is_in(**j));
                part.neighbors.extend(inside.map(|j| j - 20));
                part.end(beside.len());
            }
            part
        };
        for graph in [whole, part] {
            let n = graph.ends.len();
            let mut matrix = DMatrix::zeros(n, n);
            for k in 0..n {
                matrix[(k, k)] = graph.diagonal[k];
                for &j in graph.beside(k) {
                    matrix[(k, j as usize)] -= graph.strength;
                }
            }
            let largest = matrix.symmetric_eigenvalues().max();
            let bound = graph.highest();
            assert!((1.0..1.6).contains(&(bound / largest)), "{bound} {largest}");
        }
    }
}
