//! Force prediction of the surrogate: elastic tables, relaxing springs, tissue laws, fixture compliance, and the instrument.
//!
//! It shares tables, noise and priors with the fit, and answers a hundred times faster than a protocol that is followed
//! moment by moment on the skin's mesh.

use std::ops::Range;

use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::force_recording::Row;
use crate::forward::surrogate::mechanism::Law;
use crate::forward::surrogate::relaxing_springs::{SpringHistory, relaxation_loss};
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::observe::measured::Phase;

/// Most rounds in which the force is sought to which a stage yields, the part of the largest force to which it is found, and the largest
/// part of a round's change that the next may be foreseen to make.
const YIELDS: usize = 6;
const FOUND: f64 = 1e-6;
const STIFFEST: f64 = 0.5;

/// Spread of a mean's depths over their mean up to which its force is that at the mean depth: Hertz's differs by 3/8 of the square.
const STRAIGHT: f64 = 0.01;
/// The same from which some of the readings may be above the skin. Below, two points do (Gauss), from there on so many.
const TOUCHING: f64 = 0.4;
const MIDPOINTS: u32 = 12;

/// Midpoint of a part of a straight motion, from its mean, in its standard deviations.
fn midpoint(k: u32) -> f64 {
    let half = 3.0f64.sqrt();
    half * (2.0 * (f64::from(k) + 0.5) / f64::from(MIDPOINTS) - 1.0)
}

/// By row the mean of a force over its readings, which is not that at their mean depth.
pub(crate) fn over_spread(rows: &[Row], depths: &[f64], force: impl Fn(&f64) -> f64) -> Vec<f64> {
    let read = |(d, row): (&f64, &Row)| match row.spread_mm / d.abs() {
        ratio if ratio > TOUCHING => {
            let at = |k: u32| force(&(d + row.spread_mm * midpoint(k)));
            (0..MIDPOINTS).map(at).sum::<f64>() / f64::from(MIDPOINTS)
        }
        ratio if ratio > STRAIGHT => {
            0.5 * (force(&(d - row.spread_mm)) + force(&(d + row.spread_mm)))
        }
        _ => force(d),
    };
    depths.iter().zip(rows).map(read).collect()
}

/// Rows of a recording's stands, in their order.
pub(crate) fn stands(rows: &[Row]) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        match (row.phase, found.last_mut()) {
            (Phase::Hold, Some(last)) if last.end == k => last.end = k + 1,
            (Phase::Hold, _) => found.push(k..k + 1),
            _ => {}
        }
    }
    found
}

/// What a tool at its site answers for the numbers of a model.
struct Answer {
    /// Stiffness of the springs, N/mm.
    springs: Vec<f64>,
    /// Depths at which they touch, mm.
    touches: Vec<f64>,
}

