//! Force control: moves the product until the normal force along a direction meets its target.

use std::sync::Arc;

use thenar_surface::{GapLimits, Mesh, Product, Vec3};

use super::at_position::press_at;
use super::pressed::{Pressed, Travel};
use crate::api::ForceTarget;
use crate::detection::gaps::{Stand, limits};
use crate::skin::prepare::Skin;
use crate::stage_times::Watch;
use crate::workspace::Pressing;
use crate::workspace::warm_start::StartContact;
use crate::{ContactError, Control};

/// Force within this share of the target ends the search.
const FORCE_TOLERANCE: f64 = 1e-5;
/// Farthest travel from where the product stands, mm.
pub(crate) const MOST_TRAVEL: f64 = 120.0;
/// First step of the search, mm.
const FIRST_STEP: f64 = 0.4;
/// Factor on the remaining progress per press; a search takes about 8 presses.
const PRESS_SHARE: f64 = 0.85;
/// Progress of a search when its force is found.
const LAST_SHARE: f64 = 0.95;
/// Most steps from a known slope before the travel is bracketed.
const MOST_SECANTS: usize = 5;
/// Most presses of one search.
const MOST_PRESSES: usize = 60;

/// The travel (mm) along a unit direction at which the force is reached, with the press there.
///
/// # Errors
/// [`ContactError::ForceTarget`], `Direction`, `OutOfReach`, `ForceOutOfReach`, or those of a press.
pub(crate) fn find_offset(
    pressing: &mut Pressing<'_>,
    (posed, product): (&Mesh, &Product),
    target: ForceTarget,
    watch: Watch<'_, '_>,
) -> Result<(Travel, Pressed), ContactError> {
    if !(target.newton > 0.0 && target.newton.is_finite()) {
        return Err(ContactError::ForceTarget {
            newton: target.newton,
        });
    }
    let direction = match target.direction {
        Some(given) => given
            .try_normalize(0.0)
            .filter(|d| d.iter().all(|c| c.is_finite())),
        None => Some(mean_normal(pressing.skin, posed, product)?),
    };
    let direction = direction.ok_or(ContactError::Direction)?;
    let start = pressing.workspace.warm_start.offset;
    let mut search = Search {
        pressing: pressing.reborrow(),
        posed,
        product,
        direction,
        watch,
        target: target.newton,
        last: None,
        probes: Vec::new(),
        presses: 0,
        share: 0.0,
    };
    let offset = search.run(start)?;
    search.pressing.workspace.warm_start.slope = search.slope();
    match search.last {
        Some((at, pressed)) if at == offset => Ok((Travel { offset, direction }, pressed)),
        _ => {
            let pressed = search.press(offset)?.1;
            Ok((Travel { offset, direction }, pressed))
        }
    }
}

/// Mean product normal of the penetrating skin by depth and area, or at the nearest skin where none penetrates.
pub(crate) fn mean_normal(
    skin: &Skin,
    posed: &Mesh,
    product: &Product,
) -> Result<Vec3, ContactError> {
    let normals = thenar_surface::vertex_normals(posed);
    let reach = GapLimits {
        cut_off_mm: MOST_TRAVEL,
        ..limits()
    };
    let (mut sum, mut nearest) = (Vec3::zeros(), (f64::INFINITY, Vec3::zeros()));
    for site in (0..skin.sites.len()).filter(|&s| skin.sites.is_skin(s)) {
        let vertex = skin.sites.vertex[site] as usize;
        let Some(gap) = product.gap(posed.positions()[vertex], Some(normals[vertex]), reach) else {
            continue;
        };
        sum += gap.normal * ((-gap.distance).max(0.0) * skin.sites.area[site]);
        if gap.distance < nearest.0 {
            nearest = (gap.distance, gap.normal);
        }
    }
    let out_of_reach = ContactError::OutOfReach {
        cut_off_mm: MOST_TRAVEL,
    };
    sum.try_normalize(1e-12)
        .or_else(|| nearest.1.try_normalize(0.0))
        .ok_or(out_of_reach)
}

