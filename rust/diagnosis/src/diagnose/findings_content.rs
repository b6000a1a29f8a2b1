//! What was found in the terms of a diagnosis: findings, rivals, curves, smallest sizes, and the model as it is switched.

use thenar_contact::effects::{Effect, Sign};
use thenar_recordings::Study;

use crate::checks::signatures::looked_for;
use crate::diagnose::effect_numbers::{Free, told};
use crate::diagnose::findings::{Curve, Finding, Rival, Switched, When, Where};
use crate::diagnose::gates::{Decision, needed};
use crate::diagnose::wording::{PHASES, phase_number};
use crate::fit::fitting::Fitting;
use crate::forward::surrogate::force_recording::Course;
use crate::forward::surrogate::mechanism::{Acts, Growth, Mechanism};
use crate::forward::surrogate::model::Model;
use crate::forward::surrogate::prepared_study::Prepared;
use crate::forward::surrogate::relaxation_spectrum::Spectrum;
use crate::forward::surrogate::screen::Screen;
use crate::least_squares::surrogate_fit::{covariance, huber, left_by_fit};
use crate::selection::scored::{Rungs, Scored};

/// Findings of what is named.
pub fn findings(
    study: &Study,
    (ready, rungs): (&Prepared, &Rungs),
    decision: &Decision<'_>,
    probabilities: &[(Vec<&'static str>, f64)],
) -> Vec<Finding> {
    let Some(named) = decision.named else {
        return Vec::new();
    };
    let names = named.names();
    let own = probabilities.iter().find(|(other, _)| *other == names);
    let confidence = own.map_or(0.0, |(_, p)| p.min(0.99));
    let of = |number: usize| {
        let mechanism = &named.mechanisms[number];
        let entry = mechanism.effect.entry();
        let (numbers, _) = told(ready, named, number);
        Finding {
            effect: entry.name,
            kind: entry.kind(),
            confidence,
            numbers,
            place: (!mechanism.is_instrument()).then(|| Where {
                site: study.recordings[ready.courses[0].recording].site.clone(),
                region: study.skin.region_names.first().cloned(),
                center_mm: None,
                radius_mm: None,
                area_90_mm2: None,
                vertices: Vec::new(),
            }),
            when: when(ready, rungs, named),
            depends_on: depends_on(mechanism.effect),
            consequences: looked_for(ready, (named, mechanism.effect)),
        }
    };
    (0..named.mechanisms.len()).map(of).collect()
}

/// What a finding depends on, from the signs that the catalogue says it must leave.
fn depends_on(effect: Effect) -> Vec<&'static str> {
    let mut found = Vec::new();
    let mut add = |what: &'static str| {
        if !found.contains(&what) {
            found.push(what);
        }
    };
    for consequence in effect.entry().consequences {
        match consequence.sign {
            Sign::ForceFallsInHold | Sign::TrendsWithoutContact | Sign::LagsBehind => add("time"),
            Sign::ForceGrowsWithRate => add("rate"),
            Sign::LoopIsOpen | Sign::ForcePulls | Sign::FollowsSliding => add("direction"),
            Sign::ClockGrowsWithArea
            | Sign::SmallToolsFeelStiffer
            | Sign::StiffensWithContactSize => add("radius"),
            Sign::LaterCyclesAreSofter | Sign::RestRestores => add("cycle"),
            Sign::CurveBends | Sign::AreaChanges | Sign::ForceIsSmaller | Sign::ForceIsLarger => {
                add("depth")
            }
            Sign::BelongsToThePlace | Sign::BelongsToTheCrease => add("skin_position"),
            Sign::MovesWithTheMat => add("sensor_position"),
            Sign::ClipsAtCeiling
            | Sign::SilentBelowFloor
            | Sign::YieldsToForceOnly
            | Sign::ScalesReadings => {
                add("force");
            }
            _ => {}
        }
    }
    found
}

