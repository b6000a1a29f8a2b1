//! A press of the skin on a product with a soft grip.
//!
//! Skin and grip bear one pressure at each place, so that the compliance of the grip adds to the skin's, and the contact is solved as that of
//! one skin which yields by the sum on the product as it was given. Afterwards the sum is shared out: the product's vertices go in by what the
//! grip yields, and the skin lies on the product as it is then.

use std::sync::Arc;

use thenar_surface::{Gap, Product, Vec3};

use super::elastomer::SoftGrip;
use super::yielding::{Covered, Place};
use crate::api::{Press, Start, Unsolved};
use crate::detection::gaps::limits;
use crate::fields::result::Contact;
use crate::fields::warnings::Warning;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::{ContactError, Control, Model};

/// Share of the deepest yield by which two presses may differ.
const TOLERANCE: f64 = 1e-3;
/// ... and this in addition, mm.
const LEAST_TOLERANCE_MM: f64 = 1e-3;
/// Difference of a rough result that needs no word, mm.
const UNSEEN_MM: f64 = 0.01;
/// Largest difference of a rough result, mm.
const ROUGH_MM: f64 = 0.1;
/// Presses before it is given up.
const MOST_PRESSES: usize = 24;
/// Presses from which on the skin's moduli take the yield at the walls that were met then. Moduli decide which wall skin at an edge of the
/// product meets, and what it yields jumps from one wall to the other: without a hold the two chase each other.
const HELD_FROM: usize = 4;
/// No grip is pressed thinner than this share of itself.
const LEAST_THICKNESS: f64 = 0.05;
/// Share of the thickness by which a grip may be pressed beyond that.
const BEYOND: f64 = 0.01;
/// Deepest places at which the product is asked whether a core is left.
const PROBED: usize = 12;
/// Yield over thickness beyond which a linear elastomer answers for less and less.
const FAIR_STRAIN: f64 = 0.25;

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
        let covered = Arc::new(Covered::new(grip, product));
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
        self.workspace.grip = Some(Arc::clone(&covered));
        let settled = self.settle(press, &covered, control);
        self.workspace.grip = None;
        let Settled {
            mut contact,
            mut depth,
            left,
            presses,
        } = settled?;
        let is_solved = left <= ROUGH_MM;
        if !is_solved && press.unsolved == Unsolved::Refuse {
            return Err(ContactError::GripUnsolved {
                left_mm: left,
                presses,
            });
        }
        bound(&mut depth, &covered.thickness());
        let displacement = covered.displacement(&depth);
        self.share_out(press, &mut contact, (product, &displacement))?;
        if !is_solved {
            contact.warnings.push(Warning::GripUnsolved { left });
        } else if left > UNSEEN_MM {
            contact.warnings.push(Warning::GripRough { left });
        }
        contact
            .warnings
            .extend(strained(&depth, &covered.thickness()));
        contact.warnings.extend(without_core(&covered, &depth));
        Ok(GripContact {
            product: Arc::new(moved(product, &displacement)?),
            contact,
            displacement,
        })
    }

    /// Presses skin and grip as one, until the skin's moduli are those of what is left for the skin to yield, and no grip is pressed thinner
    /// than it can be.
    fn settle(
        &mut self,
        press: &Press<'_>,
        covered: &Covered,
        control: &Control,
    ) -> Result<Settled, ContactError> {
        let quiet = Control {
            progress: &|_, _| {},
            ..*control
        };
        let thickness = covered.thickness();
        let mut start = match press.start {
            Start::Live => Start::Warm,
            start => start,
        };
        for presses in 1.. {
            let contact = self.press(&Press { start, ..*press }, &quiet)?;
            let depth = covered.depth(&self.loads(press, covered, &contact)?);
            let (beyond, depth) = (harden(covered, &depth, &thickness), depth);
            let stale = renew(covered, self.skin, presses >= HELD_FROM);
            let left = beyond.max(stale);
            let deepest = depth.iter().fold(0.0, |most, d| f64::max(most, d.abs()));
            if left <= TOLERANCE * deepest + LEAST_TOLERANCE_MM || presses == MOST_PRESSES {
                return Ok(Settled {
                    contact,
                    depth,
                    left,
                    presses,
                });
            }
            control.step("grip", presses as f64 / MOST_PRESSES as f64)?;
            start = Start::Warm;
        }
        Err(ContactError::Cancelled)
    }

    /// The forces (N) of a contact, and where they stand on the grip.
    fn loads(
        &self,
        press: &Press<'_>,
        covered: &Covered,
        contact: &Contact,
    ) -> Result<Vec<(Place, f64)>, ContactError> {
        let mut loads = Vec::new();
        for (vertex, gap) in self.touches(press, contact)? {
            let force = contact.nodal_force[vertex];
            if force > 0.0 {
                let area = force / contact.pressure[vertex];
                loads.push((covered.place(&gap, area), force));
            }
        }
        Ok(loads)
    }

    /// Where skin that was moved by a contact lies on its product, by vertex of the hand as given.
    fn touches(
        &self,
        press: &Press<'_>,
        contact: &Contact,
    ) -> Result<Vec<(usize, Gap)>, ContactError> {
        let skin = self.skin;
        let posed = skin.posed(press.posed)?;
        let shift = contact.direction * contact.offset_of(press);
        let (mut vertices, mut points, mut facing) = (Vec::new(), Vec::new(), Vec::new());
        for site in (0..skin.sites.len()).filter(|&site| skin.sites.is_skin(site)) {
            let welded = skin.sites.vertex[site] as usize;
            let vertex = skin.merged.source[welded] as usize;
            vertices.push(vertex);
            points.push(posed.positions()[welded] + contact.displacement[vertex] - shift);
            facing.push(-contact.normal[vertex]);
        }
        let gaps = press
            .product
            .gaps_along(&points, Some(&facing), limits(), &[]);
        let found = vertices.into_iter().zip(gaps);
        Ok(found.filter_map(|(v, gap)| Some((v, gap?))).collect())
    }

    /// Takes from the skin's displacement what the grip yields: the skin then lies on the product as it is pressed.
    fn share_out(
        &self,
        press: &Press<'_>,
        contact: &mut Contact,
        (product, moved): (&Product, &[Vec3]),
    ) -> Result<(), ContactError> {
        let mut by = vec![Vec3::zeros(); contact.displacement.len()];
        for (vertex, gap) in self.touches(press, contact)? {
            let corners = product.mesh().triangles()[gap.triangle as usize];
            for (corner, weight) in corners.into_iter().zip(gap.barycentric) {
                by[vertex] += moved[corner as usize] * weight;
            }
        }
        let merged = &self.skin.merged;
        for (vertex, displacement) in contact.displacement.iter_mut().enumerate() {
            let welded = match merged.merged() {
                0 => vertex,
                _ => merged.merged_of[vertex] as usize,
            };
            *displacement += by[merged.source[welded] as usize];
        }
        Ok(())
    }
}

