//! The kernel of a layer under a bonded stiff skin, tabulated over distance.
//!
//! The kernel of layer and plate (the sibling `plate_on_layer`) is finite at distance 0, so `r` times it is tabulated, not what it lacks of 1/r. For
//! two places with different transfer functions their geometric mean counts, as in the sibling `kernel_tables`, and the response stays definite.

use libm::j0;
use rayon::prelude::*;

use super::bonded_layer::Layer;
use super::kernel_grid::{KNOTS_PER_THICKNESS, RANGE_IN_THICKNESSES, RULE};
use super::kernel_tables::interpolate;
use super::plate_on_layer::Sheet;
use super::tissue_geometry::Mix;
use crate::skin::sites::Sites;

/// Wave numbers reach to this over the bending length, at most to `MOST_WAVE_NUMBER` (1/mm).
const END_IN_LENGTHS: f64 = 40.0;
const MOST_WAVE_NUMBER: f64 = 100.0;
/// The integrals fade towards the end, which lies at this many widths of their window.
const FADE: f64 = 3.5;
/// Knots per bending length, and the most of one table.
const KNOTS_PER_LENGTH: f64 = 16.0;
const MOST_KNOTS: usize = 2048;
/// Root areas of a site for which its own term is tabulated, mm, in equal ratios.
const ROOT_AREAS: (f64, f64, usize) = (0.05, 20.0, 64);
/// Lattice sums go this far, in reciprocal spacings.
const LATTICE_REACH: i32 = 24;

/// The stiff skin of a whole hand: its tables, and the sheet over every site.
#[derive(Debug, Clone)]
pub struct StiffSkin {
    tables: StiffTables,
    sheet: Vec<usize>,
}

impl StiffSkin {
    /// None where `sheets` (by region) is empty. `size` is the extent of the skin, mm.
    pub fn new(
        layers: &[Layer],
        (sheets, sites): (&[Sheet], &Sites),
        size: f64,
    ) -> Option<StiffSkin> {
        let mut distinct: Vec<Sheet> = Vec::new();
        for sheet in sheets {
            if !distinct.contains(sheet) {
                distinct.push(*sheet);
            }
        }
        let number = |region: u32| distinct.iter().position(|d| *d == sheets[region as usize]);
        let sheet = |site: usize| number(sites.home_region(site)).unwrap_or(0);
        (!distinct.is_empty()).then(|| StiffSkin {
            sheet: (0..sites.len()).map(sheet).collect(),
            tables: StiffTables::new(layers, &distinct, size),
        })
    }

    /// The response between two sites, each with its mix of layers, at a distance (mm); without one, the term of a site of that
    /// area (mm2). 1/mm.
    pub fn entry(&self, pair: [(usize, Mix); 2], (r, area): (Option<f64>, f64)) -> f64 {
        let [(i, a), (j, b)] = pair;
        let kernel = |la: u16, lb: u16| {
            let pair = [
                (usize::from(la), self.sheet[i]),
                (usize::from(lb), self.sheet[j]),
            ];
            match r {
                Some(r) => self.tables.kernel(pair, r),
                None => self.tables.own(pair, area),
            }
        };
        if a.0 == a.1 && b.0 == b.1 {
            return kernel(a.0, b.0);
        }
        // Summed in an order that does not change when i and j trade places.
        let (va, vb) = (1.0 - a.2, 1.0 - b.2);
        (a.2 * b.2 * kernel(a.0, b.0) + va * vb * kernel(a.1, b.1))
            + (a.2 * vb * kernel(a.0, b.1) + va * b.2 * kernel(a.1, b.0))
    }
}

/// Tables for every pair of layers under every pair of sheets.
#[derive(Debug, Clone)]
pub struct StiffTables {
    layers: usize,
    step: f64,
    tables: Vec<Table>,
}

#[derive(Debug, Clone)]
struct Table {
    /// r times the kernel, one knot before zero.
    moment: Vec<f64>,
    /// Root area times a site's own term, by `ROOT_AREAS`.
    own: Vec<f64>,
}

