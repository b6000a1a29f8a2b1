//! Misfit that no listed effect explains: the variables it depends on, by held-out improvement of an empirical correction.
//!
//! What repeats share of the misfit is drawn over one variable after the other, as a factor of the force that is smooth in it, and each is
//! judged by what it removes on protocols that it was not fitted to.

use thenar_recordings::Study;

use crate::findings::Curve;
use crate::unlisted_finding::{Correction, NAMES, Unlisted};
use crate::wording::phase_name;
use thenar_inference::checks::heteroscedasticity::unmodeled_repeat_noise;
use thenar_inference::forward::surrogate::force_recording::{ForceRecording, Row};
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::forward::tables::elastic_table::radius;
use thenar_inference::noise::periodic_component::Rhythm;
use thenar_inference::selection::empirical_factor::{Factors, Point, VARIABLES, removed};
use thenar_inference::selection::scored::Rungs;

/// Part of a recording's largest force below which its misfit is no part of the force.
const LOADED: f64 = 0.05;
/// Part that a variable must remove on protocols it was not fitted to, for it to be told; and that up and down apart must add.
const TOLD: f64 = 0.25;
const APART: f64 = 0.05;

/// What is known of what has no name.
pub fn unlisted(study: &Study, ready: &PreparedStudy, rungs: &Rungs) -> Unlisted {
    let points = points(ready, rungs);
    let mut found = of_points(&points);
    found.rhythm = ready.noise.rhythm.filter(Rhythm::is_clear);
    if found.correction.is_none()
        && unmodeled_repeat_noise(&ready.noise, rungs.heteroscedasticity).is_some()
    {
        // What grows under load and is not shared.
        found.depends_on.push(("force", f64::NAN));
        found
            .depends_on
            .extend(found.rhythm.map(|_| ("time", f64::NAN)));
        return found;
    }
    let site = |point: &Point| &study.recordings[point.recording].site;
    let sites: Vec<&String> = points.iter().map(site).collect();
    let phases: Vec<&str> = points.iter().map(|p| phase_name(p.phase)).collect();
    let (site, phase) = (most(&points, &sites), most(&points, &phases));
    found.place = site.map(|site| (*site).clone()).zip(phase.copied());
    found
}

/// Under which of these keys most of the misfit beyond noise lies.
fn most<'a, K: PartialEq>(points: &[Point], keys: &'a [K]) -> Option<&'a K> {
    let beyond = |key: &K| -> f64 {
        let own = points.iter().zip(keys).filter(|(_, k)| *k == key);
        own.map(|(p, _)| p.weight * p.off * p.off - 1.0).sum()
    };
    keys.iter().max_by(|a, b| beyond(a).total_cmp(&beyond(b)))
}

fn points(ready: &PreparedStudy, rungs: &Rungs) -> Vec<Point> {
    let alike = |a: &ForceRecording, b: &ForceRecording| {
        a.protocol == b.protocol && a.place == b.place && a.rows.len() == b.rows.len()
    };
    let mut protocols: Vec<Vec<&ForceRecording>> = Vec::new();
    for course in &ready.courses {
        match protocols.iter_mut().find(|p| alike(p[0], course)) {
            Some(protocol) => protocol.push(course),
            None => protocols.push(vec![course]),
        }
    }
    let repeated = protocols.iter().enumerate().filter(|(_, p)| p.len() > 1);
    let of = |(number, repeats): (usize, &Vec<&ForceRecording>)| -> Vec<Point> {
        let rows = 0..repeats[0].rows.len();
        rows.filter_map(|n| point((ready, rungs), (number, repeats), n))
            .collect()
    };
    repeated.flat_map(of).collect()
}

