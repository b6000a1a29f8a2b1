//! Candidate recordings: each tool of the study (and a sphere that it may lack), at every speed with a hold, or in cycles.

use crate::forward::mesh::replay::Replay;
use thenar_contact::Control;
use thenar_recordings::Study;
use thenar_recordings::study::{Indenter, Shape, Site};

use crate::design::planned_recording::Press;
use crate::errors::InferenceError;
use crate::forward::surrogate::force_recording::ForceRecording;
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::forward::tables::elastic::Elastic;

/// Radius of a sphere that is asked for where the study has no other tool, over the largest in use.
const RATIO: f64 = 2.5;
/// Contact radius of a sphere that is asked for where no tool in use is round, over theirs.
const NARROW: f64 = 0.5;
/// Hold that tells clocks apart, s, if none was as long.
const HOLD_S: f64 = 8.0;
/// Cycles that tell what counts them from what counts time.
const CYCLES: u32 = 4;
/// A speed that is asked for where all were alike, over the one in use.
const FASTER: f64 = 5.0;
/// Depth of a sphere's press over its radius, at most: the contact model answers for no more (`indenter::too_deep`).
const DEEPEST: f64 = 0.5;
/// Rest before each press where the study says none, and time to set up each, s.
const REST_S: f64 = 120.0;
const SETTING_UP_S: f64 = 30.0;
/// A recording that could be made.
#[derive(Clone)]
pub struct CandidateRecording {
    /// Name in the study, if it is one of its tools.
    pub indenter: Option<String>,
    /// mm; None where it is not round.
    pub radius_mm: Option<f64>,
    /// Whether a recording used the tool.
    pub is_known: bool,
    /// Name of the tool that is pressed in turn with it.
    pub in_turn_with: Option<String>,
    /// The press, and that of the tool in turn.
    pub presses: Vec<Press>,
    /// Time of each once, with the rest before it, minutes.
    pub minutes: f64,
}

/// What was recorded so far.
pub struct RecordedSoFar {
    /// Name of the site.
    pub site: String,
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

impl RecordedSoFar {
    /// Of at least one recording.
    pub fn of(study: &Study, courses: &[ForceRecording]) -> RecordedSoFar {
        let of = |c: &ForceRecording| &study.recordings[c.recording];
        let used: Vec<String> = courses.iter().map(|c| of(c).indenter.clone()).collect();
        let tools = study.indenters.iter().filter(|i| used.contains(&i.name));
        let mut speeds: Vec<f64> = courses.iter().map(ForceRecording::speed).collect();
        speeds.retain(|s| *s > 0.0);
        speeds.sort_by(f64::total_cmp);
        speeds.dedup_by(|a, b| *a < 1.33 * *b);
        let most = |of: &dyn Fn(&ForceRecording) -> f64| courses.iter().map(of).fold(0.0, f64::max);
        let rest = courses.iter().filter_map(|c| of(c).rest_s);
        RecordedSoFar {
            site: courses
                .first()
                .map_or(String::new(), |c| of(c).site.clone()),
            largest: tools.filter_map(radius_of).fold(0.0, f64::max),
            speeds,
            depth_mm: most(&ForceRecording::deepest),
            hold_s: most(&ForceRecording::hold_s).max(HOLD_S),
            rest_s: rest.reduce(f64::max).unwrap_or(REST_S),
            used,
        }
    }

    /// The study's tools, and if all of them are in use a sphere: larger than those in use, or where none of these is round one that
    /// touches less than they do. `contact_mm` is their contact radius.
    pub fn tools(&self, study: &Study, contact_mm: f64) -> Vec<(Indenter, bool)> {
        let mut tools: Vec<(Indenter, bool)> =
            study.indenters.iter().map(|i| (i.clone(), true)).collect();
        let has_other = study.indenters.iter().any(|i| !self.used.contains(&i.name));
        let radius_mm = match self.largest > 0.0 {
            true => RATIO * self.largest,
            // A sphere of radius R at depth d touches about as far as sqrt(R d).
            false => (NARROW * contact_mm).powi(2) / self.depth_mm,
        };
        let is_round = radius_mm.is_finite() && radius_mm > 0.0;
        if !has_other && is_round {
            let shape = Shape::Sphere { radius_mm };
            let name = "a sphere".to_owned();
            tools.push((Indenter { name, shape }, false));
        }
        tools
    }

