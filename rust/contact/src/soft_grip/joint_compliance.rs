//! The compliance of skin and soft grip together: what presses both is one force at each place, and their yields add.

use crate::solve::{Compliance, Submatrix, Symmetric};

/// The compliance of a grip at the places of a contact problem, mm/N, by rows; symmetric.
#[derive(Debug, Default)]
pub struct GripRows {
    ends: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f32>,
    diagonal: Vec<f64>,
}

impl GripRows {
    /// Appends a row: its entries by ascending column, the diagonal among them.
    pub fn push(&mut self, entries: &[(u32, f32)]) {
        let row = self.diagonal.len() as u32;
        self.columns.extend(entries.iter().map(|e| e.0));
        self.values.extend(entries.iter().map(|e| e.1));
        self.ends.push(self.values.len());
        let own = entries.iter().find(|e| e.0 == row);
        self.diagonal.push(own.map_or(0.0, |e| f64::from(e.1)));
    }

    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let first = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        let there = first..self.ends[i];
        let columns = self.columns[there.clone()].iter();
        columns
            .zip(&self.values[there])
            .map(|(c, v)| (*c as usize, f64::from(*v)))
    }

    /// One row times `x`, mm.
    fn row_times(&self, i: usize, x: &[f64]) -> f64 {
        self.row(i).map(|(j, v)| v * x[j]).sum()
    }

    /// The principal part of `keep` (ascending).
    fn part(&self, keep: &[u32]) -> GripRows {
        let mut place = vec![u32::MAX; self.diagonal.len()];
        for (k, &i) in keep.iter().enumerate() {
            place[i as usize] = k as u32;
        }
        let mut part = GripRows::default();
        for &i in keep {
            let kept = self.row(i as usize).filter(|(j, _)| place[*j] != u32::MAX);
            let entries: Vec<(u32, f32)> = kept.map(|(j, v)| (place[j], v as f32)).collect();
            part.push(&entries);
        }
        part
    }
}

/// A skin's compliance and a grip's.
pub struct Joint<'a, M> {
    skin: &'a M,
    grip: &'a GripRows,
    diagonal: Vec<f64>,
}

impl<'a, M: Compliance> Joint<'a, M> {
    /// Of as many places each.
    pub fn new(skin: &'a M, grip: &'a GripRows) -> Self {
        let both = skin.diagonal().iter().zip(&grip.diagonal);
        Joint {
            skin,
            grip,
            diagonal: both.map(|(a, b)| a + b).collect(),
        }
    }
}

impl<M: Compliance> Symmetric for Joint<'_, M> {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        self.skin.times(x, out);
        for (i, out) in out.iter_mut().enumerate() {
            *out += self.grip.row_times(i, x);
        }
    }
}

impl<M: Compliance> Compliance for Joint<'_, M> {
    fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        self.skin.times_rows(rows, x, out);
        for (&i, out) in rows.iter().zip(out) {
            *out += self.grip.row_times(i as usize, x);
        }
    }

    fn norm_bound(&self) -> f64 {
        let rows = 0..self.grip.diagonal.len();
        let sum = |i: usize| self.grip.row(i).map(|(_, v)| v.abs()).sum::<f64>();
        self.skin.norm_bound() + rows.map(sum).fold(0.0, f64::max)
    }

    fn submatrix(&self, set: &[u32], is_rough: bool) -> Submatrix<'_> {
        self.skin
            .submatrix(set, is_rough)
            .with(|rows, skin| Box::new(JointPart::new(skin, self.grip.part(rows))))
    }

    fn is_narrow(&self, is_rough: bool) -> bool {
        self.skin.is_narrow(is_rough)
    }

    fn is_costly(&self) -> bool {
        self.skin.is_costly()
    }
}

/// The same on a contact set.
struct JointPart<'a> {
    skin: Box<dyn Symmetric + 'a>,
    grip: GripRows,
    diagonal: Vec<f64>,
}

impl<'a> JointPart<'a> {
    fn new(skin: Box<dyn Symmetric + 'a>, grip: GripRows) -> Self {
        let both = skin.diagonal().iter().zip(&grip.diagonal);
        let diagonal = both.map(|(a, b)| a + b).collect();
        JointPart {
            skin,
            grip,
            diagonal,
        }
    }
}

impl Symmetric for JointPart<'_> {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        self.skin.times(x, out);
        for (i, out) in out.iter_mut().enumerate() {
            *out += self.grip.row_times(i, x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Control;
    use crate::solve::row_runs::RowRuns;
    use crate::solve::{Accuracy, solve_contact};

    #[test]
    fn springs_in_series_carry_one_force() {
        // Two places, each a skin spring of 2 mm/N and a grip spring of 3 mm/N; the third has no grip.
        let skin = RowRuns::dense(vec![2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0], 3);
        let mut grip = GripRows::default();
        grip.push(&[(0, 3.0)]);
        grip.push(&[(1, 3.0)]);
        grip.push(&[]);
        let joint = Joint::new(&skin, &grip);
        let control = Control::none();
        let found = solve_contact(&joint, &[-1.0, 0.5, -1.0], None, (Accuracy::Full, &control));
        for (force, wanted) in found.force.iter().zip([0.2, 0.0, 0.5]) {
            assert!((force - wanted).abs() < 1e-9, "{force} {wanted}");
        }
        assert!(found.complementarity < 1e-11);
    }
}
