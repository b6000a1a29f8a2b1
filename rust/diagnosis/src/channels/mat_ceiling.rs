//! A ceiling of a mat that its data sheet does not state: many cells read one largest value.

use std::collections::BTreeMap;

use thenar_recordings::study::{Data, StudyRecording};
use thenar_recordings::{PressureUnit, Study};

use crate::findings::{Diagnosis, Finding, Number, Verdict};
use crate::track_record::{Confidence, Kind};

/// Readings below the largest among which those of a mat that does not clip lie about evenly, as a part of it.
const BAND: f64 = 0.15;
/// Fewest readings at a ceiling, and how often chance may put as many on the largest value.
const CLEAR: (usize, f64) = (5, 1e-6);
/// Fewest sensels that read it: one that stands still reads one value for long.
const SENSELS: usize = 3;
/// Readings at a ceiling over those at any other value near it: frames that repeat each other share all their values.
const CROWDED: usize = 3;
/// Part of a reading by which two are the same.
const SAME: f64 = 1e-9;

/// Cells that read one largest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ceiling {
    /// kPa.
    pub at: f64,
    /// How many readings stand there.
    pub cells: usize,
    /// How often chance would put as many there.
    pub chance: f64,
}

/// The study with the ceiling of its mats stated, and that ceiling; None where none shows that was not stated.
pub fn with_ceiling(study: &Study) -> Option<(Study, Ceiling)> {
    let stated = study.instrument.as_ref().and_then(|i| i.saturation_kpa);
    let mut values = Vec::new();
    for recording in &study.recordings {
        if let Data::PressureMap { map, .. } = &recording.data {
            if map.clipped_from.is_some() || map.unit != PressureUnit::Kilopascal {
                return None;
            }
            values.extend(
                map.values
                    .iter()
                    .copied()
                    .filter(|v| v.is_finite() && *v > 0.0),
            );
        }
    }
    let found = ceiling(&values)?;
    if sensels_at(study, found.at) < SENSELS
        || stated.is_some_and(|limit| limit <= found.at * (1.0 + SAME))
    {
        return None;
    }
    let mut stated_study = study.clone();
    stated_study
        .instrument
        .get_or_insert_default()
        .saturation_kpa = Some(found.at * (1.0 - SAME));
    Some((stated_study, found))
}

/// How many sensels read a value (kPa), of the recording that has most.
fn sensels_at(study: &Study, value: f64) -> usize {
    let count = |recording: &StudyRecording| match &recording.data {
        Data::PressureMap { map, .. } => {
            let mut at: Vec<usize> = (0..map.values.len())
                .filter(|&k| map.values[k].to_bits() == value.to_bits())
                .map(|k| k % map.sensels.len().max(1))
                .collect();
            at.sort_unstable();
            at.dedup();
            at.len()
        }
        _ => 0,
    };
    study.recordings.iter().map(count).max().unwrap_or(0)
}

/// The ceiling of readings (all > 0); None where the largest value is not shared by more of them than chance would have it.
pub fn ceiling(values: &[f64]) -> Option<Ceiling> {
    let most = values.iter().copied().fold(0.0, f64::max);
    let near = values.iter().filter(|v| **v >= (1.0 - BAND) * most);
    // By value, of which no two are nearer than the instrument's step.
    let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
    near.for_each(|v| *counts.entry(v.to_bits()).or_default() += 1);
    let levels: Vec<f64> = counts.keys().map(|bits| f64::from_bits(*bits)).collect();
    let steps = levels.windows(2).map(|w| w[1] - w[0]);
    let step = steps
        .filter(|s| *s > SAME * most)
        .fold(BAND * most, f64::min);
    let cells = *counts.get(&most.to_bits())?;
    let all: usize = counts.values().sum();
    let expected = all as f64 * (step / (BAND * most)).min(1.0);
    let chance = exceeded(cells, expected);
    let others = counts.iter().filter(|(bits, _)| **bits != most.to_bits());
    let is_crowded = others
        .map(|(_, n)| n * CROWDED)
        .max()
        .is_none_or(|n| cells > n);
    (cells >= CLEAR.0 && chance < CLEAR.1 && is_crowded).then_some(Ceiling {
        at: most,
        cells,
        chance,
    })
}

/// Probability that a Poisson number of this mean is `count` or more.
fn exceeded(count: usize, mean: f64) -> f64 {
    let mut term = libm::exp(-mean);
    let mut below = 0.0;
    for k in 0..count {
        below += term;
        term *= mean / (k + 1) as f64;
    }
    // What is left of the series where 1 - below has lost its digits.
    let mut above = 0.0;
    for k in count..count + 200 {
        above += term;
        term *= mean / (k + 1) as f64;
    }
    above
        .min(1.0)
        .max(if below < 0.999 { 1.0 - below } else { 0.0 })
}

/// Adds a ceiling to the diagnosis: the instrument's fault, alone or with what else is missing.
pub fn add_ceiling(found: &mut Diagnosis, seen: Ceiling) {
    found.notes.push(format!(
        "{} cells of the mat read {:.4} kPa, its largest value, exactly: it clips there, though no saturation is stated; these readings \
         were taken as at least that",
        seen.cells, seen.at
    ));
    match found.verdict {
        Verdict::NothingMissing | Verdict::Parameters => {
            found.verdict = Verdict::Instrument;
            found.names_90 = vec![vec!["saturation"]];
        }
        Verdict::MissingPhysics | Verdict::Instrument => {
            found
                .names_90
                .iter_mut()
                .for_each(|names| names.push("saturation"));
        }
        _ => return,
    }
    found.findings.push(Finding {
        effect: "saturation",
        kind: "instrument",
        channel: "map",
        confidence: Confidence::new(0.99, Kind::MatCeiling),
        numbers: vec![Number {
            name: "ceiling_kpa",
            value: seen.at,
            interval: (seen.at, seen.at),
            unit: "kPa",
        }],
        place: None,
        when: None,
        depends_on: vec!["pressure"],
        consequences: vec![(
            format!(
                "{} readings of the mat are {:.4} kPa exactly, its largest value",
                seen.cells, seen.at
            ),
            true,
        )],
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings that fall off evenly to 24 kPa in steps of `step`, and those above `limit` read as that.
    fn readings(step: f64, limit: f64) -> Vec<f64> {
        let smooth = (1..=400).map(|k| 24.0 * (1.0 - libm::sqrt(f64::from(k) / 401.0)));
        smooth
            .map(|v| ((v / step).round() * step).min(limit))
            .filter(|v| *v > 0.0)
            .collect()
    }

    #[test]
    fn shared_largest_value_is_a_ceiling_at_any_resolution() {
        for step in [0.001, 0.1] {
            assert_eq!(ceiling(&readings(step, 30.0)), None);
            let found = ceiling(&readings(step, 20.0)).expect("it clips");
            assert!((found.at - 20.0).abs() < 1e-12 && found.cells >= 5);
        }
        // A mat of few steps has many readings on each.
        assert_eq!(ceiling(&readings(2.0, 30.0)), None);
        assert_eq!(ceiling(&[]), None);
        // A still frame that is written four hundred times.
        let still = [20.0, 19.3, 18.7, 12.0, 3.0].repeat(400);
        assert_eq!(ceiling(&still), None);
    }
}
