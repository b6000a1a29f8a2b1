//! Derivatives of one recording's forces by parameters that scale the elastic response at a depth: moduli, form and scale of a tool.
//!
//! Such a parameter leaves depths and clocks as they are, so that the force is linear in the stiffness at each depth: what memory leaves of
//! every spring is found once for all of them.

use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::force_prediction::over_spread;
use crate::forward::surrogate::mechanism::{Law, Mechanism};
use crate::forward::surrogate::relaxing_springs::{Lost, SpringHistory, lost_lengths};
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::parameters::surrogate_parameter::Kind;

/// What a recording's elastic response is at a point, and what memory leaves of it.
pub(crate) struct Stiffness {
    /// True depth of each row, mm.
    depths: Vec<f64>,
    /// Elastic force of each row, N.
    elastic: Vec<f64>,
    /// Depths of the table's rungs, mm, and elastic forces there, N; empty where nothing relaxes.
    rungs: Vec<(f64, f64)>,
    /// What each spring loses, by row.
    lost: Lost,
}

/// True where the force after a mechanism is an affine function of the force before it, which does not move depths.
fn is_affine(mechanism: &Mechanism) -> bool {
    !matches!(
        mechanism.law,
        Law::Saturation(_) | Law::Floor(_) | Law::Compliance
    )
}

impl Surrogate<'_> {
    /// The elastic response of a recording; None with a mechanism that is not affine.
    pub(crate) fn stiffness(
        &self,
        (model, set): (&Model<'_>, &Setting),
        (course, forces): (usize, &[f64]),
    ) -> Option<Stiffness> {
        if !model.mechanisms.iter().all(is_affine) {
            return None;
        }
        let one = &self.courses[course];
        let table = &self.elastic.places[one.place];
        let depths = self.depths(model, set, (course, forces));
        let elastic = |d: &f64| match *d > 0.0 {
            true => table.force.at(d.sqrt()) * self.factor(model, set, (one.place, *d)),
            false => 0.0,
        };
        let elastic = over_spread(&one.rows, &depths, elastic);
        let (branches, shares) = self.relaxation_branches(model, set, (one, &depths));
        let (mut rungs, mut lost) = (Vec::new(), Lost::default());
        if !branches.is_empty() {
            let at = table.roots.iter().map(|r| r * r);
            let force = |(d, f): (f64, &f64)| (d, f * self.factor(model, set, (one.place, d)));
            rungs = at.zip(&table.rungs).map(force).collect();
            let touches: Vec<f64> = rungs.iter().map(|r| r.0).collect();
            let way = SpringHistory {
                depths: &depths,
                touches: &touches[..touches.len() - 1],
                relaxation_branches: &branches,
                shares: &shares,
            };
            lost = lost_lengths(&way);
        }
        Some(Stiffness {
            depths,
            elastic,
            rungs,
            lost,
        })
    }

    /// Derivative of the forces by a parameter of the stiffness; None for any other.
    pub(crate) fn stiffness_slopes(
        &self,
        (model, set): (&Model<'_>, &Setting),
        (kind, course): (Kind, usize),
        of: &Stiffness,
    ) -> Option<Vec<f64>> {
        let one = &self.courses[course];
        let by = |depth: f64| self.log_slope(set, kind, (one.place, depth));
        by(0.0)?;
        let by = |depth: f64| by(depth.max(0.0)).unwrap_or(0.0);
        let rows = of.depths.iter().zip(&of.elastic);
        let mut slope: Vec<f64> = rows.map(|(d, f)| f * by(*d)).collect();
        if !of.rungs.is_empty() {
            let moved: Vec<(f64, f64)> = of.rungs.iter().map(|(d, f)| (*d, f * by(*d))).collect();
            let secant = |k: usize| (moved[k + 1].1 - moved[k].1) / (moved[k + 1].0 - moved[k].0);
            let spring = |k: usize| secant(k) - if k > 0 { secant(k - 1) } else { 0.0 };
            let springs: Vec<f64> = (0..moved.len() - 1).map(spring).collect();
            let more = of.lost.forces(&springs);
            slope.iter_mut().zip(more).for_each(|(s, m)| *s += m);
        }
        self.soften_by_use(model, set, ((one, &of.depths), &mut slope));
        // The instrument is affine: what it makes of nothing is taken off.
        let mut nothing = vec![0.0; slope.len()];
        self.read(model, set, (course, &mut slope));
        self.read(model, set, (course, &mut nothing));
        let linear = slope
            .iter()
            .zip(nothing)
            .map(|(with, without)| with - without);
        Some(linear.collect())
    }

    /// Derivative of the logarithm of the stiffness at a depth by a parameter of it; None for any other.
    fn log_slope(&self, set: &Setting, kind: Kind, (place, depth): (usize, f64)) -> Option<f64> {
        let share = (depth / self.elastic.limit_depth).clamp(0.0, 1.0);
        let (first, limit) = (set.first * (1.0 - share), set.limit * share);
        Some(match kind {
            Kind::First => first / (first + limit),
            Kind::Limit => limit / (first + limit),
            Kind::Scale(_) => 1.0,
            Kind::Form(_, way) => self.form_of_tool(place, depth)[way],
            Kind::SharedForm(_, form) => self.form_of_site(depth)[form],
            _ => return None,
        })
    }
}
