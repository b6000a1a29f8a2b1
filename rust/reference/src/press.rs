//! The conductor: the product grows into the hand, then hardens.

use thenar_surface::{Product, Vec3};

use crate::cut::Cut;
use crate::newton::{End, Equilibrium, Forces, Limits};
use crate::obstacle::{LIMITS, Obstacle, Penalty};
use crate::pattern::Pattern;
use crate::prisms::PrismMesh;
use crate::refine::Refined;
use crate::result::ReferenceContact;
use crate::{ReferenceError, Tissue};

/// Product's hardness while it grows, and at the end, over the mean shear modulus, 1/mm.
const GROWING: f64 = 5.0;
const RIGID: f64 = 4000.0;
/// Factor by which it hardens in a step, and the least before the solve gives up. On the 48 mm sample 4 takes 15 Newton steps and 16 takes 14.
const HARDER: f64 = 16.0;
const LEAST_HARDER: f64 = 1.03;
/// Where skin stays deeper in the product than this, mm, the product's side is moved once more; at most so many times more.
const DEEPEST_MM: f64 = 0.01;
const MOST_SHIFTS: usize = 2;
/// Skin vertices deeper than this at the end are refused, mm.
const MOST_DEPTH_MM: f64 = 0.02;
/// Products are refused that lie deeper than this in the skin between its vertices, mm, with more than this share of the overlap.
const MOST_CUT: [(f64, f64); 2] = [(0.5, 0.1), (0.1, 0.5)];
/// Share of the vertices inside the product whose columns cross, from which tissue is refused.
const MOST_CROSSED: f64 = 0.5;
/// How far outside the product skin is still refined, mm.
const NEAR_MM: f64 = 1.0;
/// The shortest step of growth before the solve gives up, mm. The first step is the whole depth, halved where it fails: on the 48 mm sample 10
/// Newton steps in place of 20 by steps of 2 mm.
const LEAST_GROWTH_MM: f64 = 0.02;
/// Most nodes that move: with more, building the matrix alone would take too long.
const MOST_NODES: usize = 400_000;
/// Ends of a step of growth, and of one of hardening.
const GROWTH_LIMITS: Limits = Limits {
    tolerance: 0.1,
    most_steps: 25,
    decrease: 1e-2,
};
const HARDENING_LIMITS: Limits = Limits {
    tolerance: 0.03,
    decrease: 1e-3,
    ..GROWTH_LIMITS
};
/// Most Newton steps at the end.
const MOST_STEPS: usize = 60;

/// Numbers of the computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Layers of prisms between bone and skin, 1 to 8.
    pub layers: usize,
    /// Bulk modulus over shear modulus, 10 to 10,000; tissue keeps its volume, 100 lets it give way by a hundredth of a strain.
    pub bulk_ratio: f64,
    /// Edges longer than this are split, once, within 1 mm of the product, mm; infinity: none.
    pub longest_edge_mm: f64,
    /// Largest residual over the contact forces.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            layers: 3,
            bulk_ratio: 100.0,
            longest_edge_mm: 1.6,
            tolerance: 2e-4,
        }
    }
}

impl Settings {
    fn check(&self) -> Result<(), ReferenceError> {
        let refuse = |what: &str, found: String, remedy| ReferenceError::Tissue {
            what: what.to_owned(),
            found,
            remedy,
        };
        if !(1..=8).contains(&self.layers) {
            return Err(refuse("layers", self.layers.to_string(), "give 1 to 8"));
        }
        if !(10.0..=1e4).contains(&self.bulk_ratio) {
            let remedy = "give 10 (compressible) to 10000";
            return Err(refuse("bulk_ratio", self.bulk_ratio.to_string(), remedy));
        }
        Ok(())
    }
}

/// Called with the share done, 0 to 1; false stops the solve.
pub type Progress<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// Presses the tissue against a rigid, smooth product, where both lie.
///
/// The product's surface is soft first, then hardens. Where a step to the whole depth fails, the product is made smaller all around and grows
/// step by step. This is the static solution of a press along the shortest way out, at any depth.
///
/// # Errors
/// [`ReferenceError::Tissue`] for input that cannot be meshed, [`ReferenceError::Unsolved`], [`ReferenceError::Cancelled`].
pub fn press(
    tissue: &Tissue,
    product: &Product,
    settings: Settings,
    progress: Progress<'_>,
) -> Result<ReferenceContact, ReferenceError> {
    tissue.check()?;
    settings.check()?;
    let near = Obstacle::near(tissue, product, NEAR_MM);
    let refined = Refined::new(tissue, |v| near[v], settings.longest_edge_mm);
    let count = tissue.skin.len();
    match solve(&refined.tissue, product, settings, progress) {
        Ok(found) => Ok(found.without(count, &refined.parents)),
        Err(error) => Err(error.without(count, &refined.parents)),
    }
}

