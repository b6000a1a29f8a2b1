//! Steps through a protocol row by row; posture and product may move between rows, tissue and friction keep their memory.

use std::borrow::Cow;

use thenar_surface::{Mesh, Product, Vec3};

use super::first_touch::first_touch;
use super::protocol::{Demand, Row};
use super::protocol_result::{Keep, Step};
use super::row_posture::{Stand, from_product_frame, rotations, to_product_frame};
use super::tissue_memory::TissueMemory;
use crate::api::{Drag, ForceTarget};
use crate::fields::summary::{summarize, totals};
use crate::fields::warnings::Warning;
use crate::instrument::loads_of;
use crate::interface::friction;
use crate::interface::friction_state::FrictionMemory;
use crate::interface::stick_slip::StickSlipStep;
use crate::press::at_position::press_at;
use crate::press::force_control::{find_offset, mean_normal};
use crate::press::pressed::{Pressed, Travel};
use crate::skin::prepare::Skin;
use crate::stage_times::{Seconds, Watch};
use crate::workspace::Pressing;
use crate::workspace::warm_start::WarmStart;
use crate::{ActiveEffect, Contact, ContactError, Control};

/// How far the product is taken off the skin where no force is asked for, mm.
const CLEARANCE: f64 = 1.0;

/// State of a protocol in progress: rows taken, memory of tissue and friction, warm start of the next row.
///
/// A walk belongs to one skin and one product. It may be cloned, to try rows from where it stands.
#[derive(Clone)]
pub struct Walk {
    keep: Keep,
    effects: Vec<ActiveEffect>,
    direction: Option<Vec3>,
    touch: Option<f64>,
    /// The last posture, in the product's frame.
    posed: Option<Mesh>,
    history: Option<TissueMemory>,
    friction_memory: FrictionMemory,
    warm_start: WarmStart,
    rows: usize,
    last: Option<LastRow>,
}

/// The last row.
#[derive(Clone)]
struct LastRow {
    row: Row,
    step: Step,
    pressed: Pressed,
    /// Change of the offset from the row before, mm/s; 0 unless both hold a force.
    pace: f64,
}

impl Walk {
    /// A walk on a skin that was never pressed, with the effects that are switched on.
    ///
    /// `direction`: where the product moves to press, in its own frame; None: mean normal of the first posture.
    ///
    /// # Errors
    /// [`ContactError::Direction`] if it has no length.
    pub fn new(skin: &Skin, direction: Option<Vec3>) -> Result<Walk, ContactError> {
        let unit = |given: Vec3| {
            let unit = given.try_normalize(0.0);
            unit.filter(|d| d.iter().all(|c| c.is_finite()))
                .ok_or(ContactError::Direction)
        };
        Ok(Walk {
            keep: Keep::Totals,
            effects: skin.effects().to_vec(),
            direction: direction.map(unit).transpose()?,
            touch: None,
            posed: None,
            history: TissueMemory::new(
                skin.effects(),
                &skin.tissue.thicknesses(),
                skin.sites.len(),
            ),
            friction_memory: FrictionMemory::default(),
            warm_start: WarmStart::default(),
            rows: 0,
            last: None,
        })
    }

    /// The same that keeps more of every step.
    pub fn keeping(mut self, keep: Keep) -> Walk {
        self.keep = keep;
        self
    }

    /// Unit direction in which the product moves, in its own frame; zero until it is known.
    pub fn direction(&self) -> Vec3 {
        self.direction.unwrap_or_else(Vec3::zeros)
    }

    /// Travel at which the product first touches the skin, mm, where a row has asked for it.
    pub fn touch_offset(&self) -> Option<f64> {
        self.touch
    }

    /// Rows taken.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The last row's step.
    pub fn step(&self) -> Option<&Step> {
        self.last.as_ref().map(|last| &last.step)
    }

    /// True if a demand is measured from first touch.
    pub(super) fn needs_touch(demand: Demand) -> bool {
        matches!(demand, Demand::Depth(_)) || demand == Demand::Force(0.0)
    }

    /// Takes a stand: the posture, seen by the product, and what its motion does to what is remembered.
    pub(super) fn face(&mut self, skin: &Skin, stand: &Stand<'_>) -> Result<(), ContactError> {
        let posed = match (stand.posed, &stand.motion) {
            (posed, None) => skin.posed(posed)?,
            (posed, Some(motion)) => {
                let mesh = skin.posed(posed)?;
                let mut positions = mesh.positions().to_vec();
                to_product_frame(&mut positions, motion);
                mesh.with_positions(positions).map_err(ContactError::Hand)?
            }
        };
        if self.direction.is_none() {
            self.direction = Some(mean_normal(skin, &posed, stand.product)?);
        }
        let Some(before) = &self.posed else {
            self.posed = Some(posed);
            return Ok(());
        };
        if before.positions() == posed.positions() {
            return Ok(());
        }
        let vertex = skin.sites.vertex.iter().map(|v| *v as usize);
        self.friction_memory.strays = vertex
            .map(|v| before.positions()[v] - posed.positions()[v])
            .collect();
        if let Some(history) = &mut self.history {
            let turns = rotations(skin, before, &posed);
            history.turn(|site| turns[site as usize]);
        }
        self.touch = None;
        self.posed = Some(posed);
        Ok(())
    }

