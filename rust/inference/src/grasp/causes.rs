//! Causes that a grasp study can show, as columns of its linear model, and their choice one after the other by evidence.

use std::ops::Range;

use crate::errors::InferenceError;
use crate::grasp::channels::{Channel, Channels};
use crate::grasp::linear_evidence::{Factored, Rows, Sized};

/// Time constants of relaxation that are tried, s.
pub const TIMES_S: [f64; 5] = [0.7, 2.0, 5.0, 12.0, 30.0];
/// Share of the longest hold up to which they are: what fades more slowly is even in time, as a hand is that loosens.
const LONGEST: f64 = 0.5;
/// Priors of sizes: share that relaxes; loss from hold to hold; logarithm of a region's stiffness; steps of thickness; gain; drift.
const RELAXED: f64 = 0.3;
const SOFTENED: f64 = 0.15;
const STIFFNESS: f64 = 0.6;
const THINNING: f64 = 1.5;
const GAIN: f64 = 0.3;
const DRIFT: f64 = 0.15;
/// Evidence that a name needs beyond what looking at many costs, nats: the first one, and every other one.
const NAMED: (f64, f64) = (6.0, 7.0);
/// The same of a region whose level alone stands out, where nothing else is missing, and the change of the logarithm of its stiffness
/// that is no error of form. The most of 45 drawn grasps without such a region had 0.4 nats.
const REGION: (f64, f64) = (2.0, 0.45);
/// Prior of what further time constants add to a relaxation that is named.
const SPECTRUM: f64 = 0.12;
/// Most causes at once.
const MOST: usize = 3;
/// Causes within this many nats of each other cannot be distinguished.
pub const ALIKE: f64 = 3.0;
/// Holds that softening from hold to hold asks for.
const SOFTENING_HOLDS: usize = 3;

/// What may be missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cause {
    /// Held tissue gives way with this time constant, s.
    Relaxation(f64),
    /// Tissue is softer from hold to hold.
    Softening,
    /// A region is stiffer or softer than given.
    Stiffness(usize),
    /// A region's bone lies at another depth.
    Bone(usize),
    /// The mat reads too much or too little.
    Gain,
    /// The mat's readings change during a hold, or from hold to hold.
    Drift(DriftForm),
}

/// How a mat's readings drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriftForm {
    /// With the logarithm of time, as sensors creep.
    Creep,
    /// Evenly.
    Even,
    /// From hold to hold.
    BetweenHolds,
}

impl Cause {
    /// Its name in the catalogue of effects; a stiffness is a parameter.
    pub fn name(self) -> &'static str {
        match self {
            Cause::Relaxation(_) => "relaxation",
            Cause::Softening => "cycle_softening",
            Cause::Stiffness(_) => "region_stiffness",
            Cause::Bone(_) => "bone",
            Cause::Gain => "gain",
            Cause::Drift(_) => "drift",
        }
    }

    /// Whether it is the instrument's.
    pub fn is_instrument(self) -> bool {
        matches!(self, Cause::Gain | Cause::Drift(_))
    }

    /// The region that it belongs to.
    pub fn region(self) -> Option<usize> {
        match self {
            Cause::Stiffness(region) | Cause::Bone(region) => Some(region),
            _ => None,
        }
    }
}

/// A cause with its column, prior and what looking at many of its kind costs.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Which.
    pub cause: Cause,
    /// Column by row, for a size of 1.
    pub column: Vec<f64>,
    /// Standard deviation of the prior of its size.
    pub prior: f64,
    /// Logarithm of the number of its kind.
    pub cost: f64,
    /// True if its size cannot be below 0.
    pub is_positive: bool,
}

/// A cause that was weighed.
#[derive(Debug, Clone)]
pub struct Weighed {
    /// Which.
    pub cause: Cause,
    /// Size, and the gain of evidence without what looking at many costs.
    pub sized: Sized,
    /// Gain of evidence less that cost, nats.
    pub net: f64,
    /// How much better the holds are predicted that are left out in turn, nats; None with one hold.
    pub held_out: Option<f64>,
}

/// What the causes explain.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// Named causes, the strongest first.
    pub named: Vec<Weighed>,
    /// All single causes over nothing, best first.
    pub rivals: Vec<Weighed>,
    /// For each named cause: others that explain about as much in its place.
    pub alike: Vec<Vec<Weighed>>,
    /// Squared residual that is left, in the model's own variances, and rows.
    pub left: (f64, usize),
}