fn solve(
    tissue: &Tissue,
    product: &Product,
    settings: Settings,
    progress: Progress<'_>,
) -> Result<ReferenceContact, ReferenceError> {
    let mesh = PrismMesh::new(tissue, settings.layers)?;
    if mesh.free_count > MOST_NODES {
        return Err(too_large(&mesh));
    }
    let pattern = Pattern::new(&mesh);
    let touches = |v: usize| tissue.can_touch[v] && mesh.free[mesh.skin_node(v)] != u32::MAX;
    let obstacle = Obstacle::new(tissue, product, touches);
    if obstacle.is_sheet {
        return Err(ReferenceError::Tissue {
            what: "product where the skin lies in it".to_owned(),
            found: "a sheet without thickness".to_owned(),
            remedy: "give the sheet a thickness (Solidify)",
        });
    }
    check_columns(tissue, &obstacle)?;
    check_bone(tissue, &obstacle)?;
    let equilibrium = Equilibrium::new((&mesh, &pattern), obstacle, settings.bulk_ratio)
        .ok_or_else(|| too_large(&mesh))?;
    let deepest = equilibrium.obstacle.deepest;
    let moduli: f64 = tissue.shear_modulus_mpa.iter().sum();
    let mut growth = Growth {
        equilibrium,
        modulus: moduli / tissue.shear_modulus_mpa.len() as f64,
        deepest,
        done: 0.0,
        progress,
    };
    let forces = growth.run(settings.tolerance)?;
    let Growth { equilibrium, .. } = growth;
    check_depth(tissue, &equilibrium.obstacle, &forces)?;
    let places = &equilibrium.places[mesh.skin_node(0)..];
    let cut = Cut::new(tissue, &equilibrium.obstacle, places);
    let is_cut = |(depth_mm, share)| cut.depth_mm > depth_mm && cut.share > share;
    if MOST_CUT.into_iter().any(is_cut) {
        return Err(ReferenceError::Cut {
            vertex: cut.vertex,
            depth_mm: cut.depth_mm,
            share: 100.0 * cut.share,
        });
    }
    Ok(ReferenceContact::new(tissue, &equilibrium, (&forces, cut)))
}

/// Refuses tissue thicker than the body, whose columns from skin to bone cross under the product.
fn check_columns(tissue: &Tissue, obstacle: &Obstacle<'_>) -> Result<(), ReferenceError> {
    let mut crosses = vec![false; tissue.skin.len()];
    for triangle in &tissue.triangles {
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]].map(|v| v as usize);
            let (skin, bone) = (
                tissue.skin[b] - tissue.skin[a],
                tissue.bone[b] - tissue.bone[a],
            );
            if skin.dot(&bone) < 0.0 {
                (crosses[a], crosses[b]) = (true, true);
            }
        }
    }
    let pressed: Vec<usize> = obstacle.pressed().collect();
    let crossed: Vec<usize> = pressed.iter().copied().filter(|v| crosses[*v]).collect();
    let thickness = |v: &usize| (tissue.skin[*v] - tissue.bone[*v]).norm();
    let thickest = crossed
        .iter()
        .max_by(|a, b| thickness(a).total_cmp(&thickness(b)));
    match thickest {
        Some(vertex) if crossed.len() as f64 > MOST_CROSSED * pressed.len() as f64 => {
            Err(ReferenceError::TooThick {
                crossed: crossed.len(),
                pressed: pressed.len(),
                vertex: *vertex,
                thickness_mm: thickness(vertex),
            })
        }
        _ => Ok(()),
    }
}

/// Refuses a product that reaches into the bone under skin that lies in it.
fn check_bone(tissue: &Tissue, obstacle: &Obstacle<'_>) -> Result<(), ReferenceError> {
    let pressed: Vec<usize> = obstacle.pressed().collect();
    let bone: Vec<Vec3> = pressed.iter().map(|v| tissue.bone[*v]).collect();
    let gaps = obstacle.product().gaps(&bone, None, LIMITS);
    let depths = pressed
        .into_iter()
        .zip(gaps)
        .filter_map(|(vertex, gap)| Some((vertex, -gap?.distance)));
    match depths.max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((vertex, depth_mm)) if depth_mm > 0.0 => {
            Err(ReferenceError::Bone { vertex, depth_mm })
        }
        _ => Ok(()),
    }
}

/// Refuses skin that stays inside the product.
fn check_depth(
    tissue: &Tissue,
    obstacle: &Obstacle<'_>,
    forces: &Forces,
) -> Result<(), ReferenceError> {
    let deepest = forces
        .touches
        .iter()
        .min_by(|a, b| a.distance.total_cmp(&b.distance));
    let Some(touch) = deepest.filter(|touch| -touch.distance > MOST_DEPTH_MM) else {
        return Ok(());
    };
    let vertex = touch.vertex as usize;
    let bone = obstacle.product().gap(tissue.bone[vertex], None, LIMITS);
    Err(ReferenceError::Inside {
        vertex,
        depth_mm: -touch.distance,
        bone_gap_mm: bone.map_or(f64::INFINITY, |gap| gap.distance),
    })
}

