//! Laws of the instrument in the surrogate: gain step, offset, drift, saturation, floor (Tobit), delay.

use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::mechanism::Law;
use crate::forward::surrogate::surrogate_data::Surrogate;

/// Width of a floor's edge over the floor, in recordings that are only planned.
const EDGE: f64 = 0.01;

impl Surrogate<'_> {
    /// What the instrument makes of the forces of a recording, by its gain and zero: a cell that was not tared clips at one reading all the same.
    pub(crate) fn read(
        &self,
        model: &Model<'_>,
        set: &Setting,
        (course, forces): (usize, &mut Vec<f64>),
    ) {
        let one = &self.courses[course];
        let (gain, zero) = (libm::exp(set.gain[course]), set.force_zero[course]);
        forces.iter_mut().for_each(|f| *f = *f * gain + zero);
        for (number, mechanism) in model.mechanisms.iter().enumerate() {
            if !mechanism.is_instrument() {
                continue;
            }
            let value = set.of[number][0];
            match &mechanism.law {
                Law::GainStep { from } if one.order >= *from => {
                    forces.iter_mut().for_each(|f| *f *= libm::exp(value));
                }
                Law::Offset => forces.iter_mut().for_each(|f| *f += value),
                Law::Drift { time_s } => {
                    let start = one.rows[0].time_s;
                    for (force, row) in forces.iter_mut().zip(&one.rows) {
                        *force += value * libm::log1p((row.time_s - start) / time_s);
                    }
                }
                Law::Saturation(stage) => {
                    let ceiling = stage.reads(self.most.0 * libm::exp(value), gain);
                    for force in forces.iter_mut() {
                        *force = ceiling - soft(ceiling - *force, 0.02 * ceiling);
                    }
                }
                Law::Floor(stage) => {
                    let floor = stage.reads(value * self.least_peak, gain);
                    for (force, row) in forces.iter_mut().zip(&one.rows) {
                        *force = tobit_reading(floor, *force, row.force_n);
                    }
                }
                Law::Delay => {
                    let times: Vec<f64> = one.rows.iter().map(|row| row.time_s).collect();
                    let meant: Vec<f64> = times.iter().map(|t| t - value).collect();
                    *forces = crate::interpolation::linear(&times, forces, &meant);
                }
                _ => {}
            }
        }
    }
}

/// What is read of a force by an instrument that is blind below a floor, where something (or nothing) was read.
///
/// Of a force beside the floor nobody knows on which side it is, and to read nothing where all of it was meant would weigh as hundreds of
/// other readings. So a reading is held against the force that is lacking (as Tobin 1958, Econometrica 26:24, has it of what is censored):
/// what ought not to have been seen counts as that far from it, and of what ought to have been seen only what lies beyond the floor is
/// missing. Where nothing is recorded yet the floor is an edge of [`EDGE`].
fn tobit_reading(floor: f64, force: f64, reading: f64) -> f64 {
    let over = force - floor;
    match reading {
        _ if floor <= 0.0 => force,
        _ if reading.is_nan() => {
            force / (1.0 + libm::exp((-over / (EDGE * floor)).clamp(-40.0, 40.0)))
        }
        _ if reading > 0.5 * floor => force - (-over).clamp(0.0, force.max(0.0)),
        _ => over.clamp(0.0, force.max(0.0)),
    }
}

/// A value below `x` and below none: `x` for large x, 0 for small, smooth over `width`.
fn soft(x: f64, width: f64) -> f64 {
    let y = x / width;
    if y > 30.0 {
        x
    } else {
        width * libm::log1p(libm::exp(y.max(-700.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tobit_reading_equals_missing_force_at_a_floor() {
        // Read above it, read 0.25 N below it, slipped through far below it; a pull.
        for (force, wanted) in [(12.0, 12.0), (7.75, 7.5), (3.0, 0.0), (-1.0, -1.0)] {
            assert!(
                (tobit_reading(8.0, force, 8.2) - wanted).abs() < 1e-12,
                "{force}"
            );
        }
        // Not read, though 0.4 N beyond, or far more; noise is no reading.
        for (force, wanted) in [(7.0, 0.0), (8.4, 0.4), (20.0, 12.0), (-1.0, 0.0)] {
            for noise in [0.0, 3.9, -0.5] {
                let told = tobit_reading(8.0, force, noise);
                assert!((told - wanted).abs() < 1e-12, "{force} {noise}");
            }
        }
        // Planned: all of it or nothing, and a floor of nothing takes nothing.
        assert!(
            tobit_reading(8.0, 7.0, f64::NAN) < 0.01 && tobit_reading(8.0, 9.0, f64::NAN) > 8.99
        );
        assert!(
            [f64::NAN, 0.0]
                .iter()
                .all(|read| tobit_reading(0.0, 0.0, *read) == 0.0)
        );
    }
}
