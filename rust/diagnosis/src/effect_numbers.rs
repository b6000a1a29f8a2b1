//! Estimates of a fitted effect in the catalogue's terms and units, with intervals.

use thenar_contact::effects::Effect;
use thenar_contact::effects::layer_drainage::MIDDLE;

use crate::findings::{Number, Switched};
use crate::free_numbers::{Free, HALF, Three, interval, of_number, tried_interval};
use thenar_inference::forward::surrogate::mechanism::{
    DeformationMeasure, Law, Mechanism, UseAtStart,
};
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::forward::surrogate::relaxation_spectrum::{OUTER, Spectrum};
use thenar_inference::forward::surrogate::tissue_laws::RAMP;
use thenar_inference::forward::tables::elastic_table::{SHALLOW, radius, round_radius};
use thenar_inference::forward::tables::stiff_skin::{THICKNESSES_MM, ratio};
use thenar_inference::selection::candidates::SOFTENING_TRAVELS;
use thenar_inference::selection::profile_interval::Profiled;
use thenar_inference::selection::scored::Scored;

/// The mechanism as the catalogue has it: what a finding tells, and what the model is switched to.
pub fn numbers_of_effect(
    ready: &PreparedStudy,
    (scored, profiled): (&Scored, &[Profiled]),
    number: usize,
) -> (Vec<Number>, Switched) {
    let mechanism = &scored.mechanisms[number];
    let free = Free::of(ready, scored, number).with(profiled.get(number));
    let effect = mechanism.effect;
    let (amplitude, numbers) = values(ready, mechanism, &free);
    let switched = Switched {
        name: effect.name(),
        amplitude: amplitude.0,
        numbers: numbers.iter().map(|n| (n.0, n.1)).collect(),
        choices: choices(mechanism),
    };
    (list(effect, amplitude, &numbers), switched)
}

/// The numbers of an effect. Where other numbers say how much, the amplitude of 1 with which they are switched on is none that was found.
fn list(effect: Effect, amplitude: Three, numbers: &[Named]) -> Vec<Number> {
    let unit = |name: &str| {
        let entry = effect.entry().shape.iter().find(|n| n.name == name);
        entry.map_or("1", |n| n.unit)
    };
    let tell = |&(name, value, low, high): &Named| Number {
        name,
        value,
        interval: (low.min(high), low.max(high)),
        unit: unit(name),
    };
    let is_found = amplitude != WHOLE || numbers.is_empty();
    let own = is_found.then_some(("amplitude", amplitude.0, amplitude.1, amplitude.2));
    own.iter().chain(numbers).map(tell).collect()
}

/// What softening by use assumes of the tissue between recordings, where the session states no rest.
pub fn use_note(named: &Scored) -> Option<String> {
    let before = named.mechanisms.iter().find_map(|m| match m.law {
        Law::Softening { start, .. } => match start {
            UseAtStart::Rested => None,
            UseAtStart::AfterProtocols => Some("protocols before it"),
            UseAtStart::AfterRecordings => Some("recordings before it"),
        },
        _ => None,
    })?;
    Some(format!(
        "no rest is stated: the softening fits tissue that each recording takes up as the {before} left it, without recovery between \
         them; how fast it recovers was not seen, recordings with rest_s show it"
    ))
}

/// Choices that the catalogue leaves, by name.
pub(crate) fn choices(mechanism: &Mechanism) -> Vec<(&'static str, &'static str)> {
    let mut choices = match &mechanism.law {
        Law::Stiffening(measure, growth) => {
            let measure = match measure {
                DeformationMeasure::Depth => "depth",
                DeformationMeasure::Strain => "strain",
            };
            vec![("law", growth.law()), ("measure", measure)]
        }
        // The surrogate's skin clings where it has touched.
        Law::Adhesion { .. } => vec![("bonds", "touched")],
        // And drains as a layer.
        Law::Relaxation { .. } => vec![("curve", "layer")],
        Law::Drift { .. } => vec![("channel", "force"), ("form", "slowing")],
        _ if mechanism.is_instrument() => vec![("channel", "force")],
        _ => Vec::new(),
    };
    let known = mechanism.effect.entry().choices;
    choices.retain(|(name, _)| known.iter().any(|c| c.name == *name));
    choices
}

