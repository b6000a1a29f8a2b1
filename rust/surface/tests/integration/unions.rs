//! Solids made of blocks, with walls inside, butted, overlapping, welded or not: distances are those to the boundary of their union.

use crate::shapes;

use shapes::{Random, cuboid, moved, together, v};
use thenar_surface::{Gap, GapLimits, Mesh, Product, Vec3};

const FULL: GapLimits = GapLimits {
    cut_off_mm: f64::INFINITY,
    max_depth_mm: 100.0,
};

/// Cells of a lattice with uneven planes; all about the solid are empty.
struct Blocks {
    planes: [Vec<f64>; 3],
    is_solid: Vec<bool>,
}

const SIDE: usize = 6;

impl Blocks {
    fn random(random: &mut Random, share: f64) -> Blocks {
        let mut planes = || {
            let mut at = -6.0;
            let step = |_| {
                at += 1.0 + 2.5 * random.next();
                at
            };
            (0..=SIDE).map(step).collect::<Vec<f64>>()
        };
        let planes = [planes(), planes(), planes()];
        let is_inner = |c: [usize; 3]| c.iter().all(|k| (1..SIDE - 1).contains(k));
        let is_solid = (0..SIDE * SIDE * SIDE)
            .map(|i| is_inner(cell(i)) && random.next() < share)
            .collect();
        Blocks { planes, is_solid }
    }

    fn solid(&self, c: [usize; 3]) -> bool {
        self.is_solid[index(c)]
    }

    fn bounds(&self, c: [usize; 3]) -> [Vec3; 2] {
        let at = |step: usize| {
            v(
                self.planes[0][c[0] + step],
                self.planes[1][c[1] + step],
                self.planes[2][c[2] + step],
            )
        };
        [at(0), at(1)]
    }

    /// Fills empty cells that no way over faces leads out of.
    fn filled(mut self) -> Blocks {
        let mut reached = vec![false; self.is_solid.len()];
        let mut pending = vec![0];
        reached[0] = true;
        while let Some(i) = pending.pop() {
            for next in neighbors(cell(i)) {
                if !reached[index(next)] && !self.solid(next) {
                    reached[index(next)] = true;
                    pending.push(index(next));
                }
            }
        }
        self.is_solid = reached.iter().map(|r| !r).collect();
        self
    }

    /// Signed distance: to the nearest solid cell from outside, to the nearest empty one or the far from inside.
    fn distance(&self, p: Vec3) -> f64 {
        let to_box = |c: [usize; 3]| {
            let [low, high] = self.bounds(c);
            (low - p).sup(&(p - high)).sup(&Vec3::zeros()).norm()
        };
        let nearest = |solid: bool| {
            let all = (0..self.is_solid.len())
                .map(cell)
                .filter(|c| self.solid(*c) == solid);
            all.map(to_box).fold(f64::INFINITY, f64::min)
        };
        let (solid, empty) = (nearest(true), nearest(false));
        if solid > 0.0 { solid } else { -empty }
    }

    fn point(&self, random: &mut Random) -> Vec3 {
        let mut axis = |k: usize| {
            let (low, high) = (self.planes[k][0], self.planes[k][SIDE]);
            match random.next() {
                // In a plane of the lattice, as skin in a joint is.
                chance if chance < 0.3 => self.planes[k][1 + (random.next() * 5.0) as usize],
                _ => low + (high - low) * random.next(),
            }
        };
        v(axis(0), axis(1), axis(2))
    }

