//! A press of the skin on a product with a soft grip.

use std::sync::Arc;

use thenar_surface::{Product, Vec3};

use super::elastomer::SoftGrip;
use super::fixed_point::Anderson;
use super::yielding::Covered;
use crate::api::{Press, Start, Unsolved};
use crate::detection::gaps::detect;
use crate::fields::result::Contact;
use crate::fields::summary::by_given_vertex;
use crate::fields::warnings::Warning;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::{ContactError, Control, Model};

/// Share of the deepest yield by which skin's and grip's answers may differ.
const TOLERANCE: f64 = 1e-3;
/// ... and this in addition, mm.
const LEAST_TOLERANCE_MM: f64 = 1e-5;
/// Difference of a rough result that needs no word, mm.
const UNSEEN_MM: f64 = 0.005;
/// Largest difference of a rough result, mm: skin on a sharp edge of a soft grip rests on one face or the other, and that place
/// settles no better.
const ROUGH_MM: f64 = 0.1;
/// The same for all vertices together, as a share of what they yield.
const ROUGH_SHARE: f64 = 0.02;
/// Presses without progress after which a rough result is taken.
const MOST_STALLED: usize = 8;
/// Presses before it is given up.
const MOST_PRESSES: usize = 40;
/// Share of the residual that is taken at every step.
const MIXING: f64 = 0.5;
/// Growth of the residual, over the least so far, at which the iteration begins again from there.
const MOST_GROWTH: f64 = 4.0;
/// Least share of the residual that is taken after that, of what is taken at first.
const LEAST_SLOWNESS: f64 = 1.0 / 64.0;
/// Most that a grip yields in the first step, as a share of the overlap.
const FIRST_SHARE: f64 = 0.5;
/// No grip is pressed thinner than this share of itself.
const LEAST_THICKNESS: f64 = 0.05;
/// Deepest places at which the product is asked whether a core is left.
const PROBED: usize = 12;
/// Yield over thickness beyond which a linear elastomer answers for less and less.
const FAIR_STRAIN: f64 = 0.25;

/// What is pressed.
struct Task<'a> {
    press: &'a Press<'a>,
    /// The grip on its product, and the product as given.
    covered: Covered<'a>,
    product: &'a Arc<Product>,
    /// Posed positions of the skin, mm.
    skin: Vec<Vec3>,
}

/// A contact with a soft grip.
#[derive(Debug, Clone)]
pub struct GripContact {
    /// The contact on the product as it is pressed.
    pub contact: Contact,
    /// Displacement of every vertex of the product, mm: into the core where it yields, outward where it bulges.
    pub displacement: Vec<Vec3>,
    /// The product as it is pressed, where it was given (without the way that it went to carry its force).
    pub product: Arc<Product>,
}

