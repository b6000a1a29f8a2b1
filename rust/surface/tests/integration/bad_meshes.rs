//! Meshes as they come: every defect gives a clear error or a sound answer.

use crate::shapes;

use shapes::{Random, cuboid, inside_out, moved, sphere, together, v};
use thenar_surface::{
    Adjacency, GapLimits, Mesh, MeshError, Product, SkinDistance, Vec3, connected_parts,
    median_edge_length, self_intersections, vertex_areas, vertex_normals,
};

const FULL: GapLimits = GapLimits {
    cut_off_mm: f64::INFINITY,
    max_depth_mm: 15.0,
};

fn unit() -> Mesh {
    cuboid(v(0., 0., 0.), v(1., 1., 1.))
}

fn depth(product: &Product, p: Vec3) -> f64 {
    product.gap(p, None, FULL).unwrap().distance
}

/// The unit box with triangles added or left out.
fn changed(add: &[[u32; 3]], leave: usize) -> Mesh {
    let mut t = unit().triangles().to_vec();
    t.truncate(t.len() - leave);
    t.extend_from_slice(add);
    Mesh::new(unit().positions().to_vec(), t).unwrap()
}

#[test]
fn input_that_is_no_mesh_is_refused_by_name() {
    let p = || vec![v(0., 0., 0.), v(1., 0., 0.), v(0., 1., 0.)];
    assert_eq!(
        Mesh::new(vec![], vec![[0, 1, 2]]),
        Err(MeshError::NoVertices)
    );
    assert_eq!(
        Mesh::new(vec![v(0., 0., 0.)], vec![]),
        Err(MeshError::NoTriangles)
    );
    assert_eq!(
        Mesh::new(p(), vec![[0, 1, 3]]),
        Err(MeshError::TriangleOutOfRange {
            triangle: 0,
            index: 3,
            vertices: 3
        })
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut q = p();
        q[1].z = bad;
        assert_eq!(
            Mesh::new(q, vec![[0, 1, 2]]),
            Err(MeshError::NonFinite { vertex: 1 })
        );
    }
    let mut q = p();
    q[2].x = 1e13;
    assert_eq!(
        Mesh::new(q, vec![[0, 1, 2]]),
        Err(MeshError::TooFar { vertex: 2 })
    );
    let flat = Mesh::new(
        vec![v(0., 0., 0.), v(1., 0., 0.), v(2., 0., 0.)],
        vec![[0, 1, 2], [1, 1, 1]],
    )
    .unwrap();
    assert_eq!(
        Product::new(flat).unwrap_err(),
        MeshError::AllDegenerate { triangles: 2 }
    );
    let short = unit().with_positions(p());
    assert_eq!(
        short,
        Err(MeshError::LengthMismatch {
            what: "positions",
            expected: 8,
            found: 3
        })
    );
}

#[test]
fn audit_counts_each_defect() {
    let sound = unit().audit();
    assert!(
        sound.is_closed()
            && !sound.is_inside_out()
            && sound.parts == 1
            && sound.warnings("it").is_empty()
    );
    assert!((sound.signed_volume_mm3 - 1.0).abs() < 1e-12);
    assert!(inside_out(&unit()).audit().is_inside_out());
    assert_eq!(
        changed(&[[0, 0, 1], [2, 2, 2]], 0)
            .audit()
            .degenerate_triangles,
        2
    );
    assert_eq!(
        changed(&[unit().triangles()[3]], 0)
            .audit()
            .duplicate_triangles,
        1
    );
    let open = changed(&[], 1).audit();
    assert!(open.boundary_edges == 3 && !open.is_closed());
    // One of its edges is a diagonal of the box, so two get a third triangle.
    let fin = changed(&[[0, 1, 7]], 0).audit();
    assert_eq!((fin.non_manifold_edges, fin.boundary_edges), (2, 1));
    let mut t = unit().triangles().to_vec();
    t[5].swap(0, 1);
    let turned = Mesh::new(unit().positions().to_vec(), t).unwrap();
    assert_eq!(turned.audit().inconsistent_edges, 3);
    let mut p = unit().positions().to_vec();
    p.push(v(9., 9., 9.));
    let loose = Mesh::new(p, unit().triangles().to_vec()).unwrap();
    assert_eq!(
        (loose.audit().isolated_vertices, loose.audit().parts),
        (1, 1)
    );
    assert_eq!(connected_parts(&loose).1, 2);
    assert_eq!(
        loose.audit().warnings("the hand"),
        ["the hand has 1 vertices without a triangle"]
    );
}