/// Fall of the deviance by phase: load, hold, unload, rest.
fn ledger(ready: &Prepared, rungs: &Rungs, scored: &Scored) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for (sample, _, phase) in ready.screen().phases() {
        let fall = huber(rungs.base.refit.residual[sample]) - huber(scored.refit.residual[sample]);
        sums[phase_number(phase)] += 0.5 * fall / rungs.temper;
    }
    sums
}

fn when(ready: &Prepared, rungs: &Rungs, scored: &Scored) -> Option<When> {
    let sums = ledger(ready, rungs, scored);
    let most = (0..4).fold(0, |best, k| if sums[k] > sums[best] { k } else { best });
    let mut by_course: Vec<(f64, usize)> = (0..ready.courses.len()).map(|c| (0.0, c)).collect();
    for (sample, course, _) in ready.screen().phases() {
        by_course[course].0 +=
            huber(rungs.base.refit.residual[sample]) - huber(scored.refit.residual[sample]);
    }
    by_course.sort_by(|a, b| b.0.total_cmp(&a.0));
    let clearest = by_course.first()?.0;
    let shows = |(fall, _): &&(f64, usize)| *fall > 0.2 * clearest;
    let shown: Vec<usize> = by_course.iter().filter(shows).map(|(_, c)| *c).collect();
    let rows = shown
        .iter()
        .flat_map(|c| &ready.courses[*c].rows)
        .filter(|r| phase_number(r.phase) == most);
    let (mut time, mut depth, mut cycles) =
        ([f64::INFINITY, 0.0], [f64::INFINITY, 0.0], [u32::MAX, 0]);
    for row in rows {
        time = [f64::min(time[0], row.time_s), f64::max(time[1], row.time_s)];
        depth = [
            f64::min(depth[0], row.depth_mm),
            f64::max(depth[1], row.depth_mm),
        ];
        cycles = [cycles[0].min(row.cycle), cycles[1].max(row.cycle)];
    }
    (cycles[0] != u32::MAX).then(|| When {
        recordings: shown
            .iter()
            .map(|c| ready.courses[*c].name.clone())
            .collect(),
        phase: PHASES[most],
        time_s: time,
        depth_mm: depth,
        cycles,
    })
}

