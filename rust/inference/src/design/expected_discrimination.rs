//! Expected discrimination of a planned recording between two models (Box and Hill 1967): how often it would settle between them.
//!
//! Both explanations predict the recording. What keeps one from imitating the other is the difference that is left once it is
//! refitted to all recordings, the new ones among them: to first order a quadratic form of the predicted difference, with the
//! information of what was recorded so far (Gauss-Newton) and the recording's own gain, first touch and zero taken out (Schur
//! complement). If the first explanation is true, the lead of its evidence grows by a normal number of mean `d / 2` and
//! variance `d`, `d` being that squared difference in units of the noise, tempered, since forms are not true. What the
//! recordings leave open of the true one's numbers (`profile_likelihood.rs`) is open in what it predicts: then it, too, has to be refitted,
//! and what that leaves is taken off its lead.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::design::planned_recording::{Press, RecordingNoise, course};
use crate::design::profile_likelihood::ProfilePoint;
use crate::distributions::log_normal_cdf;
use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::derivatives::Slopes;
use crate::forward::surrogate::force_recording::ForceRecording;
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::forward::tables::elastic::Elastic;
use crate::parameters::surrogate_parameter::Coordinate;
use crate::selection::scored::Scored;

/// What a lead that is predicted is divided by: no form is quite true. With it the calibration's studies are settled as often as was
/// predicted, or more.
const UNTRUE: f64 = 1.5;

/// What recordings that are yet to be made come to under either of two explanations.
pub struct Discrimination {
    /// With the first true, and with the second.
    both: [Outcome; 2],
    /// Evidence of the first over that of the second, so far.
    lead: f64,
    /// Overdispersion, by which deviances are divided.
    overdispersion: f64,
}

/// What comes of an explanation that is true.
struct Outcome {
    /// How probable each of its possible numbers is.
    shares: Vec<f64>,
    /// What the other explanation leaves of it, and it itself with the numbers that it has so far.
    rival: Squares,
    own: Squares,
}

