//! A handprint: ink and simulated contact over one another, their outlines, and a table by region of the hand.

use std::collections::BTreeMap;

use thenar_recordings::handprint::TOUCHED_FROM;

use crate::colors::{SIMULATED, STANDS_OUT};
use crate::svg::{Anchor, Svg, Type, escaped};
use crate::tables;
use thenar_comparison::Printed;
use thenar_comparison::RecordingComparison;
use thenar_inference::observe::measured::Mat;
use thenar_inference::observe::robust_scale::median;

/// Largest width and height of the picture, px.
const LARGEST: [f64; 2] = [620.0, 560.0];
const TOP: f64 = 30.0;
/// Room for the ruler, px.
const BOTTOM: f64 = 30.0;
const PAPER: &str = "#f4f1ea";
const BOTH: &str = "#8d99a3";
const INK_ALONE: &str = "#e9a27a";
const SIMULATED_ALONE: &str = "#8fc1e3";
const INK_EDGE: &str = "stroke='#111' stroke-width='1.4' stroke-linecap='square'";

/// Picture and table of a print; nothing for other recordings.
pub fn section(recording: &RecordingComparison) -> String {
    let (Some(print), Some(mat)) = (&recording.print, &recording.mat) else {
        return String::new();
    };
    let beside = match print.beside > 0.005 {
        true => format!(
            " {:.0} % of the simulated force presses beside the paper.",
            100.0 * print.beside
        ),
        false => String::new(),
    };
    let caption = format!(
        "The paper as one looks at its inked side, in its fitted pose. Gray: inked and in simulated contact; orange: inked alone; blue: \
         simulated alone. Black outline: ink; blue outline: simulation.{beside}"
    );
    let drawn = picture(mat, print, &format!("{}: {caption}", recording.name));
    let mut html = format!(
        "<figure class='map'>{drawn}<figcaption>{}</figcaption></figure>\n",
        escaped(&caption)
    );
    if !print.regions.is_empty() {
        html += &format!(
            "<h3>By region of the skin</h3>{}",
            tables::print_regions(print)
        );
    }
    html
}

/// Rows and columns of the cells that are known, and what of them is drawn where.
struct Picture<'p> {
    cells: BTreeMap<[u32; 2], usize>,
    print: &'p Printed,
    low: [u32; 2],
    size: [f64; 2],
    side: [f64; 2],
}

impl Picture<'_> {
    /// Upper left corner of a cell, px; rows count upward.
    fn corner(&self, [row, column]: [u32; 2]) -> [f64; 2] {
        [
            f64::from(column - self.low[1]) * self.side[0],
            TOP + self.size[1] - (f64::from(row - self.low[0]) + 1.0) * self.side[1],
        ]
    }

    fn touches(&self, at: Option<[u32; 2]>, shares: &[f64]) -> bool {
        let cell = at.and_then(|at| self.cells.get(&at));
        cell.is_some_and(|cell| shares[*cell] >= TOUCHED_FROM)
    }

    fn color(&self, cell: usize) -> &'static str {
        let inked = self.print.recorded[cell] >= TOUCHED_FROM;
        match (inked, self.print.simulated[cell] >= TOUCHED_FROM) {
            (true, true) => BOTH,
            (true, false) => INK_ALONE,
            (false, true) => SIMULATED_ALONE,
            (false, false) => PAPER,
        }
    }

    /// Rows of like cells as one rectangle each.
    fn fill(&self, svg: &mut Svg) {
        let mut run: Option<([u32; 2], u32, &'static str)> = None;
        let draw = |svg: &mut Svg, run: Option<([u32; 2], u32, &'static str)>| {
            if let Some((first, count, color)) = run {
                let size = [f64::from(count) * self.side[0] + 0.2, self.side[1] + 0.2];
                svg.rect(self.corner(first), size, color);
            }
        };
        for (place, cell) in &self.cells {
            let color = self.color(*cell);
            run = match run {
                Some((first, count, same))
                    if same == color && first[0] == place[0] && first[1] + count == place[1] =>
                {
                    Some((first, count + 1, same))
                }
                other => {
                    draw(svg, other);
                    Some((*place, 1, color))
                }
            };
        }
        draw(svg, run);
    }

    /// The edge of what touches by some shares.
    fn outline(&self, svg: &mut Svg, shares: &[f64], style: &str) {
        for place in self.cells.keys() {
            if !self.touches(Some(*place), shares) {
                continue;
            }
            let [row, column] = *place;
            let ([x, y], [width, height]) = (self.corner(*place), self.side);
            let above = [row + 1, column];
            let right = [row, column + 1];
            let below = row.checked_sub(1).map(|row| [row, column]);
            let left = column.checked_sub(1).map(|column| [row, column]);
            for (beside, from, to) in [
                (Some(above), [x, y], [x + width, y]),
                (Some(right), [x + width, y], [x + width, y + height]),
                (below, [x, y + height], [x + width, y + height]),
                (left, [x, y], [x, y + height]),
            ] {
                if !self.touches(beside, shares) {
                    svg.line(from, to, style);
                }
            }
        }
    }
}

