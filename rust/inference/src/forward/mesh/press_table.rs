//! Force and area of a tool at a series of depths: what a model without history needs to predict any protocol.

use thenar_contact::instrument::PointLoad;
use thenar_contact::{Control, Demand, Keep, Pressing, Protocol, Row, Run};
use thenar_surface::{Product, Vec3};

use crate::errors::InferenceError;
use crate::interpolation::Table;

/// Depths of the ladder. With 24, a Hertz curve is joined to 1e-4 of its peak.
pub(crate) const RUNGS: usize = 24;

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
    /// What presses on the tool, in its own frame; empty unless a mat lies on it.
    pub loads: Vec<Vec<PointLoad>>,
    /// By region, whether it bears force at the deepest rung.
    pub touched: Vec<bool>,
}

/// Presses `tool` along `direction` to `deepest`, mm, in `rungs` steps.
///
/// # Errors
/// What the contact model says, of `what`.
pub(crate) fn press_table(
    mut skin: Pressing<'_>,
    (tool, direction): (&Product, Vec3),
    (deepest, rungs, keep): (f64, usize, Keep),
    (what, control): (&str, &Control<'_>),
) -> Result<PressTable, InferenceError> {
    let roots: Vec<f64> = (0..=rungs)
        .map(|k| deepest.sqrt() * k as f64 / rungs as f64)
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
        keep,
    };
    let course = skin
        .run(&run, control)
        .map_err(InferenceError::of_contact(what))?;
    Ok(PressTable {
        roots,
        force: course.steps.iter().map(|step| step.force).collect(),
        area: course.steps.iter().map(|step| step.area).collect(),
        touched: course.steps.last().map_or_else(Vec::new, |step| {
            step.region_force.iter().map(|f| *f > 0.0).collect()
        }),
        loads: course.steps.into_iter().map(|step| step.loads).collect(),
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
    /// By press and rung: what presses on the tool.
    pub loads: Vec<Vec<Vec<PointLoad>>>,
    /// By part: how much of each press it takes.
    pub mix: Vec<Vec<f64>>,
    /// By region, whether it bears force at the deepest rung.
    pub touched: Vec<bool>,
}

impl Basis {
    /// One part: the press itself.
    pub fn whole(table: PressTable) -> Basis {
        Basis {
            force: vec![Table::new(&table.roots, table.force)],
            area: Table::new(&table.roots, table.area),
            loads: vec![table.loads],
            mix: vec![vec![1.0]],
            roots: table.roots,
            touched: table.touched,
        }
    }

    /// Two parts, to be weighted with G0 and Glim: from the press with G0 = Glim = `unit` and that with Glim twice as large.
    pub fn linear(one: PressTable, two: PressTable, unit: f64) -> Basis {
        let mix = vec![vec![2.0 / unit, -1.0 / unit], vec![-1.0 / unit, 1.0 / unit]];
        let force = |part: &Vec<f64>| {
            let both = one.force.iter().zip(&two.force);
            let values = both.map(|(a, b)| part[0] * a + part[1] * b).collect();
            Table::new(&one.roots, values)
        };
        Basis {
            force: mix.iter().map(force).collect(),
            loads: vec![one.loads, two.loads],
            mix,
            area: Table::new(&one.roots, one.area),
            roots: one.roots,
            touched: one.touched,
        }
    }

    /// Force at a depth, N; 0 apart.
    pub(crate) fn force_at(&self, weights: &[f64], depth: f64) -> f64 {
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
    pub(crate) fn area_at(&self, depth: f64) -> f64 {
        if depth > 0.0 {
            self.area.at(depth.sqrt()).max(0.0)
        } else {
            0.0
        }
    }

    /// Depth at which a force is reached, mm; the deepest where it is not.
    pub(crate) fn depth_at(&self, weights: &[f64], force: f64) -> f64 {
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
