//! An indentation as moments and samples.

use nalgebra::Vector3;
use thenar_recordings::Curve;

use crate::observe::downsampling::{bins, means};
use crate::observe::first_touch::onset;
use crate::observe::measured::{Censoring, Moment, Phase, Quantity, Sample};
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
}

/// Turns a curve into at most about `budget` moments with force, and area and tangential force where they are given.
///
/// `across` is the direction in which a slide counts.
pub fn observe(curve: &Curve, across: Vector3<f64>, budget: usize) -> Observation {
    let mut unknown = curve.unknown.clone();
    let channel = |name: &str| curve.channel(name).unwrap_or(&[]);
    let (time, force, slide) = (channel("time_s"), channel("force_n"), channel("slide_mm"));
    let is_touch_known = curve.channel("depth_mm").is_some();
    let mut force = force.to_vec();
    let mut depth = match is_touch_known {
        true => channel("depth_mm").to_vec(),
        false => channel("travel_mm").to_vec(),
    };
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
    let stretches = stretches(courses);
    let bins = bins(courses, &stretches, budget);
    if bins.len() < time.len() {
        unknown.push(format!(
            "its {} samples are compared as {} means, none across a change of phase",
            time.len(),
            bins.len()
        ));
    }
    let list = |values: &[f64]| (!values.is_empty()).then(|| means(values, &bins));
    let (times, depths) = (means(time, &bins), means(&depth, &bins));
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
        moments,
        samples,
        is_touch_known,
        unknown,
    }
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
