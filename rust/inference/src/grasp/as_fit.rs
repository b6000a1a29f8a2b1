//! An explained grasp study as the fit that a comparison shows.

use nalgebra::{DMatrix, Vector3};
use thenar_contact::instrument::Placement;

use crate::fit::result::Fit;
use crate::grasp::causes::{Cause, Weighed};
use crate::grasp::explain::Explained;
use crate::grasp::hold::Hold;
use crate::observe::measured::{Censoring, Mat, Measured, Moment, Phase, Quantity, Sample};

/// Standard deviation of a cell in the mean over a stretch: kPa, and share of the reading.
const NOISE: (f64, f64) = (1.0, 0.03);

/// Course of a hold's force with and without what was named.
pub struct ForceCourse {
    /// s, on the recording's clock.
    pub time_s: Vec<f64>,
    /// N, of the trace, else of the cells' sum.
    pub measured_n: Vec<f64>,
    /// N, with the posture that moves as it was found to.
    pub before_n: Vec<f64>,
    /// N, with what was named as well.
    pub after_n: Vec<f64>,
}

/// The fit, with a list for every hold in the order of [`Explained::holds`].
pub fn as_fit(explained: &Explained, notes: Vec<String>) -> Fit {
    let mut fit = Fit {
        measured: Vec::new(),
        simulated: Vec::new(),
        before: Vec::new(),
        sigma: Vec::new(),
        projected: Vec::new(),
        absorbed: DMatrix::zeros(0, 0),
        estimates: Vec::new(),
        lack_of_fit_p: None,
        notes,
    };
    for (number, hold) in explained.holds.iter().enumerate() {
        let given = as_given(explained, hold);
        let (mut samples, mut simulated) = (Vec::new(), Vec::new());
        let (mut before, mut sigma) = (Vec::new(), Vec::new());
        for (stretch, map) in hold.maps.iter().enumerate() {
            let maps = simulated_map(explained, (number, stretch), true);
            for (cell, &read) in map.iter().enumerate() {
                if read.is_nan() || !explained.cells.is_live[cell] {
                    continue;
                }
                samples.push(Sample {
                    moment: stretch as u32,
                    quantity: Quantity::Pressure(cell as u32),
                    value: read,
                    censoring: censoring(explained, read),
                });
                simulated.push(maps[cell]);
                before.push(given[cell]);
                sigma.push(NOISE.0.hypot(NOISE.1 * read));
            }
        }
        let each = samples.iter().zip(&simulated).zip(&sigma);
        fit.projected
            .push(each.map(|((s, m), d)| (s.value - m) / d).collect());
        fit.measured.push(measured(hold, samples));
        fit.simulated.push(simulated);
        fit.before.push(before);
        fit.sigma.push(sigma);
    }
    let count = fit.simulated.iter().map(Vec::len).sum();
    fit.absorbed = DMatrix::zeros(count, 0);
    fit
}

/// Forces of a hold.
pub fn force_course(explained: &Explained, number: usize) -> ForceCourse {
    let hold = &explained.holds[number];
    let sums = |with: bool| -> Vec<f64> {
        let map = |stretch| simulated_map(explained, (number, stretch), with);
        (0..hold.maps.len())
            .map(|stretch| hold.sum_n(&map(stretch)))
            .collect()
    };
    let read: Vec<f64> = hold.maps.iter().map(|map| hold.sum_n(map)).collect();
    let measured = hold.force_n.clone().unwrap_or_else(|| read.clone());
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
    let leveled = |of: Vec<f64>| -> Vec<f64> {
        let factor = mean(&measured) / mean(&of).max(1e-9);
        of.iter().map(|f| f * factor).collect()
    };
    ForceCourse {
        time_s: hold.time_s.iter().map(|t| t + hold.closed_s).collect(),
        before_n: leveled(sums(false)),
        after_n: leveled(sums(true)),
        measured_n: measured,
    }
}

/// Share that a named relaxation leaves at a time, over its mean in the hold.
fn relaxed(named: &[Weighed], hold: &Hold, stretch: usize) -> f64 {
    let mut change = 0.0;
    for each in named {
        if let Cause::Relaxation(time) = each.cause {
            let shape = |t: f64| 1.0 - (-t / time).exp();
            let mean =
                hold.time_s.iter().map(|t| shape(*t)).sum::<f64>() / hold.time_s.len() as f64;
            change -= each.sized.size * (shape(hold.time_s[stretch]) - mean);
        }
    }
    change
}

fn simulated_map(explained: &Explained, (number, stretch): (usize, usize), with: bool) -> Vec<f64> {
    let (hold, fit) = (&explained.holds[number], &explained.fits[number]);
    let change = match with {
        true => relaxed(&explained.chosen.named, hold, stretch),
        false => 0.0,
    };
    let moved = explained.courses[number].shift_mm.get(stretch);
    let cell = |c: usize| {
        let of = |r: usize| {
            let shift = moved.map_or(0.0, |m| m[r]);
            fit.maps[r][c] * (1.0 + change) + fit.by_shift[r][c] * shift
        };
        (0..fit.active.len()).map(of).sum::<f64>().max(0.0) * explained.cells.gain[c]
    };
    (0..hold.kept.len()).map(cell).collect()
}

/// The map of the grasp as the study gives it.
fn as_given(explained: &Explained, hold: &Hold) -> Vec<f64> {
    let mut sum = vec![0.0; hold.kept.len()];
    for region in 0..explained.forces.len() {
        let read = explained
            .forces
            .read(region, 0.0, (&hold.mat, &Placement::default()));
        sum.iter_mut().zip(read).for_each(|(sum, p)| *sum += p);
    }
    sum
}

fn censoring(explained: &Explained, read: f64) -> Censoring {
    match read {
        p if p >= 0.98 * explained.cells.ceiling_kpa => Censoring::AtLeast,
        p if p <= explained.cells.floor_kpa => Censoring::AtMost,
        _ => Censoring::Seen,
    }
}

fn measured(hold: &Hold, samples: Vec<Sample>) -> Measured {
    let moment = |(time, frames): (&f64, &usize)| Moment {
        time_s: time + hold.closed_s,
        depth_mm: f64::NAN,
        demand_n: f64::NAN,
        slide_mm: Vector3::zeros(),
        rate_mm_s: f64::NAN,
        phase: Phase::Hold,
        cycle: 0,
        readings: *frames as u32,
        depth_spread_mm: 0.0,
        force_step_n: 0.0,
    };
    Measured {
        name: hold.name.clone(),
        protocol: hold.name.clone(),
        indenter: String::new(),
        site: String::new(),
        moments: hold.time_s.iter().zip(&hold.frames).map(moment).collect(),
        samples,
        mat: Some(Mat {
            centers: hold.mat.centers().to_vec(),
            normals: hold.mat.normals().to_vec(),
            areas: hold.mat.areas().to_vec(),
            places: hold.places.clone(),
        }),
        scan: None,
        is_calibrated: true,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: Vec::new(),
    }
}
