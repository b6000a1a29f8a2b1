//! Measured points and simulated line over depth or time, with the residual below.

use crate::axes::{Axes, Titles, range, symmetric};
use crate::colors::{BEFORE, MEASURED, PHASES, SIMULATED};
use crate::svg::{Anchor, Svg, Type};
use thenar_comparison::{RecordingComparison, Series};

/// Most points of a curve that are drawn.
const MOST: usize = 1500;
const WIDTH: f64 = 470.0;
const LEFT: f64 = 58.0;
const INNER: f64 = WIDTH - LEFT - 12.0;

/// What stands on the axis below.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Against {
    Time,
    Depth,
}

/// A quantity against depth or time; None where that is not known, or does not change.
pub fn curve(recording: &RecordingComparison, series: &Series, against: Against) -> Option<String> {
    let at = |k: usize| {
        let moment = &recording.moments[series.moments[k] as usize];
        match against {
            Against::Time => moment.time_s,
            Against::Depth => moment.depth_mm,
        }
    };
    let step = series.moments.len().div_ceil(MOST).max(1);
    let shown: Vec<usize> = (0..series.moments.len()).step_by(step).collect();
    let x = range(shown.iter().map(|k| at(*k)));
    let is_flat = shown.len() < 3 || shown.iter().all(|k| at(*k).is_nan()) || x[1] <= x[0];
    if is_flat {
        return None;
    }
    let title = match against {
        Against::Time => "Time, s",
        Against::Depth => "Depth, mm",
    };
    let label = format!("{} of {} against {title}", series.label, recording.name);
    let mut svg = Svg::new(WIDTH, 400.0, &label);
    let drawn = Drawn {
        recording,
        series,
        shown: &shown,
        x,
        at: &at,
    };
    draw_values(&mut svg, &drawn);
    draw_residual(&mut svg, &drawn, title);
    Some(svg.finish())
}

/// What of a recording is drawn: some moments of one quantity, against depth or time.
struct Drawn<'a> {
    recording: &'a RecordingComparison,
    series: &'a Series,
    shown: &'a [usize],
    x: [f64; 2],
    at: &'a dyn Fn(usize) -> f64,
}

fn draw_values(svg: &mut Svg, drawn: &Drawn<'_>) {
    let Drawn {
        series,
        shown,
        x,
        at,
        ..
    } = *drawn;
    let all = shown
        .iter()
        .flat_map(|k| [series.measured[*k], series.simulated[*k], series.before[*k]]);
    let axes = Axes::new([LEFT, 30.0], [INNER, 205.0], x, range(all));
    let title = format!("{}, {}", series.label, series.unit);
    axes.draw(
        svg,
        Titles {
            x: "",
            y: &title,
            has_x_numbers: false,
        },
    );
    let points = |values: &[f64]| -> Vec<[f64; 2]> {
        shown.iter().map(|k| axes.at(at(*k), values[*k])).collect()
    };
    svg.polyline(
        &points(&series.before),
        &format!("stroke='{BEFORE}' stroke-width='1.4' stroke-dasharray='5 4'"),
    );
    svg.dots(&points(&series.measured), dot(shown.len()), MEASURED);
    svg.polyline(
        &points(&series.simulated),
        &format!("stroke='{SIMULATED}' stroke-width='2' stroke-linejoin='round'"),
    );
    legend(svg);
}

/// Radius of a dot among so many, px.
fn dot(count: usize) -> f64 {
    match count {
        0..=60 => 2.8,
        61..=300 => 2.0,
        _ => 1.3,
    }
}

fn legend(svg: &mut Svg) {
    let y = 14.0;
    svg.dots(&[[LEFT + 6.0, y]], 2.4, MEASURED);
    svg.text(
        [LEFT + 14.0, y + 4.0],
        Anchor::Start,
        Type::Legend,
        "measured",
    );
    let line = |color: &str, more: &str| format!("stroke='{color}' stroke-width='2' {more}");
    svg.line([LEFT + 82.0, y], [LEFT + 104.0, y], &line(SIMULATED, ""));
    svg.text(
        [LEFT + 110.0, y + 4.0],
        Anchor::Start,
        Type::Legend,
        "simulated, fitted",
    );
    let dashes = "stroke-dasharray='5 4'";
    svg.line([LEFT + 218.0, y], [LEFT + 240.0, y], &line(BEFORE, dashes));
    svg.text(
        [LEFT + 246.0, y + 4.0],
        Anchor::Start,
        Type::Legend,
        "simulated, at the start",
    );
}

fn draw_residual(svg: &mut Svg, drawn: &Drawn<'_>, title: &str) {
    let Drawn {
        recording,
        series,
        shown,
        x,
        at,
    } = *drawn;
    let has_noise = series.sigma.iter().all(|sigma| *sigma > 0.0);
    let left = |k: usize| {
        let left = series.measured[k] - series.simulated[k];
        if has_noise {
            left / series.sigma[k]
        } else {
            left
        }
    };
    let values = shown.iter().map(|k| left(*k));
    let least = if has_noise { 3.0 } else { 0.0 };
    let y = symmetric(values.chain([least]));
    let axes = Axes::new([LEFT, 250.0], [INNER, 92.0], x, y);
    if has_noise {
        axes.band(svg, -2.0, 2.0, "#e8eef3");
    }
    let unit = if has_noise { "\u{03c3}" } else { series.unit };
    let y_title = format!("Residual, {unit}");
    axes.draw(
        svg,
        Titles {
            x: title,
            y: &y_title,
            has_x_numbers: true,
        },
    );
    let phase = |k: usize| recording.moments[series.moments[k] as usize].phase as usize;
    let mut present = [false; 5];
    for (number, color) in PHASES.iter().enumerate() {
        let of_phase = shown.iter().filter(|k| phase(**k) == number);
        let points: Vec<[f64; 2]> = of_phase.map(|k| axes.at(at(*k), left(*k))).collect();
        present[number] = !points.is_empty();
        svg.dots(&points, dot(shown.len()), color);
    }
    phases(svg, present);
}

/// Which color is which part of the protocol.
fn phases(svg: &mut Svg, present: [bool; 5]) {
    const NAMES: [&str; 5] = ["apart", "load", "hold", "unload", "slide"];
    let mut x = LEFT + 4.0;
    for number in (0..5).filter(|number| present[*number]) {
        svg.dots(&[[x, 391.0]], 3.0, PHASES[number]);
        svg.text([x + 8.0, 395.0], Anchor::Start, Type::Legend, NAMES[number]);
        x += 62.0;
    }
}
