//! Prepares a study for the surrogate: force recordings, noise, whitening, tables, and shared parameters.

use crate::forward::mesh::replay::Replay;
use nalgebra::Vector3;
use thenar_contact::effects::Effect;
use thenar_contact::effects::layer_drainage::drop_of_layer;
use thenar_contact::{ActiveEffect, Control, Material};
use thenar_recordings::Study;
use thenar_recordings::study::Shape;

use crate::checks::copies::copies_note;
use crate::errors::InferenceError;
use crate::forward::surrogate::force_recording::{ForceRecording, carries_use, force_recordings};
use crate::forward::surrogate::mechanism::Scales;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::forward::tables::elastic::Elastic;
use crate::forward::tables::elastic_table::radius;
use crate::noise::estimate::{Noise, noise};
use crate::noise::whitening::Whitening;
use crate::observe::robust_scale::median;
use crate::parameters::priors::{DEEPEST_TOUCH, TOUCH};
use crate::parameters::surrogate_parameter::{Coordinate, Kind};
use crate::parameters::surrogate_priors::{form_error, of_course, of_place, shared};

/// Skin is flat where it departs from a plane by less than this part of its thickness, as far as this many thicknesses from a site.
const FLAT: (f64, f64) = (0.03, 1.5);
/// Standard deviations of the noise below which a floor under readings is none.
const FLOOR: f64 = 4.0;

/// A study that is ready.
pub struct PreparedStudy {
    /// Recordings of force over depth.
    pub courses: Vec<ForceRecording>,
    /// Tables.
    pub elastic: Elastic,
    /// The noise that repeats show.
    pub noise: Noise,
    /// How residuals are whitened.
    pub whitening: Whitening,
    /// Measured values, stacked.
    pub values: Vec<f64>,
    /// Standard deviations of the noise, stacked.
    pub sigma: Vec<f64>,
    /// What is free in every model.
    pub shared: Vec<Coordinate>,
    /// Standard deviation of the first touch that a tool has in all its recordings, mm.
    pub touch_mm: f64,
    /// What is said of recordings that were left out as copies of others.
    pub copies: Option<String>,
    /// Sizes from which variants are chosen.
    pub scales: Scales,
    /// The study's own material, of the first region.
    pub base_material: Material,
}

/// Observes, judges the noise and presses the tables; None where no recording gives force over depth.
///
/// # Errors
/// What the contact model says, or `Cancelled`.
pub fn prepare(
    study: &Study,
    replay: &mut Replay,
    control: &Control<'_>,
) -> Result<Option<PreparedStudy>, InferenceError> {
    let mut found = force_recordings(study, &replay.observed.measured, &replay.place_of);
    found.retain(|c| c.deepest() > 0.0 && c.most() > 0.0);
    if found.is_empty() {
        return Ok(None);
    }
    let g0 = replay.tissue.materials[0].g0_mpa;
    let elastic = Elastic::new(replay, (g0, is_flat(study)), control)?;
    Ok(Some(PreparedStudy {
        copies: copies_note(&replay.observed.measured),
        ..assemble(study, replay, (found, elastic))
    }))
}

/// What is known without pressing.
fn assemble(
    study: &Study,
    replay: &Replay,
    (found, elastic): (Vec<ForceRecording>, Elastic),
) -> PreparedStudy {
    let is_modeled: Vec<bool> = (0..replay.observed.measured.len())
        .map(|r| found.iter().any(|c| c.recording == r))
        .collect();
    let noise = judged(study, replay, ((&found, &elastic), &is_modeled));
    let whitening = Whitening::new(&replay.observed.measured, &noise, &is_modeled);
    let samples = replay.observed.measured.iter().flat_map(|m| &m.samples);
    let values = samples.map(|s| s.value).collect();
    let scales = scales(study, &found, &elastic);
    let sheet = study.instrument.as_ref();
    let touch_mm = sheet.and_then(|s| s.first_touch_mm).unwrap_or(TOUCH);
    let shared = shared(replay, (&found, &elastic), (&noise, touch_mm));
    let sigma = noise.sigma.concat();
    PreparedStudy {
        courses: found,
        elastic,
        noise,
        whitening,
        values,
        sigma,
        shared,
        touch_mm,
        copies: None,
        scales,
        base_material: replay.tissue.materials[0],
    }
}

