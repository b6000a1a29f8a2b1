//! Equilibrium of tissue and product by a Newton iteration with a regularized diagonal.

use rayon::prelude::*;
use thenar_surface::Vec3;

use crate::factor::Factor;
use crate::obstacle::{Obstacle, Penalty, Touch};
use crate::pattern::Pattern;
use crate::prism_energy::{Element, Placed, evaluate};
use crate::prisms::{GROUP_NODES, PrismMesh};

/// Longest step of a node, mm.
const MOST_STEP_MM: f64 = 1.5;
/// Times that a step is shortened, each to this share.
const SHORTER: (usize, f64) = (6, 0.4);
/// Regularization, as a share of the diagonal, that a step begins with where the plain one leads uphill or folds a prism; its growth; its end.
const REGULARIZATION: (f64, f64, f64) = (3e-3, 4.0, 1e3);
/// Regularization below which none is left.
const NO_REGULARIZATION: f64 = 2e-4;
/// Least decrease of the energy for a step, as a share of what its slope promises.
const DECREASE: f64 = 1e-4;

/// A group whose nodes moved against each other by less than this, mm, keeps its stiffness; its force is always computed.
const SAME_MM: f64 = 1e-3;

/// Tissue, product and where the nodes lie.
pub struct Equilibrium<'a> {
    pub mesh: &'a PrismMesh,
    pub pattern: &'a Pattern,
    pub factor: Factor,
    pub obstacle: Obstacle<'a>,
    /// Bulk modulus over shear modulus.
    pub bulk_ratio: f64,
    /// Where the nodes lie, mm.
    pub places: Vec<Vec3>,
    /// Newton steps so far.
    pub steps: usize,
    elements: Vec<Element>,
    /// Places at which the elements hold force and stiffness; empty where they hold none.
    evaluated: Vec<Vec3>,
    /// Places of every group's nodes for which it holds its stiffness.
    stiff_at: Vec<[[f64; 3]; GROUP_NODES]>,
    values: Vec<f64>,
    /// Room for the stiffness of the step before.
    spare: Vec<f64>,
}

/// Forces in one state.
pub struct Forces {
    /// Energy of tissue and penalty, N mm.
    pub energy: f64,
    /// Force that is not balanced, on the unknowns, N.
    pub residual: Vec<f64>,
    /// Contact.
    pub touches: Vec<Touch>,
}

impl Forces {
    /// Norm of the residual over that of the contact forces.
    pub fn unbalanced(&self) -> f64 {
        let contact: f64 = self.touches.iter().map(|t| t.force * t.force).sum();
        norm(&self.residual) / (contact.sqrt() + 1e-6)
    }

    /// The deepest skin that bears a load, mm.
    pub fn deepest_mm(&self) -> f64 {
        self.touches
            .iter()
            .fold(0.0, |most, t| f64::max(most, -t.distance))
    }
}

/// Where a step leads.
struct Next {
    places: Vec<Vec3>,
    /// Decrease of the energy that the step promised, over the energy; infinite where it was shortened.
    decrease: f64,
    /// Whether the full step at the regularization given went well.
    is_plain: bool,
    /// Forces there, where the stiffness kept belongs to them.
    forces: Option<Forces>,
}

/// When an iteration ends.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Residual over the contact forces that is enough.
    pub tolerance: f64,
    pub most_steps: usize,
    /// Decrease of the energy that a full step promises, over the energy, after which it ends: a prism that was nearly folded holds up the
    /// residual, but not the energy. 0: the residual decides.
    pub decrease: f64,
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    Balanced,
    Stuck,
    Cancelled,
}