/// The columns; `thinner` gives the change of a region's scale in a hold by a step of thickness, and how it grows with its shift.
pub fn candidates(
    channels: &Channels,
    regions: &[usize],
    thinner: &dyn Fn(usize, usize) -> (f64, f64),
) -> Vec<Candidate> {
    let holds = channels
        .rows
        .iter()
        .map(|row| row.hold() + 1)
        .max()
        .unwrap_or(0);
    let mut all = Vec::new();
    let mut add = |cause, column, (prior, cost, is_positive): (f64, f64, bool)| {
        all.push(Candidate {
            cause,
            column,
            prior,
            cost,
            is_positive,
        });
    };
    let longest = channels.time_s.iter().copied().fold(0.0, f64::max);
    for time in TIMES_S.into_iter().filter(|t| *t < LONGEST * longest) {
        let column = course(channels, -1.0, 0.0, &|t, _| 1.0 - (-t / time).exp());
        add(
            Cause::Relaxation(time),
            column,
            (RELAXED, (TIMES_S.len() as f64).ln(), true),
        );
    }
    if holds >= SOFTENING_HOLDS {
        let column = channels.column(|row, _| match row {
            Channel::Level(hold, _) => 0.5 * (holds - 1) as f64 - hold as f64,
            _ => 0.0,
        });
        add(Cause::Softening, column, (SOFTENED, 0.0, true));
    }
    let many = (regions.len() as f64).ln();
    for &region in regions {
        let column = channels.column(|row, _| match row {
            Channel::Level(_, r) => f64::from(r == region),
            _ => 0.0,
        });
        add(Cause::Stiffness(region), column, (STIFFNESS, many, false));
        let column = channels.column(|row, k| match row {
            Channel::Level(hold, r) if r == region => thinner(hold, region).0,
            Channel::Course(hold, r, _) if r == region => {
                thinner(hold, region).1 * channels.shift_mm[k]
            }
            _ => 0.0,
        });
        add(Cause::Bone(region), column, (THINNING, many, false));
    }
    let has_trace = channels
        .rows
        .iter()
        .any(|row| matches!(row, Channel::Trace(..)));
    if has_trace {
        let column = channels.column(|row, _| match row {
            Channel::Level(..) => 1.0,
            Channel::Trace(..) => -1.0,
            Channel::Course(..) => 0.0,
        });
        add(Cause::Gain, column, (GAIN, 0.0, false));
    }
    let forms = 3.0f64.ln();
    let creep = course(channels, 1.0, -1.0, &|t, _| (1.0 + t).ln() / 31.0f64.ln());
    add(Cause::Drift(DriftForm::Creep), creep, (DRIFT, forms, false));
    let even = course(channels, 1.0, -1.0, &|t, length| t / length);
    add(Cause::Drift(DriftForm::Even), even, (DRIFT, forms, false));
    if holds >= SOFTENING_HOLDS {
        let at = |hold: usize| hold as f64 - 0.5 * (holds - 1) as f64;
        let column = channels.column(|row, _| match row {
            Channel::Level(hold, _) => at(hold),
            Channel::Trace(hold, _) => -at(hold),
            Channel::Course(..) => 0.0,
        });
        add(
            Cause::Drift(DriftForm::BetweenHolds),
            column,
            (DRIFT, forms, false),
        );
    }
    all
}

/// A shape over time and the hold's length, less its mean in each hold's courses, with a sign in courses and one in traces.
fn course(
    channels: &Channels,
    in_courses: f64,
    in_traces: f64,
    shape: &dyn Fn(f64, f64) -> f64,
) -> Vec<f64> {
    let longest = |hold: usize| {
        let own = channels.rows.iter().zip(&channels.time_s);
        own.filter(|(row, _)| row.hold() == hold)
            .map(|(_, t)| *t)
            .fold(1e-6, f64::max)
    };
    let holds = channels
        .rows
        .iter()
        .map(|row| row.hold() + 1)
        .max()
        .unwrap_or(0);
    let lengths: Vec<f64> = (0..holds).map(longest).collect();
    let value = |k: usize, hold: usize| shape(channels.time_s[k], lengths[hold]);
    let mean = |hold: usize| {
        let own = channels
            .rows
            .iter()
            .enumerate()
            .filter(|(_, row)| matches!(row, Channel::Course(h, ..) if *h == hold));
        let all: Vec<f64> = own.map(|(k, _)| value(k, hold)).collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    };
    let means: Vec<f64> = (0..holds).map(mean).collect();
    channels.column(|row, k| match row {
        Channel::Course(hold, ..) => in_courses * (value(k, hold) - means[hold]),
        Channel::Trace(hold, _) => in_traces * value(k, hold),
        Channel::Level(..) => 0.0,
    })
}

