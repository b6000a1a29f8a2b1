//! The mesh model of a study: skin, tools and caches; predicts every recording's samples in the recording's own terms.

use std::sync::Arc;

use thenar_contact::effects::Stage;
use thenar_contact::instrument::Placement;
use thenar_contact::{ActiveEffect, Control, Demand, Material};
use thenar_recordings::Study;
use thenar_recordings::study::{Indenter, Site};
use thenar_surface::{Product, Vec3};

use crate::errors::InferenceError;
use crate::forward::mesh::at_skin::AtSkin;
use crate::forward::mesh::mat_reading::Reader;
use crate::forward::mesh::nuisance::{At, Nuisance};
use crate::forward::mesh::press_key::Key;
use crate::forward::mesh::press_table::Basis;
use crate::forward::mesh::scan_shapes::{Scanned, Shapes};
use crate::forward::setup::study_skin::Tissue;
use crate::observe::first_touch::late_of;
use crate::observe::measured::Measured;
use crate::observe::study::Observed;

/// Depth that is added to the deepest of a ladder for a contact zero that moves, mm and share.
const DEPTH_MARGIN: (f64, f64) = (0.1, 0.05);
/// The same, at least, over how late depths begin.
const LATE_MARGIN: f64 = 1.5;
/// Part of the thinnest tissue, and of a ball's radius, to which that reaches at most.
const MOST_LATE: (f64, f64) = (0.6, 0.9);
/// Plates and rods reach this much beyond the skin, at most this far from the site, mm: other fingers are not in the way.
const REACH: (f64, f64) = (1.2, 60.0);

/// A tool at a place.
pub struct Place {
    pub(crate) title: String,
    pub(crate) indenter: String,
    pub(crate) site: String,
    pub(crate) tool: Product,
    /// Radius, mm, of a tool that is a ball.
    pub(crate) ball: Option<f64>,
    pub(crate) direction: Vec3,
    /// mm; of all its recordings.
    pub(crate) deepest: f64,
    /// How late its depths begin, about, mm: so much deeper it is pressed than they say.
    late: f64,
    pub(crate) kept: Vec<(Key, Arc<Basis>)>,
    pub(crate) shapes: Shapes,
}

/// What a protocol was followed with, and what came of it.
pub struct Followed {
    pub(crate) key: Key,
    pub(crate) demands: Vec<Demand>,
    pub(crate) placement: Placement,
    pub(crate) used_mm: f64,
    pub(crate) at_skin: AtSkin,
}

/// A study made ready to be simulated again and again.
pub struct Replay {
    /// The skin.
    pub tissue: Tissue,
    /// The recordings.
    pub(crate) observed: Observed,
    pub(crate) places: Vec<Place>,
    /// By recording: number of its tool at its site.
    pub(crate) place_of: Vec<usize>,
    pub(crate) readers: Vec<Option<Reader>>,
    /// The skin as scans are held against it, if there are any.
    pub(crate) scanned: Option<Scanned>,
    /// Effects on the skin.
    pub effects: Vec<ActiveEffect>,
    /// By recording: protocols followed, the last ones last.
    pub followed: Vec<Vec<Followed>>,
    /// By recording: loading travel that the tissue has behind it as the recording begins, mm; what softens by use remembers it.
    pub(crate) used_before_mm: Vec<f64>,
    /// Effects of the instrument.
    pub instrument: Vec<ActiveEffect>,
}

