//! How the skin of a posture faces what it was measured to.

use crate::mesh::adjacency::Adjacency;
use crate::mesh::triangles::Vec3;
use crate::solid::gap::{Gap, GapLimits};

/// Cosine between skin normal and the product's outward direction from which a point outside may have come through,
/// and from which a wall is none that it came through. Tests pass from 0.1 to 0.5.
pub(crate) const FACING_AWAY: f64 = 0.3;

/// A skin in one posture, in the product's frame.
#[derive(Debug, Clone, Copy)]
pub struct PosedSkin<'a> {
    /// Vertices (n), mm.
    pub points: &'a [Vec3],
    /// Outward normals (n), unit, zero where there is none.
    pub normals: &'a [Vec3],
    /// Without it nothing is known of the flesh behind a vertex.
    pub surface: Option<SkinSurface<'a>>,
}

/// The surface of a skin.
#[derive(Debug, Clone, Copy)]
pub struct SkinSurface<'a> {
    /// Turned outward.
    pub triangles: &'a [[u32; 3]],
    /// Of those triangles.
    pub adjacency: &'a Adjacency,
}

impl<'a> PosedSkin<'a> {
    /// Points with normals, of a skin whose surface is not known.
    pub fn of_points(points: &'a [Vec3], normals: &'a [Vec3]) -> PosedSkin<'a> {
        PosedSkin {
            points,
            normals,
            surface: None,
        }
    }
}

/// How skin faces what it was measured to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    /// Nothing was within reach.
    Nothing,
    /// As skin does that is pressed.
    Toward,
    /// It is inside and faces as the nearest wall does: it may lie beyond the middle of that wall.
    Within,
    /// It is outside and faces away: it may have come through.
    Away,
}

impl Sight {
    /// Of a point with a skin normal and its gap.
    pub(crate) fn new(gap: Option<&Gap>, normal: &Vec3, limits: GapLimits) -> Sight {
        let Some(gap) = gap else {
            return Sight::Nothing;
        };
        let is_outside = gap.distance > 0.0 && gap.distance <= limits.max_depth_mm;
        let away = gap.normal.dot(normal);
        if is_outside && away > FACING_AWAY {
            Sight::Away
        } else if gap.distance <= 0.0 && away > 0.0 {
            Sight::Within
        } else {
            Sight::Toward
        }
    }
}

/// Points that have a reading, and those of them that face as what they were measured to does.
pub(crate) fn seen_and_away(sights: &[Sight]) -> (Vec<u32>, Vec<u32>) {
    let those = |wanted: fn(&Sight) -> bool| {
        let all = (0..).zip(sights).filter(|(_, sight)| wanted(sight));
        all.map(|(i, _)| i).collect()
    };
    (
        those(|sight| *sight != Sight::Nothing),
        those(|sight| matches!(sight, Sight::Away | Sight::Within)),
    )
}
