//! Allowed error of the simulation: smooth factors over place and depth, and an uncorrelated part common to all presses.
//!
//! A layer over bone is no finite-strain solid. Against finite elements of six pads over curved bone (neo-Hookean to exponential,
//! plate and rod, depths to 15 % of the thickness) its pressures are off by 1.5 to 2.9 % rms of the largest; with a factor quadratic
//! in place and free at each depth 0.3 to 1.2 % are left, in single sensels up to 3.9 %. The factor is taken out; what is left is
//! told as noise that does not fall with repeats.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, Vector3};

use crate::location::protocol_cells::Cells;
use crate::location::residual_sums::{CellSum, CellSums, Channel};
use crate::location::scan_windows::Sensor;
use thenar_inference::observe::measured::Measured;

/// Powers of depth, over the largest, by which a factor may change.
const POWERS: i32 = 3;
/// Most places at which the rough error of one tool and site is told.
const MOST_NODES: f64 = 150.0;
/// Columns shorter than this, of their own length, add nothing to those before them.
const DEPENDENT: f64 = 1e-6;

/// What is allowed for, along the atoms: a row per atom.
pub(crate) struct Allowance {
    /// Orthonormal columns: smooth factors.
    pub smooth: DMatrix<f64>,
    /// Independent errors of variance 1.
    pub rough: DMatrix<f64>,
}

/// Atoms of one kind of channel under one tool at one site, and how they are numbered.
struct Family<'a> {
    cell_sums: Vec<(usize, &'a CellSum)>,
    /// Place of each on the skin, mm; of what has none its depth, in quarters of the largest.
    places: Vec<Vector3<f64>>,
    /// Distance from a place to the next.
    pitch: f64,
    is_of_map: bool,
}

/// Allows for a simulation whose pressures, forces and areas are off by `error` of the largest; None: it is taken as exact.
pub(crate) fn allow(
    (measured, cells): (&[Measured], &Cells),
    (cell_sums, sensors): (&CellSums, &[Sensor]),
    error: Option<f64>,
) -> Allowance {
    let count = cell_sums.list.len();
    let Some(error) = error else {
        return Allowance {
            smooth: DMatrix::zeros(count, 0),
            rough: DMatrix::zeros(count, 0),
        };
    };
    let (mut smooth, mut rough) = (Vec::new(), Vec::new());
    for family in families((measured, cells), cell_sums, sensors).values() {
        smooth.extend(factors(family, count));
        rough.extend(nodes(family, (error, count)));
    }
    Allowance {
        smooth: orthonormal(smooth, count),
        rough: matrix(&rough, count),
    }
}

fn families<'a>(
    (measured, cells): (&'a [Measured], &Cells),
    cell_sums: &'a CellSums,
    sensors: &[Sensor],
) -> BTreeMap<(Channel, &'a str, &'a str), Family<'a>> {
    let mut families = BTreeMap::new();
    for (at, cell_sum) in cell_sums.list.iter().enumerate() {
        let one = &measured[cells.list[cell_sum.cell].recording];
        let (kind, place, pitch) = match cell_sum.channel {
            Channel::Pressure(sensel) => {
                let of = |sensor: &Sensor| {
                    sensor
                        .place_of(cell_sum.cell, sensel)
                        .zip(Some(sensor.pitch))
                };
                let found = sensors.iter().find_map(of);
                let (place, pitch) = found.unwrap_or((Vector3::zeros(), 1.0));
                (Channel::Pressure(0), place, pitch)
            }
            other => (other, Vector3::new(4.0 * cell_sum.depth, 0.0, 0.0), 1.0),
        };
        let family = families
            .entry((kind, one.indenter.as_str(), one.site.as_str()))
            .or_insert_with(|| Family {
                cell_sums: Vec::new(),
                places: Vec::new(),
                pitch,
                is_of_map: cell_sum.channel.is_of_map(),
            });
        family.cell_sums.push((at, cell_sum));
        family.places.push(place);
    }
    families
}

/// The simulated value times powers of depth, and for maps times 1, x, y, x^2, x y, y^2 about the middle of the contact.
fn factors(family: &Family<'_>, count: usize) -> Vec<Vec<f64>> {
    let shapes = if family.is_of_map {
        shapes(family)
    } else {
        vec![vec![1.0; family.cell_sums.len()]]
    };
    let mut columns = Vec::new();
    for shape in &shapes {
        for power in 0..POWERS {
            let mut column = vec![0.0; count];
            for ((at, cell_sum), factor) in family.cell_sums.iter().zip(shape) {
                column[*at] =
                    cell_sum.weight * cell_sum.simulated * factor * cell_sum.depth.powi(power);
            }
            columns.push(column);
        }
    }
    columns
}

