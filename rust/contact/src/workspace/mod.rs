//! The workspace of presses: every byte that a press writes. Dropping it changes no fresh result.

pub mod live_cache;
pub mod posture;
pub mod problem;
pub mod warm_start;

use std::sync::{Arc, Weak};

use crate::history::tissue_memory::TissueMemory;
use crate::interface::shear_response::Pairs;
use crate::response::quantized_rows::QuantizedRows;
use crate::response::rows::Response;
use crate::skin::prepare::Skin;
use crate::soft_grip::yielding::Covered;
use live_cache::{LiveContact, LiveField, NearFields};
use posture::PostureCache;
use problem::ZoneProblem;
use warm_start::WarmStart;

/// Scratch of presses, one press at a time: storage, caches of the last press, and where the next one may start.
///
/// It serves any skin. What it holds belongs to the response of the skin that was pressed last; a skin of another response
/// finds it empty. Skins that differ only in effects or materials that leave the response as it is share what it holds.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// The response that all of this belongs to.
    response: Weak<Response>,
    /// The last active zone and its linear problem.
    pub(crate) problem: ZoneProblem,
    /// Response rows of live presses.
    pub(crate) quantized: QuantizedRows,
    /// Near-field couplings of the last live press.
    pub(crate) near: NearFields,
    /// Where the last solve ended.
    pub(crate) warm_start: WarmStart,
    /// The last posture, and what was measured of it.
    pub(crate) posture: PostureCache,
    /// Displacement field of the last live press.
    pub(crate) live_field: LiveField,
    /// Solution of the last live press by site.
    pub(crate) live_contact: LiveContact,
    /// Kernels of shear between the sites that were last in contact.
    pub(crate) pairs: Pairs,
    /// Memory of the tissue, while a row of a protocol is solved.
    pub(crate) history: Option<TissueMemory>,
    /// The soft grip on the product, while one is pressed.
    pub(crate) grip: Option<Arc<Covered>>,
}

impl Workspace {
    /// The skin ready to be pressed in this workspace, which is emptied if it was used with another response.
    pub fn on<'a>(&'a mut self, skin: &'a Skin) -> Pressing<'a> {
        if !self.is_of(skin) {
            *self = Workspace {
                response: Arc::downgrade(&skin.response),
                ..Workspace::default()
            };
        }
        Pressing {
            skin,
            workspace: self,
        }
    }

    /// True if what it holds belongs to the response of this skin.
    pub fn is_of(&self, skin: &Skin) -> bool {
        std::ptr::eq(self.response.as_ptr(), Arc::as_ptr(&skin.response))
    }

    /// Where the next warm press starts: the last result.
    pub fn warm_start(&self) -> WarmStart {
        self.warm_start.clone()
    }

    /// Lets the next warm press start from the last result of another workspace of the same skin.
    pub fn start_from(&mut self, warm_start: WarmStart) {
        self.warm_start = warm_start;
    }
}

/// A prepared skin and the workspace that presses of it write to, as one: what [`Workspace::on`] makes.
#[derive(Debug)]
pub struct Pressing<'a> {
    /// Only read.
    pub(crate) skin: &'a Skin,
    /// Written.
    pub(crate) workspace: &'a mut Workspace,
}

impl Pressing<'_> {
    /// The same for a shorter time.
    pub(crate) fn reborrow(&mut self) -> Pressing<'_> {
        Pressing {
            skin: self.skin,
            workspace: self.workspace,
        }
    }
}
