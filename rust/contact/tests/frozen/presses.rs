//! Single presses: both models, regions, postures, force targets, drags, adhesion, a stiff skin, merged vertices, a large skin.

use nalgebra::Rotation3;
use thenar_contact::{
    ActiveEffect, Contact, Control, Drag, ForceTarget, Material, Model, Press, SkinInput, Start,
    Unsolved,
};
use thenar_surface::{Mesh, Product, Vec3};

use crate::scenes::{
    Bench, flat_skin, lattice, material, paraboloid, press, press_posed, revolve, rubbing_skin,
};
use crate::shapes::{bowl, dome, ellipsoid, halves, joined, named, plain, prepared, stiffening};
use crate::shapes::{product, switch_on};
use crate::{Case, case};

/// A fresh press of the rest posture.
pub fn of(product: &Product) -> Press<'_> {
    Press {
        product,
        posed: None,
        force: None,
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    }
}

pub fn pressed(skin: &mut Bench, request: &Press<'_>) -> Contact {
    skin.press(request, &Control::none()).unwrap()
}

pub fn cases() -> Vec<Case> {
    let mut all = models();
    all.extend(targets());
    all.extend(drags());
    all.extend(skins());
    all.push(case("large skin", |bits| {
        let half_space = material(f64::INFINITY);
        let mut skin = flat_skin(6.0, 0.0575, half_space, Model::Layer);
        assert!(skin.vertices() > 40_000, "{}", skin.vertices());
        bits.contact(&press(&mut skin, &paraboloid(10.0, 0.15, 7.5)));
    }));
    all
}

fn models() -> Vec<Case> {
    vec![
        case("layer, one modulus", |bits| {
            let mut skin = flat_skin(14.0, 1.3, material(7.0), Model::Layer);
            bits.contact(&press(&mut skin, &bowl(9.0, 1.5, 16.0)));
        }),
        case("layer, half space", |bits| {
            let mut skin = flat_skin(5.0, 0.5, material(f64::INFINITY), Model::Layer);
            bits.contact(&press(&mut skin, &bowl(9.0, 0.4, 7.0)));
        }),
        case("layer, stiffening and deep", |bits| {
            let mut skin = flat_skin(16.0, 1.4, stiffening(), Model::Layer);
            bits.contact(&press(&mut skin, &bowl(9.0, 4.5, 18.0)));
        }),
        case("layer, compressible", |bits| {
            let soft = Material {
                poisson_ratio: 0.4,
                ..stiffening()
            };
            let mut skin = flat_skin(14.0, 1.3, soft, Model::Layer);
            bits.contact(&press(&mut skin, &bowl(9.0, 1.5, 16.0)));
        }),
        case("layer, two regions", |bits| {
            let materials = [Material::finger_layer(), Material::palm_layer()];
            let mut skin = halves(lattice(14.0, 1.3, 0.3), materials, Model::Layer);
            bits.contact(&press(&mut skin, &bowl(9.0, 1.5, 16.0)));
        }),
        case("paper, one region", |bits| {
            let mut skin = flat_skin(14.0, 1.6, Material::finger(), Model::Paper);
            bits.contact(&press(&mut skin, &bowl(9.0, 1.5, 16.0)));
        }),
        case("paper, two regions", |bits| {
            let materials = [Material::finger(), Material::palm()];
            let mut skin = halves(dome(14.0, 1.6, 15.0), materials, Model::Paper);
            bits.contact(&press(&mut skin, &bowl(40.0, 1.2, 20.0)));
        }),
        case("paper, force target", |bits| {
            let mut skin = flat_skin(14.0, 1.6, Material::finger(), Model::Paper);
            let product = bowl(9.0, -1.0, 16.0);
            let force = Some(ForceTarget {
                newton: 0.8,
                direction: None,
            });
            let request = Press {
                force,
                ..of(&product)
            };
            bits.contact(&pressed(&mut skin, &request));
        }),
    ]
}

fn targets() -> Vec<Case> {
    let to = |newton: f64, direction: Option<Vec3>, effects: fn() -> Vec<ActiveEffect>| {
        move |bits: &mut crate::Bits| {
            let mut skin = halves(dome(12.0, 1.3, 14.0), [stiffening(); 2], Model::Layer);
            switch_on(&mut skin, effects());
            let product = bowl(30.0, -2.0, 18.0);
            let force = Some(ForceTarget { newton, direction });
            let request = Press {
                force,
                ..of(&product)
            };
            bits.contact(&pressed(&mut skin, &request));
        }
    };
    let down = Some(Vec3::new(0.1, 0.0, -2.0));
    vec![
        case("force target, direction given", to(1.5, down, Vec::new)),
        case("force target, direction found", to(4.0, None, Vec::new)),
        case(
            "force target, adhesion",
            to(0.3, down, || vec![named("adhesion", 1.0)]),
        ),
    ]
}

