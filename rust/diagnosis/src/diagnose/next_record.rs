//! What to record next: of the recordings that could be made, the one that soonest settles between two names.

use thenar_contact::Control;
use thenar_recordings::Study;
use thenar_recordings::study::{Indenter, Shape, Site};

use super::course::Course;
use super::elastic::{Elastic, radius};
use super::findings::Suggestion;
use super::gates::{are_clocks, have_sizes, lead, opponents};
use super::ladder::Rungs;
use super::planned::Press;
use super::prepare::Prepared;
use super::promise::{Between, Promise};
use crate::DiagnosisError;
use crate::fit::Fitting;

/// Radius of a sphere that is asked for where the study has no other tool, over the largest in use.
const RATIO: f64 = 2.5;
/// Hold that tells clocks apart, s, if none was as long.
const HOLD_S: f64 = 8.0;
/// Cycles that tell what counts them from what counts time.
const CYCLES: u32 = 4;
/// A speed that is asked for where all were alike, over the one in use.
const FASTER: f64 = 5.0;
/// Depth of a sphere's press over its radius, at most: the contact model answers for no more (`tool::too_deep`).
const DEEPEST: f64 = 0.5;
/// Rest before each press where the study says none, and time to set up each, s.
const REST_S: f64 = 120.0;
const SETTING_UP_S: f64 = 30.0;
/// Numbers of presses that are asked for.
const PRESSES: [u32; 5] = [2, 4, 6, 8, 12];
/// Probability of settling from which no more presses are asked for.
const ENOUGH: f64 = 0.85;
/// Pairs of names that are looked into.
const PAIRS: usize = 3;

