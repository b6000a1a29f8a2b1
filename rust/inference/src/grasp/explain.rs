//! Conducts the explanation of a grasp study: holds, cells, regions, courses, causes.

use nalgebra::{Matrix2, Vector2};
use thenar_contact::Control;
use thenar_contact::instrument::Placement;
use thenar_recordings::Study;

use crate::errors::InferenceError;
use crate::grasp::causes::{Chosen, candidates, choose};
use crate::grasp::cell_faults::{Limits, PartGain, dead, limits, part_gain};
use crate::grasp::channels::{Channels, Found, channels, place, regions};
use crate::grasp::hold::{Hold, holds};
use crate::grasp::product_maps::{HeldProduct, RegionForces};
use crate::grasp::regional_fit::{Cells, RegionalFit, fit};
use crate::grasp::time_course::{Courses, courses};

/// Thickness that a step of the cause `bone` leaves of the tissue.
pub const THINNER: f64 = 0.8;
/// A data sheet's limit within this share of what the readings show is that limit.
const STATED: f64 = 0.1;
/// Times that the posture is fitted and pressed again.
const POSTURES: usize = 2;
/// Most holds of a study: every one is left out in turn, at a cost that grows with the fourth power of their number.
const MOST_HOLDS: usize = 12;
/// Least share of a hold's load that lies on cells which the model loads: holds that are laid out rightly have 0.99, a mat that is turned or
/// 40 mm off half of it.
const ON_MODEL: f64 = 0.7;
/// What counts there as loaded, kPa.
const LOADED_KPA: f64 = 0.5;

/// A grasp study, explained.
pub struct Explained {
    /// The holds, in the order of their recording.
    pub holds: Vec<Hold>,
    /// Their mean maps.
    pub fits: Vec<RegionalFit>,
    /// Their courses.
    pub courses: Vec<Courses>,
    /// Rows and nuisances.
    pub channels: Channels,
    /// Causes.
    pub chosen: Chosen,
    /// Limits that the readings show and no data sheet states.
    pub limits: Limits,
    /// Cells that show nothing, by number on the mat.
    pub dead: Vec<usize>,
    /// A part with another gain.
    pub part: Option<PartGain>,
    /// What is known of the cells.
    pub cells: Cells,
    /// The model of the held product.
    pub product: HeldProduct,
    /// Force of every region over its shift.
    pub forces: RegionForces,
    /// By hold: logarithm of the part of the trace's force that the mat can read.
    pub readable: Vec<f64>,
}

