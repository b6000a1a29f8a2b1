//! Energy, force and stiffness of a group of prisms at finite strain.
//!
//! `W = mu / (2 b) (exp(b (J^(-2/3) I1 - 3)) - 1) + K / 2 (Jm - 1)^2`, neo-Hookean where b is 0 (Demiray 1972; Fung); `Jm` is the mean dilatation
//! of the group, so that nearly incompressible tissue does not lock (Nagtegaal, Parks and Rice 1974).

use crate::matrix3::{Matrix3, cofactors};
use crate::prisms::{GROUP_NODES, Group, NODES, POINTS, Prism, PrismMesh};
use crate::strain_energy::Point;

/// Unknowns of a group.
pub const UNKNOWNS: usize = 3 * GROUP_NODES;
/// Unknowns of a prism.
const OF_PRISM: usize = 3 * NODES;
/// Share of its volume below which a point of a prism counts as folded.
const LEAST_VOLUME: f64 = 0.02;

/// Force on the nodes and, where asked for, stiffness of a group.
#[derive(Debug, Clone)]
pub struct Element {
    /// Strain energy, N mm.
    pub energy: f64,
    /// Volume over the volume before.
    pub dilatation: f64,
    /// Derivative of the energy by the nodes' places, N.
    pub force: [f64; UNKNOWNS],
    /// Second derivative, N/mm; lower half.
    pub stiffness: [[f64; UNKNOWNS]; UNKNOWNS],
}

impl Default for Element {
    fn default() -> Element {
        Element {
            energy: 0.0,
            dilatation: 1.0,
            force: [0.0; UNKNOWNS],
            stiffness: [[0.0; UNKNOWNS]; UNKNOWNS],
        }
    }
}

/// A group and where its nodes lie.
#[derive(Debug, Clone, Copy)]
pub struct Placed<'a> {
    pub mesh: &'a PrismMesh,
    pub group: &'a Group,
    /// mm.
    pub places: &'a [[f64; 3]; GROUP_NODES],
}

/// Fills `element`. False where one of the group's prisms is folded.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn evaluate(
    placed: Placed<'_>,
    bulk_ratio: f64,
    with_stiffness: bool,
    element: &mut Element,
) -> bool {
    let Placed {
        mesh,
        group,
        places,
    } = placed;
    let members = std::iter::once(group.prisms.0).chain(group.prisms.1);
    let mut strains = [Strain::default(); 2];
    let (mut volume, mut volume_before, mut modulus) = (0.0, 0.0, 0.0);
    for ((index, local), strain) in members.clone().zip(&group.places).zip(&mut strains) {
        let prism = &mesh.prisms[index as usize];
        let corners = local.map(|k| places[k as usize]);
        let Some(found) = Strain::new(prism, &corners) else {
            return false;
        };
        volume += found.volume;
        volume_before += prism.volume;
        modulus += prism.volume * prism.shear_modulus;
        *strain = found;
    }
    let bulk = bulk_ratio * modulus / volume_before;
    let dilatation = volume / volume_before;
    let pressure = bulk * (dilatation - 1.0);
    element.force = [0.0; UNKNOWNS];
    if with_stiffness {
        element.stiffness = [[0.0; UNKNOWNS]; UNKNOWNS];
    }
    element.dilatation = dilatation;
    element.energy = 0.5 * bulk * (dilatation - 1.0).powi(2) * volume_before;
    let mut volume_force = [0.0; UNKNOWNS];
    for ((index, local), strain) in members.zip(&group.places).zip(&strains) {
        let prism = &mesh.prisms[index as usize];
        let unknown = |k: usize| 3 * local[k / 3] as usize + k % 3;
        let mut stiffness = [[0.0; OF_PRISM]; OF_PRISM];
        for g in 0..POINTS {
            let point = Point::new(
                &strain.gradients[g],
                strain.volumes[g],
                prism.shear_modulus,
                prism.stiffening,
            );
            let (weight, shape) = (prism.weights[g], &prism.gradients[g]);
            element.energy += weight * point.energy;
            for k in 0..OF_PRISM {
                let along =
                    |m: &Matrix3| (0..3).map(|j| m[k % 3][j] * shape[k / 3][j]).sum::<f64>();
                element.force[unknown(k)] += weight * along(&point.stress);
                volume_force[unknown(k)] += weight * along(&point.cofactor);
            }
            if with_stiffness {
                add_stiffness((&point, pressure), shape, weight, &mut stiffness);
            }
        }
        if with_stiffness {
            for a in 0..OF_PRISM {
                for b in 0..=a {
                    let (p, q) = (unknown(a), unknown(b));
                    element.stiffness[p.max(q)][p.min(q)] += stiffness[a][by_axis(b)];
                }
            }
        }
    }
    for a in 0..UNKNOWNS {
        element.force[a] += pressure * volume_force[a];
        if with_stiffness {
            for b in 0..=a {
                element.stiffness[a][b] += bulk / volume_before * volume_force[a] * volume_force[b];
            }
        }
    }
    true
}

