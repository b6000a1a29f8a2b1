//! Depth through walls thinner than the press: plates, cups, sheets, seen by a whole fingertip.

use crate::shapes;

use shapes::{Random, cuboid, cylinder, moved, sphere, v};
use thenar_surface::{
    Adjacency, Gap, GapLimits, Mesh, PosedSkin, Product, Readings, SkinSurface, Vec3,
    vertex_normals,
};

const LIMITS: GapLimits = GapLimits {
    cut_off_mm: 8.0,
    max_depth_mm: 15.0,
};
const R: f64 = 8.0;

/// A ball of 8 mm as fingertip, its lowest point at z = `-depth`, with spacing about 1.7 mm.
fn tip(depth: f64) -> Mesh {
    moved(&sphere(R, 16, 28), |p| p + v(0.3, 0.2, R - depth))
}

fn posed<'a>(skin: &'a Mesh, normals: &'a [Vec3], adjacency: &'a Adjacency) -> PosedSkin<'a> {
    PosedSkin {
        points: skin.positions(),
        normals,
        surface: Some(SkinSurface {
            triangles: skin.triangles(),
            adjacency,
        }),
    }
}

fn press(product: &Product, skin: &Mesh) -> Vec<Option<Gap>> {
    let (normals, adjacency) = (vertex_normals(skin), Adjacency::new(skin));
    product.gaps_of_skin(&posed(skin, &normals, &adjacency), LIMITS)
}

/// Largest error of the readings of the lower half against the depth below z = 0, and how many of the upper half read inside.
fn judge(product: &Product, depth: f64) -> (f64, usize) {
    let skin = tip(depth);
    let middle = R - depth;
    let (mut worst, mut false_inside) = (0.0f64, 0);
    for (p, gap) in skin.positions().iter().zip(press(product, &skin)) {
        if p.z < middle - 0.25 * R {
            let gap = gap.unwrap();
            worst = worst.max((gap.distance - p.z).abs());
        } else if p.z > 0.0 && gap.is_some_and(|g| g.distance < 0.0) {
            false_inside += 1;
        }
    }
    (worst, false_inside)
}

fn plate(thickness: f64) -> Product {
    Product::new(cuboid(v(-60., -60., -thickness), v(60., 60., 0.))).unwrap()
}

#[test]
fn plate_reads_the_press_not_the_far_side() {
    // Deeper into the thinner walls, the ball is through to beyond its middle, and which way it came is anyone's guess.
    for (thickness, depth) in [
        (8., 4.),
        (8., 6.),
        (8., 10.),
        (2., 4.),
        (2., 6.),
        (1., 4.),
        (1., 6.),
    ] {
        let (worst, false_inside) = judge(&plate(thickness), depth);
        assert!(
            worst < 1e-9,
            "press {depth} into {thickness} is off by {worst}"
        );
        assert_eq!(false_inside, 0, "press {depth} into {thickness}");
    }
}

#[test]
fn plate_reads_the_same_wherever_it_lies() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.7, 0.3, -1.9);
    let go = |p: Vec3| turn * p + v(100.0, -3000.0, 20.0);
    let slab = cuboid(v(-60., -60., -2.), v(60., 60., 0.));
    let skin = tip(6.0);
    let still = press(&Product::new(slab.clone()).unwrap(), &skin);
    let there = press(&Product::new(moved(&slab, go)).unwrap(), &moved(&skin, go));
    for (a, b) in still.iter().zip(&there) {
        assert_eq!(a.is_some(), b.is_some());
        if let (Some(a), Some(b)) = (a, b) {
            assert!(
                (a.distance - b.distance).abs() < 1e-9
                    && (turn * a.normal - b.normal).norm() < 1e-6,
                "{a:?} {b:?}"
            );
        }
    }
}

#[test]
fn plate_without_skin_normals_reads_the_nearest_side() {
    let gap = plate(8.0).gap(v(0., 0., -6.0), None, LIMITS).unwrap();
    assert!((gap.distance + 2.0).abs() < 1e-12);
    let gap = plate(8.0)
        .gap(v(0., 0., -6.0), Some(v(0., 0., -1.)), LIMITS)
        .unwrap();
    assert!((gap.distance + 6.0).abs() < 1e-12 && (gap.normal - v(0., 0., 1.)).norm() < 1e-12);
}

