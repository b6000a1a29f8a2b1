//! Posture and product of one protocol row, in the product's frame; rotation of the skin since the row before.

use nalgebra::{Isometry3, Matrix3, Rotation3};
use rayon::prelude::*;
use thenar_surface::{Mesh, Product, Vec3, vertex_normals};

use crate::fields::result::Contact;
use crate::skin::prepare::Skin;

/// A rigid motion, mm and rad.
pub type Motion = Isometry3<f64>;

/// Where hand and product stand.
#[derive(Clone, Copy)]
pub struct Stand<'a> {
    /// The product, as it was prepared: the same for all rows.
    pub product: &'a Product,
    /// Posed positions, mm, one per prepared vertex; None: the rest pose.
    pub posed: Option<&'a [Vec3]>,
    /// Where the product is: from its own frame to that of the posed positions; None: they are one.
    pub motion: Option<Motion>,
}

/// Posed positions as the product sees them, mm.
pub fn to_product_frame(posed: &mut [Vec3], motion: &Motion) {
    let back = motion.inverse();
    for position in posed {
        *position = back * nalgebra::Point3::from(*position) - nalgebra::Point3::origin();
    }
}

/// How the skin at every site has turned from one posture to another.
pub fn rotations(skin: &Skin, before: &Mesh, after: &Mesh) -> Vec<Rotation3<f64>> {
    let normals = [vertex_normals(before), vertex_normals(after)];
    let frame = |mesh: &Mesh, normals: &[Vec3], vertex: u32| {
        let (normal, at) = (normals[vertex as usize], mesh.positions()[vertex as usize]);
        let neighbors = skin.adjacency.neighbors(vertex as usize);
        let edges = neighbors.iter().map(|k| mesh.positions()[*k as usize] - at);
        let along = edges
            .map(|e| e - normal * normal.dot(&e))
            .find_map(|e| e.try_normalize(1e-12));
        along.map(|u| Matrix3::from_columns(&[u, normal.cross(&u), normal]))
    };
    let turn = |&vertex: &u32| {
        let frames = (
            frame(before, &normals[0], vertex),
            frame(after, &normals[1], vertex),
        );
        match frames {
            (Some(a), Some(b)) => Rotation3::from_matrix_unchecked(b * a.transpose()),
            _ => Rotation3::identity(),
        }
    };
    skin.sites
        .vertex
        .par_iter()
        .with_min_len(256)
        .map(turn)
        .collect()
}

/// A contact solved in the product's frame, in that of the posed positions.
pub fn from_product_frame(contact: &mut Contact, motion: &Motion) {
    let (turn, shift) = (motion.rotation, motion.translation.vector);
    let all = |vectors: &mut Vec<Vec3>| vectors.iter_mut().for_each(|v| *v = turn * *v);
    all(&mut contact.displacement);
    all(&mut contact.normal);
    contact.total_force = turn * contact.total_force;
    contact.total_moment = turn * contact.total_moment + shift.cross(&contact.total_force);
    if contact.center_of_pressure != Vec3::zeros() {
        contact.center_of_pressure = turn * contact.center_of_pressure + shift;
    }
    contact.direction = turn * contact.direction;
    if let Some(shear) = &mut contact.shear {
        all(&mut shear.force);
        all(&mut shear.slip);
        shear.total = turn * shear.total;
        shear.travel = turn * shear.travel;
        shear.turn = turn * shear.turn;
    }
}