    /// Finds where the product first touches the skin, unless it is known.
    pub(super) fn touch(&mut self, skin: &Skin, product: &Product) -> Result<f64, ContactError> {
        if let (None, Some(posed)) = (self.touch, &self.posed) {
            self.touch = Some(first_touch(skin, (posed, product), self.direction())?);
        }
        Ok(self.touch.unwrap_or(0.0))
    }

    /// The contact at the last row, in full, in the frame of the posed positions.
    ///
    /// # Errors
    /// [`ContactError::EmptyProtocol`] if no row was taken, or those of a posture.
    pub fn contact(&self, skin: &Skin, stand: &Stand<'_>) -> Result<Contact, ContactError> {
        let (Some(last), Some(posed)) = (&self.last, &self.posed) else {
            return Err(ContactError::EmptyProtocol);
        };
        let mut pressed = last.pressed.clone();
        friction::move_skin(skin, stand.product, &mut pressed);
        let slide = last.row.slide;
        let posed = slid(posed, slide)?;
        let travel = Travel {
            offset: last.step.offset,
            direction: self.direction(),
        };
        let mut contact = summarize(skin, (&posed, stand.product), &pressed, travel);
        if contact.center_of_pressure != Vec3::zeros() {
            contact.center_of_pressure += slide;
        }
        contact.total_moment += slide.cross(&contact.total_force);
        for warning in &mut contact.warnings {
            // A row may lift the product off.
            if *warning == Warning::NoContact {
                *warning = Warning::Note(warning.to_string());
            }
        }
        if let Some(motion) = &stand.motion {
            from_product_frame(&mut contact, motion);
        }
        Ok(contact)
    }

    /// Solves a row, and drags the product as far as it says.
    fn press(
        &mut self,
        pressing: &mut Pressing<'_>,
        (product, row): (&Product, &Row),
        control: &Control,
    ) -> Result<(f64, Pressed), ContactError> {
        if let (Some(history), Some(last)) = (&mut pressing.workspace.history, &self.last) {
            history.seconds = row.time_s - last.row.time_s;
        }
        let touch = if Walk::needs_touch(row.demand) {
            self.touch(pressing.skin, product)?
        } else {
            0.0
        };
        let Some(posed) = &self.posed else {
            return Err(ContactError::EmptyProtocol);
        };
        let (mut seconds, direction) = (Seconds::new(), self.direction());
        let posed = slid(posed, row.slide)?;
        let watch = Watch {
            control,
            seconds: &mut seconds,
        };
        let offset = match row.demand {
            Demand::Offset(offset) => offset,
            Demand::Depth(depth) => touch + depth,
            Demand::Force(0.0) => touch - CLEARANCE,
            Demand::Force(newton) => {
                if let Some(last) = &self.last {
                    pressing.workspace.warm_start.offset =
                        last.step.offset + last.pace * (row.time_s - last.row.time_s);
                }
                let target = ForceTarget {
                    newton,
                    direction: Some(direction),
                };
                let place = (&*posed, product);
                let (travel, pressed) = find_offset(pressing, place, target, watch)?;
                return Ok((travel.offset, pressed));
            }
        };
        let there = crate::detection::gaps::Stand::moved(product, direction, offset);
        let pressed = press_at(pressing, &posed, &there, watch)?;
        Ok((offset, pressed))
    }

    /// The totals of a step, and the memory of it.
    fn keep(
        &self,
        Pressing { skin, workspace }: &mut Pressing<'_>,
        row: &Row,
        (offset, pressed): (f64, &Pressed),
    ) -> Option<Step> {
        let totals = totals(skin, self.posed.as_ref()?, pressed);
        let sheared = pressed.shear.as_ref().map(|shear| &shear.end);
        let shear = sheared.map_or_else(Vec3::zeros, StickSlipStep::force);
        if let (Some(history), Some(recalled)) = (&mut workspace.history, &pressed.recalled) {
            let place = (&*skin.sites, &totals.region_area[..]);
            let borne = (&recalled.bearing[..], &recalled.clings[..]);
            history.commit(&recalled.recall, borne, place);
        }
        let mut step = Step {
            time_s: row.time_s,
            offset,
            force: pressed.force_along(&self.direction()),
            total_force: -pressed.force_on_skin() - shear,
            shear,
            slip_loss: sheared.map_or(0.0, |end| end.dissipated),
            area: totals.region_area.iter().sum(),
            peak_pressure: totals
                .pressure
                .iter()
                .fold(0.0, |most, p| f64::max(most, p.1)),
            region_force: totals.region_force,
            work: 0.0,
            pressure: Vec::new(),
            loads: Vec::new(),
            has_converged: pressed.has_converged(),
        };
        match self.keep {
            Keep::Totals => {}
            Keep::Pressure => step.pressure = totals.pressure,
            Keep::Loads => step.loads = loads_of(skin, pressed),
        }
        if let Some(last) = &self.last {
            let moved = self.direction() * (offset - last.step.offset) + row.slide - last.row.slide;
            let push = -0.5 * (last.step.total_force + step.total_force);
            step.work = last.step.work + push.dot(&moved);
            step.slip_loss += last.step.slip_loss;
        }
        Some(step)
    }
}