/// Row `n` of a protocol; None where it is not in contact, or hardly loaded.
fn point(
    (ready, rungs): (&PreparedStudy, &Rungs),
    (protocol, repeats): (usize, &[&ForceRecording]),
    n: usize,
) -> Option<Point> {
    let samples: Option<Vec<usize>> = repeats.iter().map(|c| c.rows[n].sample).collect();
    let samples = samples?;
    let mean = |of: &dyn Fn(usize) -> f64| {
        samples.iter().map(|k| of(*k)).sum::<f64>() / samples.len() as f64
    };
    let simulated = &rungs.base.refit.simulated;
    let (base, off) = (
        mean(&|k| simulated[k]),
        mean(&|k| ready.values[k] - simulated[k]),
    );
    let one = repeats[0];
    if base < LOADED * one.most() {
        return None;
    }
    let variance = mean(&|k| ready.sigma[k] * ready.sigma[k]).max(f64::MIN_POSITIVE);
    Some(Point {
        protocol,
        recording: one.recording,
        x: variables(ready, one, (n, base))?,
        phase: one.rows[n].phase,
        base,
        off,
        weight: samples.len() as f64 / variance,
    })
}

/// What a row of a recording may depend on, by [`NAMES`]; None out of contact.
fn variables(
    ready: &PreparedStudy,
    one: &ForceRecording,
    (n, base): (usize, f64),
) -> Option<[f64; VARIABLES]> {
    let row = &one.rows[n];
    let touch = one.rows.iter().find(|row| row.depth_mm > 0.0)?;
    let fastest = one.rows.windows(2).map(speed).fold(0.0, f64::max);
    let contact = radius(&ready.elastic.places[one.place], row.depth_mm);
    let since = row.time_s - touch.time_s;
    let cycle = f64::from(row.cycle);
    (row.depth_mm > 0.0).then_some([row.depth_mm, base, contact, since, cycle, fastest])
}

/// Puts what a correction gives in the place of what was found into the curves of all recordings.
pub fn draw(ready: &PreparedStudy, rungs: &Rungs, correction: &Correction, curves: &mut [Curve]) {
    for (course, curve) in ready.courses.iter().zip(curves) {
        let rows = course.rows.iter().enumerate();
        let read = rows.filter_map(|(n, row)| Some((n, row, row.sample?)));
        for ((n, row, sample), after) in read.zip(&mut curve.after_n) {
            let base = rungs.base.refit.simulated[sample];
            *after = variables(ready, course, (n, base)).map_or(base, |x| {
                base * (1.0 + correction.factors.at(x[correction.variable], row.phase))
            });
        }
    }
}

fn speed(rows: &[Row]) -> f64 {
    (rows[1].depth_mm - rows[0].depth_mm) / (rows[1].time_s - rows[0].time_s).max(1e-9)
}

