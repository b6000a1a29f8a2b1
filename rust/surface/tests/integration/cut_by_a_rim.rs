//! A sheet whose rim cuts into skin that goes on around it.

use crate::shapes;

use shapes::{Random, moved, sphere, v};
use thenar_surface::{Adjacency, GapLimits, Mesh, PosedSkin, Product, SkinSurface, vertex_normals};

#[test]
fn rim_of_a_steep_sheet_that_cuts_the_skin_a_little_is_not_read_deep() {
    // A ball of 8 mm as fingertip, its lowest point at the origin, with spacing about 1.7 mm.
    let skin = moved(&sphere(8.0, 16, 28), |p| p + v(0.3, 0.2, 8.0));
    let (normals, adjacency) = (vertex_normals(&skin), Adjacency::new(&skin));
    let seen = PosedSkin {
        points: skin.positions(),
        normals: &normals,
        surface: Some(SkinSurface {
            triangles: skin.triangles(),
            adjacency: &adjacency,
        }),
    };
    let limits = GapLimits {
        cut_off_mm: 8.0,
        max_depth_mm: 15.0,
    };
    let mut dice = Random(11);
    let mut cuts = 0;
    for _ in 0..60 {
        let (lean, turn): (f64, f64) = (0.2 + 0.3 * dice.next(), 6.0 * dice.next());
        let (cut, skew) = (0.3 + 0.9 * dice.next(), 4.0 * dice.next() - 2.0);
        let level = v(turn.cos(), turn.sin(), 0.0);
        let along = v(-turn.sin(), turn.cos(), 0.0);
        // It stands on its rim, turned by `lean` from upright, and comes from below.
        let down = level * lean.sin() - v(0.0, 0.0, lean.cos());
        let rim = v(0.3, 0.2, 0.0) + along * skew + v(0.0, 0.0, cut);
        let corners = vec![
            rim - along * 40.0,
            rim + along * 40.0,
            rim + along * 40.0 + down * 60.0,
            rim - along * 40.0 + down * 60.0,
        ];
        let sheet = Product::new(Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()).unwrap();
        let gaps = sheet.gaps_of_skin(&seen, limits).into_iter().flatten();
        let deepest = gaps.map(|gap| -gap.distance).fold(0.0, f64::max);
        // As deep as the cut, or one spacing along the skin where it crosses it.
        assert!(deepest < cut + 1.7, "{deepest} mm for a cut of {cut} mm");
        cuts += usize::from(deepest > 0.0);
    }
    assert!(cuts > 0);
}
