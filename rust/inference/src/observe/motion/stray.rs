//! Single readings of a depth that are astray: off from those before and after them, where the force does not follow.
//!
//! A fit must not take one for a movement: to a depth that was not reached the model predicts a force that was not there, and what flattens the force,
//! such as a ceiling, then fits better than the truth.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::observe::motion::rounding::step_of;
use crate::observe::motion::stiffness::slopes;
use crate::observe::protocol_phases::{Courses, range, stretches};
use crate::observe::robust_scale::{median_deviation, noise_of};

/// Standard deviations of the bends' noise, steps to which the depth is rounded, and parts of its range: from the largest of which a reading may be
/// astray, and to which bends are explained.
const ASTRAY: [f64; 3] = [8.0, 3.0, 0.01];
const EXPLAINED: [f64; 3] = [4.0, 1.0, 0.002];
/// Readings before and after one whose bends it has to explain.
const REACH: usize = 2;
/// Part of what a movement would do to the force, and standard deviations of the force's noise that this must reach, from which it was one.
const FOLLOWS: (f64, f64) = (0.5, 6.0);
/// Part of all readings up to which they are astray: more of them are another noise.
const FEW: f64 = 0.1;

/// Depths without readings that are astray.
pub(crate) struct WithoutStrays {
    /// mm; without what readings are off by, as those before and after have it.
    pub(crate) depth_mm: Vec<f64>,
    /// How many were astray.
    pub(crate) count: usize,
    /// By how much at most, mm.
    pub(crate) most_mm: f64,
}

/// Takes readings that are astray off the depths of a course; None where there are none.
pub(crate) fn without_strays(courses: Courses<'_>) -> Option<WithoutStrays> {
    let Courses {
        time_s: time,
        depth_mm: depth,
        force_n: force,
        ..
    } = courses;
    let n = depth.len();
    if n < 8 {
        return None;
    }
    let seen = seen(time, depth);
    if seen.is_empty() || seen.len() as f64 > FEW * n as f64 {
        return None;
    }
    let repaired = repaired(depth, &seen);
    let courses = Courses {
        depth_mm: &repaired,
        ..courses
    };
    let slope = slopes((time, &repaired, force), &stretches(courses));
    let noise_n = noise_of(force);
    let is_movement = |one: &Stray| {
        let (line, pushed) = pushed(time, force, one.reading, &seen);
        // A tool that lifts takes no more of the force than there was.
        let most = if one.off < 0.0 {
            line.max(0.0)
        } else {
            f64::INFINITY
        };
        let expected = (slope[one.reading] * one.off.abs()).min(most);
        let followed = pushed * one.off.signum();
        let is_clear = |force: f64| force > FOLLOWS.1 * noise_n;
        is_clear(followed) || (is_clear(expected) && followed > FOLLOWS.0 * expected)
    };
    let astray: Vec<Stray> = seen
        .iter()
        .copied()
        .filter(|one| !is_movement(one))
        .collect();
    let sizes = astray.iter().map(|one| one.off.abs());
    let most_mm = sizes.fold(0.0, f64::max);
    (!astray.is_empty()).then(|| WithoutStrays {
        depth_mm: self::repaired(depth, &astray),
        count: astray.len(),
        most_mm,
    })
}

/// A reading that is off, and by how much.
#[derive(Debug, Clone, Copy)]
struct Stray {
    reading: usize,
    off: f64,
}

/// A series without what readings are off by.
fn repaired(series: &[f64], astray: &[Stray]) -> Vec<f64> {
    let mut repaired = series.to_vec();
    astray
        .iter()
        .for_each(|one| repaired[one.reading] -= one.off);
    repaired
}

/// The force on the line between the nearest before and after whose depths are not astray, and by how much it is off.
fn pushed(time: &[f64], force: &[f64], k: usize, astray: &[Stray]) -> (f64, f64) {
    let is_sound = |j: &usize| astray.iter().all(|one| one.reading != *j);
    let before = (0..k).rev().find(is_sound);
    let after = (k + 1..force.len()).find(is_sound);
    before.zip(after).map_or((force[k], 0.0), |(a, b)| {
        let part = (time[k] - time[a]) / (time[b] - time[a]);
        let line = force[a] + part * (force[b] - force[a]);
        (line, force[k] - line)
    })
}

