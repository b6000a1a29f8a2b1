//! What repeats say before any model is asked: whether the noise grows under load, and whether the session's gain has a step.

use super::course::Course;
use super::screen::Screen;
use crate::Phase;
use crate::observe::scatter::median;

/// Fewest deviations with and without contact from which they are compared.
const LEAST: (usize, usize) = (40, 24);
/// Deviations beyond this many of their median size are outliers.
const OUTLIER: f64 = 5.0;

/// How repeats deviate from one another under load and without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unsteady {
    /// Standard deviation under load over that without, of what differs between repeats beyond gain and first touch.
    pub ratio: f64,
    /// Number of deviations under load and without.
    pub counts: (usize, usize),
}

/// Compares what is left of the repeats' residuals, over their noise, under load and without; None without repeats or rest.
///
/// Noise of an instrument does not ask whether the tool touches; what the skin does by itself needs contact to be seen.
pub fn unsteady(screen: &Screen<'_>, residual: &[f64]) -> Option<Unsteady> {
    let (mut under, mut without) = (Vec::new(), Vec::new());
    for (c, one) in screen.courses.iter().enumerate() {
        for other in &screen.courses[c + 1..] {
            if one.protocol != other.protocol
                || one.place != other.place
                || one.rows.len() != other.rows.len()
            {
                continue;
            }
            for (a, b) in one.rows.iter().zip(&other.rows) {
                let (Some(i), Some(j)) = (a.sample, b.sample) else {
                    continue;
                };
                let off = (residual[i] - residual[j]) / 2f64.sqrt();
                match (a.phase, b.phase) {
                    (Phase::Apart, Phase::Apart) => without.push(off),
                    (Phase::Apart, _) | (_, Phase::Apart) => {}
                    _ if a.force_n > 0.3 * one.most() => under.push(off),
                    _ => {}
                }
            }
        }
    }
    if under.len() < LEAST.0 || without.len() < LEAST.1 {
        return None;
    }
    Some(Unsteady {
        ratio: size(&under) / size(&without).max(1e-9),
        counts: (under.len(), without.len()),
    })
}

/// Root mean square without outliers.
fn size(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    let most = OUTLIER * 1.4826 * median(&mut sizes);
    let kept = values.iter().filter(|v| v.abs() <= most);
    let (sum, n) = kept.fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 }
}

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
}

/// The step of the session's gain that repeats show most clearly: `log_gain` by recording against the others of its protocol.
pub fn gain_step(courses: &[Course], log_gain: &[f64]) -> Option<GainStep> {
    let mut best: Option<GainStep> = None;
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
        let slope = xy / xx;
        let left = ((yy - slope * xy) / degrees).max(1e-12);
        let error = (left / xx).sqrt();
        let t = slope.abs() / error;
        if best.is_none_or(|b| t > b.t) {
            best = Some(GainStep {
                from,
                size: (slope, error),
                t,
                degrees,
            });
        }
    }
    best
}
