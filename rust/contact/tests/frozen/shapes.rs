//! Skins and products of the frozen cases, made from code.

use std::f64::consts::{PI, TAU};

use thenar_contact::{ActiveEffect, Control, Material, Model, Skin, SkinInput};
use thenar_surface::{Mesh, Product, Vec3};

use crate::scenes::{Bench, lattice, revolve};

/// A modulus that grows with depth, on a bone.
pub fn stiffening() -> Material {
    Material {
        g0_mpa: 0.01,
        g_lim_mpa: 0.03,
        thickness_mm: 7.0,
        ..Material::finger()
    }
}

pub fn prepared(input: SkinInput) -> Bench {
    Bench::from(Skin::prepare(input, &Control::none()).unwrap())
}

/// One region of one material.
pub fn plain(mesh: Mesh, material: Material) -> Bench {
    prepared(SkinInput {
        mesh,
        regions: Vec::new(),
        materials: vec![material],
        model: Model::Layer,
    })
}

/// Two regions that meet at x = 0.
pub fn halves(mesh: Mesh, materials: [Material; 2], model: Model) -> Bench {
    let side = |p: &Vec3| i32::from(p.x > 0.0);
    prepared(SkinInput {
        regions: mesh.positions().iter().map(side).collect(),
        mesh,
        materials: materials.to_vec(),
        model,
    })
}

pub fn switch_on(skin: &mut Bench, effects: Vec<ActiveEffect>) {
    skin.set_effects(effects, &Control::none()).unwrap();
}

pub fn named(name: &str, amplitude: f64) -> ActiveEffect {
    ActiveEffect::named(name, amplitude).unwrap()
}

/// Flat skin bent down to a dome of that radius (mm).
pub fn dome(size: f64, spacing: f64, radius: f64) -> Mesh {
    let flat = lattice(size, spacing, 0.3);
    let bend = |p: &Vec3| p - Vec3::z() * (p.norm_squared() / (2.0 * radius));
    let bent = flat.positions().iter().map(bend).collect();
    flat.with_positions(bent).unwrap()
}

/// A paraboloid z = r^2 / 2R - depth as `scenes::paraboloid` makes it, of fewer triangles.
pub fn bowl(radius: f64, depth: f64, extent: f64) -> Product {
    revolve(|r| r * r / (2.0 * radius) - depth, extent, 32)
}

/// A closed surface over polar angle and angle about z.
pub fn round(rings: u32, sectors: u32, at: impl Fn(f64, f64) -> Vec3) -> Mesh {
    let mut positions = vec![at(0.0, 0.0)];
    for ring in 1..rings {
        for sector in 0..sectors {
            let (polar, angle) = (
                f64::from(ring) / f64::from(rings),
                f64::from(sector) / f64::from(sectors),
            );
            positions.push(at(PI * polar, TAU * angle));
        }
    }
    let last = positions.len() as u32;
    positions.push(at(PI, 0.0));
    let index = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, index(1, s), index(1, s + 1)]);
        for ring in 1..rings - 1 {
            let (a, b) = (index(ring, s), index(ring, s + 1));
            let (c, d) = (index(ring + 1, s), index(ring + 1, s + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
        triangles.push([last, index(rings - 1, s + 1), index(rings - 1, s)]);
    }
    Mesh::new(positions, triangles).unwrap()
}

/// An ellipsoid with those half axes (mm) about `center`.
pub fn ellipsoid(rings: u32, half: Vec3, center: Vec3) -> Mesh {
    round(rings, rings * 3 / 2, |polar, angle| {
        let unit = Vec3::new(
            polar.sin() * angle.cos(),
            polar.sin() * angle.sin(),
            polar.cos(),
        );
        center + half.component_mul(&unit)
    })
}

/// Meshes side by side as one.
pub fn joined(meshes: &[Mesh]) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Mesh::new(positions, triangles).unwrap()
}

/// A box between two corners, twelve triangles.
pub fn block(low: Vec3, high: Vec3) -> Mesh {
    let corner = |k: u32| {
        let side = |bit: u32, axis: usize| {
            if k >> bit & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        };
        Vec3::new(side(0, 0), side(1, 1), side(2, 2))
    };
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).concat();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

/// A sheet without thickness: the lattice bent up about the origin, its lowest point at z = -`depth`.
pub fn sheet(size: f64, radius: f64, depth: f64) -> Mesh {
    let flat = lattice(size, 1.0, 0.2);
    let bend = |p: &Vec3| p + Vec3::z() * (p.norm_squared() / (2.0 * radius) - depth);
    let bent = flat.positions().iter().map(bend).collect();
    flat.with_positions(bent).unwrap()
}

/// Every triangle turned over.
pub fn inside_out(mesh: &Mesh) -> Mesh {
    let turned = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]);
    Mesh::new(mesh.positions().to_vec(), turned.collect()).unwrap()
}

/// A tube about y without ends, its lowest line at z = -`depth`.
pub fn tube(radius: f64, length: f64, depth: f64) -> Mesh {
    let (sectors, rows) = (96u32, 24u32);
    let mut positions = Vec::new();
    for row in 0..=rows {
        for sector in 0..sectors {
            let angle = TAU * f64::from(sector) / f64::from(sectors);
            let y = length * (f64::from(row) / f64::from(rows) - 0.5);
            let (x, z) = (radius * angle.sin(), radius * (1.0 - angle.cos()));
            positions.push(Vec3::new(x, y, z - depth));
        }
    }
    let mut triangles = Vec::new();
    for row in 0..rows {
        for s in 0..sectors {
            let (a, b) = (row * sectors + s, row * sectors + (s + 1) % sectors);
            let (c, d) = (a + sectors, b + sectors);
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

pub fn product(mesh: Mesh) -> Product {
    Product::new(mesh).unwrap()
}