/// Chooses causes one after the other, each by its evidence in the presence of those before it. `watch` is asked before every hold that is left
/// out.
///
/// # Errors
/// What `watch` says.
pub fn choose(
    channels: &Channels,
    candidates: &[Candidate],
    watch: &dyn Fn() -> Result<(), InferenceError>,
) -> Result<Chosen, InferenceError> {
    let mut rows = channels.model.clone();
    let mut chosen = Chosen {
        named: Vec::new(),
        rivals: Vec::new(),
        alike: Vec::new(),
        left: (0.0, 0),
    };
    let mut taken: Vec<Cause> = Vec::new();
    let has_trace = channels
        .rows
        .iter()
        .any(|row| matches!(row, Channel::Trace(..)));
    for round in 0..=MOST {
        let Some(whole) = rows.factored(|_| true) else {
            return Ok(chosen);
        };
        let data = Data {
            channels,
            rows: &rows,
            whole: &whole,
        };
        let mut weighed = data.weigh(candidates, &taken, watch)?;
        weighed.sort_by(|a, b| b.net.total_cmp(&a.net));
        if round == 0 {
            chosen.rivals.clone_from(&weighed);
        }
        let needed = |cause: Cause| match (round, cause.region()) {
            (0, None) => NAMED.0,
            (0, Some(_)) => REGION.0,
            _ => NAMED.1,
        };
        let is_named = |each: &&Weighed| {
            let is_large =
                !matches!(each.cause, Cause::Stiffness(_)) || each.sized.size.abs() > REGION.1;
            is_large && each.net > needed(each.cause) && each.held_out.is_none_or(|g| g > 0.0)
        };
        let best = weighed.iter().find(is_named).cloned();
        let (Some(best), true) = (best, round < MOST) else {
            chosen.left = whole.chi_squared();
            return Ok(chosen);
        };
        // Without a trace, tissue that gives way and a mat whose readings fall differ by the shape of their course alone.
        let is_course = |cause: Cause| matches!(cause, Cause::Relaxation(_) | Cause::Drift(_));
        let is_untraced = !has_trace && is_course(best.cause);
        let is_alike = |each: &&Weighed| {
            let is_near = each.net > best.net - ALIKE
                || (is_untraced && is_course(each.cause) && each.net > NAMED.0);
            is_near
                && each.cause.name() != best.cause.name()
                && each.cause.region() == best.cause.region()
        };
        let mut alike: Vec<Weighed> = Vec::new();
        for rival in weighed.iter().filter(is_alike) {
            if alike
                .iter()
                .all(|known| known.cause.name() != rival.cause.name())
            {
                alike.push(rival.clone());
            }
        }
        chosen.alike.push(alike);
        if let Cause::Relaxation(_) = best.cause {
            let is_own = |each: &&Candidate| matches!(each.cause, Cause::Relaxation(_));
            let others = candidates.iter().filter(is_own);
            rows.nuisances
                .extend(others.map(|each| (each.column.clone(), SPECTRUM)));
        }
        if let Some(own) = candidates.iter().find(|each| each.cause == best.cause) {
            rows.nuisances.push((own.column.clone(), own.prior));
        }
        taken.push(best.cause);
        if is_untraced {
            taken.extend([Cause::Relaxation(0.0), Cause::Drift(DriftForm::Even)]);
        }
        chosen.named.push(best);
    }
    Ok(chosen)
}

/// What causes are weighed on.
struct Data<'a> {
    channels: &'a Channels,
    rows: &'a Rows,
    whole: &'a Factored,
}

/// Numbers of the holds that are left out in turn; none with one hold.
fn folds(channels: &Channels) -> Range<usize> {
    let last = channels.rows.iter().map(|row| row.hold()).max();
    match last {
        Some(last) if last > 0 => 0..last + 1,
        _ => 0..0,
    }
}

impl Data<'_> {
    /// Causes weighed on all rows, and on those of every hold given the others.
    fn weigh(
        &self,
        candidates: &[Candidate],
        taken: &[Cause],
        watch: &dyn Fn() -> Result<(), InferenceError>,
    ) -> Result<Vec<Weighed>, InferenceError> {
        // A kind is named once; of one region stiffness or bone.
        let is_taken = |each: &Candidate| {
            taken.iter().any(|named| match named.region() {
                None => named.name() == each.cause.name(),
                region => region == each.cause.region(),
            })
        };
        let free = candidates.iter().filter(|each| !is_taken(each));
        let sized = free.map(|each| (each, self.whole.with(&each.column, each.prior)));
        let kept = sized.filter(|(each, sized)| !each.is_positive || sized.size > 0.0);
        let kept: Vec<_> = kept.collect();
        let folds = folds(self.channels);
        let mut held_out = vec![0.0; kept.len()];
        for hold in folds.clone() {
            watch()?;
            let Some(others) = self.rows.factored(|k| self.channels.rows[k].hold() != hold) else {
                continue;
            };
            for (sum, (each, sized)) in held_out.iter_mut().zip(&kept) {
                *sum += sized.gain - others.with(&each.column, each.prior).gain;
            }
        }
        let weighed = kept.into_iter().zip(held_out);
        let weighed = weighed.map(|((each, sized), held_out)| Weighed {
            cause: each.cause,
            sized,
            net: sized.gain - each.cost,
            held_out: (!folds.is_empty()).then_some(held_out),
        });
        Ok(weighed.collect())
    }
}
