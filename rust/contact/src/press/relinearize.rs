//! Stage 4, outer loop: solves the linear contact problem and re-linearizes the gap until the written surface fits the product.

use thenar_surface::Vec3;

use super::displacement_field::{field, keep_out_of_product, lifted_sites};
use super::live::extrapolation;
use super::live::extrapolation::OuterLoads;
use super::live::reused_sites::{keep_solution, keep_strays, reused_sites, strays};
use super::setting::SolveSetting;
use super::solution::SolvedContact;
use super::zone_state::ZoneState;
use crate::solve::Accuracy;
use crate::workspace::Pressing;
use crate::{ContactError, Control, Model};

/// Largest distance between written contact and product that ends the loop, mm.
const OUTER_TOLERANCE: f64 = 0.008;
/// The same relative to the largest penetration: shallow presses are resolved as finely as deep ones.
const OUTER_SHARE: f64 = 5e-4;
/// Largest certificate of a large skin's far field.
const FAR_FIELD_TOLERANCE: f64 = 1e-4;
/// Passes in which slopes are those of the walls met; later ones take secants where the skin does not fit.
const PLAIN_PASSES: usize = 2;
/// Passes after which, at the latest, skin that does not fit along the averaged direction yields along the normal of its own wall.
const MOST_AVERAGED: usize = 10;
/// Most re-linearizations.
const MOST_PASSES: usize = 30;
/// Passes without a lower misfit that end the loop.
const MOST_STALLED: usize = 3;
/// Depth to which skin outside the zone may be left lifted into the product after the last round, mm.
const MOST_LIFTED: f64 = 0.02;
/// Most rounds in which sites lifted into the product join the zone.
const MOST_ROUNDS: usize = 4;

/// Solves the contact of the sites in `zone`.
///
/// # Errors
/// [`ContactError::Cancelled`].
pub fn solve(
    pressing: &mut Pressing<'_>,
    zone: Vec<u32>,
    setting: &SolveSetting<'_>,
    control: &Control,
) -> Result<SolvedContact, ContactError> {
    let skin = pressing.skin;
    let mut state = ZoneState::new(extrapolation::extrapolated_zone(pressing, setting, zone));
    let deepest = setting.detection.deepest();
    let tolerance = match setting.accuracy {
        Accuracy::Full => OUTER_TOLERANCE.min(OUTER_SHARE * deepest),
        Accuracy::Rough => extrapolation::tolerance(deepest),
    };
    let mut strayed = Vec::new();
    for round in 1.. {
        pressing.workspace.near.turn_to(round);
        let again = (round > 1).then_some(&strayed[..]);
        state.is_reused = reused_sites(pressing, setting, &state.zone, again);
        state.beyond = extrapolation::beyond(pressing, setting, round);
        match state.beyond {
            OuterLoads::Nothing => pressing.couple(&state.solved_sites(), control)?,
            _ => extrapolation::couple(pressing, (&state.zone, &state.solved_sites()), control)?,
        }
        pressing.workspace.problem.zone.clone_from(&state.zone);
        state.open(pressing, setting);
        state.passes(pressing, setting, (tolerance, control))?;
        if round == 1 {
            pressing.workspace.live_field.begin();
        }
        let (mut field, far_field) = field(pressing, setting, &state.found(), control)?;
        let (stray, far) = match state.beyond {
            OuterLoads::Nothing => (0.0, Vec::new()),
            _ => strays(&state.found(), &field, deepest),
        };
        keep_out_of_product(skin, setting, &state.found(), &mut field);
        let (worst, lifted) = lifted_sites(skin, setting, (&field, &state.zone), tolerance);
        keep_solution(pressing, setting, &state.found());
        keep_strays(pressing, &state.found(), round, &far);
        if (lifted.is_empty() && far.is_empty()) || round == MOST_ROUNDS {
            state.complementarity = state.complementarity.max(stray);
            let written = Written {
                displacement: field,
                far_field,
                worst,
                lifted,
            };
            let wanted = (tolerance, setting.accuracy.certificate());
            return Ok(state.finish(written, wanted));
        }
        strayed.extend(far);
        state.extend(match setting.accuracy {
            Accuracy::Full => lifted,
            Accuracy::Rough => extrapolation::with_neighbors(skin, setting, &state.zone, lifted),
        });
    }
    Err(ContactError::Cancelled)
}

/// The written surface of a solve, and what is left of it inside the product.
struct Written {
    /// Of every site, mm.
    displacement: Vec<Vec3>,
    /// Its largest difference from the direct sum, relative.
    far_field: f64,
    /// Deepest site outside the zone that was lifted into the product, mm, and those beyond the tolerance.
    worst: f64,
    lifted: Vec<u32>,
}

