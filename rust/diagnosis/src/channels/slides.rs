//! Friction from slides: a force along the skin that goes with the normal force while the tool slides, and not before.
//!
//! Coulomb's law in steady sliding: T = mu F, turned round with the way. A tool or a load cell that is tilted shows T = tilt F too, but
//! sliding or not: what was there before the slide is taken off.

use thenar_recordings::study::Data;
use thenar_recordings::{Curve, Study};

use crate::findings::{Diagnosis, Finding, Number, Switched, Verdict, When};
use crate::track_record::{Confidence, Kind};
use thenar_inference::observe::robust_scale::{median, median_deviation};

/// Speed from which a tool slides, as a part of its fastest.
const SLIDES: f64 = 0.3;
/// Part of a slide after which it is steady: before, the skin is sheared.
const STEADY: f64 = 0.5;
/// Part of the largest normal force from which the tool is pressed, and below which it does not touch.
const PRESSED: (f64, f64) = (0.2, 0.03);
/// Fewest samples of which a ratio is taken.
const LEAST: usize = 6;
/// Standard errors by which the ratio must differ from none, and least ratio that matters: well-oiled skin.
const CLEAR: (f64, f64) = (6.0, 0.02);
/// Part of the error of the force along the skin that the ratio of the other slides must remove.
const PREDICTS: f64 = 0.5;

/// What slides show.
#[derive(Debug, Clone, PartialEq)]
pub struct Slides {
    /// Ratio of the force along the skin to the normal force, with its sign along the way, and its standard error.
    pub ratio: (f64, f64),
    /// Whether a tilt of the tool can be distinguished from it: it was pressed before it slid, or slid both ways.
    pub is_tilt_known: bool,
    /// Part of the square of the force along the skin that the ratio of the other slides removes from each; None of one slide.
    pub removed: Option<f64>,
    /// Recordings.
    pub recordings: Vec<String>,
    /// Span of the steady parts, s.
    time_s: [f64; 2],
    depth_mm: [f64; 2],
}

impl Slides {
    /// Whether a model without friction misses it, and the other slides predict each.
    pub fn is_friction(&self) -> bool {
        let (ratio, error) = self.ratio;
        ratio.abs() > CLEAR.1
            && ratio.abs() > CLEAR.0 * error
            && self.is_tilt_known
            && self.removed.is_some_and(|removed| removed > PREDICTS)
    }
}

/// One slide's steady part.
struct Steady {
    name: String,
    /// Ratio and its standard error; before the slide.
    ratio: (f64, f64),
    is_tilt_known: bool,
    /// Normal force, and force along the way with zero and tilt taken off, N.
    pairs: Vec<(f64, f64)>,
    time_s: [f64; 2],
    depth_mm: [f64; 2],
}

/// Reads the slides of a study; None where no recording slides and gives a force along the skin.
pub fn slides(study: &Study) -> Option<Slides> {
    let mut all = Vec::new();
    for recording in &study.recordings {
        if let Data::Indentation(curve) = &recording.data
            && let Some(steady) = steady(&recording.name, curve)
        {
            all.push(steady);
        }
    }
    let n = all.len() as f64;
    if all.is_empty() {
        return None;
    }
    let mean = all.iter().map(|s| s.ratio.0).sum::<f64>() / n;
    let own = all.iter().map(|s| s.ratio.1.powi(2)).sum::<f64>() / n;
    let between = all.iter().map(|s| (s.ratio.0 - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let removed = (all.len() > 1).then(|| {
        let (mut before, mut after) = (0.0, 0.0);
        for one in &all {
            let others = (mean * n - one.ratio.0) / (n - 1.0);
            for (normal, along) in &one.pairs {
                before += along * along;
                after += (along - others * normal).powi(2);
            }
        }
        1.0 - after / f64::max(before, f64::MIN_POSITIVE)
    });
    let span = |of: &dyn Fn(&Steady) -> [f64; 2]| {
        let ends = all.iter().map(of);
        ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
            .unwrap_or([0.0; 2])
    };
    Some(Slides {
        ratio: (mean, (own.max(between) / n).sqrt()),
        is_tilt_known: all.iter().all(|s| s.is_tilt_known),
        removed,
        time_s: span(&|s| s.time_s),
        depth_mm: span(&|s| s.depth_mm),
        recordings: all.into_iter().map(|s| s.name).collect(),
    })
}

fn steady(name: &str, curve: &Curve) -> Option<Steady> {
    let (time, force) = (curve.channel("time_s")?, curve.channel("force_n")?);
    let (slide, across) = (
        curve.channel("slide_mm")?,
        curve.channel("tangential_force_n")?,
    );
    let depth = curve.channel("depth_mm").or(curve.channel("travel_mm"))?;
    let n = time.len();
    let most = force.iter().fold(0.0, |most, f| f64::max(most, *f));
    let (low, high) = slide
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| {
            (l.min(*s), h.max(*s))
        });
    if n < LEAST || high - low <= 0.0 || most <= 0.0 {
        return None;
    }
    let speed = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(n - 1));
        (slide[b] - slide[a]) / (time[b] - time[a])
    };
    let fastest = (0..n).map(|k| speed(k).abs()).fold(0.0, f64::max);
    let way = |k: usize| match speed(k) {
        v if v > SLIDES * fastest => 1.0,
        v if v < -SLIDES * fastest => -1.0,
        _ => 0.0,
    };
    let first = (0..n).find(|&k| way(k) != 0.0)?;
    let is_pressed = |k: usize| force[k] > PRESSED.0 * most;
    let zero = middle(
        (0..n)
            .filter(|&k| force[k].abs() < PRESSED.1 * most)
            .map(|k| across[k]),
    );
    let zero = zero.unwrap_or(0.0);
    let before = (0..first).filter(|&k| is_pressed(k));
    let known = middle(before.map(|k| (across[k] - zero) / force[k]));
    let tilt = known.unwrap_or(0.0);
    // Each leg one way, of which the second part is steady.
    let (mut used, mut start) = (Vec::new(), first);
    for k in first..=n {
        if k < n && way(k) == way(start) {
            continue;
        }
        let end = k - 1;
        if way(start) != 0.0 {
            let from = slide[start] + STEADY * (slide[end] - slide[start]);
            let is_late = |j: &usize| (slide[*j] - from) * way(start) >= 0.0;
            used.extend((start..=end).filter(is_late).filter(|j| is_pressed(*j)));
        }
        start = k.min(n - 1);
    }
    if used.len() < LEAST {
        return None;
    }
    let along = |k: usize| way(k) * (across[k] - zero - tilt * force[k]);
    let ratios: Vec<f64> = used.iter().map(|&k| along(k) / force[k]).collect();
    let ratio = median(&mut ratios.clone());
    let mut off: Vec<f64> = ratios.iter().map(|r| (r - ratio).abs()).collect();
    let ends = |of: &[f64]| {
        let each = used.iter().map(|&k| of[k]);
        each.fold([f64::INFINITY, f64::NEG_INFINITY], |e, v| {
            [e[0].min(v), e[1].max(v)]
        })
    };
    Some(Steady {
        name: name.to_owned(),
        // The standard error of a median of normal numbers.
        ratio: (
            ratio,
            1.2533 * median_deviation(&mut off) / (used.len() as f64).sqrt(),
        ),
        is_tilt_known: known.is_some()
            || [1.0, -1.0]
                .iter()
                .all(|one| used.iter().any(|&k| way(k) == *one)),
        pairs: used.iter().map(|&k| (force[k], along(k))).collect(),
        time_s: ends(time),
        depth_mm: ends(depth),
    })
}

