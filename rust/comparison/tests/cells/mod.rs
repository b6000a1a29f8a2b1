//! Cells of made prints, and measures of what is found.
#![allow(dead_code, clippy::unwrap_used)]

pub mod letter;

use thenar_comparison::RecordingComparison;

/// Share of every cell of a grid within a shape, looked up at 8 x 8 points.
pub fn shares(size: [usize; 2], cell: f64, is_in: &dyn Fn(f64, f64) -> bool) -> Vec<f64> {
    let [rows, columns] = size;
    let each = (0..rows * columns).map(|k| [k % columns, k / columns]);
    let share = |[column, row]: [usize; 2]| {
        let at = |number: usize, part: usize| cell * (number as f64 + (part as f64 + 0.5) / 8.0);
        let points = (0..64).map(|k| is_in(at(column, k % 8), at(row, k / 8)));
        points.filter(|is| *is).count() as f64 / 64.0
    };
    each.map(share).collect()
}

/// As read and as simulated.
pub fn measure(recording: &RecordingComparison, name: &str) -> [f64; 2] {
    let row = recording
        .measures
        .iter()
        .find(|row| row.name == name)
        .unwrap();
    [row.measured, row.after]
}