impl Pressing<'_> {
    /// Presses the prepared skin against a product that a soft grip covers.
    ///
    /// Skin and grip bear one pressure, and touch when each has yielded to it. A grip that is rigid everywhere gives the rigid
    /// product's contact bit for bit.
    ///
    /// # Errors
    /// Those of [`Pressing::press`]; [`ContactError::Elastomer`], [`ContactError::GripCount`] and
    /// [`ContactError::UnknownElastomer`] for a grip that does not fit; [`ContactError::GripModel`];
    /// [`ContactError::GripUnsolved`].
    pub fn press_grip(
        &mut self,
        press: &Press<'_>,
        (product, grip): (&Arc<Product>, &SoftGrip),
        control: &Control,
    ) -> Result<GripContact, ContactError> {
        grip.validate(product.mesh().positions().len())?;
        let covered = Covered::new(grip, product);
        if covered.soft().is_empty() {
            return Ok(GripContact {
                contact: self.press(press, control)?,
                displacement: covered.displacement(&[]),
                product: Arc::clone(product),
            });
        }
        if self.skin.model == Model::Paper {
            return Err(ContactError::GripModel);
        }
        let mut task = Task {
            press,
            covered,
            product,
            skin: as_given(self.skin, press.posed)?,
        };
        let (mut state, presses) = self.settle(&mut task, control)?;
        let is_settled = state.is_settled();
        let is_solved = is_settled || state.is_rough();
        if !is_solved && press.unsolved == Unsolved::Refuse {
            return Err(ContactError::GripUnsolved {
                left_mm: state.left,
                presses,
            });
        }
        if press.drag.is_some() || !state.contact.convergence.has_converged {
            // Dragged, or refused as a press of the rigid product is.
            let last = Press {
                product: &state.product,
                start: Start::Warm,
                ..*press
            };
            state.contact = self.press(&last, control)?;
        }
        state.contact.gap = self.gap_as_given(&task, &state.contact)?;
        let covered = &task.covered;
        let GripState {
            mut contact,
            depth,
            left,
            product,
            ..
        } = state;
        if !is_solved {
            contact.warnings.push(Warning::GripUnsolved { left });
        } else if !is_settled && left > UNSEEN_MM {
            contact.warnings.push(Warning::GripRough { left });
        }
        contact
            .warnings
            .extend(strained(&depth, &covered.thickness()));
        contact.warnings.extend(without_core(covered, &depth));
        Ok(GripContact {
            contact,
            displacement: covered.displacement(&depth),
            product,
        })
    }

    /// Presses until skin and grip agree. Returns the state in which they did best, and how many presses it took.
    fn settle(
        &mut self,
        task: &mut Task<'_>,
        control: &Control,
    ) -> Result<(GripState, usize), ContactError> {
        let thickness = task.covered.thickness();
        let (mut anderson, mut slow, mut stalled) = (Anderson::default(), 1.0, 0);
        let mut best = self.press_yielded(
            task,
            (vec![0.0; thickness.len()], task.press.start),
            control,
        )?;
        let softness = task.covered.softness(&best.contact, self.skin.spacing);
        let mixing = MIXING.min(1.0 / (1.0 + softness));
        let first = mixing.min(FIRST_SHARE * overlap(&best.contact) / best.left);
        let mut next = anderson.next(&best.depth, &best.residual, first);
        for presses in 1..MOST_PRESSES {
            control.step("grip", presses as f64 / MOST_PRESSES as f64)?;
            if best.is_settled() || (stalled >= MOST_STALLED && best.is_rough()) {
                return Ok((best, presses));
            }
            bound(&mut next, &thickness);
            let state = self.press_yielded(task, (next, Start::Warm), control)?;
            if state.left > MOST_GROWTH * best.left {
                // It runs away: from the best that was found, with what was learnt of the way there forgotten.
                (anderson, slow) = (Anderson::default(), f64::max(0.5 * slow, LEAST_SLOWNESS));
                next = anderson.next(&best.depth, &best.residual, slow * mixing);
            } else {
                next = anderson.next(&state.depth, &state.residual, slow * mixing);
            }
            stalled += 1;
            if state.left < best.left {
                (best, stalled) = (state, 0);
            }
        }
        Ok((best, MOST_PRESSES))
    }

    /// Signed distances to the product as given, where it carries the contact, mm: overlap is that of skin and product before either yields.
    fn gap_as_given(
        &mut self,
        task: &Task<'_>,
        contact: &Contact,
    ) -> Result<Vec<f64>, ContactError> {
        let posed = self.skin.posed(task.press.posed)?;
        let shift = contact.direction * contact.offset;
        let detection = detect(self, &posed, task.product, shift)?;
        Ok(by_given_vertex(self.skin, detection.distances))
    }

    /// Presses the product whose grip yields by `depth`, and finds by how much it would under that pressure.
    fn press_yielded(
        &mut self,
        task: &mut Task<'_>,
        (depth, start): (Vec<f64>, Start),
        control: &Control,
    ) -> Result<GripState, ContactError> {
        let product = match deepest(&depth) > 0.0 {
            true => Arc::new(moved(task.product, &task.covered.displacement(&depth))?),
            false => Arc::clone(task.product),
        };
        let inner = Press {
            product: &product,
            drag: None,
            start,
            unsolved: Unsolved::Keep,
            ..*task.press
        };
        let quiet = Control {
            progress: &|_, _| {},
            ..*control
        };
        let contact = self.press(&inner, &quiet)?;
        let shift = contact.direction * contact.offset;
        let mut answer = task
            .covered
            .yielding(&contact, &task.skin, (&product, shift));
        bound(&mut answer, &task.covered.thickness());
        let residual: Vec<f64> = answer.iter().zip(&depth).map(|(a, d)| a - d).collect();
        Ok(GripState {
            left: deepest(&residual),
            contact,
            depth,
            residual,
            product,
        })
    }
}

