//! Conducts a press: position or force control, drag, fields. `at_position` holds the stages of one position.

pub mod at_position;
pub mod deep_tissue;
pub mod displacement_field;
pub mod effective_modulus;
pub mod force_control;
pub mod linear_problem;
pub mod live;
pub mod paper_model;
pub mod pressed;
pub mod relinearize;
pub mod setting;
pub mod solution;
pub mod zone_response;
pub mod zone_state;
pub mod zone_steps;

use std::time::Instant;

use thenar_surface::Vec3;

use crate::api::{Press, Start, Unsolved};
use crate::detection::gaps::Stand;
use crate::fields::merged_vertices::move_out_of_product;
use crate::fields::result::Contact;
use crate::fields::summary::summarize;
use crate::fields::warnings::Warning;
use crate::interface::friction;
use crate::interface::friction_state::FrictionMemory;
use crate::solve::Accuracy;
use crate::stage_times::{Seconds, Watch, add_time};
use crate::workspace::Pressing;
use crate::workspace::warm_start::WarmStart;
use crate::{ContactError, Control};
use at_position::press_at;
use force_control::find_offset;
use pressed::Travel;

/// Share of a force target that may be missed without a word.
const FORCE_MISS: f64 = 1e-3;

impl Pressing<'_> {
    /// Presses the prepared skin, in rest or posed, against a product.
    ///
    /// # Errors
    /// [`ContactError`]: a posture that does not fit the skin, skin swallowed by the product, a force that is out of reach,
    /// or `Cancelled`. The workspace stays usable after any of them.
    pub fn press(&mut self, press: &Press<'_>, control: &Control) -> Result<Contact, ContactError> {
        if press.start == Start::Fresh {
            self.workspace.warm_start = WarmStart::default();
        }
        self.workspace.warm_start.pulls.clear();
        self.workspace.warm_start.accuracy = match press.start {
            Start::Live => Accuracy::Rough,
            Start::Fresh | Start::Warm => Accuracy::Full,
        };
        let mut seconds = Seconds::new();
        let skin = self.skin;
        let posed = skin.posed(press.posed)?;
        let watch = Watch {
            control,
            seconds: &mut seconds,
        };
        let (travel, mut pressed) = match press.force {
            None => {
                let here = Stand::as_given(press.product);
                let pressed = press_at(self, &posed, &here, watch)?;
                let direction = pressed
                    .force_on_skin()
                    .try_normalize(0.0)
                    .unwrap_or_else(Vec3::zeros);
                let offset = 0.0;
                (Travel { offset, direction }, pressed)
            }
            Some(target) => find_offset(self, (&posed, press.product), target, watch)?,
        };
        if press.unsolved == Unsolved::Refuse
            && let Some(refusal) = pressed.solved.refusal(skin)
        {
            // What is known of it starts no other press.
            self.workspace.warm_start = WarmStart::default();
            return Err(refusal);
        }
        if let Some(drag) = press.drag {
            let started = Instant::now();
            let from_rest = (drag, &FrictionMemory::default());
            friction::drag(self, &mut pressed, from_rest, control)?;
            friction::move_skin(skin, press.product, &mut pressed);
            add_time(&mut seconds, "friction", started);
        }
        control.step("fields", 0.0)?;
        let started = Instant::now();
        let mut contact = summarize(skin, (&posed, press.product), &pressed, travel);
        move_out_of_product(skin, press, travel.shift(), &mut contact);
        add_time(&mut seconds, "fields", started);
        if let Some(target) = press.force {
            let reached = pressed.force_along(&contact.direction);
            if (reached - target.newton).abs() > FORCE_MISS * target.newton {
                contact.warnings.push(Warning::ForceLeaps {
                    asked: target.newton,
                    reached,
                });
            }
        }
        contact.seconds = seconds;
        pressed.start_next(self, travel.offset);
        control.step("fields", 1.0)?;
        Ok(contact)
    }
}
