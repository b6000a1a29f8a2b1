//! The grade of a result: out-of-range results are flagged, meaningless ones are never good.

use crate::scenes;

use scenes::{flat_skin, lattice, material, paraboloid, press};
use thenar_contact::{Grade, Model, Warning};
use thenar_surface::{Mesh, Product, Vec3};

fn kinds(warnings: &[Warning]) -> Vec<&'static str> {
    warnings.iter().map(Warning::kind).collect()
}

#[test]
fn a_shallow_press_by_a_fine_product_is_good() {
    let contact = press(
        &mut flat_skin(14.0, 1.1, material(7.0), Model::Layer),
        &paraboloid(9.0, 0.8, 7.0),
    );
    assert_eq!(contact.grade(), Grade::Good, "{:?}", contact.warnings);
    assert!(contact.reason().is_none());
    assert!(contact.residual.complementarity <= 1e-10 && contact.residual.penetration_mm <= 0.02);
}

#[test]
fn without_contact_nothing_is_to_be_used_and_zero_is_zero() {
    let contact = press(
        &mut flat_skin(14.0, 1.1, material(7.0), Model::Layer),
        &paraboloid(9.0, -3.0, 7.0),
    );
    assert_eq!(contact.grade(), Grade::DoNotUse);
    assert_eq!(contact.reason(), Some(&Warning::NoContact));
    for zero in [contact.contact_area, contact.mean_pressure] {
        assert!(zero == 0.0 && zero.is_sign_positive());
    }
}

#[test]
fn a_press_beyond_the_theory_is_to_be_read_about() {
    let contact = press(
        &mut flat_skin(14.0, 1.1, material(2.0), Model::Layer),
        &paraboloid(9.0, 1.3, 7.0),
    );
    assert_eq!(contact.grade(), Grade::ReadThis, "{:?}", contact.warnings);
    assert!(kinds(&contact.warnings).contains(&"beyond_theory"));
    assert!(contact.reason().unwrap().grade() == Grade::ReadThis);
}

/// A tip of 0.6 mm reaches the one vertex under it.
#[test]
fn a_contact_of_few_vertices_is_to_be_read_about() {
    let contact = press(
        &mut flat_skin(14.0, 1.4, material(7.0), Model::Layer),
        &paraboloid(0.6, 0.3, 1.2),
    );
    let bearing = contact.nodal_force.iter().filter(|f| **f > 0.0).count();
    assert!((1..6).contains(&bearing), "{bearing}");
    assert!(contact.grade() >= Grade::ReadThis, "{:?}", contact.warnings);
    assert!(kinds(&contact.warnings).contains(&"few_vertices"));
}

#[test]
fn the_gravest_of_several_is_the_grade() {
    let (note, deep) = (
        Warning::Note("a note".to_owned()),
        Warning::Penetration { depth: 0.2 },
    );
    let read = Warning::Edge { patch_peak: 2.0 };
    assert!(note.grade() < read.grade() && read.grade() < deep.grade());
    let names = [Grade::Good, Grade::ReadThis, Grade::DoNotUse].map(Grade::name);
    assert_eq!(names, ["good", "read this", "do not use"]);
}

/// A square pin, `half` mm to each side of (x, y), from `low` up to 20 mm above the skin at z = 0.
fn pin((x, y): (f64, f64), half: f64, low: f64) -> Product {
    let corner = |i: usize| {
        let side = |bit: usize| if i & bit == 0 { -half } else { half };
        let height = if i & 4 == 0 { low } else { 20.0 };
        Vec3::new(x + side(1), y + side(2), height)
    };
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let mesh = Mesh::new((0..8).map(corner).collect(), faces.to_vec()).unwrap();
    Product::new(mesh).unwrap()
}

/// The center of the triangle of a flat skin nearest to its middle, and a corner of it.
fn between_vertices(mesh: &Mesh) -> ((f64, f64), Vec3) {
    let centers = mesh.triangles().iter().map(|t| {
        let [a, b, c] = t.map(|v| mesh.positions()[v as usize]);
        ((a + b + c) / 3.0, a)
    });
    let from_middle = |(p, _): &(Vec3, Vec3)| p.norm_squared();
    let nearest = centers.min_by(|p, q| from_middle(p).total_cmp(&from_middle(q)));
    let (center, corner) = nearest.unwrap();
    ((center.x, center.y), corner)
}

#[test]
fn a_pin_between_vertices_is_no_contact_and_says_where_it_is_under_the_skin() {
    let spacing = 1.4;
    let mesh = lattice(14.0, spacing, 0.3);
    let (place, _) = between_vertices(&mesh);
    for depth in [0.4, 1.5, 3.0] {
        let mut skin = flat_skin(14.0, spacing, material(7.0), Model::Layer);
        let contact = press(&mut skin, &pin(place, 0.1, -depth));
        assert_eq!(contact.nodal_force.iter().sum::<f64>(), 0.0);
        assert_eq!(contact.grade(), Grade::DoNotUse);
        let Some(Warning::ProductBetweenVertices {
            vertex,
            depth: found,
            touches: false,
            ..
        }) = contact.reason()
        else {
            panic!("{:?}", contact.warnings);
        };
        assert!((found - depth).abs() < 0.01, "{found} for {depth}");
        let at = mesh.positions()[*vertex];
        assert!((at.x - place.0).hypot(at.y - place.1) < 1.5 * spacing);
    }
}

#[test]
fn a_pin_above_the_skin_touches_nothing_and_is_not_under_it() {
    let (place, _) = between_vertices(&lattice(14.0, 1.4, 0.3));
    let mut skin = flat_skin(14.0, 1.4, material(7.0), Model::Layer);
    let contact = press(&mut skin, &pin(place, 0.1, 0.5));
    assert_eq!(contact.reason(), Some(&Warning::NoContact));
}

/// It meets one vertex, and reaches far deeper next to it.
#[test]
fn a_wall_that_few_vertices_meet_is_to_be_read_about() {
    let mesh = lattice(14.0, 1.4, 0.3);
    let (_, corner) = between_vertices(&mesh);
    let mut skin = flat_skin(14.0, 1.4, material(7.0), Model::Layer);
    let (near, far) = (
        pin((corner.x, corner.y), 0.1, -1.0),
        pin((corner.x + 0.6, corner.y), 0.1, -2.5),
    );
    let (a, b) = (near.mesh(), far.mesh());
    let positions = a.positions().iter().chain(b.positions()).copied().collect();
    let behind = b
        .triangles()
        .iter()
        .map(|t| t.map(|v| v + a.positions().len() as u32));
    let faces = a.triangles().iter().copied().chain(behind).collect();
    let both = Product::new(Mesh::new(positions, faces).unwrap()).unwrap();
    let contact = press(&mut skin, &both);
    assert!(contact.nodal_force.iter().sum::<f64>() > 0.0);
    assert_eq!(contact.grade(), Grade::ReadThis, "{:?}", contact.warnings);
    assert!(kinds(&contact.warnings).contains(&"product_between_vertices"));
}

#[test]
fn an_edge_of_a_block_that_skin_spans_is_no_product_between_vertices() {
    for half in [2.0, 3.3, 5.1] {
        let mut skin = flat_skin(14.0, 1.4, material(7.0), Model::Layer);
        let contact = press(&mut skin, &pin((0.2, 0.1), half, -1.2));
        assert!(contact.nodal_force.iter().sum::<f64>() > 0.0);
        let kinds = kinds(&contact.warnings);
        assert!(!kinds.contains(&"product_between_vertices"), "{kinds:?}");
    }
}
