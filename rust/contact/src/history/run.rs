//! Conducts a protocol: one press a row, each in the light of those before it.

use thenar_surface::{GapLimits, Mesh, Product, Vec3, vertex_normals};

use super::course::{Course, Keep, Step};
use super::protocol::{Demand, Protocol};
use super::state::History;
use crate::force_control::{MOST_TRAVEL, find_offset, mean_normal};
use crate::instrument::loads_of;
use crate::interface::friction::{self, Grasp};
use crate::interface::stick_slip::Dragged;
use crate::memory::Last;
use crate::press::{Drag, ForceTarget};
use crate::simulate::{Pressed, Seconds};
use crate::skin::Skin;
use crate::summary::{summarize, totals};
use crate::zone::limits;
use crate::{ContactError, Control};

/// How far the product is taken off the skin where no force is asked for, mm.
const CLEARANCE: f64 = 1.0;
/// Gap at which the product counts as touching, mm.
const TOUCH: f64 = 1e-6;
/// Most steps of the approach to first touch.
const MOST_APPROACHES: usize = 200;

/// A protocol with what it is done to.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// The product, in the frame of the posed positions.
    pub product: &'a Product,
    /// Posed positions, mm, one per prepared vertex; None: the rest pose.
    pub posed: Option<&'a [Vec3]>,
    /// What is done.
    pub protocol: &'a Protocol,
    /// What to keep of every step.
    pub keep: Keep,
}

impl Skin {
    /// Follows a protocol from rest, with the effects that are switched on; the tissue remembers from row to row.
    ///
    /// The first row is reached at once; between rows loads grow in straight lines, so rows must be close enough in time for
    /// the fastest thing to be seen.
    ///
    /// # Errors
    /// [`ContactError::Protocol`] naming the row, those of a press, or `Cancelled`. The skin stays usable after any of them.
    pub fn run(&mut self, run: &Run<'_>, control: &Control) -> Result<Course, ContactError> {
        run.protocol.validate()?;
        let posed = self.posed(run.posed)?;
        self.memory.last = Last::default();
        self.memory.triangle.clear();
        self.memory.offset = 0.0;
        self.memory.pulls.clear();
        self.history = History::new(
            self.effects(),
            self.tissue.materials.len(),
            self.sites.len(),
        );
        let course = self.follow(&posed, run, control);
        self.history = None;
        course
    }

    fn follow(
        &mut self,
        posed: &Mesh,
        run: &Run<'_>,
        control: &Control,
    ) -> Result<Course, ContactError> {
        let direction = match run.protocol.direction {
            Some(given) => given
                .try_normalize(0.0)
                .filter(|d| d.iter().all(|c| c.is_finite())),
            None => Some(mean_normal(self, posed, run.product)?),
        };
        let direction = direction.ok_or(ContactError::Direction)?;
        let needs_touch =
            |demand: Demand| matches!(demand, Demand::Depth(_)) || demand == Demand::Force(0.0);
        let touch = match run.protocol.rows.iter().any(|row| needs_touch(row.demand)) {
            true => Some(first_touch(self, (posed, run.product), direction)?),
            false => None,
        };
        let mut walk = Walk {
            run,
            posed,
            direction,
            touch,
            control,
            grasp: Grasp {
                travel: run.protocol.rows[0].slide,
                ..Grasp::default()
            },
        };
        let mut steps: Vec<Step> = Vec::with_capacity(run.protocol.rows.len());
        let mut before: Option<(Vec3, Vec3)> = None;
        let mut last = None;
        for row in 0..run.protocol.rows.len() {
            control.step("protocol", row as f64 / run.protocol.rows.len() as f64)?;
            let (offset, pressed) = walk.step(self, row)?;
            let mut step = walk.keep(self, row, (offset, &pressed));
            let place = direction * offset + run.protocol.rows[row].slide;
            let push = -step.total_force;
            if let (Some((force, at)), Some(previous)) = (before, steps.last()) {
                step.work = previous.work + 0.5 * (force + push).dot(&(place - at));
                step.slip_loss += previous.slip_loss;
            }
            before = Some((push, place));
            steps.push(step);
            last = Some((offset, pressed));
        }
        let (offset, mut pressed) = last.ok_or(ContactError::EmptyProtocol)?;
        friction::move_skin(self, run.product, &mut pressed);
        let slide = run.protocol.rows[run.protocol.rows.len() - 1].slide;
        let posed = slid(posed, slide)?;
        let mut contact = summarize(self, (&posed, run.product), &pressed, (offset, direction));
        if contact.center_of_pressure != Vec3::zeros() {
            contact.center_of_pressure += slide;
        }
        contact.total_moment += slide.cross(&contact.total_force);
        control.step("protocol", 1.0)?;
        Ok(Course {
            steps,
            direction,
            touch_offset: touch,
            last: contact,
        })
    }
}

struct Walk<'a> {
    run: &'a Run<'a>,
    posed: &'a Mesh,
    direction: Vec3,
    touch: Option<f64>,
    control: &'a Control<'a>,
    /// What friction remembers.
    grasp: Grasp,
}