/// A recording for each of the first pairs.
///
/// # Errors
/// What the contact model says of pressing another tool, or `Cancelled`.
pub fn suggestions(
    study: &Study,
    fitting: &mut Fitting,
    (ready, rungs): (&Prepared, &Rungs),
    (pairs, control): (&[[&'static str; 2]], &Control<'_>),
) -> Result<Vec<Suggestion>, DiagnosisError> {
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    let past = Past::of(study, &ready.courses);
    let site = study.sites.iter().find(|s| s.name == past.site);
    let Some(site) = site else {
        return Ok(Vec::new());
    };
    let tools = past.tools(study);
    let mut elastic = ready.elastic.clone();
    let places = placed(
        (&tools, site),
        (&past, fitting),
        (ready, &mut elastic, control),
    )?;
    let contact = |place: usize| radius(&elastic.places[place], ready.scales.deepest);
    let choices = past.choices((&tools, &places), &contact);
    let mut found: Vec<Suggestion> = Vec::new();
    for pair in pairs.iter().take(PAIRS) {
        control.check().map_err(|_| DiagnosisError::Cancelled)?;
        let best = best((study, ready, &elastic), rungs, (*pair, &choices));
        let Some((choice, presses, probability)) = best else {
            continue;
        };
        let one = told(&past, choice, (*pair, presses, probability));
        let is_same = |f: &&mut Suggestion| {
            f.indenter == one.indenter
                && (f.speed_mm_s, f.hold_s, f.cycles) == (one.speed_mm_s, one.hold_s, one.cycles)
                && f.in_turn_with == one.in_turn_with
        };
        match found.iter_mut().find(is_same) {
            Some(same) => same.join(one),
            None => found.push(one),
        }
    }
    Ok(found)
}

impl Suggestion {
    /// Lets the same recording settle another pair too.
    fn join(&mut self, other: Suggestion) {
        let more = other.settles.iter().filter(|n| !self.settles.contains(n));
        let more: Vec<&'static str> = more.copied().collect();
        self.settles.extend(more);
        if other.presses > self.presses {
            (self.presses, self.minutes, self.text) = (other.presses, other.minutes, other.text);
        }
        self.probability = match (self.probability, other.probability) {
            (Some(a), Some(b)) => Some(a.min(b)),
            _ => None,
        };
    }
}

/// A recording that could be made.
#[derive(Clone)]
struct Choice {
    /// Name in the study, if it is one of its tools.
    indenter: Option<String>,
    radius_mm: Option<f64>,
    /// Whether a recording used the tool.
    is_known: bool,
    /// Name of a tool in use that is pressed in turn with it.
    in_turn_with: Option<String>,
    /// The press, and that of the tool in turn.
    presses: Vec<Press>,
    /// Time of each once, with the rest before it, minutes.
    minutes: f64,
}

/// The choice that soonest settles a pair with enough probability, or else that does so most often, and with how many presses.
fn best<'a>(
    (study, ready, elastic): (&Study, &Prepared, &Elastic),
    rungs: &Rungs,
    (pair, choices): ([&str; 2], &'a [Choice]),
) -> Option<(&'a Choice, u32, f64)> {
    let two = opponents(rungs, pair)?;
    let needed = lead(two[0], two[1])?;
    let between = Between {
        ready,
        study,
        elastic,
        two,
        temper: rungs.temper,
    };
    let contact = |place: usize| radius(&elastic.places[place], ready.scales.deepest);
    let mut all: Vec<(&Choice, u32, f64)> = Vec::new();
    for choice in choices {
        let radii = (0..elastic.studied).chain(choice.presses.iter().map(|p| p.place));
        if are_clocks(two) && !have_sizes(radii.map(contact)) {
            continue;
        }
        let Some(promise) = between.promise(&choice.presses) else {
            continue;
        };
        all.extend(enough(&promise, needed).map(|(times, p)| (choice, times, p)));
    }
    let minutes = |one: &(&Choice, u32, f64)| f64::from(one.1) * one.0.minutes;
    let settles = all.iter().filter(|one| one.2 >= ENOUGH);
    let soonest = settles.min_by(|a, b| minutes(a).total_cmp(&minutes(b)));
    let most = || all.iter().max_by(|a, b| a.2.total_cmp(&b.2));
    soonest.or_else(most).copied()
}

/// The fewest presses that settle often enough, or the most that are asked for; and how often they do.
fn enough(promise: &Promise, needed: f64) -> Option<(u32, f64)> {
    let mut last = None;
    for presses in PRESSES {
        let probability = promise.probability(presses, needed)?;
        last = Some((presses, probability));
        if probability >= ENOUGH {
            break;
        }
    }
    last
}

/// What was recorded so far.
struct Past {
    site: String,
    /// Tools in use.
    used: Vec<String>,
    /// Largest radius in use, mm; 0 where no tool is round.
    largest: f64,
    /// Speeds of loading in use, mm/s, ascending, of which none is within a third of another.
    speeds: Vec<f64>,
    /// Deepest press, mm, and longest hold, s.
    depth_mm: f64,
    hold_s: f64,
    /// Rest before a press, s.
    rest_s: f64,
}

fn radius_of(tool: &Indenter) -> Option<f64> {
    match &tool.shape {
        Shape::Sphere { radius_mm }
        | Shape::Cylinder { radius_mm, .. }
        | Shape::Punch { radius_mm } => Some(*radius_mm),
        _ => None,
    }
}

impl Past {
    /// Of at least one recording.
    fn of(study: &Study, courses: &[Course]) -> Past {
        let of = |c: &Course| &study.recordings[c.recording];
        let used: Vec<String> = courses.iter().map(|c| of(c).indenter.clone()).collect();
        let tools = study.indenters.iter().filter(|i| used.contains(&i.name));
        let mut speeds: Vec<f64> = courses.iter().map(Course::speed).collect();
        speeds.retain(|s| *s > 0.0);
        speeds.sort_by(f64::total_cmp);
        speeds.dedup_by(|a, b| *a < 1.33 * *b);
        let most = |of: &dyn Fn(&Course) -> f64| courses.iter().map(of).fold(0.0, f64::max);
        let rest = courses.iter().filter_map(|c| of(c).rest_s);
        Past {
            site: courses
                .first()
                .map_or(String::new(), |c| of(c).site.clone()),
            largest: tools.filter_map(radius_of).fold(0.0, f64::max),
            speeds,
            depth_mm: most(&Course::deepest),
            hold_s: most(&Course::hold_s).max(HOLD_S),
            rest_s: rest.reduce(f64::max).unwrap_or(REST_S),
            used,
        }
    }

    /// The study's tools, and a larger sphere if it has none that was not used.
    fn tools(&self, study: &Study) -> Vec<(Indenter, bool)> {
        let mut tools: Vec<(Indenter, bool)> =
            study.indenters.iter().map(|i| (i.clone(), true)).collect();
        let has_other = study.indenters.iter().any(|i| !self.used.contains(&i.name));
        if !has_other && self.largest > 0.0 {
            let shape = Shape::Sphere {
                radius_mm: RATIO * self.largest,
            };
            let name = "a larger sphere".to_owned();
            tools.push((Indenter { name, shape }, false));
        }
        tools
    }

    fn depth_of(&self, tool: &Indenter) -> f64 {
        match &tool.shape {
            Shape::Sphere { radius_mm } => self.depth_mm.min(DEEPEST * radius_mm),
            _ => self.depth_mm,
        }
    }

    /// Every tool held at every speed, and in cycles at the middle one: alone, and in turn with the tool in use that differs most.
    fn choices(
        &self,
        (tools, places): (&[(Indenter, bool)], &[usize]),
        contact: &dyn Fn(usize) -> f64,
    ) -> Vec<Choice> {
        let mut all = Vec::new();
        for ((tool, is_own), place) in tools.iter().zip(places) {
            let apart = |other: usize| libm::log(contact(other) / contact(*place)).abs();
            let used = tools.iter().zip(places);
            let used = used.filter(|((t, _), p)| *p != place && self.used.contains(&t.name));
            let other = used.max_by(|a, b| apart(*a.1).total_cmp(&apart(*b.1)));
            for (speed_mm_s, hold_s, cycles) in self.ways() {
                let press = |(tool, place): (&Indenter, usize)| Press {
                    place,
                    depth_mm: self.depth_of(tool),
                    speed_mm_s,
                    hold_s,
                    cycles,
                };
                let alone = Choice {
                    indenter: is_own.then(|| tool.name.clone()),
                    radius_mm: radius_of(tool),
                    is_known: self.used.contains(&tool.name),
                    in_turn_with: None,
                    minutes: self.minutes(&press((tool, *place))),
                    presses: vec![press((tool, *place))],
                };
                if let Some(((other, _), place)) = other {
                    let mut both = alone.clone();
                    let press = press((other, *place));
                    both.minutes += self.minutes(&press);
                    both.presses.push(press);
                    both.in_turn_with = Some(other.name.clone());
                    all.push(both);
                }
                all.push(alone);
            }
        }
        all
    }

    /// Speed, hold and cycles of what can be done with a tool.
    fn ways(&self) -> Vec<(f64, f64, u32)> {
        let mut speeds = self.speeds.clone();
        match speeds[..] {
            [] => speeds.push(1.0),
            [one] => speeds.push(FASTER * one),
            _ => {}
        }
        let middle = speeds[self.speeds.len().saturating_sub(1) / 2];
        let mut ways: Vec<(f64, f64, u32)> = speeds.iter().map(|s| (*s, self.hold_s, 1)).collect();
        ways.push((middle, 0.0, CYCLES));
        ways
    }

    /// Time of a press with the rest before it, minutes.
    fn minutes(&self, press: &Press) -> f64 {
        let moving = 2.0 * f64::from(press.cycles) * press.depth_mm / press.speed_mm_s;
        (self.rest_s + SETTING_UP_S + press.hold_s + moving) / 60.0
    }
}

/// Numbers of the tools' places; those that no recording used are placed and pressed.
fn placed(
    (tools, site): (&[(Indenter, bool)], &Site),
    (past, fitting): (&Past, &mut Fitting),
    (ready, elastic, control): (&Prepared, &mut Elastic, &Control<'_>),
) -> Result<Vec<usize>, DiagnosisError> {
    let mut places = Vec::new();
    for (tool, _) in tools {
        let observed = &fitting.replay.observed.measured;
        let is_here = |c: &&Course| {
            let one = &observed[c.recording];
            one.indenter == tool.name && one.site == site.name
        };
        places.push(match ready.courses.iter().find(is_here) {
            Some(course) => course.place,
            None => fitting
                .replay
                .add_place((tool, site), past.depth_of(tool))?,
        });
    }
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    let g0 = fitting.replay.tissue.materials[0].g0_mpa;
    elastic.add(fitting, g0, &quiet)?;
    Ok(places)
}

fn told(
    past: &Past,
    choice: &Choice,
    (pair, times, probability): ([&'static str; 2], u32, f64),
) -> Suggestion {
    let press = &choice.presses[0];
    let other = if choice.is_known {
        ""
    } else {
        ", not used so far"
    };
    let tool = match (&choice.indenter, choice.radius_mm) {
        (Some(name), Some(r)) => format!("the indenter '{name}' (radius {r:.1} mm{other})"),
        (Some(name), None) => format!("the indenter '{name}'"),
        (None, Some(r)) => format!("a sphere of radius {r:.1} mm"),
        (None, None) => "the same indenter".to_owned(),
    };
    let how = match press.cycles {
        1 => format!("hold {:.0} s", press.hold_s),
        n => format!("{n} cycles without a hold"),
    };
    let (in_turn, each) = match &choice.in_turn_with {
        Some(name) => (format!(", in turn with '{name}'"), " each"),
        None => (String::new(), ""),
    };
    let text = format!(
        "Press with {tool} to {:.2} mm at {:.2} mm/s, {how}{in_turn}, {times} times{each}: {} and {} then differ",
        press.depth_mm,
        press.speed_mm_s,
        pair[0].replace('_', " "),
        pair[1].replace('_', " ")
    );
    Suggestion {
        text,
        indenter: choice.indenter.clone(),
        radius_mm: choice.radius_mm,
        in_turn_with: choice.in_turn_with.clone(),
        site: past.site.clone(),
        speed_mm_s: press.speed_mm_s,
        hold_s: press.hold_s,
        cycles: press.cycles,
        depth_mm: press.depth_mm,
        presses: times,
        settles: pair.to_vec(),
        probability: Some(probability),
        minutes: f64::from(times) * choice.minutes,
    }
}