    /// Every wall that has solid on a side once, with shared corners, turned and cut at random; inner walls by chance.
    fn walls(&self, random: &mut Random, inner: f64) -> Mesh {
        let mut triangles = Vec::new();
        let corner = |c: [usize; 3]| ((c[2] * (SIDE + 1) + c[1]) * (SIDE + 1) + c[0]) as u32;
        for c in (0..self.is_solid.len()).map(cell) {
            for axis in 0..3 {
                let mut next = c;
                next[axis] += 1;
                if next[axis] == SIDE {
                    continue;
                }
                let solid = [self.solid(c), self.solid(next)];
                if solid == [false, false] || (solid == [true, true] && random.next() > inner) {
                    continue;
                }
                let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                    let mut at = next;
                    at[(axis + 1) % 3] += a;
                    at[(axis + 2) % 3] += b;
                    corner(at)
                });
                let [a, b, c, d] = corners;
                let halves = if random.next() < 0.5 {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                };
                for [a, b, c] in halves {
                    triangles.push(if random.next() < 0.5 {
                        [a, b, c]
                    } else {
                        [a, c, b]
                    });
                }
            }
        }
        let side = SIDE + 1;
        let place = |i: usize| {
            v(
                self.planes[0][i % side],
                self.planes[1][i / side % side],
                self.planes[2][i / side / side],
            )
        };
        Mesh::new((0..side * side * side).map(place).collect(), triangles).unwrap()
    }

    /// Boxes that cover the solid cells: each cell by itself, or runs of cells that overlap.
    fn boxes(&self, random: &mut Random) -> Vec<Mesh> {
        let mut boxes = Vec::new();
        for c in (0..self.is_solid.len())
            .map(cell)
            .filter(|c| self.solid(*c))
        {
            let mut end = c;
            let axis = (random.next() * 3.0) as usize;
            while random.next() < 0.6 && end[axis] + 1 < SIDE {
                let mut next = end;
                next[axis] += 1;
                if !self.solid(next) {
                    break;
                }
                end = next;
            }
            boxes.push(cuboid(self.bounds(c)[0], self.bounds(end)[1]));
        }
        boxes
    }
}

fn cell(i: usize) -> [usize; 3] {
    [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE]
}

fn index(c: [usize; 3]) -> usize {
    (c[2] * SIDE + c[1]) * SIDE + c[0]
}

fn neighbors(c: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..3).flat_map(move |axis| {
        [c[axis].checked_sub(1), Some(c[axis] + 1)]
            .into_iter()
            .flatten()
            .filter(|k| *k < SIDE)
            .map(move |k| {
                let mut next = c;
                next[axis] = k;
                next
            })
    })
}

/// A rotation by a random angle about a random axis, or none.
fn turn(random: &mut Random) -> impl Fn(Vec3) -> Vec3 + Copy + use<> {
    let (axis, angle) = (
        random.direction(),
        if random.next() < 0.3 {
            0.0
        } else {
            3.0 * random.next()
        },
    );
    move |p: Vec3| {
        p * angle.cos() + axis.cross(&p) * angle.sin() + axis * axis.dot(&p) * (1.0 - angle.cos())
    }
}