    /// True for the name of a tool in use.
    pub fn is_used(&self, name: &str) -> bool {
        self.used.iter().any(|used| used == name)
    }

    fn depth_of(&self, tool: &Indenter) -> f64 {
        match &tool.shape {
            Shape::Sphere { radius_mm } => self.depth_mm.min(DEEPEST * radius_mm),
            _ => self.depth_mm,
        }
    }

    /// Every tool held at every speed, and in cycles at the middle one: alone, and in turn with its partners.
    pub fn choices(
        &self,
        (tools, places): (&[(Indenter, bool)], &[Option<usize>]),
        contact: &dyn Fn(usize) -> f64,
    ) -> Vec<CandidateRecording> {
        let (mut all, mut paired) = (Vec::new(), Vec::new());
        let known = tools.iter().zip(places);
        let known = known.filter_map(|(tool, place)| Some((&tool.0, tool.1, (*place)?)));
        for (tool, is_own, place) in known {
            let mut partners = self.partners((tool, place), (tools, places), contact);
            // Each may be the other's partner: once is enough.
            partners.retain(|(_, other)| !paired.contains(&[*other, place]));
            paired.extend(partners.iter().map(|(_, other)| [place, *other]));
            for (speed_mm_s, hold_s, cycles) in self.ways() {
                let press = |(tool, place): (&Indenter, usize)| Press {
                    place,
                    depth_mm: self.depth_of(tool),
                    speed_mm_s,
                    hold_s,
                    cycles,
                };
                let alone = CandidateRecording {
                    indenter: is_own.then(|| tool.name.clone()),
                    radius_mm: radius_of(tool),
                    is_known: self.is_used(&tool.name),
                    in_turn_with: None,
                    minutes: self.minutes(&press((tool, place))),
                    presses: vec![press((tool, place))],
                };
                let in_turn = partners.iter().map(|(other, place)| {
                    let (press, mut both) = (press((other, *place)), alone.clone());
                    both.minutes += self.minutes(&press);
                    both.presses.push(press);
                    both.in_turn_with = Some(other.name.clone());
                    both
                });
                all.extend(in_turn);
                all.push(alone);
            }
        }
        all
    }

