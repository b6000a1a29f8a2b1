//! Cross-validation: every protocol is predicted from the others, with and without a finding.

use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::force_recording::ForceRecording;
use crate::forward::surrogate::mechanism::Mechanism;
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::least_squares::surrogate_fit::{Refit, refit};
use crate::noise::whitening::Whitening;
use crate::observe::measured::Measured;
use crate::parameters::surrogate_parameter::Kind;
use crate::random::Random;
use crate::selection::negative_control::{HeldOut, negative_control};
use crate::selection::scored::Scored;
use thenar_contact::ActiveEffect;

/// Errors beyond this many standard deviations of the noise count as that many: outliers of a recording are nobody's gain.
const MOST: f64 = 8.0;
/// Times that recordings are resampled for an interval.
const DRAWS: usize = 400;
/// Ends of a 90 % interval.
const ENDS: (f64, f64) = (0.05, 0.95);

/// Squared errors of one recording, over the noise: without and with the finding, repeat against repeat, and their number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Errors {
    before: f64,
    after: f64,
    floor: f64,
    count: f64,
}

/// A finding to be judged by recordings that it was not fitted to.
#[derive(Clone)]
pub struct Judged<'a> {
    /// The study.
    pub ready: &'a PreparedStudy,
    /// Its recordings.
    pub measured: &'a [Measured],
    /// The finding.
    pub found: &'a Scored,
    /// Variance of the residuals over the noise's.
    pub overdispersion: f64,
    /// Of what is drawn for intervals and for the negative control.
    pub seed: u64,
}

impl Judged<'_> {
    /// Holds every protocol out in turn, or where there is but one every recording; None where there is but one recording.
    ///
    /// What belongs to a held-out recording alone (its gain, first touch and zero of the force, within what repeats differ by; the model's form where its
    /// tool was not seen) is fitted to it, with and without the finding alike; nothing else is.
    pub fn by_protocol(&self) -> Option<Gain> {
        self.over(&folds(&self.ready.courses)?, HeldOutBy::Protocol)
    }

    /// The same with the first repeats of all protocols held out together, then the second ones, and so on: what one protocol alone can
    /// show, as a ceiling that no other reaches, only its own repeats can confirm. None where no protocol was repeated.
    pub fn by_repeat(&self) -> Option<Gain> {
        let folds = repeats(&self.ready.courses);
        let is_repeated = folds.iter().any(|number| *number > 0);
        is_repeated.then(|| self.over(&folds, HeldOutBy::Repeat))?
    }

    /// The fits that predict what is held out, in the way that a gain was found by.
    pub(crate) fn fits(&self, held_out_by: HeldOutBy) -> impl ExactSizeIterator<Item = Fold> {
        let folds = match held_out_by {
            HeldOutBy::Protocol => folds(&self.ready.courses),
            HeldOutBy::Repeat => Some(repeats(&self.ready.courses)),
        };
        self.fitted(folds.unwrap_or_default())
    }

    fn fitted(&self, folds: Vec<usize>) -> impl ExactSizeIterator<Item = Fold> {
        let numbers = folds.iter().max().map_or(0, |last| last + 1);
        let fold = move |number: usize| {
            let is_out = |c: usize| folds[c] == number;
            let of = |mechanisms: &[Mechanism]| {
                let from = (mechanisms, &self.found.refit.at[..]);
                predicted(self.ready, self.measured, from, &is_out)
            };
            Fold {
                courses: (0..folds.len()).filter(|c| is_out(*c)).collect(),
                before: of(&[]),
                after: of(&self.found.mechanisms),
            }
        };
        (0..numbers).map(fold)
    }

    fn over(&self, folds: &[usize], held_out_by: HeldOutBy) -> Option<Gain> {
        let (mut all, mut held) = (Vec::new(), Vec::new());
        let mut deviance = 0.0;
        for (number, fold) in self.fitted(folds.to_vec()).enumerate() {
            let (before, after) = (&fold.before, &fold.after);
            deviance += before.deviance - after.deviance;
            for &c in &fold.courses {
                let mut own = HeldOut {
                    protocol: number,
                    error: Vec::new(),
                    patch: Vec::new(),
                };
                let samples = self.ready.courses[c].rows.iter().filter_map(|r| r.sample);
                for sample in samples {
                    own.error.push(before.residual[sample]);
                    own.patch
                        .push(before.residual[sample] - after.residual[sample]);
                }
                all.push(errors(self.ready, c, (&before.simulated, &after.simulated)));
                held.push(own);
            }
        }
        if all.is_empty() {
            return None;
        }
        let nats = |squares: f64| 0.5 * squares / self.overdispersion;
        Some(Gain {
            log_score: nats(deviance),
            confirmed: nats(deviance) / self.found.qaic_gain.max(1e-3),
            placebo: nats(negative_control(&held, MOST, self.seed)),
            held_out_by,
            ..summary(self.ready, &all, self.seed)
        })
    }
}

