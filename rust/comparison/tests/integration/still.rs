//! A frame beside a contact that was solved elsewhere, and the residual carried to the skin.

use crate::made;

use made::{Vec3, flat_mat};
use thenar_comparison::{RecordingComparison, Still, compare_still, on_skin};

fn measure(recording: &RecordingComparison, name: &str) -> [f64; 2] {
    let found = recording.measures.iter().find(|row| row.name == name);
    let row = found.unwrap_or_else(|| panic!("{name} is among the measures"));
    [row.measured, row.after]
}

/// A constant over the mat is that constant on the skin below it, nothing is told
/// beside it or far below it, and a linear field is kept between sensels of equal weight.
#[test]
fn residual_is_carried_to_the_skin() {
    let mat = flat_mat(4, 4, 5.0);
    let skin = [
        Vec3::new(7.5, 7.5, -0.8),
        Vec3::new(2.0, 13.0, -0.2),
        Vec3::new(40.0, 7.5, 0.0),
        Vec3::new(7.5, 7.5, -30.0),
    ];
    let constant = on_skin(&skin, &mat, &[3.0; 16], 1.0);
    assert!((constant[0] - 3.0).abs() < 1e-12 && (constant[1] - 3.0).abs() < 1e-12);
    assert!(constant[2..].iter().all(|value| value.is_nan()));
    let slope: Vec<f64> = mat
        .centers
        .iter()
        .map(|center| center.x + 2.0 * center.y)
        .collect();
    let middle = on_skin(&skin[..1], &mat, &slope, 1.0);
    assert!((middle[0] - 22.5).abs() < 1e-9, "{middle:?}");
}

/// A still of a contact: each sensel reads the force on it over its area, what falls beside the mat is told, and without noise
/// nothing is called significant.
#[test]
fn a_still_is_compared_sensel_by_sensel() {
    let mat = flat_mat(2, 2, 10.0);
    let positions = [
        Vec3::new(0.0, 0.0, 0.0),
        Vec3::new(10.0, 10.0, 0.0),
        Vec3::new(60.0, 0.0, 0.0),
    ];
    let comparison = compare_still(Still {
        name: "grasp",
        product: "cylinder",
        hand: "right hand",
        positions: &positions,
        areas: &[1.0; 3],
        force_n: &[2.0, 1.0, 1.0],
        mat,
        values: &[25.0, 0.0, f64::NAN, 10.0],
        is_calibrated: true,
        threshold: Some(3.0),
        clipped_from: None,
        noise: None,
        time_s: 4.0,
        unknown: Vec::new(),
    })
    .expect("a comparison");
    let recording = &comparison.recordings[0];
    let frame = &recording.frames[0];
    assert_eq!(frame.simulated[..2], [20.0, 0.0]);
    assert_eq!(frame.residual[..2], [5.0, 0.0]);
    assert!(frame.measured[2].is_nan() && frame.residual[3].abs() < 1e-9);
    assert_eq!(measure(recording, "overlap")[1], 1.0);
    assert!((measure(recording, "force_n")[0] - 3.5).abs() < 1e-12);
    assert!(
        comparison
            .notes
            .iter()
            .any(|note| note.contains("Of the simulated 4 N, 1 N press beside the mat")),
        "{:?}",
        comparison.notes
    );
    assert!(
        recording
            .trends
            .iter()
            .flat_map(|trend| &trend.bins)
            .all(|bin| !bin.stands_out())
    );
    assert!(
        comparison.sentence.contains("without repeats"),
        "{}",
        comparison.sentence
    );
}
