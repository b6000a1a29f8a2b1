//! Estimates of a fitted effect in the catalogue's terms and units, with intervals.

use nalgebra::{DMatrix, DVector};
use thenar_contact::effects::Effect;

use crate::findings::{Number, Switched};
use thenar_inference::forward::surrogate::candidate_model::Model;
use thenar_inference::forward::surrogate::mechanism::{
    DeformationMeasure, Law, Mechanism, UseAtStart,
};
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::forward::surrogate::relaxation_spectrum::Spectrum;
use thenar_inference::forward::surrogate::tissue_laws::RAMP;
use thenar_inference::forward::tables::elastic_table::radius;
use thenar_inference::forward::tables::stiff_skin::{ratio, thickness};
use thenar_inference::least_squares::surrogate_fit::Refit;
use thenar_inference::parameters::surrogate_parameter::Kind;
use thenar_inference::selection::scored::Scored;

/// Half width of a 90 % interval in standard errors.
const HALF: f64 = 1.645;
/// Share of the force that the catalogue's drainage loses, with its own drained Poisson's ratio of 0.3.
const DROP: f64 = 0.285_714;
/// Time, in a^2 / D, of the main branch of the catalogue's drainage.
const MAIN_BRANCH: f64 = 0.605;

/// A mechanism's free numbers, with what is known of their errors.
pub struct Free {
    /// In the model's order.
    pub values: Vec<f64>,
    /// Covariance of their errors.
    covariance: DMatrix<f64>,
    /// The pulp's modulus at first touch as it was fitted with them, MPa.
    shear_mpa: f64,
}

impl Free {
    /// Those of mechanism `number` of a model.
    pub fn of(ready: &PreparedStudy, scored: &Scored, number: usize) -> Free {
        let surrogate = ready.surrogate();
        let model = Model::new(&surrogate, &scored.mechanisms);
        let all = model.coordinates.iter().enumerate();
        let own = all.filter(|(_, c)| matches!(c.kind, Kind::Of(of, _) if of == number));
        let own: Vec<usize> = own.map(|(k, _)| k).collect();
        Free::taken(&scored.refit, &own)
    }

    /// Those of a fit.
    fn taken(refit: &Refit, own: &[usize]) -> Free {
        Free {
            values: own.iter().map(|k| refit.at[*k]).collect(),
            covariance: refit.covariance.select_rows(own).select_columns(own),
            shear_mpa: libm::exp(refit.at[0]),
        }
    }

    /// A sum of the numbers, each times its weight, and its standard error.
    pub fn sum(&self, weights: &[f64]) -> (f64, f64) {
        let value = self.values.iter().zip(weights).map(|(v, w)| v * w).sum();
        let weights = DVector::from_column_slice(weights);
        let variance = (&self.covariance * &weights).dot(&weights);
        (value, variance.max(0.0).sqrt())
    }

    /// The first number and its standard error.
    pub fn first(&self) -> (f64, f64) {
        let mut weights = vec![0.0; self.values.len()];
        weights[0] = 1.0;
        self.sum(&weights)
    }
}

/// The mechanism as the catalogue has it: what a finding tells, and what the model is switched to.
pub fn numbers_of_effect(
    ready: &PreparedStudy,
    scored: &Scored,
    number: usize,
) -> (Vec<Number>, Switched) {
    let mechanism = &scored.mechanisms[number];
    let free = Free::of(ready, scored, number);
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
fn choices(mechanism: &Mechanism) -> Vec<(&'static str, &'static str)> {
    let mut choices = match &mechanism.law {
        Law::Stiffening(measure, growth) => {
            let measure = match measure {
                DeformationMeasure::Depth => "depth",
                DeformationMeasure::Strain => "strain",
            };
            vec![("law", growth.law()), ("measure", measure)]
        }
        Law::Delay | Law::Offset => vec![("channel", "force")],
        _ => Vec::new(),
    };
    let known = mechanism.effect.entry().choices;
    choices.retain(|(name, _)| known.iter().any(|c| c.name == *name));
    choices
}

type Three = (f64, f64, f64);
type Named = (&'static str, f64, f64, f64);
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
            let shape = vec![
                ("travel_mm", *travel_mm, travel_mm / 2.0, travel_mm * 2.0),
                ("recovery_s", *recovery_s, 5.0, 1000.0),
            ];
            (shares, shape)
        }
        Law::Adhesion { .. } => {
            let work = interval(free, &|x| work_of(ready, x.max(0.0)));
            let work = ("work_j_per_m2", work.0, work.1, work.2);
            (WHOLE, vec![work, reach(ready, free)])
        }
        Law::Tabulated(form) if mechanism.effect == Effect::StiffSkin => (WHOLE, skin(*form, free)),
        law => {
            let listed = one(ready, (mechanism.effect, law)).map(|(name, scale)| {
                let three = interval(free, &*scale);
                (name, three.0, three.1, three.2)
            });
            (WHOLE, listed.into_iter().collect())
        }
    }
}

