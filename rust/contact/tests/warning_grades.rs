//! The grade of a result: out-of-range results are flagged, meaningless ones are never good.
#![allow(clippy::unwrap_used)]

mod scenes;

use scenes::{flat_skin, material, paraboloid, press};
use thenar_contact::{Grade, Model, Warning};

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
