//! The skin as a mesh: closed, well shaped, of the spacing asked for, mirrored exactly, the same bits each time.

use crate::measuring;

use measuring::{corners, default_hand, hand, smallest_angle};
use proptest::prelude::*;
use thenar_hand::{HandShape, Sex, Side};
use thenar_surface::self_intersections;

#[test]
fn default_hand_is_closed_well_shaped_and_of_the_papers_density() {
    let hand = default_hand();
    let audit = hand.mesh.audit();
    assert!(audit.is_closed() && !audit.is_inside_out() && audit.parts == 1);
    assert_eq!(
        audit.degenerate_triangles + audit.duplicate_triangles + audit.isolated_vertices,
        0
    );
    assert_eq!(self_intersections(&hand.mesh), 0);
    // Xie Table 5: 9,693 vertices.
    let vertices = hand.mesh.positions().len();
    assert!((9200..=10200).contains(&vertices), "{vertices} vertices");
    // A closed surface without handles has two vertices more than half its triangles.
    assert_eq!(hand.mesh.triangles().len(), 2 * (vertices - 2));
}

#[test]
fn triangles_and_edges_keep_their_promises_at_every_spacing() {
    for spacing_mm in [1.25, 2.5, 5.0] {
        let hand = hand(&HandShape {
            spacing_mm,
            ..HandShape::default()
        });
        let sharpest = (0..hand.mesh.triangles().len())
            .map(|t| smallest_angle(corners(&hand.mesh, t)))
            .fold(90.0, f64::min);
        assert!(sharpest >= 20.0, "{sharpest} degrees at {spacing_mm} mm");
        assert_eq!(self_intersections(&hand.mesh), 0, "at {spacing_mm} mm");
        let share = measuring::palmar_edges_in_range(&hand, spacing_mm);
        assert!(share >= 0.99, "{share} of palmar edges at {spacing_mm} mm");
    }
}

/// At this size and spacing the extraction once lost a block at the little finger's tip, and the skin had a hole.
#[test]
fn a_small_man_whose_little_finger_grazes_a_block_gets_a_closed_hand() {
    let hand = hand(&HandShape {
        percentile: 1.4837531378264395,
        spacing_mm: 2.3001469187093293,
        ..HandShape::default()
    });
    let audit = hand.mesh.audit();
    assert!(audit.is_closed() && audit.parts == 1);
    assert_eq!(self_intersections(&hand.mesh), 0);
}

#[test]
fn left_hand_mirrors_the_right_exactly() {
    let right = default_hand();
    let left = hand(&HandShape {
        side: Side::Left,
        ..HandShape::default()
    });
    for (r, l) in right.mesh.positions().iter().zip(left.mesh.positions()) {
        assert!(r.x == -l.x && r.y == l.y && r.z == l.z);
    }
    assert!(
        (right.mesh.audit().signed_volume_mm3 - left.mesh.audit().signed_volume_mm3).abs() < 1e-6
    );
    assert_eq!(right.regions, left.regions);
    assert_eq!(right.weights, left.weights);
}

#[test]
fn same_shape_gives_the_same_bits_on_any_number_of_threads() {
    let shape = HandShape {
        spacing_mm: 4.0,
        ..HandShape::default()
    };
    let first = hand(&shape);
    let single = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one");
    let second = single.install(|| hand(&shape));
    assert_eq!(first.mesh.positions(), second.mesh.positions());
    assert_eq!(first.mesh.triangles(), second.mesh.triangles());
    assert_eq!(first.weights, second.weights);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_person_gets_a_closed_hand(percentile in 1.0..99.0f64, is_male: bool, spacing_mm in 2.2..5.0f64) {
        let sex = if is_male { Sex::Male } else { Sex::Female };
        let hand = hand(&HandShape { percentile, sex, spacing_mm, ..HandShape::default() });
        prop_assert!(hand.mesh.audit().is_closed());
        prop_assert_eq!(self_intersections(&hand.mesh), 0);
        let sharpest = (0..hand.mesh.triangles().len()).map(|t| smallest_angle(corners(&hand.mesh, t))).fold(90.0, f64::min);
        prop_assert!(sharpest >= 20.0, "{} degrees", sharpest);
    }
}