impl Replay {
    /// Prepares skin, tools and mats.
    ///
    /// # Errors
    /// [`InferenceError`] naming the skin, the region or the tool that cannot be used, or `Cancelled`.
    pub fn new(
        study: &Study,
        observed: Observed,
        control: &Control<'_>,
    ) -> Result<Replay, InferenceError> {
        let mut tissue = crate::forward::setup::study_skin::tissue(&study.skin, control)?;
        let (mut places, mut place_of) = (Vec::<Place>::new(), Vec::new());
        for measured in &observed.measured {
            let at = places
                .iter()
                .position(|p| p.indenter == measured.indenter && p.site == measured.site);
            let at = match at {
                Some(at) => at,
                None => {
                    places.push(place(study, measured, tissue.extent)?);
                    places.len() - 1
                }
            };
            let depths = measured.moments.iter().map(|m| m.depth_mm);
            let deepest = depths.filter(|d| d.is_finite()).fold(0.0, f64::max);
            places[at].deepest = places[at].deepest.max(deepest);
            places[at].late = places[at].late.max(late_of(measured));
            place_of.push(at);
        }
        let readers = observed
            .measured
            .iter()
            .map(|m| {
                m.mat
                    .as_ref()
                    .map(|mat| Reader::new(mat, &m.name))
                    .transpose()
            })
            .collect::<Result<Vec<Option<Reader>>, InferenceError>>()?;
        for place in &places {
            let indenter = study.indenters.iter().find(|i| i.name == place.indenter);
            let told = indenter.and_then(|indenter| {
                crate::forward::setup::indenter::too_deep(indenter, place.deepest)
            });
            tissue.notes.extend(told);
        }
        for place in &mut places {
            // Where no depth is known a force is sought; soft tissue yields half its thickness at most.
            if place.deepest == 0.0 {
                place.deepest = 0.5 * thinnest(&tissue.materials).min(8.0);
            }
            place.deepest = reach(place, thinnest(&tissue.materials));
        }
        let mesh = &study.skin.mesh;
        for place in &places {
            let pressed = (&place.tool, place.direction * place.deepest);
            if crate::forward::setup::skin_rim::presses_rim(
                (&mesh.positions, &mesh.triangles),
                pressed,
            ) {
                tissue.notes.push(format!(
                    "{} presses the rim of the study's skin: the model's tissue goes on beyond it, and where the sample ends there its \
                     free sides make it softer than its modulus",
                    place.title
                ));
            }
        }
        let has_scan = observed.measured.iter().any(|m| m.scan.is_some());
        let scanned = has_scan.then(|| Scanned::new(&mesh.positions, &mesh.triangles));
        let followed = observed.measured.iter().map(|_| Vec::new()).collect();
        let used_before_mm = vec![0.0; observed.measured.len()];
        Ok(Replay {
            tissue,
            followed,
            used_before_mm,
            observed,
            places,
            place_of,
            readers,
            scanned: scanned.transpose()?,
            effects: Vec::new(),
            instrument: Vec::new(),
        })
    }

    /// Effects switched on in every later prediction, in place of those before: those of the skin and those of the instrument.
    ///
    /// # Errors
    /// What the contact model says of an effect's numbers.
    pub fn set_effects(
        &mut self,
        effects: &[ActiveEffect],
        control: &Control<'_>,
    ) -> Result<(), InferenceError> {
        let is_instrument = |e: &&ActiveEffect| e.entry().is_instrument();
        let of_skin: Vec<ActiveEffect> = effects
            .iter()
            .filter(|e| !is_instrument(e))
            .cloned()
            .collect();
        if of_skin != self.effects {
            let changed = self.tissue.skin.with_effects(of_skin.clone(), control);
            self.tissue.skin = changed.map_err(InferenceError::of_contact("the effects"))?;
            self.effects = of_skin;
        }
        self.instrument = effects.iter().filter(is_instrument).cloned().collect();
        Ok(())
    }

    /// True if the model with its effects remembers, so that each protocol is followed as it was.
    pub fn remembers(&self) -> bool {
        self.effects.iter().any(remembers)
    }

    /// Effects that act the same at all times.
    pub(crate) fn lasting(&self) -> Vec<ActiveEffect> {
        self.effects
            .iter()
            .filter(|e| !remembers(e))
            .cloned()
            .collect()
    }

