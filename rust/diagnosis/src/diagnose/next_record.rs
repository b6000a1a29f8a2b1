//! What to record next: the protocol that settles between two names, from their necessary consequences.

use thenar_recordings::Study;
use thenar_recordings::study::Shape;

use super::course::Course;
use super::findings::Suggestion;

/// Largest ratio of radii that is asked for where the study has no other tool.
const RATIO: f64 = 2.5;
/// Hold that tells clocks apart, s.
const HOLD_S: f64 = 8.0;
/// Cycles that tell what counts them from what counts time.
const CYCLES: u32 = 4;
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
    let past = Past::of(study, courses)?;
    let choice = past.choice(study, by(pair));
    Some(told(&past, choice, pair))
}

/// What was recorded so far.
struct Past {
    site: String,
    /// The smallest tool in use, and its radius.
    smallest: (String, Option<f64>),
    /// Tools in use.
    used: Vec<String>,
    /// Radii in use, mm; infinity and 0 where no tool is round.
    radii: (f64, f64),
    /// Speeds of loading in use, mm/s: slowest, in the middle, fastest.
    speeds: [f64; 3],
    /// Deepest press, mm, and longest hold, s.
    depth_mm: f64,
    hold_s: f64,
}

/// A tool and how it is to be pressed.
struct Choice {
    indenter: Option<String>,
    radius_mm: Option<f64>,
    speed_mm_s: f64,
    hold_s: f64,
    cycles: u32,
}

fn radius_of(study: &Study, name: &str) -> Option<f64> {
    let tool = study.indenters.iter().find(|i| i.name == name)?;
    match &tool.shape {
        Shape::Sphere { radius_mm }
        | Shape::Cylinder { radius_mm, .. }
        | Shape::Punch { radius_mm } => Some(*radius_mm),
        _ => None,
    }
}

impl Past {
    fn of(study: &Study, courses: &[Course]) -> Option<Past> {
        let first = courses.first()?;
        let tool = |c: &Course| study.recordings[c.recording].indenter.clone();
        let used: Vec<String> = courses.iter().map(tool).collect();
        let size = |name: &&String| radius_of(study, name).unwrap_or(f64::INFINITY);
        let smallest = used.iter().min_by(|a, b| size(a).total_cmp(&size(b)))?;
        let smallest = (smallest.clone(), radius_of(study, smallest));
        let known = used.iter().filter_map(|name| radius_of(study, name));
        let radii = known.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), r| {
            (low.min(r), high.max(r))
        });
        let speeds = courses.iter().map(Course::speed);
        let mut speeds: Vec<f64> = speeds.filter(|s| *s > 0.0).collect();
        speeds.sort_by(f64::total_cmp);
        let at = |k: usize| speeds.get(k).copied().unwrap_or(1.0);
        let most = |of: &dyn Fn(&Course) -> f64| courses.iter().map(of).fold(0.0, f64::max);
        Some(Past {
            site: study.recordings[first.recording].site.clone(),
            smallest,
            radii,
            speeds: [at(0), at(speeds.len() / 2), at(speeds.len().max(1) - 1)],
            depth_mm: most(&Course::deepest),
            hold_s: most(&Course::hold_s).max(HOLD_S),
            used,
        })
    }

    fn choice(&self, study: &Study, by: By) -> Choice {
        let same = |speed_mm_s: f64, hold_s: f64, cycles: u32| Choice {
            indenter: Some(self.smallest.0.clone()),
            radius_mm: self.smallest.1,
            speed_mm_s,
            hold_s,
            cycles,
        };
        let [slow, middle, fast] = self.speeds;
        match by {
            By::Count => same(middle, 0.0, CYCLES),
            By::Speed if fast > 4.0 * slow => same((fast * slow).sqrt(), self.hold_s, 1),
            By::Speed => same(5.0 * fast, self.hold_s, 1),
            By::Size => {
                let (indenter, radius_mm) = self.other(study);
                Choice {
                    indenter,
                    radius_mm,
                    ..same(middle, self.hold_s, 1)
                }
            }
        }
    }

    /// The study's own tool that was not used and differs most in size; else one that is asked for.
    fn other(&self, study: &Study) -> (Option<String>, Option<f64>) {
        let unused = study.indenters.iter().map(|i| &i.name);
        let unused = unused.filter(|name| !self.used.contains(name));
        let sized = unused.filter_map(|name| Some((name.clone(), radius_of(study, name)?)));
        let other = sized.max_by(|a, b| apart(a.1, self.radii).total_cmp(&apart(b.1, self.radii)));
        match other {
            Some((name, radius)) => (Some(name), Some(radius)),
            None if self.radii.1 > 0.0 => (None, Some(self.radii.1 * RATIO)),
            None => (Some(self.smallest.0.clone()), self.smallest.1),
        }
    }
}

fn told(past: &Past, choice: Choice, pair: [&'static str; 2]) -> Suggestion {
    let tool = match (&choice.indenter, choice.radius_mm) {
        (Some(name), Some(r)) => format!("the indenter '{name}' (radius {r:.1} mm)"),
        (Some(name), None) => format!("the indenter '{name}'"),
        (None, Some(r)) => format!("a sphere of radius {r:.1} mm"),
        (None, None) => "the same indenter".to_owned(),
    };
    let how = match choice.cycles {
        1 => format!("hold {:.0} s", choice.hold_s),
        n => format!("{n} cycles without a hold"),
    };
    let (depth, speed) = (past.depth_mm, choice.speed_mm_s);
    let text = format!(
        "Press with {tool} to {depth:.2} mm at {speed:.2} mm/s, {how}, twice: {} and {} then differ",
        pair[0].replace('_', " "),
        pair[1].replace('_', " ")
    );
    let own_s = choice.hold_s + 2.0 * f64::from(choice.cycles) * depth / speed;
    Suggestion {
        text,
        indenter: choice.indenter,
        radius_mm: choice.radius_mm,
        site: past.site.clone(),
        speed_mm_s: speed,
        hold_s: choice.hold_s,
        cycles: choice.cycles,
        depth_mm: depth,
        settles: pair.to_vec(),
        minutes: MINUTES + 2.0 * own_s / 60.0,
    }
}

/// How far a radius is from those in use, as a ratio.
fn apart(radius: f64, (low, high): (f64, f64)) -> f64 {
    f64::max(radius / high.max(1e-9), low / radius.max(1e-9))
}
