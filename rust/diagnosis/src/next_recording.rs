//! The next recording: of the candidates (`design`), the one that soonest settles between two names.

use thenar_contact::Control;
use thenar_inference::forward::mesh::replay::Replay;
use thenar_recordings::Study;

use crate::findings::Suggestion;
use crate::gates::decision::{are_clocks, have_sizes, lead, opponents};
use crate::wording::effect_in_words;
use thenar_inference::design::candidate_recordings::{CandidateRecording, RecordedSoFar, placed};
use thenar_inference::design::expected_discrimination::{Discrimination, ModelPair};
use thenar_inference::design::profile_likelihood::profile;
use thenar_inference::errors::InferenceError;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::forward::tables::elastic::Elastic;
use thenar_inference::forward::tables::elastic_table::radius;
use thenar_inference::selection::scored::Rungs;

/// Numbers of presses that are asked for.
const PRESSES: [u32; 5] = [2, 4, 6, 8, 12];
/// Probability of settling from which no more presses are asked for.
const ENOUGH: f64 = 0.9;
/// Pairs of names that are looked into.
const PAIRS: usize = 3;

/// A recording for each of the first pairs.
///
/// # Errors
/// What the contact model says of pressing another tool, or `Cancelled`.
pub fn suggestions(
    study: &Study,
    replay: &mut Replay,
    (ready, rungs): (&PreparedStudy, &Rungs),
    (pairs, control): (&[[&'static str; 2]], &Control<'_>),
) -> Result<Vec<Suggestion>, InferenceError> {
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    let past = RecordedSoFar::of(study, &ready.courses);
    let site = study.sites.iter().find(|s| s.name == past.site);
    let Some(site) = site else {
        return Ok(Vec::new());
    };
    let used = ready.courses.iter().map(|c| c.place);
    let contacts = used.map(|place| radius(&ready.elastic.places[place], ready.scales.deepest));
    let tools = past.tools(study, contacts.fold(0.0, f64::max));
    let mut elastic = ready.elastic.clone();
    let places = placed(
        (&tools, site),
        (&past, replay),
        (ready, &mut elastic, control),
    )?;
    let contact = |place: usize| radius(&elastic.places[place], ready.scales.deepest);
    let choices = past.choices((&tools, &places), &contact);
    let mut found: Vec<Suggestion> = Vec::new();
    for pair in pairs.iter().take(PAIRS) {
        control.check().map_err(|_| InferenceError::Cancelled)?;
        let best = best((ready, &elastic), rungs, (*pair, &choices));
        let Some((choice, presses, probability)) = best else {
            continue;
        };
        let one = told(&past, choice, (*pair, presses, probability));
        match found.iter_mut().find(|other| other.asks_as(&one)) {
            Some(same) => same.join(one),
            None => found.push(one),
        }
    }
    Ok(found)
}

impl Suggestion {
    /// True for the same recording, however often.
    fn asks_as(&self, other: &Suggestion) -> bool {
        let way = |of: &Suggestion| (of.speed_mm_s, of.hold_s, of.cycles);
        self.indenter == other.indenter
            && self.in_turn_with == other.in_turn_with
            && way(self) == way(other)
    }

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

/// The choice that soonest settles a pair with enough probability, or else that does so most often, and with how many presses.
fn best<'a>(
    (ready, elastic): (&PreparedStudy, &Elastic),
    rungs: &Rungs,
    (pair, choices): ([&str; 2], &'a [CandidateRecording]),
) -> Option<(&'a CandidateRecording, u32, f64)> {
    let two = opponents(rungs, pair)?;
    let needed = lead(two[0], two[1])?;
    let surrogate = ready.surrogate();
    let between = ModelPair {
        ready,
        elastic,
        two,
        profile: two.map(|of| profile(&surrogate, of, rungs.overdispersion)),
        overdispersion: rungs.overdispersion,
    };
    let contact = |place: usize| radius(&elastic.places[place], ready.scales.deepest);
    let mut all: Vec<(&CandidateRecording, u32, f64)> = Vec::new();
    for choice in choices {
        let radii = (0..elastic.studied).chain(choice.presses.iter().map(|p| p.place));
        if are_clocks(two) && !have_sizes(radii.map(contact)) {
            continue;
        }
        let Some(discrimination) = between.discrimination(&choice.presses) else {
            continue;
        };
        all.extend(enough(&discrimination, needed).map(|(times, p)| (choice, times, p)));
    }
    let minutes = |one: &(&CandidateRecording, u32, f64)| f64::from(one.1) * one.0.minutes;
    let settles = all.iter().filter(|one| one.2 >= ENOUGH);
    let soonest = settles.min_by(|a, b| minutes(a).total_cmp(&minutes(b)));
    let most = || all.iter().max_by(|a, b| a.2.total_cmp(&b.2));
    soonest.or_else(most).copied()
}

/// The fewest presses that settle often enough, or the most that are asked for; and how often they do.
fn enough(discrimination: &Discrimination, needed: f64) -> Option<(u32, f64)> {
    let mut last = None;
    for presses in PRESSES {
        let probability = discrimination.probability(presses, needed)?;
        last = Some((presses, probability));
        if probability >= ENOUGH {
            break;
        }
    }
    last
}

/// With what to press and how.
fn said(past: &RecordedSoFar, choice: &CandidateRecording) -> String {
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
    let in_turn = match &choice.in_turn_with {
        Some(name) if past.is_used(name) => format!(", in turn with '{name}'"),
        Some(name) => format!(", in turn with '{name}', not used so far"),
        None => String::new(),
    };
    let (depth, speed) = (press.depth_mm, press.speed_mm_s);
    format!("{tool} to {depth:.2} mm at {speed:.2} mm/s, {how}{in_turn}")
}

fn told(
    past: &RecordedSoFar,
    choice: &CandidateRecording,
    (pair, times, probability): ([&'static str; 2], u32, f64),
) -> Suggestion {
    let press = &choice.presses[0];
    let (with, each) = (
        said(past, choice),
        if choice.in_turn_with.is_some() {
            " each"
        } else {
            ""
        },
    );
    let text = format!(
        "Press with {with}, {times} times{each}: {} and {} predict different forces there",
        effect_in_words(pair[0]),
        effect_in_words(pair[1])
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