/// Quadratic functions of place by atom, in the plane that the sensels under load lie in.
fn shapes(family: &Family<'_>) -> Vec<Vec<f64>> {
    let loads = || {
        family
            .cell_sums
            .iter()
            .map(|(_, cell_sum)| cell_sum.simulated.max(0.0))
    };
    let whole = loads().sum::<f64>().max(f64::MIN_POSITIVE);
    let middle: Vector3<f64> = family
        .places
        .iter()
        .zip(loads())
        .map(|(place, load)| place * load)
        .sum::<Vector3<f64>>()
        / whole;
    let mut spread = nalgebra::Matrix3::zeros();
    for (place, load) in family.places.iter().zip(loads()) {
        spread += (place - middle) * (place - middle).transpose() * (load / whole);
    }
    let eigen = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let length = eigen.eigenvalues[order[0]].sqrt().max(1e-9);
    let along = |place: &Vector3<f64>, axis: usize| {
        eigen
            .eigenvectors
            .column(order[axis])
            .dot(&(place - middle))
            / length
    };
    let flat: Vec<[f64; 2]> = family
        .places
        .iter()
        .map(|p| [along(p, 0), along(p, 1)])
        .collect();
    let monomials: [fn(&[f64; 2]) -> f64; 6] = [
        |_| 1.0,
        |[x, _]| *x,
        |[_, y]| *y,
        |[x, _]| x * x,
        |[x, y]| x * y,
        |[_, y]| y * y,
    ];
    monomials
        .iter()
        .map(|monomial| flat.iter().map(monomial).collect())
        .collect()
}

/// Bumps one node apart and two nodes apart, each of half the variance, together `error` of the largest value everywhere: the same in
/// all presses of a tool at a site.
fn nodes(family: &Family<'_>, (error, count): (f64, usize)) -> Vec<Vec<f64>> {
    let crowd = (family.places.len() as f64 / MOST_NODES).sqrt();
    let spacing = family.pitch * (0.5 * crowd).clamp(1.0, 4.0);
    let share = error * 0.5_f64.sqrt();
    let mut columns = bumps(family, spacing, (share, count));
    columns.extend(bumps(family, 2.0 * spacing, (share, count)));
    columns
}

fn bumps(family: &Family<'_>, spacing: f64, (error, count): (f64, usize)) -> Vec<Vec<f64>> {
    let mut nodes: Vec<Vector3<f64>> = Vec::new();
    for place in &family.places {
        if nodes
            .iter()
            .all(|node| (node - place).norm() >= 0.9 * spacing)
        {
            nodes.push(*place);
        }
    }
    let mut columns = vec![vec![0.0; count]; nodes.len()];
    for ((at, cell_sum), place) in family.cell_sums.iter().zip(&family.places) {
        let bump =
            |node: &Vector3<f64>| (-(node - place).norm_squared() / (spacing * spacing)).exp();
        let bumps: Vec<f64> = nodes.iter().map(bump).collect();
        let length = bumps.iter().map(|b| b * b).sum::<f64>().sqrt().max(1e-3);
        for (column, bump) in columns.iter_mut().zip(&bumps) {
            column[*at] = error * cell_sum.peak * cell_sum.weight * bump / length;
        }
    }
    columns
}

/// Gram-Schmidt, twice over, dependent columns left out.
fn orthonormal(columns: Vec<Vec<f64>>, count: usize) -> DMatrix<f64> {
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let before = norm(&column);
        for _ in 0..2 {
            for other in &kept {
                let along: f64 = column.iter().zip(other).map(|(a, b)| a * b).sum();
                column
                    .iter_mut()
                    .zip(other)
                    .for_each(|(a, b)| *a -= along * b);
            }
        }
        let left = norm(&column);
        if left > DEPENDENT * before && left > 0.0 {
            column.iter_mut().for_each(|value| *value /= left);
            kept.push(column);
        }
    }
    matrix(&kept, count)
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|value| value * value).sum::<f64>().sqrt()
}

fn matrix(columns: &[Vec<f64>], count: usize) -> DMatrix<f64> {
    DMatrix::from_fn(count, columns.len(), |row, column| columns[column][row])
}
