//! Fits made up without any simulation: a mat and a force curve pressed by a paraboloid, noise, nuisances, and planted patches.

use nalgebra::{DMatrix, DVector, Vector3};
use thenar_inference::{Censoring, Fit, Mat, Measured, Moment, Phase, Quantity, Sample};

/// Generator of the tests, of another kind than the library's (xorshift64*, and the sum of twelve uniforms refined by Box-Muller).
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Noise {
        Noise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// Which recordings to make up.
#[derive(Clone)]
pub struct Design {
    pub rows: u32,
    pub columns: u32,
    /// Where the mat's corner lies in each recording, mm; one repeat each.
    pub corners: Vec<[f64; 2]>,
    /// Depths of the loading frames; as many frames of holding follow.
    pub depths: Vec<f64>,
    /// Noise of a sensel, kPa.
    pub sigma: f64,
    /// Add a force curve that goes with each mat.
    pub curve: bool,
}

pub const PITCH: f64 = 5.0;

impl Design {
    pub fn flat(side: u32) -> Design {
        Design {
            rows: side,
            columns: side,
            corners: vec![[0.0, 0.0]; 2],
            depths: vec![0.5, 1.0, 1.5, 2.0],
            sigma: 0.4,
            curve: true,
        }
    }

    pub fn center(&self, corner: [f64; 2], sensel: u32) -> Vector3<f64> {
        let (row, column) = (sensel / self.columns, sensel % self.columns);
        let half = |count: u32| 0.5 * (f64::from(count) - 1.0);
        Vector3::new(
            corner[0] + (f64::from(column) - half(self.columns)) * PITCH,
            corner[1] + (f64::from(row) - half(self.rows)) * PITCH,
            0.0,
        )
    }

    fn moments(&self) -> Vec<Moment> {
        let deepest = self.depths[self.depths.len() - 1];
        let hold = vec![deepest; self.depths.len()];
        let depths = self.depths.iter().chain(&hold);
        let moment = |(at, depth): (usize, &f64)| Moment {
            time_s: 0.2 * at as f64,
            depth_mm: *depth,
            demand_n: f64::NAN,
            slide_mm: Vector3::zeros(),
            rate_mm_s: if at < self.depths.len() { 2.5 } else { 0.0 },
            phase: if at < self.depths.len() {
                Phase::Load
            } else {
                Phase::Hold
            },
            cycle: 0,
            readings: 1,
            depth_spread_mm: 0.0,
            force_step_n: 0.0,
        };
        depths.enumerate().map(moment).collect()
    }

    /// Recordings with the pressure of a paraboloid of radius 12 sqrt(depth / 2) mm as simulation, and no residual.
    pub fn simulated(&self) -> (Vec<Measured>, Vec<Vec<f64>>) {
        let moments = self.moments();
        let mut measured = Vec::new();
        let mut simulated = Vec::new();
        for (at, corner) in self.corners.iter().enumerate() {
            let count = self.rows * self.columns;
            let centers: Vec<_> = (0..count)
                .map(|sensel| self.center(*corner, sensel))
                .collect();
            let mut samples = Vec::new();
            let mut values = Vec::new();
            for (frame, moment) in moments.iter().enumerate() {
                for sensel in 0..count {
                    let square = centers[sensel as usize].norm_squared() / (72.0 * moment.depth_mm);
                    let value = 15.0 * moment.depth_mm * (1.0 - square).max(0.0).sqrt();
                    samples.push(sample(frame, Quantity::Pressure(sensel), value));
                    values.push(value);
                }
            }
            let mat = Mat {
                normals: vec![Vector3::z(); count as usize],
                areas: vec![PITCH * PITCH; count as usize],
                places: (0..count)
                    .map(|s| Some([s / self.columns, s % self.columns]))
                    .collect(),
                centers,
            };
            measured.push(recording(format!("mat {at}"), &moments, samples, Some(mat)));
            simulated.push(values);
            if self.curve {
                let force: Vec<f64> = moments.iter().map(|m| 3.0 * m.depth_mm.powf(1.5)).collect();
                let list = force.iter().enumerate();
                let samples = list.map(|(i, f)| sample(i, Quantity::Force, *f)).collect();
                measured.push(recording(format!("curve {at}"), &moments, samples, None));
                simulated.push(force);
            }
        }
        (measured, simulated)
    }

    fn sigma_of(&self, quantity: Quantity) -> f64 {
        if quantity == Quantity::Force {
            0.05
        } else {
            self.sigma
        }
    }

    /// A fit to noise of this design and to what `planted` adds to each sample (recording, moment, center of its sensel, simulated value):
    /// a gain over all, and a shift of the mat, are taken out as parameters would.
    pub fn fit(&self, noise: &mut Noise, planted: &Planted<'_>) -> Fit {
        let (measured, simulated) = self.simulated();
        let mut residuals: Vec<Vec<f64>> = Vec::new();
        for (which, (one, values)) in measured.iter().zip(&simulated).enumerate() {
            let added = one.samples.iter().zip(values).map(|(sample, value)| {
                let moment = &one.moments[sample.moment as usize];
                let center = match (sample.quantity, &one.mat) {
                    (Quantity::Pressure(sensel), Some(mat)) => Some(mat.centers[sensel as usize]),
                    _ => None,
                };
                planted(which, moment, center, *value)
                    + self.sigma_of(sample.quantity) * noise.normal()
            });
            residuals.push(added.collect());
        }
        self.project(measured, simulated, residuals)
    }

    /// Takes out what a gain and a shift of every mat absorb.
    pub fn project(
        &self,
        mut measured: Vec<Measured>,
        simulated: Vec<Vec<f64>>,
        residuals: Vec<Vec<f64>>,
    ) -> Fit {
        let sigma: Vec<Vec<f64>> = measured
            .iter()
            .map(|one| {
                one.samples
                    .iter()
                    .map(|s| self.sigma_of(s.quantity))
                    .collect()
            })
            .collect();
        let count = simulated.iter().map(Vec::len).sum();
        let mut columns = DMatrix::zeros(count, 3);
        let mut whitened = DVector::zeros(count);
        let mut row = 0;
        for (which, one) in measured.iter_mut().enumerate() {
            for (at, sample) in one.samples.iter_mut().enumerate() {
                let value = simulated[which][at];
                sample.value = value + residuals[which][at];
                columns[(row, 0)] = value / sigma[which][at];
                if let (Quantity::Pressure(sensel), Some(mat)) = (sample.quantity, &one.mat) {
                    let center = mat.centers[sensel as usize];
                    columns[(row, 1)] = value * center.x / sigma[which][at];
                    columns[(row, 2)] = value * center.y / sigma[which][at];
                }
                whitened[row] = residuals[which][at] / sigma[which][at];
                row += 1;
            }
        }
        let absorbed = columns.qr().q();
        let left = &whitened - &absorbed * (absorbed.transpose() * &whitened);
        let mut rest = left.iter().copied();
        let projected = simulated
            .iter()
            .map(|one| rest.by_ref().take(one.len()).collect())
            .collect();
        Fit {
            before: simulated.clone(),
            measured,
            simulated,
            sigma,
            projected,
            absorbed,
            estimates: Vec::new(),
            lack_of_fit_p: None,
            notes: Vec::new(),
        }
    }
}

/// What is added to a sample: recording, moment, center of its sensel, simulated value.
pub type Planted<'a> = dyn Fn(usize, &Moment, Option<Vector3<f64>>, f64) -> f64 + 'a;

/// Nothing.
pub fn nothing(_: usize, _: &Moment, _: Option<Vector3<f64>>, _: f64) -> f64 {
    0.0
}

fn sample(moment: usize, quantity: Quantity, value: f64) -> Sample {
    Sample {
        moment: moment as u32,
        quantity,
        value,
        censoring: Censoring::Seen,
    }
}

fn recording(name: String, moments: &[Moment], samples: Vec<Sample>, mat: Option<Mat>) -> Measured {
    Measured {
        name,
        protocol: if mat.is_some() { "map" } else { "curve" }.to_owned(),
        indenter: "plate".to_owned(),
        site: "pad".to_owned(),
        moments: moments.to_vec(),
        samples,
        mat,
        scan: None,
        is_calibrated: true,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: Vec::new(),
    }
}
