//! An indentation as moments and samples.

use std::ops::Range;

use nalgebra::Vector3;
use thenar_recordings::Curve;

use crate::number_format::number;
use crate::observe::depth_jitter::without_jitter;
use crate::observe::downsampling::{bins, means, spread};
use crate::observe::first_touch::onset;
use crate::observe::measured::{Censoring, Moment, Phase, Quantity, Sample};
use crate::observe::motion::moving_average::{Window, moving_average, variance_within};
use crate::observe::motion::rounding::{exceeds_noise, wide_step};
use crate::observe::motion::stray::without_strays;
use crate::observe::protocol_phases::{Courses, Stretch, range, stretches};
use crate::observe::robust_scale::{median, noise_of};

/// What a curve says, thinned.
pub struct Observation {
    /// Instants.
    pub moments: Vec<Moment>,
    /// Numbers.
    pub samples: Vec<Sample>,
    /// False where the depth of first touch is a guess from the force.
    pub is_touch_known: bool,
    /// What cannot be known, a sentence each.
    pub unknown: Vec<String>,
    /// How it was thinned.
    pub division: Division,
    /// As [`crate::observe::measured::Measured::depth_error_mm`].
    pub depth_error_mm: f64,
    /// As [`crate::observe::measured::Measured::is_coarse`].
    pub is_coarse: bool,
}

/// Phases of a recording and the bins whose means are compared. Repeats share those of the first: bins that follow each one's own noise
/// would lie at other moments in each.
#[derive(Debug, Clone)]
pub struct Division {
    /// Of all readings, s.
    time_s: Vec<f64>,
    stretches: Vec<Stretch>,
    bins: Vec<Range<usize>>,
}

impl Division {
    /// Whether readings at these times (s) are to be divided alike: too many to keep each, as many as here, and each at the same moment
    /// but for half a step.
    fn fits(&self, time_s: &[f64]) -> bool {
        let is_thinned = self.bins.len() < self.time_s.len();
        let (n, m) = (time_s.len(), self.time_s.len());
        let lag = |t: &[f64]| t.first().copied().unwrap_or(0.0);
        let offset = lag(time_s) - lag(&self.time_s);
        let is_same = |k: usize| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(m - 1));
            let step = 0.5 * (self.time_s[after] - self.time_s[before]);
            (time_s[k] - offset - self.time_s[k]).abs() < 0.5 * step
        };
        is_thinned && n == m && (0..n).all(is_same)
    }
}