#[test]
fn defects_do_not_change_the_distance() {
    let mut p = unit().positions().to_vec();
    p.extend([v(0.5, 0.0, 0.0), v(7., 7., 7.)]);
    let mut t = unit().triangles().to_vec();
    // A sliver along an edge, a collapsed triangle, a copy turned round.
    t.extend([[0, 8, 1], [3, 3, 4], [t[0][0], t[0][2], t[0][1]]]);
    t[7].swap(1, 2);
    let messy = Product::new(Mesh::new(p, t).unwrap()).unwrap();
    let sound = Product::new(unit()).unwrap();
    let mut random = Random(5);
    for _ in 0..5_000 {
        let q = random.within(1.5) + v(0.5, 0.5, 0.5);
        assert_eq!(depth(&messy, q), depth(&sound, q));
    }
    assert_eq!(messy.warnings().len(), 6, "{:?}", messy.warnings());
}

#[test]
fn split_corners_are_welded() {
    let m = unit();
    let p: Vec<Vec3> = (0..12).flat_map(|t| m.corners(t)).collect();
    let soup = Product::new(
        Mesh::new(p, (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap(),
    )
    .unwrap();
    assert!(
        soup.is_closed() && soup.warnings().is_empty(),
        "{:?}",
        soup.warnings()
    );
    assert_eq!(
        depth(&soup, v(0.5, 0.5, 0.9)),
        depth(&Product::new(m).unwrap(), v(0.5, 0.5, 0.9))
    );
}

#[test]
fn product_with_a_hole_or_a_fin_keeps_its_inside() {
    let ball = sphere(10.0, 24, 40);
    let mut t = ball.triangles().to_vec();
    t.remove(100);
    let holed = Product::new(Mesh::new(ball.positions().to_vec(), t.clone()).unwrap()).unwrap();
    t.push([0, 5, 300]);
    let finned = Product::new(Mesh::new(ball.positions().to_vec(), t).unwrap()).unwrap();
    let whole = Product::new(ball.clone()).unwrap();
    assert!(!holed.is_closed());
    let mut random = Random(6);
    let missing = ball.corners(100)[0];
    for _ in 0..3_000 {
        let q = random.within(14.0);
        if (q - missing).norm() > 4.0 {
            assert_eq!(depth(&holed, q).signum(), depth(&whole, q).signum());
            let limits = GapLimits {
                cut_off_mm: 1.0,
                max_depth_mm: 15.0,
            };
            let cut = holed.gap(q, None, limits);
            assert_eq!(cut.is_none(), depth(&holed, q) > 1.0, "{q:?} {cut:?}");
        }
        assert!((depth(&finned, q) < 0.0) <= (q.norm() < 10.0));
    }
}

#[test]
fn parts_overlap_nest_and_turn() {
    let big = cuboid(v(-5., -5., -5.), v(5., 5., 5.));
    let bar = cuboid(v(4., -1., -1.), v(12., 1., 1.));
    let cavity = inside_out(&cuboid(v(-2., -2., -2.), v(2., 2., 2.)));
    let joined = Product::new(together(&[big.clone(), bar.clone()])).unwrap();
    // 4.5 is within both; the bar's end cap at 4 is nearest and has its back there.
    assert!(
        depth(&joined, v(3.9, 0., 0.)) < 0.0
            && depth(&joined, v(4.5, 0., 0.)) < 0.0
            && depth(&joined, v(11., 0., 0.)) < 0.0
    );
    assert!(depth(&joined, v(6., 2., 0.)) > 0.0);
    // The bar's end within the box is no way out.
    assert!((depth(&joined, v(3.9, 0., 3.0)) + 1.1).abs() < 1e-12);
    assert!(depth(&joined, v(3.9, 0., 0.)) < -1.4);
    let hollow = Product::new(together(&[big.clone(), cavity.clone()])).unwrap();
    assert!(
        hollow.warnings().is_empty()
            && depth(&hollow, v(0., 0., 0.)) > 0.0
            && depth(&hollow, v(3., 0., 0.)) < 0.0
    );
    let turned = Product::new(inside_out(&together(&[
        big.clone(),
        cavity,
        moved(&big, |p| p + v(20., 0., 0.)),
    ])))
    .unwrap();
    assert!(
        depth(&turned, v(0., 0., 0.)) > 0.0
            && depth(&turned, v(3., 0., 0.)) < 0.0
            && depth(&turned, v(20., 0., 0.)) < 0.0
    );
    let one = Product::new(together(&[
        big.clone(),
        inside_out(&moved(&big, |p| p + v(20., 0., 0.))),
    ]))
    .unwrap();
    assert!(
        depth(&one, v(0., 0., 0.)) < 0.0
            && depth(&one, v(20., 0., 0.)) < 0.0
            && one.warnings().len() == 1
    );
}

#[test]
fn crossing_triangles_are_counted() {
    assert_eq!(self_intersections(&sphere(5.0, 12, 16)), 0);
    let crossing = together(&[
        cuboid(v(-5., -5., -5.), v(5., 5., 5.)),
        cuboid(v(4., -1., -1.), v(12., 1.5, 1.)),
    ]);
    // The bar passes its 8 side triangles through the 2 triangles of one face.
    assert_eq!(self_intersections(&crossing), 10);
    let single = vec![
        v(0., 0., 0.),
        v(4., 0., 0.),
        v(0., 4., 0.),
        v(1., 1., -1.),
        v(1., 1., 1.),
        v(9., 9., 1.),
    ];
    assert_eq!(
        self_intersections(&Mesh::new(single, vec![[0, 1, 2], [3, 4, 5]]).unwrap()),
        2
    );
}

#[test]
fn one_triangle_and_loose_vertices_give_derived_data() {
    let mesh = Mesh::new(
        vec![v(0., 0., 0.), v(3., 0., 0.), v(0., 4., 0.), v(9., 9., 9.)],
        vec![[0, 1, 2], [0, 1, 2], [0, 0, 3]],
    )
    .unwrap();
    assert_eq!(
        vertex_normals(&mesh),
        vec![v(0., 0., 1.), v(0., 0., 1.), v(0., 0., 1.), Vec3::zeros()]
    );
    assert_eq!(vertex_areas(&mesh), vec![2.0, 2.0, 2.0, 0.0]);
    assert_eq!(mesh.edges(), vec![[0, 1], [0, 2], [0, 3], [1, 2]]);
    assert_eq!(Adjacency::new(&mesh).neighbors(0), &[1, 2, 3]);
    assert!((median_edge_length(&mesh) - 5.0).abs() < 1e-12);
    assert_eq!(
        SkinDistance::new(&mesh, &Adjacency::new(&mesh), 10.0).patch_of(0),
        0
    );
}

#[test]
fn points_and_limits_that_are_no_numbers_find_nothing() {
    let product = Product::new(unit()).unwrap();
    let points = [
        v(f64::NAN, 0., 0.),
        v(0., f64::INFINITY, 0.),
        v(1e300, 0., 0.),
        v(0.5, 0.5, 0.6),
    ];
    let normals = [
        Vec3::zeros(),
        v(f64::NAN, 0., 0.),
        v(1., 0., 0.),
        v(f64::NAN, 0., 0.),
    ];
    let gaps = product.gaps(&points, Some(&normals), FULL);
    assert!(
        gaps[..3].iter().all(Option::is_none) && (gaps[3].unwrap().distance + 0.4).abs() < 1e-12
    );
    assert!(product.gaps(&points, Some(&normals[..2]), FULL)[3].is_some());
    let none = GapLimits {
        cut_off_mm: f64::NAN,
        max_depth_mm: -1.0,
    };
    assert_eq!(product.gap(v(2., 0.5, 0.5), None, none), None);
    assert!(
        product
            .gap(v(0.5, 0.5, 0.6), Some(v(0., 0., 1.)), none)
            .unwrap()
            .distance
            < 0.0
    );
}