impl Pressing<'_> {
    /// Takes the next row of a walk: hand and product stand as `stand` says, and `row` asks for the rest, in the product's
    /// own frame. A product that stands where it should needs `Demand::Offset(0.0)`.
    ///
    /// Other presses and walks may come between the rows, which may be taken in any workspace. Where the posture has moved
    /// against the product since the last row, remembered loads turn with the skin and friction feels the travel; the step's
    /// work is that of offset and slide alone.
    ///
    /// # Errors
    /// [`ContactError::Protocol`] naming the row and what is wrong, those of a press, or `Cancelled`; the walk then stands
    /// where it stood.
    pub fn advance(
        &mut self,
        walk: &mut Walk,
        (stand, row): (&Stand<'_>, &Row),
        control: &Control,
    ) -> Result<Step, ContactError> {
        row.check((walk.rows, walk.last.as_ref().map(|last| last.row.time_s)))?;
        let (then, now) = (&walk.effects, self.skin.effects());
        if then.len() != now.len() || !then.iter().zip(now).all(|(a, b)| a.acts_as(b)) {
            return Err(ContactError::Protocol {
                row: walk.rows,
                problem: "the skin's effects have changed since the walk began; begin anew"
                    .to_owned(),
            });
        }
        let mut next = walk.clone();
        next.face(self.skin, stand)?;
        let step = self.take(&mut next, (stand.product, row), control)?;
        *walk = next;
        Ok(step)
    }

    /// Takes a row where the walk stands.
    pub(super) fn take(
        &mut self,
        walk: &mut Walk,
        place: (&Product, &Row),
        control: &Control,
    ) -> Result<Step, ContactError> {
        std::mem::swap(&mut self.workspace.history, &mut walk.history);
        std::mem::swap(&mut self.workspace.warm_start, &mut walk.warm_start);
        let step = self.step(walk, place, control);
        std::mem::swap(&mut self.workspace.history, &mut walk.history);
        std::mem::swap(&mut self.workspace.warm_start, &mut walk.warm_start);
        let row = walk.rows;
        let step = step.map_err(|error| match error {
            ContactError::Cancelled => error,
            other => ContactError::Protocol {
                row,
                problem: other.to_string(),
            },
        })?;
        walk.rows += 1;
        Ok(step)
    }

    fn step(
        &mut self,
        walk: &mut Walk,
        (product, row): (&Product, &Row),
        control: &Control,
    ) -> Result<Step, ContactError> {
        let quiet = Control {
            cancelled: control.cancelled,
            progress: &|_, _| {},
        };
        if walk.last.is_none() {
            walk.friction_memory.travel = row.slide;
        }
        let (offset, mut pressed) = walk.press(self, (product, row), &quiet)?;
        let motion = Drag::Motion {
            travel: row.slide,
            turn: Vec3::zeros(),
        };
        friction::drag(self, &mut pressed, (motion, &walk.friction_memory), &quiet)?;
        walk.friction_memory = friction::friction_memory(&pressed, row.slide);
        pressed.start_next(self, offset);
        let step = walk
            .keep(self, row, (offset, &pressed))
            .ok_or(ContactError::EmptyProtocol)?;
        let is_held = |row: &Row| matches!(row.demand, Demand::Force(newton) if newton > 0.0);
        let held = walk
            .last
            .as_ref()
            .filter(|last| is_held(row) && is_held(&last.row));
        let pace = held.map_or(0.0, |last| {
            (offset - last.step.offset) / (row.time_s - last.row.time_s)
        });
        walk.last = Some(LastRow {
            row: *row,
            step: step.clone(),
            pressed,
            pace,
        });
        Ok(step)
    }
}

/// The posture seen from a product that was moved by `slide`.
fn slid(posed: &Mesh, slide: Vec3) -> Result<Cow<'_, Mesh>, ContactError> {
    if slide == Vec3::zeros() {
        return Ok(Cow::Borrowed(posed));
    }
    let positions = posed.positions().iter().map(|p| p - slide).collect();
    let moved = posed
        .with_positions(positions)
        .map_err(ContactError::Hand)?;
    Ok(Cow::Owned(moved))
}
