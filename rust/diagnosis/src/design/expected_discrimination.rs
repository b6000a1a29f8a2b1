//! What a recording that is yet to be made promises: how often it would settle between two explanations.
//!
//! Both explanations foretell the recording. What keeps one from imitating the other is the difference that is left once it is
//! fitted anew to all recordings, the new ones among them: to first order a quadratic form of the foretold difference, with the
//! information of what was recorded so far (Gauss-Newton) and the recording's own gain and first touch taken out (Schur
//! complement). If the first explanation is true, the lead of its evidence grows by a normal number of mean `d / 2` and
//! variance `d`, `d` being that squared difference in units of the noise, tempered, since forms are not true. What the
//! recordings leave open of the true one's numbers (`possible.rs`) is open in what it foretells: then it, too, has to be fitted anew,
//! and what that leaves is taken off its lead.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::design::planned_recording::{Fresh, Press, course};
use crate::design::profile_likelihood::Possible;
use crate::distributions::log_normal_cdf;
use crate::forward::surrogate::force_recording::Course;
use crate::forward::surrogate::model::Model;
use crate::forward::surrogate::prepared_study::Prepared;
use crate::forward::surrogate::screen::Screen;
use crate::forward::tables::elastic::Elastic;
use crate::parameters::surrogate_parameter::Coordinate;
use crate::selection::scored::Scored;

/// What a lead that is foretold is divided by: no form is quite true. With it the calibration's studies are settled as often as was
/// foretold, or more.
const UNTRUE: f64 = 1.5;

/// What recordings that are yet to be made come to under either of two explanations.
pub struct Promise {
    /// With the first true, and with the second.
    both: [Foreseen; 2],
    /// Evidence of the first over that of the second, so far.
    lead: f64,
    /// What deviances are divided by.
    temper: f64,
}

/// What comes of an explanation that is true.
struct Foreseen {
    /// How probable each of its possible numbers is.
    shares: Vec<f64>,
    /// What the other explanation leaves of it, and it itself with the numbers that it has so far.
    rival: Squares,
    own: Squares,
}

impl Foreseen {
    /// How often the lead comes to `needed` from `lead`, with deviances over `temper`.
    fn probability(&self, presses: u32, (lead, needed, temper): (f64, f64, f64)) -> Option<f64> {
        let (rival, own) = (self.rival.left(presses)?, self.own.left(presses)?);
        let mut sum = 0.0;
        for (share, (rival, own)) in self.shares.iter().zip(rival.iter().zip(&own)) {
            let spread = (rival + own) / temper;
            let z = (lead + 0.5 * (rival - own) / temper - needed) / spread.max(1e-9).sqrt();
            sum += share * libm::exp(log_normal_cdf(z));
        }
        Some(sum)
    }
}

/// Squares of what a fit is off by on presses made in turn, one for each of what may be true, and of the slopes of what is fitted, in
/// units of the noise.
struct Squares {
    off: Vec<f64>,
    /// By number that is fitted and truth.
    across: DMatrix<f64>,
    slopes: DMatrix<f64>,
    /// What earlier recordings say of what is fitted.
    known: DMatrix<f64>,
}

impl Squares {
    /// What is left of each square if each press is made `presses` times; None if the fit has no answer.
    fn left(&self, presses: u32) -> Option<Vec<f64>> {
        let n = f64::from(presses);
        let across = &self.across * n;
        let taken = (&self.known + &self.slopes * n).cholesky()?.solve(&across);
        let one =
            |(k, off): (usize, &f64)| (n * off - across.column(k).dot(&taken.column(k))).max(0.0);
        Some(self.off.iter().enumerate().map(one).collect())
    }
}

impl Promise {
    /// How often the lead of the true one comes to `needed`, nats, if each press is made that many times.
    pub fn probability(&self, presses: u32, needed: f64) -> Option<f64> {
        let first = 1.0 / (1.0 + libm::exp(-self.lead));
        let temper = self.temper * UNTRUE;
        let of = |k: usize, lead: f64| self.both[k].probability(presses, (lead, needed, temper));
        Some(first * of(0, self.lead)? + (1.0 - first) * of(1, -self.lead)?)
    }
}

