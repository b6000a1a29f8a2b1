//! Mean pressure over each sensel of a placed mat, against depth.

use std::sync::Arc;

use rayon::prelude::*;
use thenar_contact::ActiveEffect;
use thenar_contact::effects::Effect;
use thenar_contact::instrument::{Mat as Sensels, MatLayout, Placement, PointLoad, Spot};

use crate::errors::InferenceError;
use crate::forward::mesh::press_table::Basis;
use crate::interpolation::Table;
use crate::observe::measured::Mat;
use thenar_surface::Vec3;

/// Readings kept for each recording.
const MOST_KEPT: usize = 60;

/// By part of a basis and rung, where each load lies.
type Located = Vec<Vec<Vec<Option<Spot>>>>;

/// A mat that reads presses.
pub struct Reader {
    sensels: Sensels,
    /// Where the loads of a ladder's rungs lie on the mat, that of the last ladder.
    located: Option<(Arc<Basis>, Located)>,
    kept: Vec<(Arc<Basis>, Placement, Arc<Readings>)>,
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
        let of = |(part, w): (&Vec<Option<Table>>, &f64)| match &part[sensel] {
            Some(table) => w * table.at(root),
            None => 0.0,
        };
        self.parts.iter().zip(weights).map(of).sum::<f64>().max(0.0)
    }
}

impl Reader {
    /// A reader for a mat in skin coordinates at first touch, that of `recording`.
    ///
    /// # Errors
    /// What the contact model says of the mat.
    pub fn new(mat: &Mat, recording: &str) -> Result<Reader, InferenceError> {
        let layout = MatLayout {
            centers: mat.centers.clone(),
            normals: mat.normals.clone(),
            areas: mat.areas.clone(),
            along: None,
        };
        let what = format!("the mat of recording '{recording}'");
        let sensels = Sensels::new(layout).map_err(InferenceError::of_contact(what))?;
        Ok(Reader {
            sensels,
            located: None,
            kept: Vec::new(),
        })
    }

    /// The mat.
    pub fn sensels(&self) -> &Sensels {
        &self.sensels
    }

    /// Readings of a press with the mat so placed; the same again for the same input.
    pub fn readings(&mut self, basis: &Arc<Basis>, placement: Placement) -> Arc<Readings> {
        let is_kept = |(of, at, _): &&(Arc<Basis>, Placement, Arc<Readings>)| {
            Arc::ptr_eq(of, basis) && *at == placement
        };
        if let Some((_, _, readings)) = self.kept.iter().find(is_kept) {
            return readings.clone();
        }
        let sensels = &self.sensels;
        if !matches!(&self.located, Some((of, _)) if Arc::ptr_eq(of, basis)) {
            let of = |rungs: &Vec<Vec<PointLoad>>| {
                let each = rungs.par_iter().map(|loads| sensels.locate(loads));
                each.collect()
            };
            self.located = Some((basis.clone(), basis.loads.iter().map(of).collect()));
        }
        let located = self.located.iter().flat_map(|(_, located)| located);
        let presses: Vec<Vec<Vec<f64>>> = basis
            .loads
            .iter()
            .zip(located)
            .map(|(rungs, spots)| {
                let each = rungs.par_iter().zip(spots);
                each.map(|(loads, spots)| sensels.read_located((loads, spots), &placement))
                    .collect()
            })
            .collect();
        let part = |mix: &Vec<f64>| -> Vec<Option<Table>> {
            (0..self.sensels.len())
                .map(|sensel| {
                    let value = |rung: usize| -> f64 {
                        presses
                            .iter()
                            .zip(mix)
                            .map(|(press, m)| m * press[rung][sensel])
                            .sum()
                    };
                    let is_loaded = presses
                        .iter()
                        .any(|p| p.iter().any(|rung| rung[sensel] != 0.0));
                    let values = || (0..basis.roots.len()).map(value).collect();
                    is_loaded.then(|| Table::new(&basis.roots, values()))
                })
                .collect()
        };
        let readings = Arc::new(Readings {
            parts: basis.mix.iter().map(part).collect(),
        });
        if self.kept.len() == MOST_KEPT {
            self.kept.remove(0);
        }
        self.kept.push((basis.clone(), placement, readings.clone()));
        readings
    }
}

/// A mat's placement once its tool has slid over the skin, mm along it: the mat goes with the tool.
///
/// The skin under a plane stays where it is, and its pressures wander over the mat. Of a tool that is curved along the way only the mat's
/// share of the slide is followed, not that it presses elsewhere.
pub fn slid(mut placement: Placement, sensels: &Sensels, slide: &Vec3) -> Placement {
    if *slide == Vec3::zeros() {
        return placement;
    }
    let far = |at: &[f64; 2]| at[0].hypot(at[1]);
    let flat = sensels.flat().iter().map(far).enumerate();
    let middle = flat
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |(k, _)| k);
    for (axis, shift) in sensels.axes()[middle].iter().zip(&mut placement.shift_mm) {
        *shift += axis.dot(slide);
    }
    placement
}

/// A placement with what effects of misregistration add to it.
pub fn misplaced(mut placement: Placement, effects: &[ActiveEffect]) -> Placement {
    for effect in effects
        .iter()
        .filter(|e| e.effect == Effect::Misregistration)
    {
        let of = |name: &str| effect.amplitude * effect.number(name);
        placement.shift_mm[0] += of("shift_1_mm");
        placement.shift_mm[1] += of("shift_2_mm");
        placement.turn_rad += of("turn_rad");
    }
    placement
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five by five sensels of 2 mm in the plane z = 0, and a load on the middle of the skin.
    #[test]
    fn load_wanders_over_a_mat_against_its_slide() {
        let places = (0..25).map(|k| (f64::from(k % 5) - 2.0, f64::from(k / 5) - 2.0));
        let centers: Vec<Vec3> = places
            .map(|(x, y)| Vec3::new(2.0 * x, 2.0 * y, 0.0))
            .collect();
        let layout = MatLayout {
            normals: vec![Vec3::z(); 25],
            areas: vec![4.0; 25],
            along: None,
            centers,
        };
        let sensels = Sensels::new(layout).unwrap();
        let load = PointLoad {
            position: Vec3::zeros(),
            force_n: 1.0,
            area_mm2: 1.0,
        };
        for slide in [
            Vec3::new(2.0, 0.0, 0.0),
            Vec3::new(0.0, -4.0, 0.0),
            Vec3::zeros(),
        ] {
            let placement = slid(Placement::default(), &sensels, &slide);
            let read = sensels.read_at(&[load], &placement);
            let loaded = (0..25).filter(|k| read[*k] > 0.0).collect::<Vec<usize>>();
            assert_eq!(loaded.len(), 1);
            assert!(
                (sensels.centers()[loaded[0]] + slide).norm() < 1e-9,
                "{slide:?} {loaded:?}"
            );
        }
    }
}