fn of_points(points: &[Point]) -> Unlisted {
    let best = |variable: usize| {
        let alone = removed(points, (variable, false))?;
        let apart =
            removed(points, (variable, true)).filter(|share| *share > alone.max(0.0) + APART);
        Some((variable, apart.is_some(), apart.unwrap_or(alone)))
    };
    let mut all: Vec<_> = (0..VARIABLES).filter_map(best).collect();
    all.retain(|(.., share)| *share > TOLD);
    all.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut depends_on: Vec<_> = all.iter().map(|(v, _, s)| (NAMES[*v].0, *s)).collect();
    let correction = all.first().map(|(variable, is_apart, removed)| {
        if *is_apart {
            depends_on.insert(1, ("direction", *removed));
        }
        let every: Vec<&Point> = points.iter().collect();
        Correction {
            variable: *variable,
            factors: Factors::of(&every, (*variable, *is_apart)),
            removed: *removed,
        }
    });
    Unlisted {
        depends_on,
        correction,
        rhythm: None,
        place: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use thenar_inference::observe::measured::Phase;
    use thenar_inference::random::Random;

    /// Four protocols of 60 rows to different depths by different tools; what is measured more is a part of the force, by depth and
    /// direction; and noise of 1 % of the largest force.
    fn study(part: impl Fn(f64, bool) -> f64) -> Vec<Point> {
        let mut random = Random::new(3);
        let mut all = Vec::new();
        for protocol in 0..4 {
            let stiffness = 1.0 + 0.7 * protocol as f64;
            for n in 1..60 {
                let is_leaving = n >= 30;
                let depth = if is_leaving { 60 - n } else { n } as f64 / 30.0;
                let base = stiffness * libm::pow(depth, 1.5);
                let noise = 0.01 * stiffness;
                let time = n as f64 * 0.1 * (1 + protocol) as f64;
                let phase = [Phase::Load, Phase::Unload][usize::from(is_leaving)];
                all.push(Point {
                    protocol,
                    recording: protocol,
                    x: [depth, base, stiffness * depth.sqrt(), time, 0.0, 1.0],
                    phase,
                    base,
                    off: base * part(depth, is_leaving) + noise * random.normal(),
                    weight: 1.0 / (noise * noise),
                });
            }
        }
        all
    }

    /// A pocket that gives way at half of the depth.
    #[test]
    fn depth_dependent_misfit_is_named_and_corrected_on_held_out_protocols() {
        let gives = |depth: f64, _: bool| -0.3 / (1.0 + libm::exp(-(depth - 0.5) / 0.05));
        let found = of_points(&study(gives));
        assert_eq!(found.depends_on[0].0, "depth", "{:?}", found.depends_on);
        assert!(
            found
                .depends_on
                .iter()
                .all(|(name, _)| *name != "direction")
        );
        let correction = found.correction.as_ref().unwrap();
        assert!(correction.removed > 0.9, "{}", correction.removed);
        for (at, change) in correction
            .factors
            .knots
            .iter()
            .zip(&correction.factors.change[0])
        {
            let off = change - gives(*at, false);
            assert!(off.abs() < 0.06, "{at}: {change}");
        }
        let told = found.told();
        assert!(
            told.starts_with("it goes with depth: the force is 3"),
            "{told}"
        );
        assert!(
            told.contains("% smaller at") && !told.contains("larger"),
            "{told}"
        );
    }

    /// Half of the squares are noise, which no correction removes and none need remove.
    #[test]
    fn removed_share_is_relative_to_reducible_misfit() {
        let points = study(|_, _| -0.016);
        let (squares, count) = (
            points.iter().map(|p| p.weight * p.off * p.off).sum::<f64>(),
            points.len() as f64,
        );
        assert!(
            squares < 2.5 * count && squares > 1.5 * count,
            "{squares} {count}"
        );
        let share = removed(&points, (0, false)).unwrap();
        assert!(share > 0.8 && share < 1.2, "{share}");
    }

    #[test]
    fn loading_and_unloading_get_separate_factors_where_they_differ() {
        let found = of_points(&study(
            |depth, out| if out { -0.2 * depth } else { 0.1 * depth },
        ));
        assert_eq!(found.depends_on[1].0, "direction", "{:?}", found.depends_on);
        let [going_in, going_out] = &found.correction.as_ref().unwrap().factors.change;
        assert!(going_in.last() > Some(&0.05) && going_out.last() < Some(&-0.1));
    }

    #[test]
    fn place_of_most_misfit_is_the_largest_sum() {
        let points = study(|_, out| if out { -0.2 } else { 0.02 });
        let phases: Vec<Phase> = points.iter().map(|p| p.phase).collect();
        assert_eq!(most(&points, &phases), Some(&Phase::Unload));
        assert_eq!(most::<Phase>(&[], &[]), None);
    }

    /// Noise is no misfit, and what is another in every protocol holds on none.
    #[test]
    fn no_correction_without_held_out_improvement() {
        let noise = of_points(&study(|_, _| 0.0));
        assert!(noise.correction.is_none(), "{:?}", noise.depends_on);
        let mut other = study(|_, _| 0.0);
        for point in &mut other {
            point.off += point.base * if point.protocol % 2 == 0 { 0.2 } else { -0.2 };
        }
        let other = of_points(&other);
        assert!(
            other
                .depends_on
                .iter()
                .all(|(name, _)| !["depth", "time"].contains(name)),
            "{:?}",
            other.depends_on
        );
        let one: Vec<Point> = study(|d, _| d)
            .into_iter()
            .filter(|p| p.protocol == 0)
            .collect();
        assert!(
            of_points(&one)
                .told()
                .starts_with("what it depends on cannot be told")
        );
    }
}