    /// Prepares the skin for these materials and effects, if it is not.
    pub(crate) fn turn_skin(
        &mut self,
        key: &Key,
        (what, control): (&str, &Control<'_>),
    ) -> Result<(), InferenceError> {
        let skin = &mut self.tissue.skin;
        if skin.effects() != key.effects {
            let changed = skin.with_effects(key.effects.clone(), control);
            *skin = changed.map_err(InferenceError::of_contact(what))?;
        }
        if skin.materials() != key.materials {
            let changed = skin.with_materials(&key.materials, control);
            *skin = changed.map_err(InferenceError::of_contact(what))?;
        }
        Ok(())
    }

    /// Number of tools at places.
    pub fn places(&self) -> usize {
        self.places.len()
    }

    /// Adds a tool at a site that no recording used, to be pressed as deep as `deepest` (mm); its number among the places.
    ///
    /// # Errors
    /// [`InferenceError`] naming a tool that cannot be used.
    pub fn add_place(
        &mut self,
        (indenter, site): (&Indenter, &Site),
        deepest: f64,
    ) -> Result<usize, InferenceError> {
        let mut place = Place::new(indenter, site, self.tissue.extent)?;
        place.deepest = deepest;
        self.places.push(place);
        Ok(self.places.len() - 1)
    }

    /// Takes away the tool that was added last.
    pub(crate) fn drop_place(&mut self) {
        self.places.pop();
    }

    /// Depth that a recording's ladder reaches, mm.
    pub fn deepest(&self, recording: usize) -> f64 {
        self.places[self.place_of[recording]].deepest
    }

    /// Regions that bear force in some recording in use, at the deepest rung of its ladder.
    ///
    /// # Errors
    /// Those of a prediction.
    pub fn touched(
        &mut self,
        is_used: &[bool],
        control: &Control<'_>,
    ) -> Result<Vec<bool>, InferenceError> {
        let regions = self.tissue.regions.len();
        if regions == 1 {
            return Ok(vec![true]);
        }
        let materials = self.tissue.materials.clone();
        let mut touched = vec![false; regions];
        for at in 0..self.places.len() {
            let uses = |r: usize| is_used[r] && self.place_of[r] == at;
            if (0..is_used.len()).any(uses) {
                let (basis, _) = self.basis(at, &materials, control)?;
                for (region, touches) in basis.touched.iter().enumerate() {
                    touched[region] |= touches;
                }
            }
        }
        Ok(touched)
    }

    /// Predictions for every sample of a recording, in its units.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub fn predict(
        &mut self,
        recording: usize,
        (materials, nuisance): (&[Material], &Nuisance),
        control: &Control<'_>,
    ) -> Result<Vec<f64>, InferenceError> {
        if self.observed.measured[recording].samples.is_empty() {
            return Ok(Vec::new());
        }
        let at_skin = match self.remembers() {
            true => self.follow(recording, (materials, nuisance), control)?,
            false => self.look_up(recording, (materials, nuisance), control)?,
        };
        self.shown(recording, nuisance, at_skin)
    }

    /// Predictions near others that are known: of a model that remembers, as one without memory changes from `from` to `to`.
    ///
    /// A protocol is long to follow, and the derivatives that a fit takes steps by need not be exact.
    ///
    /// # Errors
    /// As [`Replay::predict`].
    pub(crate) fn predict_near(
        &mut self,
        recording: usize,
        (from, to): (At<'_>, At<'_>),
        control: &Control<'_>,
    ) -> Result<Vec<f64>, InferenceError> {
        if !self.remembers() || self.observed.measured[recording].samples.is_empty() {
            return self.predict(recording, to, control);
        }
        let known = self.follow(recording, from, control)?;
        let base = self.look_up(recording, from, control)?;
        let moved = self.look_up(recording, to, control)?;
        self.shown(recording, to.1, known.moved(&base, &moved))
    }
}

fn remembers(effect: &ActiveEffect) -> bool {
    effect.amplitude > 0.0 && matches!(effect.entry().stage, Stage::History | Stage::Interface)
}

/// Least thickness of these tissues, mm.
pub(crate) fn thinnest(materials: &[Material]) -> f64 {
    let all = materials.iter().map(|m| m.thickness_mm);
    all.fold(f64::INFINITY, f64::min)
}

/// Depth that the ladder of a place reaches, mm, for the deepest of its recordings.
fn reach(place: &Place, thinnest: f64) -> f64 {
    let usual = place.deepest * (1.0 + DEPTH_MARGIN.1) + DEPTH_MARGIN.0 * place.deepest.min(1.0);
    let late = place.deepest + (LATE_MARGIN * place.late).min(place.deepest);
    let ball = place.ball.unwrap_or(f64::INFINITY);
    usual.max(late.min(MOST_LATE.0 * thinnest).min(MOST_LATE.1 * ball))
}

fn place(study: &Study, measured: &Measured, extent: f64) -> Result<Place, InferenceError> {
    let (name, at) = (&measured.indenter, &measured.site);
    let indenter = study.indenters.iter().find(|i| i.name == *name);
    let site = study.sites.iter().find(|s| s.name == *at);
    let (Some(indenter), Some(site)) = (indenter, site) else {
        return Err(InferenceError::Placing {
            indenter: name.clone(),
            site: at.clone(),
            problem: "one of them is not defined; add it to the study".into(),
        });
    };
    Place::new(indenter, site, extent)
}

impl Place {
    fn new(indenter: &Indenter, site: &Site, extent: f64) -> Result<Place, InferenceError> {
        let reach = (REACH.0 * extent).min(REACH.1);
        Ok(Place {
            title: format!("the indenter '{}' at site '{}'", indenter.name, site.name),
            indenter: indenter.name.clone(),
            site: site.name.clone(),
            tool: crate::forward::setup::indenter::tool(indenter, site, reach)?,
            ball: crate::forward::setup::indenter::ball(indenter),
            direction: site.direction.into(),
            deepest: 0.0,
            late: 0.0,
            kept: Vec::new(),
            shapes: Shapes::default(),
        })
    }
}
