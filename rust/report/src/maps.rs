//! Frames of a mat and scans: measured, simulated and residual side by side, sensels true to their pitch.

use nalgebra::{Matrix3, Vector3};

use crate::colors::{diverging, viridis};
use crate::svg::{Anchor, Svg, Type};
use crate::ticks::{round_up, ticks};
use thenar_comparison::Frame;
use thenar_comparison::Scanned;
use thenar_inference::observe::measured::Mat;

/// Largest width and height of one map, px.
const PANEL: [f64; 2] = [262.0, 300.0];
const TOP: f64 = 34.0;
const GAP: f64 = 18.0;
/// Width of a color scale with its numbers, px.
const SCALE: f64 = 62.0;
const EMPTY: &str = "#f1f3f5";
const OUTLINE: &str = "stroke='#111' stroke-width='1.3' stroke-linecap='square'";

/// Where the sensels of a mat are drawn.
struct Layout {
    /// Corner and size of each, px.
    cells: Vec<[f64; 4]>,
    size: [f64; 2],
    /// px per mm.
    scale: f64,
}

/// Left edge, title, values and their color.
type Panel<'a> = (f64, &'a str, &'a [f64], &'a dyn Fn(f64) -> String);

/// A disc to be marked on the residual.
pub struct Mark {
    /// Center, mm.
    pub center: Vector3<f64>,
    /// mm.
    pub radius: f64,
}

/// One frame; `unit` is that of the values.
pub fn frame(mat: &Mat, (frame, marks): (&Frame, &[Mark]), unit: &str, label: &str) -> String {
    let layout = layout(mat);
    let top = round_up(
        frame
            .measured
            .iter()
            .chain(&frame.simulated)
            .copied()
            .fold(0.0, f64::max),
    );
    let most = round_up(
        frame
            .residual
            .iter()
            .map(|value| value.abs())
            .fold(0.0, f64::max),
    );
    let pressure = |value: f64| {
        if value > 0.0 {
            viridis(value / top)
        } else {
            EMPTY.into()
        }
    };
    let residual = |value: f64| diverging(value / most);
    let to_share = |share: f64| diverging(2.0 * share - 1.0);
    let mut svg = triptych(
        &layout,
        [&frame.measured, &frame.simulated, &frame.residual],
        [
            Look {
                of_value: &pressure,
                ends: [0.0, top],
                of_share: &viridis,
            },
            Look {
                of_value: &residual,
                ends: [-most, most],
                of_share: &to_share,
            },
        ],
        (unit, label),
    );
    let width = layout.size[0];
    for left in [0.0, width + GAP, third(width)] {
        outline(&mut svg, mat, &layout, (left, &frame.measured));
    }
    for mark in marks {
        ring(&mut svg, mat, &layout, (third(width), mark));
    }
    svg.finish()
}

/// A scan: heights measured and simulated on one diverging scale, and their difference on its own.
pub fn scan(scan: &Scanned, label: &str) -> String {
    let seen = Mat {
        centers: scan.places.clone(),
        normals: scan.normals.clone(),
        areas: vec![scan.spacing * scan.spacing; scan.places.len()],
        places: vec![None; scan.places.len()],
    };
    let largest = |lists: &[&Vec<f64>]| {
        let all = lists.iter().flat_map(|list| list.iter());
        round_up(all.fold(0.0, |most, value| f64::max(most, value.abs())))
    };
    let (top, most) = (
        largest(&[&scan.measured, &scan.simulated]),
        largest(&[&scan.residual]),
    );
    let height = |value: f64| diverging(value / top);
    let residual = |value: f64| diverging(value / most);
    let to_share = |share: f64| diverging(2.0 * share - 1.0);
    let svg = triptych(
        &layout(&seen),
        [&scan.measured, &scan.simulated, &scan.residual],
        [
            Look {
                of_value: &height,
                ends: [-top, top],
                of_share: &to_share,
            },
            Look {
                of_value: &residual,
                ends: [-most, most],
                of_share: &to_share,
            },
        ],
        ("mm", label),
    );
    svg.finish()
}

/// Left edge of the third of three maps of a width.
fn third(width: f64) -> f64 {
    2.0 * width + GAP + SCALE + GAP
}

/// How values are colored.
struct Look<'a> {
    /// Color of a value.
    of_value: &'a dyn Fn(f64) -> String,
    /// Lowest and highest value of the scale.
    ends: [f64; 2],
    /// Color of a share of the scale.
    of_share: &'a dyn Fn(f64) -> String,
}

