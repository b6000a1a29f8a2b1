//! The hand in another posture: joint angles to bone transforms to skin (linear blend skinning).

use crate::build::Hand;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use thenar_surface::Vec3;

/// A turn of one joint away from rest, radians.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointTurn {
    /// About [`crate::Bone::flexion_axis`].
    pub flexion: f64,
    /// About [`crate::Bone::abduction_axis`], before the flexion.
    pub abduction: f64,
}

impl Hand {
    /// World transform of every bone, from rest to the posture; `turns` one per bone.
    ///
    /// # Panics
    /// If `turns` has not one entry per bone.
    pub fn bone_transforms(&self, turns: &[JointTurn]) -> Vec<Isometry3<f64>> {
        assert_eq!(turns.len(), self.bones.len(), "one turn per bone");
        let mut world: Vec<Isometry3<f64>> = Vec::with_capacity(turns.len());
        for (bone, turn) in self.bones.iter().zip(turns) {
            let flexion = UnitQuaternion::from_scaled_axis(bone.flexion_axis * turn.flexion);
            let abduction = UnitQuaternion::from_scaled_axis(bone.abduction_axis * turn.abduction);
            let about = Translation3::from(bone.head)
                * (abduction * flexion)
                * Translation3::from(-bone.head);
            world.push(
                bone.parent
                    .map_or(Isometry3::identity(), |parent| world[parent])
                    * about,
            );
        }
        world
    }

    /// Vertices of the skin in a posture, mm, in mesh order.
    pub fn posed(&self, turns: &[JointTurn]) -> Vec<Vec3> {
        let world = self.bone_transforms(turns);
        let blend = |(position, weights): (&Vec3, &crate::VertexWeights)| {
            (0..4).fold(Vec3::zeros(), |sum, k| {
                let moved = world[weights.bones[k] as usize] * nalgebra::Point3::from(*position);
                sum + moved.coords * weights.shares[k]
            })
        };
        self.mesh
            .positions()
            .iter()
            .zip(&self.weights)
            .map(blend)
            .collect()
    }
}