/// Deformation of a prism at its points.
#[derive(Debug, Clone, Copy, Default)]
struct Strain {
    gradients: [Matrix3; POINTS],
    /// Volume over the volume before, of every point.
    volumes: [f64; POINTS],
    /// Of the prism, mm3.
    volume: f64,
}

impl Strain {
    /// `None` where the prism is folded.
    #[inline(always)]
    fn new(prism: &Prism, corners: &[[f64; 3]; NODES]) -> Option<Strain> {
        let mut strain = Strain::default();
        for g in 0..POINTS {
            let gradient = deformation(&prism.gradients[g], corners);
            let cofactor = cofactors(&gradient);
            let j = (0..3).map(|k| gradient[0][k] * cofactor[0][k]).sum::<f64>();
            if j < LEAST_VOLUME {
                return None;
            }
            (strain.gradients[g], strain.volumes[g]) = (gradient, j);
            strain.volume += j * prism.weights[g];
        }
        Some(strain)
    }
}

#[inline(always)]
fn deformation(shape: &[[f64; 3]; NODES], places: &[[f64; 3]; NODES]) -> Matrix3 {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..NODES).map(|a| places[a][i] * shape[a][j]).sum())
    })
}

/// Column of an unknown of a prism in its stiffness: all nodes of one axis follow each other, for loops over nodes that fill registers.
#[inline(always)]
fn by_axis(unknown: usize) -> usize {
    NODES * (unknown % 3) + unknown / 3
}

