//! Stiffness over the table's: modulus, form error, and effects that change the elastic response.

use thenar_contact::effects::Effect;

use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::mechanism::{DeformationMeasure, KNOTS, Law};
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::forward::tables::elastic_table::{radius, rung};
use crate::forward::tables::form_ways::{WAYS, ways};
use crate::interpolation::{interval, mixed};
use crate::parameters::priors::{SHARED, SHARED_DEPTH};

/// Depth over that which shared forms were measured to, up to which they go on: half the thickness.
const DEEPEST: f64 = 0.5 / SHARED_DEPTH;

impl Surrogate<'_> {
    /// Modulus, form and changed response at a depth: force over the table's.
    pub(crate) fn factor(
        &self,
        model: &Model<'_>,
        set: &Setting,
        (place, depth): (usize, f64),
    ) -> f64 {
        let share = (depth / self.elastic.limit_depth).clamp(0.0, 1.0);
        let modulus = set.first * (1.0 - share) + set.limit * share;
        let mut log = set.scale[place];
        let is_off = |sizes: &[f64]| sizes.iter().any(|size| *size != 0.0);
        let (of_tool, of_site) = (
            &set.form[place],
            &set.shared_form[self.elastic.site_of[place]],
        );
        if is_off(of_tool) {
            log += sum(of_tool, &self.form_of_tool(place, depth));
        }
        if is_off(of_site) {
            log += sum(of_site, &self.form_of_site(depth));
        }
        for (number, mechanism) in model.mechanisms.iter().enumerate() {
            match &mechanism.law {
                Law::Tabulated(form) => {
                    let value = set.of[number][0];
                    log += self.tabled((mechanism.effect, *form), value, (place, depth));
                }
                Law::Stiffening(measure, growth) => {
                    let (rate, x) = (set.of[number][0], self.measure(*measure, (place, depth)));
                    log += growth.log(rate, x);
                }
                Law::DepthCurve { knot } => {
                    let x = (KNOTS + 1) as f64 * depth / self.most.1;
                    log += set.of[number][0] * (1.0 - (x - (knot + 1) as f64).abs()).max(0.0);
                }
                _ => {}
            }
        }
        modulus * libm::exp(log)
    }

    /// Ways in which the form of one tool's force may be off at a depth, over that tool's deepest.
    pub(crate) fn form_of_tool(&self, place: usize, depth: f64) -> [f64; WAYS] {
        ways((depth / self.elastic.places[place].deepest).clamp(0.0, 1.0))
    }

    /// The forms that all tools at a site share, at a depth: as they were measured, over a part of the tissue's thickness.
    pub(crate) fn form_of_site(&self, depth: f64) -> [f64; SHARED] {
        let ways = ways((depth / self.elastic.shared_depth).clamp(0.0, DEEPEST));
        self.elastic.shared_form().map(|form| sum(&form, &ways))
    }

    fn tabled(
        &self,
        (effect, form): (Effect, usize),
        value: f64,
        (place, depth): (usize, f64),
    ) -> f64 {
        let Some(variant) = self.elastic.variant(effect, form) else {
            return 0.0;
        };
        let table = &self.elastic.places[place];
        let (knot, share) = interval(&variant.knots, value);
        let rung = rung(table, depth);
        let at = |knot: usize| mixed(&variant.log_ratio[place][knot], rung);
        at(knot) * (1.0 - share) + at(knot + 1) * share
    }

    fn measure(&self, measure: DeformationMeasure, (place, depth): (usize, f64)) -> f64 {
        match measure {
            DeformationMeasure::Depth => depth / self.most.1,
            DeformationMeasure::Strain => self.strain((place, depth)) / self.largest_strain(),
        }
    }

    /// a/R of a sphere of radius R at depth d is d/a, so that the table's own contact radius tells it.
    fn strain(&self, (place, depth): (usize, f64)) -> f64 {
        depth / radius(&self.elastic.places[place], depth).max(1e-9)
    }

    /// Largest strain of any tool at the study's largest depth.
    pub fn largest_strain(&self) -> f64 {
        let places = 0..self.elastic.studied;
        let all = places.map(|place| self.strain((place, self.most.1)));
        all.fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// Products of each of two, summed.
fn sum<const N: usize>(sizes: &[f64; N], ways: &[f64; N]) -> f64 {
    sizes.iter().zip(ways).map(|(size, way)| size * way).sum()
}
