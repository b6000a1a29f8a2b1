//! Meshes and slow twins for the tests.
#![allow(dead_code, clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use thenar_surface::{Mesh, Vec3, closest_point};

pub fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A box between two corners, 12 triangles, outward.
pub fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    let corner = |i: usize| {
        v(
            [low.x, high.x][i & 1],
            [low.y, high.y][i >> 1 & 1],
            [low.z, high.z][i >> 2],
        )
    };
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

/// A closed cylinder about z, from z = 0 to `height`, with `sides` sides; flat caps.
pub fn cylinder(radius: f64, height: f64, sides: u32) -> Mesh {
    let mut p: Vec<Vec3> = vec![v(0., 0., 0.), v(0., 0., height)];
    for k in 0..sides {
        let (s, c) = (TAU * f64::from(k) / f64::from(sides)).sin_cos();
        p.push(v(radius * c, radius * s, 0.0));
        p.push(v(radius * c, radius * s, height));
    }
    let mut t = Vec::new();
    for k in 0..sides {
        let (a, b) = (2 + 2 * k, 2 + 2 * ((k + 1) % sides));
        t.extend([
            [0, b, a],
            [1, a + 1, b + 1],
            [a, b, b + 1],
            [a, b + 1, a + 1],
        ]);
    }
    Mesh::new(p, t).unwrap()
}

/// A sphere by latitude and longitude: `2 * sectors * (rings - 1)` triangles.
pub fn sphere(radius: f64, rings: u32, sectors: u32) -> Mesh {
    let mut p = vec![v(0., 0., -radius)];
    for i in 1..rings {
        let (sin, cos) = (PI * f64::from(i) / f64::from(rings)).sin_cos();
        for k in 0..sectors {
            let (s, c) =
                (TAU * (f64::from(k) + 0.5 * f64::from(i % 2)) / f64::from(sectors)).sin_cos();
            p.push(v(radius * sin * c, radius * sin * s, -radius * cos));
        }
    }
    p.push(v(0., 0., radius));
    let top = p.len() as u32 - 1;
    let at = |i: u32, k: u32| 1 + (i - 1) * sectors + k % sectors;
    let mut t = Vec::new();
    for k in 0..sectors {
        t.push([0, at(1, k + 1), at(1, k)]);
        t.push([top, at(rings - 1, k), at(rings - 1, k + 1)]);
        for i in 1..rings - 1 {
            let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
            // Odd rings are turned by half a sector, so the short diagonal alternates.
            t.extend(if i % 2 == 1 {
                [[a, b, d], [a, d, c]]
            } else {
                [[a, b, c], [b, d, c]]
            });
        }
    }
    Mesh::new(p, t).unwrap()
}

/// Several meshes as one.
pub fn together(meshes: &[Mesh]) -> Mesh {
    let (mut p, mut t) = (Vec::new(), Vec::new());
    for m in meshes {
        let base = p.len() as u32;
        p.extend_from_slice(m.positions());
        t.extend(m.triangles().iter().map(|c| c.map(|i| i + base)));
    }
    Mesh::new(p, t).unwrap()
}

pub fn inside_out(mesh: &Mesh) -> Mesh {
    let t = mesh
        .triangles()
        .iter()
        .map(|&[a, b, c]| [a, c, b])
        .collect();
    Mesh::new(mesh.positions().to_vec(), t).unwrap()
}

pub fn moved(mesh: &Mesh, by: impl Fn(Vec3) -> Vec3) -> Mesh {
    mesh.with_positions(mesh.positions().iter().map(|&p| by(p)).collect())
        .unwrap()
}

/// Unsigned distance by trying every triangle.
pub fn brute_distance(mesh: &Mesh, p: Vec3) -> f64 {
    let all =
        (0..mesh.triangles().len()).map(|t| closest_point(mesh.corners(t), p).distance_squared);
    all.fold(f64::INFINITY, f64::min).sqrt()
}

/// Numbers in 0..1 from a seed (xorshift64*).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn within(&mut self, half: f64) -> Vec3 {
        let mut one = || (2.0 * self.next() - 1.0) * half;
        v(one(), one(), one())
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let d = self.within(1.0);
            if d.norm() > 0.1 && d.norm() < 1.0 {
                return d.normalize();
            }
        }
    }
}
