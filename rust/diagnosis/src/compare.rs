//! Conducts a comparison: fit the parameters, locate what is left, then set recordings and simulation side by side.

use nalgebra::Vector3;
use thenar_contact::Control;
use thenar_recordings::Study;
use thenar_recordings::study::{Data, StudyRecording};
use thenar_surface::Mesh;

use crate::comparison::{Compared, Comparison, SIGNIFICANT, compare_fit};
use crate::prints::add_prints;
use crate::words::{chance, percent};
use crate::{DiagnosisError, Fitting, Options, Search, locate};

/// Standard deviation of the model's load at any depth against finite elements of a fingertip, which it leaves by up to 9 % of the best
/// straight line (two of them).
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
/// [`DiagnosisError`]: skin, tools or mats that cannot be used, presses that fail, too few samples, or `Cancelled`.
pub fn compare(
    study: &Study,
    options: &Options,
    control: &Control<'_>,
) -> Result<Comparison, DiagnosisError> {
    let progress = |stage: &str, share: f64| (control.progress)(stage, FITTING * share);
    let within = Control {
        cancelled: control.cancelled,
        progress: &progress,
    };
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    let mut fitting = Fitting::new(study, &within)?;
    let has_samples = fitting.measured().iter().any(|m| !m.samples.is_empty());
    let is_print = |recording: &StudyRecording| matches!(recording.data, Data::Handprint { .. });
    let mut fit = match !has_samples && study.recordings.iter().any(is_print) {
        true => fitting.unfitted(),
        false => fitting.fit(options, &within)?,
    };
    if fit.lack_of_fit_p.is_some_and(|p| p < SIGNIFICANT) {
        fit.notes.extend(allowing(&mut fitting, options, &quiet)?);
    }
    let prints = add_prints(study, (&mut fitting, &mut fit), &within)?;
    let progress = |stage: &str, share: f64| {
        (control.progress)(stage, FITTING + (LOCATED - FITTING) * share);
    };
    let within = Control {
        cancelled: control.cancelled,
        progress: &progress,
    };
    let file = &study.skin.mesh;
    let mesh = Mesh::new(file.positions.clone(), file.triangles.clone());
    let mesh = mesh.map_err(DiagnosisError::Skin)?;
    let search = Search {
        skin: Some(&mesh),
        seed: options.seed,
        ..Search::default()
    };
    // Without repeats noise is a guess, and a place that stands out of a guess is none.
    let is_told = fit.lack_of_fit_p.is_some();
    let location = is_told
        .then(|| locate(&fit, &search, &within))
        .transpose()?;
    let step = |share: f64| {
        let step = control.step("comparing", share);
        step.map_err(|_| DiagnosisError::Cancelled)
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

/// How much is left once the model's own form may be off, as far as it is known to be.
fn allowing(
    fitting: &mut Fitting,
    options: &Options,
    control: &Control<'_>,
) -> Result<Option<String>, DiagnosisError> {
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
