//! Bounds and priors of the surrogate model's parameters: moduli, first touch, gain, and the error of the model's form.

use crate::forward::mesh::replay::Replay;
use thenar_contact::Material;

use crate::forward::surrogate::force_prediction::stands;
use crate::forward::surrogate::force_recording::ForceRecording;
use crate::forward::tables::elastic::Elastic;
use crate::forward::tables::form_ways::WAYS;
use crate::noise::estimate::Noise;
use crate::observe::first_touch::at_zero;
use crate::parameters::priors::{
    CLEAR_AT_ZERO, DEEPEST_TOUCH, FORM_ERROR, LOG_MODULUS, MEASURED_FORM, MOST, SHARED,
    SHARED_FORM, UNKNOWN_TOUCH,
};
use crate::parameters::surrogate_parameter::{Coordinate, Kind};

/// Most stands of a recording whose depths are fitted.
const MOST_STANDS: usize = 8;

/// Moduli, first touch, gain, and the model's form. `touch_mm` is the standard deviation of the first touch that a tool has in all its recordings,
/// where it was judged.
///
/// That repeats agree in their first touch says nothing of how far it is off in all of them: a tool whose length was measured wrongly, and a
/// trigger of the force, are off alike every time.
pub(crate) fn shared(
    replay: &Replay,
    (courses, elastic): (&[ForceRecording], &Elastic),
    (noise, touch_mm): (&Noise, f64),
) -> Vec<Coordinate> {
    let known = &replay.observed.is_touch_known;
    let sigma = noise.sigma.concat();
    let mut all = moduli(&replay.tissue.materials[0]).to_vec();
    let has_regions = replay.tissue.regions.len() > 1;
    for place in 0..elastic.places.len() {
        let Some(first) = courses.iter().find(|c| c.place == place) else {
            continue;
        };
        let deep = first.deepest();
        let at_place = courses.iter().filter(|c| c.place == place);
        let seen = pressed_before(at_place, (&sigma, noise.force_zero_n.unwrap_or(0.0)));
        let judged = match known[first.recording] {
            true => touch_mm.max(seen).min(DEEPEST_TOUCH * deep),
            false => (UNKNOWN_TOUCH * deep).max(seen),
        };
        let form = form_error(elastic, place);
        all.extend(of_place(place, (judged, deep), (form, has_regions)));
    }
    for (c, course) in courses.iter().enumerate() {
        all.extend(of_course(c, course.deepest(), (noise, touch_mm)));
        // All readings of a stand are rounded alike, so that their mean is no surer than one.
        let rounded_mm = replay.observed.measured[course.recording].depth_error_mm;
        let stands = stands(&course.rows).len().min(MOST_STANDS);
        all.extend((0..stands).filter(|_| rounded_mm > 0.0).map(|stand| {
            Coordinate::about(Kind::Stand(c, stand), (rounded_mm, MOST), 0.1 * rounded_mm)
        }));
    }
    all
}

/// About how deep a tool is pressed where its depths begin, mm, as the recordings show in which there is clearly a force already; 0 if none does.
fn pressed_before<'a>(
    courses: impl Iterator<Item = &'a ForceRecording>,
    (sigma, zero_sd_n): (&[f64], f64),
) -> f64 {
    let late = courses.filter_map(|course| {
        let seen = at_zero(&course.rows, |row| (row.depth_mm, row.force_n))?;
        let noise = sigma[course.rows[seen.reading].sample?];
        // Only an approach shows the recording's own zero.
        let noise = match seen.reading {
            0 => noise.hypot(zero_sd_n),
            _ => noise,
        };
        (seen.force_n > CLEAR_AT_ZERO * noise).then(|| seen.late_mm())
    });
    late.fold(0.0, f64::max)
}

/// The modulus at first touch and the one at which it stops growing, about the study's own.
pub(crate) fn moduli(material: &Material) -> [Coordinate; 2] {
    let start = [
        (Kind::First, material.g0_mpa),
        (Kind::Limit, material.g_lim_mpa),
    ];
    start.map(|(kind, modulus)| {
        let start = libm::log(modulus);
        Coordinate {
            kind,
            start,
            bounds: (start - LOG_MODULUS, start + LOG_MODULUS),
            prior: None,
            step: 1e-3,
        }
    })
}

/// What a tool at its site may be off by: its first touch as it was judged, against a depth (mm), and the model's form.
pub(crate) fn of_place(
    place: usize,
    (judged, deep): (f64, f64),
    (form, has_regions): ([f64; WAYS], bool),
) -> Vec<Coordinate> {
    let mut all = vec![Coordinate::about(
        Kind::Touch(place),
        (judged, MOST),
        1e-3 * deep,
    )];
    if has_regions {
        all.push(Coordinate::about(Kind::Scale(place), (0.5, MOST), 1e-3));
    }
    let is_off = |k: &usize| form[*k] > 0.0;
    let one = |k| Coordinate::about(Kind::Form(place, k), (form[k], MOST), 1e-3);
    all.extend((0..WAYS).filter(is_off).map(one));
    all
}

/// True where the form of the model is known: on flat skin over a plane, and on a half space.
pub fn is_form_known(elastic: &Elastic) -> bool {
    (elastic.is_flat && !elastic.is_bone_stated) || !elastic.shared_depth.is_finite()
}

