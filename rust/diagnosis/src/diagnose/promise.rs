//! What a recording that is yet to be made promises: how often it would settle between two explanations.
//!
//! Both explanations foretell the recording. What keeps one from imitating the other is the difference that is left once it is
//! fitted anew to all recordings, the new ones among them: to first order a quadratic form of the foretold difference, with the
//! information of what was recorded so far (Gauss-Newton) and the recording's own gain and first touch taken out (Schur
//! complement). If the first explanation is true, the lead of its evidence grows by a normal number of mean `d / 2` and
//! variance `d`, `d` being that squared difference in units of the noise, tempered as all evidence that becomes a probability is.

use nalgebra::{DMatrix, DVector};

use super::course::Course;
use super::elastic::Elastic;
use super::ladder::Scored;
use super::model::{Coordinate, Model};
use super::planned::{Fresh, Press, course};
use super::posterior::TEMPERATURE;
use super::prepare::Prepared;
use super::screen::Screen;
use crate::statistics::log_normal_cdf;
use thenar_recordings::Study;

/// What the difference of two explanations on a new recording comes to.
pub struct Promise {
    /// With the first true and the second fitted, and the other way round.
    both: [Squares; 2],
    /// Evidence of the first over that of the second, so far.
    lead: f64,
    /// What deviances are divided by.
    temper: f64,
}

/// Squares of the foretold difference of presses made in turn, and of the slopes of what is fitted, in units of the noise.
struct Squares {
    difference: f64,
    across: DVector<f64>,
    slopes: DMatrix<f64>,
    /// What earlier recordings say of what is fitted.
    known: DMatrix<f64>,
}

impl Squares {
    /// Squared difference that is left if each is made `presses` times; None if the fit has no answer.
    fn left(&self, presses: u32) -> Option<f64> {
        let n = f64::from(presses);
        let across = &self.across * n;
        let factor = (&self.known + &self.slopes * n).cholesky()?;
        Some((n * self.difference - across.dot(&factor.solve(&across))).max(0.0))
    }
}

impl Promise {
    /// How often the lead of the true one comes to `needed`, nats, if each press is made that many times.
    pub fn probability(&self, presses: u32, needed: f64) -> Option<f64> {
        let first = 1.0 / (1.0 + libm::exp(-self.lead / TEMPERATURE));
        let mut sum = 0.0;
        for (squares, (share, lead)) in self
            .both
            .iter()
            .zip([(first, self.lead), (1.0 - first, -self.lead)])
        {
            let left = squares.left(presses)? / (self.temper * TEMPERATURE);
            let z = (lead + 0.5 * left - needed) / left.max(1e-9).sqrt();
            sum += share * libm::exp(log_normal_cdf(z));
        }
        Some(sum)
    }
}

/// What is held against each other, and with what.
pub struct Between<'a> {
    /// The recordings so far.
    pub ready: &'a Prepared,
    /// The study.
    pub study: &'a Study,
    /// Tables, also of tools that were not used so far.
    pub elastic: &'a Elastic,
    /// Two explanations.
    pub two: [&'a Scored; 2],
    /// What deviances are divided by.
    pub temper: f64,
}

