//! Conducts a comparison: fit the parameters, locate what is left, then set recordings and simulation side by side.

use nalgebra::Vector3;
use thenar_contact::{Control, Material};
use thenar_recordings::Study;
use thenar_recordings::study::{Data, StudyRecording};
use thenar_surface::Mesh;

use crate::comparison::compare_fit::compare_fit;
use crate::comparison::result::{Compared, Comparison};
use crate::comparison::trends::SIGNIFICANT;
use crate::location::locate::{Search, locate, model_error};
use crate::location::mismatch::Location;
use crate::prints::study_prints::{Studied, add_prints};
use thenar_inference::errors::InferenceError;
use thenar_inference::fit::fitting::{Fitting, Options};
use thenar_inference::fit::result::Fit;
use thenar_inference::number_format::{chance, percent};

/// Standard deviation of the factor by which the model's load may be off at any depth: two of them are the 9 % by which the layer leaves
/// the finite elements of the round fingertip in `tests/proof`.
const FORM_ERROR: f64 = 0.045;
/// Part of the work that fitting is, for progress.
const FITTING: f64 = 0.8;
/// Part after which all is located.
const LOCATED: f64 = 0.98;

/// Fits a study's parameters to its recordings, locates the mismatch that is left, and compares.
///
/// The same study and options give the same comparison, bit for bit.
///
/// # Errors
/// [`InferenceError`]: skin, tools or mats that cannot be used, presses that fail, too few samples, or `Cancelled`.
pub fn compare(
    study: &Study,
    options: &Options,
    control: &Control<'_>,
) -> Result<Comparison, InferenceError> {
    if study.has_grasps() {
        return Err(InferenceError::Grasps {
            problem: "moduli are not fitted to grasps; diagnose the study, which compares them region by region".to_owned(),
        });
    }
    let progress = |stage: &str, share: f64| (control.progress)(stage, FITTING * share);
    let fitting = Control {
        cancelled: control.cancelled,
        progress: &progress,
    };
    let (fit, prints) = fitted(study, options, &fitting)?;
    let progress = |stage: &str, share: f64| {
        (control.progress)(stage, FITTING + (LOCATED - FITTING) * share);
    };
    let locating = Control {
        cancelled: control.cancelled,
        progress: &progress,
    };
    let location = located(study, (&fit, options), &locating)?;
    let step = |share: f64| {
        let step = control.step("comparing", share);
        step.map_err(|_| InferenceError::Cancelled)
    };
    step(LOCATED)?;
    let sites: Vec<(String, Vector3<f64>)> = study
        .sites
        .iter()
        .map(|site| (site.name.clone(), site.point_mm.into()))
        .collect();
    let comparison = compare_fit(&Compared {
        title: &study.title,
        skin: &study.skin.mesh.positions,
        sites: &sites,
        fit: &fit,
        location: location.as_ref(),
        prints: &prints,
    });
    step(1.0)?;
    Ok(comparison)
}

/// The fit of a study, and its handprints beside it.
fn fitted(
    study: &Study,
    options: &Options,
    control: &Control<'_>,
) -> Result<(Fit, Vec<Option<Studied>>), InferenceError> {
    let mut fitting = Fitting::new(study, control)?;
    let has_samples = fitting.measured().iter().any(|m| !m.samples.is_empty());
    let is_print = |recording: &StudyRecording| matches!(recording.data, Data::Handprint { .. });
    let mut fit = match !has_samples && study.recordings.iter().any(is_print) {
        true => fitting.unfitted(),
        false => fitting.fit(options, control)?,
    };
    if fit.lack_of_fit_p.is_some_and(|p| p < SIGNIFICANT) {
        let quiet = Control {
            cancelled: control.cancelled,
            progress: &|_, _| {},
        };
        fit.notes.extend(allowing(&mut fitting, options, &quiet)?);
    }
    let prints = add_prints(study, (&mut fitting, &mut fit), control)?;
    Ok((fit, prints))
}

/// Where the mismatch is that a fit leaves; None without repeats: noise is a guess then, and a place that stands out of a guess is none.
fn located(
    study: &Study,
    (fit, options): (&Fit, &Options),
    control: &Control<'_>,
) -> Result<Option<Location>, InferenceError> {
    let file = &study.skin.mesh;
    let mesh = Mesh::new(file.positions.clone(), file.triangles.clone());
    let mesh = mesh.map_err(InferenceError::Skin)?;
    let search = Search {
        skin: Some(&mesh),
        seed: options.seed,
        model_error: Some(model_error(mapped_strain(study, fit))),
        ..Search::default()
    };
    let is_told = fit.lack_of_fit_p.is_some();
    is_told.then(|| locate(fit, &search, control)).transpose()
}

/// Largest depth of a map over the thinnest tissue; 0 without maps.
fn mapped_strain(study: &Study, fit: &Fit) -> f64 {
    let maps = fit.measured.iter().filter(|m| m.mat.is_some());
    let depths = maps.flat_map(|m| &m.moments).map(|moment| moment.depth_mm);
    let deepest = depths.filter(|d| d.is_finite()).fold(0.0, f64::max);
    let given = study.skin.materials.iter().filter_map(|m| m.thickness_mm);
    // What is not given is a fingertip's.
    let thinnest = given.reduce(f64::min);
    deepest / thinnest.unwrap_or(Material::default().thickness_mm)
}

/// How much is left once the model's own form may be off, as far as it is known to be.
fn allowing(
    fitting: &mut Fitting,
    options: &Options,
    control: &Control<'_>,
) -> Result<Option<String>, InferenceError> {
    let wider = Options {
        form_error: FORM_ERROR,
        ..options.clone()
    };
    let p = fitting.fit(&wider, control)?.lack_of_fit_p;
    Ok(p.map(|p| {
        format!(
            "The test for lack of fit takes the model as exact. With its load allowed to be off by {} (one standard deviation) at any depth, for each tool at \
             each place, as finite elements of a fingertip show, noise alone leaves as much with {}.",
            percent(FORM_ERROR),
            chance(p)
        )
    }))
}
