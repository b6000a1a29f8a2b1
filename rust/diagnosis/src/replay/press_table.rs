//! A tool pressed to a ladder of depths: what a model without memory needs to answer any protocol.

use thenar_contact::{Control, Demand, Keep, Protocol, Row, Run, Skin};
use thenar_surface::{Product, Vec3};

use super::interpolation::Table;
use crate::DiagnosisError;

/// Depths of the ladder. With 24, a Hertz curve is joined to 1e-4 of its peak.
const RUNGS: usize = 24;

/// A press at each depth of a ladder, which grows as the square: near first touch force, area and pressure are smooth in the
/// root of the depth.
#[derive(Debug, Clone)]
pub struct PressTable {
    /// Roots of the depths, from 0.
    pub roots: Vec<f64>,
    /// Force along the travel, N.
    pub force: Vec<f64>,
    /// Contact area, mm2.
    pub area: Vec<f64>,
    /// Pressure (MPa) of the vertices in contact.
    pub pressure: Vec<Vec<(u32, f64)>>,
    /// By region, whether it bears force at the deepest rung.
    pub touched: Vec<bool>,
    /// Travel of the tool from where it was given to first touch, mm.
    pub touch_offset: f64,
}

/// Presses `tool` along `direction` to `deepest`, mm, in steps.
///
/// # Errors
/// What the contact model says, of `what`.
pub fn press_table(
    skin: &mut Skin,
    (tool, direction): (&Product, Vec3),
    deepest: f64,
    (what, control): (&str, &Control<'_>),
) -> Result<PressTable, DiagnosisError> {
    let roots: Vec<f64> = (0..=RUNGS)
        .map(|k| deepest.sqrt() * k as f64 / RUNGS as f64)
        .collect();
    let row = |(k, root): (usize, &f64)| Row {
        time_s: k as f64,
        demand: Demand::Depth(root * root),
        slide: Vec3::zeros(),
    };
    let protocol = Protocol {
        rows: roots.iter().enumerate().map(row).collect(),
        direction: Some(direction),
    };
    let run = Run {
        product: tool,
        posed: None,
        protocol: &protocol,
        keep: Keep::Pressure,
    };
    let course = skin
        .run(&run, control)
        .map_err(DiagnosisError::of_contact(what))?;
    Ok(PressTable {
        roots,
        force: course.steps.iter().map(|step| step.force).collect(),
        area: course.steps.iter().map(|step| step.area).collect(),
        touched: course.steps.last().map_or_else(Vec::new, |step| {
            step.region_force.iter().map(|f| *f > 0.0).collect()
        }),
        touch_offset: course.touch_offset.unwrap_or(0.0),
        pressure: course.steps.into_iter().map(|step| step.pressure).collect(),
    })
}

/// Several tables of one ladder whose weighted sum is the press at some parameters.
///
/// In one region without coupling `p = G p1` with p1 independent of G, and `G = G0 (1 - share) + Glim share` with a share that
/// depends on the depth alone (Xie Eq. 3): force and pressure are linear in G0 and Glim, and the area depends on neither.
#[derive(Debug, Clone)]
pub struct Basis {
    /// Roots of the depths.
    pub roots: Vec<f64>,
    /// Force by part.
    pub force: Vec<Table>,
    /// Contact area.
    pub area: Table,
    /// By part and rung: pressure of the vertices, MPa.
    pub pressure: Vec<Vec<Vec<(u32, f64)>>>,
    /// By region, whether it bears force at the deepest rung.
    pub touched: Vec<bool>,
    /// Travel to first touch, mm.
    pub touch_offset: f64,
}

impl Basis {
    /// One part: the press itself.
    pub fn whole(table: PressTable) -> Basis {
        Basis {
            force: vec![Table::new(&table.roots, table.force)],
            area: Table::new(&table.roots, table.area),
            pressure: vec![table.pressure],
            roots: table.roots,
            touched: table.touched,
            touch_offset: table.touch_offset,
        }
    }

    /// Two parts, to be weighted with G0 and Glim: from the press with G0 = Glim = `unit` and that with Glim twice as large.
    pub fn linear(one: PressTable, two: &PressTable, unit: f64) -> Basis {
        let rest = |one: f64, two: f64| (2.0 * one - two) / unit;
        let limit = |one: f64, two: f64| (two - one) / unit;
        let split = |part: &dyn Fn(f64, f64) -> f64| {
            let force = one.force.iter().zip(&two.force).map(|(a, b)| part(*a, *b));
            let pressure = one.pressure.iter().zip(&two.pressure);
            let pressure = pressure.map(|(a, b)| joined(a, b, part)).collect();
            (Table::new(&one.roots, force.collect()), pressure)
        };
        let ((force_0, pressure_0), (force_1, pressure_1)) = (split(&rest), split(&limit));
        Basis {
            force: vec![force_0, force_1],
            pressure: vec![pressure_0, pressure_1],
            area: Table::new(&one.roots, one.area),
            roots: one.roots,
            touched: one.touched,
            touch_offset: one.touch_offset,
        }
    }

    /// Force at a depth, N; 0 apart.
    pub fn force_at(&self, weights: &[f64], depth: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let root = depth.sqrt();
        self.force
            .iter()
            .zip(weights)
            .map(|(table, w)| w * table.at(root))
            .sum()
    }

    /// Contact area at a depth, mm2; 0 apart.
    pub fn area_at(&self, depth: f64) -> f64 {
        if depth > 0.0 {
            self.area.at(depth.sqrt()).max(0.0)
        } else {
            0.0
        }
    }

    /// Depth at which a force is reached, mm; the deepest where it is not.
    pub fn depth_at(&self, weights: &[f64], force: f64) -> f64 {
        let last = self.roots[self.roots.len() - 1];
        let (mut low, mut high) = (0.0, last * last);
        if force <= 0.0 {
            return 0.0;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match self.force_at(weights, middle) < force {
                true => low = middle,
                false => high = middle,
            }
        }
        0.5 * (low + high)
    }
}

/// Pressures of two presses put together vertex by vertex; a vertex that only one of them touches bears 0 in the other.
fn joined(
    one: &[(u32, f64)],
    two: &[(u32, f64)],
    part: &dyn Fn(f64, f64) -> f64,
) -> Vec<(u32, f64)> {
    let (mut i, mut j, mut sum) = (0, 0, Vec::with_capacity(one.len()));
    while i < one.len() || j < two.len() {
        let (a, b) = (one.get(i), two.get(j));
        let vertex = u32::min(a.map_or(u32::MAX, |a| a.0), b.map_or(u32::MAX, |b| b.0));
        let of = |entry: Option<&(u32, f64)>| entry.filter(|e| e.0 == vertex).map(|e| e.1);
        let (first, second) = (of(a), of(b));
        i += usize::from(first.is_some());
        j += usize::from(second.is_some());
        sum.push((vertex, part(first.unwrap_or(0.0), second.unwrap_or(0.0))));
    }
    sum
}