/// Recordings that are held out at once, and the fits to all others that predict them.
pub(crate) struct Fold {
    /// Numbers of the recordings held out.
    pub courses: Vec<usize>,
    /// Without the finding.
    pub before: Refit,
    /// With it.
    pub after: Refit,
}

/// Squared errors of one recording's predictions (stacked samples), without and with a finding.
pub(crate) fn errors(
    ready: &PreparedStudy,
    course: usize,
    (before, after): (&[f64], &[f64]),
) -> Errors {
    let mut sum = Errors {
        before: 0.0,
        after: 0.0,
        floor: 0.0,
        count: 0.0,
    };
    for row in &ready.courses[course].rows {
        let Some(sample) = row.sample else {
            continue;
        };
        let square = |simulated: &[f64]| {
            ((row.force_n - simulated[sample]) / ready.sigma[sample])
                .clamp(-MOST, MOST)
                .powi(2)
        };
        sum.before += square(before);
        sum.after += square(after);
        sum.count += 1.0;
    }
    sum.floor = sum.count * floor(ready, course);
    sum
}

/// By recording, the number of the fold with which it is held out: its protocol's, or where there is but one its own.
fn folds(courses: &[ForceRecording]) -> Option<Vec<usize>> {
    let mut protocols: Vec<(&str, usize)> = Vec::new();
    let mut folds = Vec::new();
    for course in courses {
        let key = (course.protocol.as_str(), course.place);
        let known = protocols.iter().position(|other| *other == key);
        folds.push(known.unwrap_or_else(|| {
            protocols.push(key);
            protocols.len() - 1
        }));
    }
    match (protocols.len(), courses.len()) {
        (_, 0 | 1) => None,
        (1, n) => Some((0..n).collect()),
        _ => Some(folds),
    }
}

/// By recording, how many of its protocol and place come before it.
fn repeats(courses: &[ForceRecording]) -> Vec<usize> {
    let is_same =
        |a: &ForceRecording, b: &ForceRecording| a.protocol == b.protocol && a.place == b.place;
    let before = |(c, one): (usize, &ForceRecording)| {
        courses[..c]
            .iter()
            .filter(|other| is_same(one, other))
            .count()
    };
    courses.iter().enumerate().map(before).collect()
}

/// Mean square of repeats about each other, over the noise, as noise would give it: 1, or less if the noise was judged too large.
fn floor(ready: &PreparedStudy, course: usize) -> f64 {
    let one = &ready.courses[course];
    let mut squares = (0.0, 0.0);
    for other in &ready.courses {
        let repeats =
            other.protocol == one.protocol && other.place == one.place && other.name != one.name;
        if !repeats || other.rows.len() != one.rows.len() {
            continue;
        }
        let gain = {
            let both = one.rows.iter().zip(&other.rows);
            let (over, under) = both.fold((0.0, 0.0), |(o, u), (a, b)| {
                (o + a.force_n * b.force_n, u + b.force_n * b.force_n)
            });
            if under > 0.0 { over / under } else { 1.0 }
        };
        for (a, b) in one.rows.iter().zip(&other.rows) {
            if let Some(sample) = a.sample {
                let off = (a.force_n - gain * b.force_n) / ready.sigma[sample];
                squares = (
                    squares.0 + 0.5 * off.clamp(-MOST, MOST).powi(2),
                    squares.1 + 1.0,
                );
            }
        }
    }
    if squares.1 > 0.0 {
        f64::min(squares.0 / squares.1, 1.0)
    } else {
        1.0
    }
}

/// Predictions of what is out, from a fit to what is not, and their whitened residuals.
fn predicted(
    ready: &PreparedStudy,
    measured: &[Measured],
    (mechanisms, from): (&[Mechanism], &[f64]),
    is_out: &dyn Fn(usize) -> bool,
) -> Refit {
    let used = |out: bool| -> Vec<bool> {
        let of = |r: usize| ready.courses.iter().position(|c| c.recording == r);
        (0..measured.len())
            .map(|r| of(r).is_some_and(|c| is_out(c) == out))
            .collect()
    };
    let within = |whitening: &Whitening, pin: Option<&[f64]>| {
        let surrogate = Surrogate {
            whitening,
            ..ready.surrogate()
        };
        let mut model = Model::new(&surrogate, mechanisms);
        if let Some(values) = pin {
            let seen = |place: usize| {
                let mut all = ready.courses.iter().enumerate();
                all.any(|(c, course)| course.place == place && !is_out(c))
            };
            for (coordinate, value) in model.coordinates.iter_mut().zip(values) {
                let own = match coordinate.kind {
                    Kind::Form(place, _) | Kind::Touch(place) => !seen(place),
                    kind => kind.course().is_some_and(is_out),
                };
                if !own {
                    coordinate.bounds = (*value, *value);
                    coordinate.prior = None;
                }
            }
        }
        let start = pin.unwrap_or(&from[..from.len().min(model.coordinates.len())]);
        refit(&surrogate, &model, start)
    };
    let told_by = Whitening::new(measured, &ready.noise, &used(false));
    let fitted = within(&told_by, None);
    let shown_by = Whitening::new(measured, &ready.noise, &used(true));
    within(&shown_by, Some(&fitted.at))
}