impl StiffTables {
    /// Tabulates distances up to `size` (the extent of the skin, mm).
    pub fn new(layers: &[Layer], sheets: &[Sheet], size: f64) -> StiffTables {
        let classes: Vec<(Layer, Sheet)> = sheets
            .iter()
            .flat_map(|sheet| layers.iter().map(move |layer| (*layer, *sheet)))
            .collect();
        let grid = Grid::new(layers, sheets, size);
        let nodes = grid.nodes();
        let root = |(layer, sheet): &(Layer, Sheet)| {
            let seen = |&(k, _): &(f64, f64)| sheet.transfer(layer, k).sqrt();
            nodes.iter().map(seen).collect()
        };
        let roots: Vec<Vec<f64>> = classes.iter().map(root).collect();
        let pairs: Vec<(usize, usize)> = (0..classes.len())
            .flat_map(|b| (0..=b).map(move |a| (a, b)))
            .collect();
        let weight = |&(a, b): &(usize, usize)| {
            let product = roots[a].iter().zip(&roots[b]);
            nodes
                .iter()
                .zip(product)
                .map(|(n, (x, y))| n.1 * x * y)
                .collect()
        };
        let weights: Vec<Vec<f64>> = pairs.iter().map(weight).collect();
        let knots: Vec<Vec<f64>> = (0..grid.knots)
            .into_par_iter()
            .map(|knot| {
                let r = grid.place(knot);
                let bessel: Vec<f64> = nodes.iter().map(|&(k, _)| j0(k * r)).collect();
                let moment =
                    |w: &Vec<f64>| r * w.iter().zip(&bessel).map(|(w, j)| w * j).sum::<f64>();
                weights.iter().map(moment).collect()
            })
            .collect();
        let table = |(pair, &(a, b)): (usize, &(usize, usize))| {
            let moment = knots.iter().map(|of_pair| of_pair[pair]).collect();
            Table::new([classes[a], classes[b]], (moment, &grid))
        };
        StiffTables {
            layers: layers.len(),
            step: grid.step,
            tables: pairs.par_iter().enumerate().map(table).collect(),
        }
    }

    /// The kernel between two places at distance `r` (mm), 1/mm; each place is a layer and a sheet.
    pub fn kernel(&self, pair: [(usize, usize); 2], r: f64) -> f64 {
        let table = self.table(pair);
        interpolate(&table.moment, r / self.step) / r
    }

    /// A site's own term for its area (mm2), 1/mm: what a lattice of such sites lacks of the integral.
    pub fn own(&self, pair: [(usize, usize); 2], area: f64) -> f64 {
        let (low, high, count) = ROOT_AREAS;
        let root = area.sqrt();
        let x = (root / low).ln() / (high / low).ln() * (count - 1) as f64;
        let x = x.clamp(0.0, (count - 1) as f64 - 1e-9);
        let own = &self.table(pair).own;
        let (i, share) = (x as usize, x.fract());
        ((1.0 - share) * own[i] + share * own[i + 1]) / root
    }

    fn table(&self, pair: [(usize, usize); 2]) -> &Table {
        let [a, b] = pair.map(|(layer, sheet)| sheet * self.layers + layer);
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        &self.tables[b * (b + 1) / 2 + a]
    }
}

impl Table {
    fn new(pair: [(Layer, Sheet); 2], (mut moment, grid): (Vec<f64>, &Grid)) -> Table {
        let transfer = |k: f64| {
            let [a, b] = pair.map(|(layer, sheet)| sheet.transfer(&layer, k));
            (a * b).sqrt()
        };
        let range = 0.5 * RANGE_IN_THICKNESSES * (pair[0].0.thickness + pair[1].0.thickness);
        if range <= grid.reach {
            close(&mut moment, grid.step, (range, transfer(1e-6) / 1e-6));
        }
        let (low, high, count) = ROOT_AREAS;
        let own = |i: usize| {
            let root = low * (high / low).powf(i as f64 / (count - 1) as f64);
            root * own_term(&transfer, root)
        };
        Table {
            moment,
            own: (0..count).map(own).collect(),
        }
    }
}

/// Where all tables of a skin have their knots, and their integrals their nodes.
struct Grid {
    step: f64,
    reach: f64,
    knots: usize,
    end: f64,
}

impl Grid {
    fn new(layers: &[Layer], sheets: &[Sheet], size: f64) -> Grid {
        let thickness = layers.iter().map(|layer| layer.thickness);
        let (thinnest, thickest) = thickness.fold((f64::INFINITY, 0.0f64), |(low, high), h| {
            (low.min(h), high.max(h))
        });
        let lengths = sheets.iter().map(|sheet| sheet.bending.cbrt());
        let length = lengths.filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
        let end = (END_IN_LENGTHS / length).clamp(1.0, MOST_WAVE_NUMBER);
        let reach = (RANGE_IN_THICKNESSES * thickest).min(size);
        let fine = (thinnest / KNOTS_PER_THICKNESS).min(length / KNOTS_PER_LENGTH);
        let step = fine.max(reach / MOST_KNOTS as f64).min(reach);
        let knots = (reach / step).ceil() as usize + 4;
        Grid {
            step,
            reach,
            knots,
            end,
        }
    }

    /// Distance of a knot, mm; the first lies before zero.
    fn place(&self, knot: usize) -> f64 {
        (knot as f64 - 1.0) * self.step
    }

    /// Gauss-Legendre panels, each no longer than one oscillation of J0 at the reach, with the window in their weights.
    fn nodes(&self) -> Vec<(f64, f64)> {
        let panels = ((self.end * self.reach / std::f64::consts::TAU).ceil() as usize).max(60);
        let half = 0.5 * self.end / panels as f64;
        let seen = |k: f64, w: f64| (k, half * w * window(FADE * k / self.end));
        let panel = |panel: usize| {
            let middle = (2 * panel + 1) as f64 * half;
            let around = move |(x, w): (f64, f64)| [(middle - half * x, w), (middle + half * x, w)];
            RULE.into_iter().flat_map(around)
        };
        (0..panels)
            .flat_map(panel)
            .map(|(k, w)| seen(k, w))
            .collect()
    }
}

