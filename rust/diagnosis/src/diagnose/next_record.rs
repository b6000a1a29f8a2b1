//! What to record next: the protocol that settles between two names, from their necessary consequences.

use thenar_recordings::Study;
use thenar_recordings::study::Shape;

use super::course::Course;
use super::findings::Suggestion;

/// Largest ratio of radii that is asked for where the study has no other tool.
const RATIO: f64 = 2.5;
/// Hold that tells clocks apart, s.
const HOLD_S: f64 = 8.0;
/// Minutes that a recording takes besides its own time, with its repeat and the rest before it.
const MINUTES: f64 = 6.0;

/// A recording for each of the first pairs, the best first.
pub fn suggestions(
    study: &Study,
    courses: &[Course],
    pairs: &[[&'static str; 2]],
) -> Vec<Suggestion> {
    let mut found: Vec<Suggestion> = Vec::new();
    for pair in pairs.iter().take(3) {
        let Some(one) = suggestion(study, courses, *pair) else {
            continue;
        };
        match found
            .iter_mut()
            .find(|f| f.indenter == one.indenter && f.cycles == one.cycles)
        {
            Some(same) => {
                let more = one
                    .settles
                    .into_iter()
                    .filter(|n| !same.settles.contains(n));
                same.settles.extend(more.collect::<Vec<_>>());
            }
            None => found.push(one),
        }
    }
    found
}

/// How a pair differs.
enum By {
    /// Another contact size, held.
    Size,
    /// Cycles.
    Count,
    /// Another speed.
    Speed,
}

fn by(pair: [&str; 2]) -> By {
    let has = |name: &str| pair.contains(&name);
    if has("cycle_softening") {
        return By::Count;
    }
    if has("rate_independent_loss") && (has("relaxation") || has("drainage")) || has("timing") {
        return By::Speed;
    }
    By::Size
}

fn suggestion(study: &Study, courses: &[Course], pair: [&'static str; 2]) -> Option<Suggestion> {
    let first = courses.first()?;
    let site = study.recordings[first.recording].site.clone();
    let used: Vec<&str> = courses
        .iter()
        .map(|c| study.recordings[c.recording].indenter.as_str())
        .collect();
    let radius = |name: &str| {
        let tool = study.indenters.iter().find(|i| i.name == name)?;
        match &tool.shape {
            Shape::Sphere { radius_mm }
            | Shape::Cylinder { radius_mm, .. }
            | Shape::Punch { radius_mm } => Some(*radius_mm),
            _ => None,
        }
    };
    let speeds: Vec<f64> = courses
        .iter()
        .map(Course::speed)
        .filter(|s| *s > 0.0)
        .collect();
    let mut sorted = speeds.clone();
    sorted.sort_by(f64::total_cmp);
    let speed = sorted.get(sorted.len() / 2).copied().unwrap_or(1.0);
    let depth = courses.iter().map(Course::deepest).fold(0.0, f64::max);
    let hold = courses
        .iter()
        .map(Course::hold_s)
        .fold(0.0, f64::max)
        .max(HOLD_S);
    let here = used.iter().filter_map(|u| radius(u));
    let (low, high) = here.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), r| {
        (l.min(r), h.max(r))
    });
    // The study's own tool that was not used and differs most in size; else one that is asked for.
    let other = study
        .indenters
        .iter()
        .filter(|i| !used.contains(&i.name.as_str()))
        .filter_map(|i| radius(&i.name).map(|r| (i.name.clone(), r)))
        .max_by(|a, b| apart(a.1, (low, high)).total_cmp(&apart(b.1, (low, high))));
    let make = |indenter: Option<String>,
                radius_mm: Option<f64>,
                speed: f64,
                hold: f64,
                cycles: u32| {
        let tool = match (&indenter, radius_mm) {
            (Some(name), Some(r)) => format!("the indenter '{name}' (radius {r:.1} mm)"),
            (Some(name), None) => format!("the indenter '{name}'"),
            (None, Some(r)) => format!("a sphere of radius {r:.1} mm"),
            (None, None) => "the same indenter".to_owned(),
        };
        let how = match cycles {
            1 => format!("hold {hold:.0} s"),
            n => format!("{n} cycles without a hold"),
        };
        let text = format!(
            "Press with {tool} to {depth:.2} mm at {speed:.2} mm/s, {how}, twice: {} and {} then differ",
            pair[0].replace('_', " "),
            pair[1].replace('_', " ")
        );
        Suggestion {
            text,
            indenter,
            radius_mm,
            site: site.clone(),
            speed_mm_s: speed,
            hold_s: hold,
            cycles,
            depth_mm: depth,
            settles: pair.to_vec(),
            minutes: MINUTES + 2.0 * (hold + 2.0 * f64::from(cycles) * depth / speed) / 60.0,
        }
    };
    let small = used.iter().min_by(|a, b| {
        let size = |name: &str| radius(name).unwrap_or(f64::INFINITY);
        size(a).total_cmp(&size(b))
    })?;
    let small = ((*small).to_owned(), radius(small));
    Some(match by(pair) {
        By::Count => make(Some(small.0), small.1, speed, 0.0, 4),
        By::Speed => {
            let fast = sorted.last().copied().unwrap_or(1.0);
            let slow = sorted.first().copied().unwrap_or(1.0);
            let other = if fast > 4.0 * slow {
                (fast * slow).sqrt()
            } else {
                5.0 * fast
            };
            make(Some(small.0), small.1, other, hold, 1)
        }
        By::Size => match other {
            Some((name, r)) => make(Some(name), Some(r), speed, hold, 1),
            None if high > 0.0 => make(None, Some(high * RATIO), speed, hold, 1),
            None => make(Some(small.0), small.1, speed, hold, 1),
        },
    })
}

/// How far a radius is from those in use, as a ratio.
fn apart(radius: f64, (low, high): (f64, f64)) -> f64 {
    f64::max(radius / high.max(1e-9), low / radius.max(1e-9))
}