/// A travel (mm) and the excess there.
type Probe = (f64, f64);

/// What a known slope leads to.
enum Guess {
    /// The travel that was looked for.
    Found(f64),
    /// Travels with too little and too much force.
    Between([Probe; 2]),
    /// Where to look for them.
    Near(f64),
}

struct Search<'a, 'c> {
    pressing: Pressing<'a>,
    posed: &'a Mesh,
    product: &'a Product,
    direction: Vec3,
    watch: Watch<'a, 'c>,
    target: f64,
    last: Option<(f64, Pressed)>,
    /// Every travel tried.
    probes: Vec<Probe>,
    presses: i32,
    /// Share of the search done, as reported.
    share: f64,
}

impl Search<'_, '_> {
    fn press(&mut self, offset: f64) -> Result<(f64, Pressed), ContactError> {
        let control = Control {
            progress: &|_, _| {},
            ..*self.watch.control
        };
        let watch = Watch {
            control: &control,
            seconds: self.watch.seconds,
        };
        let there = Stand::moved(self.product, self.direction, offset);
        let pressed = press_at(&mut self.pressing, self.posed, &there, watch);
        self.tell(pressed.as_ref().ok())?;
        let pressed = pressed?;
        // Without the travel: the surface is linearized as by a press from nothing, whose result this one repeats.
        self.pressing.workspace.warm_start.last = Arc::new(StartContact {
            travel: Vec::new(),
            ..pressed.solved.to_start(self.pressing.skin.sites.len())
        });
        Ok((pressed.force_along(&self.direction), pressed))
    }

    /// Progress of the search: by the digits of the force found, and a little with every press.
    fn tell(&mut self, pressed: Option<&Pressed>) -> Result<(), ContactError> {
        self.presses += 1;
        let miss = pressed.map_or(1.0, |pressed| {
            (pressed.force_along(&self.direction) / self.target - 1.0).abs()
        });
        let digits = miss.clamp(FORCE_TOLERANCE, 1.0).ln() / FORCE_TOLERANCE.ln();
        let by_presses = 1.0 - PRESS_SHARE.powi(self.presses);
        self.share = self.share.max(LAST_SHARE * digits.max(by_presses));
        self.watch.control.step("force", self.share)
    }

    /// Excess of the force's 2/3 power: force grows about as travel^1.5, so this is nearly a straight line.
    fn excess(&mut self, offset: f64) -> Result<(f64, f64), ContactError> {
        let (force, pressed) = self.press(offset)?;
        self.last = Some((offset, pressed));
        let power = |f: f64| f.abs().powf(2.0 / 3.0).copysign(f);
        let value = power(force) - power(self.target);
        self.probes.push((offset, value));
        Ok((value, force))
    }