/// A window that is 1 - x^4 / 2 near 0: what it cuts off adds nothing at distances that matter.
fn window(x: f64) -> f64 {
    (1.0 + x * x) * (-x * x).exp()
}

/// Ends the kernel at its range and gives back the volume beyond, as the bare layer's does.
fn close(moment: &mut [f64], step: f64, (range, wanted): (f64, f64)) {
    let from = 0.5 * range;
    let share = |r: f64| ((r - from) / (range - from)).clamp(0.0, 1.0);
    let fade = |r: f64| 1.0 - share(r).powi(3) * (10.0 - 15.0 * share(r) + 6.0 * share(r).powi(2));
    let bump = |r: f64| (std::f64::consts::PI * share(r)).sin().powi(4);
    let place = |knot: usize| (knot as f64 - 1.0) * step;
    moment
        .iter_mut()
        .enumerate()
        .for_each(|(knot, g)| *g *= fade(place(knot)));
    let count = 32 * (range / step).ceil() as usize;
    let width = range / count as f64;
    let (mut volume, mut room) = (0.0, 0.0);
    for i in 0..count {
        let r = (i as f64 + 0.5) * width;
        volume += interpolate(moment, r / step) * width;
        room += r * bump(r) * width;
    }
    for (knot, g) in moment.iter_mut().enumerate() {
        *g += (wanted - volume) / room * place(knot) * bump(place(knot));
    }
}

/// The integral of the transfer function less the sum over a square lattice of root area `root` (mm): Poisson's formula for
/// what a lattice without its middle lacks. 3.9003 / root for a half space, the kernel at 0 for wide kernels.
fn own_term(transfer: &impl Fn(f64) -> f64, root: f64) -> f64 {
    let unit = std::f64::consts::TAU / root;
    let cut = unit * f64::from(LATTICE_REACH) / 4.0;
    let seen = |k: f64| transfer(k) * window(k / cut);
    let (low, high, steps) = (1e-6f64, 5.0 * cut, 1500);
    let ratio = (high / low).ln() / f64::from(steps);
    let whole: f64 = (0..=steps)
        .map(|i| low * (ratio * f64::from(i)).exp())
        .map(|k| k * seen(k) * ratio)
        .sum();
    let mut sum = 0.0;
    for m in 0..=LATTICE_REACH {
        for n in 1..=LATTICE_REACH {
            let far = f64::from(m * m + n * n).sqrt();
            sum += 4.0 * seen(unit * far) / far;
        }
    }
    whole - sum / root
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_SPACE: Layer = Layer {
        thickness: f64::INFINITY,
        poisson_ratio: 0.5,
    };

    #[test]
    fn without_a_skin_the_own_term_is_the_lattice_constant() {
        for root in [0.3, 1.0, 2.5] {
            let own = own_term(&|_| 1.0, root) * root;
            assert!((own / 3.900_3 - 1.0).abs() < 2e-4, "{root}: {own}");
        }
    }

    #[test]
    fn a_stiff_plate_on_a_half_space_sinks_by_its_closed_form() {
        // The integral of dk / (1 + b k^3) is 2 pi / (3 sqrt(3) b^(1/3)).
        for length in [2.0f64, 6.0] {
            let sheet = Sheet {
                bending: length.powi(3),
                ..Sheet::NONE
            };
            let tables = StiffTables::new(&[HALF_SPACE], &[sheet], 60.0);
            let exact = std::f64::consts::TAU / (27f64.sqrt() * length);
            for found in [
                tables.own([(0, 0); 2], 0.01 * length * length),
                tables.kernel([(0, 0); 2], 0.01 * length),
            ] {
                assert!(
                    (found / exact - 1.0).abs() < 5e-3,
                    "{length}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn a_soft_skin_leaves_the_bonded_layer() {
        let layer = Layer {
            thickness: 5.0,
            poisson_ratio: 0.5,
        };
        let sheet = Sheet {
            bending: 1e-4,
            ..Sheet::NONE
        };
        let tables = StiffTables::new(&[layer], &[sheet], 200.0);
        let bare = super::super::kernel_tables::KernelTables::new(&[layer], 200.0);
        for r in [0.5, 1.0, 2.0, 5.0, 12.0] {
            let (found, expected) = (tables.kernel([(0, 0); 2], r), 1.0 / r - bare.psi(0, 0, r));
            assert!(
                (found - expected).abs() * r < 5e-3,
                "{r}: {found} {expected}"
            );
        }
        let own = tables.own([(0, 0); 2], 1.0);
        assert!(
            (own / (3.900_3 - bare.psi(0, 0, 0.0)) - 1.0).abs() < 0.01,
            "{own}"
        );
    }
}