/// Keeps a grip from being pressed thinner, or from bulging farther, than it is thick.
fn bound(depth: &mut [f64], thickness: &[f64]) {
    for (depth, thickness) in depth.iter_mut().zip(thickness) {
        let most = (1.0 - LEAST_THICKNESS) * thickness;
        *depth = depth.clamp(-most, most);
    }
}

/// One press of a grip that yields by `depth`.
struct GripState {
    contact: Contact,
    product: Arc<Product>,
    /// By soft vertex, mm.
    depth: Vec<f64>,
    /// What the grip would yield under the contact's pressure, less `depth`, mm, and its largest.
    residual: Vec<f64>,
    left: f64,
}

impl GripState {
    fn is_settled(&self) -> bool {
        self.left <= TOLERANCE * deepest(&self.depth) + LEAST_TOLERANCE_MM
    }

    /// Settled but for a few vertices.
    fn is_rough(&self) -> bool {
        self.left <= ROUGH_MM && norm(&self.residual) <= ROUGH_SHARE * norm(&self.depth)
    }
}

/// Root of the sum of squares.
fn norm(of: &[f64]) -> f64 {
    of.iter().map(|d| d * d).sum::<f64>().sqrt()
}

/// The largest of these, signs aside.
fn deepest(of: &[f64]) -> f64 {
    of.iter().fold(0.0, |most, d| f64::max(most, d.abs()))
}

/// Posed positions of the hand as given, mm; zero at vertices that are merged into others, which bear nothing.
fn as_given(skin: &Skin, posed: Option<&[Vec3]>) -> Result<Vec<Vec3>, ContactError> {
    let mesh = skin.posed(posed)?;
    let mut given = vec![Vec3::zeros(); skin.regions.len()];
    for (&source, position) in skin.merged.source.iter().zip(mesh.positions()) {
        given[source as usize] = *position;
    }
    Ok(given)
}

fn moved(product: &Product, by: &[Vec3]) -> Result<Product, ContactError> {
    let positions = product.mesh().positions().iter().zip(by);
    let mesh = product
        .mesh()
        .with_positions(positions.map(|(p, by)| p + by).collect())
        .map_err(ContactError::Product)?;
    Product::new(mesh).map_err(ContactError::Product)
}

/// Deepest overlap of skin and product, mm.
fn overlap(contact: &Contact) -> f64 {
    contact
        .gap
        .iter()
        .fold(0.0, |most, gap| f64::max(most, -gap))
}

/// What there is to say of a grip that is pressed far.
fn strained(depth: &[f64], thickness: &[f64]) -> Option<Warning> {
    let strain = depth.iter().zip(thickness).map(|(d, h)| d.abs() / h);
    let strain = strain.fold(0.0, f64::max);
    (strain > FAIR_STRAIN).then_some(Warning::GripStrain { strain })
}

/// Whether the grip is thicker than half the product where it yields most.
fn without_core(covered: &Covered<'_>, depth: &[f64]) -> Option<Warning> {
    let mut deepest: Vec<usize> = (0..depth.len()).filter(|&k| depth[k] > 0.0).collect();
    deepest.sort_by(|&a, &b| depth[b].total_cmp(&depth[a]).then(a.cmp(&b)));
    let place = deepest
        .into_iter()
        .take(PROBED)
        .map(|k| covered.soft()[k])
        .find(|&vertex| covered.is_too_thick(vertex))?;
    Some(Warning::GripWithoutCore {
        vertex: place as usize,
    })
}