/// The noise, from repeats along what gain and contact zero do to them.
fn judged(
    study: &Study,
    replay: &Replay,
    ((courses, elastic), is_modeled): ((&[ForceRecording], &Elastic), &[bool]),
) -> Noise {
    let measured = &replay.observed.measured;
    let nothing = || -> Vec<Vec<f64>> {
        measured
            .iter()
            .map(|m| vec![0.0; m.samples.len()])
            .collect()
    };
    let (mut simulated, mut slopes) = (nothing(), nothing());
    let material = replay.tissue.materials[0];
    for course in courses {
        let table = &elastic.places[course.place];
        let force = |d: f64| match d > 0.0 {
            true => table.force.at(d.sqrt()) * material.shear_modulus(d),
            false => 0.0,
        };
        let step = 5e-3 * table.deepest;
        for row in &course.rows {
            if let Some(sample) = row.sample {
                let at = sample - course.samples.0;
                let here = force(row.depth_mm);
                simulated[course.recording][at] = here;
                slopes[course.recording][at] = (force(row.depth_mm + step) - here) / step;
            }
        }
    }
    let noise_n = study.instrument.as_ref().and_then(|i| i.noise_n);
    noise(measured, (&simulated, &slopes), is_modeled, noise_n)
}

impl PreparedStudy {
    /// Poisson's ratio of drained tissue with which drainage is switched on: the catalogue's, as none is fitted.
    pub fn drained_poisson_ratio(&self) -> f64 {
        ActiveEffect::new(Effect::Drainage, 1.0).number("drained_poisson_ratio")
    }

    /// Share of the force that tissue of that Poisson's ratio loses in the end as it drains, over the places of the study.
    pub fn mean_drop(&self) -> f64 {
        let drained = self.drained_poisson_ratio();
        let thickness = self.base_material.thickness_mm;
        let places = &self.elastic.places[..self.elastic.studied];
        let of = |p| drop_of_layer(drained, (radius(p, self.scales.deepest), thickness));
        places.iter().map(of).sum::<f64>() / places.len() as f64
    }

    /// Shortest and longest period that recordings can show, s: the least time between readings, and the longest recording.
    pub fn seen_periods(&self) -> (f64, f64) {
        let mut seen = (f64::INFINITY, 0.0);
        for course in &self.courses {
            let steps = course
                .rows
                .windows(2)
                .map(|two| two[1].time_s - two[0].time_s);
            seen.0 = steps.filter(|s| *s > 0.0).fold(seen.0, f64::min);
            if let (Some(first), Some(last)) = (course.rows.first(), course.rows.last()) {
                seen.1 = f64::max(seen.1, last.time_s - first.time_s);
            }
        }
        seen
    }

    /// Noise over the largest force of its recording, the median of all samples.
    pub fn noise_share(&self) -> f64 {
        let share = |c: &ForceRecording| {
            let sample = c.rows.iter().find_map(|r| r.sample)?;
            Some(self.sigma[sample] / c.most())
        };
        let mut shares: Vec<f64> = self.courses.iter().filter_map(share).collect();
        median(&mut shares).clamp(1e-4, 0.1)
    }

    /// Coordinates of a recording that is yet to be made, as deep as `deepest` (mm): those of its tool's place, if the study has
    /// not used it, and its own. `elastic` has that place, too.
    pub(crate) fn coordinates_of(
        &self,
        elastic: &Elastic,
        (place, course): (usize, usize),
        deepest: f64,
    ) -> (Vec<Coordinate>, Vec<Coordinate>) {
        let has_regions = self.shared.iter().any(|c| matches!(c.kind, Kind::Scale(_)));
        let of_place = match place < elastic.studied {
            true => Vec::new(),
            false => of_place(
                place,
                (self.touch_mm.min(DEEPEST_TOUCH * deepest), deepest),
                (form_error(elastic, place), has_regions),
            ),
        };
        (
            of_place,
            of_course(course, deepest, (&self.noise, self.touch_mm)),
        )
    }