/// Modulus and thickness of a stiff skin.
fn skin(form: usize, free: &Free) -> Vec<Named> {
    let pulp = 3.0 * free.shear_mpa;
    let modulus = interval(free, &|x| pulp * ratio(x));
    let thick = thickness(form);
    vec![
        ("modulus_mpa", modulus.0, modulus.1, modulus.2),
        ("thickness_mm", thick.0, thick.1, thick.2),
    ]
}

/// Range of a grip.
fn reach(ready: &PreparedStudy, free: &Free) -> Named {
    let (log, error) = free.sum(&[0.0, 1.0]);
    let range = libm::exp(log) * ready.scales.deepest * RAMP;
    let factor = libm::exp(HALF * error).min(MOST);
    ("range_mm", range, range / factor, range * factor)
}

/// The first number and the ends of its interval, in other terms.
fn interval(free: &Free, scale: &dyn Fn(f64) -> f64) -> Three {
    let (value, error) = free.first();
    let ends = [0.0, -HALF * error, HALF * error].map(|off| scale(value + off));
    (ends[0], ends[1], ends[2])
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
        // Mean rate over the first ten times the creep's own time.
        Law::Drift { time_s } => (
            "rate_n_per_min",
            Box::new(move |x| x * libm::log1p(10.0) / (10.0 * time_s) * 60.0),
        ),
        Law::Saturation(_) => ("ceiling_n", Box::new(move |x| most * libm::exp(x))),
        Law::Floor(_) => ("floor_n", Box::new(move |x| x.max(0.0) * least)),
        Law::Compliance => ("compliance_mm_per_n", Box::new(|x| x.max(0.0))),
        Law::Delay => ("delay_s", Box::new(|x| x)),
        Law::Relaxation { .. } | Law::Softening { .. } | Law::Adhesion { .. } => return None,
    };
    Some((name, scale))
}

/// Mean of the outer thirds of a normal law, in widths from its middle.
const OUTER: f64 = 1.090_8;

/// Amplitude and times of a load that fades by a smooth spectrum.
fn fading(ready: &PreparedStudy, effect: Effect, free: &Free) -> (Three, Vec<Named>) {
    // A period so many widths from the median, and its interval.
    let period = |widths: f64| {
        let (log, error) = free.sum(&[0.0, 1.0, widths]);
        let factor = libm::exp(HALF * error).min(MOST);
        let period = libm::exp(log);
        (period, period / factor, period * factor)
    };
    if effect == Effect::Drainage {
        let over = MAIN_BRANCH * ready.scales.radius.powi(2);
        let (middle, low, high) = period(0.0);
        let name = "diffusivity_mm2_per_s";
        let diffusivity = (name, over / middle, over / high, over / low);
        return (within(free.first(), 1.0 / DROP), vec![diffusivity]);
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
    (within(free.first(), 1.0), numbers)
}

/// Largest factor on a period that is stated as its interval.
const MOST: f64 = 30.0;

/// Amplitude and length of a load that is lost with travel.
fn travelling(lengths: &[f64], free: &Free) -> (Three, Vec<Named>) {
    let (sum, error) = free.sum(&vec![1.0; lengths.len()]);
    let each = free.values.iter().zip(lengths);
    let mean_log = match sum > 0.0 {
        true => each.map(|(f, p)| f * libm::log(*p)).sum::<f64>() / sum,
        false => libm::log(lengths[0]),
    };
    let mean = libm::exp(mean_log);
    // Half of a length's step either way, widened by how little the shares are known.
    let factor = libm::exp(1.0 + HALF * error / sum.max(1e-3)).min(MOST);
    let length = ("length_mm", mean, mean / factor, mean * factor);
    (within((sum, error), 1.0), vec![length])
}

/// A share times `scale` and its interval, between none and nearly all.
fn within((share, error): (f64, f64), scale: f64) -> Three {
    let one = |x: f64| (x * scale).clamp(0.0, 0.99);
    (
        one(share),
        one(share - HALF * error),
        one(share + HALF * error),
    )
}

/// Work of adhesion, J/m2, that pulls the largest contact with this part of the largest force: `F = 1.75 pi w R`, between the limits
/// of JKR and DMT, with `R = a^2 / d`.
fn work_of(ready: &PreparedStudy, share: f64) -> f64 {
    let deepest = ready.scales.deepest;
    let radii = ready.elastic.places.iter().map(|p| radius(p, deepest));
    let tool = radii.fold(1e-3, f64::max).powi(2) / deepest;
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

    #[test]
    fn standard_error_of_a_sum_includes_covariance() {
        let refit = Refit {
            at: vec![7.0, 1.0, 2.0],
            deviance: 0.0,
            residual: Vec::new(),
            simulated: Vec::new(),
            covariance: DMatrix::from_row_slice(
                3,
                3,
                &[1.0, 0.5, 0.5, 0.5, 4.0, -2.0, 0.5, -2.0, 9.0],
            ),
        };
        let free = Free::taken(&refit, &[1, 2]);
        assert_eq!(free.first(), (1.0, 2.0));
        assert_eq!(free.sum(&[1.0, 1.0]), (3.0, 3.0));
        assert_eq!(free.sum(&[0.0, 1.0]), (2.0, 3.0));
    }
}