/// What is held against each other, and with what.
pub struct Between<'a> {
    /// The recordings so far.
    pub ready: &'a Prepared,
    /// Tables, also of tools that were not used so far.
    pub elastic: &'a Elastic,
    /// Two explanations.
    pub two: [&'a Scored; 2],
    /// What the numbers of each may be.
    pub possible: [Vec<Possible>; 2],
    /// What deviances are divided by.
    pub temper: f64,
}

impl Between<'_> {
    /// What presses that are made in turn promise, each with a tool of its own; None where the earlier recordings leave a fit without an
    /// answer.
    pub fn promise(&self, presses: &[Press]) -> Option<Promise> {
        let ready = self.ready;
        let number = ready.courses.len();
        let (mut courses, mut shared) = (ready.courses.clone(), ready.shared.clone());
        let (mut of_place, mut all_own) = (Vec::new(), Vec::new());
        for (k, press) in presses.iter().enumerate() {
            courses.push(course(press, number + k));
            let which = (press.place, number + k);
            let (place, own) = ready.coordinates_of(self.elastic, which, press.depth_mm);
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
        let new = (number, ready.shared.len(), &of_place[..]);
        let foretold = |k: usize| Foretold::new(&screen, (self.two[k], &self.possible[k]), new);
        let [a, b] = [foretold(0)?, foretold(1)?];
        let noise = |(course, forces): (&Course, &Vec<f64>)| {
            let most = forces.iter().fold(0.0, |m, f| f64::max(m, *f));
            Fresh::new(ready, course, ready.noise_share() * most)
        };
        let noise: Vec<Fresh> = courses[number..]
            .iter()
            .zip(a.forces())
            .map(noise)
            .collect();
        Some(Promise {
            both: [a.beside(&b, &noise), b.beside(&a, &noise)],
            lead: self.two[0].evidence - self.two[1].evidence,
            temper: self.temper,
        })
    }
}

/// An explanation's forces on new recordings, and how they change with what is fitted.
struct Foretold {
    /// By recording, with all that its numbers may be, and how probable these are; the optimum's are the first.
    possible: Vec<(f64, Vec<Vec<f64>>)>,
    /// By recording, slopes by coordinate; and of the recording's own coordinates times what these scatter by.
    slopes: Vec<Vec<Vec<f64>>>,
    own: Vec<Vec<Vec<f64>>>,
    known: DMatrix<f64>,
}

impl Foretold {
    /// On the recordings from number `new` of the screen, whose coordinates stand after the `first` of earlier ones.
    fn new(
        screen: &Screen<'_>,
        (of, possible): (&Scored, &[Possible]),
        (new, first, of_place): (usize, usize, &[Coordinate]),
    ) -> Option<Foretold> {
        let model = Model::new(screen, &of.mechanisms);
        let last = screen.shared.len();
        let longer = |known: &[f64]| {
            let mut at = known[..first].to_vec();
            at.resize(last, 0.0);
            at.extend_from_slice(&known[first..]);
            at
        };
        let forces = |at: &[f64]| -> Vec<Vec<f64>> {
            let set = model.setting(screen, at);
            let all = new..screen.courses.len();
            all.map(|course| screen.forces(&model, &set, course))
                .collect()
        };
        let one = |p: &Possible| (p.share, forces(&longer(&p.at)));
        let possible: Vec<_> = possible.iter().map(one).collect();
        let (at, best) = (longer(&of.refit.at), &possible.first()?.1);
        let own = first + of_place.len()..last;
        let slopes = |(k, forces): (usize, &Vec<f64>)| {
            slopes((screen, &model, &at), (new + k, forces), &own)
        };
        let (slopes, own) = best.iter().enumerate().map(slopes).unzip();
        Some(Foretold {
            possible,
            slopes,
            own,
            known: known(&of.refit.covariance, (first, of_place))?,
        })
    }

    /// At the optimum, by recording.
    fn forces(&self) -> &[Vec<f64>] {
        &self.possible[0].1
    }

    /// What comes if this one is true, of all recordings together.
    fn beside(&self, rival: &Foretold, noise: &[Fresh]) -> Foreseen {
        Foreseen {
            shares: self.possible.iter().map(|(share, _)| *share).collect(),
            rival: rival.squares(&self.possible, noise),
            own: self.squares(&self.possible, noise),
        }
    }