    /// The least reading that stands out of the noise, over the smallest peak: of the middle recording of those whose noise is small enough.
    pub(crate) fn least_seen(&self) -> f64 {
        let peak = self.scales.forces.0;
        let seen = self.courses.iter().filter_map(|course| {
            let samples = course.rows.iter().filter_map(|row| row.sample);
            let noise = samples.map(|k| self.sigma[k]).fold(0.0, f64::max);
            let least = FLOOR * noise.hypot(self.noise.force_zero_n.unwrap_or(0.0));
            let readings = course.rows.iter().filter(|row| row.sample.is_some());
            let above = readings.map(|row| row.force_n).filter(|f| *f > least);
            (least < 0.5 * peak).then(|| above.fold(peak, f64::min) / peak)
        });
        match &mut seen.collect::<Vec<f64>>()[..] {
            [] => self.noise_share() * FLOOR,
            found => median(found),
        }
    }

    /// The screen of these recordings.
    pub fn surrogate(&self) -> Surrogate<'_> {
        Surrogate {
            courses: &self.courses,
            elastic: &self.elastic,
            whitening: &self.whitening,
            measured: &self.values,
            shared: self.shared.clone(),
            most: (self.scales.forces.1, self.scales.deepest),
            least_peak: self.scales.forces.0,
            least_floor: FLOOR * self.noise_share(),
        }
    }
}

fn scales(study: &Study, courses: &[ForceRecording], elastic: &Elastic) -> Scales {
    let peaks = courses.iter().map(ForceRecording::most);
    let forces = peaks.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), f| {
        (low.min(f), high.max(f))
    });
    let deepest = courses
        .iter()
        .map(ForceRecording::deepest)
        .fold(0.0, f64::max);
    let logs = elastic
        .places
        .iter()
        .map(|p| libm::log(radius(p, deepest).max(1e-3)));
    let has_strain = courses.iter().any(|c| {
        let name = &study.recordings[c.recording].indenter;
        let tool = study.indenters.iter().find(|i| i.name == *name);
        tool.is_some_and(|t| matches!(t.shape, Shape::Sphere { .. } | Shape::Cylinder { .. }))
    });
    Scales {
        deepest,
        radius: libm::exp(logs.sum::<f64>() / elastic.places.len() as f64),
        forces,
        has_bone: elastic
            .variant(thenar_contact::effects::Effect::Bone, 0)
            .is_some(),
        has_strain,
        carries_use: carries_use(courses),
    }
}

