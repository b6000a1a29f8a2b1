//! The fallback solver: modified proportioning with reduced gradient projections (MPRGP, Dostal & Schoeberl 2005); it always ends.

use super::conjugate_gradient::CgLimits;
use super::lcp::Compliance;

/// Minimizes `x A x / 2 + d x` over `x >= 0`, from the feasible part of the `x` given.
///
/// Stops when the free and the chopped gradient are within the tolerance (mm), or after that many products. Returns the steps.
pub fn mprgp<M: Compliance>(matrix: &M, gap: &[f64], x: &mut [f64], limits: CgLimits<'_>) -> usize {
    let CgLimits {
        tolerance,
        steps,
        cancelled,
    } = limits;
    let n = matrix.diagonal().len();
    let step_length = 1.0 / matrix.norm_bound();
    for v in x.iter_mut() {
        *v = v.max(0.0);
    }
    let mut gradient = vec![0.0; n];
    let mut image = vec![0.0; n];
    residual(matrix, gap, x, &mut gradient);
    let mut direction = free_part(x, &gradient);
    for step in 0..steps {
        if step % 16 == 0 && cancelled() {
            return step;
        }
        let free = free_part(x, &gradient);
        let chopped: Vec<f64> = (0..n)
            .map(|i| {
                if x[i] > 0.0 {
                    0.0
                } else {
                    gradient[i].min(0.0)
                }
            })
            .collect();
        if largest(&free).max(largest(&chopped)) <= tolerance {
            return step;
        }
        let reduced: f64 = (0..n)
            .map(|i| free[i] * free[i].min(x[i] / step_length))
            .sum();
        if dot(&chopped, &chopped) > reduced {
            matrix.times(&chopped, &mut image);
            let curvature = dot(&chopped, &image);
            let length = if curvature > 0.0 {
                dot(&gradient, &chopped) / curvature
            } else {
                step_length
            };
            advance(x, &mut gradient, &chopped, &image, length);
            direction = free_part(x, &gradient);
            continue;
        }
        matrix.times(&direction, &mut image);
        let curvature = dot(&direction, &image);
        let wanted = if curvature > 0.0 {
            dot(&gradient, &direction) / curvature
        } else {
            f64::INFINITY
        };
        let room = (0..n)
            .filter(|&i| direction[i] > 0.0)
            .map(|i| x[i] / direction[i])
            .fold(f64::INFINITY, f64::min);
        if wanted <= room {
            advance(x, &mut gradient, &direction, &image, wanted);
            let free = free_part(x, &gradient);
            let beta = dot(&free, &image) / curvature;
            for i in 0..n {
                direction[i] = free[i] - beta * direction[i];
            }
        } else {
            if room.is_finite() {
                advance(x, &mut gradient, &direction, &image, room);
            }
            let free = free_part(x, &gradient);
            for i in 0..n {
                x[i] = (x[i] - step_length * free[i]).max(0.0);
            }
            residual(matrix, gap, x, &mut gradient);
            direction = free_part(x, &gradient);
        }
    }
    steps
}

fn advance(x: &mut [f64], gradient: &mut [f64], direction: &[f64], image: &[f64], length: f64) {
    for i in 0..x.len() {
        x[i] = (x[i] - length * direction[i]).max(0.0);
        gradient[i] -= length * image[i];
    }
}

fn residual<M: Compliance>(matrix: &M, gap: &[f64], x: &[f64], out: &mut [f64]) {
    matrix.times(x, out);
    for (o, d) in out.iter_mut().zip(gap) {
        *o += d;
    }
}

fn free_part(x: &[f64], gradient: &[f64]) -> Vec<f64> {
    x.iter()
        .zip(gradient)
        .map(|(x, g)| if *x > 0.0 { *g } else { 0.0 })
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| f64::max(most, v.abs()))
}
