//! Near and far blocks of a zone's coupling, laid out in strips; each pair of clusters is stored once.

use std::ops::Range;

use rayon::prelude::*;

use crate::ContactError;

/// Blocks that are made between two looks at the caller's wish to stop.
const AT_ONCE: usize = 2048;
/// Blocks of a strip: few enough for their result to stay in a core's cache, many enough to add it up seldom.
const STRIP: usize = 256;

/// Two clusters and where the block between them begins.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    pub(super) a: usize,
    pub(super) b: usize,
    pub(super) start: usize,
    /// Where the strip's result has them.
    pub(super) to_a: u32,
    pub(super) to_b: u32,
}

impl Pair {
    pub(super) fn new(a: usize, b: usize) -> Pair {
        let (start, to_a, to_b) = (0, 0, 0);
        Pair {
            a,
            b,
            start,
            to_a,
            to_b,
        }
    }
}

/// Blocks that follow one another and are multiplied together.
#[derive(Debug, Clone)]
pub struct Strip {
    pub(super) pairs: Range<usize>,
    /// Clusters of the pairs, and where each begins in the strip's result.
    pub(super) touched: Vec<(u32, u32)>,
    /// Length of the result.
    pub(super) length: usize,
}

/// Blocks of one kind, in strips.
#[derive(Debug, Clone, Default)]
pub struct Blocks {
    pub(super) pairs: Vec<Pair>,
    pub(super) values: Vec<f32>,
    pub(super) entries: usize,
    pub(super) strips: Vec<Strip>,
}

impl Blocks {
    /// Gives every block its place, in memory and in a strip.
    pub(super) fn lay_out(&mut self, size: impl Fn(usize) -> usize, clusters: usize) {
        let mut end = 0;
        for pair in &mut self.pairs {
            pair.start = end;
            end += size(pair.a) * size(pair.b);
        }
        self.entries = end;
        let mut place = vec![None; clusters];
        self.strips.clear();
        for (number, pairs) in self.pairs.chunks_mut(STRIP).enumerate() {
            let (mut touched, mut length) = (Vec::new(), 0);
            let mut put = |cluster: usize| {
                *place[cluster].get_or_insert_with(|| {
                    touched.push((cluster as u32, length as u32));
                    length += size(cluster);
                    touched[touched.len() - 1].1
                })
            };
            for pair in pairs.iter_mut() {
                (pair.to_a, pair.to_b) = (put(pair.a), put(pair.b));
            }
            for &(cluster, _) in &touched {
                place[cluster as usize] = None;
            }
            let first = number * STRIP;
            self.strips.push(Strip {
                pairs: first..first + pairs.len(),
                touched,
                length,
            });
        }
    }

    /// Where the entries of a pair are.
    fn range(&self, pair: usize) -> Range<usize> {
        let next = self.pairs.get(pair + 1);
        self.pairs[pair].start..next.map_or(self.entries, |next| next.start)
    }

    /// The entries of a pair.
    pub(super) fn block(&self, pair: usize) -> &[f32] {
        &self.values[self.range(pair)]
    }

    pub(super) fn fill(
        &mut self,
        make: impl Fn(&Pair, &mut [f32]) + Sync,
        watch: impl Fn(f64) -> Result<(), ContactError>,
    ) -> Result<(), ContactError> {
        self.values.reserve_exact(self.entries);
        for first in (0..self.pairs.len()).step_by(AT_ONCE) {
            watch(first as f64 / self.pairs.len() as f64)?;
            let some = first..self.pairs.len().min(first + AT_ONCE);
            let one = |pair: usize| {
                let mut block = vec![0.0; self.range(pair).len()];
                make(&self.pairs[pair], &mut block);
                block
            };
            let made: Vec<Vec<f32>> = some.into_par_iter().map(one).collect();
            for block in &made {
                self.values.extend_from_slice(block);
            }
        }
        Ok(())
    }
}