/// Readings that seem astray.
///
/// One that is off bends the series before it, in it and behind it. With a corner of the motion, or another reading that is off, this has to explain
/// all that the bends nearby show, better than any other reading does; a corner alone must not.
fn seen(time: &[f64], depth: &[f64]) -> Vec<Stray> {
    let bends: Vec<f64> = (1..depth.len() - 1).map(|k| bend(time, depth, k)).collect();
    let noise = median_deviation(&mut bends.iter().map(|b| b.abs()).collect::<Vec<f64>>());
    let (low, high) = range(depth);
    let largest = |of: [f64; 3]| {
        let sizes = [of[0] * noise, of[1] * step_of(depth), of[2] * (high - low)];
        sizes.into_iter().fold(0.0, f64::max)
    };
    let (least, most) = (largest(ASTRAY), largest(EXPLAINED));
    if least <= 0.0 {
        return Vec::new();
    }
    let stray = |k: usize| {
        let near = k.saturating_sub(REACH).max(1)..(k + REACH + 1).min(depth.len() - 1);
        // An error bends the series by a half of it or more.
        if near.clone().all(|j| bends[j - 1].abs() < 0.25 * least) {
            return None;
        }
        let own = k - near.start;
        let bends = Bends::new(time, &bends, near);
        let (off, left) = bends.best(own, least);
        if left > most {
            return None;
        }
        let mut others = (0..bends.errors.len()).filter(|at| *at != own);
        let is_best = others.all(|at| left <= bends.best(at, 0.0).1 + 1e-9 * most);
        let is_astray = is_best && bends.left_by_a_corner() > most;
        is_astray.then_some(Stray { reading: k, off })
    };
    (2..depth.len() - 2).filter_map(stray).collect()
}

/// The bends of some readings, and what may have made them.
struct Bends {
    seen: DVector<f64>,
    /// By reading, what an error of 1 in it does.
    errors: Vec<DVector<f64>>,
    /// By reading, what a corner of the motion in it does.
    corners: Vec<DVector<f64>>,
}

impl Bends {
    fn new(time: &[f64], bends: &[f64], near: Range<usize>) -> Bends {
        let vector =
            |of: &dyn Fn(usize) -> f64| DVector::from_iterator(near.len(), near.clone().map(of));
        let each = |of: &dyn Fn(usize, usize) -> f64| -> Vec<DVector<f64>> {
            let one = |at: usize| vector(&|k| of(at, k));
            near.clone().map(one).collect()
        };
        Bends {
            seen: vector(&|k| bends[k - 1]),
            errors: each(&|at, k| bent_by(time, at, k)),
            corners: each(&|at, k| if k == at { 1.0 } else { 0.0 }),
        }
    }

    /// By how much a reading is off in the best explanation in which that is `size` at least, and what this leaves.
    fn best(&self, at: usize, size: f64) -> (f64, f64) {
        let own = &self.errors[at];
        let errors = self.errors.iter().enumerate();
        let others = errors.filter(|(other, _)| *other != at);
        let others = others.map(|(_, error)| error).chain(&self.corners);
        let both = others.map(|other| fitted(&self.seen, &[own, other]));
        let all = both.chain([fitted(&self.seen, &[own])]);
        let large = all.filter(|(off, _)| off.abs() >= size);
        large.fold((0.0, f64::INFINITY), |best, one| {
            if one.1 < best.1 { one } else { best }
        })
    }

    /// What the best corner leaves.
    fn left_by_a_corner(&self) -> f64 {
        let each = self.corners.iter();
        let left = each.map(|corner| fitted(&self.seen, &[corner]).1);
        left.fold(f64::INFINITY, f64::min)
    }
}

/// How much of the first column is in a vector, by least squares, and the largest of what all columns leave of it.
fn fitted(vector: &DVector<f64>, columns: &[&DVector<f64>]) -> (f64, f64) {
    let columns = DMatrix::from_fn(vector.len(), columns.len(), |j, c| columns[c][j]);
    let gram = columns.transpose() * &columns;
    match gram.try_inverse() {
        Some(inverse) => {
            let found = inverse * columns.transpose() * vector;
            (found[0], (vector - columns * &found).amax())
        }
        None => (0.0, f64::INFINITY),
    }
}

/// How far a reading is off the line between those before and after it.
fn bend(time: &[f64], series: &[f64], k: usize) -> f64 {
    let part = part(time, k);
    series[k] - (1.0 - part) * series[k - 1] - part * series[k + 1]
}

/// What an error of 1 in a reading adds to the bend in another.
fn bent_by(time: &[f64], error: usize, k: usize) -> f64 {
    if error == k {
        1.0
    } else if error == k + 1 {
        -part(time, k)
    } else if error + 1 == k {
        part(time, k) - 1.0
    } else {
        0.0
    }
}

