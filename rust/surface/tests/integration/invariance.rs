//! What must not change the answer: threads, hints, rigid motion, a far origin; and what random meshes must not do.

use crate::shapes;

use proptest::prelude::*;
use shapes::{Random, brute_distance, moved, sphere, v};
use thenar_surface::{
    Adjacency, Gap, GapLimits, Mesh, PosedSkin, Product, Readings, SkinDistance, SkinSurface, Vec3,
    closest_point, renew_shape, self_intersections, vertex_areas, vertex_normals,
};

const FULL: GapLimits = GapLimits {
    cut_off_mm: f64::INFINITY,
    max_depth_mm: 15.0,
};
const CUT: GapLimits = GapLimits {
    cut_off_mm: 3.0,
    max_depth_mm: 6.0,
};

/// A ball with dents, and a skin ball that runs into it.
fn scene() -> (Mesh, Mesh) {
    let dented = moved(&sphere(10.0, 24, 40), |p| {
        p * (1.0 + 0.1 * (0.7 * p.x).sin() * (0.9 * p.y).cos())
    });
    (
        dented,
        moved(&sphere(6.0, 16, 28), |p| p + v(13.1, 1.3, 0.7)),
    )
}

fn query(product: &Product, skin: &Mesh, limits: GapLimits) -> Vec<Option<Gap>> {
    let (normals, adjacency) = (vertex_normals(skin), Adjacency::new(skin));
    let surface = (skin.triangles(), &adjacency);
    product.gaps_of_skin(&posed(skin.positions(), &normals, surface), limits)
}

fn posed<'a>(
    points: &'a [Vec3],
    normals: &'a [Vec3],
    (triangles, adjacency): (&'a [[u32; 3]], &'a Adjacency),
) -> PosedSkin<'a> {
    PosedSkin {
        points,
        normals,
        surface: Some(SkinSurface {
            triangles,
            adjacency,
        }),
    }
}

fn with_threads(
    threads: usize,
    work: impl FnOnce() -> Vec<Option<Gap>> + Send,
) -> Vec<Option<Gap>> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(work)
}

#[test]
fn same_bits_for_any_threads_and_hints() {
    let (product, skin) = scene();
    let product = Product::new(product).unwrap();
    for limits in [FULL, CUT] {
        let one = with_threads(1, || query(&product, &skin, limits));
        assert_eq!(one, with_threads(2, || query(&product, &skin, limits)));
        let mut random = Random(7);
        let count = product.mesh().triangles().len() as f64;
        let hints: Vec<u32> = one
            .iter()
            .map(|_| (random.next() * count * 1.1) as u32)
            .collect();
        let normals = vertex_normals(&skin);
        let along = |hints| product.gaps_along(skin.positions(), Some(&normals), limits, hints);
        assert_eq!(along(&[]), along(&hints));
        let single: Vec<_> = skin
            .positions()
            .iter()
            .map(|&p| product.gap(p, None, limits))
            .collect();
        assert_eq!(single, product.gaps(skin.positions(), None, limits));
    }
}

#[test]
fn cut_off_leaves_the_rest_untouched() {
    let (product, _) = scene();
    let product = Product::new(product).unwrap();
    let mut random = Random(8);
    for _ in 0..5_000 {
        let p = random.within(16.0);
        let (full, cut) = (
            product.gap(p, None, FULL).unwrap(),
            product.gap(p, None, CUT),
        );
        assert_eq!(cut, Some(full).filter(|g| g.distance <= 3.0));
    }
}

