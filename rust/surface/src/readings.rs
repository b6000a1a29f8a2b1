//! Gaps of the same points from posture to posture: only what moved is measured anew.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::facing::Facing;
use crate::mesh::Vec3;
use crate::nearest::Pending;
use crate::poke::{Skin, settle};
use crate::product::{Gap, GapLimits, Product};

/// Points answered by one task.
const CHUNK: usize = 256;

/// What was read of some points the last time, before skin that has come through a wall was told from other skin.
#[derive(Debug, Clone, Default)]
pub struct Readings {
    /// Of which product; 0: of none.
    product: u64,
    limits: Option<GapLimits>,
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    gaps: Vec<Option<Gap>>,
}

/// A number that no other product of this process has.
pub(crate) fn new_number() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl Product {
    /// [`Product::gaps`], bit for bit; points that lie and face as in `readings` are not measured anew. Keeps what was read there.
    ///
    /// `points` (n), mm; `skin_normals` (n), unit, zero where there is none.
    pub fn gaps_after(
        &self,
        readings: &mut Readings,
        (points, skin_normals): (&[Vec3], &[Vec3]),
        limits: GapLimits,
    ) -> Vec<Option<Gap>> {
        let fits = readings.product == self.number()
            && readings.limits == Some(limits)
            && readings.points.len() == points.len();
        if !fits {
            let missing = Vec3::repeat(f64::NAN);
            let hints = std::mem::take(&mut readings.gaps);
            *readings = Readings {
                product: self.number(),
                limits: Some(limits),
                points: vec![missing; points.len()],
                normals: vec![missing; points.len()],
                gaps: if hints.len() == points.len() {
                    hints
                } else {
                    vec![None; points.len()]
                },
            };
        }
        let Readings {
            points: before,
            normals,
            gaps,
            ..
        } = readings;
        let parts = gaps
            .par_chunks_mut(CHUNK)
            .zip(
                before
                    .par_chunks_mut(CHUNK)
                    .zip(normals.par_chunks_mut(CHUNK)),
            )
            .zip(points.par_chunks(CHUNK).zip(skin_normals.par_chunks(CHUNK)));
        parts.for_each(|((gaps, (before, faced)), (points, normals))| {
            let mut pending = Pending::default();
            let mut facing = Facing::new(self, limits, &mut pending);
            let mut last = None;
            for k in 0..points.len() {
                if before[k] != points[k] || faced[k] != normals[k] {
                    let hint = gaps[k].map(|g| g.triangle).or(last);
                    gaps[k] = facing.gap(points[k], Some(normals[k]), hint);
                    (before[k], faced[k]) = (points[k], normals[k]);
                    last = gaps[k].map(|g| g.triangle).or(last);
                }
            }
        });
        let mut settled = gaps.clone();
        let skin = Skin {
            points,
            normals: skin_normals,
        };
        settle(self, &skin, limits, &mut settled);
        settled
    }
}
