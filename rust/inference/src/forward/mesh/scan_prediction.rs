//! Predicted distances of scanned points from the deformed skin.

use std::sync::Arc;

use nalgebra::Vector3;
use thenar_contact::{Control, Demand, Material};
use thenar_surface::Vec3;

use crate::errors::InferenceError;
use crate::forward::mesh::nuisance::Nuisance;
use crate::forward::mesh::press_key::Key;
use crate::forward::mesh::replay::Replay;
use crate::forward::mesh::scan_shapes::{MOST_KEPT, RUNGS, Shape};
use crate::observe::measured::Quantity;

impl Replay {
    /// Values of a scan's samples.
    pub(crate) fn seen(
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
    pub(crate) fn displacement(
        &mut self,
        recording: usize,
        (materials, depth): (&[Material], f64),
        control: &Control<'_>,
    ) -> Result<Vec<Vec3>, InferenceError> {
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
    ) -> Result<Shape, InferenceError> {
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