/// The best fit so far: the merit of a pass is the misfit of the written skin, and what does not lower it goes half the way.
#[derive(Default)]
struct Best {
    misfit: Option<f64>,
    travel: Vec<f64>,
    misfits: Vec<f64>,
    stalled: usize,
}

impl Best {
    /// Takes over a state that fits better; whether it does.
    fn take(&mut self, state: &ZoneState) -> bool {
        let is_better = self.misfit.is_none_or(|best| state.misfit < best);
        if is_better {
            self.misfit = Some(state.misfit);
            self.travel.clone_from(&state.travel);
            self.misfits = state.misfits();
            self.stalled = 0;
        } else {
            self.stalled += 1;
        }
        is_better
    }

    fn is_stuck(&self) -> bool {
        self.stalled >= MOST_STALLED
    }
}

impl ZoneState {
    /// Re-linearizes until the zone fits the product: roughly at first, to the end once it does.
    fn passes(
        &mut self,
        pressing: &mut Pressing<'_>,
        setting: &SolveSetting<'_>,
        (tolerance, control): (f64, &Control),
    ) -> Result<(), ContactError> {
        let skin = pressing.skin;
        let mut problem = self.directional_problem(pressing);
        self.matrix(pressing, setting, &mut problem);
        let (mut best, mut is_along_walls) = (Best::default(), false);
        for pass in 0..MOST_PASSES {
            control.step("solving", pass as f64 / MOST_PASSES as f64)?;
            self.convergence.passes = pass + 1;
            let before: Vec<(f64, f64)> = self.measured().collect();
            self.solve(pressing, &problem, (Accuracy::Rough, control))?;
            self.place(skin, setting);
            if skin.model == Model::Layer && self.turn_strayed(skin, setting) {
                problem = self.directional_problem(pressing);
                self.matrix(pressing, setting, &mut problem);
                best = Best::default();
                continue;
            }
            let has_improved = best.take(self);
            let is_stuck = best.is_stuck() && is_along_walls;
            let is_last = self.misfit <= tolerance || pass + 1 == MOST_PASSES || is_stuck;
            if is_last && setting.accuracy != Accuracy::Rough {
                self.solve(pressing, &problem, (setting.accuracy, control))?;
                self.place(skin, setting);
            }
            if self.misfit <= tolerance || is_stuck {
                break;
            }
            if pass == 0 && skin.model == Model::Layer {
                // From now on the normals where the skin lies; then held, so that facets cannot make them flicker.
                self.update_cosines(pressing);
                self.matrix(pressing, setting, &mut problem);
            }
            if pass >= PLAIN_PASSES || !has_improved {
                self.take_secants(&before, tolerance);
                if !is_along_walls && (best.is_stuck() || pass + 1 >= MOST_AVERAGED) {
                    is_along_walls = true;
                    // What does not fit along the averaged direction yields along the normal of its own wall.
                    self.yield_along_walls(skin, setting, tolerance);
                    problem = self.directional_problem(pressing);
                    best = Best::default();
                } else if !has_improved {
                    self.step_back(skin, setting, (&best.travel, &best.misfits));
                }
                self.matrix(pressing, setting, &mut problem);
            }
        }
        Ok(())
    }

    fn finish(mut self, written: Written, (tolerance, certificate): (f64, f64)) -> SolvedContact {
        let Written {
            displacement,
            far_field,
            worst,
            lifted,
        } = written;
        let is_fit = self.misfit <= tolerance && (lifted.is_empty() || worst <= MOST_LIFTED);
        let is_solved = is_fit && self.complementarity <= certificate;
        self.convergence.has_converged = is_solved && far_field <= FAR_FIELD_TOLERANCE;
        let misfits = self.misfits();
        let mut unfit: Vec<usize> = (0..misfits.len())
            .filter(|&k| misfits[k] > tolerance)
            .collect();
        unfit.sort_by(|&a, &b| misfits[b].total_cmp(&misfits[a]));
        let mut unfit: Vec<u32> = unfit.into_iter().map(|k| self.zone[k]).collect();
        if !is_fit {
            unfit.extend(lifted);
        }
        let deepest = self.touch.iter().map(|g| -g.distance).fold(worst, f64::max);
        let bearing = self.direction.iter().zip(&self.cosine);
        SolvedContact {
            bearing: bearing.map(|(d, c)| d * *c).collect(),
            zone: self.zone,
            force: self.force,
            touch: self.touch,
            travel: self.travel,
            slack: self.slack,
            displacement,
            penetration: deepest.max(0.0),
            complementarity: self.complementarity,
            far_field,
            convergence: self.convergence,
            unfit,
            left: self.misfit.max(worst),
        }
    }
}