#[test]
fn back_of_a_fold_near_a_thin_wall_stays_outside() {
    // A flat fold of skin 6 mm thick lies on a wall 1 mm thick: its back faces away at 6 mm and is not through.
    let fold = moved(&sphere(1.0, 16, 28), |p| {
        v(15.0 * p.x, 15.0 * p.y, 3.0 * p.z + 2.99)
    });
    for gap in press(&plate(1.0), &fold).iter().flatten() {
        assert!(gap.distance > -0.0101, "{gap:?}");
    }
}

#[test]
fn lone_vertex_beyond_the_wall_is_not_taken_through() {
    let gaps = plate(1.0).gaps(&[v(0., 0., -3.)], Some(&[v(0., 0., -1.)]), LIMITS);
    assert!(gaps[0].unwrap().distance > 0.0);
}

/// A round cup about z, open at the top, radius 30 outside, 60 high, wall 2 mm; or only its outer sheet.
fn cup(has_thickness: bool) -> Product {
    let profile: &[(f64, f64)] = if has_thickness {
        &[
            (0., 0.),
            (30., 0.),
            (30., 60.),
            (28., 60.),
            (28., 2.),
            (0., 2.),
        ]
    } else {
        &[(0., 0.), (30., 0.), (30., 60.)]
    };
    let sides = 256u32;
    let (mut p, mut t) = (Vec::new(), Vec::new());
    for &(r, z) in profile {
        for k in 0..sides {
            let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
            p.push(v(r * c, r * s, z));
        }
    }
    for ring in 0..profile.len() as u32 - 1 {
        for k in 0..sides {
            let (a, b) = (ring * sides + k, ring * sides + (k + 1) % sides);
            t.extend([[a, b, b + sides], [a, b + sides, a + sides]]);
        }
    }
    Product::new(Mesh::new(p, t).unwrap()).unwrap()
}

/// Presses a tip `depth` into the wall of a cup at mid height, from outside (1) or inside (-1), and compares with a round wall.
fn judge_cup(product: &Product, radius: f64, depth: f64, from: f64) {
    let center = v(radius + from * (R - depth), 0.0, 30.0);
    let skin = moved(&sphere(R, 16, 28), |p| v(p.z, p.x, p.y) * -from + center);
    assert!(skin.audit().signed_volume_mm3 > 0.0 || from > 0.0);
    let normals: Vec<Vec3> = skin.positions().iter().map(|p| (p - center) / R).collect();
    let gaps = product.gaps(skin.positions(), Some(&normals), LIMITS);
    for ((p, normal), gap) in skin.positions().iter().zip(&normals).zip(gaps) {
        let wanted = from * (p.xy().norm() - radius);
        if normal.x * from < -0.3 {
            let gap = gap.unwrap();
            assert!(
                (gap.distance - wanted).abs() < 0.02,
                "{} for {wanted} at {p:?} from {from}",
                gap.distance
            );
        } else if normal.x * from > 0.2 {
            assert!(
                gap.is_none_or(|g| g.distance > 0.0),
                "{gap:?} at {p:?} from {from}"
            );
        }
    }
}

#[test]
fn cup_reads_right_from_outside_and_inside() {
    for depth in [1.0, 3.0, 5.0] {
        judge_cup(&cup(true), 30.0, depth, 1.0);
        judge_cup(&cup(true), 28.0, depth, -1.0);
    }
}

#[test]
fn cup_of_a_single_sheet_reads_right_from_outside_and_inside() {
    for depth in [1.0, 3.0, 5.0] {
        judge_cup(&cup(false), 30.0, depth, 1.0);
        judge_cup(&cup(false), 30.0, depth, -1.0);
    }
}