impl Walk<'_> {
    /// Takes one row, and keeps what the tissue remembers of it.
    fn step(&mut self, skin: &mut Skin, row: usize) -> Result<(f64, Pressed), ContactError> {
        let rows = &self.run.protocol.rows;
        if let Some(history) = skin.history.as_mut() {
            history.seconds = if row > 0 {
                rows[row].time_s - rows[row - 1].time_s
            } else {
                0.0
            };
        }
        let of_row = |error| match error {
            ContactError::Cancelled => error,
            other => ContactError::Protocol {
                row,
                problem: other.to_string(),
            },
        };
        let (offset, mut pressed) = self.press(skin, row).map_err(of_row)?;
        let motion = Drag::Motion {
            travel: rows[row].slide,
            turn: Vec3::zeros(),
        };
        let quiet = Control {
            cancelled: self.control.cancelled,
            progress: &|_, _| {},
        };
        friction::drag(skin, &mut pressed, (motion, &self.grasp), &quiet).map_err(of_row)?;
        self.grasp = friction::grasp(&pressed, rows[row].slide);
        skin.remember(&pressed, offset);
        Ok((offset, pressed))
    }

    fn press(&self, skin: &mut Skin, row: usize) -> Result<(f64, Pressed), ContactError> {
        let moment = &self.run.protocol.rows[row];
        let quiet = Control {
            cancelled: self.control.cancelled,
            progress: &|_, _| {},
        };
        let mut seconds = Seconds::new();
        let slid = slid(self.posed, moment.slide)?;
        let touch = self.touch.unwrap_or(0.0);
        let offset = match moment.demand {
            Demand::Offset(offset) => offset,
            Demand::Depth(depth) => touch + depth,
            Demand::Force(0.0) => touch - CLEARANCE,
            Demand::Force(newton) => {
                let target = ForceTarget {
                    newton,
                    direction: Some(self.direction),
                };
                let (offset, _, pressed) = find_offset(
                    skin,
                    (&slid, self.run.product),
                    target,
                    (&quiet, &mut seconds),
                )?;
                return Ok((offset, pressed));
            }
        };
        let shift = self.direction * offset;
        let pressed = skin.press_at(&slid, (self.run.product, shift), (&quiet, &mut seconds))?;
        Ok((offset, pressed))
    }

    /// The totals of a step, and the memory of it.
    fn keep(&self, skin: &mut Skin, row: usize, (offset, pressed): (f64, &Pressed)) -> Step {
        let totals = totals(skin, self.posed, pressed);
        let sheared = pressed.shear.as_ref().map(|shear| &shear.end);
        let shear = sheared.map_or_else(Vec3::zeros, Dragged::force);
        if let (Some(history), Some(recalled)) = (skin.history.as_mut(), &pressed.recalled) {
            history.commit(
                &recalled.recall,
                &recalled.bearing,
                (&skin.sites, &totals.region_area),
            );
        }
        Step {
            time_s: self.run.protocol.rows[row].time_s,
            offset,
            force: pressed.force_along(&self.direction),
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
            pressure: match self.run.keep {
                Keep::Pressure => totals.pressure,
                Keep::Totals | Keep::Loads => Vec::new(),
            },
            loads: match self.run.keep {
                Keep::Loads => loads_of(skin, pressed),
                Keep::Totals | Keep::Pressure => Vec::new(),
            },
            has_converged: pressed.solved.convergence.has_converged,
        }
    }
}

/// The posture seen from a product that was moved by `slide`.
fn slid(posed: &Mesh, slide: Vec3) -> Result<std::borrow::Cow<'_, Mesh>, ContactError> {
    if slide == Vec3::zeros() {
        return Ok(std::borrow::Cow::Borrowed(posed));
    }
    let positions = posed.positions().iter().map(|p| p - slide).collect();
    let moved = posed
        .with_positions(positions)
        .map_err(ContactError::Hand)?;
    Ok(std::borrow::Cow::Owned(moved))
}

/// Travel along `direction` at which the product first touches the skin, mm.
///
/// # Errors
/// [`ContactError::OutOfReach`] if the product passes the skin by.
fn first_touch(
    skin: &Skin,
    (posed, product): (&Mesh, &Product),
    direction: Vec3,
) -> Result<f64, ContactError> {
    let normals = vertex_normals(posed);
    let reach = GapLimits {
        cut_off_mm: MOST_TRAVEL,
        ..limits()
    };
    let vertices = (0..skin.sites.len())
        .filter(|&s| skin.sites.is_skin(s))
        .map(|s| skin.sites.vertex[s] as usize);
    let vertices: Vec<usize> = vertices.collect();
    let facing: Vec<Vec3> = vertices.iter().map(|&v| normals[v]).collect();
    let (mut offset, mut least) = (0.0f64, f64::INFINITY);
    for _ in 0..MOST_APPROACHES {
        let points: Vec<Vec3> = vertices
            .iter()
            .map(|&v| posed.positions()[v] - direction * offset)
            .collect();
        let gaps = product.gaps(&points, Some(&facing), reach);
        least = gaps
            .iter()
            .flatten()
            .map(|g| g.distance)
            .fold(f64::INFINITY, f64::min);
        if least.abs() < TOUCH || offset.abs() > MOST_TRAVEL || least.is_infinite() {
            break;
        }
        offset += least;
    }
    if least.abs() < 1e3 * TOUCH {
        Ok(offset)
    } else {
        Err(ContactError::OutOfReach {
            cut_off_mm: MOST_TRAVEL,
        })
    }
}