impl Surrogate<'_> {
    /// Forces of one recording's rows, N.
    pub fn forces(&self, model: &Model<'_>, set: &Setting, course: usize) -> Vec<f64> {
        let rows = self.courses[course].rows.iter();
        // Nothing is known where nothing was read yet.
        let known: Vec<f64> = rows.map(|r| f64::max(r.force_n, 0.0)).collect();
        let yields = model.mechanisms.iter().any(|m| m.law == Law::Compliance);
        let mut forces = match yields {
            true => self.with_compliance(model, set, (course, known)),
            false => self.pressed(model, set, (course, &known)),
        };
        self.read(model, set, (course, &mut forces));
        forces
    }

    /// Forces on the tool where the stage yields to them: what is measured is only where the search begins, and a stage that is as soft as
    /// the skin would not let it end by itself (each row is led on by Aitken's rule).
    fn with_compliance(
        &self,
        model: &Model<'_>,
        set: &Setting,
        (course, mut at): (usize, Vec<f64>),
    ) -> Vec<f64> {
        for _ in 0..YIELDS {
            let once = self.pressed(model, set, (course, &at));
            let twice = self.pressed(model, set, (course, &once));
            let mut off = 0.0f64;
            for ((at, once), twice) in at.iter_mut().zip(&once).zip(&twice) {
                let (first, second) = (once - *at, twice - once);
                off = off.max(first.abs());
                let part = match first == 0.0 {
                    true => 0.0,
                    false => (second / first).min(STIFFEST),
                };
                *at += first / (1.0 - part);
            }
            if off < FOUND * self.most.0 {
                break;
            }
        }
        at
    }

    /// Forces on the tool of one recording, where the stage yields to forces that are known.
    fn pressed(
        &self,
        model: &Model<'_>,
        set: &Setting,
        (course, known): (usize, &[f64]),
    ) -> Vec<f64> {
        let one = &self.courses[course];
        let table = &self.elastic.places[one.place];
        let depths = self.depths(model, set, (course, known));
        let elastic = |d: &f64| match *d > 0.0 {
            true => table.force.at(d.sqrt()) * self.factor(model, set, (one.place, *d)),
            false => 0.0,
        };
        let mut forces = over_spread(&one.rows, &depths, elastic);
        let (relaxation_branches, shares) = self.relaxation_branches(model, set, (one, &depths));
        if !relaxation_branches.is_empty() {
            let answer = self.answer(model, set, one.place);
            let way = SpringHistory {
                depths: &depths,
                touches: &answer.touches[..answer.springs.len()],
                relaxation_branches: &relaxation_branches,
                shares: &shares,
            };
            let more = relaxation_loss(&way, &answer.springs);
            forces.iter_mut().zip(more).for_each(|(f, m)| *f += m);
        }
        self.soften_by_use(model, set, ((one, &depths), &mut forces));
        self.adhere(model, set, ((one, &depths), &mut forces));
        forces
    }

    /// True depths of a recording's rows, mm.
    pub(crate) fn depths(
        &self,
        model: &Model<'_>,
        set: &Setting,
        (course, known): (usize, &[f64]),
    ) -> Vec<f64> {
        let one = &self.courses[course];
        let zero = set.zero[course] + set.touch[one.place];
        let mut yields = 0.0;
        for (number, mechanism) in model.mechanisms.iter().enumerate() {
            if mechanism.law == Law::Compliance {
                yields += set.of[number][0];
            }
        }
        let depth = |(row, force): (&Row, &f64)| row.depth_mm - zero - yields * force.max(0.0);
        let mut depths: Vec<f64> = one.rows.iter().zip(known).map(depth).collect();
        if !set.stand[course].is_empty() {
            for (stand, off_mm) in stands(&one.rows).into_iter().zip(&set.stand[course]) {
                depths[stand].iter_mut().for_each(|d| *d += off_mm);
            }
        }
        depths
    }

    fn answer(&self, model: &Model<'_>, set: &Setting, place: usize) -> Answer {
        let table = &self.elastic.places[place];
        let depths: Vec<f64> = table.roots.iter().map(|r| r * r).collect();
        let force = |(d, f): (&f64, &f64)| f * self.factor(model, set, (place, *d));
        let rungs: Vec<f64> = depths.iter().zip(&table.rungs).map(force).collect();
        let secant = |k: usize| (rungs[k + 1] - rungs[k]) / (depths[k + 1] - depths[k]);
        let springs = (0..rungs.len() - 1)
            .map(|k| secant(k) - if k > 0 { secant(k - 1) } else { 0.0 })
            .collect();
        Answer {
            springs,
            touches: depths,
        }
    }

    /// Stacked predictions of all samples; those that are not screened are what was measured.
    pub fn stacked(&self, forces: &[Vec<f64>]) -> Vec<f64> {
        let mut all = self.measured.to_vec();
        for (course, forces) in self.courses.iter().zip(forces) {
            for (row, force) in course.rows.iter().zip(forces) {
                if let Some(sample) = row.sample {
                    all[sample] = *force;
                }
            }
        }
        all
    }

    /// Forces of all recordings.
    pub fn all_forces(&self, model: &Model<'_>, at: &[f64]) -> Vec<Vec<f64>> {
        let set = model.setting(self, at);
        (0..self.courses.len())
            .map(|c| self.forces(model, &set, c))
            .collect()
    }

    /// Phase of every screened sample, and the course it belongs to.
    pub fn phases(&self) -> Vec<(usize, usize, Phase)> {
        let mut all = Vec::new();
        for (c, course) in self.courses.iter().enumerate() {
            all.extend(
                course
                    .rows
                    .iter()
                    .filter_map(|r| r.sample.map(|s| (s, c, r.phase))),
            );
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use crate::parameters::surrogate_parameter::Coordinate;
    use thenar_contact::effects::Effect;

    use super::*;
    use crate::forward::surrogate::mechanism::{Mechanism, Stage};
    use crate::forward::surrogate::prepared_study::PreparedStudy;
    use crate::forward::surrogate::synthetic::{ready, tool};
    use crate::parameters::surrogate_parameter::Kind;

    /// A press at 1 mm/s to 2 mm by a tool of that law; what was read is nothing.
    fn pressed(force: impl Fn(f64) -> f64) -> PreparedStudy {
        pressed_and_read(force, |_| 0.0)
    }

    /// The same with readings by depth.
    fn pressed_and_read(force: impl Fn(f64) -> f64, reading: impl Fn(f64) -> f64) -> PreparedStudy {
        let read = |k: u32| {
            let time = f64::from(k) / 40.0;
            (time, time, Phase::Load, reading(time))
        };
        let readings = (0..=80).map(read).collect();
        ready(vec![tool(2.0, force, |_| 1.0)], &[(0, readings)], 0.1).0
    }

    /// Forces with a mechanism of that size, in tissue as it is.
    fn forces(ready: &PreparedStudy, mechanism: (Effect, Law), size: f64) -> Vec<f64> {
        let surrogate = ready.surrogate();
        let (effect, law) = mechanism;
        let all = [Mechanism { effect, law }];
        let model = Model::new(&surrogate, &all);
        let mut at: Vec<f64> = model.coordinates.iter().map(|c| c.start).collect();
        *at.last_mut().unwrap() = size;
        surrogate.all_forces(&model, &at).concat()
    }

    /// F = k (s - c F), so F = k s / (1 + c k), however soft the stage is against the skin; and for a ball, whose force is put in again.
    #[test]
    fn compliant_fixture_equals_closed_form() {
        let yields = (Effect::FixtureCompliance, Law::Compliance);
        for part in [0.1, 0.5, 0.8] {
            // Of the deepest depth, at the force without.
            let linear = forces(&pressed(|d| 10.0 * d), yields.clone(), 0.1 * part);
            for (k, force) in linear.iter().enumerate() {
                let wanted = 10.0 * k as f64 / 40.0 / (1.0 + part);
                assert!((force - wanted).abs() < 1e-4, "{part}: {force} {wanted}");
            }
            let ball = |d: f64| 10.0 * libm::pow(d, 1.5);
            let compliance = part * 2.0 / ball(2.0);
            let planned = pressed_and_read(ball, |_| f64::NAN);
            for ready in [pressed(ball), planned] {
                let round = forces(&ready, yields.clone(), compliance);
                for (k, force) in round.iter().enumerate() {
                    let wanted = ball(k as f64 / 40.0 - compliance * force);
                    assert!((force - wanted).abs() < 0.01, "{part}: {force} {wanted}");
                }
            }
        }
    }

    /// A ball's force over ten readings each, of which the first begin above the skin.
    #[test]
    fn force_of_a_mean_over_readings_is_the_mean_of_their_forces() {
        let ball = |d: f64| 10.0 * libm::pow(d, 1.5);
        let mut ready = pressed(ball);
        let step = 0.02;
        let spread = step * (99.0f64 / 12.0).sqrt();
        let rows = &mut ready.courses[0].rows;
        rows.truncate(10);
        let mut wanted = Vec::new();
        for (k, row) in rows.iter_mut().enumerate() {
            row.depth_mm = 0.2 * k as f64 - 0.03;
            row.spread_mm = spread;
            let at = |j: u32| row.depth_mm + step * (f64::from(j) - 4.5);
            wanted.push((0..10).map(|j| ball(at(j).max(0.0))).sum::<f64>() / 10.0);
        }
        let nothing = (Effect::FixtureCompliance, Law::Compliance);
        let found = forces(&ready, nothing.clone(), 0.0);
        for (force, wanted) in found.iter().zip(&wanted) {
            assert!((force - wanted).abs() < 0.004, "{force} {wanted}");
        }
        ready.courses[0]
            .rows
            .iter_mut()
            .for_each(|row| row.spread_mm = 0.0);
        let at_mean = forces(&ready, nothing, 0.0);
        assert!((at_mean[1] - wanted[1]).abs() > 0.01, "{at_mean:?}");
    }

    /// The first of two stands is 0.05 mm deeper than it was read.
    #[test]
    fn what_a_stand_is_off_by_moves_its_rows_and_no_other() {
        let mut ready = pressed(|d| 10.0 * d);
        let rows = &mut ready.courses[0].rows;
        for k in (30..40).chain(60..70) {
            rows[k].phase = Phase::Hold;
        }
        assert_eq!(stands(rows), [30..40, 60..70]);
        ready.shared.extend(
            [0.05, 0.0]
                .into_iter()
                .enumerate()
                .map(|(stand, start)| Coordinate {
                    kind: Kind::Stand(0, stand),
                    start,
                    bounds: (-1.0, 1.0),
                    prior: Some(0.1),
                    step: 1e-4,
                }),
        );
        let nothing = (Effect::FixtureCompliance, Law::Compliance);
        for (k, force) in forces(&ready, nothing, 0.0).iter().enumerate() {
            let off = if (30..40).contains(&k) { 0.05 } else { 0.0 };
            let wanted = 10.0 * (k as f64 / 40.0 + off);
            assert!((force - wanted).abs() < 1e-4, "{k}: {force} {wanted}");
        }
    }

    /// Before the gain a ceiling and a floor are the same force in all recordings, after it the same reading.
    #[test]
    fn limits_apply_before_or_after_the_gain() {
        let mut ready = pressed_and_read(|d| 10.0 * d, |_| f64::NAN);
        ready.scales.forces = (20.0, 20.0);
        let gain = 1.25f64;
        ready.shared.push(Coordinate {
            kind: Kind::Gain(0),
            start: gain.ln(),
            bounds: (-1.0, 1.0),
            prior: Some(0.1),
            step: 1e-4,
        });
        for (stage, limit) in [(Stage::First, 8.0 * gain), (Stage::Last, 8.0)] {
            let ceiling = forces(
                &ready,
                (Effect::Saturation, Law::Saturation(stage)),
                f64::ln(8.0 / 20.0),
            );
            let most = ceiling.iter().fold(0.0, |a, b| f64::max(a, *b));
            assert!((most / limit - 1.0).abs() < 1e-6, "{stage:?}: {most}");
            let floor = forces(&ready, (Effect::Threshold, Law::Floor(stage)), 8.0 / 20.0);
            let seen = floor.iter().filter(|f| **f > 0.9 * limit);
            let least = seen.fold(f64::INFINITY, |a, b| a.min(*b));
            assert!((least / limit - 1.0).abs() < 0.06, "{stage:?}: {least}");
        }
    }

    /// A reading beside a floor is off by the force that is lacking, not by all of it: skin that is stiffer or softer than the model.
    #[test]
    fn floor_residual_is_bounded_by_the_missing_force() {
        for stiffer in [1.06, 0.94] {
            let reading = |d: f64| match 10.0 * stiffer * d < 8.0 {
                true => 0.0,
                false => 10.0 * stiffer * d,
            };
            let mut ready = pressed_and_read(|d| 10.0 * d, reading);
            ready.scales.forces = (20.0, 20.0);
            let blind = (Effect::Threshold, Law::Floor(Stage::Last));
            let told = forces(&ready, blind, 8.0 / 20.0);
            let off = told.iter().zip(&ready.courses[0].rows).map(|(f, row)| {
                let same_stiffness = row.force_n / stiffer;
                (f - same_stiffness).abs()
            });
            assert!(
                off.fold(0.0, f64::max) < 1.01 * 8.0 * 0.06 / 0.94,
                "{stiffer}"
            );
            // Well below it nothing is read, well above it all of it.
            assert!(told[20].abs() < 1e-9 && (told[70] - 17.5).abs() < 1e-9);
        }
    }
}
