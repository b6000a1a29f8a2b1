//! Vertices that the library merges are written outside the product too, and their remaining penetration is reported.

use crate::scenes;

use scenes::{Bench, lattice, material};
use thenar_contact::{Contact, Control, Model, Press, Skin, SkinInput, Start, Unsolved};
use thenar_surface::{Mesh, Product, Vec3};

/// Radius of the ball that presses, mm, how deep, and the spacing of the skin.
const RADIUS: f64 = 12.0;
const DEPTH: f64 = 1.0;
const SPACING: f64 = 2.0;

/// Flat skin with one more vertex in a triangle, 0.3 mm from its corner nearest to the middle and 0.27 mm above it.
fn skin_with_a_near_vertex() -> (Mesh, usize) {
    let flat = lattice(8.0, SPACING, 0.3);
    let nearest = |t: &&[u32; 3]| {
        let middle: Vec3 = t.iter().map(|&v| flat.positions()[v as usize]).sum();
        (middle.norm() * 1e6) as u64
    };
    let split = *flat.triangles().iter().min_by_key(nearest).unwrap();
    let [a, b, c] = split.map(|v| flat.positions()[v as usize]);
    let along = (0.5 * (b + c) - a).normalize();
    let mut positions = flat.positions().to_vec();
    let extra = positions.len();
    positions.push(a + along * 0.15 + Vec3::new(0.0, 0.0, 0.27));
    let extra_number = extra as u32;
    let mut triangles: Vec<[u32; 3]> = flat
        .triangles()
        .iter()
        .copied()
        .filter(|t| *t != split)
        .collect();
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        triangles.push([split[from], split[to], extra_number]);
    }
    (Mesh::new(positions, triangles).unwrap(), extra)
}

/// A fine ball whose lowest point lies `DEPTH` below the flat skin.
fn ball() -> Product {
    let (rings, sectors) = (400u32, 400u32);
    let center = Vec3::new(0.0, 0.0, RADIUS - DEPTH);
    let mut positions = vec![center - Vec3::new(0.0, 0.0, RADIUS)];
    for ring in 1..rings {
        let tilt = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for sector in 0..sectors {
            let angle = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let around = Vec3::new(angle.cos(), angle.sin(), 0.0) * tilt.sin();
            positions.push(center + (around - Vec3::new(0.0, 0.0, tilt.cos())) * RADIUS);
        }
    }
    let top = positions.len() as u32;
    positions.push(center + Vec3::new(0.0, 0.0, RADIUS));
    let at = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, at(1, s + 1), at(1, s)]);
        for ring in 1..rings - 1 {
            let (a, b, c, d) = (
                at(ring, s),
                at(ring, s + 1),
                at(ring + 1, s),
                at(ring + 1, s + 1),
            );
            triangles.extend([[a, b, d], [a, d, c]]);
        }
        triangles.push([top, at(rings - 1, s), at(rings - 1, s + 1)]);
    }
    Product::new(Mesh::new(positions, triangles).unwrap()).unwrap()
}

fn pressed(mesh: &Mesh, posed: Option<&[Vec3]>, shift: Vec3) -> Contact {
    let input = SkinInput {
        mesh: mesh.clone(),
        regions: Vec::new(),
        materials: vec![material(10.0)],
        model: Model::Layer,
    };
    let mut skin = Bench::from(Skin::prepare(input, &Control::none()).unwrap());
    let text = skin.warnings().join(" ");
    assert!(
        text.contains("1 vertices are nearer to another one than a quarter"),
        "{text}"
    );
    let moved = ball();
    let positions = moved.mesh().positions().iter().map(|p| p + shift).collect();
    let product = Product::new(moved.mesh().with_positions(positions).unwrap()).unwrap();
    let press = Press {
        product: &product,
        posed,
        force: None,
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    };
    skin.press(&press, &Control::none()).unwrap()
}

/// How deep a written vertex lies in the true ball, mm.
fn depth(place: Vec3, shift: Vec3) -> f64 {
    RADIUS - (place - shift - Vec3::new(0.0, 0.0, RADIUS - DEPTH)).norm()
}

#[test]
fn a_merged_vertex_is_put_out_of_the_product() {
    let (mesh, extra) = skin_with_a_near_vertex();
    let contact = pressed(&mesh, None, Vec3::zeros());
    let written: Vec<f64> = mesh
        .positions()
        .iter()
        .zip(&contact.displacement)
        .map(|(p, u)| depth(p + u, Vec3::zeros()))
        .collect();
    let deepest = written.iter().fold(0.0, |most, d| f64::max(most, *d));
    assert!(contact.displacement[extra].norm() > 0.5, "it is pressed");
    assert!(
        deepest < 0.01,
        "{deepest} mm inside, the merged vertex {}",
        written[extra]
    );
    assert!(contact.residual.penetration_mm < 0.01);
}

#[test]
fn it_is_put_out_in_a_posture_too() {
    let (mesh, extra) = skin_with_a_near_vertex();
    let shift = Vec3::new(3.0, -2.0, 5.0);
    let posed: Vec<Vec3> = mesh.positions().iter().map(|p| p + shift).collect();
    let contact = pressed(&mesh, Some(&posed), shift);
    let inside = depth(posed[extra] + contact.displacement[extra], shift);
    assert!(
        contact.displacement[extra].norm() > 0.5 && inside < 0.01,
        "{inside} mm"
    );
}
