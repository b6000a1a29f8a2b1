//! Derivatives of the surrogate's forces by its parameters.

use std::cell::OnceCell;

use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::mechanism::{Law, Mechanism};
use crate::forward::surrogate::stiffness_slopes::Stiffness;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::parameters::surrogate_parameter::Kind;

/// Derivatives of one recording's forces at a point.
pub struct Slopes<'a> {
    surrogate: &'a Surrogate<'a>,
    model: &'a Model<'a>,
    at: &'a [f64],
    set: Setting,
    course: usize,
    forces: &'a [f64],
    stiffness: Option<Stiffness>,
    /// By the depth of first touch, be it the tool's or the recording's.
    by_touch: OnceCell<Vec<f64>>,
}

impl<'a> Slopes<'a> {
    /// Of a recording whose forces at the point are known.
    pub fn new(
        surrogate: &'a Surrogate<'a>,
        (model, at): (&'a Model<'a>, &'a [f64]),
        (course, forces): (usize, &'a [f64]),
    ) -> Slopes<'a> {
        let set = model.setting(surrogate, at);
        Slopes {
            stiffness: surrogate.stiffness((model, &set), (course, forces)),
            surrogate,
            model,
            at,
            set,
            course,
            forces,
            by_touch: OnceCell::new(),
        }
    }

    /// By a coordinate, or None where it does not matter.
    pub fn by(&self, number: usize) -> Option<Vec<f64>> {
        let kind = self.model.coordinates[number].kind;
        if !self.surrogate.matters(self.model, kind, self.course) {
            return None;
        }
        if matches!(kind, Kind::Touch(_) | Kind::Zero(_)) {
            return Some(
                self.by_touch
                    .get_or_init(|| self.difference(number))
                    .clone(),
            );
        }
        let point = (self.model, &self.set);
        let all = |is_so: fn(&Mechanism) -> bool| self.model.mechanisms.iter().all(is_so);
        let is_plain = all(|mechanism| !mechanism.is_instrument());
        if matches!(kind, Kind::ForceZero(_)) && is_plain {
            return Some(vec![1.0; self.forces.len()]);
        }
        let zero = self.set.force_zero[self.course];
        let is_proportion = matches!(kind, Kind::Gain(_))
            && (is_plain || (zero == 0.0 && all(Mechanism::is_read_in_proportion)));
        let known = match (&self.stiffness, is_proportion) {
            (_, true) => Some(self.forces.iter().map(|f| f - zero).collect()),
            (Some(of), _) => self
                .surrogate
                .stiffness_slopes(point, (kind, self.course), of),
            _ => None,
        };
        Some(known.unwrap_or_else(|| self.difference(number)))
    }

    /// By a difference of forces, toward the farther bound.
    fn difference(&self, number: usize) -> Vec<f64> {
        let coordinate = &self.model.coordinates[number];
        let (low, high) = coordinate.bounds;
        let step = match high - self.at[number] > self.at[number] - low {
            true => coordinate.step,
            false => -coordinate.step,
        };
        let mut moved = self.at.to_vec();
        moved[number] += step;
        let set = self.model.setting(self.surrogate, &moved);
        let moved = self.surrogate.forces(self.model, &set, self.course);
        let slope = moved.iter().zip(self.forces).map(|(b, a)| (b - a) / step);
        slope.collect()
    }
}

impl Surrogate<'_> {
    /// Whether a recording's forces depend on a number.
    fn matters(&self, model: &Model<'_>, kind: Kind, course: usize) -> bool {
        let one = &self.courses[course];
        match kind {
            Kind::Zero(c) | Kind::Gain(c) | Kind::ForceZero(c) | Kind::Stand(c, _) => c == course,
            Kind::Touch(place) | Kind::Form(place, _) | Kind::Scale(place) => place == one.place,
            Kind::Of(of, _) => match &model.mechanisms[of].law {
                Law::GainStep { from } => one.order >= *from,
                _ => true,
            },
            Kind::SharedForm(site, _) => site == self.elastic.site_of[one.place],
            Kind::First | Kind::Limit => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use thenar_contact::effects::Effect;

    use super::*;
    use crate::forward::surrogate::prepared_study::PreparedStudy;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::forward::tables::form_ways::WAYS;
    use crate::observe::measured::Phase;
    use crate::parameters::priors::SHARED;
    use crate::parameters::surrogate_parameter::Coordinate;
    use crate::selection::candidates::singles;

    /// A ball pressed to 2 mm, read as means, whose every shared number is free.
    fn pressed() -> PreparedStudy {
        let ball = |d: f64| 10.0 * d * d.sqrt();
        let read = |time: f64| -> Reading { (time, time, Phase::Load, 0.9 * ball(time)) };
        let readings = (0..=80).map(|k| read(f64::from(k) / 40.0)).collect();
        let (mut made, _) = ready(vec![tool(2.0, ball, |d| d.sqrt())], &[(0, readings)], 0.1);
        let kinds = [
            Kind::Gain(0),
            Kind::ForceZero(0),
            Kind::Scale(0),
            Kind::Touch(0),
            Kind::Zero(0),
            Kind::Stand(0, 0),
        ];
        for row in &mut made.courses[0].rows {
            row.spread_mm = 0.01;
        }
        for row in &mut made.courses[0].rows[60..] {
            row.phase = Phase::Hold;
        }
        let forms = (0..WAYS).map(|k| Kind::Form(0, k));
        let shared = (0..SHARED).map(|k| Kind::SharedForm(0, k));
        let free = kinds
            .into_iter()
            .chain(forms)
            .chain(shared)
            .map(|kind| Coordinate {
                kind,
                // As large as a quarter of the force, so that a slope that forgets it is seen.
                start: if kind == Kind::ForceZero(0) {
                    5.0
                } else {
                    0.03
                },
                bounds: (-10.0, 10.0),
                prior: Some(0.1),
                step: 1e-5,
            });
        made.shared.extend(free);
        made
    }

    /// Most that slopes by a number are off central differences, over the largest slope.
    fn off(surrogate: &Surrogate<'_>, (model, at): (&Model<'_>, &[f64]), number: usize) -> f64 {
        let beside = |way: f64| {
            let mut moved = at.to_vec();
            moved[number] += way;
            surrogate.all_forces(model, &moved).concat()
        };
        let (low, high) = (beside(-1e-5), beside(1e-5));
        let forces = surrogate.all_forces(model, at).concat();
        let slopes = Slopes::new(surrogate, (model, at), (0, &forces))
            .by(number)
            .expect("slopes");
        let most = slopes.iter().fold(1e-3, |most: f64, s| most.max(s.abs()));
        let ends = low.iter().zip(&high);
        let off = slopes
            .iter()
            .zip(ends)
            .map(|(slope, (a, b))| (slope - (b - a) / 2e-5).abs());
        off.fold(0.0, f64::max) / most
    }

    /// Beside every mechanism that needs neither a table of its own nor a measured shape, and for every shared number: what a fit
    /// steps by is what the forces do.
    #[test]
    fn derivatives_equal_central_differences() {
        let ready = pressed();
        let surrogate = ready.surrogate();
        let mut tried = singles(ready.scales);
        tried.retain(|m| !matches!(m.law, Law::Tabulated(_) | Law::Floor(_)));
        let (effect, law) = (Effect::Gain, Law::GainStep { from: 0 });
        tried.push(Mechanism { effect, law });
        for mechanism in &tried {
            let model = Model::new(&surrogate, std::slice::from_ref(mechanism));
            let mut at: Vec<f64> = model.coordinates.iter().map(|c| c.start).collect();
            at[ready.shared.len()..].iter_mut().for_each(|x| *x += 0.1);
            for number in 0..ready.shared.len() {
                let (off, kind) = (
                    off(&surrogate, (&model, &at), number),
                    model.coordinates[number].kind,
                );
                assert!(off < 2e-2, "{} {kind:?}: {off}", mechanism.effect.name());
            }
        }
    }
}