fn drags() -> Vec<Case> {
    let dragged = |how: Drag, force: Option<ForceTarget>| {
        move |bits: &mut crate::Bits| {
            let mut skin = rubbing_skin(&dome(8.0, 0.9, 12.0), 7.0, 0.4);
            let product = bowl(60.0, 0.8, 12.0);
            let request = Press {
                drag: Some(how),
                force,
                ..of(&product)
            };
            bits.contact(&pressed(&mut skin, &request));
        }
    };
    let motion = |travel: Vec3, turn: Vec3| Drag::Motion { travel, turn };
    let aside = Vec3::new(0.2, -0.1, 0.0);
    let force = Some(ForceTarget {
        newton: 1.0,
        direction: Some(-Vec3::z()),
    });
    vec![
        case("drag, travel", dragged(motion(aside, Vec3::zeros()), None)),
        case(
            "drag, turn",
            dragged(motion(Vec3::zeros(), 0.1 * Vec3::z()), None),
        ),
        case(
            "drag, to a shear force",
            dragged(Drag::Force(0.5 * aside), None),
        ),
        case(
            "drag, under a force target",
            dragged(motion(aside, 0.02 * Vec3::z()), force),
        ),
    ]
}

fn skins() -> Vec<Case> {
    vec![
        case("posed and tilted", |bits| {
            let mesh = dome(12.0, 1.3, 14.0);
            let turn = Rotation3::from_euler_angles(0.2, -0.15, 0.4);
            let posed: Vec<Vec3> = mesh
                .positions()
                .iter()
                .map(|p| turn * p + Vec3::z())
                .collect();
            let mut skin = plain(mesh, stiffening());
            let product = bowl(30.0, 0.5, 18.0);
            bits.contact(&press_posed(&mut skin, &product, &posed));
        }),
        case("partly without skin", |bits| {
            let mesh = lattice(14.0, 1.3, 0.3);
            let bare = |p: &Vec3| if p.x > 2.0 { -1 } else { 0 };
            let mut skin = prepared(SkinInput {
                regions: mesh.positions().iter().map(bare).collect(),
                mesh,
                materials: vec![stiffening()],
                model: Model::Layer,
            });
            bits.contact(&press(&mut skin, &bowl(9.0, 1.5, 16.0)));
        }),
        case("closed skin on a punch", |bits| {
            let finger = ellipsoid(24, Vec3::new(8.0, 14.0, 6.0), Vec3::new(0.0, 0.0, -6.0));
            let mut skin = plain(finger, stiffening());
            let punch = revolve(|r| 0.002 * r * r - 1.2, 20.0, 60);
            bits.contact(&press(&mut skin, &punch));
        }),
        case("pinched between two fingers", |bits| {
            let side = |x: f64| ellipsoid(20, Vec3::new(7.0, 11.0, 8.0), Vec3::new(x, 0.0, 0.0));
            let pair = joined(&[side(-18.0), side(18.0)]);
            let mut skin = halves(pair, [stiffening(), Material::palm_layer()], Model::Layer);
            let handle = ellipsoid(40, Vec3::new(12.3, 40.0, 12.0), Vec3::zeros());
            bits.contact(&press(&mut skin, &product(handle)));
        }),
        case("torn seam", |bits| {
            let mut skin = plain(torn(&lattice(14.0, 1.3, 0.3)), stiffening());
            bits.contact(&press(&mut skin, &bowl(9.0, 1.5, 16.0)));
        }),
        case("merged vertex", |bits| {
            let mut skin = plain(near_vertex(&lattice(8.0, 2.0, 0.3)), material(10.0));
            assert!(!skin.warnings().is_empty());
            bits.contact(&press(&mut skin, &bowl(12.0, 1.0, 12.0)));
        }),
        case("other materials and effects after a press", |bits| {
            let mut skin = flat_skin(12.0, 1.3, material(7.0), Model::Layer);
            let product = bowl(9.0, 1.2, 16.0);
            press(&mut skin, &product);
            skin.set_materials(&[stiffening()], &Control::none())
                .unwrap();
            bits.contact(&press(&mut skin, &product));
            switch_on(&mut skin, vec![named("bone", 1.0), named("friction", 1.0)]);
            bits.contact(&press(&mut skin, &product));
            bits.numbers(&skin.thickness());
        }),
    ]
}

/// The mesh with vertices of their own for the triangles beyond x = 0.3.
fn torn(mesh: &Mesh) -> Mesh {
    let (mut positions, mut triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
    let beyond = |t: &&mut [u32; 3]| mesh.positions()[t[0] as usize].x > 0.3;
    for vertex in triangles.iter_mut().filter(beyond).flatten() {
        positions.push(mesh.positions()[*vertex as usize]);
        *vertex = positions.len() as u32 - 1;
    }
    Mesh::new(positions, triangles).unwrap()
}

/// The mesh with a vertex more in its middle triangle, so near a corner that the library merges the two.
fn near_vertex(mesh: &Mesh) -> Mesh {
    let distance = |t: &&[u32; 3]| {
        let sum: Vec3 = t.iter().map(|v| mesh.positions()[*v as usize]).sum();
        (sum.norm() * 1e6) as u64
    };
    let split = *mesh.triangles().iter().min_by_key(distance).unwrap();
    let [a, b, c] = split.map(|v| mesh.positions()[v as usize]);
    let mut positions = mesh.positions().to_vec();
    let extra = positions.len() as u32;
    positions.push(a + 0.15 * (0.5 * (b + c) - a).normalize() + 0.27 * Vec3::z());
    let others = mesh.triangles().iter().filter(|t| **t != split);
    let mut triangles: Vec<[u32; 3]> = others.copied().collect();
    triangles.extend([[0, 1], [1, 2], [2, 0]].map(|[from, to]| [split[from], split[to], extra]));
    Mesh::new(positions, triangles).unwrap()
}
