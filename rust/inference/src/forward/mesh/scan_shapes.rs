//! Deformed shapes of the skin under a tool, cached by material, and the heights that a scan of them gives.

use std::sync::Arc;

use thenar_surface::{Mesh, Vec3};

use crate::errors::InferenceError;
use crate::forward::mesh::press_key::Key;
use crate::observe::measured::Scan;
use crate::observe::scan_registration::{Pose, Surface, moved};

/// Parts of the deepest press at which the skin's shape is solved, straight between them. It grows about as the power 3/2 of the depth, of
/// which straight lines over a twelfth of it miss less than 1e-3.
pub(crate) const RUNGS: usize = 12;

/// Shapes kept for each tool and place.
pub(crate) const MOST_KEPT: usize = 4;

/// Displacement of every vertex, mm.
pub type Shape = Arc<Vec<Vec3>>;

/// Shapes of the skin under one tool, by material and rung.
#[derive(Default)]
pub struct Shapes {
    pub kept: Vec<(Key, Vec<Option<Shape>>)>,
}

/// The skin of a study as scans are held against it.
pub struct Scanned {
    pub surface: Surface,
}

impl Scanned {
    /// Of the study's skin.
    ///
    /// # Errors
    /// [`InferenceError::Skin`].
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Scanned, InferenceError> {
        let mesh = Mesh::new(positions.to_vec(), triangles.to_vec());
        Ok(Scanned {
            surface: Surface::new(mesh.map_err(InferenceError::Skin)?),
        })
    }

    /// Simulated heights over the skin at rest by place, mm: the measured ones less the mean distance of their points from the skin
    /// that is displaced, with the scan moved by `pose`. NaN for a place without points.
    pub fn heights(
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
