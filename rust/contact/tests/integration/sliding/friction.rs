//! Friction on pressed skin: Cattaneo and Mindlin, torsion, turned scenes, bone, and what must change nothing.

use crate::scenes;

use nalgebra::{Rotation3, Vector3};
use scenes::{Bench, SHEAR_MODULUS, lattice, paraboloid, rubbing_skin};
use thenar_contact::{
    ActiveEffect, Contact, ContactError, Control, Drag, Press, Shear, Start, Unsolved,
};
use thenar_surface::{Mesh, Product, Vec3};

const MU: f64 = 0.4;

fn drag(skin: &mut Bench, product: &Product, drag: Option<Drag>) -> Result<Contact, ContactError> {
    let press = Press {
        product,
        posed: None,
        force: None,
        drag,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    };
    skin.press(&press, &Control::none())
}

fn travel(x: f64, y: f64) -> Option<Drag> {
    Some(Drag::Motion {
        travel: Vec3::new(x, y, 0.0),
        turn: Vec3::zeros(),
    })
}

fn normal_force(contact: &Contact) -> f64 {
    contact.nodal_force.iter().sum()
}

/// A contact of radius 1 mm on a half space, seven spacings wide; the sphere is so large that planes stay level.
const SPACING: f64 = 1.0 / 7.0;

fn hertz() -> (Mesh, Product) {
    (lattice(1.5, SPACING, 0.3), paraboloid(50.0, 0.02, 2.0))
}

fn stuck_radius(shear: &Shear) -> f64 {
    let cell = SPACING * SPACING * 0.75f64.sqrt();
    let stuck = shear.is_sticking.iter().filter(|s| **s).count() as f64;
    (stuck * cell / std::f64::consts::PI).sqrt()
}

