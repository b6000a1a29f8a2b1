//! Stage 4's outer loop: the contact problem is linear in the gap, the product is not; repeat until the written surface fits.

use thenar_surface::{Gap, Product, Vec3};

use crate::carried::{field, keep_out, lifted_sites};
use crate::contact_state::{Beyond, State};
use crate::held::{held, keep, strays};
use crate::live;
use crate::memory::Last;
use crate::press::Convergence;
use crate::skin::Skin;
use crate::solve::Accuracy;
use crate::zone::Detection;
use crate::{ContactError, Control, Model};

/// Largest distance between written contact and product that ends the loop, mm.
const OUTER_TOLERANCE: f64 = 0.008;
/// The same relative to the largest penetration: shallow presses are resolved as finely as deep ones.
const OUTER_SHARE: f64 = 5e-4;
/// Largest certificate of a large skin's far field.
const FAR_FIELD_TOLERANCE: f64 = 1e-4;
/// Most re-linearizations.
const MOST_PASSES: usize = 14;
/// Most rounds in which sites lifted into the product join the zone.
const MOST_ROUNDS: usize = 4;

/// The solved contact, in the product's frame.
#[derive(Clone)]
pub struct Solved {
    /// Sites that could touch, ascending.
    pub zone: Vec<u32>,
    /// Normal force on each, N.
    pub force: Vec<f64>,
    /// Where each touches, or would: closest point and normal after deformation.
    pub touch: Vec<Gap>,
    /// Travel of each along its direction, mm.
    pub travel: Vec<f64>,
    /// Slack of the last linear problem, mm.
    pub slack: Vec<f64>,
    /// Direction in which each yields times its cosine with the normal: load per normal force.
    pub bearing: Vec<Vec3>,
    /// Displacement of every site, mm.
    pub displacement: Vec<Vec3>,
    /// Signed distance of the written zone, and of every other site that was lifted towards the product, at worst, mm.
    pub penetration: f64,
    /// Complementarity of the last linear problem.
    pub complementarity: f64,
    /// Largest difference of the displacement from the direct sum, on a sample of sites, relative to the largest.
    pub far_field: f64,
    /// How it ended.
    pub convergence: Convergence,
}

/// What does not change within a solve.
pub struct Setting<'a> {
    /// The product.
    pub product: &'a Product,
    /// Detection of this posture.
    pub detection: &'a Detection,
    /// Response weight s = sqrt((1 - nu) / (2 pi G)) of every site.
    pub weight: &'a [f64],
    /// What to start from.
    pub start: Option<&'a Last>,
    /// How far the last linear problem is solved.
    pub accuracy: Accuracy,
    /// Median edge, mm.
    pub spacing: f64,
}

/// Solves the contact of the sites in `zone`.
///
/// # Errors
/// [`ContactError::Cancelled`].
pub fn solve(
    skin: &mut Skin,
    zone: Vec<u32>,
    setting: &Setting<'_>,
    control: &Control,
) -> Result<Solved, ContactError> {
    let mut state = State::new(live::with_foreseen(skin, setting, zone));
    let deepest = setting.detection.deepest();
    let tolerance = match setting.accuracy {
        Accuracy::Full => OUTER_TOLERANCE.min(OUTER_SHARE * deepest),
        Accuracy::Rough => live::tolerance(deepest),
    };
    let mut strayed = Vec::new();
    for round in 1.. {
        skin.memory.near.turn_to(round);
        let again = (round > 1).then_some(&strayed[..]);
        state.held = held(skin, setting, &state.zone, again);
        state.beyond = live::beyond(skin, setting, round);
        match state.beyond {
            Beyond::Nothing => skin.couple(&state.solved_sites(), control)?,
            _ => live::couple(skin, (&state.zone, &state.solved_sites()), control)?,
        }
        skin.memory.zone.clone_from(&state.zone);
        state.open(skin, setting);
        state.passes(skin, setting, (tolerance, control))?;
        if round == 1 {
            skin.memory.shown.begin();
        }
        let (mut field, far_field) = field(skin, setting, &state.found(), control)?;
        let (stray, far) = match state.beyond {
            Beyond::Nothing => (0.0, Vec::new()),
            _ => strays(&state.found(), &field, deepest),
        };
        keep_out(skin, setting, &state.found(), &mut field);
        let (worst, lifted) = lifted_sites(skin, setting, (&field, &state.zone), tolerance);
        let left = (&state.slack[..], &state.sums[..], &state.held[..]);
        keep(skin, setting, &state.found(), left);
        if (lifted.is_empty() && far.is_empty()) || round == MOST_ROUNDS {
            state.complementarity = state.complementarity.max(stray);
            let wanted = (tolerance, setting.accuracy.certificate());
            return Ok(state.finish((field, far_field), worst, wanted));
        }
        strayed.extend(far);
        state.extend(match setting.accuracy {
            Accuracy::Full => lifted,
            Accuracy::Rough => live::ringed(skin, setting, &state.zone, lifted),
        });
    }
    Err(ContactError::Cancelled)
}

impl State {
    /// Re-linearizes until the zone fits the product: roughly at first, to the end once it does.
    fn passes(
        &mut self,
        skin: &mut Skin,
        setting: &Setting<'_>,
        (tolerance, control): (f64, &Control),
    ) -> Result<(), ContactError> {
        let mut turned = self.turned(skin);
        self.matrix(skin, setting, &mut turned);
        for pass in 0..MOST_PASSES {
            control.step("solving", pass as f64 / MOST_PASSES as f64)?;
            self.convergence.passes = pass + 1;
            self.solve(skin, &turned, (Accuracy::Rough, control))?;
            self.place(skin, setting);
            let is_last = self.misfit <= tolerance || pass + 1 == MOST_PASSES;
            if is_last && setting.accuracy != Accuracy::Rough {
                self.solve(skin, &turned, (setting.accuracy, control))?;
                self.place(skin, setting);
            }
            if self.misfit <= tolerance {
                break;
            }
            if pass == 0 && skin.model == Model::Layer {
                // From now on the normals where the skin lies; then held, so that facets cannot make them flicker.
                self.see_along_normals(skin);
                self.matrix(skin, setting, &mut turned);
            }
        }
        Ok(())
    }

    fn finish(
        mut self,
        (displacement, far_field): (Vec<Vec3>, f64),
        worst: f64,
        (tolerance, certificate): (f64, f64),
    ) -> Solved {
        let is_solved = self.misfit <= tolerance && self.complementarity <= certificate;
        self.convergence.has_converged = is_solved && far_field <= FAR_FIELD_TOLERANCE;
        let deepest = self.touch.iter().map(|g| -g.distance).fold(worst, f64::max);
        let bearing = self.direction.iter().zip(&self.cosine);
        Solved {
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
        }
    }
}

/// The welded vertex of a site.
pub fn vertex(skin: &Skin, site: u32) -> usize {
    skin.sites.vertex[site as usize] as usize
}
