//! Change point of the gain within a session, from the gains of repeats (Student t, corrected for the positions tried).

use crate::forward::surrogate::force_recording::ForceRecording;

/// A step of the gain within the session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainStep {
    /// First recording of the session that reads otherwise.
    pub from: usize,
    /// Logarithm of the factor, and its standard error.
    pub size: (f64, f64),
    /// Its size over its standard error.
    pub t: f64,
    /// Degrees of freedom of that error.
    pub degrees: f64,
    /// Logarithm of the improbability of such a step anywhere in the session, nats.
    pub evidence: f64,
}

/// Scatter of gains between repeats that is taken before they are seen, and the degrees of freedom that it counts for: 2 to 8 % are
/// common (`tests/trial`, calibration).
const USUAL_SCATTER: (f64, f64) = (0.05, 4.0);

/// The step of the session's gain that repeats show most clearly: `log_gain` by recording against the others of its protocol.
pub fn gain_step(courses: &[ForceRecording], log_gain: &[f64]) -> Option<GainStep> {
    let (mut best, mut tried): (Option<GainStep>, f64) = (None, 0.0);
    for from in 1..courses.len() {
        let (mut xx, mut xy, mut yy, mut degrees) = (0.0, 0.0, 0.0, -1.0);
        let mut done: Vec<(&str, usize)> = Vec::new();
        for one in courses {
            let key = (one.protocol.as_str(), one.place);
            if done.contains(&key) {
                continue;
            }
            done.push(key);
            let own: Vec<usize> = (0..courses.len())
                .filter(|&k| courses[k].protocol == one.protocol && courses[k].place == one.place)
                .collect();
            let x = |k: usize| f64::from(courses[k].order >= from);
            let n = own.len() as f64;
            let mean = |of: &dyn Fn(usize) -> f64| own.iter().map(|&k| of(k)).sum::<f64>() / n;
            let (mx, my) = (mean(&x), mean(&|k| log_gain[k]));
            for &k in &own {
                let (dx, dy) = (x(k) - mx, log_gain[k] - my);
                (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
            }
            degrees += n - 1.0;
        }
        if xx < 1.0 || degrees < 2.0 {
            continue;
        }
        tried += 1.0;
        let slope = xy / xx;
        let usual = USUAL_SCATTER.1 * USUAL_SCATTER.0.powi(2);
        degrees += USUAL_SCATTER.1;
        let left = (yy - slope * xy + usual) / degrees;
        let error = (left / xx).sqrt();
        let t = slope.abs() / error;
        if best.is_none_or(|b| t > b.t) {
            best = Some(GainStep {
                from,
                size: (slope, error),
                t,
                degrees,
                evidence: 0.0,
            });
        }
    }
    best.map(|step| GainStep {
        evidence: -libm::log((tried * two_sided(step.t, step.degrees)).min(1.0)),
        ..step
    })
}

/// Probability that Student's t with `degrees` is larger than `t` either way (by Simpson's rule over the angle).
fn two_sided(t: f64, degrees: f64) -> f64 {
    const PARTS: usize = 200;
    // With t = sqrt(degrees) tan x the density is that of cos(x)^(degrees - 1).
    let from = libm::atan(t / degrees.sqrt());
    let half = std::f64::consts::FRAC_PI_2;
    let area = |from: f64| {
        let step = (half - from) / PARTS as f64;
        let at = |k: usize| libm::pow(libm::cos(from + step * k as f64).max(0.0), degrees - 1.0);
        let weight = |k: usize| match k {
            0 | PARTS => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=PARTS).map(|k| weight(k) * at(k)).sum::<f64>() * step / 3.0
    };
    (area(from) / area(0.0)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any table of Student's t: 2.776 at 4 degrees and 2.306 at 8 leave 5 %; 4.604 at 4 leaves 1 %.
    #[test]
    fn two_sided_t_tail_agrees_with_published_tables() {
        for (t, degrees, p) in [(2.776, 4.0, 0.05), (2.306, 8.0, 0.05), (4.604, 4.0, 0.01)] {
            assert!((two_sided(t, degrees) / p - 1.0).abs() < 2e-3, "{t}");
        }
    }
}