    /// Squares if this one is fitted to each of what may be true.
    fn squares(&self, truths: &[(f64, Vec<Vec<f64>>)], noise: &[Fresh]) -> Squares {
        let (m, n) = (truths.len(), self.known.nrows());
        let mut sum = DMatrix::zeros(m + n, m + n);
        for (course, noise) in noise.iter().enumerate() {
            let off = |(_, forces): &(f64, Vec<Vec<f64>>)| -> Vec<f64> {
                let both = forces[course].iter().zip(&self.forces()[course]);
                both.map(|(a, b)| a - b).collect()
            };
            let off: Vec<Vec<f64>> = truths.iter().map(off).collect();
            let columns = off.iter().chain(&self.slopes[course]);
            sum += noise.square((columns, &self.own[course]));
        }
        Squares {
            off: (0..m).map(|k| sum[(k, k)]).collect(),
            across: sum.view((m, 0), (n, m)).into_owned(),
            slopes: sum.view((m, m), (n, n)).into_owned(),
            known: self.known.clone(),
        }
    }
}

/// Slopes of a recording's forces by all coordinates but the numbers `own`, and by those of `own` that move them, times what these
/// scatter by.
fn slopes(
    (screen, model, at): (&Screen<'_>, &Model<'_>, &[f64]),
    (course, forces): (usize, &[f64]),
    own: &Range<usize>,
) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let (mut shared, mut others) = (Vec::new(), Vec::new());
    for (number, coordinate) in model.coordinates.iter().enumerate() {
        let found = screen.slopes((model, at), (number, course), forces);
        if !own.contains(&number) {
            shared.push(found.unwrap_or_else(|| vec![0.0; forces.len()]));
        } else if let Some(slope) = found {
            let sd = coordinate.prior.unwrap_or(0.0);
            others.push(slope.iter().map(|s| s * sd).collect());
        }
    }
    (shared, others)
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
    use nalgebra::DVector;

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
        let foretold = Foretold {
            possible: vec![(1.0, vec![vec![0.0; rows]])],
            slopes: vec![slopes.clone()],
            own: vec![owns.clone()],
            known: known.clone(),
        };
        let nothing = vec![0.0; rows];
        let truths = [nothing, off.clone()].map(|forces| (0.5, vec![forces]));
        let squares = foretold.squares(&truths, &[noise]);
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
        assert_eq!(said[0], 0.0);
        assert!((said[1] - left).abs() < 1e-9 * left, "{} {left}", said[1]);
    }

    /// A lead that grows by a normal number of mean d / 2 and variance d.
    #[test]
    fn the_probability_is_that_of_the_lead() {
        let plain = |off: &[f64]| Squares {
            off: off.to_vec(),
            across: DMatrix::zeros(1, off.len()),
            slopes: DMatrix::zeros(1, 1),
            known: DMatrix::identity(1, 1),
        };
        let foreseen = |shares: &[f64], rival: &[f64], own: &[f64]| Foreseen {
            shares: shares.to_vec(),
            rival: plain(rival),
            own: plain(own),
        };
        let four = 4.0 * UNTRUE;
        let promise = |lead: f64| Promise {
            both: [(); 2].map(|()| foreseen(&[1.0], &[four], &[0.0])),
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
            both: [(); 2].map(|()| foreseen(&[1.0], &[0.0], &[0.0])),
            ..promise(0.0)
        };
        assert!(never.probability(12, 4.0).unwrap() < 1e-9);
        // Numbers that are open: half of the time as above, half of the time as much as the rival leaves is left by the true one itself.
        let open = Promise {
            both: [(); 2].map(|()| foreseen(&[0.5, 0.5], &[four, four], &[0.0, four])),
            ..promise(0.0)
        };
        // Then the lead stays 0 on average, and 4 is one deviation, 4, away: 15.87 % of cases.
        let both = open.probability(2, 4.0).unwrap();
        assert!((both - 0.5 * (0.5 + 0.158_66)).abs() < 1e-4, "{both}");
    }
}
