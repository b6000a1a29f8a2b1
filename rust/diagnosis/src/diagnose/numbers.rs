//! The numbers of a screened mechanism in the catalogue's terms.

use thenar_contact::effects::Effect;

use super::elastic::{radius, skin_share};
use super::findings::{Number, Switched};
use super::ladder::Scored;
use super::mechanism::{Acts, Clock, Measure, Mechanism};
use super::model::{Kind, Model};
use super::prepare::Prepared;

/// Half width of a 90 % interval in standard errors.
const HALF: f64 = 1.645;
/// Share of the force that the catalogue's drainage loses, with its own drained Poisson's ratio of 0.3.
const DROP: f64 = 0.285_714;
/// Time, in a^2 / D, of the main branch of the catalogue's drainage.
const MAIN_BRANCH: f64 = 0.605;

/// Values of a mechanism's free numbers with their standard errors, `number` being its place in the model.
pub fn free_numbers(ready: &Prepared, scored: &Scored, number: usize) -> Vec<(f64, f64)> {
    let screen = ready.screen();
    let model = Model::new(&screen, &scored.mechanisms);
    let all = model.coordinates.iter().enumerate();
    let own = all.filter(|(_, c)| matches!(c.kind, Kind::Of(of, _) if of == number));
    own.map(|(k, _)| {
        let variance = scored.refit.covariance[(k, k)].max(0.0);
        (scored.refit.at[k], variance.sqrt())
    })
    .collect()
}

/// Standard error of the sum of a mechanism's free numbers, of which one stands for its neighbor.
fn sum_error(ready: &Prepared, scored: &Scored, number: usize) -> f64 {
    let screen = ready.screen();
    let model = Model::new(&screen, &scored.mechanisms);
    let all = model.coordinates.iter().enumerate();
    let own = all.filter(|(_, c)| matches!(c.kind, Kind::Of(of, _) if of == number));
    let own: Vec<usize> = own.map(|(k, _)| k).collect();
    let pairs = own.iter().flat_map(|a| own.iter().map(move |b| (*a, *b)));
    let variance: f64 = pairs.map(|at| scored.refit.covariance[at]).sum();
    variance.max(0.0).sqrt()
}

/// The mechanism as the catalogue has it: what a finding tells, and what the model is switched to.
pub fn told(ready: &Prepared, scored: &Scored, number: usize) -> (Vec<Number>, Switched) {
    let mechanism = &scored.mechanisms[number];
    let free = free_numbers(ready, scored, number);
    let effect = mechanism.effect;
    let error = sum_error(ready, scored, number);
    let (amplitude, numbers) = values(ready, (mechanism, &free, error));
    let unit = |name: &str| {
        let entry = effect.entry().shape.iter().find(|n| n.name == name);
        entry.map_or("1", |n| n.unit)
    };
    let tell = |(name, value, low, high): &(&'static str, f64, f64, f64)| Number {
        name,
        value: *value,
        interval: (low.min(*high), low.max(*high)),
        unit: unit(name),
    };
    let mut list: Vec<Number> = vec![Number {
        name: "amplitude",
        value: amplitude.0,
        interval: (amplitude.1, amplitude.2),
        unit: "1",
    }];
    list.extend(numbers.iter().map(tell));
    let choices = match (&mechanism.acts, effect) {
        (Acts::Stiffens(Measure::Depth), _) => vec![("law", "exponential"), ("measure", "depth")],
        (Acts::Stiffens(Measure::Strain), _) => vec![("law", "exponential"), ("measure", "strain")],
        (Acts::Late, _) => vec![("channel", "force")],
        (Acts::Offset, _) => vec![("channel", "force")],
        _ => Vec::new(),
    };
    let known = |name: &str| effect.entry().choices.iter().any(|c| c.name == name);
    let switched = Switched {
        name: effect.name(),
        amplitude: amplitude.0,
        numbers: numbers.iter().map(|n| (n.0, n.1)).collect(),
        choices: choices
            .into_iter()
            .filter(|(name, _)| known(name))
            .collect(),
    };
    (list, switched)
}