/// Explains a study of grasps.
///
/// # Errors
/// [`InferenceError`]: skin, product or mats that cannot be used, presses that fail, or `Cancelled`.
pub fn explain(study: &Study, control: &Control<'_>) -> Result<Explained, InferenceError> {
    let step = |stage: &str, share: f64| {
        let step = control.step(stage, share);
        step.map_err(|_| InferenceError::Cancelled)
    };
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    step("preparing the grasp", 0.0)?;
    let holds = holds(study)?;
    check_holds(&holds)?;
    let product = HeldProduct::new(study, &quiet)?;
    let shown = limits(&holds);
    let sheet = study.instrument.as_ref();
    let stated = (
        sheet.and_then(|i| i.saturation_kpa),
        sheet.and_then(|i| i.threshold_kpa),
    );
    let count = holds.first().map_or(0, |hold| hold.kept.len());
    let mut cells = Cells {
        is_live: vec![true; count],
        floor_kpa: shown.floor_kpa.or(stated.1).unwrap_or(0.0),
        ceiling_kpa: shown.ceiling_kpa.or(stated.0).unwrap_or(f64::INFINITY),
        gain: vec![1.0; count],
    };
    let mut middle = vec![0.0; product.regions().len()];
    let mut forces = None;
    let mut fits: Vec<RegionalFit> = Vec::new();
    for round in 0..POSTURES {
        step("pressing the grasp", 0.1 + 0.3 * round as f64)?;
        let pressed = product.forces(&middle, 1.0, &quiet)?;
        if pressed.is_bare() {
            return Err(refused(
                "the hand does not touch the product; give both in one frame and in mm, as the product is held".to_owned(),
            ));
        }
        fits = holds
            .iter()
            .map(|hold| fit(hold, &pressed, &cells))
            .collect();
        for (region, middle) in middle.iter_mut().enumerate() {
            let own = fits
                .iter()
                .filter_map(|fit| place(fit, region).map(|k| fit.shift_mm[k]));
            let own: Vec<f64> = own.collect();
            if !own.is_empty() && round + 1 < POSTURES {
                *middle = own.iter().sum::<f64>() / own.len() as f64;
            }
        }
        forces = Some(pressed);
    }
    let Some(forces) = forces else {
        return Err(InferenceError::Cancelled);
    };
    step("looking at the cells", 0.7)?;
    let is_dead = dead(&holds, &fits, cells.floor_kpa);
    let dead: Vec<usize> = (0..is_dead.len()).filter(|k| is_dead[*k]).collect();
    cells.is_live = is_dead.iter().map(|dead| !dead).collect();
    let part = part_gain(&holds, &fits, &cells);
    if let Some(part) = &part {
        for (gain, is_in) in cells.gain.iter_mut().zip(&part.is_in) {
            *gain = if *is_in { part.gain } else { 1.0 };
        }
    }
    let fits: Vec<RegionalFit> = holds
        .iter()
        .map(|hold| fit(hold, &forces, &cells))
        .collect();
    for (hold, fit) in holds.iter().zip(&fits) {
        check_place(hold, fit, &cells)?;
    }
    let courses: Vec<Courses> = holds
        .iter()
        .zip(&fits)
        .map(|(hold, fit)| courses(hold, fit, &cells))
        .collect();
    let readable: Vec<f64> = holds
        .iter()
        .zip(&fits)
        .map(|(hold, fit)| readable(hold, fit, (&forces, &cells)))
        .collect();
    let channels = channels(&Found {
        holds: &holds,
        fits: &fits,
        courses: &courses,
        readable: &readable,
        gain: sheet.and_then(|i| i.gain_percent).map(|p| 0.01 * p),
    });
    step("pressing the grasp on thinner tissue", 0.75)?;
    let thin = product.forces(&forces.middle_mm, THINNER, &quiet)?;
    let regions = regions(&fits);
    let thinner = |hold: usize, region: usize| {
        thinning((&holds[hold], &fits[hold]), (&forces, &thin), region)
    };
    let table: Vec<Vec<(f64, f64)>> = (0..holds.len())
        .map(|hold| {
            (0..forces.len())
                .map(|region| thinner(hold, region))
                .collect()
        })
        .collect();
    step("weighing causes", 0.9)?;
    let is_stated = |shown: Option<f64>, stated: Option<f64>| {
        let is_it = |(a, b): (f64, f64)| (a / b - 1.0).abs() < STATED;
        shown.zip(stated).is_some_and(is_it)
    };
    let mut causes = candidates(&channels, &regions, &|hold, region| table[hold][region]);
    // Cells at fault change the level of the regions that they lie under.
    let unstated = Limits {
        ceiling_kpa: shown
            .ceiling_kpa
            .filter(|_| !is_stated(shown.ceiling_kpa, stated.0)),
        floor_kpa: shown
            .floor_kpa
            .filter(|_| !is_stated(shown.floor_kpa, stated.1)),
    };
    if !dead.is_empty() || part.is_some() || unstated != Limits::default() {
        causes.retain(|each| each.cause.region().is_none());
    }
    let chosen = choose(&channels, &causes, &|| step("weighing causes", 0.9))?;
    Ok(Explained {
        limits: unstated,
        holds,
        fits,
        courses,
        channels,
        chosen,
        dead,
        part,
        cells,
        product,
        forces,
        readable,
    })
}

