//! One press at a fixed position: detection, response weights, active zone, solve; memory and adhesion displace the posture.

use std::sync::Arc;
use std::time::Instant;

use thenar_surface::{Mesh, Product, Vec3};

use super::effective_modulus::{region_moduli, site_response};
use super::pressed::{PressMemory, Pressed};
use super::relinearize::solve;
use super::setting::SolveSetting;
use super::solution::SolvedContact;
use crate::detection::active_zone::{active_zone, check_resolution};
use crate::detection::gaps::{Detection, Stand, detect};
use crate::history::displaced_posture::{DisplacedPosture, TruePosture, displace, restore};
use crate::history::tissue_memory::MemoryStep;
use crate::interface::adhesion::{AdhesionLaw, MOST_SOLVES};
use crate::interface::pulls::{Adhesion, Pull, steady};
use crate::skin::prepare::Skin;
use crate::solve::Accuracy;
use crate::stage_times::{Watch, add_time};
use crate::workspace::Pressing;
use crate::workspace::warm_start::StartContact;
use crate::{ContactError, Control};

/// One position of the product, measured.
struct Position<'a> {
    product: &'a Product,
    /// Gaps of the true posture.
    detection: &'a Detection,
    /// Memory of the tissue, if a protocol is followed.
    recall: Option<&'a MemoryStep>,
    /// Response weight by site.
    weight: &'a [f64],
}

/// Presses the product where it stands.
///
/// # Errors
/// Those of a press; see [`Pressing::press`].
pub(crate) fn press_at(
    pressing: &mut Pressing<'_>,
    posed: &Mesh,
    stand: &Stand<'_>,
    watch: Watch<'_, '_>,
) -> Result<Pressed, ContactError> {
    let Watch { control, seconds } = watch;
    let skin = pressing.skin;
    // Stage 1: detection.
    control.step("distances", 0.0)?;
    let started = Instant::now();
    let detection = detect(pressing, posed, stand)?;
    add_time(seconds, "distances", started);
    // Stage 3 as far as it follows from the depths: moduli and response weights. Rows and couplings are made for the zone.
    let started = Instant::now();
    let relieved = pressing.workspace.grip.as_ref();
    let relieved = relieved.and_then(|grip| detection.relieved(skin, &grip.yields().taken));
    let borne = relieved.as_ref().unwrap_or(&detection);
    let mut shear_modulus = region_moduli(skin, borne);
    let recall = recall(pressing, &detection);
    if let Some(recall) = &recall {
        recall.soften(&mut shear_modulus);
    }
    let mut response = site_response(skin, &shear_modulus, borne);
    let attraction = AdhesionLaw::new(skin, &pressing.workspace.warm_start.pulls);
    add_time(seconds, "response", started);
    // Stages 2 to 4: active zone, coupling, solve; with adhesion until it settles.
    let started = Instant::now();
    let position = Position {
        product: stand.product,
        detection: &detection,
        recall: recall.as_ref(),
        weight: &response.weight,
    };
    let (mut solved, adhesion) = match &attraction {
        None => (
            solve_zone(pressing, &position, &[], control)?,
            Adhesion::none(),
        ),
        Some(attraction) => solve_adhesive(pressing, attraction, &position, control)?,
    };
    let modulus_at = &mut response.modulus;
    let recalled = recall.map(|recall| {
        let mut bearing = restore(skin, &mut solved, modulus_at, &recall);
        let mut clings = vec![false; recall.instantaneous.len()];
        for pull in &adhesion.pulls {
            bearing.push(elastic(skin, pull, &recall));
            clings[skin.sites.home_region(pull.site as usize) as usize] = true;
        }
        PressMemory {
            recall,
            bearing,
            clings,
        }
    });
    add_time(seconds, "solve", started);
    Ok(Pressed {
        detection,
        solved,
        shear_modulus,
        modulus_at: response.modulus,
        recalled,
        adhesion,
        shear: None,
        accuracy: pressing.workspace.warm_start.accuracy,
    })
}