#[test]
fn rigid_motion_and_a_far_origin_change_nothing() {
    let (product, skin) = scene();
    let still = query(&Product::new(product.clone()).unwrap(), &skin, CUT);
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    // 5.9 km away, f64 itself is 9e-10 mm apart, which rounding the input adds to every coordinate.
    for (shift, tolerance) in [(v(31.0, -17.0, 5.0), 1e-9), (v(5.9e6, -5.9e6, 1e6), 1e-8)] {
        let go = |p: Vec3| turn * p + shift;
        let there = query(
            &Product::new(moved(&product, go)).unwrap(),
            &moved(&skin, go),
            CUT,
        );
        for (a, b) in still.iter().zip(&there) {
            assert_eq!(a.is_some(), b.is_some());
            if let (Some(a), Some(b)) = (a, b) {
                assert!(
                    (a.distance - b.distance).abs() < tolerance,
                    "{} {}",
                    a.distance,
                    b.distance
                );
                assert!(
                    a.distance.abs() < 1e-3
                        || (turn * a.normal - b.normal).norm() < 1e4 * tolerance
                );
            }
        }
    }
}

#[test]
fn distance_to_a_sphere_converges_with_the_square_of_the_spacing() {
    let error = |rings: u32| {
        let product = Product::new(sphere(10.0, rings, 2 * rings)).unwrap();
        let mut random = Random(9);
        let one =
            |p: Vec3| (product.gap(p, None, FULL).unwrap().distance - (p.norm() - 10.0)).abs();
        (0..500)
            .map(|_| one(random.direction() * (5.0 + 10.0 * random.next())))
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(20), error(40));
    assert!(
        fine < 0.02 && coarse / fine > 3.5 && coarse / fine < 4.5,
        "{coarse} {fine}"
    );
}

#[test]
fn half_a_million_triangles_answer_like_the_sphere_they_cover() {
    let start = std::time::Instant::now();
    let product = Product::new(sphere(60.0, 500, 500)).unwrap();
    println!(
        "{} triangles in {:?}",
        product.mesh().triangles().len(),
        start.elapsed()
    );
    let mut random = Random(11);
    let points: Vec<Vec3> = (0..2_000)
        .map(|_| random.direction() * (50.0 + 20.0 * random.next()))
        .collect();
    for (p, gap) in points.iter().zip(product.gaps(&points, None, FULL)) {
        assert!((gap.unwrap().distance - (p.norm() - 60.0)).abs() < 2e-3);
    }
}

#[test]
fn long_thin_triangles_are_not_missed() {
    let mut random = Random(10);
    for round in 0..30 {
        let (mut p, mut t) = (Vec::new(), Vec::new());
        for k in 0..60u32 {
            let (at, along) = (random.within(10.0), random.direction() * 20.0);
            let thin = random.direction() * 10f64.powf(-4.0 * random.next());
            p.extend([at, at + along, at + along * random.next() + thin]);
            t.push([3 * k, 3 * k + 1, 3 * k + 2]);
        }
        let mesh = Mesh::new(p, t).unwrap();
        let product = Product::new(mesh.clone()).unwrap();
        for _ in 0..200 {
            let q = random.within(if round % 2 == 0 { 15.0 } else { 300.0 });
            let distance = product.gap(q, None, FULL).unwrap().distance.abs();
            assert!((distance - brute_distance(&mesh, q)).abs() <= 1e-12 * q.norm().max(1.0));
        }
    }
}

