//! Deviation of each repeat from their mean, with gain and first touch, and the zero of the force where it differs, taken out.

use nalgebra::{Matrix3, Vector3};

use crate::noise::deviations::{Deviations, Group, LEAST_SAMPLES};
use crate::noise::repeat_alignment::Aligned;

/// The repeats of one group at the same moments, and what gain and first touch do to their mean.
pub(crate) struct AlignedGroup {
    time: Vec<f64>,
    repeats: Vec<Aligned>,
    /// Means over the repeats.
    value: Vec<f64>,
    depth: Vec<f64>,
    /// The measured value's own slope by depth.
    slope: Vec<f64>,
}

impl AlignedGroup {
    pub(crate) fn new((time, repeats): (Vec<f64>, Vec<Aligned>)) -> Option<AlignedGroup> {
        let (n, m) = (time.len(), repeats.len() as f64);
        if n < LEAST_SAMPLES || repeats.iter().any(|r| r.value.len() != n) {
            return None;
        }
        let mean = |list: &dyn Fn(&Aligned) -> &Vec<f64>| -> Vec<f64> {
            (0..n)
                .map(|k| repeats.iter().map(|r| list(r)[k]).sum::<f64>() / m)
                .collect()
        };
        let (value, depth) = (mean(&|r| &r.value), mean(&|r| &r.depth));
        let slope = own_slope(&value, &mean(&|r| &r.simulated), &mean(&|r| &r.slope));
        Some(AlignedGroup {
            time,
            value,
            depth,
            slope,
            repeats,
        })
    }

    /// Deviations with gain and first touch taken out, and with them, where `has_own_zero`, a constant. Not by generalized least squares: these
    /// look at the smallest differences, near first touch, where it does not act as a slope.
    pub(crate) fn deviations(&self, group: &Group, has_own_zero: bool) -> Option<Deviations> {
        let (n, value, slope) = (self.time.len(), &self.value, &self.slope);
        let most = value.iter().fold(0.0, |most, v| f64::max(most, v.abs()));
        if most == 0.0 {
            return None;
        }
        let constant = if has_own_zero { 1.0 } else { 0.0 };
        let along: Vec<Vector3<f64>> = (0..n)
            .map(|k| Vector3::new(value[k], -slope[k], constant))
            .collect();
        let mut gram: Matrix3<f64> = along.iter().map(|a| a * a.transpose()).sum();
        if !has_own_zero {
            gram[(2, 2)] = 1.0;
        }
        let inverse = gram.try_inverse()?;
        let (mut rest, mut whole) = (Vec::new(), Vec::new());
        for repeat in &self.repeats {
            let off: Vec<f64> = (0..n)
                .map(|k| {
                    let moved = repeat.depth[k] - self.depth[k];
                    let moved = if moved.is_finite() { moved } else { 0.0 };
                    repeat.value[k] - value[k] - slope[k] * moved
                })
                .collect();
            let pull: Vector3<f64> = along.iter().zip(&off).map(|(a, o)| a * *o).sum();
            let found = inverse * pull;
            rest.push((0..n).map(|k| off[k] - along[k].dot(&found)).collect());
            whole.push(found);
        }
        Some(Deviations {
            group: group.clone(),
            time: self.time.clone(),
            most,
            load: value.iter().map(|v| v.abs() / most).collect(),
            profile: vec![1.0; n],
            readings: self.repeats[0].readings.clone(),
            rest,
            whole,
            along: along.iter().map(|a| inverse * a).collect(),
            has_own_zero,
        })
    }
}

/// The measured value's own slope by depth: the model's relative slope is nearly that of any skin. Near first touch, where both
/// vanish, the ratio of value and simulation is noise, and says no more than that of the whole.
fn own_slope(value: &[f64], simulated: &[f64], slope: &[f64]) -> Vec<f64> {
    let both = || value.iter().zip(simulated);
    let over: f64 = both().map(|(v, s)| v * s).sum();
    let under: f64 = simulated.iter().map(|s| s * s).sum();
    let scale = over / under.max(f64::MIN_POSITIVE);
    let one = |((v, s), slope): ((&f64, &f64), &f64)| match s.abs() > 0.0 && scale > 0.0 {
        true => slope * (v / s).clamp(0.5 * scale, 2.0 * scale),
        false => 0.0,
    };
    let found = both().zip(slope).map(one);
    found.map(|s| if s.is_finite() { s } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Skin twice as stiff as the model has twice its slope; where a reading near first touch is noise, the whole says no more than
    /// twice or half of that, and where the model bears nothing there is no slope.
    #[test]
    fn own_slope_scales_the_model_slope_by_a_smooth_force_ratio() {
        let simulated = [0.0, 1e-3, 1e-3, 1.0, 2.0, 3.0];
        let value = [0.5, 0.1, -0.1, 2.0, 4.0, 6.0];
        let slope = [1.0, 0.5, 0.5, 1.0, 1.5, 2.0];
        let found = own_slope(&value, &simulated, &slope);
        let wanted = [0.0, 2.0, 0.5, 2.0, 3.0, 4.0];
        for (own, wanted) in found.iter().zip(wanted) {
            assert!((own - wanted).abs() < 1e-3, "{found:?}");
        }
    }
}