type Named = (&'static str, f64, f64, f64);
/// Largest amplitude with which what drains is switched on.
const MOST_SHARE: f64 = 0.99;
/// Amplitude of an effect whose other numbers say how much.
const WHOLE: Three = (1.0, 1.0, 1.0);

/// Amplitude and shape numbers, each with its interval.
fn values(ready: &PreparedStudy, mechanism: &Mechanism, free: &Free) -> (Three, Vec<Named>) {
    match &mechanism.law {
        Law::Relaxation {
            spectrum: Spectrum::Free(lengths),
            ..
        } => travelling(lengths, free),
        Law::Relaxation { .. } => fading(ready, mechanism.effect, free),
        Law::Softening {
            travel_mm,
            recovery_s,
            ..
        } => {
            let shares = interval(free, &|x| x.clamp(0.0, 0.95));
            let travels = free
                .laws(&mechanism.law)
                .into_iter()
                .filter_map(|law| match law {
                    Law::Softening { travel_mm, .. } => Some(*travel_mm),
                    _ => None,
                });
            let tried = SOFTENING_TRAVELS.map(|over| over * ready.scales.deepest);
            let travel = tried_interval(*travel_mm, &tried, &travels.collect::<Vec<f64>>());
            let shape = vec![
                ("travel_mm", travel.0, travel.1, travel.2),
                ("recovery_s", *recovery_s, *recovery_s, *recovery_s),
            ];
            (shares, shape)
        }
        Law::Adhesion { .. } => {
            let work = interval(free, &|x| work_of(ready, x.max(0.0)));
            let work = ("work_j_per_m2", work.0, work.1, work.2);
            (WHOLE, vec![work, reach(ready, free)])
        }
        Law::Tabulated(form) if mechanism.effect == Effect::StiffSkin => {
            (WHOLE, skin((*form, &mechanism.law), free))
        }
        law => {
            let listed = one(ready, (mechanism.effect, law)).map(|(name, scale)| {
                let three = interval(free, &*scale);
                (name, three.0, three.1, three.2)
            });
            let own_time = match *law {
                Law::Drift { time_s } => Some(("time_s", time_s, time_s, time_s)),
                _ => None,
            };
            (WHOLE, listed.into_iter().chain(own_time).collect())
        }
    }
}

/// Modulus and thickness of a stiff skin.
fn skin((form, law): (usize, &Law), free: &Free) -> Vec<Named> {
    let pulp = 3.0 * free.shear_mpa;
    let modulus = interval(free, &|x| pulp * ratio(x));
    let kept = free.laws(law).into_iter().filter_map(|law| match law {
        Law::Tabulated(form) => Some(THICKNESSES_MM[*form]),
        _ => None,
    });
    let kept: Vec<f64> = kept.collect();
    let thick = tried_interval(THICKNESSES_MM[form], &THICKNESSES_MM, &kept);
    vec![
        ("modulus_mpa", modulus.0, modulus.1, modulus.2),
        ("thickness_mm", thick.0, thick.1, thick.2),
    ]
}

/// Range of a grip.
fn reach(ready: &PreparedStudy, free: &Free) -> Named {
    let range = of_number(free, 1, &|log| libm::exp(log) * ready.scales.deepest * RAMP);
    ("range_mm", range.0, range.1, range.2)
}

/// A number in the catalogue's terms, of the model's own.
type Scale<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// The one number of a mechanism that has no other: its name, and its value in the catalogue's terms.
fn one<'a>(
    ready: &'a PreparedStudy,
    (effect, law): (Effect, &Law),
) -> Option<(&'static str, Scale<'a>)> {
    let own = ready.base_material;
    let (least, most) = ready.scales.forces;
    let (name, scale): (_, Scale<'a>) = match *law {
        Law::Tabulated(_) if effect == Effect::Bone => (
            "thickness_mm",
            Box::new(move |x| own.thickness_mm * libm::exp(x)),
        ),
        Law::Tabulated(_) => (
            "poisson_ratio",
            Box::new(move |x| own.poisson_ratio - x.max(0.0)),
        ),
        Law::Stiffening(measure, growth) => {
            let (name, most) = match measure {
                DeformationMeasure::Depth => ("reference_depth_mm", ready.scales.deepest),
                DeformationMeasure::Strain => {
                    ("reference_strain", ready.surrogate().largest_strain())
                }
            };
            (name, Box::new(move |x| most * growth.reference(x)))
        }
        Law::GainStep { .. } => ("error", Box::new(|x| libm::exp(x) - 1.0)),
        Law::Offset => ("offset_n", Box::new(|x| x)),
        Law::Drift { time_s } => ("rate_n_per_min", Box::new(move |x| drift_rate(x, time_s))),
        Law::Saturation(_) => ("ceiling_n", Box::new(move |x| most * libm::exp(x))),
        Law::Floor(_) => ("floor_n", Box::new(move |x| x.max(0.0) * least)),
        Law::Compliance => ("compliance_mm_per_n", Box::new(|x| x.max(0.0))),
        Law::Delay => ("delay_s", Box::new(|x| x)),
        Law::Relaxation { .. }
        | Law::Softening { .. }
        | Law::Adhesion { .. }
        | Law::DepthCurve { .. } => return None,
    };
    Some((name, scale))
}