fn too_large(mesh: &PrismMesh) -> ReferenceError {
    ReferenceError::Tissue {
        what: "the tissue's mesh is too large for the memory".to_owned(),
        found: format!("{} nodes that move", mesh.free_count),
        remedy: "hold what is far from the product, use fewer layers, or a coarser skin",
    }
}

struct Growth<'a> {
    equilibrium: Equilibrium<'a>,
    /// Mean shear modulus, MPa.
    modulus: f64,
    /// Overlap before the press, mm.
    deepest: f64,
    /// Share of the work done, never falling.
    done: f64,
    progress: Progress<'a>,
}

impl Growth<'_> {
    fn run(&mut self, tolerance: f64) -> Result<Forces, ReferenceError> {
        let (mut grown, mut step) = (0.0, self.deepest);
        while grown < self.deepest {
            let next = (grown + step).min(self.deepest);
            let before: Vec<Vec3> = self.equilibrium.places.clone();
            let (end, forces) = self.balance(GROWING, self.deepest - next, GROWTH_LIMITS)?;
            if end == End::Balanced {
                grown = next;
                step *= 2.0;
                self.advance(0.6 * grown / self.deepest)?;
            } else {
                self.equilibrium.places = before;
                step *= 0.5;
                if step < LEAST_GROWTH_MM {
                    return Err(self.unsolved(grown, forces.as_ref()));
                }
            }
        }
        self.harden()?;
        self.advance(0.8)?;
        let last_limits = Limits {
            tolerance,
            most_steps: MOST_STEPS,
            decrease: 0.0,
        };
        for round in 0..=MOST_SHIFTS {
            self.equilibrium.shift_obstacle();
            match self.balance(RIGID, 0.0, last_limits)? {
                (End::Balanced, Some(forces)) => {
                    if forces.deepest_mm() <= DEEPEST_MM || round == MOST_SHIFTS {
                        return Ok(forces);
                    }
                    self.advance(0.85 + 0.05 * round as f64)?;
                }
                (_, forces) => return Err(self.unsolved(self.deepest, forces.as_ref())),
            }
        }
        Err(self.unsolved(self.deepest, None))
    }

    /// Hardens the product step by step; a step that fails is taken back and halved.
    fn harden(&mut self) -> Result<(), ReferenceError> {
        let (mut hardness, mut factor) = (GROWING, HARDER);
        while hardness < RIGID {
            let next = (hardness * factor).min(RIGID);
            let before = self.equilibrium.places.clone();
            let (end, forces) = self.balance(next, 0.0, HARDENING_LIMITS)?;
            if end == End::Balanced {
                hardness = next;
                self.advance(0.6 + 0.2 * (hardness / GROWING).ln() / (RIGID / GROWING).ln())?;
                factor = (factor * factor).min(HARDER);
            } else {
                self.equilibrium.places = before;
                factor = factor.sqrt();
                if factor < LEAST_HARDER {
                    return Err(self.unsolved(self.deepest, forces.as_ref()));
                }
            }
        }
        Ok(())
    }

    fn balance(
        &mut self,
        hardness: f64,
        inset: f64,
        limits: Limits,
    ) -> Result<(End, Option<Forces>), ReferenceError> {
        let penalty = Penalty {
            stiffness: hardness * self.modulus,
            inset,
        };
        let progress = self.progress;
        let done = self.done;
        let (end, forces) = self
            .equilibrium
            .balance(penalty, limits, &|| !progress(done));
        match end {
            End::Cancelled => Err(ReferenceError::Cancelled),
            _ => Ok((end, forces)),
        }
    }

    fn advance(&mut self, share: f64) -> Result<(), ReferenceError> {
        self.done = share;
        if (self.progress)(share) {
            Ok(())
        } else {
            Err(ReferenceError::Cancelled)
        }
    }

    fn unsolved(&self, grown: f64, forces: Option<&Forces>) -> ReferenceError {
        let mesh = self.equilibrium.mesh;
        let mut vertex = 0;
        if let Some(forces) = forces {
            let size = |k: u32| {
                (0..3)
                    .map(|i| forces.residual[3 * k as usize + i].powi(2))
                    .sum::<f64>()
            };
            let free = (0..mesh.nodes.len()).filter(|node| mesh.free[*node] != u32::MAX);
            let worst = free.max_by(|a, b| size(mesh.free[*a]).total_cmp(&size(mesh.free[*b])));
            vertex = worst.map_or(0, |node| node % mesh.skin_count);
        }
        ReferenceError::Unsolved {
            share: 100.0 * grown / self.deepest.max(1e-9),
            unbalanced: forces.map_or(f64::NAN, |f| 100.0 * f.unbalanced()),
            vertex,
        }
    }
}
