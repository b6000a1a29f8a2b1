//! What a scan sees of a press: how far the scanned points lie from the deformed skin.

use std::sync::Arc;

use nalgebra::Vector3;
use thenar_contact::{Control, Demand, Material};
use thenar_surface::{Mesh, Vec3};

use super::{Key, Nuisance, Replay};
use crate::DiagnosisError;
use crate::observe::laying::{Pose, Surface, moved};
use crate::observe::{Quantity, Scan};

/// Parts of the deepest press at which the skin's shape is solved, straight between them. It grows about as the power 3/2 of the depth, of
/// which straight lines over a twelfth of it miss less than 1e-3.
const RUNGS: usize = 12;
/// Shapes kept for each tool and place.
const MOST_KEPT: usize = 4;

/// Displacement of every vertex, mm.
type Shape = Arc<Vec<Vec3>>;

/// Shapes of the skin under one tool, by material and rung.
#[derive(Default)]
pub struct Shapes {
    kept: Vec<(Key, Vec<Option<Shape>>)>,
}

/// The skin of a study as scans are held against it.
pub struct Scanned {
    surface: Surface,
}

impl Scanned {
    /// Of the study's skin.
    ///
    /// # Errors
    /// [`DiagnosisError::Skin`].
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Scanned, DiagnosisError> {
        let mesh = Mesh::new(positions.to_vec(), triangles.to_vec());
        Ok(Scanned {
            surface: Surface::new(mesh.map_err(DiagnosisError::Skin)?),
        })
    }

    /// Simulated heights over the skin at rest by place, mm: the measured ones less the mean distance of their points from the skin
    /// that is displaced, with the scan moved by `pose`. NaN for a place without points.
    fn heights(
        &self,
        scan: &Scan,
        measured: &[f64],
        (displacement, pose): (&[Vec3], &Pose),
    ) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); scan.places.len()];
        let Some(surface) = self.surface.displaced(displacement) else {
            return vec![f64::NAN; scan.places.len()];
        };
        for point in &scan.points {
            let at = moved(point.position, pose, scan.center);
            let sum: &mut (f64, f64) = &mut sums[point.place as usize];
            *sum = (
                sum.0 + surface.foot(at, point.triangle).distance,
                sum.1 + 1.0,
            );
        }
        sums.iter()
            .zip(measured)
            .map(|((sum, count), height)| height - sum / count)
            .collect()
    }
}

impl Replay {
    /// Values of a scan's samples.
    pub(super) fn seen(
        &self,
        recording: usize,
        nuisance: &Nuisance,
        displacement: &[Vec3],
    ) -> Vec<f64> {
        let measured = &self.observed.measured[recording];
        let (Some(scan), Some(scanned)) = (&measured.scan, &self.scanned) else {
            return Vec::new();
        };
        let mut heights = vec![f64::NAN; scan.places.len()];
        for sample in &measured.samples {
            if let Quantity::Scan(place) = sample.quantity {
                heights[place as usize] = sample.value;
            }
        }
        scanned.heights(scan, &heights, (displacement, &nuisance.scan))
    }

    /// Displacement of every vertex of the skin at the depth of a recording's last moment, mm; empty of a recording that is no scan.
    pub(super) fn displacement(
        &mut self,
        recording: usize,
        (materials, depth): (&[Material], f64),
        control: &Control<'_>,
    ) -> Result<Vec<Vec3>, DiagnosisError> {
        if self.observed.measured[recording].scan.is_none() {
            return Ok(Vec::new());
        }
        let at = self.place_of[recording];
        let deepest = self.places[at].deepest;
        let place = (depth.max(0.0) / deepest * RUNGS as f64).min(RUNGS as f64);
        let low = (place as usize).min(RUNGS - 1);
        let share = place - low as f64;
        // With one region and no effect of its own stiffness the shape depends on the depth alone: that of the start serves all moduli.
        let key = self.key(materials);
        let one = self.shape(at, (&key, low), control)?;
        let two = self.shape(at, (&key, low + 1), control)?;
        let between = |(a, b): (&Vector3<f64>, &Vector3<f64>)| a + (b - a) * share;
        Ok(one.iter().zip(two.iter()).map(between).collect())
    }

    fn shape(
        &mut self,
        at: usize,
        (key, rung): (&Key, usize),
        control: &Control<'_>,
    ) -> Result<Shape, DiagnosisError> {
        let kept = &mut self.places[at].shapes.kept;
        let found = kept
            .iter()
            .position(|(other, _)| other == key)
            .unwrap_or_else(|| {
                if kept.len() == MOST_KEPT {
                    kept.remove(0);
                }
                kept.push((key.clone(), vec![None; RUNGS + 1]));
                kept.len() - 1
            });
        if let Some(shape) = &kept[found].1[rung] {
            return Ok(shape.clone());
        }
        let scanned = self.scanned.as_ref();
        let count = scanned.map_or(0, |scanned| scanned.surface.positions().len());
        let depth = self.places[at].deepest * rung as f64 / RUNGS as f64;
        let shape = Arc::new(match rung {
            0 => vec![Vec3::zeros(); count],
            _ => {
                let title = self.places[at].title.clone();
                let depths = [0.5 * depth, depth].map(Demand::Depth);
                self.pressed_by(at, (key, &depths), (&title, control))?
                    .displacement
            }
        });
        self.places[at].shapes.kept[found].1[rung] = Some(shape.clone());
        Ok(shape)
    }
}