fn any_mesh() -> impl Strategy<Value = (Vec<Vec3>, Vec<[u32; 3]>)> {
    // Few distinct coordinates and few vertices make coincident, flat, duplicated and crossing triangles common.
    let coordinate = prop_oneof![
        (-2i8..3).prop_map(f64::from),
        -3.0..3.0f64,
        Just(1e-9),
        Just(1e6)
    ];
    let point = prop::array::uniform3(coordinate).prop_map(|[x, y, z]| v(x, y, z));
    prop::collection::vec(point, 1..12).prop_flat_map(|p| {
        let index = 0..p.len() as u32;
        (
            Just(p),
            prop::collection::vec(prop::array::uniform3(index), 1..30),
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_meshes_give_sound_answers((p, t) in any_mesh(), seed in 1u64..1_000_000) {
        let mesh = Mesh::new(p.clone(), t).unwrap();
        mesh.audit().warnings("it");
        self_intersections(&mesh);
        let skin = SkinDistance::new(&mesh, &Adjacency::new(&mesh), 5.0);
        prop_assert_eq!(skin.patches().map(<[u32]>::len).sum::<usize>(), p.len());
        let Ok(product) = Product::new(mesh) else { return Ok(()) };
        let mut random = Random(seed);
        let mut points = p;
        points.extend((0..6).map(|_| random.within(4.0)));
        let normals: Vec<Vec3> = points.iter().map(|_| random.direction()).collect();
        let nearest = |q: Vec3| {
            let all = product.mesh().triangles().iter().enumerate();
            // From every corner: measured from one, a needle of that size may be off by more than the bound.
            let turns = |[a, b, c]: [Vec3; 3]| [[a, b, c], [b, c, a], [c, a, b]];
            all.flat_map(|(t, _)| turns(product.mesh().corners(t)))
                .map(|corners| closest_point(corners, q).distance_squared.sqrt())
                .fold(f64::INFINITY, f64::min)
        };
        for gap in product.gaps(&points, None, FULL).iter().zip(&points) {
            let (Some(g), q) = gap else { panic!("no gap") };
            // Triangles without area are left out, so the distance may only be larger, and by rounding smaller: coordinates
            // reach 1e6, and thin triangles of that size lose six of the 16 digits.
            prop_assert!(g.distance.abs() >= nearest(*q) - 1e-10 * 1e6_f64.max(q.norm()), "{:?} {}", g, nearest(*q));
            prop_assert!((g.normal.norm() - 1.0).abs() < 1e-9 && g.barycentric.iter().all(|w| (0.0..=1.0).contains(w)));
            prop_assert!((g.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        for g in product.gaps(&points, Some(&normals), CUT).into_iter().flatten() {
            prop_assert!(g.distance.is_finite() && g.normal.iter().all(|x| x.is_finite()));
        }
    }
}

#[test]
fn readings_normals_and_areas_of_skin_that_moves_in_part_are_those_of_all_of_it_bit_for_bit() {
    let (dented, skin) = scene();
    let other = Product::new(moved(&dented, |p| p * 1.02)).unwrap();
    let adjacency = Adjacency::new(&skin);
    let surface = (skin.triangles(), &adjacency);
    let products = [Product::new(dented).unwrap(), other];
    let mut random = Random(11);
    let (mut readings, mut positions) = (Readings::default(), skin.positions().to_vec());
    let (mut normals, mut areas) = (vertex_normals(&skin), vertex_areas(&skin));
    for frame in 0..24 {
        let middle = v(10.0, 0.0, 0.0) + random.within(5.0);
        let by = random.within(0.6);
        let has_moved: Vec<bool> = positions
            .iter()
            .map(|p| (p - middle).norm() < 3.0)
            .collect();
        for (p, has_moved) in positions.iter_mut().zip(&has_moved) {
            *p += if *has_moved { by } else { Vec3::zeros() };
        }
        let moved = skin.with_positions(positions.clone()).unwrap();
        renew_shape(&moved, &has_moved, (&mut normals, &mut areas));
        assert_eq!(normals, vertex_normals(&moved), "{frame}");
        assert_eq!(areas, vertex_areas(&moved), "{frame}");
        let product = &products[frame / 6 % 2];
        let limits = if frame % 12 < 9 { CUT } else { FULL };
        let again =
            product.gaps_after(&mut readings, &posed(&positions, &normals, surface), limits);
        assert_eq!(*again, query(product, &moved, limits), "{frame}");
        let distance = |gap: &Option<Gap>| gap.map_or(f64::INFINITY, |gap| gap.distance);
        let distances: Vec<f64> = again.iter().map(distance).collect();
        assert_eq!(readings.distances(), distances, "{frame}");
    }
    // Skin that lies where it lay and faces the other way.
    let turned: Vec<Vec3> = normals.iter().map(|n| -n).collect();
    let before = products[0].gaps_after(&mut readings, &posed(&positions, &normals, surface), CUT);
    let again = products[0].gaps_after(&mut readings, &posed(&positions, &turned, surface), CUT);
    assert_eq!(
        *again,
        products[0].gaps_of_skin(&posed(&positions, &turned, surface), CUT)
    );
    assert_ne!(again, before, "which way skin faces matters here");
}