impl Between<'_> {
    /// What presses that are made in turn promise, at most one of them with a tool that was not used so far; None where the earlier
    /// recordings leave a fit without an answer.
    pub fn promise(&self, presses: &[Press]) -> Option<Promise> {
        let ready = self.ready;
        let number = ready.courses.len();
        let (mut courses, mut shared) = (ready.courses.clone(), ready.shared.clone());
        let (mut of_place, mut all_own) = (Vec::new(), Vec::new());
        for (k, press) in presses.iter().enumerate() {
            courses.push(course(press, number + k));
            let which = (press.place, number + k);
            let (place, own) = ready.coordinates_of(self.study, which, press.depth_mm);
            of_place.extend(place);
            all_own.extend(own);
        }
        shared.extend_from_slice(&of_place);
        shared.extend(all_own);
        let screen = Screen {
            courses: &courses,
            elastic: self.elastic,
            shared,
            ..ready.screen()
        };
        let foretold = |of: &Scored| Foretold::new(&screen, of, (number, &ready.shared, &of_place));
        let [a, b] = [foretold(self.two[0])?, foretold(self.two[1])?];
        let noise = |(course, forces): (&Course, &Vec<f64>)| {
            let most = forces.iter().fold(0.0, |m, f| f64::max(m, *f));
            Fresh::new(ready, course, ready.noise_share() * most)
        };
        let noise: Vec<Fresh> = courses[number..].iter().zip(&a.forces).map(noise).collect();
        Some(Promise {
            both: [a.squares(&b, &noise), b.squares(&a, &noise)],
            lead: self.two[0].evidence - self.two[1].evidence,
            temper: self.temper,
        })
    }
}

/// An explanation's forces on new recordings, and how they change with what is fitted.
struct Foretold {
    /// By recording.
    forces: Vec<Vec<f64>>,
    /// By recording, slopes by coordinate; and of the recording's own coordinates times what these scatter by.
    slopes: Vec<Vec<Vec<f64>>>,
    own: Vec<Vec<Vec<f64>>>,
    known: DMatrix<f64>,
}

impl Foretold {
    fn new(
        screen: &Screen<'_>,
        of: &Scored,
        (new, before, of_place): (usize, &[Coordinate], &[Coordinate]),
    ) -> Option<Foretold> {
        let model = Model::new(screen, &of.mechanisms);
        let (first, last) = (before.len(), screen.shared.len());
        let mut at = of.refit.at[..first].to_vec();
        at.resize(last, 0.0);
        at.extend_from_slice(&of.refit.at[first..]);
        let set = model.setting(screen, &at);
        let mut all = Foretold {
            forces: Vec::new(),
            slopes: Vec::new(),
            own: Vec::new(),
            known: known(&of.refit.covariance, (first, of_place))?,
        };
        let own = first + of_place.len()..last;
        for course in new..screen.courses.len() {
            let forces = screen.forces(&model, &set, course);
            let (mut slopes, mut others) = (Vec::new(), Vec::new());
            for (number, coordinate) in model.coordinates.iter().enumerate() {
                let found = screen.slopes((&model, &at), (number, course), &forces);
                if !own.contains(&number) {
                    slopes.push(found.unwrap_or_else(|| vec![0.0; forces.len()]));
                } else if let Some(slope) = found {
                    let sd = coordinate.prior.unwrap_or(0.0);
                    others.push(slope.iter().map(|s| s * sd).collect());
                }
            }
            all.forces.push(forces);
            all.slopes.push(slopes);
            all.own.push(others);
        }
        Some(all)
    }

    /// Squares if this one is true and `other` is fitted, of all recordings together.
    fn squares(&self, other: &Foretold, noise: &[Fresh]) -> Squares {
        let n = other.known.nrows();
        let mut sum = DMatrix::zeros(n + 1, n + 1);
        for (course, noise) in noise.iter().enumerate() {
            let both = self.forces[course].iter().zip(&other.forces[course]);
            let off: Vec<f64> = both.map(|(a, b)| a - b).collect();
            let columns = std::iter::once(&off).chain(&other.slopes[course]);
            sum += noise.square((columns, &other.own[course]));
        }
        Squares {
            difference: sum[(0, 0)],
            across: sum.view((1, 0), (n, 1)).column(0).into_owned(),
            slopes: sum.view((1, 1), (n, n)).into_owned(),
            known: other.known.clone(),
        }
    }
}

