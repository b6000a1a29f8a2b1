//! Row layout that the sites of one patch share in the near field.

use super::row_kernels::LANES;
use crate::response::assembly::{SHORT, take};
use crate::solve::row_runs::Run;

/// What the rows of one patch have in common; empty where it is not coupled.
#[derive(Debug, Clone, Default)]
pub(super) struct PatchRows {
    /// Entries of each, a multiple of [`LANES`].
    pub width: usize,
    /// The coupled columns, and their pieces in the rows of the response: first and number.
    runs: Vec<Run>,
    pieces: Vec<(u32, u32)>,
    /// Which of its chunks of [`LANES`] columns hold any that is solved, ascending: products read no others.
    pub chunks: Vec<u32>,
}

impl PatchRows {
    /// Of the coupled columns and their pieces in the rows of the response; none is solved yet.
    pub fn new((runs, pieces): (Vec<Run>, Vec<(u32, u32)>)) -> Self {
        let width: usize = runs.iter().map(|run| run.len as usize).sum();
        PatchRows {
            width: width.next_multiple_of(LANES),
            runs,
            pieces,
            chunks: Vec::new(),
        }
    }

    /// Finds the chunks with columns that are solved: where `solved`, by column, is not zero.
    pub fn choose_chunks(&mut self, solved: &[f32]) {
        let mut there = [Vec::new()];
        self.gather([solved], &mut there);
        let chunks = (0..).zip(there[0].as_chunks::<LANES>().0);
        let any = chunks.filter(|(_, chunk)| chunk.iter().any(|x| *x != 0.0));
        self.chunks = any.map(|(at, _)| at).collect();
    }

    /// Writes the values of `all` at the columns to `there`, filled up with zeros.
    fn gather<const N: usize>(&self, all: [&[f32]; N], there: &mut [Vec<f32>; N]) {
        for (all, there) in all.into_iter().zip(there) {
            there.clear();
            for run in &self.runs {
                there.extend_from_slice(&all[run.start as usize..][..run.len as usize]);
            }
            there.resize(self.width, 0.0);
        }
    }

    /// The values of `all`, by column, in the chunks of solved columns.
    pub fn gather_solved<const N: usize>(&self, all: [&[f32]; N], there: &mut [Vec<f32>; N]) {
        self.gather(all, there);
        for there in there {
            let (chunks, _) = there.as_chunks_mut::<LANES>();
            for (to, &from) in self.chunks.iter().enumerate() {
                chunks[to] = chunks[from as usize];
            }
            there.truncate(self.chunks.len() * LANES);
        }
    }

    /// Appends what a row holds at the columns, filled up with zeros.
    pub fn push_row(&self, row: &[i16], values: &mut Vec<i16>) {
        let begin = values.len();
        let end = begin + self.width;
        values.resize(end + SHORT, 0);
        let taken = take(row, &self.pieces, &mut values[begin..]).len();
        values.truncate(end);
        values[begin + taken..].fill(0);
    }
}

pub(super) fn slices<const N: usize>(values: &[Vec<f32>; N]) -> [&[f32]; N] {
    values.each_ref().map(|values| &values[..])
}
