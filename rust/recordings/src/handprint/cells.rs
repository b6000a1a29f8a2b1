//! Counts ink by cell.

use super::image::Gray;
use super::ink::Parted;
use super::options::{PrintOptions, cells_along};
use super::print::Handprint;

/// A cell is known if this part of it is paper.
const KNOWN_FROM: f64 = 0.5;

/// The print of an image whose ink is parted from its paper.
pub fn count(gray: &Gray, parted: &Parted, options: &PrintOptions) -> Handprint {
    let (mm, side) = (options.scale.mm_per_px(), options.cell_mm);
    let [width, height] = gray.size;
    let [columns, rows] = gray.size.map(|pixels| cells_along(pixels, options));
    let (mut inked, mut known) = (vec![0.0; rows * columns], vec![0.0; rows * columns]);
    let cell = |pixel: usize| ((pixel as f64 + 0.5) * mm / side) as usize;
    for (pixel, brightness) in gray.pixels.iter().enumerate() {
        if !parted.is_paper[pixel] {
            continue;
        }
        let (x, y) = (pixel % width, pixel / width);
        let across = if options.is_mirrored {
            width - 1 - x
        } else {
            x
        };
        // Rows count from the lower edge.
        let at = cell(height - 1 - y).min(rows - 1) * columns + cell(across).min(columns - 1);
        known[at] += 1.0;
        inked[at] += f64::from(u8::from(parted.is_ink(*brightness)));
    }
    let all: f64 = inked.iter().sum();
    let in_cell = (side / mm).powi(2);
    let share = |(inked, known): (&f64, &f64)| match *known >= KNOWN_FROM * in_cell {
        true => inked / known,
        false => f64::NAN,
    };
    Handprint {
        size_px: gray.size,
        mm_per_px: mm,
        threshold: parted.threshold,
        ink: parted.ink,
        cells: [rows, columns],
        cell_mm: side,
        inked: inked.iter().zip(&known).map(share).collect(),
        inked_mm2: all * mm * mm,
        unknown: vec![
            "ink says where skin touched at any time of the press, and not how hard".to_owned(),
        ],
        warnings: parted.warnings.clone(),
    }
}