/// Information that the earlier recordings hold, with that of a new tool's coordinates after the `first` shared ones.
fn known(
    covariance: &DMatrix<f64>,
    (first, of_place): (usize, &[Coordinate]),
) -> Option<DMatrix<f64>> {
    let mut matrix = covariance.clone().cholesky()?.inverse();
    matrix = matrix.insert_rows(first, of_place.len(), 0.0);
    matrix = matrix.insert_columns(first, of_place.len(), 0.0);
    for (k, coordinate) in of_place.iter().enumerate() {
        let sd = coordinate.prior.unwrap_or(1.0);
        matrix[(first + k, first + k)] = 1.0 / (sd * sd);
    }
    Some(matrix)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Presses stacked with a gain and touch each, fitted by least squares: what is left is what the quadratic form says.
    #[test]
    fn what_is_left_is_what_a_fit_to_all_presses_leaves() {
        let (rows, fitted, own, presses) = (30, 4, 2, 5);
        let mut random = Random::new(7);
        let mut column = || -> Vec<f64> { (0..rows).map(|_| random.uniform() - 0.5).collect() };
        let off = column();
        let slopes: Vec<Vec<f64>> = (0..fitted).map(|_| column()).collect();
        let owns: Vec<Vec<f64>> = (0..own).map(|_| column()).collect();
        let known = DMatrix::from_diagonal(&DVector::from_vec(vec![0.3, 1.0, 2.0, 5.0]));
        let noise = Fresh::white(0.1, rows);
        let sum = noise.square((std::iter::once(&off).chain(&slopes), &owns));
        let squares = Squares {
            difference: sum[(0, 0)],
            across: sum.view((1, 0), (fitted, 1)).column(0).into_owned(),
            slopes: sum.view((1, 1), (fitted, fitted)).into_owned(),
            known: known.clone(),
        };
        let width = fitted + own * presses;
        let mut stacked = DMatrix::zeros(rows * presses + width, width);
        let mut side = DVector::zeros(rows * presses + width);
        for press in 0..presses {
            for row in 0..rows {
                let at = press * rows + row;
                side[at] = off[row] / 0.1;
                for (k, slope) in slopes.iter().enumerate() {
                    stacked[(at, k)] = slope[row] / 0.1;
                }
                for (k, own_slope) in owns.iter().enumerate() {
                    stacked[(at, fitted + own * press + k)] = own_slope[row] / 0.1;
                }
            }
        }
        for k in 0..width {
            let root = if k < fitted {
                known[(k, k)].sqrt()
            } else {
                1.0
            };
            stacked[(rows * presses + k, k)] = root;
        }
        let fit = stacked.clone().svd(true, true).solve(&side, 1e-14).unwrap();
        let left = (&side - &stacked * fit).norm_squared();
        let said = squares.left(presses as u32).unwrap();
        assert!((said - left).abs() < 1e-9 * left, "{said} {left}");
    }

    /// A lead that grows by a normal number of mean d / 2 and variance d.
    #[test]
    fn the_probability_is_that_of_the_lead() {
        let plain = |difference: f64| Squares {
            difference,
            across: DVector::zeros(1),
            slopes: DMatrix::zeros(1, 1),
            known: DMatrix::identity(1, 1),
        };
        let promise = |lead: f64| Promise {
            both: [plain(4.0 * TEMPERATURE), plain(4.0 * TEMPERATURE)],
            lead,
            temper: 1.0,
        };
        let even = promise(0.0).probability(2, 4.0).unwrap();
        assert!(
            (even - 0.5).abs() < 1e-6,
            "d = 8 leads by 4 on average: {even}"
        );
        // Twelve presses: d = 48, mean 24, deviation 6.93; a normal number above (4 - 24) / 6.93 = -2.887 in 99.805 % of cases.
        let sure = promise(0.0).probability(12, 4.0).unwrap();
        assert!((sure - 0.998_05).abs() < 2e-5, "{sure}");
        let never = Promise {
            both: [plain(0.0), plain(0.0)],
            ..promise(0.0)
        };
        assert!(never.probability(12, 4.0).unwrap() < 1e-9);
    }
}