/// N/min, of a drift of `x ln(1 + t / time_s)` newtons: its mean over the first ten times `time_s`.
pub(crate) fn drift_rate(x: f64, time_s: f64) -> f64 {
    x * libm::log1p(10.0) / (10.0 * time_s) * 60.0
}

/// Amplitude and times of a load that fades by a smooth spectrum.
fn fading(ready: &PreparedStudy, effect: Effect, free: &Free) -> (Three, Vec<Named>) {
    let seen = ready.seen_periods();
    // A period so many widths from the median, and its interval: open beyond what the recordings last, and shorter than their steps. The
    // median is a number of the fit with a profile of its own, and the outer ones are profiled in its place.
    let period = |widths: f64| {
        let (log, error) = free.sum(&[0.0, 1.0, widths]);
        let period = libm::exp(log);
        let profile = match widths == 0.0 {
            true => free.profile(1),
            false => free.outer(widths > 0.0, log),
        };
        let is_open = profile.map_or((false, false), |known| known.is_open);
        let by_error = (log - HALF * error, log + HALF * error);
        let ends = profile.map_or(by_error, |known| known.ends);
        let low = libm::exp(if is_open.0 { by_error.0 } else { ends.0 });
        let high = libm::exp(if is_open.1 { by_error.1 } else { ends.1 });
        let factor = (high / low).sqrt();
        // Wholly outside of what recordings show it is the law's extrapolation, and no bound.
        let is_outside = low > seen.1 || high < seen.0;
        let is_open = (
            is_open.0 || low < seen.0 || factor > MOST || is_outside,
            is_open.1 || high > seen.1 || factor > MOST || is_outside,
        );
        (
            period,
            if is_open.0 { f64::NEG_INFINITY } else { low },
            if is_open.1 { f64::INFINITY } else { high },
        )
    };
    if effect == Effect::Drainage {
        let over = MIDDLE * ready.scales.radius.powi(2);
        let (middle, low, high) = period(0.0);
        let name = "diffusivity_mm2_per_s";
        let end = |of: f64, open: f64| if of.is_finite() { over / of } else { open };
        let ends = (end(high, f64::NEG_INFINITY), end(low, f64::INFINITY));
        let diffusivity = (name, over / middle, ends.0, ends.1);
        let drop = ready.mean_drop();
        let share = at_most(interval(free, &|x| (x / drop).max(0.0)), MOST_SHARE);
        let spread = of_number(free, 2, &|x| x.max(0.0));
        let (reference, drained) = (ready.scales.radius, ready.drained_poisson_ratio());
        let fixed = |name, value| (name, value, value, value);
        return (
            share,
            vec![
                diffusivity,
                ("spread", spread.0, spread.1, spread.2),
                fixed("radius_mm", reference),
                fixed("drained_poisson_ratio", drained),
            ],
        );
    }
    let names = ["time_1_s", "time_2_s", "time_3_s"];
    let times = names.into_iter().zip([-OUTER, 0.0, OUTER]);
    let times = times.map(|(name, widths)| {
        let (period, low, high) = period(widths);
        (name, period, low, high)
    });
    let third = 1.0 / 3.0;
    let weights = ["weight_1", "weight_2", "weight_3"].map(|name| (name, third, third, third));
    let numbers = times.chain(weights).collect();
    (interval(free, &|x| x.clamp(0.0, 0.99)), numbers)
}

