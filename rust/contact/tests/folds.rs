//! Skin that is folded inside the product: what faces away from the wall it has entered must not read the far wall.
#![allow(clippy::unwrap_used)]

mod scenes;

use scenes::press;
use thenar_contact::{Contact, Material, Model, Skin, SkinInput};
use thenar_surface::{Mesh, Product, Vec3};

/// Half the thickness of the web of skin, mm.
const HALF: f64 = 1.2;

/// A web of skin as between two fingers: a flat pouch of 2.4 mm, its upper side facing +z, its lower side facing -z.
fn web() -> Mesh {
    let (rings, sectors) = (24u32, 48u32);
    let (half_x, half_y) = (16.0, 11.0);
    let mut positions = vec![Vec3::new(0.0, 0.0, HALF)];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for sector in 0..sectors {
            let angle = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let out = polar.sin();
            positions.push(Vec3::new(
                half_x * out * angle.cos(),
                half_y * out * angle.sin(),
                HALF * polar.cos(),
            ));
        }
    }
    let last = positions.len() as u32;
    positions.push(Vec3::new(0.0, 0.0, -HALF));
    let at = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, at(1, s), at(1, s + 1)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, s), at(ring, s + 1));
            let (c, d) = (at(ring + 1, s), at(ring + 1, s + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
        triangles.push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
    }
    Mesh::new(positions, triangles).unwrap()
}

/// A bar along y of elliptic section whose lowest line lies at z = `height`: `tall` mm from there to its far wall.
fn bar(height: f64, tall: f64) -> Product {
    let sectors = 192u32;
    let mut positions = Vec::new();
    for y in [-40.0, 40.0] {
        for sector in 0..sectors {
            let angle = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let z = height
                + if angle.cos() > 0.0 {
                    24.0 * (1.0 - angle.cos())
                } else {
                    24.0 - (tall - 24.0) * angle.cos()
                };
            positions.push(Vec3::new(24.0 * angle.sin(), y, z));
        }
    }
    let middles = positions.len() as u32;
    positions.extend([-40.0, 40.0].map(|y| Vec3::new(0.0, y, height + 24.0)));
    let mut triangles = Vec::new();
    for s in 0..sectors {
        let (a, b) = (s, (s + 1) % sectors);
        let (c, d) = (a + sectors, b + sectors);
        triangles.extend([[a, b, d], [a, d, c], [a, middles, b], [c, d, middles + 1]]);
    }
    Product::new(Mesh::new(positions, triangles).unwrap()).unwrap()
}

fn pressed(height: f64, tall: f64) -> Contact {
    let soft = Material {
        g0_mpa: 0.01,
        g_lim_mpa: 0.02,
        thickness_mm: 7.0,
        ..Material::finger()
    };
    let input = SkinInput {
        mesh: web(),
        regions: Vec::new(),
        materials: vec![soft],
        model: Model::Layer,
    };
    let mut skin = Skin::prepare(input, &thenar_contact::Control::none()).unwrap();
    press(&mut skin, &bar(height, tall))
}

/// The web dips wholly into the bar: its lower side lies inside too, turned away from the wall it came through.
#[test]
fn skin_turned_away_inside_a_bar_does_not_feel_the_far_wall() {
    let dip = 0.5;
    let near = pressed(-HALF - dip, 48.0);
    for tall in [60.0, 90.0] {
        let far = pressed(-HALF - dip, tall);
        let (a, b) = (near.total_force.z, far.total_force.z);
        println!("force with the far wall at 48 mm {a:.4} N, at {tall} mm {b:.4} N");
        assert!((b / a - 1.0).abs() < 1e-4, "{a} N and {b} N");
    }
    let deepest = near.gap.iter().fold(0.0, |most: f64, g| most.max(-g));
    assert!(
        (deepest - (2.0 * HALF + dip)).abs() < 0.01,
        "reads {deepest} mm"
    );
    let moved = near
        .displacement
        .iter()
        .map(|u| u.norm())
        .fold(0.0, f64::max);
    assert!(moved < 1.2 * deepest, "skin moved by {moved} mm");
    assert!(
        near.residual.penetration_mm <= 0.02,
        "{}",
        near.residual.penetration_mm
    );
    assert!(near.convergence.has_converged);
}