#[test]
fn skin_deeper_in_a_hollow_sheet_than_the_cut_off_reads_its_depth() {
    let pot = cup(false);
    for depth in [7.0, 9.0, 12.0, 14.0] {
        let center = v(30.0 + 40.0 - depth, 0.0, 30.0);
        let skin = moved(&sphere(40.0, 48, 72), |p| v(p.z, p.x, p.y) + center);
        let mut deep = 0;
        for (p, gap) in skin.positions().iter().zip(press(&pot, &skin)) {
            let wanted = p.xy().norm() - 30.0;
            if wanted < 0.0 && p.x > 0.0 && (15.0..55.0).contains(&p.z) {
                let found = gap.map_or(f64::INFINITY, |gap| gap.distance);
                assert!(
                    (found - wanted).abs() < 0.02,
                    "{found} for {wanted} at {p:?}"
                );
                deep += usize::from(wanted < -LIMITS.cut_off_mm);
            }
        }
        assert_eq!(deep > 0, depth > LIMITS.cut_off_mm);
    }
}

#[test]
fn finger_in_a_pot_without_a_lid_is_outside_however_far_from_its_walls() {
    let finger = moved(&sphere(R, 32, 28), |p| v(p.x, p.y, 6.0 * p.z + 60.0));
    for gap in press(&cup(false), &finger) {
        assert!(gap.is_none_or(|gap| gap.distance > 0.0), "{gap:?}");
    }
}

#[test]
fn flat_sheet_reads_right_from_both_sides() {
    let corners = vec![
        v(-60., -60., 0.),
        v(60., -60., 0.),
        v(60., 60., 0.),
        v(-60., 60., 0.),
    ];
    for triangles in [vec![[0, 1, 2], [0, 2, 3]], vec![[0, 2, 1], [0, 3, 2]]] {
        let sheet = Product::new(Mesh::new(corners.clone(), triangles).unwrap()).unwrap();
        for depth in [1.0, 4.0, 6.0] {
            let (worst, false_inside) = judge(&sheet, depth);
            assert!(
                worst < 1e-9 && false_inside == 0,
                "press {depth}: off by {worst}, {false_inside} false"
            );
        }
    }
}

/// A box of one sheet about the origin, 40 mm wide and 20 deep, its floor at z = 0, without its lid.
fn lidless() -> Product {
    let walls = cuboid(v(-20., -20., 0.), v(20., 20., 20.));
    let is_lid = |t: &[u32; 3]| t.iter().all(|&i| walls.positions()[i as usize].z > 19.0);
    let kept: Vec<[u32; 3]> = walls
        .triangles()
        .iter()
        .copied()
        .filter(|t| !is_lid(t))
        .collect();
    assert_eq!(kept.len(), 10);
    Product::new(Mesh::new(walls.positions().to_vec(), kept).unwrap()).unwrap()
}

#[test]
fn skin_beside_a_patch_through_a_sheet_reads_by_its_side_of_the_sheet() {
    // Pots without a lid, of one sheet, pressed from outside: at the rim of the patch the skin is tangent to the wall.
    for (radius, height, depth) in [
        (40.0, 120.0, 2.0),
        (40.0, 120.0, 6.0),
        (40.0, 120.0, 7.0),
        (17.0, 115.0, 4.0),
        (17.0, 115.0, 6.5),
    ] {
        let whole = cylinder(radius, height, 96);
        let top = whole
            .positions()
            .iter()
            .map(|p| p.z)
            .fold(f64::MIN, f64::max);
        let is_lid = |t: &[u32; 3]| {
            t.iter()
                .all(|&i| whole.positions()[i as usize].z > top - 1e-9)
        };
        let walls = whole.triangles().iter().filter(|t| !is_lid(t)).copied();
        let pot =
            Product::new(Mesh::new(whole.positions().to_vec(), walls.collect()).unwrap()).unwrap();
        assert!((0..pot.mesh().triangles().len()).all(|t| pot.is_sheet(t)));
        for turned in 0..8 {
            let angle = 0.37 * f64::from(turned);
            let place = v(
                (radius + R - depth) * angle.cos(),
                (radius + R - depth) * angle.sin(),
                top - 58.2,
            );
            let skin = moved(&sphere(R, 18, 30), |p| v(p.z, p.x, p.y) + place);
            for (p, gap) in skin.positions().iter().zip(press(&pot, &skin)) {
                let from_axis = p.xy().norm();
                // Facets lie up to 0.03 mm within the circle.
                if (from_axis - radius).abs() > 0.05 {
                    let gap = gap.map_or(f64::INFINITY, |gap| gap.distance); // none is out of reach
                    let text =
                        format!("{gap} at radius {from_axis} of {radius}, pressed {depth} mm");
                    assert_eq!(gap < 0.0, from_axis < radius, "{text}");
                }
            }
        }
    }
}