fn picture(mat: &Mat, print: &Printed, label: &str) -> String {
    let known = (0..mat.places.len()).filter(|k| !print.recorded[*k].is_nan());
    let cells: BTreeMap<[u32; 2], usize> =
        known.filter_map(|k| Some((mat.places[k]?, k))).collect();
    let range = |axis: usize| {
        let numbers = || cells.keys().map(|place| place[axis]);
        (numbers().min().unwrap_or(0), numbers().max().unwrap_or(0))
    };
    let (rows, columns) = (range(0), range(1));
    let pitch = pitch(mat, &cells);
    let extent = [
        f64::from(columns.1 - columns.0 + 1) * pitch[0],
        f64::from(rows.1 - rows.0 + 1) * pitch[1],
    ];
    let scale = (LARGEST[0] / extent[0]).min(LARGEST[1] / extent[1]);
    let picture = Picture {
        cells,
        print,
        low: [rows.0, columns.0],
        size: extent.map(|length| length * scale),
        side: pitch.map(|length| length * scale),
    };
    let [width, height] = picture.size;
    let mut svg = Svg::new(width.max(330.0), TOP + height + BOTTOM, label);
    picture.fill(&mut svg);
    let blue = format!("stroke='{SIMULATED}' stroke-width='1.8' stroke-linecap='square'");
    picture.outline(&mut svg, &print.simulated, &blue);
    picture.outline(&mut svg, &print.recorded, INK_EDGE);
    svg.frame([0.0, TOP], picture.size, "#c3cad0");
    let legend = [
        (BOTH, "both"),
        (INK_ALONE, "ink alone"),
        (SIMULATED_ALONE, "simulated alone"),
    ];
    for (k, (color, text)) in legend.iter().enumerate() {
        let left = 105.0 * k as f64;
        svg.rect([left, 8.0], [12.0, 12.0], color);
        svg.text([left + 17.0, 18.0], Anchor::Start, Type::Legend, text);
    }
    ruler(&mut svg, (scale, width, TOP + height + 14.0));
    svg.finish()
}

fn ruler(svg: &mut Svg, (scale, width, y): (f64, f64, f64)) {
    let long = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
    let Some(length) = long
        .iter()
        .rev()
        .find(|length| **length * scale <= 0.4 * width)
    else {
        return;
    };
    let style = format!("stroke='{STANDS_OUT}' stroke-width='2'");
    svg.line([0.0, y], [length * scale, y], &style);
    let at = [length * scale + 6.0, y + 4.0];
    svg.text(at, Anchor::Start, Type::Tick, &format!("{length} mm"));
}