    /// Slope of the excess where the search ended; that of the search before if this one tried one travel only.
    fn slope(&self) -> Option<f64> {
        let tried = self.probes.windows(2).last();
        let slope = tried.map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0));
        slope
            .or(self.pressing.workspace.warm_start.slope)
            .filter(|s| s.is_finite() && *s > 0.0)
    }

    fn is_there(&self, force: f64) -> bool {
        (force - self.target).abs() <= FORCE_TOLERANCE * self.target
    }

    /// A few steps of the secant from a slope that is known: most searches that follow another end here.
    ///
    /// Returns the travel found, or the two travels between which it lies if both signs were seen.
    fn by_slope(&mut self, start: f64, mut slope: f64) -> Result<Guess, ContactError> {
        let mut here = start;
        let (mut low, mut high): (Option<Probe>, Option<Probe>) = (None, None);
        for _ in 0..MOST_SECANTS {
            let (value, force) = match self.excess(here) {
                Err(ContactError::Swallowed { .. }) => break,
                other => other?,
            };
            if self.is_there(force) {
                return Ok(Guess::Found(here));
            }
            if force <= 0.0 {
                break;
            }
            let end = if value < 0.0 { &mut low } else { &mut high };
            *end = Some((here, value));
            if let Some([a, b]) = self.probes.last_chunk() {
                let secant = (b.1 - a.1) / (b.0 - a.0);
                slope = if secant.is_finite() && secant > 0.0 {
                    secant
                } else {
                    slope
                };
            }
            here -= (value / slope).clamp(-FIRST_STEP, FIRST_STEP);
        }
        Ok(match (low, high) {
            (Some(low), Some(high)) if low.0 < high.0 => Guess::Between([low, high]),
            (Some(only), None) | (None, Some(only)) => Guess::Near(only.0),
            _ => Guess::Near(start),
        })
    }

    fn run(&mut self, start: f64) -> Result<f64, ContactError> {
        let guess = match self.pressing.workspace.warm_start.slope {
            Some(slope) => self.by_slope(start, slope)?,
            None => Guess::Near(start),
        };
        let [mut low, mut high] = match guess {
            Guess::Found(offset) => return Ok(offset),
            Guess::Between(ends) => ends,
            Guess::Near(start) => self.bracket(start)?,
        };
        let mut last_low = None;
        for _ in 0..MOST_PRESSES {
            let mut middle = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            let width = high.0 - low.0;
            if !(middle > low.0 && middle < high.0) {
                middle = 0.5 * (low.0 + high.0);
            }
            if width < 1e-9 {
                return Ok(middle);
            }
            let (value, force) = self.excess(middle)?;
            if self.is_there(force) {
                return Ok(middle);
            }
            // Illinois: an end that stays put twice counts for half, so that it cannot stall the secant.
            let is_low = value < 0.0;
            let (moved, kept) = if is_low {
                (&mut low, &mut high)
            } else {
                (&mut high, &mut low)
            };
            *moved = (middle, value);
            if last_low == Some(is_low) {
                kept.1 *= 0.5;
            }
            last_low = Some(is_low);
        }
        Ok(self.last.as_ref().map_or(high.0, |last| last.0))
    }

    /// Travels with too little and too much force, each with its excess.
    fn bracket(&mut self, start: f64) -> Result<[Probe; 2], ContactError> {
        let (value, mut force) = self.excess(start)?;
        let (mut here, mut step) = ((start, value), FIRST_STEP);
        if force <= 0.0 {
            step = step.max(self.approach());
        }
        let mut reached = force;
        let sign = if value < 0.0 { 1.0 } else { -1.0 };
        while (here.0 - start).abs() < MOST_TRAVEL {
            let next = here.0 + sign * step;
            let value = match self.excess(next) {
                // Too deep counts as too much: the target lies before.
                Err(ContactError::Swallowed { .. }) if sign > 0.0 => {
                    if step < 1e-3 {
                        break;
                    }
                    step *= 0.4;
                    continue;
                }
                other => {
                    let (value, f) = other?;
                    force = f;
                    value
                }
            };
            reached = reached.max(force);
            if (value < 0.0) != (sign > 0.0) {
                let there = (next, value);
                return Ok(if sign > 0.0 {
                    [here, there]
                } else {
                    [there, here]
                });
            }
            here = (next, value);
            step *= 1.7;
        }
        let travel_mm = (here.0 - start).abs();
        Err(ContactError::ForceOutOfReach {
            target_n: self.target,
            reached_n: reached,
            travel_mm,
        })
    }

    /// Distance to the first skin, mm: where no force is, a search may step this far at once.
    fn approach(&self) -> f64 {
        let Some((_, pressed)) = &self.last else {
            return 0.0;
        };
        let distances = pressed.detection.gaps.iter().flatten().map(|g| g.distance);
        let nearest = distances.fold(f64::INFINITY, f64::min);
        if nearest.is_finite() {
            nearest
        } else {
            limits().cut_off_mm
        }
    }
}
