//! What two recordings' waves share, and how far noise could have made it.

use std::collections::{HashMap, HashSet};

use super::waves::Waves;

/// Standard errors of all pairs of recordings over those that are left without the one that shares most, at most.
const OF_ONE: f64 = 2.0;
/// Neighbors each way whose mean square is the variance at a place.
const NEIGHBORS: usize = 5;

/// Sums of one pair of recordings.
pub(super) struct Pair {
    /// Numbers of both.
    of: [usize; 2],
    products: f64,
    /// Variance of that sum where noise knows nothing of each other, nor of itself.
    variance: f64,
    /// Sum of the third powers of what that variance is the sum of squares of.
    cubes: f64,
    /// How many neighbors count as one in what the two do not share, which is noise.
    memory: f64,
    /// Variance if what waves do of themselves is noise that remembers.
    variance_alone: f64,
    /// Sum of the products in N^2, and over the ranges of both recordings' forces.
    pub(super) squares: [f64; 2],
    /// Sum of the products' weights.
    pub(super) weight: f64,
    /// Number of products.
    pub(super) count: usize,
}

impl Pair {
    /// None where the two were hardly read at the same places.
    pub(super) fn of(of: [usize; 2], (a, b): (&Waves, &Waves)) -> Option<Pair> {
        let places = a.same_places(b);
        if places.len() < 2 * a.in_mean.max(b.in_mean) {
            return None;
        }
        let x: Vec<f64> = places.iter().map(|(i, _)| a.force[*i]).collect();
        let y: Vec<f64> = places.iter().map(|(_, j)| b.force[*j]).collect();
        let lags = a.in_mean.max(b.in_mean).min(x.len());
        let off: Vec<f64> = x.iter().zip(&y).map(|(x, y)| x - y).collect();
        let products: f64 = x.iter().zip(&y).map(|(x, y)| x * y).sum();
        let memory = memory((&off, &off), lags);
        let independent: Vec<f64> = powers(&x)
            .iter()
            .zip(powers(&y))
            .map(|(x, y)| x * y)
            .collect();
        let own: f64 = x.iter().zip(&y).map(|(x, y)| (x * y).powi(2)).sum();
        let weight = |(i, j): &(usize, usize)| a.weight[*i] * b.weight[*j];
        let newtons = products * a.deviation_n * b.deviation_n;
        Some(Pair {
            of,
            products,
            variance: independent.iter().sum(),
            cubes: independent
                .iter()
                .map(|square| square * square.sqrt())
                .sum(),
            memory,
            variance_alone: own * memory.max(self::memory((&x, &y), lags)),
            squares: [newtons, newtons / (a.range_n * b.range_n)],
            weight: places.iter().map(weight).sum(),
            count: places.len(),
        })
    }
}

/// Of the sum over all pairs, as those of a normal number that is as unlikely. What hums by itself may be in step in one pair by chance: one alone
/// is held against its own memory, and of several no single one decides.
pub(super) fn standard_errors(pairs: &[Pair]) -> f64 {
    let over = |products: f64, variance: f64| products / variance.max(f64::MIN_POSITIVE).sqrt();
    if let [one] = pairs {
        let variance = one.variance * one.memory;
        return over(one.products, variance.max(one.variance_alone));
    }
    // One pair does not tell well how far its noise remembers.
    let count: usize = pairs.iter().map(|pair| pair.count).sum();
    let memory = pairs
        .iter()
        .map(|pair| pair.memory * pair.count as f64)
        .sum::<f64>()
        / count as f64;
    let variance = |pair: &Pair| pair.variance * pair.memory.max(memory);
    let of = |pair: &Pair| over(pair.products, variance(pair));
    let Some(most) = pairs.iter().max_by(|a, b| of(a).total_cmp(&of(b))) else {
        return 0.0;
    };
    let products: f64 = pairs.iter().map(|pair| pair.products).sum();
    let all: f64 = pairs.iter().map(variance).sum();
    let left = over(products - most.products, all - variance(most));
    let found = over(products, all).min(OF_ONE * left.max(0.0));
    let cubes: f64 = pairs
        .iter()
        .map(|p| p.cubes * p.memory.max(memory).powi(2))
        .sum();
    let third = 6.0 * triangles(pairs) * cubes / pairs.len() as f64;
    let all = all.max(f64::MIN_POSITIVE);
    as_normal(found, third / (all * all.sqrt()))
}

/// Number of triples of recordings of which all three pairs are there: of those the products of three pairs are squares, so that sums are
/// skewed.
fn triangles(pairs: &[Pair]) -> f64 {
    let mut after: HashMap<usize, Vec<usize>> = HashMap::new();
    for pair in pairs {
        after.entry(pair.of[0]).or_default().push(pair.of[1]);
    }
    let all: HashSet<[usize; 2]> = pairs.iter().map(|pair| pair.of).collect();
    let third = |[i, j]: [usize; 2]| {
        let of = after.get(&j).into_iter().flatten();
        of.filter(|k| all.contains(&[i, **k])).count()
    };
    pairs.iter().map(|pair| third(pair.of) as f64).sum()
}