/// The same from the traction where skin sticks: there margin^2 (a^2 - r^2) = c^2 - r^2, with a = 1 mm.
fn stick_radius_by_traction(mesh: &Mesh, shear: &Shear) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (v, p) in mesh.positions().iter().enumerate() {
        if shear.is_sticking[v] {
            let r2 = p.norm_squared();
            sum += shear.margin[v].powi(2) * (1.0 - r2) + r2;
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

#[test]
fn cattaneo_and_mindlin_hold_on_pressed_skin() {
    let (mesh, product) = hertz();
    let mut skin = rubbing_skin(&mesh, f64::INFINITY, MU);
    for share in [0.2, 0.5, 0.8] {
        let load = normal_force(&drag(&mut skin, &product, None).unwrap());
        let force = Vec3::new(0.8, 0.6, 0.0) * (share * MU * load);
        let contact = drag(&mut skin, &product, Some(Drag::Force(force))).unwrap();
        let shear = contact.shear.unwrap();
        assert!(shear.residual <= 1e-8, "{}", shear.residual);
        assert!(
            (shear.total - force).norm() < 2e-3 * force.norm(),
            "{}",
            shear.total
        );
        let unit = 3.0 * 1.5 * MU * load / (16.0 * SHEAR_MODULUS);
        let exact = unit * (1.0 - (1.0 - share).powf(2.0 / 3.0));
        let ratio = shear.travel.norm() / exact;
        let stick = (1.0 - share).cbrt();
        let counted = stuck_radius(&shear) / stick;
        let by_traction = stick_radius_by_traction(&mesh, &shear) / stick;
        println!(
            "{share} of full slip, over Mindlin's: travel {ratio:.4}, stick radius by traction {by_traction:.3}, counted {counted:.3}"
        );
        assert!((ratio - 1.0).abs() < 0.01);
        assert!((counted - 1.0).abs() < 0.05);
        assert!((by_traction - 1.0).abs() < 0.03);
        // The force on the product is the opposite of that on the skin.
        assert!((contact.total_force.x + shear.total.x).abs() < 0.02 * force.norm());
    }
}

#[test]
fn slip_is_against_the_force_and_none_where_skin_sticks() {
    let (mesh, product) = hertz();
    let mut skin = rubbing_skin(&mesh, f64::INFINITY, MU);
    let contact = drag(&mut skin, &product, travel(0.007, -0.004)).unwrap();
    let shear = contact.shear.unwrap();
    let (mut stuck, mut slipped) = (0, 0);
    for v in 0..mesh.positions().len() {
        let (q, slip, p) = (shear.force[v], shear.slip[v], contact.nodal_force[v]);
        assert!(q.norm() <= MU * p * (1.0 + 1e-9));
        assert!(q.dot(&contact.normal[v]).abs() < 1e-12);
        if shear.is_sticking[v] {
            stuck += 1;
            assert!(slip.norm() < 1e-8 && shear.margin[v] > 0.0, "{slip}");
        } else if p > 0.0 {
            slipped += 1;
            assert!((q.dot(&slip) + q.norm() * slip.norm()).abs() < 1e-9 * q.norm());
            assert!((q.norm() / (MU * p) - 1.0).abs() < 1e-8 && shear.margin[v] == 0.0);
        } else {
            assert!(shear.margin[v].is_nan());
        }
    }
    assert!(stuck > 20 && slipped > 20, "{stuck} {slipped}");
    assert!(shear.dissipated > 0.0 && shear.stored > 0.0);
}

#[test]
fn a_contact_that_sticks_all_over_is_as_stiff_as_a_bonded_disc() {
    // Mindlin 1949: Q = 8 G a / (2 - nu) a travel; Reissner & Sagoci 1944: M = 16 G a^3 / 3 a radian.
    let exact = [8.0 / 1.5 * SHEAR_MODULUS, 16.0 / 3.0 * SHEAR_MODULUS];
    let mut errors = Vec::new();
    for spacing in [1.0 / 6.0, 1.0 / 12.0] {
        let mesh = lattice(1.5, spacing, 0.3);
        let mut skin = rubbing_skin(&mesh, f64::INFINITY, 9.0);
        let product = paraboloid(50.0, 0.02, 2.0);
        let (small, turn) = (1e-5, Vec3::new(0.0, 0.0, 1e-5));
        let pulled = drag(&mut skin, &product, travel(small, 0.0)).unwrap();
        let motion = Drag::Motion {
            travel: Vec3::zeros(),
            turn,
        };
        let turned = drag(&mut skin, &product, Some(motion)).unwrap();
        let twist = turned.shear.unwrap().force;
        let lever = |(x, q): (&Vec3, &Vec3)| x.cross(q).z;
        let found = [
            pulled.shear.unwrap().total.x / small,
            mesh.positions().iter().zip(&twist).map(lever).sum::<f64>() / small,
        ];
        errors.push([found[0] / exact[0] - 1.0, found[1] / exact[1] - 1.0]);
    }
    // The traction is singular at the rim, and the more so in torsion.
    let [coarse, fine] = [errors[0], errors[1]];
    assert!(coarse[0].abs() < 0.03 && fine[0].abs() < 0.01, "{errors:?}");
    assert!(coarse[1].abs() < 0.1 && fine[1].abs() < 0.02, "{errors:?}");
}

#[test]
fn torsion_ends_at_the_moment_of_full_slip() {
    let (mesh, product) = hertz();
    let mut skin = rubbing_skin(&mesh, f64::INFINITY, MU);
    let motion = Drag::Motion {
        travel: Vec3::zeros(),
        turn: Vec3::new(0.0, 0.0, 1.0),
    };
    let contact = drag(&mut skin, &product, Some(motion)).unwrap();
    // 3 pi mu P a / 16 under Hertz's pressure.
    let full = 3.0 * std::f64::consts::PI / 16.0 * MU * normal_force(&contact);
    let ratio = -contact.total_moment.z / full;
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    assert!(
        contact
            .shear
            .unwrap()
            .is_sticking
            .iter()
            .filter(|s| **s)
            .count()
            <= 1
    );
}

#[test]
fn a_turned_scene_gives_the_turned_result() {
    let (mesh, product) = (lattice(9.0, 1.1, 0.3), paraboloid(9.0, 1.5, 6.0));
    let here = drag(
        &mut rubbing_skin(&mesh, 7.0, MU),
        &product,
        travel(0.6, 0.3),
    )
    .unwrap();
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let shift = Vector3::new(31.0, -20.0, 77.0);
    let moved = |m: &Mesh| {
        let positions = m.positions().iter().map(|p| turn * p + shift).collect();
        Mesh::new(positions, m.triangles().to_vec()).unwrap()
    };
    let motion = Drag::Motion {
        travel: turn * Vec3::new(0.6, 0.3, 0.0),
        turn: Vec3::zeros(),
    };
    let product = Product::new(moved(product.mesh())).unwrap();
    let there = drag(
        &mut rubbing_skin(&moved(&mesh), 7.0, MU),
        &product,
        Some(motion),
    )
    .unwrap();
    let (a, b) = (here.shear.unwrap(), there.shear.unwrap());
    assert!(a.total.norm() > 0.01);
    assert!((turn * a.total - b.total).norm() < 1e-6 * a.total.norm());
    for (a, b) in here.displacement.iter().zip(&there.displacement) {
        assert!((turn * a - b).norm() < 1e-6, "{a} {b}");
    }
}

#[test]
fn bone_makes_the_skin_stiffer_to_shear() {
    let (mesh, product) = (lattice(12.0, 1.1, 0.3), paraboloid(9.0, 1.0, 6.0));
    let stiffness = |thickness: f64| {
        let contact = drag(
            &mut rubbing_skin(&mesh, thickness, 5.0),
            &product,
            travel(0.05, 0.0),
        )
        .unwrap();
        contact.shear.unwrap().total.x / contact.contact_area.sqrt()
    };
    let (thin, thick, open) = (stiffness(3.0), stiffness(8.0), stiffness(f64::INFINITY));
    assert!(
        thin > 1.2 * thick && thick > 1.05 * open,
        "{thin} {thick} {open}"
    );
}

#[test]
fn dragged_skin_moves_along_and_stays_on_the_product() {
    let (mesh, product) = (lattice(12.0, 1.1, 0.3), paraboloid(9.0, 1.5, 7.0));
    let mut skin = rubbing_skin(&mesh, 7.0, 0.6);
    let base = drag(&mut skin, &product, None).unwrap();
    let contact = drag(&mut skin, &product, travel(0.3, 0.0)).unwrap();
    let mut most = 0.0;
    for v in 0..mesh.positions().len() {
        let moved = contact.displacement[v] - base.displacement[v];
        most = f64::max(most, moved.x);
        let gap = product.gap(
            mesh.positions()[v] + contact.displacement[v],
            None,
            thenar_surface::GapLimits {
                cut_off_mm: 1.0,
                max_depth_mm: 4.0,
            },
        );
        let distance = gap.map_or(1.0, |g| g.distance);
        assert!(distance > -0.01, "vertex {v} is {distance} mm inside");
        if contact.nodal_force[v] > 0.0 {
            assert!(distance.abs() < 0.01, "{distance}");
        }
    }
    assert!(most > 0.25 && most < 0.35, "{most}");
}

#[test]
fn nothing_changes_without_friction_or_without_a_drag() {
    let (mesh, product) = (lattice(9.0, 1.1, 0.3), paraboloid(9.0, 1.5, 6.0));
    let mut with = rubbing_skin(&mesh, 7.0, MU);
    let mut without = rubbing_skin(&mesh, 7.0, MU);
    without.set_effects(Vec::new(), &Control::none()).unwrap();
    let mut zero = rubbing_skin(&mesh, 7.0, 0.0);
    let mut off = rubbing_skin(&mesh, 7.0, MU);
    let friction = ActiveEffect::named("friction", 0.0).unwrap();
    off.set_effects(vec![friction], &Control::none()).unwrap();
    let base = drag(&mut without, &product, None).unwrap();
    let same = |other: &Contact| {
        assert_eq!(base.displacement, other.displacement);
        assert_eq!(base.nodal_force, other.nodal_force);
        assert_eq!(base.total_force, other.total_force);
    };
    same(&drag(&mut with, &product, None).unwrap());
    same(&drag(&mut without, &product, travel(0.5, 0.0)).unwrap());
    same(&drag(&mut off, &product, travel(0.5, 0.0)).unwrap());
    let slippery = drag(&mut zero, &product, travel(0.5, 0.0)).unwrap();
    assert_eq!(slippery.shear.unwrap().total, Vec3::zeros());
    assert_eq!(slippery.total_force, base.total_force);
}

#[test]
fn a_drag_twice_is_the_same_bits_on_any_number_of_threads() {
    let (mesh, product) = (lattice(9.0, 1.1, 0.3), paraboloid(9.0, 1.5, 6.0));
    let once = drag(
        &mut rubbing_skin(&mesh, 7.0, MU),
        &product,
        travel(0.4, 0.1),
    )
    .unwrap();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let alone = pool.install(|| {
        drag(
            &mut rubbing_skin(&mesh, 7.0, MU),
            &product,
            travel(0.4, 0.1),
        )
        .unwrap()
    });
    assert_eq!(once.displacement, alone.displacement);
    assert_eq!(once.shear.unwrap().force, alone.shear.unwrap().force);
}

#[test]
fn bad_input_is_refused_in_a_sentence() {
    let (mesh, product) = (lattice(6.0, 1.1, 0.3), paraboloid(9.0, 1.0, 5.0));
    let mut skin = rubbing_skin(&mesh, 7.0, MU);
    let says = |result: Result<Contact, ContactError>, text: &str| {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(text), "{message}");
    };
    says(
        drag(&mut skin, &product, travel(f64::NAN, 0.0)),
        "must be finite",
    );
    says(
        drag(&mut skin, &product, Some(Drag::Force(Vec3::zeros()))),
        "not zero",
    );
    says(
        drag(
            &mut skin,
            &product,
            Some(Drag::Force(Vec3::new(9.0, 0.0, 0.0))),
        ),
        "more than the",
    );
    let negative = ActiveEffect::named("friction", 1.0)
        .unwrap()
        .with("coefficient", -0.1)
        .unwrap();
    let refused = skin
        .set_effects(vec![negative], &Control::none())
        .unwrap_err();
    assert!(
        refused.to_string().contains("coefficient is -0.1"),
        "{refused}"
    );
    assert!(
        drag(&mut skin, &product, travel(0.1, 0.0)).is_ok(),
        "the skin stays usable"
    );
}