/// What was tried, best first.
pub fn rivals(
    ready: &Prepared,
    rungs: &Rungs,
    probabilities: &[(Vec<&'static str>, f64)],
) -> Vec<Rival> {
    let of = |scored: &Scored| {
        let names = scored.names();
        let p = probabilities.iter().find(|(other, _)| *other == names);
        Rival {
            probability: p.map_or(0.0, |p| p.1),
            effects: names,
            evidence: scored.evidence,
            left: scored.coherent / rungs.base.coherent.max(1e-9),
            ledger: ledger(ready, rungs, scored),
        }
    };
    let mut all: Vec<Rival> = rungs
        .singles
        .iter()
        .chain(rungs.pairs.iter().take(10))
        .map(of)
        .collect();
    all.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    all
}

/// Measured, before and after, of every recording.
pub fn curves(ready: &Prepared, rungs: &Rungs, decision: &Decision<'_>) -> Vec<Curve> {
    let after = decision.named.unwrap_or(&rungs.base);
    let of = |course: &crate::forward::surrogate::force_recording::Course| {
        let rows: Vec<_> = course
            .rows
            .iter()
            .filter_map(|r| r.sample.map(|s| (r, s)))
            .collect();
        Curve {
            recording: course.name.clone(),
            time_s: rows.iter().map(|(r, _)| r.time_s).collect(),
            depth_mm: rows.iter().map(|(r, _)| r.depth_mm).collect(),
            measured_n: rows.iter().map(|(r, _)| r.force_n).collect(),
            before_n: rows
                .iter()
                .map(|(_, s)| rungs.base.refit.simulated[*s])
                .collect(),
            after_n: rows
                .iter()
                .map(|(_, s)| after.refit.simulated[*s])
                .collect(),
        }
    };
    ready.courses.iter().map(of).collect()
}

/// The smallest amplitude of every single effect that would have been detected; None where that is more than there can be.
///
/// Of a load that fades it is that of the spectrum with which a fit begins: where there is none, a fit ends at any.
pub fn smallest_seen(
    ready: &Prepared,
    rungs: &Rungs,
) -> Vec<(&'static str, Option<f64>, &'static str)> {
    let mut found = Vec::new();
    for scored in &rungs.singles {
        let mechanism = &scored.mechanisms[0];
        let least = needed(mechanism) + mechanism.price() as f64;
        let errors = (2.0 * least * rungs.temper).sqrt();
        let size = match mechanism.acts {
            Acts::Fades {
                spectrum: Spectrum::Smooth { .. },
                ..
            } => errors * error_at_start(ready, rungs, mechanism),
            Acts::Tabled(_) if mechanism.effect == Effect::StiffSkin => {
                size_that_leaves(&ready.screen(), rungs, (mechanism, errors))
            }
            Acts::Blind(_) => {
                let unread = unread(&ready.courses);
                let screen = Screen {
                    courses: &unread,
                    ..ready.screen()
                };
                size_that_leaves(&screen, rungs, (mechanism, errors)).max(screen.least_floor)
            }
            _ => errors * Free::of(ready, scored, 0).first().1,
        };
        let (value, unit, most) = in_words(ready, scored, size);
        let name = scored.mechanisms[0].effect.name();
        found.push((name, Some(value).filter(|v| *v <= most), unit));
    }
    found.sort_by_key(|(name, ..)| Effect::named(name));
    found
}

/// Standard error of a mechanism's first number, beside the base's as they were fitted and its others as a fit begins.
fn error_at_start(ready: &Prepared, rungs: &Rungs, mechanism: &Mechanism) -> f64 {
    let screen = ready.screen();
    let model = Model::new(&screen, std::slice::from_ref(mechanism));
    let own = rungs.base.refit.at.len();
    let starts = model.coordinates[own..].iter().map(|c| c.start);
    let at: Vec<f64> = rungs.base.refit.at.iter().copied().chain(starts).collect();
    let known: Vec<usize> = (own + 1..at.len()).collect();
    covariance(&screen, &model, (at, &known))[(own, own)].sqrt()
}

/// The size from which a mechanism leaves so many standard deviations once the base is fitted to it; beyond its bounds if it does at none. Of a skin,
/// which adds little at first: a standard error at no skin at all would say that it is never seen. Of a floor likewise.
fn size_that_leaves(
    screen: &Screen<'_>,
    rungs: &Rungs,
    (mechanism, errors): (&Mechanism, f64),
) -> f64 {
    let model = Model::new(screen, std::slice::from_ref(mechanism));
    let base = &rungs.base.refit.at;
    let most = model.coordinates[base.len()].bounds.1;
    let sizes: Vec<f64> = (0..=SIZES)
        .map(|k| most * k as f64 / SIZES as f64)
        .collect();
    let of =
        |size: &f64| screen.stacked(&screen.all_forces(&model, &[base, &[*size][..]].concat()));
    let changed: Vec<Vec<f64>> = sizes.iter().map(of).collect();
    let squares = left_by_fit(screen, &Model::new(screen, &[]), (base, &changed));
    let left: Vec<f64> = squares.iter().map(|s| s.max(0.0).sqrt()).collect();
    let Some(k) = left.iter().position(|left| *left >= errors) else {
        return 2.0 * most;
    };
    let before = k.saturating_sub(1);
    let share = (errors - left[before]) / (left[k] - left[before]).max(f64::MIN_POSITIVE);
    sizes[before] + share.min(1.0) * (sizes[k] - sizes[before])
}

/// The same recordings before anything was read of them.
fn unread(courses: &[Course]) -> Vec<Course> {
    let mut all = courses.to_vec();
    for row in all.iter_mut().flat_map(|course| &mut course.rows) {
        row.force_n = f64::NAN;
    }
    all
}

/// Sizes at which a mechanism is tried.
const SIZES: usize = 24;

/// A size in screening's own number as a person takes it, and the largest that there can be.
fn in_words(ready: &Prepared, scored: &Scored, size: f64) -> (f64, &'static str, f64) {
    let (least, most) = ready.scales.forces;
    let deepest = ready.scales.deepest;
    match &scored.mechanisms[0].acts {
        Acts::Fades { .. } | Acts::Softens { .. } => (size, "share of the force", 1.0),
        Acts::Clings { .. } => (size, "share of the largest force", 1.0),
        Acts::Tabled(_) => match scored.mechanisms[0].effect {
            Effect::Bone => (libm::exp(size) - 1.0, "share of the thickness", 1.0),
            Effect::Compressibility => (size, "of Poisson's ratio", 0.5),
            _ => {
                let ratio = crate::forward::tables::stiff_skin::ratio(size);
                (
                    ratio,
                    "times as stiff as pulp",
                    crate::forward::tables::stiff_skin::MOST,
                )
            }
        },
        Acts::Stiffens(_, Growth::Square) => (size, "share of the force", 1.0),
        Acts::Stiffens(..) | Acts::Saturates(_) | Acts::GainStep { .. } => {
            (libm::exp(size) - 1.0, "share of the force", 1.0)
        }
        Acts::Offset | Acts::Drifts { .. } => (size, "N", most),
        Acts::Blind(_) => (size * least, "N", most),
        Acts::Yields => (size, "mm/N", deepest / most.max(1e-12)),
        Acts::Late => (size, "s", longest(ready)),
    }
}

/// Length of the longest recording, s.
fn longest(ready: &Prepared) -> f64 {
    let last = |course: &Course| course.rows.last().map_or(0.0, |row| row.time_s);
    ready.courses.iter().map(last).fold(0.0, f64::max)
}

/// Fitted moduli by region: all in the proportion of the study's own.
pub fn materials(
    fitting: &Fitting,
    (ready, rungs): (&Prepared, &Rungs),
    decision: &Decision<'_>,
) -> Vec<(String, f64, f64)> {
    let at = &decision.named.unwrap_or(&rungs.base).refit.at;
    let (g0, g_lim) = (libm::exp(at[0]), libm::exp(at[1]));
    let tissue = &fitting.replay.tissue;
    let each = tissue.regions.iter().zip(&tissue.materials);
    each.map(|(region, m)| {
        let scale = m.g0_mpa / ready.base_material.g0_mpa;
        (region.clone(), g0 * scale, g_lim * scale)
    })
    .collect()
}

/// Effects as the model takes them.
pub fn effects(ready: &Prepared, decision: &Decision<'_>) -> Vec<Switched> {
    let Some(named) = decision.named else {
        return Vec::new();
    };
    (0..named.mechanisms.len())
        .map(|k| told(ready, named, k).1)
        .collect()
}

/// Numbers behind the verdict.
pub fn evidence(ready: &Prepared, rungs: &Rungs) -> Vec<(&'static str, f64)> {
    let n = rungs.samples as f64;
    let mut all = vec![
        ("samples", n),
        ("deviance_per_sample", rungs.base.refit.deviance / n),
        ("coherent_misfit_per_sample", rungs.base.coherent / n),
        ("noise_share", ready.noise_share()),
        ("noise_step", ready.noise.step[0]),
        ("temper", rungs.temper),
        ("repeat_gain_sd", ready.noise.gain),
        ("repeat_zero_sd_mm", ready.noise.zero_mm.unwrap_or(f64::NAN)),
        ("noise_memory_s", ready.noise.memory_s[0]),
    ];
    if let Some(unsteady) = rungs.unsteady {
        all.push(("noise_under_load_over_without", unsteady.ratio));
        all.push(("noise_of_one_size_up_to", unsteady.least));
    }
    if let Some(rhythm) = ready.noise.rhythm {
        all.push(("rhythm_hz", rhythm.hz));
        all.push(("rhythm_nats", rhythm.nats));
        all.push(("rhythm_chance", rhythm.chance));
    }
    if let Some(step) = rungs.gain_step {
        all.push(("gain_step_t", step.t));
        all.push(("gain_step_degrees", step.degrees));
        all.push(("gain_step_log", step.size.0));
    }
    all
}