fn soup(mesh: &Mesh) -> Mesh {
    let corners = (0..mesh.triangles().len()).flat_map(|t| mesh.corners(t));
    let triangles = (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    Mesh::new(corners.collect(), triangles.collect()).unwrap()
}

/// The signed distances of random points are those of the blocks, and the closest points lie on their boundary.
fn compare(blocks: &Blocks, mesh: &Mesh, random: &mut Random, slack: f64) {
    let turn = turn(random);
    let product = Product::new(moved(mesh, turn)).unwrap();
    for _ in 0..28 {
        let p = blocks.point(random);
        let right = blocks.distance(p);
        let found: Gap = product.gap(turn(p), None, FULL).unwrap();
        assert!(
            (found.distance - right).abs() < slack,
            "at {p:?}: {} instead of {right}; {:?}",
            found.distance,
            product.warnings()
        );
        if right < -slack {
            // With the skin's normal toward the way out, the same.
            let skin = -found.normal;
            let facing = product.gap(turn(p), Some(skin), FULL).unwrap();
            assert!(
                (facing.distance - right).abs() < slack,
                "{} instead of {right}",
                facing.distance
            );
        }
        let to = found
            .barycentric
            .iter()
            .zip(product.mesh().corners(found.triangle as usize));
        let named: Vec3 = to.map(|(w, corner)| corner * *w).sum();
        assert!((named - found.closest).norm() < slack);
    }
}

#[test]
fn walls_within_welded_solids_are_no_boundary() {
    let mut random = Random(11);
    for k in 0..42 {
        let blocks = Blocks::random(&mut random, 0.3 + 0.6 * random_share(k)).filled();
        if !blocks.is_solid.contains(&true) {
            continue;
        }
        let inner = random.next();
        let mesh = blocks.walls(&mut random, inner);
        compare(&blocks, &mesh, &mut random, 1e-9);
        compare(&blocks, &soup(&mesh), &mut random, 1e-9);
    }
}

fn random_share(k: usize) -> f64 {
    (k % 7) as f64 / 7.0
}

#[test]
fn butted_and_overlapping_blocks_are_one_solid() {
    let mut random = Random(12);
    for k in 0..42 {
        let blocks = Blocks::random(&mut random, 0.2 + 0.6 * random_share(k));
        let boxes = blocks.boxes(&mut random);
        if !boxes.is_empty() {
            compare(&blocks, &together(&boxes), &mut random, 1e-9);
        }
    }
}

#[test]
fn blocks_that_miss_each_other_by_rounding_are_butted() {
    let mut random = Random(13);
    for k in 0..28 {
        let blocks = Blocks::random(&mut random, 0.2 + 0.6 * random_share(k));
        let boxes = blocks.boxes(&mut random);
        let shaken: Vec<Mesh> = boxes
            .iter()
            .map(|b| {
                let off = random.within(2e-5);
                moved(b, |p| p + off)
            })
            .collect();
        if !shaken.is_empty() {
            compare(&blocks, &together(&shaken), &mut random, 2e-3);
        }
    }
}

#[test]
fn loose_faces_within_a_solid_are_no_boundary() {
    let mut random = Random(14);
    for k in 0..28 {
        let blocks = Blocks::random(&mut random, 0.3 + 0.6 * random_share(k));
        let mut parts = blocks.boxes(&mut random);
        for c in (0..blocks.is_solid.len())
            .map(cell)
            .filter(|c| blocks.solid(*c))
        {
            let [low, high] = blocks.bounds(c);
            let mut inside =
                || low + (high - low).component_mul(&(random.within(0.45) + Vec3::repeat(0.5)));
            let corners = vec![inside(), inside(), inside()];
            parts.push(Mesh::new(corners, vec![[0, 1, 2]]).unwrap());
        }
        if !parts.is_empty() {
            compare(&blocks, &together(&parts), &mut random, 1e-9);
        }
    }
}

#[test]
fn turned_boxes_that_overlap_are_one_solid() {
    let mut random = Random(15);
    for _ in 0..28 {
        let placed = |_| {
            let (turn, put) = (turn(&mut random), random.within(3.0));
            let half = Vec3::repeat(1.5) + random.within(1.0);
            moved(&cuboid(-half, half), |p| turn(p) + put)
        };
        let meshes: Vec<Mesh> = (0..4).map(placed).collect();
        let product = Product::new(together(&meshes)).unwrap();
        // By the planes of the boxes' first triangles: two to a face.
        let planes: Vec<Vec<(Vec3, f64)>> = meshes
            .iter()
            .map(|m| {
                let plane = |t: usize| {
                    let [a, b, c] = m.corners(t);
                    let n = (b - a).cross(&(c - a)).normalize();
                    (n, n.dot(&a))
                };
                (0..12).step_by(2).map(plane).collect()
            })
            .collect();
        let beyond = |p: Vec3| {
            let of = |planes: &Vec<(Vec3, f64)>| {
                planes
                    .iter()
                    .map(|(n, d)| n.dot(&p) - d)
                    .fold(f64::MIN, f64::max)
            };
            planes.iter().map(of).fold(f64::INFINITY, f64::min)
        };
        for _ in 0..28 {
            let p = random.within(6.0);
            let found = product.gap(p, None, FULL).unwrap();
            assert_eq!(found.distance < 0.0, beyond(p) < 0.0, "{p:?} {found:?}");
            assert!(beyond(found.closest).abs() < 1e-9, "{found:?}");
            // Nothing of the other side is nearer.
            for _ in 0..40 {
                let near =
                    p + random.direction() * (found.distance.abs() - 1e-6) * random.next().cbrt();
                assert_eq!(
                    beyond(near) < 0.0,
                    found.distance < 0.0,
                    "{near:?} is nearer to {p:?} than {found:?}"
                );
            }
        }
    }
}

#[test]
fn normal_at_the_edge_where_two_parts_meet_points_the_shortest_way_out() {
    // An L of two boxes that overlap: within its corner the edge at x = y = 0 is nearest, whose place lies amid faces of both.
    let foot = cuboid(Vec3::new(-10.0, -10.0, -10.0), Vec3::new(10.0, 0.0, 10.0));
    let back = cuboid(Vec3::new(-10.0, -5.0, -10.0), Vec3::new(0.0, 10.0, 10.0));
    let corner = Product::new(together(&[foot, back])).unwrap();
    for (x, y, z) in [(1.0, 2.0, 0.3), (2.0, 0.5, -4.0), (1.5, 1.5, 3.0)] {
        let gap = corner.gap(Vec3::new(-x, -y, z), None, FULL).unwrap();
        assert!((gap.distance + x.hypot(y)).abs() < 1e-9, "{gap:?}");
        assert!(
            (gap.normal - Vec3::new(x, y, 0.0).normalize()).norm() < 1e-9,
            "{gap:?}"
        );
    }
}
