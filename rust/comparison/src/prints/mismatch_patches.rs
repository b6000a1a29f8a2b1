//! Patches of the paper on which ink and simulated contact differ.

use crate::comparison::quantities::{Kind, WorstPlace};
use crate::prints::paper_sheet::Sheet;
use crate::prints::print_case::PrintCase;
use thenar_inference::observe::measured::Phase;

/// Patches that are told.
const MOST: usize = 8;
/// Cells beside a cell, along columns and rows.
const BESIDE: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];

/// The largest patches first: connected cells of which ink alone, or simulation alone, says that they touched.
///
/// Edges are told to one cell, so cells count only in squares of two by two. `measured`, `simulated` and `residual` are areas, mm2; a
/// patch is named by the cell next to its middle. `residual` is that of every cell, `cell_of` the cell on which a vertex of the skin comes to
/// lie; where no vertex lies on a patch, the nearest stands for it.
pub fn patches(
    case: &PrintCase<'_>,
    sheet: &Sheet,
    (residual, cell_of): (&[f64], &[Option<usize>]),
) -> Vec<WorstPlace> {
    let signs = thick(sheet, residual);
    let area = |patch: &Vec<usize>| patch.iter().map(|cell| case.mat.areas[*cell]).sum::<f64>();
    let mut found: Vec<(f64, Vec<usize>)> = connected(sheet, &signs)
        .into_iter()
        .map(|patch| (area(&patch), patch))
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    found.truncate(MOST);
    let place = |(area, patch): &(f64, Vec<usize>)| {
        let is_inked = signs[patch[0]] > 0.0;
        let middle = middle(sheet, patch);
        let measured = if is_inked { *area } else { 0.0 };
        WorstPlace {
            kind: Kind::Area,
            moment: 0,
            time_s: f64::NAN,
            depth_mm: f64::NAN,
            phase: Phase::Hold,
            sensel: Some(middle as u32),
            place: case.mat.places[middle],
            position_mm: Some(case.mat.centers[middle].into()),
            vertices: vertices(case, (patch, middle), cell_of),
            measured,
            simulated: area - measured,
            residual: 2.0 * measured - area,
            sigmas: f64::NAN,
        }
    };
    found.iter().map(place).collect()
}

/// Only what lies in a square of two by two alike cells.
fn thick(sheet: &Sheet, signs: &[f64]) -> Vec<f64> {
    let sign = |cell: Option<usize>| cell.map_or(f64::NAN, |cell| signs[cell]);
    let is_thick = |cell: usize| {
        [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]
            .iter()
            .any(|[x, y]| {
                [[*x, 0.0], [0.0, *y], [*x, *y]]
                    .iter()
                    .all(|by| sign(sheet.beside(cell, *by)) == signs[cell])
            })
    };
    let kept = (0..signs.len()).map(|cell| if is_thick(cell) { signs[cell] } else { 0.0 });
    kept.collect()
}

/// Cells of one sign that hang together by their sides, each patch in order.
fn connected(sheet: &Sheet, signs: &[f64]) -> Vec<Vec<usize>> {
    let mut is_taken = vec![false; signs.len()];
    let mut patches = Vec::new();
    for first in 0..signs.len() {
        if signs[first] == 0.0 || is_taken[first] {
            continue;
        }
        is_taken[first] = true;
        let (mut patch, mut next) = (vec![first], 0);
        while next < patch.len() {
            let here = patch[next];
            let beside = BESIDE.iter();
            for cell in beside.filter_map(|by| sheet.beside(here, *by)) {
                if signs[cell] == signs[first] && !is_taken[cell] {
                    is_taken[cell] = true;
                    patch.push(cell);
                }
            }
            next += 1;
        }
        patch.sort_unstable();
        patches.push(patch);
    }
    patches
}

/// The cell of a patch next to its middle.
fn middle(sheet: &Sheet, patch: &[usize]) -> usize {
    let mean = [0, 1].map(|axis| {
        let sum: f64 = patch.iter().map(|cell| sheet.middle(*cell)[axis]).sum();
        sum / patch.len() as f64
    });
    let off = |cell: usize| {
        let at = sheet.middle(cell);
        (at[0] - mean[0]).powi(2) + (at[1] - mean[1]).powi(2)
    };
    let nearest = patch.iter().copied();
    nearest
        .min_by(|a, b| off(*a).total_cmp(&off(*b)))
        .unwrap_or(0)
}

/// Vertices of the skin on a patch, the one next to its middle first; of equals the lower number.
fn vertices(
    case: &PrintCase<'_>,
    (patch, middle): (&[usize], usize),
    cell_of: &[Option<usize>],
) -> Vec<u32> {
    let center = case.mat.centers[middle];
    let off = |vertex: u32| (case.pressed.positions[vertex as usize] - center).norm_squared();
    let is_on = |cell: &Option<usize>| cell.is_some_and(|cell| patch.binary_search(&cell).is_ok());
    let on = cell_of.iter().enumerate().filter(|(_, cell)| is_on(cell));
    let mut found: Vec<u32> = on.map(|(vertex, _)| vertex as u32).collect();
    if found.is_empty() {
        let all = 0..case.pressed.positions.len() as u32;
        found.extend(all.min_by(|a, b| off(*a).total_cmp(&off(*b))));
    }
    found.sort_by(|a, b| off(*a).total_cmp(&off(*b)).then(a.cmp(b)));
    found
}
