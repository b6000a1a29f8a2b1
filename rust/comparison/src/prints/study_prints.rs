//! The handprints of a study, pressed as their protocol says with the materials of a fit.

use nalgebra::Vector3;
use thenar_contact::Control;
use thenar_recordings::Study;
use thenar_recordings::handprint::Handprint;
use thenar_recordings::study::{Data, PlacedSensel, StudyRecording};
use thenar_surface::{Mesh, vertex_areas};

use crate::comparison::quantities::Measure;
use crate::prints::compare_print::compare;
use crate::prints::print_case::{Pressed, PrintCase};
use crate::prints::printed::Printed;
use thenar_inference::errors::InferenceError;
use thenar_inference::fit::fitting::Fitting;
use thenar_inference::fit::result::Fit;
use thenar_inference::forward::mesh::print_press::{Demanded, PrintPress};
use thenar_inference::observe::measured::Mat;

/// A print beside its simulation, with its table.
pub(crate) type Studied = (Printed, Vec<Measure>);

/// Compares every handprint of a study; by recording, None for others and for those that cannot be compared. What a recording lacks is
/// added to what is unknown of it.
///
/// # Errors
/// What the contact model says of a press, or `Cancelled`.
pub(crate) fn add_prints(
    study: &Study,
    (fitting, fit): (&mut Fitting, &mut Fit),
    control: &Control<'_>,
) -> Result<Vec<Option<Studied>>, InferenceError> {
    let rest = &study.skin.mesh.positions[..];
    let mut all = Vec::with_capacity(study.recordings.len());
    for (number, recording) in study.recordings.iter().enumerate() {
        let Data::Handprint { print, sensels, .. } = &recording.data else {
            all.push(None);
            continue;
        };
        let unknown = &mut fit.measured[number].unknown;
        let Some((mat, inked)) = sensels.as_ref().and_then(|cells| laid(print, cells)) else {
            unknown.push("its paper is not placed on the tool; give placing or sensels".to_owned());
            all.push(None);
            continue;
        };
        let Some(demanded) = demanded(recording) else {
            unknown.push(
                "how hard it was pressed is not known; give force_n, depth_mm or motion".to_owned(),
            );
            all.push(None);
            continue;
        };
        let presses = fitting.presses(number, (rest, demanded, &fit.estimates), control)?;
        let found = of_study(study, (recording, &mat, &inked), &presses);
        match &found {
            None => fit.measured[number]
                .unknown
                .push("no cell of it is half inked, so it shows no contact".to_owned()),
            Some(_) => fit.measured[number].mat = Some(mat),
        }
        all.push(found);
    }
    Ok(all)
}

fn of_study(
    study: &Study,
    (recording, mat, inked): (&StudyRecording, &Mat, &[f64]),
    [before, after]: &[PrintPress; 2],
) -> Option<Studied> {
    let Data::Handprint { ink_kpa, .. } = &recording.data else {
        return None;
    };
    let file = &study.skin.mesh;
    let mesh = Mesh::new(file.positions.clone(), file.triangles.clone()).ok()?;
    let areas = vertex_areas(&mesh);
    let sheet = study.instrument.as_ref();
    compare(&PrintCase {
        mat,
        inked,
        ink_kpa: *ink_kpa,
        pressed: pressed(after, &areas),
        before: Some(pressed(before, &areas)),
        position_mm: sheet.and_then(|sheet| sheet.position_mm),
        regions: (&study.skin.regions, &study.skin.region_names),
    })
}

fn pressed<'a>(press: &'a PrintPress, areas: &'a [f64]) -> Pressed<'a> {
    Pressed {
        positions: &press.positions,
        areas,
        force_n: &press.force_n,
    }
}

/// How hard it was pressed at most: ink stays where the skin was.
fn demanded(recording: &StudyRecording) -> Option<Demanded> {
    let Data::Handprint {
        depth_mm,
        force_n,
        motion,
        ..
    } = &recording.data
    else {
        return None;
    };
    let most = |channel: &str| {
        let values = motion.as_ref()?.channel(channel)?;
        let finite = values.iter().copied().filter(|value| value.is_finite());
        finite.reduce(f64::max).filter(|value| *value > 0.0)
    };
    let force = force_n.or_else(|| most("force_n")).map(Demanded::Force);
    force.or_else(|| depth_mm.or_else(|| most("depth_mm")).map(Demanded::Depth))
}

/// The cells that have a place, and their shares of ink.
fn laid(print: &Handprint, cells: &[Option<PlacedSensel>]) -> Option<(Mat, Vec<f64>)> {
    let columns = print.cells[1];
    let placed: Vec<(usize, &PlacedSensel)> = cells
        .iter()
        .enumerate()
        .filter_map(|(k, cell)| Some((k, cell.as_ref()?)))
        .collect();
    let normals: Option<Vec<Vector3<f64>>> = placed
        .iter()
        .map(|(_, cell)| Some(cell.normal?.into()))
        .collect();
    let mat = Mat {
        centers: placed
            .iter()
            .map(|(_, cell)| cell.center_mm.into())
            .collect(),
        // A table of cells has no normals; a sheet needs them only where a cell has no neighbor.
        normals: normals.unwrap_or_else(|| vec![Vector3::z(); placed.len()]),
        areas: placed.iter().map(|(_, cell)| cell.area_mm2).collect(),
        places: placed
            .iter()
            .map(|(k, _)| Some([(k / columns) as u32, (k % columns) as u32]))
            .collect(),
    };
    let inked = placed.iter().map(|(k, _)| print.inked[*k]).collect();
    (!placed.is_empty()).then_some((mat, inked))
}