/// Turns a curve into at most about `budget` moments with force, and area and tangential force where they are given.
///
/// `across` is the direction in which a slide counts, `alike` how a repeat of the same protocol was divided, and `averaged` over which readings each
/// force is a mean.
pub fn observe(
    curve: &Curve,
    (across, alike, averaged): (Vector3<f64>, Option<&Division>, Window),
    budget: usize,
) -> Observation {
    let mut unknown = curve.unknown.clone();
    let channel = |name: &str| curve.channel(name).unwrap_or(&[]);
    let (time, force, slide) = (channel("time_s"), channel("force_n"), channel("slide_mm"));
    let is_touch_known = curve.channel("depth_mm").is_some();
    let mut force = force.to_vec();
    let mut depth = match is_touch_known {
        true => channel("depth_mm").to_vec(),
        false => channel("travel_mm").to_vec(),
    };
    let without_strays = without_strays(Courses {
        time_s: time,
        depth_mm: &depth,
        force_n: &force,
        slide_mm: slide,
    });
    if let Some(found) = without_strays {
        unknown.push(format!(
            "readings of its depth that are astray: {}, by up to {:.0} um; the force does not follow them, and they are taken as those before and \
             after have it",
            found.count,
            1000.0 * found.most_mm
        ));
        depth = found.depth_mm;
    }
    if !is_touch_known {
        let touch = onset(&depth, &force);
        let (travel, rest) = (depth[touch.sample], touch.rest_n);
        depth.iter_mut().for_each(|d| *d -= travel);
        force.iter_mut().for_each(|f| *f -= rest);
        unknown.push(format!(
            "the file gives travel but no point of first touch: it is taken where the force rises from its noise, {travel:.4} mm, \
             and fitted; the force before it ({rest:.3e} N) is taken off"
        ));
    }
    let courses = Courses {
        time_s: time,
        depth_mm: &depth,
        force_n: &force,
        slide_mm: slide,
    };
    let alike = alike.filter(|division| division.fits(time));
    let stretches = alike.map_or_else(|| stretches(courses), |division| division.stretches.clone());
    let steady = without_jitter(courses, &stretches);
    if let Some(found) = &steady {
        unknown.push(match found.step_mm > 0.0 {
            true => format!(
                "its depth is read in steps of {:.1} um, within which it follows straight lines: it is taken as these lines",
                1000.0 * found.step_mm
            ),
            false => format!(
                "its depth jitters by {:.0} um about a smooth motion, of which the force follows {:.0} %: the rest is taken for noise of \
                 the reading",
                1000.0 * found.jitter_mm,
                100.0 * found.reliability
            ),
        });
    }
    let read = steady
        .as_ref()
        .map_or(courses.depth_mm, |found| &found.depth_mm);
    let averaged_alike = moving_average(read, averaged);
    let within = variance_within(read, averaged);
    let readings = averaged.readings();
    if readings > 1 {
        unknown.push(format!(
            "each of its forces is the mean of {readings} readings: its depth is averaged over the same"
        ));
    }
    let courses = Courses {
        depth_mm: &averaged_alike,
        ..courses
    };
    let bins = alike.map_or_else(
        || bins(courses, &stretches, budget),
        |division| division.bins.clone(),
    );
    if bins.len() < time.len() {
        unknown.push(format!(
            "its {} samples are compared as {} means, none across a change of phase",
            time.len(),
            bins.len()
        ));
    }
    let step_n = wide_step(&force);
    let is_coarse = exceeds_noise(step_n, &force);
    if is_coarse {
        unknown.push(format!(
            "its force is read in steps of {} mN, which are larger than its noise: what is smaller than half a step is not seen; a finer range of \
             the load cell shows it",
            number(1000.0 * step_n)
        ));
    }
    let list = |values: &[f64]| (!values.is_empty()).then(|| means(values, &bins));
    let (times, depths) = (means(time, &bins), means(courses.depth_mm, &bins));
    let slides = list(slide);
    let of_bin = |k: usize| {
        let first = bins[k].start;
        let found = stretches.iter().position(|s| first < s.end);
        found.map_or(0, |found| found)
    };
    let rates = rates(&times, &depths, of_bin);
    let moments: Vec<Moment> = (0..bins.len())
        .map(|k| {
            let stretch: &Stretch = &stretches[of_bin(k)];
            Moment {
                time_s: times[k],
                depth_mm: depths[k],
                demand_n: f64::NAN,
                slide_mm: across * slides.as_ref().map_or(0.0, |s| s[k]),
                rate_mm_s: rates[k],
                phase: stretch.phase,
                cycle: stretch.cycle,
                readings: bins[k].len() as u32,
                depth_spread_mm: spread((time, courses.depth_mm), &bins[k])
                    .hypot(means(&within, &bins[k..=k])[0].sqrt()),
                force_step_n: match is_of_one_reading(&force[bins[k].clone()]) {
                    true => step_n,
                    false => 0.0,
                },
            }
        })
        .collect();
    unknown.extend(unseen_phases(&moments));
    let lists = [
        (Quantity::Force, Some(means(&force, &bins))),
        (
            Quantity::TangentialForce,
            list(channel("tangential_force_n")),
        ),
        (Quantity::Area, list(channel("area_mm2"))),
    ];
    let mut samples = Vec::new();
    for k in 0..moments.len() {
        for (quantity, values) in &lists {
            if let Some(values) = values {
                samples.push(Sample {
                    moment: k as u32,
                    quantity: *quantity,
                    value: values[k],
                    censoring: Censoring::Seen,
                });
            }
        }
    }
    Observation {
        depth_error_mm: steady.as_ref().map_or(0.0, |found| found.left_mm),
        is_coarse,
        moments,
        samples,
        is_touch_known,
        unknown,
        division: Division {
            time_s: time.to_vec(),
            stretches,
            bins,
        },
    }
}

/// Whether all of these readings are the same.
fn is_of_one_reading(readings: &[f64]) -> bool {
    readings.windows(2).all(|two| two[0] == two[1])
}

/// Speed of the depth at every moment, mm/s: the slope of a straight line through it and its neighbors of the same stretch.
fn rates(time: &[f64], depth: &[f64], stretch_of: impl Fn(usize) -> usize) -> Vec<f64> {
    let n = time.len();
    let own: Vec<usize> = (0..n).map(stretch_of).collect();
    let slope = |k: usize| {
        let near = (k.saturating_sub(2)..(k + 3).min(n)).filter(|&j| own[j] == own[k]);
        let near: Vec<usize> = near.collect();
        let mean = |v: &[f64]| near.iter().map(|&j| v[j]).sum::<f64>() / near.len() as f64;
        let (t, d) = (mean(time), mean(depth));
        let over: f64 = near.iter().map(|&j| (time[j] - t) * (depth[j] - d)).sum();
        let under: f64 = near.iter().map(|&j| (time[j] - t).powi(2)).sum();
        if under > 0.0 { over / under } else { 0.0 }
    };
    (0..n).map(slope).collect()
}

/// Sentences about what a protocol never did.
fn unseen_phases(moments: &[Moment]) -> Vec<String> {
    let has = |phase: Phase| moments.iter().any(|m| m.phase == phase && m.depth_mm > 0.0);
    let mut sentences = Vec::new();
    if !has(Phase::Unload) {
        sentences
            .push("it never unloads: loss, adhesion and recovery cannot be seen in it".to_owned());
    }
    if !has(Phase::Hold) {
        sentences.push("it never stands still: fading of the force with time cannot be told from a softer skin".to_owned());
    }
    let depths: Vec<f64> = moments.iter().map(|m| m.depth_mm).collect();
    let (low, high) = range(&depths);
    let mut steps: Vec<f64> = depths.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    if high - low < 10.0 * noise_of(&depths) && median(&mut steps) > 0.0 {
        sentences.push("its depth hardly leaves the noise".to_owned());
    }
    sentences
}