fn refused(problem: String) -> InferenceError {
    InferenceError::Grasps { problem }
}

/// Refuses holds that cannot be explained together.
fn check_holds(holds: &[Hold]) -> Result<(), InferenceError> {
    if holds.len() > MOST_HOLDS {
        return Err(refused(format!(
            "{} holds are more than {MOST_HOLDS}; make studies of fewer",
            holds.len()
        )));
    }
    match holds.iter().find(|hold| hold.kept != holds[0].kept) {
        Some(other) => Err(refused(format!(
            "'{}' and '{}' have different cells; make a study of each mat, and place the same cells in all its recordings",
            holds[0].name, other.name
        ))),
        None => Ok(()),
    }
}

/// Refuses a hold whose readings do not lie where the model's hand touches the product.
fn check_place(hold: &Hold, fit: &RegionalFit, cells: &Cells) -> Result<(), InferenceError> {
    let (read, model) = (hold.mean(), fit.sum());
    let on = |k: usize| match model[k] * cells.gain[k] > LOADED_KPA {
        true => read[k],
        false => 0.0,
    };
    let on: Vec<f64> = (0..read.len()).map(on).collect();
    let (on, whole) = (hold.sum_n(&on), hold.sum_n(&read));
    if whole <= 0.0 {
        return Err(refused(format!(
            "'{}' reads nothing; check the file and the mat",
            hold.name
        )));
    }
    if on < ON_MODEL * whole {
        return Err(refused(format!(
            "only {:.0} % of the load of '{}' lies where the hand touches the product; check how the mat is placed (origin, seam, turn) and the \
             hand's posture",
            100.0 * on / whole,
            hold.name
        )));
    }
    Ok(())
}

/// Logarithm of what the mat can read of the model over what the trace measures of it.
fn readable(hold: &Hold, fit: &RegionalFit, (forces, cells): (&RegionForces, &Cells)) -> f64 {
    let seen: Vec<f64> = fit
        .sum()
        .iter()
        .enumerate()
        .map(
            |(cell, p)| match cells.is_live[cell] && p * cells.gain[cell] > cells.floor_kpa {
                true => (p * cells.gain[cell]).min(cells.ceiling_kpa),
                false => 0.0,
            },
        )
        .collect();
    let of = |(k, &region): (usize, &usize)| {
        fit.log_scale[k].exp() * forces.force_n(region, fit.shift_mm[k], hold.force_direction)
    };
    let whole: f64 = fit.active.iter().enumerate().map(of).sum();
    (hold.sum_n(&seen) / whole).ln()
}

/// What a step of thinner tissue is taken for by a fit with scale and shift: change of the scale's logarithm, and how it grows with shift, /mm.
fn thinning(
    (hold, fit): (&Hold, &RegionalFit),
    (forces, thin): (&RegionForces, &RegionForces),
    region: usize,
) -> (f64, f64) {
    let Some(k) = place(fit, region) else {
        return (0.0, 0.0);
    };
    let mat = (&hold.mat, &Placement::default());
    let taken = |shift: f64| {
        let read = |of: &RegionForces, at: f64| of.read(region, at, mat);
        let (now, other) = (read(forces, shift), read(thin, shift));
        let (ahead, behind) = (read(forces, shift + 0.15), read(forces, shift - 0.15));
        let (mut normal, mut pull) = (Matrix2::identity() * 1e-9, Vector2::zeros());
        for cell in 0..now.len() {
            let row = Vector2::new(now[cell], (ahead[cell] - behind[cell]) / 0.3);
            normal += row * row.transpose();
            pull += row * (other[cell] - now[cell]);
        }
        normal
            .lu()
            .solve(&pull)
            .map_or(0.0, |found| found.x.max(-0.9).ln_1p())
    };
    let (low, high) = forces.range(region);
    let at = fit.shift_mm[k].clamp(low + 0.35, high - 0.35);
    (taken(at), (taken(at + 0.2) - taken(at - 0.2)) / 0.4)
}