impl<'a> Equilibrium<'a> {
    /// `None` where there is not enough memory.
    pub fn new(
        (mesh, pattern): (&'a PrismMesh, &'a Pattern),
        obstacle: Obstacle<'a>,
        bulk_ratio: f64,
    ) -> Option<Equilibrium<'a>> {
        Some(Equilibrium {
            mesh,
            pattern,
            factor: Factor::new(pattern)?,
            obstacle,
            bulk_ratio,
            places: mesh.nodes.clone(),
            steps: 0,
            elements: vec![Element::default(); mesh.groups.len()],
            evaluated: Vec::new(),
            stiff_at: vec![[[f64::INFINITY; 3]; GROUP_NODES]; mesh.groups.len()],
            values: vec![0.0; pattern.rows.len()],
            spare: vec![0.0; pattern.rows.len()],
        })
    }

    /// Iterates until the residual is below the tolerance.
    pub fn balance(
        &mut self,
        penalty: Penalty,
        limits: Limits,
        is_cancelled: &dyn Fn() -> bool,
    ) -> (End, Option<Forces>) {
        let places = std::mem::take(&mut self.places);
        let (end, places, forces) = self.iterate(places, penalty, limits, is_cancelled);
        self.places = places;
        (end, forces)
    }

    fn iterate(
        &mut self,
        mut places: Vec<Vec3>,
        penalty: Penalty,
        limits: Limits,
        is_cancelled: &dyn Fn() -> bool,
    ) -> (End, Vec<Vec3>, Option<Forces>) {
        let Some(mut forces) = self.forces(&places, penalty, true) else {
            return (End::Stuck, places, None);
        };
        let mut regularization = 0.0;
        for _ in 0..limits.most_steps {
            if forces.unbalanced() < limits.tolerance {
                return (End::Balanced, places, Some(forces));
            }
            if is_cancelled() {
                return (End::Cancelled, places, Some(forces));
            }
            self.steps += 1;
            let Some(next) = self.step(&places, &forces, penalty, &mut regularization) else {
                return (End::Stuck, places, Some(forces));
            };
            if next.is_plain {
                regularization = if regularization > NO_REGULARIZATION {
                    0.25 * regularization
                } else {
                    0.0
                };
            }
            let is_near = next.decrease < limits.decrease;
            places = next.places;
            match next.forces.or_else(|| self.forces(&places, penalty, true)) {
                Some(found) => forces = found,
                None => return (End::Stuck, places, None),
            }
            if is_near {
                return (End::Balanced, places, Some(forces));
            }
        }
        let end = if forces.unbalanced() < limits.tolerance {
            End::Balanced
        } else {
            End::Stuck
        };
        (end, places, Some(forces))
    }

    /// The next places; `None` where no step lowers the energy. The stiffness kept is that of the places given, or of the next ones where
    /// their forces are returned.
    fn step(
        &mut self,
        places: &[Vec3],
        forces: &Forces,
        penalty: Penalty,
        regularization: &mut f64,
    ) -> Option<Next> {
        // The attempts below overwrite the stiffness that is kept.
        std::mem::swap(&mut self.values, &mut self.spare);
        let mut stiffness = std::mem::take(&mut self.spare);
        let mut is_first = true;
        let unbalanced = norm(&forces.residual);
        let diagonal = self.pattern.diagonal();
        let plain: Vec<f64> = diagonal.iter().map(|entry| stiffness[*entry]).collect();
        let mut next = None;
        'search: while *regularization <= REGULARIZATION.2 {
            for (entry, plain) in diagonal.iter().zip(&plain) {
                stiffness[*entry] = plain + *regularization * plain.abs();
            }
            let mut step: Vec<f64> = forces.residual.iter().map(|r| -r).collect();
            let is_definite = self.factor.solve(self.pattern, &stiffness, &mut step);
            let longest = step.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            if is_definite && longest.is_finite() {
                let slope: f64 = step.iter().zip(&forces.residual).map(|(s, r)| s * r).sum();
                let mut share = (MOST_STEP_MM / longest).min(1.0);
                for attempt in 0..SHORTER.0 {
                    let there = self.moved(places, &step, share);
                    // The first step mostly serves: its stiffness is then not computed apart.
                    let is_plain = is_first && attempt == 0;
                    if let Some(found) = self.forces(&there, penalty, is_plain) {
                        let enough =
                            forces.energy + DECREASE * share * slope + 1e-10 * forces.energy.abs();
                        if found.energy <= enough || norm(&found.residual) < 0.5 * unbalanced {
                            next = Some(Next {
                                places: there,
                                decrease: if share < 1.0 || *regularization > 0.0 {
                                    f64::INFINITY
                                } else {
                                    -0.5 * slope / forces.energy
                                },
                                is_plain,
                                forces: is_plain.then_some(found),
                            });
                            break 'search;
                        }
                    }
                    share *= SHORTER.1;
                }
            }
            is_first = false;
            *regularization = (REGULARIZATION.1 * *regularization).max(REGULARIZATION.0);
        }
        self.spare = stiffness;
        next
    }

    /// Moves the product's side to where its penalty holds the skin at it.
    pub fn shift_obstacle(&mut self) {
        let (mesh, places) = (self.mesh, &self.places);
        self.obstacle.shift(|v| places[mesh.skin_node(v)]);
    }

    /// Smallest and largest volume of a prism over its volume before, where the nodes were evaluated last.
    pub fn dilatations(&self) -> [f64; 2] {
        let all = self.elements.iter().map(|element| element.dilatation);
        all.fold([1.0, 1.0], |[low, high], d| {
            [f64::min(low, d), f64::max(high, d)]
        })
    }

    fn moved(&self, places: &[Vec3], step: &[f64], share: f64) -> Vec<Vec3> {
        let moved = places.iter().zip(&self.mesh.free).map(|(place, free)| {
            let k = 3 * *free as usize;
            match step.get(k..k + 3) {
                Some(by) if *free != u32::MAX => place + Vec3::new(by[0], by[1], by[2]) * share,
                _ => *place,
            }
        });
        moved.collect()
    }

    /// Evaluates the elements at `places`; false where a prism is folded.
    fn strain(&mut self, places: &[Vec3], with_stiffness: bool) -> bool {
        let (mesh, bulk_ratio) = (self.mesh, self.bulk_ratio);
        self.evaluated.clear();
        let work = self
            .elements
            .par_iter_mut()
            .zip(&mut self.stiff_at)
            .zip(&mesh.groups)
            .with_min_len(128);
        let is_sound = work.map(|((element, stiff_at), group)| {
            let place = |k: u32| places.get(k as usize).copied().unwrap_or_default().into();
            let corners = group.nodes.map(place);
            let placed = Placed {
                mesh,
                group,
                places: &corners,
            };
            let is_new = with_stiffness && !is_same_shape(&corners, stiff_at);
            let is_sound = evaluate(placed, bulk_ratio, is_new, element);
            if is_sound && is_new {
                *stiff_at = corners;
            }
            is_sound
        });
        let is_sound = is_sound.reduce(|| true, |a, b| a && b);
        if is_sound && with_stiffness {
            self.evaluated.extend_from_slice(places);
        }
        is_sound
    }

    /// Energy and forces at `places`, and the stiffness where asked for; `None` where a prism is folded.
    fn forces(
        &mut self,
        places: &[Vec3],
        penalty: Penalty,
        with_stiffness: bool,
    ) -> Option<Forces> {
        let mesh = self.mesh;
        // A product that changed leaves the tissue as it was.
        let is_known = with_stiffness && self.evaluated == places;
        if !is_known && !self.strain(places, with_stiffness) {
            return None;
        }
        let mut residual = vec![0.0; 3 * mesh.free_count];
        for (element, group) in self.elements.iter().zip(&mesh.groups) {
            for (a, node) in group.nodes.iter().enumerate() {
                let free = mesh.free.get(*node as usize).copied().unwrap_or(u32::MAX);
                if free != u32::MAX {
                    for i in 0..3 {
                        residual[3 * free as usize + i] += element.force[3 * a + i];
                    }
                }
            }
        }
        let touches = self
            .obstacle
            .touches(|v| places[mesh.skin_node(v)], penalty);
        for touch in &touches {
            let free = mesh.free[mesh.skin_node(touch.vertex as usize)] as usize;
            for i in 0..3 {
                residual[3 * free + i] -= touch.force * touch.normal[i];
            }
        }
        if with_stiffness {
            self.values.fill(0.0);
            self.pattern.add(mesh, &self.elements, &mut self.values);
            for touch in &touches {
                let free = mesh.free[mesh.skin_node(touch.vertex as usize)] as usize;
                let n = touch.normal;
                let block =
                    std::array::from_fn(|i| std::array::from_fn(|j| touch.stiffness * n[i] * n[j]));
                self.pattern.add_node(free, &block, &mut self.values);
            }
        }
        let tissue: f64 = self.elements.iter().map(|e| e.energy).sum();
        let contact: f64 = touches.iter().map(|t| t.energy).sum();
        Some(Forces {
            energy: tissue + contact,
            residual,
            touches,
        })
    }
}

/// Whether no node moved against the first by more than [`SAME_MM`].
fn is_same_shape(places: &[[f64; 3]; GROUP_NODES], before: &[[f64; 3]; GROUP_NODES]) -> bool {
    let moved = |k: usize, i: usize| places[k][i] - before[k][i];
    (1..GROUP_NODES).all(|k| (0..3).all(|i| (moved(k, i) - moved(0, i)).abs() <= SAME_MM))
}

/// Euclidean norm.
pub fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}