    /// What a tool is pressed in turn with: the tool in use that differs most, and for one that is not in use also such a one that the
    /// study has, if that differs more.
    fn partners<'a>(
        &self,
        (tool, place): (&Indenter, usize),
        (tools, places): (&'a [(Indenter, bool)], &[Option<usize>]),
        contact: &dyn Fn(usize) -> f64,
    ) -> Vec<(&'a Indenter, usize)> {
        let apart = |other: &(&Indenter, usize)| libm::log(contact(other.1) / contact(place)).abs();
        let most = |is_used: bool| {
            let known = tools.iter().zip(places);
            let others = known.filter_map(|((other, is_own), at)| {
                let at = at.filter(|at| *at != place && *is_own)?;
                (self.is_used(&other.name) == is_used).then_some((other, at))
            });
            others.max_by(|a, b| apart(a).total_cmp(&apart(b)))
        };
        let used = most(true);
        let least = used.as_ref().map_or(0.0, apart);
        let fresh = most(false).filter(|other| !self.is_used(&tool.name) && apart(other) > least);
        used.into_iter().chain(fresh).collect()
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

/// Numbers of the tools' places; those that no recording used are placed and pressed, and left out (None) where that cannot be done.
///
/// # Errors
/// `Cancelled`.
pub fn placed(
    (tools, site): (&[(Indenter, bool)], &Site),
    (past, replay): (&RecordedSoFar, &mut Replay),
    (ready, elastic, control): (&PreparedStudy, &mut Elastic, &Control<'_>),
) -> Result<Vec<Option<usize>>, InferenceError> {
    let mut places = Vec::new();
    for (tool, _) in tools {
        let observed = &replay.observed.measured;
        let is_here = |c: &&ForceRecording| {
            let one = &observed[c.recording];
            one.indenter == tool.name && one.site == site.name
        };
        let known = ready.courses.iter().find(is_here).map(|c| c.place);
        places.push(match known {
            Some(place) => Some(place),
            None => match pressed((tool, site, past), replay, (elastic, control)) {
                // A tool that the skin cannot be pressed with is no advice, and no reason to say nothing.
                Err(InferenceError::Cancelled) => return Err(InferenceError::Cancelled),
                other => other.ok(),
            },
        });
    }
    Ok(places)
}

/// The number of the place of a tool that is placed and pressed; if that fails, nothing is changed.
fn pressed(
    (tool, site, past): (&Indenter, &Site, &RecordedSoFar),
    replay: &mut Replay,
    (elastic, control): (&mut Elastic, &Control<'_>),
) -> Result<usize, InferenceError> {
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    let g0 = replay.tissue.materials[0].g0_mpa;
    let place = replay.add_place((tool, site), past.depth_of(tool))?;
    let mut tried = elastic.clone();
    let done = tried.add(replay, g0, &quiet);
    replay.set_effects(&[], &quiet)?;
    match done {
        Ok(()) => *elastic = tried,
        Err(_) => replay.drop_place(),
    }
    done.map(|()| place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// Which spheres are pressed in turn where these are in use, in the study's order of `radii` (mm), and in how many ways each.
    fn pairs(radii: [(&str, f64); 3], used: &[&str]) -> BTreeMap<String, usize> {
        let past = RecordedSoFar {
            site: String::new(),
            used: used.iter().map(|name| (*name).to_owned()).collect(),
            largest: 28.0,
            speeds: vec![1.0],
            depth_mm: 0.8,
            hold_s: 8.0,
            rest_s: 120.0,
        };
        let sphere = |(name, radius_mm): (&str, f64)| {
            let shape = Shape::Sphere { radius_mm };
            let name = name.to_owned();
            (Indenter { name, shape }, true)
        };
        let contact = |place: usize| (radii[place].1 * 0.8).sqrt();
        let places = [Some(0), Some(1), Some(2)];
        let all = past.choices((&radii.map(sphere), &places), &contact);
        let in_turn = |c: CandidateRecording| {
            let mut both = [c.indenter?, c.in_turn_with?];
            both.sort();
            Some(both.join("+"))
        };
        let mut found = BTreeMap::new();
        for pair in all.into_iter().filter_map(in_turn) {
            *found.entry(pair).or_default() += 1;
        }
        found
    }

    /// 5 and 28 mm differ more than either and 11, and 11 differs more from 28 than from 5. Each pair comes once in each way: at two
    /// speeds, and in cycles.
    #[test]
    fn alternating_candidates_pair_the_tools_that_differ_most() {
        let radii = [("large", 11.0), ("small", 5.0), ("wide", 28.0)];
        for turn in 0..3 {
            let mut radii = radii;
            radii.rotate_left(turn);
            for (used, wanted) in [
                (&["large"][..], ["large+small", "large+wide", "small+wide"]),
                (&["small"], ["large+small", "large+wide", "small+wide"]),
                (
                    &["small", "wide"],
                    ["large+wide", "small+wide", "small+wide"],
                ),
            ] {
                let wanted = wanted.map(|pair| (pair.to_owned(), 3));
                assert_eq!(pairs(radii, used), BTreeMap::from(wanted), "{used:?}");
            }
        }
    }
}
