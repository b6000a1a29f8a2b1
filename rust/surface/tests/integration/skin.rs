//! Patches and distances along the skin against surfaces whose geodesics are known.

use crate::shapes;

use shapes::{Random, sphere, together, v};
use thenar_surface::{Adjacency, Mesh, SkinDistance, Vec3};

/// A jittered triangular lattice in the plane, `n` by `n`, spacing 2.4 mm.
fn sheet(n: u32, jitter: f64, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut p = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let off = random.within(jitter * 2.4);
            p.push(
                v(
                    2.4 * (f64::from(i) + 0.5 * f64::from(j % 2)),
                    2.4 * 0.866 * f64::from(j),
                    0.0,
                ) + v(off.x, off.y, 0.0),
            );
        }
    }
    let mut t = Vec::new();
    for j in 0..n - 1 {
        for i in 0..n - 1 {
            let a = j * n + i;
            t.extend(if j % 2 == 0 {
                [[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]
            } else {
                [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]
            });
        }
    }
    Mesh::new(p, t).unwrap()
}

fn check(mesh: &Mesh, true_distance: impl Fn(Vec3, Vec3) -> f64) -> f64 {
    let skin = SkinDistance::new(mesh, &Adjacency::new(mesh), 60.0);
    let p = mesh.positions();
    let is_center = |i: usize| skin.center(skin.patch_of(i)) == i as u32;
    let (mut tightest, mut loosest_far) = (0.0f64, 1.0f64);
    for a in 0..p.len() {
        for b in (0..p.len()).step_by(3) {
            let bound = skin.lower_bound(skin.patch_of(a), skin.patch_of(b));
            let exact = true_distance(p[a], p[b]);
            if bound.is_finite() {
                assert!(bound <= exact + 1e-9, "bound {bound} over {exact}");
                tightest = tightest.max(bound / exact.max(1.0));
                if exact > 40.0 && is_center(a) && is_center(b) {
                    loosest_far = loosest_far.min(bound / exact);
                }
            } else {
                assert!(exact > 60.0 / 1.7, "{exact} taken for beyond 60");
            }
        }
    }
    // A gate is of use where the way along the skin is long, however short the chord; 20 mm of it are the reach of two patches.
    assert!(loosest_far > 0.25, "only {loosest_far} of the distance");
    tightest
}

#[test]
fn bounds_hold_on_a_plane_a_cylinder_and_a_sphere() {
    for seed in 1..4 {
        let flat = sheet(30, 0.2, seed);
        assert!(check(&flat, |a, b| (a - b).norm()) > 0.6);
        let rolled = shapes::moved(&flat, |p| {
            v(
                12.0 * (p.x / 12.0 + 0.1).sin(),
                p.y,
                12.0 * (p.x / 12.0 + 0.1).cos(),
            )
        });
        let unroll = |p: Vec3| {
            v(
                12.0 * p.x.atan2(p.z).rem_euclid(std::f64::consts::TAU),
                p.y,
                0.0,
            )
        };
        check(&rolled, |a, b| (unroll(a) - unroll(b)).norm());
    }
    let ball = sphere(15.0, 24, 40);
    check(&ball, |a, b| {
        15.0 * 0.98 * (a.dot(&b) / 225.0).clamp(-1.0, 1.0).acos()
    });
}

#[test]
fn patches_cover_every_vertex_once_and_parts_are_far() {
    let two = together(&[
        sphere(5.0, 12, 16),
        shapes::moved(&sphere(5.0, 12, 16), |p| p + v(11.0, 0.0, 0.0)),
    ]);
    let skin = SkinDistance::new(&two, &Adjacency::new(&two), 50.0);
    let mut seen = vec![0; two.positions().len()];
    for (k, members) in skin.patches().enumerate() {
        assert!(members.len() <= 32);
        for &i in members {
            seen[i as usize] += 1;
            assert_eq!(skin.patch_of(i as usize), k as u32);
        }
    }
    assert!(seen.iter().all(|&n| n == 1));
    let half = two.positions().len() / 2;
    assert_eq!(
        skin.lower_bound(skin.patch_of(0), skin.patch_of(half)),
        f64::INFINITY
    );
    assert_eq!(skin.lower_bound(skin.patch_of(0), skin.patch_of(0)), 0.0);
    assert!(skin.len() < two.positions().len() / 16);
}
