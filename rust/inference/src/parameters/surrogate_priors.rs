//! Bounds and priors of the surrogate model's parameters: moduli, first touch, gain, and the error of the model's form.

use crate::forward::mesh::replay::Replay;
use thenar_contact::Material;

use crate::forward::mesh::nuisance::KNOTS;
use crate::forward::surrogate::force_recording::ForceRecording;
use crate::forward::tables::elastic::Elastic;
use crate::noise::estimate::Noise;
use crate::parameters::surrogate_parameter::{Coordinate, Kind};

/// Standard deviation of the factor by which the model's form may be off, for each tool at each site, by way (`stiffness_factor::modes`): of a ball
/// on flat skin (`forward::tables::sphere`), of another tool there, and on any other skin.
///
/// Against the finite elements of the calibration's flat pads without effects balls are off by 0.4 % in the whole, by 0.3 % in their tilt and
/// by 0.1 % in their bend, once the moduli took what all tools share (`python -m trial.against_ball`); tables from the mesh by more; on the
/// round fingertip of `tests/proof` the layer is off by up to 9 %.
pub(crate) const FORM_ERROR: [[f64; KNOTS]; 3] = [
    [0.006, 0.006, 0.003, 0.02],
    [0.01, 0.01, 0.004, 0.02],
    [0.05, 0.05, 0.03, 0.05],
];

/// Largest standard deviation of first touch as an operator judges it, mm, as the fit takes it. Where repeats show that first touch
/// scatters by less, what a tool has in all its recordings is taken for no larger than that.
pub(crate) const TOUCH: f64 = 0.05;

/// Part of a recording's depth that first touch may be off by where it is read from the force.
pub(crate) const UNKNOWN_TOUCH: f64 = 0.15;

/// Bounds of a modulus against the study's own, as logarithms.
pub(crate) const MODULUS: f64 = 3.0;

/// Bounds in standard deviations.
pub(crate) const MOST: f64 = 6.0;

/// Moduli, first touch, gain, and the model's form.
pub(crate) fn shared(
    replay: &Replay,
    (courses, elastic): (&[ForceRecording], &Elastic),
    noise: &Noise,
) -> Vec<Coordinate> {
    let known = &replay.observed.is_touch_known;
    let mut all = moduli(&replay.tissue.materials[0]).to_vec();
    let has_regions = replay.tissue.regions.len() > 1;
    for place in 0..elastic.places.len() {
        let Some(first) = courses.iter().find(|c| c.place == place) else {
            continue;
        };
        let deep = first.deepest();
        let judged = match known[first.recording] {
            true => touch(noise.zero_mm).min(0.25 * deep),
            false => UNKNOWN_TOUCH * deep,
        };
        let form = form_error(elastic, place);
        all.extend(of_place(place, (judged, deep), (form, has_regions)));
    }
    for (c, course) in courses.iter().enumerate() {
        all.extend(of_course(c, course.deepest(), noise));
    }
    all
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
            bounds: (start - MODULUS, start + MODULUS),
            prior: None,
            step: 1e-3,
        }
    })
}

/// Standard deviation of the first touch that a tool has in all its recordings, mm, from that between repeats.
pub(crate) fn touch(scatter_mm: Option<f64>) -> f64 {
    scatter_mm.map_or(TOUCH, |scatter| scatter.min(TOUCH))
}

/// What a tool at its site may be off by: its first touch as it was judged, against a depth (mm), and the model's form.
pub(crate) fn of_place(
    place: usize,
    (judged, deep): (f64, f64),
    (form, has_regions): ([f64; KNOTS], bool),
) -> Vec<Coordinate> {
    let mut all = vec![about(Kind::Touch(place), judged, 1e-3 * deep)];
    if has_regions {
        all.push(about(Kind::Scale(place), 0.5, 1e-3));
    }
    all.extend((0..KNOTS).map(|k| about(Kind::Form(place, k), form[k], 1e-3)));
    all
}

/// As [`FORM_ERROR`] has it for the tool and the skin of a place.
pub(crate) fn form_error(elastic: &Elastic, place: usize) -> [f64; KNOTS] {
    let is_exact = elastic.places[place].is_exact;
    FORM_ERROR[if is_exact {
        0
    } else {
        1 + usize::from(!elastic.is_flat)
    }]
}

/// How well the elastic answers of the study's tools are known, in words.
pub fn form_note(elastic: &Elastic) -> String {
    let percent = |form: [f64; KNOTS]| 100.0 * form[0];
    let meshed = percent(FORM_ERROR[1 + usize::from(!elastic.is_flat)]);
    let places = &elastic.places[..elastic.studied];
    let balls = places.iter().filter(|place| place.is_exact).count();
    let known = format!(
        "a ball on flat skin is pressed without a mesh, and its force known to {} %",
        percent(FORM_ERROR[0])
    );
    match (balls, places.len() - balls) {
        (0, _) => format!("pressed on the mesh; its forces may be off by {meshed} %"),
        (_, 0) => known,
        (_, others) => format!(
            "{known}; that of {others} of {} tools, on the mesh, to {meshed} %",
            places.len()
        ),
    }
}

/// What a recording may be off by: its first touch, and its gain where repeats show that it scatters.
pub(crate) fn of_course(course: usize, deepest: f64, noise: &Noise) -> Vec<Coordinate> {
    let zero = noise.zero_mm.unwrap_or(TOUCH).max(1e-4);
    let mut all = vec![about(Kind::Zero(course), zero, 1e-3 * deepest)];
    if noise.gain > 0.0 {
        all.push(about(Kind::Gain(course), noise.gain, 1e-4));
    }
    all
}

pub(crate) fn about(kind: Kind, sd: f64, step: f64) -> Coordinate {
    Coordinate {
        kind,
        start: 0.0,
        bounds: (-MOST * sd, MOST * sd),
        prior: Some(sd),
        step,
    }
}
