//! Mesh refinement of the skin near first touch.
//!
//! A contact that reaches over few vertices answers in steps, as one after the other comes to bear: on the skins of
//! `tests/trial` force over depth wavers by 2 to 10 % about what finite elements give, where the contact is two to four edges
//! wide. Triangles are halved across their longest edges (Rivara 1984), which keeps the mesh whole and no angle below half of the
//! smallest that it had; new vertices lie on the cubic that leaves both ends of their edge along the skin.

use crate::forward::mesh::replay::Replay;
use std::collections::HashMap;

use nalgebra::Vector3;
use thenar_recordings::Study;
use thenar_recordings::study::{Shape, StudySkin};

/// Longest edge over the distance from first touch.
const GRADE: f64 = 0.35;
/// Part of a recording's depth at which the contact is to be as finely divided as at full depth.
const EARLY: f64 = 0.1;
/// Most vertices that are added.
const MOST: usize = 12_000;
/// Largest height of a new vertex over its edge, as a part of the edge: beyond it there is a crease, not a curve.
const LIFT: f64 = 0.1;

/// First touch of a tool, and the radius about it within which triangles are all as small, mm.
struct Touch {
    at: Vector3<f64>,
    core: f64,
}

/// The study with a finer skin; None where it is fine enough.
pub fn refined(study: &Study, replay: &Replay) -> Option<Study> {
    let touches = touches(study, replay);
    let skin = finer(&study.skin, &touches)?;
    Some(Study {
        skin,
        ..study.clone()
    })
}

fn touches(study: &Study, replay: &Replay) -> Vec<Touch> {
    let of = |(r, recording): (usize, &thenar_recordings::study::StudyRecording)| {
        let site = study.sites.iter().find(|s| s.name == recording.site)?;
        let tool = study
            .indenters
            .iter()
            .find(|i| i.name == recording.indenter)?;
        let core = match &tool.shape {
            Shape::Sphere { radius_mm } | Shape::Cylinder { radius_mm, .. } => {
                (EARLY * radius_mm * replay.deepest(r)).sqrt()
            }
            Shape::Punch { radius_mm } => *radius_mm,
            _ => return None,
        };
        let at = site.point_mm.into();
        (core > 0.0).then_some(Touch { at, core })
    };
    study.recordings.iter().enumerate().filter_map(of).collect()
}

/// A skin with triangles no larger than first touch asks for.
fn finer(skin: &StudySkin, touches: &[Touch]) -> Option<StudySkin> {
    let mut mesh = Halving::new(skin)?;
    let mut waiting: Vec<usize> = (0..mesh.triangles.len()).collect();
    while let Some(triangle) = waiting.pop() {
        let most = mesh.positions.len() - skin.mesh.positions.len() >= MOST;
        if most || !mesh.is_coarse(triangle, touches) {
            continue;
        }
        waiting.push(triangle);
        mesh.halve(triangle, &mut waiting);
    }
    let has_more = mesh.positions.len() > skin.mesh.positions.len();
    has_more.then(|| {
        let mut finer = skin.clone();
        finer.mesh.positions = mesh.positions;
        finer.mesh.triangles = mesh.triangles;
        finer.regions = mesh.regions;
        finer
    })
}

/// A mesh whose triangles are halved one by one.
struct Halving {
    positions: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    regions: Vec<i32>,
    triangles: Vec<[u32; 3]>,
    /// Triangle to the left of each directed edge.
    left: HashMap<(u32, u32), usize>,
}

impl Halving {
    /// None for a mesh two of whose triangles share a directed edge: it cannot be halved and stay whole.
    fn new(skin: &StudySkin) -> Option<Halving> {
        let (positions, triangles) = (skin.mesh.positions.clone(), skin.mesh.triangles.clone());
        let mut left = HashMap::with_capacity(3 * triangles.len());
        let mut normals = vec![Vector3::zeros(); positions.len()];
        for (number, [a, b, c]) in triangles.iter().enumerate() {
            let at = |k: &u32| positions[*k as usize];
            let across = (at(b) - at(a)).cross(&(at(c) - at(a)));
            for k in [a, b, c] {
                normals[*k as usize] += across;
            }
            for edge in [(*a, *b), (*b, *c), (*c, *a)] {
                if left.insert(edge, number).is_some() {
                    return None;
                }
            }
        }
        for normal in &mut normals {
            *normal = normal
                .try_normalize(f64::MIN_POSITIVE)
                .unwrap_or_else(Vector3::zeros);
        }
        Some(Halving {
            positions,
            normals,
            regions: skin.regions.clone(),
            triangles,
            left,
        })
    }