/// How far a reading lies on the way from the one before to the one after, in time.
fn part(time: &[f64], k: usize) -> f64 {
    (time[k] - time[k - 1]) / (time[k + 1] - time[k - 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// A ball pressed in 25 readings, held and lifted: true depths, times, and forces at depths.
    fn press() -> (Vec<f64>, Vec<f64>) {
        let knots = [
            (0.0, -0.15),
            (1.2, 1.1),
            (5.2, 1.1),
            (6.4, -0.15),
            (7.4, -0.15),
        ];
        let counts = [25, 16, 16, 16];
        let mut time = Vec::new();
        for (k, count) in counts.into_iter().enumerate() {
            let (from, to) = (knots[k].0, knots[k + 1].0);
            time.extend((0..count).map(|j| from + (to - from) * f64::from(j) / f64::from(count)));
        }
        let at = |t: &f64| {
            let leg = knots.windows(2).find(|leg| *t < leg[1].0).unwrap();
            leg[0].1 + (leg[1].1 - leg[0].1) * (t - leg[0].0) / (leg[1].0 - leg[0].0)
        };
        let depth = time.iter().map(at).collect();
        (time, depth)
    }

    fn forces(depth: &[f64], random: &mut Random) -> Vec<f64> {
        let one = |d: &f64| 0.2 * d.max(0.0).powf(1.5) + 0.003 * random.normal();
        depth.iter().map(one).collect()
    }

    fn found(time: &[f64], read: &[f64], force: &[f64]) -> Option<WithoutStrays> {
        without_strays(Courses {
            time_s: time,
            depth_mm: read,
            force_n: force,
            slide_mm: &[],
        })
    }

    /// Three readings off by 0.1 mm in noise of 2 um, at any places: nearly all are found, and all else stays as it was read.
    #[test]
    fn readings_off_by_themselves_are_found() {
        let (time, truth) = press();
        let (mut all, mut missed) = (0, 0);
        for seed in 1..41 {
            let mut random = Random::new(seed);
            let force = forces(&truth, &mut random);
            // A stage that reads without noise, to the digits of a file, or with some.
            let noise = [0.0, 0.002][seed as usize % 2];
            let noisy = truth.iter().map(|d| d + noise * random.normal());
            let clean: Vec<f64> = noisy.map(|d| (1e5 * d).round() / 1e5).collect();
            assert!(found(&time, &clean, &force).is_none());
            let mut read = clean.clone();
            let mut places: Vec<usize> = (0..3)
                .map(|_| 2 + (random.uniform() * (time.len() - 4) as f64) as usize)
                .collect();
            places.sort_unstable();
            places.dedup();
            for k in &places {
                read[*k] += if random.uniform() < 0.5 { 0.1 } else { -0.1 };
            }
            all += places.len();
            let Some(repaired) = found(&time, &read, &force) else {
                missed += places.len();
                continue;
            };
            assert!(
                (repaired.most_mm - 0.1).abs() < 0.02,
                "{}",
                repaired.most_mm
            );
            for (k, clean) in clean.iter().enumerate() {
                let off = (repaired.depth_mm[k] - clean).abs();
                match places.contains(&k) {
                    true if off > 0.09 => missed += 1,
                    true => assert!(off < 0.02, "{off}"),
                    false => assert_eq!(off, 0.0),
                }
            }
        }
        assert!(missed * 20 < all, "{missed} of {all}");
    }

    /// A stage that jumps for one reading takes the force along. Too many are no single readings, and a corner is none.
    #[test]
    fn movements_stay() {
        let (time, truth) = press();
        let mut random = Random::new(3);
        let mut moved = truth.clone();
        for k in [20, 30, 36] {
            moved[k] += 0.1;
        }
        let force = forces(&moved, &mut random);
        assert!(found(&time, &moved, &force).is_none(), "the force follows");
        let still = forces(&truth, &mut random);
        assert_eq!(found(&time, &moved, &still).unwrap().count, 3);
        // Taps of one reading with nothing before and after, and a lift that loses the contact.
        let taps = |apart: f64, tap: f64| -> Vec<f64> {
            let is_tap = |k: usize| [20, 40, 41, 60].contains(&k);
            (0..time.len())
                .map(|k| if is_tap(k) { tap } else { apart })
                .collect()
        };
        for (apart, tap) in [(-0.1, 0.5), (0.3, -0.4)] {
            let moved = taps(apart, tap);
            let force = forces(&moved, &mut random);
            assert!(found(&time, &moved, &force).is_none(), "{tap}");
            assert_eq!(
                found(&time, &moved, &forces(&taps(apart, apart), &mut random))
                    .unwrap()
                    .count,
                4
            );
        }
        let mut often = truth.clone();
        for k in (4..70).step_by(4) {
            often[k] += 0.1;
        }
        assert!(found(&time, &often, &still).is_none(), "too many");
        let strokes: Vec<f64> = (0..time.len())
            .map(|k| f64::from([0, 1, 2, 1][k % 4]))
            .collect();
        assert!(found(&time, &strokes, &still).is_none(), "corners");
    }
}