/// The effect of tissue memory on this step, if a protocol is followed.
fn recall(pressing: &Pressing<'_>, detection: &Detection) -> Option<MemoryStep> {
    let history = pressing.workspace.history.as_ref()?;
    Some(history.recall(&detection.max_penetration, &pressing.skin.sites))
}

/// Finds the active zone and solves its contact, in the posture that memory and attraction make of the true one.
fn solve_zone(
    pressing: &mut Pressing<'_>,
    position: &Position<'_>,
    pulls: &[Pull],
    control: &Control,
) -> Result<SolvedContact, ContactError> {
    let skin = pressing.skin;
    let moved = displaced(pressing, position, pulls, control)?;
    let detection = moved
        .as_ref()
        .map_or(position.detection, |moved| &moved.detection);
    let zone = active_zone(pressing, detection);
    check_resolution(skin, &zone)?;
    let last = Arc::clone(&pressing.workspace.warm_start.last);
    let elastic = position.recall.map(|recall| StartContact {
        force: recall.elastic(&last.force, &skin.sites),
        travel: Vec::new(),
    });
    let start = elastic.as_ref().unwrap_or(&*last);
    let setting = SolveSetting {
        product: position.product,
        detection,
        weight: position.weight,
        start: (start.force.len() == skin.sites.len()).then_some(start),
        // What moves besides the product is solved to the end.
        accuracy: match &moved {
            None => pressing.workspace.warm_start.accuracy,
            Some(_) => Accuracy::Full,
        },
        spacing: skin.spacing,
    };
    let mut solved = solve(pressing, zone, &setting, control)?;
    if let Some(moved) = &moved {
        moved.add_to(&mut solved);
    }
    Ok(solved)
}

/// The posture displaced by remembered loads and by attraction; None where there are none.
fn displaced(
    pressing: &Pressing<'_>,
    position: &Position<'_>,
    pulls: &[Pull],
    control: &Control,
) -> Result<Option<DisplacedPosture>, ContactError> {
    if position.recall.is_none() && pulls.is_empty() {
        return Ok(None);
    }
    let skin = pressing.skin;
    let pulled: Vec<u32> = pulls.iter().map(|pull| pull.site).collect();
    if skin.hierarchy.is_none() {
        skin.response.make_rows(&pulled, &skin.sites);
    }
    let mut loads = position
        .recall
        .map_or_else(Vec::new, |recall| recall.loads.clone());
    for pull in pulls {
        loads.push(match position.recall {
            Some(recall) => elastic(skin, pull, recall),
            None => (pull.site, pull.load()),
        });
    }
    let truth = TruePosture {
        product: position.product,
        detection: position.detection,
        weight: position.weight,
    };
    let mut moved = displace(pressing, &truth, &loads, control)?;
    if !pulls.is_empty() {
        moved.detection.deepen(skin);
    }
    Ok(Some(moved))
}

/// An attraction as a load on the elastic tissue: divided by the share that has not faded, N.
fn elastic(skin: &Skin, pull: &Pull, recall: &MemoryStep) -> (u32, Vec3) {
    let region = skin.sites.home_region(pull.site as usize) as usize;
    (pull.site, pull.load() / recall.instantaneous[region])
}

/// Finds attraction and contact together, from the attraction of the step before.
fn solve_adhesive(
    pressing: &mut Pressing<'_>,
    attraction: &AdhesionLaw,
    position: &Position<'_>,
    control: &Control,
) -> Result<(SolvedContact, Adhesion), ContactError> {
    let skin = pressing.skin;
    let mut pulls = pressing.workspace.warm_start.pulls.clone();
    for solve in 1.. {
        let solved = solve_zone(pressing, position, &pulls, control)?;
        let mut next = attraction.pulls(skin, (position.product, position.detection), &solved);
        steady(&pulls, &mut next, solve);
        let is_settled = attraction.is_settled(&pulls, &next);
        if is_settled || solve == MOST_SOLVES {
            return Ok((solved, Adhesion { pulls, is_settled }));
        }
        pulls = next;
        if position.recall.is_none() {
            pressing.workspace.warm_start.last = Arc::new(StartContact {
                travel: Vec::new(),
                ..solved.to_start(skin.sites.len())
            });
        }
    }
    Err(ContactError::Cancelled)
}