/// Usual distance of neighboring columns and rows, mm.
fn pitch(mat: &Mat, cells: &BTreeMap<[u32; 2], usize>) -> [f64; 2] {
    let usual = |step: [u32; 2]| {
        let apart = |(place, cell): (&[u32; 2], &usize)| {
            let next = cells.get(&[place[0] + step[0], place[1] + step[1]])?;
            Some((mat.centers[*next] - mat.centers[*cell]).norm())
        };
        let mut lengths: Vec<f64> = cells.iter().filter_map(apart).collect();
        (!lengths.is_empty()).then(|| median(&mut lengths))
    };
    let side = mat.areas.first().map_or(1.0, |area| area.sqrt());
    [usual([0, 1]).unwrap_or(side), usual([1, 0]).unwrap_or(side)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use thenar_comparison::PosePart;

    /// Cells of 1 mm from the lower left row by row: both touch, ink alone, simulated alone, neither; half a cell touches.
    fn drawn() -> String {
        let places = [[0, 0], [0, 1], [1, 0], [1, 1]];
        let center = |[row, column]: [u32; 2]| Vector3::new(column.into(), row.into(), 0.0);
        let mat = Mat {
            centers: places.map(center).to_vec(),
            normals: vec![Vector3::z(); 4],
            areas: vec![1.0; 4],
            places: places.map(Some).to_vec(),
        };
        let pose = || PosePart {
            value: 0.0,
            low: 0.0,
            high: 0.0,
        };
        let print = Printed {
            recorded: vec![1.0, 0.5, 0.49, 0.0],
            simulated: vec![0.5, 0.49, 1.0, 0.0],
            as_laid: vec![0.0; 4],
            ink_kpa: 0.0,
            pose: [pose(), pose(), pose()],
            mirrored_overlap: 0.0,
            is_mirrored: false,
            regions: Vec::new(),
            on_skin: Vec::new(),
            beside: 0.0,
            is_at_end: false,
            worst: Vec::new(),
        };
        picture(&mat, &print, "")
    }

    /// A fill by the name that the caption gives it.
    fn hue(fill: &str) -> &'static str {
        let channel = |at: usize| i32::from_str_radix(&fill[at..at + 2], 16).expect("hex");
        match [1, 3, 5].map(channel) {
            [r, g, b] if r - b > 60 && (b..r).contains(&g) => "orange",
            [r, g, b] if b - r > 60 && (r..b).contains(&g) => "blue",
            [r, g, b] if r.min(g).min(b) > 220 => "paper",
            [r, g, b] if r.max(g).max(b) - r.min(g).min(b) < 30 => "gray",
            _ => "none of these",
        }
    }

    /// In the picture, where rows count upward, and before the words of the legend over it.
    #[test]
    fn cells_and_legend_have_the_colors_of_the_caption() {
        let svg = drawn();
        let (mut cells, mut legend) = (Vec::new(), Vec::new());
        for rect in svg.split("<rect ").skip(1) {
            let of = |key: &str| {
                let (_, after) = rect.split_once(&format!("{key}='")).expect(key);
                after.split('\'').next().expect("a quote")
            };
            let number = |key: &str| of(key).parse::<f64>().expect(key);
            if number("width") < 300.0 {
                let one = (-number("y"), number("x"), hue(of("fill")), rect);
                match number("y") < TOP {
                    true => legend.push(one),
                    false => cells.push(one),
                }
            }
        }
        cells.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let hues: Vec<&str> = cells.iter().map(|cell| cell.2).collect();
        assert_eq!(hues, ["gray", "orange", "blue", "paper"]);
        let told = [("gray", "both"), ("orange", "ink"), ("blue", "simulat")];
        assert_eq!(legend.len(), told.len());
        for (one, (hue, word)) in legend.iter().zip(told) {
            assert!(one.2 == hue && one.3.contains(word), "{one:?}");
        }
    }

    /// Two cells beside each other have six edges.
    #[test]
    fn outlines_go_around_ink_and_simulation() {
        let svg = drawn();
        let edges = |style: &str| svg.matches(style).count();
        assert_eq!(edges(INK_EDGE), 6);
        assert_eq!(edges(&format!("stroke='{SIMULATED}'")), 6);
    }
}