/// The normal number that is as unlikely as one of a gamma law of this skewness, both of mean 0 and variance 1 (Wilson and Hilferty 1931,
/// Proceedings of the National Academy of Sciences 17:684).
fn as_normal(value: f64, skewness: f64) -> f64 {
    if skewness <= 0.0 || value <= 0.0 {
        return value;
    }
    let degrees = 8.0 / (skewness * skewness);
    let part = (1.0 + value * (2.0 / degrees).sqrt()).max(0.0);
    let variance = 2.0 / (9.0 * degrees);
    (libm::cbrt(part) - (1.0 - variance)) / variance.sqrt()
}

/// Mean square of a series about each place.
fn powers(series: &[f64]) -> Vec<f64> {
    let about = |k: usize| {
        let near = &series[k.saturating_sub(NEIGHBORS)..(k + NEIGHBORS + 1).min(series.len())];
        near.iter().map(|x| x * x).sum::<f64>() / near.len() as f64
    };
    (0..series.len()).map(about).collect()
}

/// How many neighbors count as one in a sum of products of two series: 1 and twice the products of their correlations. At so many lags these are all
/// taken; at longer ones, up to half of the series, what they have more than chance gives them, as where a line of one frequency is in both.
fn memory((one, other): (&[f64], &[f64]), lags: usize) -> f64 {
    let sum = |series: &[f64]| {
        series
            .iter()
            .map(|a| a * a)
            .sum::<f64>()
            .max(f64::MIN_POSITIVE)
    };
    let squares = (sum(one), sum(other));
    let at = |series: &[f64], lag: usize| -> f64 {
        let pairs = series[lag..].iter().zip(series);
        pairs.map(|(a, b)| a * b).sum()
    };
    let shared = |lag: usize| at(one, lag) * at(other, lag) / (squares.0 * squares.1);
    let near: f64 = (1..lags.min(one.len())).map(shared).sum();
    let short = 1.0 + 2.0 * near.max(0.0);
    let by_chance = short / one.len().max(1) as f64;
    let far: f64 = (lags..one.len() / 2)
        .map(|lag| shared(lag) - by_chance)
        .sum();
    short + 2.0 * far.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::waves::Waves;
    use super::{Pair, as_normal, standard_errors};

    /// Waves at these places of a way, of a mean of five samples.
    fn waves(way: u32, places: usize) -> Waves {
        Waves {
            at: (0..places).map(|k| (way, 0.1 * k as f64)).collect(),
            force: (0..places).map(|k| (k % 3) as f64 - 1.0).collect(),
            weight: vec![1.0; places],
            in_mean: 5,
            deviation_n: 0.1,
            range_n: 1.0,
        }
    }

    #[test]
    fn recordings_with_few_places_in_common_are_no_pair() {
        let (long, other) = (waves(0, 30), waves(2, 30));
        assert!(Pair::of([0, 1], (&long, &other)).is_none());
        assert!(Pair::of([0, 1], (&long, &waves(0, 9))).is_none());
        let found = Pair::of([0, 1], (&long, &waves(0, 12))).unwrap();
        assert_eq!((found.count, found.products), (12, 8.0));
    }

    /// Two sums of 10, each of variance 100: the one whose noise seems to forget itself has the mean memory, 2, the other its own, 3.
    #[test]
    fn memory_is_at_least_that_of_all_pairs() {
        let pair = |of, memory| Pair {
            of,
            products: 10.0,
            variance: 100.0,
            cubes: 1000.0,
            memory,
            variance_alone: 100.0,
            squares: [0.0; 2],
            weight: 1.0,
            count: 50,
        };
        let found = standard_errors(&[pair([0, 1], 1.0), pair([2, 3], 3.0)]);
        assert!((found - 20.0 / 500f64.sqrt()).abs() < 1e-12, "{found}");
    }

    /// Any table: chi-square of 5 degrees exceeds 11.070 in 5 and 20.515 in 0.1 of 100, a normal number 1.645 and 3.090.
    #[test]
    fn skewed_sums_become_normal_numbers_as_rare() {
        let skewness = (8.0f64 / 5.0).sqrt();
        for (chi_square, normal) in [(11.070, 1.645), (20.515, 3.090)] {
            let found = as_normal((chi_square - 5.0) / 10f64.sqrt(), skewness);
            assert!((found - normal).abs() < 0.04, "{chi_square}: {found}");
        }
        assert_eq!((as_normal(3.0, 0.0), as_normal(-1.0, 2.0)), (3.0, -1.0));
    }
}
