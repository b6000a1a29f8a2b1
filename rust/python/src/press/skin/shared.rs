//! A skin that several threads press at once: the skin of now, and the workspaces that wait for a press.

use crate::conversion::errors::Failure;
use crate::press::product::Surface;
use crate::press::requests::{Followed, Request, Target};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use thenar_contact::{ContactError, Control, Press, Run, Skin, WarmStart, Workspace};
use thenar_surface::Vec3;

/// Workspaces kept while nothing presses: a large contact takes some hundred MB in each.
const MOST_IDLE: usize = 2;

/// Displacement of a soft grip by vertex of the product, mm, and the product as it is pressed.
pub(crate) type PressedGrip = (Vec<Vec3>, Arc<thenar_surface::Product>);

pub(crate) struct Inner {
    state: Mutex<State>,
    /// The product of the last press from arrays: pressing it again needs no new tree.
    last_product: Mutex<Option<Arc<thenar_surface::Product>>>,
}

/// Locked for moments only, never while something is pressed.
struct State {
    skin: Arc<Skin>,
    /// Workspaces of the skin's response; the one that was used last is the last.
    idle: Vec<Workspace>,
    /// The last result, where a warm press starts in whatever workspace it gets.
    last: WarmStart,
}

impl Inner {
    pub(crate) fn new(skin: Skin) -> Inner {
        let state = State {
            skin: Arc::new(skin),
            idle: Vec::new(),
            last: WarmStart::default(),
        };
        Inner {
            state: Mutex::new(state),
            last_product: Mutex::new(None),
        }
    }

    /// The skin of now; a later change makes another.
    pub(crate) fn skin(&self) -> Arc<Skin> {
        Arc::clone(&self.state().skin)
    }

    /// Goes on with another skin of the same hand.
    pub(super) fn change(&self, skin: Skin) {
        let state = &mut *self.state();
        if !skin.shares_response(&state.skin) {
            (state.idle, state.last) = (Vec::new(), WarmStart::default());
        }
        state.skin = Arc::new(skin);
    }

    pub(super) fn press(
        &self,
        request: Request,
        control: &Control,
    ) -> Result<(thenar_contact::Contact, Option<PressedGrip>), Failure> {
        let started = Instant::now();
        (control.progress)("product", 0.0);
        let product = self.product(request.target)?;
        let prepared_in = started.elapsed().as_secs_f64();
        let press = Press {
            product: &product,
            posed: request.posed.as_deref(),
            force: request.force,
            drag: request.drag,
            start: request.start,
            unsolved: request.unsolved,
        };
        let (skin, mut workspace) = self.begin();
        let mut pressing = workspace.on(&skin);
        let found = match &request.grip {
            None => pressing
                .press(&press, control)
                .map(|contact| (contact, None)),
            Some(grip) => pressing
                .press_grip(&press, (&product, grip), control)
                .map(|found| (found.contact, Some((found.displacement, found.product)))),
        };
        self.end(workspace, State::keep_result);
        let (mut contact, grip) = found?;
        contact.seconds.insert(0, ("product", prepared_in));
        Ok((contact, grip))
    }

    pub(super) fn follow(
        &self,
        request: Followed,
        control: &Control,
    ) -> Result<thenar_contact::Course, Failure> {
        (control.progress)("product", 0.0);
        let product = self.product(request.target)?;
        let run = Run {
            product: &product,
            posed: request.posed.as_deref(),
            protocol: &request.protocol,
            keep: request.keep,
        };
        if let Some(effects) = request.effects {
            let skin = self.skin().with_effects(effects, control)?;
            return Ok(Workspace::default().on(&skin).run(&run, control)?);
        }
        let (skin, mut workspace) = self.begin();
        let course = workspace.on(&skin).run(&run, control);
        self.end(workspace, |_, _| ());
        Ok(course?)
    }

    /// The product to press, its tree made unless it is that of the last press.
    pub(super) fn product(&self, target: Target) -> Result<Arc<thenar_surface::Product>, Failure> {
        match target {
            Target::Prepared(product) => Ok(product),
            Target::Surface(surface) => self.product_of(surface),
        }
    }

    fn product_of(&self, surface: Surface) -> Result<Arc<thenar_surface::Product>, Failure> {
        let last = || {
            self.last_product
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
        };
        let known = last().clone();
        if let Some(product) = known.filter(|product| {
            product.mesh().triangles() == surface.triangles
                && product.mesh().positions() == surface.vertices
        }) {
            return Ok(product);
        }
        let product = surface.into_product().map_err(ContactError::Product)?;
        *last() = Some(Arc::clone(&product));
        Ok(product)
    }

    /// The skin of now with a workspace for one press of it, the one that was used last where it is idle.
    fn begin(&self) -> (Arc<Skin>, Workspace) {
        let state = &mut *self.state();
        let mut workspace = state.idle.pop().unwrap_or_default();
        workspace.on(&state.skin);
        workspace.start_from(state.last.clone());
        (Arc::clone(&state.skin), workspace)
    }

    /// Takes a workspace back, unless the skin has another response by now. A press that panicked loses its workspace.
    fn end(&self, workspace: Workspace, keep: impl FnOnce(&mut State, &Workspace)) {
        let state = &mut *self.state();
        if !workspace.is_of(&state.skin) {
            return;
        }
        keep(state, &workspace);
        if state.idle.len() == MOST_IDLE {
            state.idle.remove(0);
        }
        state.idle.push(workspace);
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Keeps where a press ended for the next warm one.
    fn keep_result(&mut self, workspace: &Workspace) {
        self.last = workspace.warm_start();
    }
}
