//! A frame with two axes: from numbers to places on a figure, with grid, ticks and titles.

use crate::svg::{Anchor, Svg, Type};
use crate::ticks::{round_up, ticks};

const GRID: &str = "stroke='#e4e9ed' stroke-width='1'";
const ZERO: &str = "stroke='#59636b' stroke-width='1'";

/// A plot's frame on a figure.
pub struct Axes {
    corner: [f64; 2],
    size: [f64; 2],
    x: [f64; 2],
    y: [f64; 2],
}

/// What stands beside the axes; an empty text leaves it out.
#[derive(Debug, Clone, Copy, Default)]
pub struct Titles<'a> {
    pub x: &'a str,
    pub y: &'a str,
    /// Whether the numbers of x stand below.
    pub has_x_numbers: bool,
}

impl Axes {
    /// A frame at `corner` of `size`, px, for ranges of x and y; a range without width is widened.
    pub fn new(corner: [f64; 2], size: [f64; 2], x: [f64; 2], y: [f64; 2]) -> Axes {
        Axes {
            corner,
            size,
            x: widened(x),
            y: widened(y),
        }
    }

    /// Place of a point.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [
            self.corner[0] + self.size[0] * share(x, self.x),
            self.corner[1] + self.size[1] * (1.0 - share(y, self.y).clamp(-0.02, 1.02)),
        ]
    }

    /// A band from `low` to `high` over the whole width.
    pub fn band(&self, svg: &mut Svg, low: f64, high: f64, fill: &str) {
        let top = self.at(self.x[0], high.min(self.y[1]));
        let bottom = self.at(self.x[0], low.max(self.y[0]));
        svg.rect(top, [self.size[0], bottom[1] - top[1]], fill);
    }

    /// Grid, ticks and titles.
    pub fn draw(&self, svg: &mut Svg, titles: Titles) {
        let ([left, top], [width, height]) = (self.corner, self.size);
        let (right, bottom) = (left + width, top + height);
        for (value, text) in ticks(self.y[0], self.y[1], (height / 26.0) as usize) {
            let y = self.at(0.0, value)[1];
            svg.line(
                [left, y],
                [right, y],
                if value == 0.0 { ZERO } else { GRID },
            );
            svg.text([left - 6.0, y + 3.5], Anchor::End, Type::Tick, &text);
        }
        for (value, text) in ticks(self.x[0], self.x[1], (width / 60.0) as usize) {
            let x = self.at(value, 0.0)[0];
            svg.line([x, top], [x, bottom], GRID);
            if titles.has_x_numbers {
                svg.text([x, bottom + 15.0], Anchor::Middle, Type::Tick, &text);
            }
        }
        svg.frame(self.corner, self.size, "#8a9299");
        let middle = [left + width / 2.0, top + height / 2.0];
        if !titles.x.is_empty() {
            svg.text(
                [middle[0], bottom + 32.0],
                Anchor::Middle,
                Type::Axis,
                titles.x,
            );
        }
        if !titles.y.is_empty() {
            svg.text_up([left - 42.0, middle[1]], Type::Axis, titles.y);
        }
    }
}

/// The range of values, with a margin; `0..1` if there is none.
pub fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|value| value.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    if low > high {
        return [0.0, 1.0];
    }
    let margin = 0.04 * (high - low);
    let low = if low >= 0.0 && low < 0.3 * high {
        0.0
    } else {
        low - margin
    };
    [low, high + margin]
}

/// A range around zero.
pub fn symmetric(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|value| value.is_finite());
    let most = finite.fold(0.0_f64, |most, value| most.max(value.abs()));
    let most = if most > 0.0 {
        round_up(1.02 * most)
    } else {
        1.0
    };
    [-most, most]
}

fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    match high > low {
        true => [low, high],
        false => [low - 0.5, low + 0.5],
    }
}
