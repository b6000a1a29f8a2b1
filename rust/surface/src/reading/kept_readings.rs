//! Gaps of the same points from posture to posture: only what moved is measured anew.

use std::sync::Arc;

use crate::mesh::triangles::Vec3;
use crate::reading::facing::{PosedSkin, Sight};
use crate::reading::opposing_wall::{Facing, Turned};
use crate::reading::skin_queries::{FEW, deal};
use crate::reading::through_walls::settle;
use crate::solid::gap::{Gap, GapLimits};
use crate::solid::product::Product;
use crate::tree::nearest::Pending;

/// Points answered by one task.
const CHUNK: usize = 256;

/// What was read of some points the last time.
#[derive(Debug, Clone, Default)]
pub struct Readings {
    /// Of which product; 0: of none.
    product: u64,
    limits: Option<GapLimits>,
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    gaps: Arc<Vec<Option<Gap>>>,
    /// Their distances, mm; infinite where there is none.
    distances: Vec<f64>,
    /// How each faces what it was measured to, before skin that has come through a wall was told from other skin.
    sights: Vec<Sight>,
    /// What was read of skin that may have come through a wall, before it was told from other skin.
    plain: Vec<(u32, Option<Gap>)>,
    /// How far each may go before a face can be within the cut-off, mm; 0 if not known, NaN if nothing was read.
    rooms: Vec<f64>,
}

impl Readings {
    /// The signed distances of the gaps handed out last, mm; infinite where there is none. Most that ask need no more.
    pub fn distances(&self) -> &[f64] {
        &self.distances
    }
}

fn distance(gap: &Option<Gap>) -> f64 {
    gap.as_ref().map_or(f64::INFINITY, |gap| gap.distance)
}

impl Product {
    /// [`Product::gaps`], bit for bit; points that lie and face as in `readings` are not measured anew. Keeps what was read there, and hands
    /// it out: who lets go of it before the next query saves the copying of what stays.
    ///
    pub fn gaps_after(
        &self,
        readings: &mut Readings,
        skin: &PosedSkin<'_>,
        limits: GapLimits,
    ) -> Arc<Vec<Option<Gap>>> {
        let (points, skin_normals) = (skin.points, skin.normals);
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
                    Arc::new(vec![None; points.len()])
                },
                distances: vec![f64::INFINITY; points.len()],
                sights: vec![Sight::Nothing; points.len()],
                plain: Vec::new(),
                rooms: vec![f64::NAN; points.len()],
            };
        }
        let gaps = Arc::make_mut(&mut readings.gaps);
        for (k, plain) in readings.plain.drain(..) {
            gaps[k as usize] = plain;
            readings.distances[k as usize] = distance(&plain);
        }
        self.read_moved(readings, (points, skin_normals), limits);
        let gaps = Arc::make_mut(&mut readings.gaps);
        readings.plain = settle(self, skin, limits, (&readings.sights, gaps));
        for (k, _) in &readings.plain {
            readings.distances[*k as usize] = distance(&gaps[*k as usize]);
        }
        Arc::clone(&readings.gaps)
    }

    /// Measures anew what moved or turned.
    fn read_moved(
        &self,
        readings: &mut Readings,
        (points, skin_normals): (&[Vec3], &[Vec3]),
        limits: GapLimits,
    ) {
        let before = readings.points.iter().zip(&readings.normals);
        let now = points.iter().zip(skin_normals);
        let moved = before.zip(now).filter(|(before, now)| before != now);
        let are_few = moved.take(FEW).count() < FEW;
        let parts = Arc::make_mut(&mut readings.gaps)
            .chunks_mut(CHUNK)
            .zip(readings.rooms.chunks_mut(CHUNK))
            .zip(readings.distances.chunks_mut(CHUNK))
            .zip(readings.sights.chunks_mut(CHUNK))
            .zip(readings.points.chunks_mut(CHUNK))
            .zip(readings.normals.chunks_mut(CHUNK))
            .zip(points.chunks(CHUNK).zip(skin_normals.chunks(CHUNK)));
        deal(
            parts,
            are_few,
            |((((((gaps, rooms), distances), sights), before), faced), (points, normals))| {
                let mut pending = Pending::default();
                let mut facing = Facing::new(self, (limits, Turned::Nearest), &mut pending);
                let mut last = None;
                for k in 0..points.len() {
                    let (point, normal) = (points[k], normals[k]);
                    if before[k] == point && faced[k] == normal {
                        continue;
                    }
                    let room = rooms[k] - (point - before[k]).norm();
                    let hint = gaps[k].map(|g| g.triangle).or(last);
                    (gaps[k], rooms[k]) = if room > 0.0 {
                        (facing.gap_beyond(point, Some(normal)), room)
                    } else if !rooms[k].is_nan() {
                        facing.gap_and_room(point, Some(normal), hint)
                    } else {
                        (facing.gap(point, Some(normal), hint), 0.0)
                    };
                    distances[k] = distance(&gaps[k]);
                    sights[k] = Sight::new(gaps[k].as_ref(), &normal, limits);
                    (before[k], faced[k]) = (point, normal);
                    last = gaps[k].map(|g| g.triangle).or(last);
                }
            },
        );
    }
}
