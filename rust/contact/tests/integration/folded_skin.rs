//! Skin that is folded inside the product: what faces away from the wall it has entered must not read the far wall.

use crate::scenes;

use scenes::{Bench, press};
use thenar_contact::{Contact, Material, Model, Skin, SkinInput};
use thenar_surface::{Mesh, Product, Vec3};

/// Half the thickness of the web of skin, mm.
const HALF: f64 = 1.2;

/// A web of skin as between two fingers: a flat pouch of 2.4 mm, its upper side facing +z, its lower side facing -z.
fn web() -> Mesh {
    round(24, 48, |polar, angle| {
        Vec3::new(
            16.0 * polar.sin() * angle.cos(),
            11.0 * polar.sin() * angle.sin(),
            HALF * polar.cos(),
        )
    })
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
    let mut triangles = Vec::new();
    for s in 0..sectors {
        let (a, b) = (s, (s + 1) % sectors);
        let (c, d) = (a + sectors, b + sectors);
        triangles.extend([[a, b, d], [a, d, c]]);
    }
    // The ends, as strips between the lower and the upper side: the section of a thin bar is no star.
    let quarter = sectors / 4;
    for k in 0..2 * quarter {
        let lower = |k: u32| (k + 3 * quarter) % sectors;
        let upper = |k: u32| (3 * quarter - k) % sectors;
        let (a, b, c, d) = (lower(k), lower(k + 1), upper(k + 1), upper(k));
        for [p, q, r] in [[a, c, b], [a, d, c]] {
            if p != q && q != r && r != p {
                triangles.push([p, q, r]);
                triangles.push([p + sectors, r + sectors, q + sectors]);
            }
        }
    }
    Product::new(Mesh::new(positions, triangles).unwrap()).unwrap()
}

fn pressed(height: f64, tall: f64) -> Contact {
    press(&mut soft_skin(web()), &bar(height, tall))
}

/// The web dips wholly into the bar: its lower side lies inside too, turned away from the wall it came through.
#[test]
fn skin_turned_away_inside_a_bar_does_not_feel_the_far_wall() {
    let dip = 0.5;
    let near = pressed(-HALF - dip, 48.0);
    for tall in [8.0, 12.0, 18.0, 24.0, 30.0, 60.0, 90.0] {
        let far = pressed(-HALF - dip, tall);
        let (a, b) = (near.total_force.z, far.total_force.z);
        println!("force with the far wall at 48 mm {a:.4} N, at {tall} mm {b:.4} N");
        assert!((b / a - 1.0).abs() < 1e-4, "{a} N and {b} N at {tall} mm");
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

/// A fingertip as a ball of 8 mm, a closed skin, pressed so deep into a plate of each thickness from above: all but the skin that
/// has come through must feel the same plate.
#[test]
fn a_plate_feels_the_same_however_thin_it_is() {
    for depth in [2.0, 4.0, 6.0] {
        let forces = [8.0, 4.0, 2.0, 1.0].map(|thick| {
            let contact = press(&mut ball(28, 40), &plate(60.0, thick, depth - 8.0));
            assert!(contact.convergence.has_converged, "{depth} into {thick}");
            contact.total_force.norm()
        });
        println!("{depth} mm deep: {forces:?} N into plates of 8, 4, 2 and 1 mm");
        for force in forces {
            assert!(
                (force / forces[0] - 1.0).abs() < 1e-3,
                "{depth} mm deep: {forces:?}"
            );
        }
    }
}

/// A flat pad on a narrower plate, pressed beyond the middle of it: no slope of the skin shows the way it came.
#[test]
fn a_flat_pad_feels_the_side_of_a_plate_that_it_is_pressed_on() {
    let forces = [8.0, 3.0, 2.0].map(|thick| {
        let contact = press(&mut pouch(), &plate(9.0, thick, 1.5 - 4.0));
        let deepest = contact.gap.iter().fold(0.0, |most: f64, g| most.max(-g));
        assert!((deepest - 1.5).abs() < 0.05, "{thick}: reads {deepest} mm");
        contact.total_force.norm()
    });
    println!("{forces:?} N into plates of 8, 3 and 2 mm");
    for force in forces {
        assert!((force / forces[0] - 1.0).abs() < 0.02, "{forces:?}");
    }
}

fn soft_skin(mesh: Mesh) -> Bench {
    let soft = Material {
        g0_mpa: 0.01,
        g_lim_mpa: 0.02,
        thickness_mm: 7.0,
        ..Material::finger()
    };
    let input = SkinInput {
        mesh,
        regions: Vec::new(),
        materials: vec![soft],
        model: Model::Layer,
    };
    Bench::from(Skin::prepare(input, &thenar_contact::Control::none()).unwrap())
}

/// A ball of 8 mm about the origin.
fn ball(rings: u32, sectors: u32) -> Bench {
    soft_skin(round(rings, sectors, |polar, angle| {
        8.0 * Vec3::new(
            polar.sin() * angle.cos(),
            polar.sin() * angle.sin(),
            polar.cos(),
        )
    }))
}

/// A pad of 40 x 40 mm, 8 mm thick, flat above and below, with rounded sides.
fn pouch() -> Bench {
    soft_skin(round(56, 72, |polar, angle| {
        let flat = |x: f64, power: f64| x.signum() * x.abs().powf(power);
        let out = 20.0 * flat(polar.sin(), 0.8);
        Vec3::new(
            out * angle.cos(),
            out * angle.sin(),
            4.0 * flat(polar.cos(), 0.08),
        )
    }))
}

/// A closed surface over polar angle and angle about z.
fn round(rings: u32, sectors: u32, at: impl Fn(f64, f64) -> Vec3) -> Mesh {
    use std::f64::consts::{PI, TAU};
    let mut positions = vec![at(0.0, 0.0)];
    for ring in 1..rings {
        for sector in 0..sectors {
            positions.push(at(
                PI * f64::from(ring) / f64::from(rings),
                TAU * f64::from(sector) / f64::from(sectors),
            ));
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

/// A square plate of half width `half`, its upper side at z = `top`.
fn plate(half: f64, thick: f64, top: f64) -> Product {
    let corner = |k: u32| {
        let sign = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let z = if k >> 2 & 1 == 1 { top } else { top - thick };
        Vec3::new(half * sign(0), half * sign(1), z)
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
    Product::new(Mesh::new((0..8).map(corner).collect(), triangles).unwrap()).unwrap()
}