/// A value and its interval up to the most that it may be: open above where the interval ends beyond.
fn at_most((value, low, high): Three, most: f64) -> Three {
    let end = if high > most { f64::INFINITY } else { high };
    (value.min(most), low.min(most), end)
}

/// Largest factor on a number that is stated as its interval; beyond it the number is open on both sides.
const MOST: f64 = 30.0;

/// Amplitude and length of a load that is lost with travel.
fn travelling(lengths: &[f64], free: &Free) -> (Three, Vec<Named>) {
    let (sum, error) = free.sum(&vec![1.0; lengths.len()]);
    let share = free.sum_interval((sum, error), &|x| x.clamp(0.0, 0.99));
    let half = match share.1.is_finite() && share.2.is_finite() {
        true => 0.5 * (share.2 - share.1),
        false => f64::INFINITY,
    };
    let each = free.values.iter().zip(lengths);
    let mean_log = match sum > 0.0 {
        true => each.map(|(f, p)| f * libm::log(*p)).sum::<f64>() / sum,
        false => libm::log(lengths[0]),
    };
    let mean = libm::exp(mean_log);
    // Half of a length's step either way, widened by how little the shares are known.
    let factor = libm::exp(1.0 + half / sum.max(1e-3));
    let length = match factor > MOST {
        true => ("length_mm", mean, f64::NEG_INFINITY, f64::INFINITY),
        false => ("length_mm", mean, mean / factor, mean * factor),
    };
    (share, vec![length])
}

/// Work of adhesion, J/m2, that pulls the largest contact with this part of the largest force: `F = 1.75 pi w R`, between the limits
/// of JKR and DMT, with the `R` of [`round_radius`].
fn work_of(ready: &PreparedStudy, share: f64) -> f64 {
    let deepest = ready.scales.deepest;
    let at = |depth: f64| {
        let radii = ready.elastic.places.iter().map(|p| radius(p, depth));
        radii.fold(0.0, f64::max)
    };
    let tool = round_radius((at(SHALLOW * deepest), at(deepest)), deepest);
    share * ready.scales.forces.1 / (1.75 * std::f64::consts::PI * tool) * 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By a sum of a million steps.
    #[test]
    fn outer_third_mean_of_a_normal_distribution() {
        let (mut weights, mut sums) = ([0.0; 3], [0.0; 3]);
        let at = |n: i32| -8.0 + 16.0 * (f64::from(n) + 0.5) / 1e6;
        let whole: f64 = (0..1_000_000)
            .map(|n| libm::exp(-0.5 * at(n).powi(2)))
            .sum();
        let mut before = 0.0;
        for n in 0..1_000_000 {
            let weight = libm::exp(-0.5 * at(n).powi(2)) / whole;
            let third = ((3.0 * before) as usize).min(2);
            weights[third] += weight;
            sums[third] += weight * at(n);
            before += weight;
        }
        let means: Vec<f64> = sums.iter().zip(weights).map(|(s, w)| s / w).collect();
        for (mean, wanted) in means.iter().zip([-OUTER, 0.0, OUTER]) {
            assert!((mean - wanted).abs() < 1e-4, "{means:?}");
        }
    }

    #[test]
    fn a_share_beyond_the_most_is_open_above() {
        assert_eq!(at_most((0.4, 0.3, 0.6), 0.9), (0.4, 0.3, 0.6));
        assert_eq!(at_most((0.8, 0.7, 1.2), 0.9), (0.8, 0.7, f64::INFINITY));
        assert_eq!(at_most((1.3, 1.1, 1.5), 0.9), (0.9, 0.9, f64::INFINITY));
    }

    #[test]
    fn unit_amplitude_is_omitted_beside_other_numbers() {
        let names = |amplitude: Three, numbers: &[Named]| -> Vec<&str> {
            let listed = list(Effect::StiffSkin, amplitude, numbers);
            listed.iter().map(|number| number.name).collect()
        };
        let modulus = ("modulus_mpa", 0.2, 0.1, 0.3);
        assert_eq!(names(WHOLE, &[modulus]), ["modulus_mpa"]);
        assert_eq!(names(WHOLE, &[]), ["amplitude"]);
        let part = (0.34, 0.31, 0.37);
        assert_eq!(names(part, &[modulus]), ["amplitude", "modulus_mpa"]);
    }
}