impl Contact {
    /// The way that the product went along [`Contact::direction`], mm.
    fn offset_of(&self, press: &Press<'_>) -> f64 {
        press.force.map_or(0.0, |_| self.offset)
    }
}

/// What presses of skin and grip as one end with.
struct Settled {
    /// Skin against product: its displacement holds what the grip yields.
    contact: Contact,
    /// By soft vertex, mm.
    depth: Vec<f64>,
    /// Largest difference from what the last press took for given, mm.
    left: f64,
    presses: usize,
}

/// Lets a grip give less where it is pressed thinner than it can be, and more again where it is not; returns by how much it is off, mm.
fn harden(covered: &Covered, depth: &[f64], thickness: &[f64]) -> f64 {
    let mut give = covered.give();
    let mut most = 0.0;
    for ((&vertex, depth), thickness) in covered.soft().iter().zip(depth).zip(thickness) {
        let give = &mut give[vertex as usize];
        let limit = (1.0 - LEAST_THICKNESS) * thickness;
        if *give < 1.0 || depth.abs() > limit {
            let wanted = (*give * (limit / depth.abs().max(1e-12)).sqrt()).min(1.0);
            let is_off = depth.abs() > limit + BEYOND * thickness || wanted > *give;
            if is_off {
                most = f64::max(
                    most,
                    (depth.abs() - limit)
                        .abs()
                        .min((wanted - *give).abs() * limit),
                );
            }
            *give = wanted;
        }
    }
    most
}

/// Takes what the grip yielded in the last press out of the depths that the skin's moduli follow; returns the largest change, mm.
///
/// Where no modulus follows depth, nothing is taken. `is_held`: from now on at the walls that the last press met.
fn renew(covered: &Covered, skin: &Skin, is_held: bool) -> f64 {
    let mut yields = covered.yields();
    let follows = |m: &crate::Material| m.stiffening > 0.0 || m.g0_mpa != m.g_lim_mpa;
    if !skin.tissue.materials.iter().any(follows) {
        return 0.0;
    }
    if is_held && yields.held.is_empty() {
        yields.held = yields.met.clone();
    }
    let before = std::mem::take(&mut yields.taken);
    let was = |site: usize| before.get(site).copied().unwrap_or(0.0);
    let changes = yields.found.iter().enumerate();
    let change = changes.fold(0.0, |most, (site, y)| {
        f64::max(most, (y.max(0.0) - was(site)).abs())
    });
    yields.taken = yields.found.iter().map(|y| y.max(0.0)).collect();
    change
}

/// Keeps a grip from being pressed thinner, or from bulging farther, than it is thick.
fn bound(depth: &mut [f64], thickness: &[f64]) {
    for (depth, thickness) in depth.iter_mut().zip(thickness) {
        let most = (1.0 - LEAST_THICKNESS) * thickness;
        *depth = depth.clamp(-most, most);
    }
}

fn moved(product: &Product, by: &[Vec3]) -> Result<Product, ContactError> {
    let positions = product.mesh().positions().iter().zip(by);
    let mesh = product
        .mesh()
        .with_positions(positions.map(|(p, by)| p + by).collect())
        .map_err(ContactError::Product)?;
    Product::new(mesh).map_err(ContactError::Product)
}

/// What there is to say of a grip that is pressed far.
fn strained(depth: &[f64], thickness: &[f64]) -> Option<Warning> {
    let strain = depth.iter().zip(thickness).map(|(d, h)| d.abs() / h);
    let strain = strain.fold(0.0, f64::max);
    (strain > FAIR_STRAIN).then_some(Warning::GripStrain { strain })
}

/// Whether the grip is thicker than half the product where it yields most.
fn without_core(covered: &Covered, depth: &[f64]) -> Option<Warning> {
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