/// These coordinates with the form of the model as free as it was measured to be; what is new comes last. None on flat skin over bone without
/// end, whose form is known, and on a half space: what was measured is tissue over bone.
pub(crate) fn with_measured_form(
    shared: &[Coordinate],
    elastic: &Elastic,
) -> Option<Vec<Coordinate>> {
    if is_form_known(elastic) {
        return None;
    }
    let mut all = shared.to_vec();
    let places: Vec<usize> = (0..elastic.places.len())
        .filter(|p| shared.iter().any(|c| c.kind == Kind::Touch(*p)))
        .collect();
    for place in &places {
        for (way, sd) in MEASURED_FORM.into_iter().enumerate() {
            let kind = Kind::Form(*place, way);
            match all.iter_mut().find(|c| c.kind == kind) {
                Some(known) => {
                    let wider = sd.max(known.prior.unwrap_or(sd));
                    *known = Coordinate::about(kind, (wider, MOST), 1e-3);
                }
                None => all.push(Coordinate::about(kind, (sd, MOST), 1e-3)),
            }
        }
    }
    let mut sites: Vec<usize> = places.iter().map(|p| elastic.site_of[*p]).collect();
    sites.sort_unstable();
    sites.dedup();
    let is_off = |form: &usize| elastic.shared_form()[*form].iter().any(|size| *size != 0.0);
    for site in sites {
        let one = |form| Coordinate::about(Kind::SharedForm(site, form), (1.0, MOST), 0.02);
        all.extend((0..SHARED).filter(is_off).map(one));
    }
    Some(all)
}

/// As [`FORM_ERROR`] has it for the tool and the skin of a place.
pub(crate) fn form_error(elastic: &Elastic, place: usize) -> [f64; WAYS] {
    match elastic.places[place].is_exact {
        true => FORM_ERROR[0],
        false => meshed(elastic),
    }
}

/// That of a tool that is pressed on the mesh.
fn meshed(elastic: &Elastic) -> [f64; WAYS] {
    FORM_ERROR[match (elastic.is_bone_stated, elastic.is_flat) {
        (true, _) => 2,
        (false, true) => 1,
        (false, false) => 3,
    }]
}

/// How well the elastic answers of the study's tools are known, in words.
pub fn form_note(elastic: &Elastic) -> String {
    let percent = |size: f64| (100.0 * size).round();
    let off = |shared: [[f64; WAYS]; SHARED]| {
        let all = shared.iter().flatten().map(|size| size.abs());
        percent(all.fold(meshed(elastic)[0], f64::max))
    };
    let meshed = off(elastic.shared_form());
    let places = &elastic.places[..elastic.studied];
    let balls = places.iter().filter(|place| place.is_exact).count();
    let known = format!(
        "the force of a ball on flat skin is known to {} %, since it is pressed without a mesh",
        100.0 * FORM_ERROR[0][0]
    );
    match (balls, places.len() - balls) {
        (0, _) if !is_form_known(elastic) && !elastic.is_bone_stated => format!(
            "the width of the bone is not stated: over a narrow bone the simulated forces may be off by {meshed} %. State it \
             (bone_half_width_mm in [skin.materials]) to have smaller effects named: then it is {} %",
            off(SHARED_FORM[0])
        ),
        (0, _) => format!("the simulated forces may be off by {meshed} %"),
        (_, 0) => known,
        (_, others) => format!(
            "{known}; that of {others} of {} tools, pressed on the mesh, to {meshed} %",
            places.len()
        ),
    }
}

/// What a recording may be off by: its first touch (`touch_mm` where there are no repeats), and, as repeats differ, its gain and the zero of its force.
pub(crate) fn of_course(
    course: usize,
    deepest: f64,
    (noise, touch_mm): (&Noise, f64),
) -> Vec<Coordinate> {
    let zero = noise.zero_mm.unwrap_or(touch_mm).max(1e-4);
    let mut all = vec![Coordinate::about(
        Kind::Zero(course),
        (zero, MOST),
        1e-3 * deepest,
    )];
    if noise.gain > 0.0 {
        all.push(Coordinate::about(
            Kind::Gain(course),
            (noise.gain, MOST),
            1e-4,
        ));
    }
    if let Some(sd) = noise.force_zero_n {
        all.push(Coordinate::about(
            Kind::ForceZero(course),
            (sd, MOST),
            1e-2 * sd,
        ));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::ready;
    use crate::observe::measured::Phase;

    /// A tool whose depths begin 0.2 mm late, one whose depths begin with first touch, and one that is recorded from deeper on.
    #[test]
    fn a_force_at_depth_zero_frees_the_first_touch_of_its_tool() {
        let press = |late: f64, from: f64| -> Vec<_> {
            (0..60)
                .map(|k| from + 0.025 * f64::from(k))
                .map(|depth| (depth, (depth + late).max(0.0).powf(1.5)))
                .enumerate()
                .map(|(k, (depth, force))| (0.1 * k as f64, depth, Phase::Load, force))
                .collect()
        };
        let tools = [(0.2, -0.3), (0.0, -0.3), (0.2, 0.2)];
        let presses: Vec<_> = (0..3).map(|t| (t, press(tools[t].0, tools[t].1))).collect();
        let (made, _) = ready(Vec::new(), &presses, 0.01);
        let seen = [0, 1, 2].map(|place| {
            pressed_before(
                made.courses.iter().filter(|c| c.place == place),
                (&made.sigma, 0.0),
            )
        });
        assert!(
            (seen[0] - 0.2).abs() < 0.02 && seen[1..] == [0.0, 0.0],
            "{seen:?}"
        );
    }
}