/// Median; None of fewer than 6 values.
fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut list: Vec<f64> = values.collect();
    (list.len() >= LEAST).then(|| median(&mut list))
}

/// Whether friction is named with what was said before. An instrument at fault has no finding where only a place of maps speaks for it,
/// which says nothing of slides.
fn is_open(verdict: Verdict, findings: &[Finding]) -> bool {
    match verdict {
        Verdict::NothingMissing | Verdict::Parameters | Verdict::MissingPhysics => true,
        Verdict::Instrument => findings.is_empty(),
        Verdict::CannotTell | Verdict::Unlisted | Verdict::InsufficientData => false,
    }
}

/// Adds friction to the diagnosis, alone or with what else is missing.
pub fn add_friction(study: &Study, found: &mut Diagnosis) {
    let Some(seen) = slides(study) else {
        return;
    };
    let (ratio, error) = (seen.ratio.0.abs(), seen.ratio.1);
    if ratio > CLEAR.1 && ratio > CLEAR.0 * error && !seen.is_friction() {
        found.suspected.push("friction");
        found.notes.push(format!(
            "slides: the force along the skin is {ratio:.3} of the normal force; friction is suspected, and not named: record a second slide \
             that begins after a hold, or goes both ways"
        ));
        return;
    }
    if !seen.is_friction() {
        found.notes.push(format!(
            "slides: the force along the skin is {ratio:.3} (standard error {error:.3}) of the normal force; no friction beyond that"
        ));
        return;
    }
    let sentence = format!(
        "while it slides the tool is held back by {ratio:.3} ({:.3} to {:.3}) of the normal force, which the model without friction does not have",
        ratio - 1.645 * error,
        ratio + 1.645 * error
    );
    found.notes.push(sentence);
    if !is_open(found.verdict, &found.findings) {
        return;
    }
    found.verdict = Verdict::MissingPhysics;
    for names in &mut found.names_90 {
        names.push("friction");
    }
    if found.names_90.is_empty() {
        found.names_90.push(vec!["friction"]);
    }
    found.effects.push(Switched {
        name: "friction",
        amplitude: 1.0,
        numbers: vec![("coefficient", ratio)],
        choices: Vec::new(),
    });
    found.findings.push(Finding {
        effect: "friction",
        kind: "tissue",
        channel: "tangential_force",
        confidence: Confidence::new(0.99, Kind::Slide),
        numbers: vec![Number {
            name: "coefficient",
            value: ratio,
            interval: (ratio - 1.645 * error, ratio + 1.645 * error),
            unit: "1",
        }],
        place: None,
        when: Some(When {
            recordings: seen.recordings.clone(),
            phase: "slide",
            time_s: seen.time_s,
            depth_mm: seen.depth_mm,
            cycles: [0, 0],
        }),
        depends_on: vec!["direction"],
        consequences: vec![(
            "a dragged product pulls along the skin, at most the coefficient times the normal force".to_owned(),
            true,
        )],
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_that_stays_with_the_sensels_does_not_silence_a_slide() {
        assert!(is_open(Verdict::Instrument, &[]));
        assert!(is_open(Verdict::NothingMissing, &[]));
        assert!(!is_open(Verdict::CannotTell, &[]));
    }
}