/// Measured, simulated and residual side by side, the first two in one look.
fn triptych(
    layout: &Layout,
    values: [&[f64]; 3],
    [both, left_over]: [Look<'_>; 2],
    (unit, label): (&str, &str),
) -> Svg {
    let [width, height] = layout.size;
    let third = third(width);
    let mut svg = Svg::new(third + width + SCALE, TOP + height.max(120.0) + 34.0, label);
    let panels: [Panel; 3] = [
        (0.0, "Measured", values[0], both.of_value),
        (width + GAP, "Simulated", values[1], both.of_value),
        (
            third,
            "Measured \u{2212} simulated",
            values[2],
            left_over.of_value,
        ),
    ];
    for (left, title, values, color) in panels {
        svg.text([left, TOP - 10.0], Anchor::Start, Type::Title, title);
        for (cell, value) in layout
            .cells
            .iter()
            .zip(values)
            .filter(|(_, value)| !value.is_nan())
        {
            let corner = [left + cell[0], TOP + cell[1]];
            svg.rect(corner, [cell[2], cell[3]], &color(*value));
        }
        svg.frame([left, TOP], layout.size, "#c3cad0");
    }
    let first = [2.0 * width + GAP + 10.0, height];
    scale(&mut svg, first, &both, unit);
    let second = [third + width + 10.0, height];
    scale(&mut svg, second, &left_over, unit);
    ruler(&mut svg, layout);
    svg
}

/// A ring around the sensel next to a mark.
fn ring(svg: &mut Svg, mat: &Mat, layout: &Layout, (left, mark): (f64, &Mark)) {
    let apart = |k: &usize| (mat.centers[*k] - mark.center).norm();
    let nearest = (0..mat.centers.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
    if let Some([x, y, width, height]) = nearest.map(|k| layout.cells[k]) {
        let center = [left + x + width / 2.0, TOP + y + height / 2.0];
        svg.ring(center, mark.radius * layout.scale, "#111");
    }
}

/// The edge of what the mat read, where its sensels are numbered.
fn outline(svg: &mut Svg, mat: &Mat, layout: &Layout, (left, measured): (f64, &[f64])) {
    let numbered = (0..measured.len()).filter_map(|k| Some((mat.places[k]?, k)));
    let places: std::collections::BTreeMap<[u32; 2], usize> = numbered.collect();
    let touches = |row: Option<u32>, column: Option<u32>| {
        let place = row.zip(column).map(|(row, column)| [row, column]);
        place
            .and_then(|place| places.get(&place))
            .is_some_and(|k| measured[*k] > 0.0)
    };
    for ([row, column], k) in &places {
        let [x, y, width, height] = layout.cells[*k];
        let (x, y) = (left + x, TOP + y);
        let [a, b, c, d] = [
            [x, y],
            [x + width, y],
            [x + width, y + height],
            [x, y + height],
        ];
        let sides = [
            (touches(row.checked_sub(1), Some(*column)), a, b),
            (touches(Some(*row), Some(column + 1)), b, c),
            (touches(Some(row + 1), Some(*column)), d, c),
            (touches(Some(*row), column.checked_sub(1)), a, d),
        ];
        for (beside, from, to) in sides {
            if measured[*k] > 0.0 && !beside {
                svg.line(from, to, OUTLINE);
            }
        }
    }
}

/// A color scale with its numbers; `at` is its left edge and height.
fn scale(svg: &mut Svg, at: [f64; 2], look: &Look<'_>, unit: &str) {
    let [low, high] = look.ends;
    const STEPS: usize = 60;
    let ([left, height], width) = (at, 12.0);
    let height = height.max(90.0);
    let step = height / STEPS as f64;
    for k in 0..STEPS {
        let y = TOP + height - (k + 1) as f64 * step;
        svg.rect(
            [left, y],
            [width, step + 0.4],
            &(look.of_share)((k as f64 + 0.5) / STEPS as f64),
        );
    }
    for (value, text) in ticks(low, high, 5) {
        let y = TOP + height * (1.0 - (value - low) / (high - low));
        svg.text(
            [left + width + 5.0, y + 3.5],
            Anchor::Start,
            Type::Tick,
            &text,
        );
    }
    svg.text([left, TOP - 10.0], Anchor::Start, Type::Tick, unit);
}

/// Ten or a hundred millimeters.
fn ruler(svg: &mut Svg, layout: &Layout) {
    let long = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
    let fits = |length: &&f64| **length * layout.scale <= 0.6 * layout.size[0];
    let Some(length) = long.iter().rev().find(fits) else {
        return;
    };
    let (y, end) = (TOP + layout.size[1] + 12.0, length * layout.scale);
    svg.line([0.0, y], [end, y], "stroke='#444' stroke-width='2'");
    svg.text(
        [end + 6.0, y + 4.0],
        Anchor::Start,
        Type::Tick,
        &format!("{length} mm"),
    );
}

fn layout(mat: &Mat) -> Layout {
    let flat = match numbered(mat) {
        Some(flat) => flat,
        None => seen_from_above(mat),
    };
    let low = |axis: usize| {
        flat.iter()
            .map(|cell| cell[axis])
            .fold(f64::INFINITY, f64::min)
    };
    let high = |axis: usize| {
        let ends = flat.iter().map(|cell| cell[axis] + cell[axis + 2]);
        ends.fold(f64::NEG_INFINITY, f64::max)
    };
    let (x, y) = (low(0), low(1));
    let extent = [(high(0) - x).max(1e-9), (high(1) - y).max(1e-9)];
    let scale = (PANEL[0] / extent[0]).min(PANEL[1] / extent[1]);
    let place = |cell: &[f64; 4]| {
        // A hairline between sensels, so that they can be told apart.
        let gap = (0.04 * cell[2] * scale).min(0.8);
        let size = [cell[2] * scale - gap, cell[3] * scale - gap];
        [
            (cell[0] - x) * scale,
            (cell[1] - y) * scale,
            size[0],
            size[1],
        ]
    };
    Layout {
        cells: flat.iter().map(place).collect(),
        size: extent.map(|length| length * scale),
        scale,
    }
}

/// Cells of the flat mat by row and column, mm; None if a sensel has no number.
fn numbered(mat: &Mat) -> Option<Vec<[f64; 4]>> {
    let places: Vec<[u32; 2]> = mat.places.iter().copied().collect::<Option<_>>()?;
    let order: std::collections::BTreeMap<[u32; 2], usize> = places
        .iter()
        .enumerate()
        .map(|(k, place)| (*place, k))
        .collect();
    let pitch = |step: [u32; 2]| {
        let next = |k: usize| {
            order
                .get(&[places[k][0] + step[0], places[k][1] + step[1]])
                .copied()
        };
        let pairs = (0..places.len()).filter_map(|k| Some((k, next(k)?)));
        let mut apart: Vec<f64> = pairs
            .map(|(k, next)| (mat.centers[next] - mat.centers[k]).norm())
            .collect();
        apart.sort_by(f64::total_cmp);
        apart
            .get(apart.len() / 2)
            .copied()
            .filter(|pitch| *pitch > 0.0)
    };
    let side = mat.areas.first().map_or(1.0, |area| area.sqrt());
    let columns = pitch([0, 1]).unwrap_or(side);
    let rows = pitch([1, 0]).unwrap_or(side);
    let cell = |[row, column]: &[u32; 2]| {
        [
            f64::from(*column) * columns,
            f64::from(*row) * rows,
            columns,
            rows,
        ]
    };
    Some(places.iter().map(cell).collect())
}

/// Squares of the sensels' areas where their centers lie as seen along the mean normal, mm.
fn seen_from_above(mat: &Mat) -> Vec<[f64; 4]> {
    let count = mat.centers.len().max(1) as f64;
    let mean = mat.centers.iter().sum::<Vector3<f64>>() / count;
    let spread = mat.centers.iter().fold(Matrix3::zeros(), |sum, center| {
        let apart = center - mean;
        sum + apart * apart.transpose()
    });
    let eigen = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let axis = |k: usize| eigen.eigenvectors.column(order[k]).into_owned();
    let (across, along) = (axis(1), axis(0));
    let cell = |(center, area): (&Vector3<f64>, &f64)| {
        let (side, apart) = (area.max(0.0).sqrt(), center - mean);
        [
            apart.dot(&across) - side / 2.0,
            apart.dot(&along) - side / 2.0,
            side,
            side,
        ]
    };
    mat.centers.iter().zip(&mat.areas).map(cell).collect()
}