/// True if the skin is a plane about every site, and goes on beyond what a press moves; that of a half space, as a layer of the default
/// thickness would have to. Of tissue whose thickness is not stated nothing is known.
fn is_flat(study: &Study) -> bool {
    let materials = &study.skin.materials;
    let stated = materials.iter().filter_map(|m| m.thickness_mm);
    let mut thickness = stated.fold(f64::INFINITY, f64::min);
    if !thickness.is_finite() {
        if materials.is_empty() || materials.iter().any(|m| m.thickness_mm.is_none()) {
            return false;
        }
        thickness = Material::default().thickness_mm;
    }
    study.sites.iter().all(|site| {
        let (point, along): (Vector3<f64>, Vector3<f64>) =
            (site.point_mm.into(), site.direction.into());
        let positions = || study.skin.mesh.positions.iter().map(|p| p - point);
        let reach = FLAT.1 * thickness;
        positions().any(|off| off.norm() > reach)
            && positions()
                .all(|off| off.norm() > reach || off.dot(&along).abs() < FLAT.0 * thickness)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::{ready, tool};
    use crate::forward::tables::form_ways::WAYS;
    use crate::parameters::surrogate_priors::with_measured_form;
    use std::path::PathBuf;
    use thenar_recordings::meshes::MeshFile;
    use thenar_recordings::study::{Site, StudyMaterial, StudySkin};

    /// A lattice of 20 mm whose rim lies `rise` mm higher than its middle, over tissue of a thickness.
    fn skin(thickness_mm: Option<f64>, rise: f64) -> Study {
        let along = |k: i32| 2.0 * f64::from(k);
        let one = |(i, j): (i32, i32)| {
            let (x, y) = (along(i), along(j));
            Vector3::new(x, y, rise * (x * x + y * y) / 200.0)
        };
        let places = (-5..=5).flat_map(|i| (-5..=5).map(move |j| (i, j)));
        let mesh = MeshFile {
            positions: places.map(one).collect(),
            triangles: Vec::new(),
            notes: Vec::new(),
        };
        let material = StudyMaterial {
            thickness_mm,
            ..StudyMaterial::default()
        };
        Study {
            folder: PathBuf::new(),
            title: String::new(),
            skin: StudySkin {
                mesh,
                materials: vec![material],
                ..StudySkin::default()
            },
            indenters: Vec::new(),
            sites: vec![Site {
                name: "pad".into(),
                point_mm: [0.0; 3],
                direction: [0.0, 0.0, -1.0],
                distance_mm: 0.0,
            }],
            recordings: Vec::new(),
            instrument: None,
            warnings: Vec::new(),
        }
    }

    /// A half space is the layer without bone: its skin is no rounder for that.
    #[test]
    fn skin_is_flat_on_a_half_space_as_on_a_layer() {
        for thickness_mm in [Some(4.0), Some(f64::INFINITY)] {
            assert!(is_flat(&skin(thickness_mm, 0.0)), "{thickness_mm:?}");
            assert!(!is_flat(&skin(thickness_mm, 1.0)), "{thickness_mm:?}");
        }
        // A layer's skin ends within what a press moves; and nobody knows how thick the other tissue is.
        assert!(!is_flat(&skin(Some(20.0), 0.0)) && !is_flat(&skin(None, 0.0)));
        let mut both = skin(Some(f64::INFINITY), 0.0);
        both.skin.materials.push(StudyMaterial::default());
        assert!(!is_flat(&both));
    }

    #[test]
    fn form_prior_widens_from_sphere_to_mesh_to_round_skin() {
        let tools = (0..2).map(|_| tool(1.0, |d| d, |_| 1.0)).collect();
        let (mut ready, _) = ready(tools, &[], 0.1);
        ready.elastic.places[1].is_exact = true;
        let of = |elastic: &Elastic, place: usize| form_error(elastic, place)[0];
        let flat = [0, 1].map(|place| of(&ready.elastic, place));
        ready.elastic.is_flat = false;
        let round = of(&ready.elastic, 0);
        assert!(flat[1] < flat[0] && flat[0] < round);
        ready.elastic.is_bone_stated = true;
        let stated = of(&ready.elastic, 0);
        assert!(flat[0] < stated && stated < round);
    }

    /// On round skin a name is held against a form that is freer than the fit's, the more so where the bone is not stated, and on flat skin not.
    #[test]
    fn measured_form_is_free_on_round_skin() {
        let (mut ready, _) = ready(vec![tool(1.0, |d| d, |_| 1.0)], &[], 0.1);
        let round = of_place(0, (0.05, 1.0), ([0.01; WAYS], false));
        let free = |elastic: &Elastic| with_measured_form(&round, elastic);
        assert!(free(&ready.elastic).is_none());
        ready.elastic.is_flat = false;
        let unstated = free(&ready.elastic).unwrap();
        assert_eq!(
            unstated[..round.len()]
                .iter()
                .map(|c| c.kind)
                .collect::<Vec<_>>(),
            round.iter().map(|c| c.kind).collect::<Vec<_>>()
        );
        let sd = |all: &[Coordinate], kind: Kind| {
            all.iter().find(|c| c.kind == kind).and_then(|c| c.prior)
        };
        assert!(sd(&unstated, Kind::Form(0, 2)) > sd(&round, Kind::Form(0, 2)));
        assert!(sd(&unstated, Kind::SharedForm(0, 0)) == Some(1.0));
        let bend = |elastic: &Elastic| elastic.shared_form()[0][2];
        let most = bend(&ready.elastic);
        ready.elastic.is_bone_stated = true;
        assert!(bend(&ready.elastic) < 0.6 * most && bend(&ready.elastic) > 0.01);
        assert!(free(&ready.elastic).unwrap().len() < unstated.len());
    }
}
