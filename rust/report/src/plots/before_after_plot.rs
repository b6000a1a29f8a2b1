//! Plot of a recording: force over time before and after the finding, and the residual below.

use crate::axes::{Axes, Titles, range, symmetric};
use crate::colors::{BEFORE, MEASURED, SIMULATED};
use crate::svg::{Anchor, Svg, Type};
use thenar_diagnosis::Curve;

const WIDTH: f64 = 470.0;
const LEFT: f64 = 62.0;
const INNER: f64 = WIDTH - LEFT - 12.0;

/// A figure of one recording: dots measured, the line with parameters alone dashed, and the line with what was found.
pub fn plot(curve: &Curve) -> String {
    let less = |values: &[f64]| -> Vec<f64> {
        let both = values.iter().zip(&curve.before_n);
        both.map(|(value, before)| 1e3 * (value - before)).collect()
    };
    let (left, added) = (less(&curve.measured_n), less(&curve.after_n));
    let time = range(curve.time_s.iter().copied());
    let forces = [&curve.measured_n, &curve.before_n, &curve.after_n];
    let force = range(forces.into_iter().flatten().copied());
    let mut svg = Svg::new(WIDTH, 376.0, &curve.recording);
    svg.text([LEFT, 16.0], Anchor::Start, Type::Title, &curve.recording);
    let above = Axes::new([LEFT, 28.0], [INNER, 170.0], time, force);
    let titles = Titles {
        y: "Force, N",
        ..Titles::default()
    };
    above.draw(&mut svg, titles);
    let both = [(&curve.before_n, before()), (&curve.after_n, after())];
    draw((&mut svg, &above, curve), &curve.measured_n, &both);
    let rest = symmetric(left.iter().chain(&added).copied());
    let below = Axes::new([LEFT, 214.0], [INNER, 120.0], time, rest);
    let titles = Titles {
        x: "Time, s",
        y: "Less parameters, mN",
        has_x_numbers: true,
    };
    below.draw(&mut svg, titles);
    draw((&mut svg, &below, curve), &left, &[(&added, after())]);
    format!("<figure>{}</figure>", svg.finish())
}

fn before() -> String {
    format!("stroke='{BEFORE}' stroke-width='1.6' stroke-dasharray='5 4'")
}

fn after() -> String {
    format!("stroke='{SIMULATED}' stroke-width='2' stroke-linejoin='round'")
}

/// Dots and lines of values by time.
fn draw(
    (svg, axes, curve): (&mut Svg, &Axes, &Curve),
    dots: &[f64],
    lines: &[(&Vec<f64>, String)],
) {
    let points = |values: &[f64]| -> Vec<[f64; 2]> {
        let all = curve.time_s.iter().zip(values);
        all.map(|(time, value)| axes.at(*time, *value)).collect()
    };
    svg.dots(&points(dots), 2.0, MEASURED);
    for (values, style) in lines {
        svg.polyline(&points(values), style);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 1 N, 20 mN are left: as large a part of the lower drawing as they are of what is left.
    #[test]
    fn residual_plot_has_its_own_scale() {
        let curve = Curve {
            recording: "slow <1>".to_owned(),
            time_s: vec![0.0, 1.0, 2.0],
            depth_mm: vec![0.0, 1.0, 0.0],
            measured_n: vec![0.0, 1.02, 0.01],
            before_n: vec![0.0, 1.0, 0.0],
            after_n: vec![0.0, 1.02, 0.0],
        };
        let svg = plot(&curve);
        let time = range([0.0, 2.0].into_iter());
        let most = symmetric([20.0].into_iter())[1];
        let below = Axes::new([LEFT, 214.0], [INNER, 120.0], time, [-most, most]);
        let peak = below.at(1.0, 20.0);
        assert!((214.0..230.0).contains(&peak[1]), "near the top: {peak:?}");
        let path = svg
            .rsplit("<path d='M")
            .next()
            .and_then(|p| p.split('\'').next());
        let numbers: Vec<f64> = path
            .unwrap()
            .split(['L', ' '])
            .map(|n| n.parse().unwrap())
            .collect();
        let expected = [below.at(0.0, 0.0), peak, below.at(2.0, 0.0)].concat();
        assert_eq!(numbers.len(), expected.len());
        let is_near = |(n, e): (&f64, &f64)| (n - e).abs() < 0.01;
        assert!(
            numbers.iter().zip(&expected).all(is_near),
            "{numbers:?} {expected:?}"
        );
        assert!(svg.contains("slow &lt;1&gt;") && svg.contains("Less parameters, mN"));
    }
}