#[test]
fn patch_of_skin_wholly_within_a_lidless_box_has_come_through_its_floor() {
    let points: Vec<Vec3> = (0..49)
        .map(|i| v(f64::from(i % 7) - 3.0, f64::from(i / 7) - 3.0, 0.6))
        .collect();
    let facing = |z: f64| vec![v(0.0, 0.0, z); points.len()];
    for gap in lidless().gaps(&points, Some(&facing(1.0)), LIMITS) {
        let gap = gap.unwrap();
        assert!((gap.distance + 0.6).abs() < 1e-12, "{gap:?}");
        assert!((gap.normal - v(0., 0., -1.)).norm() < 1e-12, "{gap:?}");
    }
    // Skin that faces the floor from within has not touched it.
    for gap in lidless().gaps(&points, Some(&facing(-1.0)), LIMITS) {
        assert!((gap.unwrap().distance - 0.6).abs() < 1e-12);
    }
}

#[test]
fn closed_finger_within_a_lidless_box_stays_out_of_its_floor() {
    let finger = moved(&sphere(1.0, 16, 28), |p| {
        v(12.0 * p.x, 3.0 * p.y, 3.0 * p.z + 3.4)
    });
    for gap in press(&lidless(), &finger).iter().flatten() {
        assert!(gap.distance > 0.0, "{gap:?}");
    }
}

/// Postures of a tip that wanders about the origin, at times by leaps, and of which now one half moves and now the other.
fn wandering(frames: usize, seed: u64) -> Vec<Mesh> {
    let mut random = Random(seed);
    let mut skin = moved(&tip(3.0), |p| p + v(0.0, 0.0, 1.0));
    let frame = |k: usize| {
        let by = random.within(if k % 8 == 7 { 12.0 } else { 0.8 });
        let middle = skin.positions()[0].x;
        let shrink = 0.02 * random.next();
        skin = moved(&skin, |p| match k % 3 {
            0 => p + by,
            1 if p.x < middle => p + by * 0.3,
            2 if p.x > middle => p - p * shrink,
            _ => p,
        });
        skin.clone()
    };
    (0..frames).map(frame).collect()
}

#[test]
fn readings_kept_from_posture_to_posture_are_those_of_all_skin_bit_for_bit() {
    let standing = |cup: Product| Product::new(moved(cup.mesh(), |p| p - v(30., 0., 30.))).unwrap();
    let products = [
        plate(8.0),
        plate(1.0),
        standing(cup(true)),
        standing(cup(false)),
        lidless(),
    ];
    let mut through = 0;
    for (seed, product) in (1..).zip(&products) {
        for cut_off_mm in [1.5, 8.0, f64::INFINITY] {
            let limits = GapLimits {
                cut_off_mm,
                ..LIMITS
            };
            let mut readings = Readings::default();
            for (frame, skin) in wandering(32, seed).iter().enumerate() {
                let (normals, adjacency) = (vertex_normals(skin), Adjacency::new(skin));
                let posed = posed(skin, &normals, &adjacency);
                let kept = product.gaps_after(&mut readings, &posed, limits);
                let fresh = product.gaps_of_skin(&posed, limits);
                assert_eq!(*kept, fresh, "product {seed}, frame {frame}, {cut_off_mm}");
                let distance = |g: &Option<Gap>| g.map_or(f64::INFINITY, |g| g.distance);
                let distances: Vec<f64> = fresh.iter().map(distance).collect();
                assert_eq!(readings.distances(), distances, "{seed}, {frame}");
                let plain = |p: &Vec3| product.gap(*p, None, limits);
                let pairs = kept.iter().zip(skin.positions().iter().map(plain));
                let is_through = |pair: &(&Option<Gap>, Option<Gap>)| {
                    let sign = |g: &Option<Gap>| g.map(|g| g.distance < 0.0);
                    sign(pair.0) != sign(&pair.1)
                };
                through += pairs.filter(is_through).count();
            }
        }
    }
    assert!(
        through > 100,
        "{through} are through a wall: too few to tell"
    );
}