impl Outcome {
    /// How often the lead comes to `needed` from `lead`, with deviances over `overdispersion`.
    fn probability(
        &self,
        presses: u32,
        (lead, needed, overdispersion): (f64, f64, f64),
    ) -> Option<f64> {
        let (rival, own) = (self.rival.left(presses)?, self.own.left(presses)?);
        let mut sum = 0.0;
        for (share, (rival, own)) in self.shares.iter().zip(rival.iter().zip(&own)) {
            let spread = (rival + own) / overdispersion;
            let z =
                (lead + 0.5 * (rival - own) / overdispersion - needed) / spread.max(1e-9).sqrt();
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

impl Discrimination {
    /// How often the lead of the true one comes to `needed`, nats, if each press is made that many times.
    pub fn probability(&self, presses: u32, needed: f64) -> Option<f64> {
        let first = 1.0 / (1.0 + libm::exp(-self.lead));
        let overdispersion = self.overdispersion * UNTRUE;
        let of =
            |k: usize, lead: f64| self.both[k].probability(presses, (lead, needed, overdispersion));
        Some(first * of(0, self.lead)? + (1.0 - first) * of(1, -self.lead)?)
    }
}

/// What is held against each other, and with what.
pub struct ModelPair<'a> {
    /// The recordings so far.
    pub ready: &'a PreparedStudy,
    /// Tables, also of tools that were not used so far.
    pub elastic: &'a Elastic,
    /// Two explanations.
    pub two: [&'a Scored; 2],
    /// What the numbers of each may be.
    pub profile: [Vec<ProfilePoint>; 2],
    /// Overdispersion, by which deviances are divided.
    pub overdispersion: f64,
}

impl ModelPair<'_> {
    /// What presses that are made in turn promise, each with a tool of its own; None where the earlier recordings leave a fit without an
    /// answer.
    pub fn discrimination(&self, presses: &[Press]) -> Option<Discrimination> {
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
        let surrogate = Surrogate {
            courses: &courses,
            elastic: self.elastic,
            shared,
            ..ready.surrogate()
        };
        let new = (number, ready.shared.len(), &of_place[..]);
        let predicted =
            |k: usize| PredictedRecordings::new(&surrogate, (self.two[k], &self.profile[k]), new);
        let [a, b] = [predicted(0)?, predicted(1)?];
        let noise = |(course, forces): (&ForceRecording, &Vec<f64>)| {
            let most = forces.iter().fold(0.0, |m, f| f64::max(m, *f));
            RecordingNoise::new(ready, course, ready.noise_share() * most)
        };
        let noise: Vec<RecordingNoise> = courses[number..]
            .iter()
            .zip(a.forces())
            .map(noise)
            .collect();
        Some(Discrimination {
            both: [a.beside(&b, &noise), b.beside(&a, &noise)],
            lead: self.two[0].qaic_gain - self.two[1].qaic_gain,
            overdispersion: self.overdispersion,
        })
    }
}

/// An explanation's forces on new recordings, and how they change with what is fitted.
struct PredictedRecordings {
    /// By recording, with all that its numbers may be, and how probable these are; the optimum's are the first.
    profile: Vec<(f64, Vec<Vec<f64>>)>,
    /// By recording, slopes by coordinate; and of the recording's own coordinates times what these scatter by.
    slopes: Vec<Vec<Vec<f64>>>,
    own: Vec<Vec<Vec<f64>>>,
    known: DMatrix<f64>,
}

impl PredictedRecordings {
    /// On the recordings from number `new` of the screen, whose coordinates stand after the `first` of earlier ones.
    fn new(
        surrogate: &Surrogate<'_>,
        (of, profile): (&Scored, &[ProfilePoint]),
        (new, first, of_place): (usize, usize, &[Coordinate]),
    ) -> Option<PredictedRecordings> {
        let model = Model::new(surrogate, &of.mechanisms);
        let last = surrogate.shared.len();
        let longer = |known: &[f64]| {
            let mut at = known[..first].to_vec();
            at.resize(last, 0.0);
            at.extend_from_slice(&known[first..]);
            at
        };
        let forces = |at: &[f64]| -> Vec<Vec<f64>> {
            let set = model.setting(surrogate, at);
            let all = new..surrogate.courses.len();
            all.map(|course| surrogate.forces(&model, &set, course))
                .collect()
        };
        let one = |p: &ProfilePoint| (p.share, forces(&longer(&p.at)));
        let profile: Vec<_> = profile.iter().map(one).collect();
        let (at, best) = (longer(&of.refit.at), &profile.first()?.1);
        let own = first + of_place.len()..last;
        let slopes = |(k, forces): (usize, &Vec<f64>)| {
            slopes((surrogate, &model, &at), (new + k, forces), &own)
        };
        let (slopes, own) = best.iter().enumerate().map(slopes).unzip();
        Some(PredictedRecordings {
            profile,
            slopes,
            own,
            known: known(&of.refit.covariance, (first, of_place))?,
        })
    }

    /// At the optimum, by recording.
    fn forces(&self) -> &[Vec<f64>] {
        &self.profile[0].1
    }

    /// What comes if this one is true, of all recordings together.
    fn beside(&self, rival: &PredictedRecordings, noise: &[RecordingNoise]) -> Outcome {
        Outcome {
            shares: self.profile.iter().map(|(share, _)| *share).collect(),
            rival: rival.squares(&self.profile, noise),
            own: self.squares(&self.profile, noise),
        }
    }

    /// Squares if this one is fitted to each of what may be true.
    fn squares(&self, truths: &[(f64, Vec<Vec<f64>>)], noise: &[RecordingNoise]) -> Squares {
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
    (surrogate, model, at): (&Surrogate<'_>, &Model<'_>, &[f64]),
    (course, forces): (usize, &[f64]),
    own: &Range<usize>,
) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let (mut shared, mut others) = (Vec::new(), Vec::new());
    let of = Slopes::new(surrogate, (model, at), (course, forces));
    for (number, coordinate) in model.coordinates.iter().enumerate() {
        let found = of.by(number);
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
    fn expected_misfit_equals_refit_of_all_presses() {
        let (rows, fitted, own, presses) = (30, 4, 2, 5);
        let mut random = Random::new(7);
        let mut column = || -> Vec<f64> { (0..rows).map(|_| random.uniform() - 0.5).collect() };
        let off = column();
        let slopes: Vec<Vec<f64>> = (0..fitted).map(|_| column()).collect();
        let owns: Vec<Vec<f64>> = (0..own).map(|_| column()).collect();
        let known = DMatrix::from_diagonal(&DVector::from_vec(vec![0.3, 1.0, 2.0, 5.0]));
        let noise = RecordingNoise::white(0.1, rows);
        let predicted = PredictedRecordings {
            profile: vec![(1.0, vec![vec![0.0; rows]])],
            slopes: vec![slopes.clone()],
            own: vec![owns.clone()],
            known: known.clone(),
        };
        let nothing = vec![0.0; rows];
        let truths = [nothing, off.clone()].map(|forces| (0.5, vec![forces]));
        let squares = predicted.squares(&truths, &[noise]);
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
    fn discrimination_probability_is_normal_in_the_lead() {
        let plain = |off: &[f64]| Squares {
            off: off.to_vec(),
            across: DMatrix::zeros(1, off.len()),
            slopes: DMatrix::zeros(1, 1),
            known: DMatrix::identity(1, 1),
        };
        let foreseen = |shares: &[f64], rival: &[f64], own: &[f64]| Outcome {
            shares: shares.to_vec(),
            rival: plain(rival),
            own: plain(own),
        };
        let four = 4.0 * UNTRUE;
        let discrimination = |lead: f64| Discrimination {
            both: [(); 2].map(|()| foreseen(&[1.0], &[four], &[0.0])),
            lead,
            overdispersion: 1.0,
        };
        let even = discrimination(0.0).probability(2, 4.0).unwrap();
        assert!(
            (even - 0.5).abs() < 1e-6,
            "d = 8 leads by 4 on average: {even}"
        );
        // Twelve presses: d = 48, mean 24, deviation 6.93; a normal number above (4 - 24) / 6.93 = -2.887 in 99.805 % of cases.
        let sure = discrimination(0.0).probability(12, 4.0).unwrap();
        assert!((sure - 0.998_05).abs() < 2e-5, "{sure}");
        let never = Discrimination {
            both: [(); 2].map(|()| foreseen(&[1.0], &[0.0], &[0.0])),
            ..discrimination(0.0)
        };
        assert!(never.probability(12, 4.0).unwrap() < 1e-9);
        // Numbers that are open: half of the time as above, half of the time as much as the rival leaves is left by the true one itself.
        let open = Discrimination {
            both: [(); 2].map(|()| foreseen(&[0.5, 0.5], &[four, four], &[0.0, four])),
            ..discrimination(0.0)
        };
        // Then the lead stays 0 on average, and 4 is one deviation, 4, away: 15.87 % of cases.
        let both = open.probability(2, 4.0).unwrap();
        assert!((both - 0.5 * (0.5 + 0.158_66)).abs() < 1e-4, "{both}");
    }
}