    fn edges(&self, triangle: usize) -> [(u32, u32); 3] {
        let [a, b, c] = self.triangles[triangle];
        [(a, b), (b, c), (c, a)]
    }

    fn length(&self, (a, b): (u32, u32)) -> f64 {
        (self.positions[a as usize] - self.positions[b as usize]).norm()
    }

    /// The longest edge; of edges alike, the one of the smallest numbers, so that both its triangles choose the same.
    fn longest(&self, triangle: usize) -> (u32, u32) {
        let rank = |e: (u32, u32)| {
            (
                self.length((e.0.min(e.1), e.0.max(e.1))),
                e.0.min(e.1),
                e.0.max(e.1),
            )
        };
        let mut edges = self.edges(triangle);
        edges.sort_by(|a, b| {
            let (a, b) = (rank(*a), rank(*b));
            b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2))
        });
        edges[0]
    }

    fn is_coarse(&self, triangle: usize, touches: &[Touch]) -> bool {
        let [a, b, c] = self.triangles[triangle].map(|k| self.positions[k as usize]);
        let middle = (a + b + c) / 3.0;
        let longest = self.length(self.longest(triangle));
        touches.iter().any(|touch| {
            // The edge's own half may reach nearer than the middle does.
            let away = ((middle - touch.at).norm() - 0.5 * longest).max(touch.core);
            longest > GRADE * away
        })
    }

    /// Halves a triangle, or first that neighbor whose longest edge keeps it from being halved; what is new or changed waits.
    fn halve(&mut self, triangle: usize, waiting: &mut Vec<usize>) {
        let mut triangle = triangle;
        // Along the way to the neighbor across the longest edge, edges only grow, so that it ends.
        let (edge, across) = loop {
            let (a, b) = self.longest(triangle);
            let across = self.left.get(&(b, a)).copied();
            match across {
                Some(next) if self.longest(next) != (b, a) => triangle = next,
                _ => break ((a, b), across),
            }
        };
        let middle = self.middle(edge);
        waiting.push(self.split(triangle, edge, middle));
        if let Some(other) = across {
            waiting.push(self.split(other, (edge.1, edge.0), middle));
            waiting.push(other);
        }
        waiting.push(triangle);
    }

    /// Adds the vertex that halves an edge.
    fn middle(&mut self, (a, b): (u32, u32)) -> u32 {
        let (i, j) = (a as usize, b as usize);
        let along = self.positions[j] - self.positions[i];
        let mut lift = (self.normals[j] * along.dot(&self.normals[j])
            - self.normals[i] * along.dot(&self.normals[i]))
            / 8.0;
        let most = LIFT * along.norm();
        if lift.norm() > most {
            lift = Vector3::zeros();
        }
        self.positions
            .push((self.positions[i] + self.positions[j]) * 0.5 + lift);
        let normal = self.normals[i] + self.normals[j];
        self.normals.push(
            normal
                .try_normalize(f64::MIN_POSITIVE)
                .unwrap_or_else(Vector3::zeros),
        );
        if !self.regions.is_empty() {
            // A vertex that is no skin would make a hole of what is half skin.
            self.regions.push(self.regions[i].max(self.regions[j]));
        }
        self.positions.len() as u32 - 1
    }

    /// Makes two of the triangle to the left of `edge`; returns the new one.
    fn split(&mut self, triangle: usize, (a, b): (u32, u32), middle: u32) -> usize {
        let corners = self.triangles[triangle];
        let top = corners
            .into_iter()
            .find(|k| *k != a && *k != b)
            .unwrap_or(a);
        let new = self.triangles.len();
        self.triangles[triangle] = [a, middle, top];
        self.triangles.push([middle, b, top]);
        self.left.remove(&(a, b));
        for (edge, of) in [
            ((a, middle), triangle),
            ((middle, top), triangle),
            ((middle, b), new),
            ((b, top), new),
            ((top, middle), new),
        ] {
            self.left.insert(edge, of);
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit sphere from an octahedron that was divided evenly, as a hand's skin is curved.
    fn ball() -> StudySkin {
        let mut skin = StudySkin::default();
        skin.mesh.positions = vec![
            Vector3::x(),
            Vector3::y(),
            Vector3::z(),
            -Vector3::x(),
            -Vector3::y(),
            -Vector3::z(),
        ];
        for (a, b) in [(0, 1), (1, 3), (3, 4), (4, 0)] {
            skin.mesh.triangles.push([a, b, 2]);
            skin.mesh.triangles.push([b, a, 5]);
        }
        for _ in 0..4 {
            let mut mesh = Halving::new(&skin).unwrap();
            for triangle in 0..mesh.triangles.len() {
                mesh.halve(triangle, &mut Vec::new());
            }
            for position in &mut mesh.positions {
                *position = position.normalize();
            }
            skin.mesh.positions = mesh.positions;
            skin.mesh.triangles = mesh.triangles;
        }
        skin
    }

    fn smallest_angle(mesh: &StudySkin) -> f64 {
        let mut least = f64::INFINITY;
        for t in &mesh.mesh.triangles {
            for k in 0..3 {
                let at = |j: usize| mesh.mesh.positions[t[(k + j) % 3] as usize];
                least = least.min((at(1) - at(0)).angle(&(at(2) - at(0))));
            }
        }
        least
    }

    #[test]
    fn a_ball_stays_closed_and_round_and_is_fine_where_it_is_touched() {
        let skin = ball();
        let touch = Touch {
            at: Vector3::z(),
            core: 0.05,
        };
        let fine = finer(&skin, std::slice::from_ref(&touch)).unwrap();
        let mesh = Halving::new(&fine).unwrap();
        for (a, b) in mesh.left.keys() {
            assert!(mesh.left.contains_key(&(*b, *a)), "a hole at {a} {b}");
        }
        let vertices = mesh.positions.len() as i64;
        let (edges, faces) = (mesh.left.len() as i64 / 2, mesh.triangles.len() as i64);
        assert_eq!(vertices - edges + faces, 2, "a sphere's Euler number");
        assert!(
            (0..mesh.triangles.len()).all(|t| !mesh.is_coarse(t, std::slice::from_ref(&touch)))
        );
        assert!(smallest_angle(&fine) > 0.45 * smallest_angle(&skin));
        let near = |p: &Vector3<f64>| (p - touch.at).norm() < 0.3;
        let worst = |points: &[Vector3<f64>]| {
            let off = points
                .iter()
                .filter(|p| near(p))
                .map(|p| (p.norm() - 1.0).abs());
            off.fold(0.0, f64::max)
        };
        let coarse = Halving::new(&skin).unwrap();
        let chords = coarse
            .left
            .keys()
            .map(|(a, b)| (coarse.positions[*a as usize] + coarse.positions[*b as usize]) * 0.5);
        let straight = worst(&chords.collect::<Vec<_>>());
        let round = worst(&mesh.positions);
        assert!(
            straight > 0.01 && round < 0.5 * straight,
            "{round} {straight}"
        );
    }

    #[test]
    fn a_vertex_between_skin_and_none_is_skin() {
        let mut skin = ball();
        let (a, b) = (skin.mesh.triangles[0][0], skin.mesh.triangles[0][1]);
        for [first, second] in [[-1, 2], [2, -1]] {
            skin.regions = vec![2; skin.mesh.positions.len()];
            (skin.regions[a as usize], skin.regions[b as usize]) = (first, second);
            let mut mesh = Halving::new(&skin).unwrap();
            let middle = mesh.middle((a, b));
            assert_eq!(
                mesh.regions[middle as usize], 2,
                "else a hole of what is half skin"
            );
        }
    }

    #[test]
    fn regions_go_on_and_a_fine_skin_is_left_alone() {
        let mut skin = ball();
        skin.regions = skin
            .mesh
            .positions
            .iter()
            .map(|p| if p.x < 0.0 { -1 } else { 3 })
            .collect();
        let touch = |core| Touch {
            at: Vector3::x(),
            core,
        };
        let fine = finer(&skin, &[touch(0.1)]).unwrap();
        assert_eq!(fine.regions.len(), fine.mesh.positions.len());
        for (p, region) in fine.mesh.positions.iter().zip(&fine.regions) {
            let wanted = if p.x < 0.0 { -1 } else { 3 };
            assert!(*region == wanted || p.x.abs() < 0.3, "{p:?} {region}");
        }
        assert!(finer(&skin, &[touch(50.0)]).is_none());
        assert!(finer(&skin, &[]).is_none());
    }
}
