//! What a placed mat reads of a press: the mean pressure over each sensel, against depth.

use std::sync::Arc;

use nalgebra::Vector3;
use thenar_contact::instrument::{Mat as Sensels, MatLayout, PointLoad};
use thenar_surface::Vec3;

use super::interpolation::Table;
use super::press_table::Basis;
use super::tissue::Tissue;
use crate::DiagnosisError;
use crate::observe::{Mat, across};

/// Readings kept for each recording.
const MOST_KEPT: usize = 8;

/// A mat that reads presses.
pub struct Reader {
    mat: Mat,
    sensels: Option<Sensels>,
    kept: Vec<(Arc<Basis>, [f64; 2], Arc<Readings>)>,
}

/// Pressure over every sensel against the root of the depth, by part of the basis, kPa.
pub struct Readings {
    /// None for a sensel that no rung of the ladder loads.
    parts: Vec<Vec<Option<Table>>>,
}

impl Readings {
    /// Pressure over a sensel at a depth, kPa.
    pub fn at(&self, sensel: usize, weights: &[f64], depth: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let root = depth.sqrt();
        let of = |(part, w): (&Vec<Option<Table>>, &f64)| {
            part[sensel]
                .as_ref()
                .map_or(0.0, |table| w * table.at(root))
        };
        self.parts.iter().zip(weights).map(of).sum::<f64>().max(0.0)
    }
}

impl Reader {
    /// A reader for a mat in skin coordinates at first touch.
    pub fn new(mat: Mat) -> Reader {
        Reader {
            mat,
            sensels: None,
            kept: Vec::new(),
        }
    }

    /// Readings of a press with the mat shifted across the travel; the same again for the same input.
    ///
    /// # Errors
    /// What the contact model says of the mat.
    pub fn readings(
        &mut self,
        (basis, tissue): (&Arc<Basis>, &Tissue),
        (direction, shift): (Vec3, [f64; 2]),
    ) -> Result<Arc<Readings>, DiagnosisError> {
        let is_kept = |(of, at, _): &&(Arc<Basis>, [f64; 2], Arc<Readings>)| {
            Arc::ptr_eq(of, basis) && *at == shift
        };
        if let Some((_, _, readings)) = self.kept.iter().find(is_kept) {
            return Ok(readings.clone());
        }
        let moved = axes(direction);
        let moved = moved[0] * shift[0] + moved[1] * shift[1];
        let mut parts = Vec::new();
        for part in &basis.pressure {
            let mut rungs = Vec::new();
            for (pressure, root) in part.iter().zip(&basis.roots) {
                // The mat travels with the tool and lies `moved` from where it should: the loads move the other way.
                let travel = direction * (basis.touch_offset + root * root) + moved;
                rungs.push(self.read((pressure, tissue), travel)?);
            }
            parts.push(tables(&basis.roots, &rungs));
        }
        let readings = Arc::new(Readings { parts });
        if self.kept.len() == MOST_KEPT {
            self.kept.remove(0);
        }
        self.kept.push((basis.clone(), shift, readings.clone()));
        Ok(readings)
    }

    /// Mean pressure over every sensel, kPa, with the mat moved by `travel`.
    pub fn read(
        &mut self,
        (pressure, tissue): (&[(u32, f64)], &Tissue),
        travel: Vec3,
    ) -> Result<Vec<f64>, DiagnosisError> {
        let load = |(vertex, pressure): &(u32, f64)| {
            let vertex = *vertex as usize;
            PointLoad {
                position: tissue.positions[vertex] - travel,
                force_n: pressure * tissue.areas[vertex],
                area_mm2: tissue.areas[vertex],
            }
        };
        let loads: Vec<PointLoad> = pressure.iter().map(load).collect();
        if self.sensels.is_none() {
            let layout = MatLayout {
                centers: self.mat.centers.clone(),
                normals: self.mat.normals.clone(),
                areas: self.mat.areas.clone(),
                along: None,
            };
            let laid = Sensels::new(layout).map_err(DiagnosisError::of_contact("the mat"))?;
            self.sensels = Some(laid);
        }
        Ok(self
            .sensels
            .as_ref()
            .map_or_else(Vec::new, |mat| mat.read(&loads)))
    }
}

/// The two directions in which a mat's pose is fitted.
pub(super) fn axes(direction: Vec3) -> [Vector3<f64>; 2] {
    let x = across(direction);
    [x, direction.cross(&x)]
}

fn tables(roots: &[f64], rungs: &[Vec<f64>]) -> Vec<Option<Table>> {
    let sensels = rungs.first().map_or(0, Vec::len);
    let table = |k: usize| {
        let values: Vec<f64> = rungs.iter().map(|rung| rung[k]).collect();
        values
            .iter()
            .any(|v| *v != 0.0)
            .then(|| Table::new(roots, values))
    };
    (0..sensels).map(table).collect()
}