/// Adds the stiffness of one point under the group's pressure; rows by node, columns `by_axis`.
#[inline(always)]
fn add_stiffness(
    (point, pressure): (&Point, f64),
    shape: &[[f64; 3]; NODES],
    weight: f64,
    stiffness: &mut [[f64; OF_PRISM]; OF_PRISM],
) {
    let (f, t) = point.gradients();
    let of = |m: &Matrix3| -> [[f64; NODES]; 3] {
        std::array::from_fn(|i| {
            std::array::from_fn(|a| (0..3).map(|j| m[i][j] * shape[a][j]).sum())
        })
    };
    let (f, g) = (of(f), of(t));
    let [k1, k2, k3, k4, k5] = point.moduli(pressure).map(|k| weight * k);
    for a in 0..NODES {
        let along: [f64; NODES] =
            std::array::from_fn(|b| k5 * (0..3).map(|j| shape[a][j] * shape[b][j]).sum::<f64>());
        for i in 0..3 {
            let row = &mut stiffness[3 * a + i];
            let (u, v) = (k1 * f[i][a] + k2 * g[i][a], k2 * f[i][a] + k3 * g[i][a]);
            for k in 0..3 {
                let w = k4 * g[k][a];
                for b in 0..NODES {
                    row[NODES * k + b] += u * f[k][b] + v * g[k][b] + w * g[i][b];
                }
            }
            for b in 0..NODES {
                row[NODES * i + b] += along[b];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tissue;
    use crate::prisms::PrismMesh;
    use thenar_surface::Vec3;

    /// Two prisms with a common side.
    fn pair() -> PrismMesh {
        let skin = vec![
            Vec3::new(0.0, 0.0, 2.0),
            Vec3::new(1.5, 0.2, 2.1),
            Vec3::new(0.3, 1.2, 1.8),
            Vec3::new(1.7, 1.4, 2.0),
        ];
        let bone = vec![
            Vec3::new(0.1, 0.0, 0.0),
            Vec3::new(1.0, 0.1, 0.2),
            Vec3::new(0.2, 0.9, -0.1),
            Vec3::new(1.2, 1.1, 0.1),
        ];
        let tissue = Tissue {
            skin,
            bone,
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            is_held: vec![false; 4],
            can_touch: vec![true; 4],
            shear_modulus_mpa: vec![0.01, 0.01, 0.02, 0.03],
            stiffening: vec![0.3, 0.3, 0.2, 0.1],
        };
        let mesh = PrismMesh::new(&tissue, 1).expect("the prisms have volume");
        assert!(mesh.groups.len() == 1 && mesh.groups[0].prisms.1.is_some());
        mesh
    }

    const BULK_RATIO: f64 = 100.0;

    fn at_rest(mesh: &PrismMesh) -> [[f64; 3]; GROUP_NODES] {
        mesh.groups[0].nodes.map(|k| mesh.nodes[k as usize].into())
    }

    fn moved(mesh: &PrismMesh) -> [[f64; 3]; GROUP_NODES] {
        let mut places = at_rest(mesh);
        for (a, x) in places.iter_mut().enumerate() {
            let shift = [0.2, -0.1, 0.25].map(|s| s * (1.0 + 0.3 * a as f64) * x[2] / 2.0);
            *x = [x[0] + shift[0], x[1] + shift[1] * x[0], x[2] - shift[2]];
        }
        places
    }

    fn at(
        mesh: &PrismMesh,
        places: &[[f64; 3]; GROUP_NODES],
        with_stiffness: bool,
    ) -> Option<Element> {
        let mut element = Element::default();
        let placed = Placed {
            mesh,
            group: &mesh.groups[0],
            places,
        };
        evaluate(placed, BULK_RATIO, with_stiffness, &mut element).then_some(element)
    }

    /// Force is the derivative of the energy, stiffness that of the force: central differences.
    #[test]
    fn force_and_stiffness_are_derivatives_of_the_energy() {
        let (mesh, step) = (pair(), 1e-5);
        let places = moved(&mesh);
        let element = at(&mesh, &places, true).expect("not folded");
        let shifted = |unknown: usize, by: f64| {
            let mut places = places;
            places[unknown / 3][unknown % 3] += by;
            at(&mesh, &places, false).expect("not folded")
        };
        let scale = element.stiffness[17][17];
        for a in 0..UNKNOWNS {
            let (above, below) = (shifted(a, step), shifted(a, -step));
            let slope = (above.energy - below.energy) / (2.0 * step);
            assert!(
                (slope - element.force[a]).abs() < 1e-6 * scale,
                "{a}: {slope} {}",
                element.force[a]
            );
            for b in 0..UNKNOWNS {
                let slope = (above.force[b] - below.force[b]) / (2.0 * step);
                let found = element.stiffness[a.max(b)][a.min(b)];
                assert!(
                    (slope - found).abs() < 1e-6 * scale,
                    "{a} {b}: {slope} {found}"
                );
            }
        }
    }

    #[test]
    fn a_rigid_motion_costs_nothing() {
        let mesh = pair();
        let (sine, cosine) = 0.7_f64.sin_cos();
        let places = at_rest(&mesh).map(|x| {
            let turned = [cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1]];
            [turned[0] + 3.0, turned[1], x[2] - 1.0]
        });
        let element = at(&mesh, &places, true).expect("not folded");
        assert!(element.energy.abs() < 1e-15);
        assert!(element.force.iter().all(|f| f.abs() < 1e-12));
    }

    #[test]
    fn a_folded_prism_is_refused() {
        let mesh = pair();
        let mut places = moved(&mesh);
        for (place, node) in places.iter_mut().zip(mesh.groups[0].nodes) {
            if node as usize >= mesh.skin_count {
                place[2] = -3.0;
            }
        }
        assert!(at(&mesh, &places, false).is_none());
    }
}
