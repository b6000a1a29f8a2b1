//! Bar plots: mean residual in ranges of a variable, and an estimate with its interval.

use crate::axes::{Axes, Titles, symmetric};
use crate::colors::{BEFORE, QUIET, SIMULATED, STANDS_OUT};
use crate::svg::{Anchor, Svg, Type};
use thenar_comparison::Trend;
use thenar_inference::parameters::estimate::Estimate;

const WIDTH: f64 = 310.0;
const HEIGHT: f64 = 176.0;
const LEFT: f64 = 58.0;

/// Mean residual over the ranges of a variable; bars that stand out of the noise are vermillion.
pub fn trend(trend: &Trend, unit: &str) -> String {
    let label = format!(
        "mean residual of {} against {}",
        trend.kind.label(),
        trend.variable.label()
    );
    let mut svg = Svg::new(WIDTH, HEIGHT, &label);
    let is_counted = trend.bins.iter().all(|bin| !bin.label.is_empty());
    let count = trend.bins.len() as f64;
    let edges = edges(trend);
    let x = match is_counted {
        true => [0.0, count],
        false => [edges[0], edges[edges.len() - 1]],
    };
    let size = [WIDTH - LEFT - 10.0, 104.0];
    let y = symmetric(trend.bins.iter().map(|bin| bin.mean));
    let axes = Axes::new([LEFT, 24.0], size, x, y);
    axes.draw(
        &mut svg,
        Titles {
            x: trend.variable.label(),
            y: unit,
            has_x_numbers: !is_counted,
        },
    );
    for (k, bin) in trend.bins.iter().enumerate() {
        let [low, high] = match is_counted {
            true => [k as f64 + 0.15, k as f64 + 0.85],
            false => [edges[k], edges[k + 1]],
        };
        let color = if bin.stands_out() { STANDS_OUT } else { QUIET };
        let (zero, end) = (axes.at(low, 0.0), axes.at(high, bin.mean));
        let width = (end[0] - zero[0] - 1.0).max(2.0);
        let (top, bottom) = (zero[1].min(end[1]), zero[1].max(end[1]));
        svg.rect(
            [zero[0] + 0.5, top],
            [width, (bottom - top).max(1.0)],
            color,
        );
        if is_counted {
            let middle = [zero[0] + width / 2.0, 24.0 + size[1] + 15.0];
            svg.text(middle, Anchor::Middle, Type::Tick, &bin.label);
        }
    }
    let title = format!("{} residual, mean", trend.kind.label());
    svg.text([LEFT, 15.0], Anchor::Start, Type::Title, &title);
    svg.finish()
}

/// Where one bar ends and the next begins: midway between the values of neighboring ranges.
fn edges(trend: &Trend) -> Vec<f64> {
    let bins = &trend.bins;
    let mut edges: Vec<f64> = bins
        .windows(2)
        .map(|pair| 0.5 * (pair[0].range[1] + pair[1].range[0]))
        .collect();
    let (first, last) = (bins[0].range, bins[bins.len() - 1].range);
    // A range of one value is as wide as it is far from its neighbor.
    let half = |[low, high]: [f64; 2], edge: f64| if high > low { 0.0 } else { (edge - low).abs() };
    edges.insert(0, first[0] - half(first, edges[0]));
    edges.push(last[1] + half(last, edges[edges.len() - 1]));
    edges
}

/// Bounds as a line, interval as a bar, estimate as a tick, start as a ring.
pub fn estimate(estimate: &Estimate) -> String {
    let (width, middle) = (190.0, 9.0);
    let mut svg = Svg::new(width, 18.0, &format!("interval of {}", estimate.name));
    let (low, high) = estimate.bounds;
    let has_bounds = low.is_finite() && high.is_finite() && high > low;
    let (low, high) = match has_bounds {
        true => (low, high),
        false => {
            let values = [estimate.start, estimate.low, estimate.high, estimate.value];
            let finite = || values.into_iter().filter(|value| value.is_finite());
            (
                finite().fold(f64::INFINITY, f64::min),
                finite().fold(f64::NEG_INFINITY, f64::max),
            )
        }
    };
    let is_logarithmic = low > 0.0 && high / low > 20.0;
    let share = |value: f64| match is_logarithmic {
        true => (value.max(low) / low).ln() / (high / low).ln(),
        false => (value - low) / (high - low),
    };
    let at = |value: f64| 5.0 + (width - 10.0) * share(value).clamp(0.0, 1.0);
    svg.line(
        [5.0, middle],
        [width - 5.0, middle],
        "stroke='#c3cad0' stroke-width='1.5'",
    );
    if has_bounds {
        for x in [5.0, width - 5.0] {
            svg.line([x, 4.0], [x, 14.0], "stroke='#c3cad0' stroke-width='1.5'");
        }
    }
    let color = if estimate.is_at_bound {
        STANDS_OUT
    } else {
        SIMULATED
    };
    if estimate.low.is_finite() && estimate.high.is_finite() {
        let (from, to) = (at(estimate.low), at(estimate.high));
        svg.shade([from, middle - 3.0], [(to - from).max(1.5), 6.0], color);
    }
    svg.ring([at(estimate.start), middle], 3.4, BEFORE);
    let x = at(estimate.value);
    svg.line(
        [x, 2.0],
        [x, 16.0],
        &format!("stroke='{color}' stroke-width='2.2'"),
    );
    svg.finish()
}