pub(crate) fn summary(ready: &PreparedStudy, all: &[Errors], seed: u64) -> Gain {
    let rms = |of: &[&Errors], which: &dyn Fn(&Errors) -> f64| {
        let (sum, n) = of
            .iter()
            .fold((0.0, 0.0), |(s, n), e| (s + which(e), n + e.count));
        (sum / f64::max(n, 1.0)).sqrt()
    };
    let four = |of: &[&Errors]| {
        let (e0, e1) = (rms(of, &|e| e.before), rms(of, &|e| e.after));
        let floor = rms(of, &|e| e.floor);
        let reducible = e0 * e0 - floor * floor;
        let removed = (e0 * e0 - e1 * e1) / reducible.max(1e-3 * e0 * e0).max(1e-12);
        [e0, e1, floor, removed.min(1.0)]
    };
    let whole: Vec<&Errors> = all.iter().collect();
    let best = four(&whole);
    let mut random = Random::new(seed);
    let mut drawn: [Vec<f64>; 4] = Default::default();
    for _ in 0..DRAWS {
        let of: Vec<&Errors> = (0..all.len())
            .map(|_| &all[((random.uniform() * all.len() as f64) as usize).min(all.len() - 1)])
            .collect();
        for (list, value) in drawn.iter_mut().zip(four(&of)) {
            list.push(value);
        }
    }
    let interval = |list: &mut Vec<f64>| {
        list.sort_by(f64::total_cmp);
        let at = |share: f64| list[((share * list.len() as f64) as usize).min(list.len() - 1)];
        (at(ENDS.0), at(ENDS.1))
    };
    let [mut before, mut after, mut floor, mut removed] = drawn;
    Gain {
        held_out: ready.courses.iter().map(|c| c.name.clone()).collect(),
        before: Spread {
            rms: best[0],
            interval: interval(&mut before),
        },
        after: Spread {
            rms: best[1],
            interval: interval(&mut after),
        },
        floor: Spread {
            rms: best[2],
            interval: interval(&mut floor),
        },
        removed: best[3],
        interval: interval(&mut removed),
        log_score: 0.0,
        confirmed: 0.0,
        placebo: 0.0,
        members: Vec::new(),
        held_out_by: HeldOutBy::Protocol,
        contact_model: None,
    }
}

/// What is held out at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldOutBy {
    /// All recordings of a protocol.
    Protocol,
    /// One recording of every protocol.
    Repeat,
}

/// An error of prediction with its 90 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Root mean square.
    pub rms: f64,
    /// Ends of the interval.
    pub interval: (f64, f64),
}

/// How well recordings are predicted that were not used.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// Recordings that were held out in turn, protocol by protocol.
    pub held_out: Vec<String>,
    /// Without and with the finding, in standard deviations of the noise.
    pub before: Spread,
    /// With it.
    pub after: Spread,
    /// Repeat against repeat.
    pub floor: Spread,
    /// Share of the reducible error that is removed.
    pub removed: f64,
    /// Ends of its interval.
    pub interval: (f64, f64),
    /// How much the log predictive density of held-out recordings rises with the finding, nats: half the fall of their whitened deviance
    /// over the overdispersion (a plug-in estimate of the difference in elpd, Vehtari, Gelman and Gabry 2017). It weighs what noise
    /// hardly hides, which the squared error of curves with a slow noise does not.
    pub log_score: f64,
    /// Share of the finding's evidence that this is.
    pub confirmed: f64,
    /// The same rise with the finding's change on the wrong recordings at the wrong moments, in 99 of 100 draws at most.
    pub placebo: f64,
    /// Of two effects together: share of the evidence for each, given the other, that held-out recordings confirm.
    pub members: Vec<(&'static str, f64)>,
    /// What was held out at once.
    pub held_out_by: HeldOutBy,
    /// The same recordings predicted by the contact model on the study's mesh; None where it was not asked or has no such effect.
    pub contact_model: Option<ContactModelCheck>,
}

/// How the contact model with a finding's effects predicts recordings that were held out.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactModelCheck {
    /// Error without the finding, in standard deviations of the noise.
    pub before: Spread,
    /// Error of the contact model with it.
    pub after: Spread,
    /// Share of the reducible error that is removed; negative: the contact model predicts worse with what the finding switches on.
    pub removed: f64,
    /// Ends of its 90 % interval.
    pub interval: (f64, f64),
    /// Share that the fit removes in the same recordings, and its error there, in standard deviations of the noise.
    pub by_fit: (f64, f64),
    /// Factors on the fit's moduli with which this was found: at first touch, and where they stop growing.
    pub moduli: [f64; 2],
    /// The effects that are to be switched on, with the numbers with which this was found.
    pub effects: Vec<ActiveEffect>,
}
