//! Conducts the making of a hand: skeleton, flesh, skin, then what each vertex belongs to.

use crate::anatomy::{Place, places};
use crate::armature::{Bone, bones};
use crate::error::HandError;
use crate::flesh::Flesh;
use crate::regions::{
    FINGER_THICKNESS_MM, PALM_THICKNESS_MM, REGION_NAMES, RegionKind, region_kinds, regions,
};
use crate::size::{HandShape, Side};
use crate::skeleton::Skeleton;
use crate::skin::{Soup, extract, remesh};
use crate::weights::{VertexWeights, weights};
use thenar_surface::{Adjacency, Mesh, Vec3};

/// A hand at rest: flat, fingers slightly bent and spread. Origin in the wrist crease, +Y to the fingers, +Z out of the palm,
/// +X to the thumb of a right hand and away from it on a left one. All lengths in mm.
#[derive(Debug, Clone)]
pub struct Hand {
    /// Closed skin, normals outward.
    pub mesh: Mesh,
    /// Region of every vertex, a place in `region_names`, or [`crate::NO_REGION`].
    pub regions: Vec<i32>,
    /// Names of the 19 palmar regions.
    pub region_names: [&'static str; 19],
    /// Finger or palm, for each region.
    pub kinds: [RegionKind; 19],
    /// Soft tissue over bone, mm, for each region; see [`crate::FINGER_THICKNESS_MM`].
    pub thickness_mm: [f64; 19],
    /// Bones of the rig, parents first.
    pub bones: Vec<Bone>,
    /// What each vertex follows.
    pub weights: Vec<VertexWeights>,
    /// True on the nail plates.
    pub nails: Vec<bool>,
}

/// Edges come out this much shorter when asked for; the remesh ends with a median edge of 1.12 times the length it aims at.
const AIM: f64 = 0.885;

impl HandShape {
    /// Makes the hand: skin, regions, bones and weights.
    ///
    /// # Errors
    /// [`HandError::OutOfRange`] for a measurement no hand has, [`HandError::NotClosed`] if the skin has a hole.
    pub fn build(&self) -> Result<Hand, HandError> {
        let (length, breadth) = self.length_and_breadth()?;
        let skeleton = Skeleton::new(length, breadth);
        let flesh = Flesh::new(&skeleton);
        let not_closed = HandError::NotClosed {
            spacing_mm: self.spacing_mm,
        };
        let step = (0.5 * self.spacing_mm).clamp(0.9, 1.3);
        let spacing = |p: Vec3| wanted_spacing(&flesh, self.spacing_mm, p);
        let skin = remesh(&flesh, &spacing, extract(&flesh, step)).ok_or(not_closed)?;
        let places = places(&flesh, &skin.positions);
        let bones = bones(&skeleton, flesh.cut_y);
        let hand = assemble(&skeleton, skin, &places, bones, self.spacing_mm)?;
        Ok(match self.side {
            Side::Right => hand,
            Side::Left => mirrored(&hand)?,
        })
    }
}

fn assemble(
    skeleton: &Skeleton,
    skin: Soup,
    places: &[Place],
    bones: Vec<Bone>,
    spacing: f64,
) -> Result<Hand, HandError> {
    let mesh = Mesh::new(skin.positions, skin.triangles)?;
    let adjacency = Adjacency::new(&mesh);
    let kinds = region_kinds();
    let thickness = |kind| match kind {
        RegionKind::Finger => FINGER_THICKNESS_MM,
        RegionKind::Palm => PALM_THICKNESS_MM,
    };
    Ok(Hand {
        regions: regions(skeleton, places, &adjacency),
        region_names: REGION_NAMES,
        kinds,
        thickness_mm: kinds.map(thickness),
        weights: weights(skeleton, &bones, places, &adjacency, spacing),
        nails: places.iter().map(|place| place.nail <= 0.0).collect(),
        bones,
        mesh,
    })
}

/// Half the spacing along the outline of a nail, so that its edge survives; grows by half a mm each mm away from it.
fn wanted_spacing(flesh: &Flesh, spacing: f64, p: Vec3) -> f64 {
    let (spacing, fine) = (
        AIM * spacing,
        (AIM * 0.5 * spacing).max(0.8).min(AIM * spacing),
    );
    (0..flesh.nails().len())
        .map(|k| fine + 0.5 * (flesh.nail_distance(k, p) - 0.7).max(0.0))
        .fold(spacing, f64::min)
}

fn mirrored(hand: &Hand) -> Result<Hand, HandError> {
    let positions = hand
        .mesh
        .positions()
        .iter()
        .map(|p| Vec3::new(-p.x, p.y, p.z))
        .collect();
    let triangles = hand
        .mesh
        .triangles()
        .iter()
        .map(|t| [t[0], t[2], t[1]])
        .collect();
    let bones = hand.bones.iter().map(Bone::mirrored).collect();
    Ok(Hand {
        mesh: Mesh::new(positions, triangles)?,
        bones,
        ..hand.clone()
    })
}