type Three = (f64, f64, f64);
type Named = (&'static str, f64, f64, f64);

/// Amplitude and shape numbers, each with its interval.
fn values(
    ready: &Prepared,
    (mechanism, free, error_of_sum): (&Mechanism, &[(f64, f64)], f64),
) -> (Three, Vec<Named>) {
    let (value, error) = free[0];
    let interval = |scale: &dyn Fn(f64) -> f64| {
        (
            scale(value),
            scale(value - HALF * error),
            scale(value + HALF * error),
        )
    };
    let whole: Three = (1.0, 1.0, 1.0);
    let named = |name: &'static str, three: Three| vec![(name, three.0, three.1, three.2)];
    match &mechanism.acts {
        Acts::Fades { clock, periods } => fading(
            ready,
            (mechanism.effect, *clock, periods),
            (free, error_of_sum),
        ),
        Acts::Softens {
            travel_mm,
            recovery_s,
        } => {
            let shares = interval(&|x| x.clamp(0.0, 0.95));
            let shape = vec![
                ("travel_mm", *travel_mm, travel_mm / 2.0, travel_mm * 2.0),
                ("recovery_s", *recovery_s, 5.0, 1000.0),
            ];
            (shares, shape)
        }
        Acts::Clings { .. } => {
            let work = interval(&|x| work_of(ready, x.max(0.0)));
            (whole, named("work_j_per_m2", work))
        }
        Acts::Tabled => {
            let own = ready.base_material;
            match mechanism.effect {
                Effect::Bone => {
                    let thickness = interval(&|x| own.thickness_mm * libm::exp(x));
                    (whole, named("thickness_mm", thickness))
                }
                Effect::Compressibility => {
                    let poisson = interval(&|x| own.poisson_ratio - x.max(0.0));
                    (whole, named("poisson_ratio", poisson))
                }
                _ => (interval(&|x| skin_share(x.max(0.0))), Vec::new()),
            }
        }
        Acts::Stiffens(measure) => {
            let (name, most) = match measure {
                Measure::Depth => ("reference_depth_mm", ready.scales.deepest),
                Measure::Strain => ("reference_strain", ready.screen().largest_strain()),
            };
            (whole, named(name, interval(&|x| most / x.max(0.01))))
        }
        Acts::GainStep { .. } => (whole, named("error", interval(&|x| libm::exp(x) - 1.0))),
        Acts::Offset => (whole, named("offset_n", interval(&|x| x))),
        Acts::Drifts { time_s } => {
            // Mean rate over the first ten times the creep's own time.
            let rate = |x: f64| x * libm::log1p(10.0) / (10.0 * time_s) * 60.0;
            (whole, named("rate_n_per_min", interval(&rate)))
        }
        Acts::Saturates => {
            let ceiling = interval(&|x| ready.scales.forces.1 * libm::exp(x));
            (whole, named("ceiling_n", ceiling))
        }
        Acts::Blind => (
            whole,
            named("floor_n", interval(&|x| x.max(0.0) * ready.scales.forces.0)),
        ),
        Acts::Yields => (
            whole,
            named("compliance_mm_per_n", interval(&|x| x.max(0.0))),
        ),
        Acts::Late => (whole, named("delay_s", interval(&|x| x))),
    }
}

/// Amplitude and times of branches that fade.
fn fading(
    ready: &Prepared,
    (effect, clock, periods): (Effect, Clock, &[f64]),
    (free, error): (&[(f64, f64)], f64),
) -> (Three, Vec<Named>) {
    let sum: f64 = free.iter().map(|f| f.0).sum();
    let scale = if effect == Effect::Drainage {
        1.0 / DROP
    } else {
        1.0
    };
    let within = |x: f64| (x * scale).clamp(0.0, 0.99);
    let amplitude = (
        within(sum),
        within(sum - HALF * error),
        within(sum + HALF * error),
    );
    let each = free.iter().zip(periods);
    let mean_log = match sum > 0.0 {
        true => each.map(|(f, p)| f.0 * libm::log(*p)).sum::<f64>() / sum,
        false => libm::log(periods[0]),
    };
    let mean = libm::exp(mean_log);
    // Half a period's step either way, widened by how little the shares are known.
    let factor = libm::exp(1.0 + HALF * error / sum.max(1e-3)).min(30.0);
    let numbers = match (effect, clock) {
        (Effect::Drainage, _) => {
            let d = MAIN_BRANCH * ready.scales.radius.powi(2) / mean;
            vec![("diffusivity_mm2_per_s", d, d / factor, d * factor)]
        }
        (Effect::RateIndependentLoss, _) => vec![("length_mm", mean, mean / factor, mean * factor)],
        _ => {
            let names = ["time_1_s", "time_2_s", "time_3_s"];
            let weights = ["weight_1", "weight_2", "weight_3"];
            let (free, periods) = in_three(free, periods);
            let times = names.iter().zip(&periods).map(|(n, p)| (*n, *p, *p, *p));
            let share = |x: f64| (x / sum.max(1e-9)).clamp(0.0, 1.0);
            let shares = weights.iter().zip(&free).map(|(n, f)| {
                (
                    *n,
                    share(f.0),
                    share(f.0 - HALF * f.1),
                    share(f.0 + HALF * f.1),
                )
            });
            times.chain(shares).collect()
        }
    };
    (amplitude, numbers)
}

/// Branches of a spectrum as the catalogue's three at most: the fastest together, and the slowest, each at their mean time.
fn in_three(free: &[(f64, f64)], periods: &[f64]) -> (Vec<(f64, f64)>, Vec<f64>) {
    if free.len() <= 3 {
        return (free.to_vec(), periods.to_vec());
    }
    let side = (free.len() - 1) / 2;
    let parts = [
        0..side,
        side..free.len() - side,
        free.len() - side..free.len(),
    ];
    let one = |part: std::ops::Range<usize>| {
        let share: f64 = free[part.clone()].iter().map(|f| f.0).sum();
        let error = free[part.clone()].iter().map(|f| f.1 * f.1).sum::<f64>();
        let count = part.len() as f64;
        let logs = part.clone().map(|k| {
            let weight = if share > 0.0 {
                free[k].0 / share
            } else {
                1.0 / count
            };
            weight * libm::log(periods[k])
        });
        ((share, error.sqrt()), libm::exp(logs.sum::<f64>()))
    };
    parts.into_iter().map(one).unzip()
}

/// Work of adhesion, J/m2, that pulls the largest contact with this part of the largest force: `F = 1.75 pi w R`, between the limits
/// of JKR and DMT, with `R = a^2 / d`.
fn work_of(ready: &Prepared, share: f64) -> f64 {
    let deepest = ready.scales.deepest;
    let radii = ready.elastic.places.iter().map(|p| radius(p, deepest));
    let tool = radii.fold(1e-3, f64::max).powi(2) / deepest;
    share * ready.scales.forces.1 / (1.75 * std::f64::consts::PI * tool) * 1e3
}
