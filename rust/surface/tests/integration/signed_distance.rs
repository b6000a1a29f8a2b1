//! Signed distance against closed forms and against trying every triangle.

use crate::shapes;

use shapes::{Random, brute_distance, cuboid, cylinder, inside_out, sphere, v};
use thenar_surface::{GapLimits, Mesh, Product, Vec3};

const FULL: GapLimits = GapLimits {
    cut_off_mm: f64::INFINITY,
    max_depth_mm: 15.0,
};

/// Closed form for a box about the origin.
fn box_distance(half: Vec3, p: Vec3) -> f64 {
    let q = p.abs() - half;
    q.sup(&Vec3::zeros()).norm() + q.max().min(0.0)
}

#[test]
fn box_has_its_closed_form_everywhere() {
    let half = v(10.0, 4.0, 7.0);
    let product = Product::new(cuboid(-half, half)).unwrap();
    assert!(product.warnings().is_empty(), "{:?}", product.warnings());
    let mut random = Random(1);
    for _ in 0..20_000 {
        let p = random.within(20.0);
        let gap = product.gap(p, None, FULL).unwrap();
        assert!(
            (gap.distance - box_distance(half, p)).abs() < 1e-12,
            "{p:?}"
        );
        let step = p + gap.normal * 1e-6;
        assert!(
            (box_distance(half, step) - gap.distance - 1e-6).abs() < 1e-9,
            "gradient at {p:?}"
        );
    }
}

#[test]
fn prism_of_128_sides_has_its_closed_form() {
    let (r, h, n) = (24.0, 100.0, 128);
    let product = Product::new(cylinder(r, h, n)).unwrap();
    let apothem = r * (std::f64::consts::PI / f64::from(n)).cos();
    let mut random = Random(2);
    for _ in 0..20_000 {
        let p = random.within(60.0) + v(0.0, 0.0, 50.0);
        let gap = product.gap(p, None, FULL).unwrap();
        let rho = p.xy().norm();
        let (low, high) = (
            box_distance(v(apothem, 1e9, h / 2.0), v(rho, 0.0, p.z - h / 2.0)),
            box_distance(v(r, 1e9, h / 2.0), v(rho, 0.0, p.z - h / 2.0)),
        );
        // The prism lies between the cylinders through its sides and through its edges.
        assert!(
            gap.distance >= high.min(low) - 1e-9 && gap.distance <= high.max(low) + 1e-9,
            "{p:?}: {} not in {high}..{low}",
            gap.distance
        );
    }
}

#[test]
fn nearest_triangle_is_that_of_trying_all() {
    let mesh = sphere(20.0, 24, 40);
    let product = Product::new(mesh.clone()).unwrap();
    let mut random = Random(3);
    for _ in 0..2_000 {
        let p = random.within(40.0);
        let gap = product.gap(p, None, FULL).unwrap();
        assert_eq!(gap.distance.abs(), brute_distance(&mesh, p));
        let [a, b, c] = product.mesh().corners(gap.triangle as usize);
        let [x, y, z] = gap.barycentric;
        assert!((a * x + b * y + c * z - gap.closest).norm() < 1e-12);
    }
}

#[test]
fn inside_out_product_is_turned_and_told() {
    let product = Product::new(inside_out(&cuboid(v(0., 0., 0.), v(1., 2., 3.)))).unwrap();
    assert!(product.gap(v(0.5, 1.0, 1.5), None, FULL).unwrap().distance < 0.0);
    assert_eq!(product.warnings().len(), 1);
}

#[test]
fn side_is_right_next_to_a_sliver_whose_normal_is_rounding() {
    // A cube of 40 mm; on one edge a vertex off by 1e-6 mm makes a sliver that may face anywhere, as Booleans leave it.
    let box_of = cuboid(Vec3::repeat(-20.0), Vec3::repeat(20.0));
    let (a, b) = (Vec3::new(20.0, 20.0, -20.0), Vec3::new(20.0, 20.0, 20.0));
    let at = |p: Vec3| {
        box_of
            .positions()
            .iter()
            .position(|q| (q - p).norm() < 1e-9)
            .unwrap() as u32
    };
    let (a, b) = (at(a), at(b));
    for turn in 0..12 {
        let angle = f64::from(turn) * std::f64::consts::TAU / 12.0;
        let off = Vec3::new(angle.cos(), angle.sin(), 0.0) * 1e-6;
        let mut positions = box_of.positions().to_vec();
        let middle = positions.len() as u32;
        positions.push(Vec3::new(20.0, 20.0, 3.0) + off);
        let mut triangles = Vec::new();
        let mut is_split = false;
        for t in box_of.triangles() {
            let start = (0..3).find(|&k| t[k] == b && t[(k + 1) % 3] == a);
            match start {
                Some(k) => {
                    let c = t[(k + 2) % 3];
                    triangles.extend([[b, middle, c], [middle, a, c], [b, a, middle]]);
                    is_split = true;
                }
                None => triangles.push(*t),
            }
        }
        assert!(is_split);
        let product = Product::new(Mesh::new(positions, triangles).unwrap()).unwrap();
        for side in 0..24 {
            let toward = f64::from(side) * std::f64::consts::TAU / 24.0 + 0.05;
            let p = Vec3::new(20.0, 20.0, 2.0) + Vec3::new(toward.cos(), toward.sin(), 0.0) * 1.5;
            let is_inside = p.x < 20.0 && p.y < 20.0;
            let gap = product.gap(p, None, FULL).unwrap();
            assert_eq!(
                gap.distance < 0.0,
                is_inside,
                "{p:?}: {gap:?}, sliver {turn}"
            );
        }
    }
}

#[test]
fn the_nearest_place_is_that_of_the_signed_distance_whatever_the_side() {
    let mut random = Random(5);
    let whole = sphere(7.0, 12, 17);
    // Without its top it is open: there the side takes a winding number.
    let bowl = whole.triangles().iter().copied();
    let bowl = bowl
        .filter(|t| t.iter().all(|&i| whole.positions()[i as usize].z < 4.0))
        .collect();
    let bowl = Mesh::new(whole.positions().to_vec(), bowl).unwrap();
    for mesh in [whole, bowl] {
        let product = Product::new(mesh.clone()).unwrap();
        let points: Vec<Vec3> = (0..400).map(|_| random.within(11.0)).collect();
        let limits = GapLimits {
            cut_off_mm: f64::INFINITY,
            max_depth_mm: 100.0,
        };
        let cut = 2.5;
        let nearest = product.nearest(&points, cut);
        let signed = product.gaps(&points, None, limits);
        let mut beyond = 0;
        for ((p, nearest), signed) in points.iter().zip(nearest).zip(signed) {
            let signed = signed.unwrap();
            let distance = brute_distance(&mesh, *p);
            let Some(nearest) = nearest else {
                assert!(distance > cut);
                beyond += 1;
                continue;
            };
            assert!((nearest.distance - distance).abs() < 1e-9 && distance <= cut);
            assert_eq!(nearest.distance, signed.distance.abs());
            assert_eq!(nearest.closest, signed.closest);
            assert_eq!(nearest.triangle, signed.triangle);
        }
        assert!((100..350).contains(&beyond), "{beyond}");
    }
}
