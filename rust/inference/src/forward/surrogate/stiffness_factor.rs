//! Stiffness over the table's: modulus, form error, and effects that change the elastic response.

use thenar_contact::effects::Effect;

use crate::forward::mesh::nuisance::KNOTS;
use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::mechanism::{DeformationMeasure, Law};
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::forward::tables::elastic_table::{Tabulated, radius, rung};
use crate::interpolation::{interval, mixed};

impl Surrogate<'_> {
    /// Modulus, form and changed response at a depth: force over the table's.
    pub(crate) fn factor(
        &self,
        model: &Model<'_>,
        set: &Setting,
        (place, depth): (usize, f64),
    ) -> f64 {
        let table = &self.elastic.places[place];
        let share = (depth / self.elastic.limit_depth).clamp(0.0, 1.0);
        let modulus = set.first * (1.0 - share) + set.limit * share;
        let mut log = set.scale[place];
        let form = set.form[place].iter().zip(modes(table, depth));
        log += form.map(|(size, mode)| size * mode).sum::<f64>();
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
                _ => {}
            }
        }
        modulus * libm::exp(log)
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

/// Ways in which the model's form may be off at a depth: the whole tool, its tilt and its bend over depth, and first touch.
pub(crate) fn modes(table: &Tabulated, depth: f64) -> [f64; KNOTS] {
    let u = (depth / table.deepest).clamp(0.0, 1.0);
    [
        1.0,
        2.0 * u - 1.0,
        6.0 * u * (u - 1.0) + 1.0,
        libm::exp(-u / FIRST),
    ]
}

/// Part of the deepest depth over which an error at first touch dies away.
const FIRST: f64 = 0.05;
