//! Findings, rivals, curves, fitted materials and evidence of a diagnosis, from the fitted candidates.

use thenar_contact::effects::{Effect, Sign};
use thenar_inference::forward::mesh::replay::Replay;
use thenar_recordings::Study;

use crate::effect_numbers::numbers_of_effect;
use crate::findings::{Curve, Finding, Rival, Switched, When, Where};
use crate::gates::decision::Decision;
use crate::gates::size_gate::Sized;
use crate::track_record::{Confidence, Form, Kind};
use crate::wording::{PHASES, phase_number};
use thenar_inference::checks::signatures::looked_for;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::least_squares::huber::{HUBER, huber};
use thenar_inference::parameters::surrogate_priors::is_form_known;
use thenar_inference::selection::scored::{Rungs, Scored};

/// Findings of what is named.
pub fn findings(
    study: &Study,
    (ready, rungs): (&PreparedStudy, &Rungs),
    sized: &Sized<'_>,
    probabilities: &[(Vec<&'static str>, f64)],
) -> Vec<Finding> {
    let (decision, profiled) = (&sized.decision, &sized.profiled[..]);
    let Some(named) = decision.named else {
        return Vec::new();
    };
    let names = named.names();
    // Of all models that hold these names, alone or with others.
    let holding = probabilities
        .iter()
        .filter(|(other, _)| names.iter().all(|name| other.contains(name)));
    let posterior = holding.map(|(_, p)| p).sum::<f64>().min(0.99);
    let form = match is_form_known(&ready.elastic) {
        true => Form::Known,
        false => Form::Measured,
    };
    let of = |number: usize| {
        let mechanism = &named.mechanisms[number];
        let entry = mechanism.effect.entry();
        let (numbers, _) = numbers_of_effect(ready, (named, profiled), number);
        let kind = match (named.mechanisms.len(), mechanism.is_instrument()) {
            (1, true) => Kind::Instrument(form),
            (1, false) => Kind::Skin(form),
            _ => Kind::OneOfTwo(form),
        };
        Finding {
            effect: entry.name,
            kind: entry.kind(),
            channel: "force",
            confidence: Confidence::new(posterior, kind),
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
fn ledger(ready: &PreparedStudy, rungs: &Rungs, scored: &Scored) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for (sample, _, phase) in ready.surrogate().phases() {
        let fall = huber(rungs.base.refit.residual[sample], HUBER)
            - huber(scored.refit.residual[sample], HUBER);
        sums[phase_number(phase)] += 0.5 * fall / rungs.overdispersion;
    }
    sums
}

fn when(ready: &PreparedStudy, rungs: &Rungs, scored: &Scored) -> Option<When> {
    let sums = ledger(ready, rungs, scored);
    let most = (0..4).fold(0, |best, k| if sums[k] > sums[best] { k } else { best });
    let mut by_course: Vec<(f64, usize)> = (0..ready.courses.len()).map(|c| (0.0, c)).collect();
    for (sample, course, _) in ready.surrogate().phases() {
        by_course[course].0 += huber(rungs.base.refit.residual[sample], HUBER)
            - huber(scored.refit.residual[sample], HUBER);
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
    ready: &PreparedStudy,
    rungs: &Rungs,
    probabilities: &[(Vec<&'static str>, f64)],
) -> Vec<Rival> {
    let of = |scored: &Scored| {
        let names = scored.names();
        let p = probabilities.iter().find(|(other, _)| *other == names);
        Rival {
            probability: p.map_or(0.0, |p| p.1),
            effects: names,
            evidence: scored.qaic_gain,
            left: scored.lack_of_fit.all / rungs.base.lack_of_fit.all.max(1e-9),
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
pub fn curves(ready: &PreparedStudy, rungs: &Rungs, decision: &Decision<'_>) -> Vec<Curve> {
    let after = decision.named.unwrap_or(&rungs.base);
    let of = |course: &thenar_inference::forward::surrogate::force_recording::ForceRecording| {
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

/// Fitted moduli by region: all in the proportion of the study's own.
pub fn materials(
    replay: &Replay,
    (ready, rungs): (&PreparedStudy, &Rungs),
    decision: &Decision<'_>,
) -> Vec<(String, f64, f64)> {
    let at = &decision.named.unwrap_or(&rungs.base).refit.at;
    let (g0, g_lim) = (libm::exp(at[0]), libm::exp(at[1]));
    let tissue = &replay.tissue;
    let each = tissue.regions.iter().zip(&tissue.materials);
    each.map(|(region, m)| {
        let scale = m.g0_mpa / ready.base_material.g0_mpa;
        (region.clone(), g0 * scale, g_lim * scale)
    })
    .collect()
}

/// Effects as the model takes them.
pub fn effects(ready: &PreparedStudy, sized: &Sized<'_>) -> Vec<Switched> {
    let (decision, profiled) = (&sized.decision, &sized.profiled[..]);
    let Some(named) = decision.named else {
        return Vec::new();
    };
    (0..named.mechanisms.len())
        .map(|k| numbers_of_effect(ready, (named, profiled), k).1)
        .collect()
}

/// Numbers behind the verdict.
pub fn evidence(ready: &PreparedStudy, rungs: &Rungs) -> Vec<(&'static str, f64)> {
    let n = rungs.samples as f64;
    let mut all = vec![
        ("samples", n),
        ("deviance_per_sample", rungs.base.refit.deviance / n),
        ("coherent_misfit_per_sample", rungs.base.lack_of_fit.all / n),
        (
            "coherent_misfit_less_largest_part",
            rungs.base.lack_of_fit.less_largest / n,
        ),
        ("noise_share", ready.noise_share()),
        ("noise_step", ready.noise.step[0]),
        ("temper", rungs.overdispersion),
        ("repeat_gain_sd", ready.noise.gain),
        ("repeat_zero_sd_mm", ready.noise.zero_mm.unwrap_or(f64::NAN)),
        (
            "repeat_force_zero_sd_n",
            ready.noise.force_zero_n.unwrap_or(f64::NAN),
        ),
        ("noise_memory_s", ready.noise.correlation[0].memory_s),
        ("noise_white_share", ready.noise.correlation[0].white),
    ];
    if let Some(heteroscedasticity) = rungs.heteroscedasticity {
        all.push(("noise_under_load_over_without", heteroscedasticity.ratio));
        all.push(("noise_of_one_size_up_to", heteroscedasticity.least));
    }
    if let Some(curve) = &rungs.depth_curve {
        all.push(("depth_curve_nats", curve.qaic_gain));
    }
    if let Some(waves) = rungs.short_waves {
        all.push(("shared_short_waves_standard_errors", waves.standard_errors));
        all.push(("shared_short_waves_rms_n", waves.rms_n));
        all.push((
            "shared_short_waves_by_depth",
            f64::from(u8::from(waves.is_by_depth)),
        ));
    }
    if let Some(rhythm) = ready.noise.rhythm {
        all.push(("rhythm_hz", rhythm.hz));
        all.push(("rhythm_nats", rhythm.nats));
        all.push(("rhythm_chance", rhythm.chance));
    }
    if let Some((hz, amplitude_n)) = ready.noise.hum {
        all.extend([("hum_hz", hz), ("hum_amplitude_n", amplitude_n)]);
    }
    if let Some(step) = rungs.gain_step {
        all.push(("gain_step_t", step.t));
        all.push(("gain_step_degrees", step.degrees));
        all.push(("gain_step_log", step.size.0));
    }
    all
}
