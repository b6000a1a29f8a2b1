//! Fits made by hand for the tests of comparison and report: an indentation with known noise, and a mat with known frames.

#![allow(dead_code)]

use nalgebra::{DMatrix, Vector3};
use thenar_comparison::{Compared, Comparison, compare_fit};
use thenar_inference::{
    Censoring, Estimate, Fit, Mat, Measured, Moment, Phase, Quantity, Sample, Target,
};

pub type Vec3 = Vector3<f64>;

/// Normal numbers from a seed (SplitMix64, Box-Muller).
pub struct Normal(pub u64);

impl Normal {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 + 1e-17
    }

    pub fn next(&mut self) -> f64 {
        let (a, b) = (self.unit(), self.unit());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

/// Loads in 2 s, holds 3 s, unloads in 2 s, to 2 mm, `count` moments.
pub fn ramp_and_hold(count: usize) -> Vec<Moment> {
    let moment = |k: usize| {
        let time_s = 7.0 * k as f64 / (count - 1) as f64;
        let (depth_mm, rate_mm_s, phase) = match time_s {
            t if t < 2.0 => (t, 1.0, Phase::Load),
            t if t <= 5.0 => (2.0, 0.0, Phase::Hold),
            t => (7.0 - t, -1.0, Phase::Unload),
        };
        Moment {
            time_s,
            depth_mm,
            demand_n: f64::NAN,
            slide_mm: Vec3::zeros(),
            rate_mm_s,
            phase,
            cycle: 0,
            readings: 1,
            depth_spread_mm: 0.0,
            force_step_n: 0.0,
        }
    };
    (0..count).map(moment).collect()
}

/// A recording of forces over [`ramp_and_hold`], with their simulation.
pub fn indentation(name: &str, measured: &[f64]) -> Measured {
    let samples = measured.iter().enumerate().map(|(k, value)| Sample {
        moment: k as u32,
        quantity: Quantity::Force,
        value: *value,
        censoring: Censoring::Seen,
    });
    Measured {
        name: name.into(),
        protocol: "slow press".into(),
        indenter: "plate".into(),
        site: "pad".into(),
        moments: ramp_and_hold(measured.len()),
        samples: samples.collect(),
        mat: None,
        scan: None,
        is_calibrated: true,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: Vec::new(),
    }
}

/// Force of a hyperelastic pad: grows faster than its depth.
pub fn pad_force(depth_mm: f64) -> f64 {
    0.6 * depth_mm.max(0.0).powf(1.5) * (0.25 * depth_mm).exp()
}

/// A flat mat of `rows` by `columns` sensels of `pitch` mm that looks along +z, its first sensel at the origin.
pub fn flat_mat(rows: u32, columns: u32, pitch: f64) -> Mat {
    let places: Vec<[u32; 2]> = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| [row, column]))
        .collect();
    let center = |[row, column]: &[u32; 2]| {
        Vec3::new(f64::from(*column) * pitch, f64::from(*row) * pitch, 0.0)
    };
    Mat {
        centers: places.iter().map(center).collect(),
        normals: vec![Vec3::z(); places.len()],
        areas: vec![pitch * pitch; places.len()],
        places: places.into_iter().map(Some).collect(),
    }
}

/// A recording of frames of a mat, one moment each second; a reading of 0 stands for less than `threshold`.
pub fn map(name: &str, mat: &Mat, frames: &[Vec<f64>], threshold: f64) -> Measured {
    let count = frames.len();
    let mut samples = Vec::new();
    for (moment, frame) in frames.iter().enumerate() {
        for (sensel, value) in frame
            .iter()
            .enumerate()
            .filter(|(_, value)| !value.is_nan())
        {
            let is_below = *value == 0.0 && threshold > 0.0;
            samples.push(Sample {
                moment: moment as u32,
                quantity: Quantity::Pressure(sensel as u32),
                value: if is_below { threshold } else { *value },
                censoring: if is_below {
                    Censoring::AtMost
                } else {
                    Censoring::Seen
                },
            });
        }
    }
    let mut moments = ramp_and_hold(count.max(2));
    moments.truncate(count);
    Measured {
        samples,
        moments,
        mat: Some(mat.clone()),
        ..indentation(name, &[])
    }
}

/// A fit of recordings with their simulations and one noise for all, in which `absorbed` columns were taken out.
///
/// What is projected is `P r / sigma`.
pub fn fit_of(recordings: Vec<(Measured, Vec<f64>)>, sigma: f64, absorbed: DMatrix<f64>) -> Fit {
    let mut whitened = Vec::new();
    for (measured, simulated) in &recordings {
        for (sample, simulated) in measured.samples.iter().zip(simulated) {
            let left = match sample.censoring {
                Censoring::AtMost if *simulated <= sample.value => 0.0,
                Censoring::AtLeast if *simulated >= sample.value => 0.0,
                _ => sample.value - simulated,
            };
            whitened.push(left / sigma);
        }
    }
    let rows = whitened.len();
    let whitened = nalgebra::DVector::from_vec(whitened);
    let absorbed = if absorbed.nrows() == rows {
        absorbed
    } else {
        DMatrix::zeros(rows, 0)
    };
    let left = &whitened - &absorbed * (absorbed.transpose() * &whitened);
    let (mut projected, mut start) = (Vec::new(), 0);
    for (measured, _) in &recordings {
        let count = measured.samples.len();
        projected.push(left.as_slice()[start..start + count].to_vec());
        start += count;
    }
    let (measured, simulated): (Vec<_>, Vec<_>) = recordings.into_iter().unzip();
    let before = simulated
        .iter()
        .map(|values| values.iter().map(|value| 0.8 * value).collect());
    Fit {
        before: before.collect(),
        sigma: measured
            .iter()
            .map(|one| vec![sigma; one.samples.len()])
            .collect(),
        measured,
        simulated,
        projected,
        absorbed,
        estimates: Vec::new(),
        lack_of_fit_p: None,
        notes: Vec::new(),
    }
}

/// An estimate of a modulus.
pub fn modulus(name: &str, value: f64) -> Estimate {
    Estimate {
        name: name.into(),
        target: Target::Region("pad".into()),
        start: 0.005,
        value,
        low: 0.9 * value,
        high: 1.12 * value,
        bounds: (0.001, 0.2),
        is_at_bound: false,
    }
}

/// The comparison of a fit with a skin of nine vertices around the origin.
pub fn compared(fit: &Fit) -> Comparison {
    let skin: Vec<Vec3> = (0..9)
        .map(|k| Vec3::new(f64::from(k % 3) * 5.0, f64::from(k / 3) * 5.0, 0.5))
        .collect();
    compare_fit(&Compared {
        title: "Index fingertip, subject 3",
        skin: &skin,
        sites: &[("pad".into(), Vec3::zeros())],
        fit,
        location: None,
        prints: &[],
    })
}
