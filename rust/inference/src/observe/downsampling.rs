//! Downsampling of long recordings by means over stretches; turning points are kept.

use std::ops::Range;

use crate::observe::protocol_phases::{Courses, Stretch, range};

/// Bins of samples to be averaged, at most half more than `budget` (one a stretch where there are more), none across the border of two
/// stretches.
///
/// A recording that is not much longer keeps every sample: bins of one and of two samples would fall on other moments in each of its
/// repeats, and about turning points these would seem to differ. Else bins are of equal length along the curve in time, depth and force, each
/// relative to its range: ramps and holds are both kept, and a bin holds little curvature.
pub fn bins(courses: Courses<'_>, stretches: &[Stretch], budget: usize) -> Vec<Range<usize>> {
    let n = courses.time_s.len();
    if is_kept_whole(n, budget) {
        return (0..n).map(|k| k..k + 1).collect();
    }
    let length = lengths(courses);
    let whole = length[n - 1].max(f64::MIN_POSITIVE);
    let mut bins = Vec::new();
    for stretch in stretches {
        let (first, last) = (stretch.start, stretch.end);
        let own = length[last - 1] - length[first];
        let wanted = (budget as f64 * own / whole).round() as usize;
        let wanted = wanted.clamp(1, last - first);
        let mut start = first;
        for bin in 1..=wanted {
            let until = length[first] + own * bin as f64 / wanted as f64;
            let mut end = start + 1;
            while end < last && (length[end] < until || bin == wanted) {
                end += 1;
            }
            if start < last {
                bins.push(start..end);
            }
            start = end;
        }
    }
    bins
}

/// Whether a recording of so many samples keeps every one.
pub(crate) fn is_kept_whole(samples: usize, budget: usize) -> bool {
    samples <= budget + budget / 2
}

/// Length along the curve up to each sample; each of time, depth and force counts relative to its range.
///
/// Force and depth are taken as means over some samples, else noise would be the greater part of the length.
fn lengths(courses: Courses<'_>) -> Vec<f64> {
    let n = courses.time_s.len();
    let stride = (n / 400).max(1);
    let scaled = |values: &[f64]| -> Vec<f64> {
        let (low, high) = range(values);
        let scale = if high > low { 1.0 / (high - low) } else { 0.0 };
        let blocks = values.chunks(stride);
        blocks
            .map(|block| scale * block.iter().sum::<f64>() / block.len() as f64)
            .collect()
    };
    let lists = [courses.time_s, courses.depth_mm, courses.force_n].map(scaled);
    let mut length = vec![0.0; n];
    for k in 1..n {
        let (block, within) = (k / stride, stride.min(n - (k / stride) * stride));
        let next = (block + 1).min(lists[0].len() - 1);
        let step = |list: &Vec<f64>| (list[next] - list[block]) / within as f64;
        let square: f64 = lists.iter().map(|list| step(list).powi(2)).sum();
        length[k] = length[k - 1] + square.sqrt();
    }
    length
}

/// Mean of a channel over each bin.
pub fn means(values: &[f64], bins: &[Range<usize>]) -> Vec<f64> {
    let mean = |bin: &Range<usize>| values[bin.clone()].iter().sum::<f64>() / bin.len() as f64;
    bins.iter().map(mean).collect()
}

/// Standard deviation of a channel over a bin, as of its straight line over time: what a reading jitters by is none of it.
pub fn spread((time_s, values): (&[f64], &[f64]), bin: &Range<usize>) -> f64 {
    let n = bin.len() as f64;
    let mean = |of: &[f64]| of[bin.clone()].iter().sum::<f64>() / n;
    let (time, value) = (mean(time_s), mean(values));
    let (mut square, mut product) = (0.0, 0.0);
    for k in bin.clone() {
        let off = time_s[k] - time;
        square += off * off;
        product += off * (values[k] - value);
    }
    match square > 0.0 {
        true => product.abs() / (square * n).sqrt(),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::protocol_phases::stretches;

    #[test]
    fn every_sample_is_in_one_bin_and_ramps_and_holds_are_both_kept() {
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 1e-3).collect();
        let depth: Vec<f64> = time.iter().map(|t| t.min(1.0) * 2.0).collect();
        let force: Vec<f64> = depth.iter().map(|d| d.powf(1.5)).collect();
        let courses = Courses {
            time_s: &time,
            depth_mm: &depth,
            force_n: &force,
            slide_mm: &[],
        };
        let bins = bins(courses, &stretches(courses), 90);
        assert!((80..100).contains(&bins.len()), "{}", bins.len());
        assert_eq!(bins[0].start, 0);
        assert_eq!(bins[bins.len() - 1].end, 20_000);
        assert!(bins.windows(2).all(|w| w[0].end == w[1].start));
        let in_ramp = bins.iter().filter(|bin| bin.end <= 1000).count();
        assert!(in_ramp > 30 && in_ramp < 65, "{in_ramp}");
    }

    /// Of n even steps: their length times the root of (n^2 - 1) / 12; what a reading jitters by across a straight motion is none of it.
    #[test]
    fn spread_is_that_of_the_straight_motion() {
        let time: Vec<f64> = (0..40).map(|k| 0.01 * f64::from(k)).collect();
        let bin = 10..20;
        let wanted = 0.05 * (99.0f64 / 12.0).sqrt();
        let moved = |jitter: f64| -> Vec<f64> {
            let at = |k: u32| -0.05 * f64::from(k) + jitter * f64::from(k % 2);
            (0..40).map(at).collect()
        };
        assert!((spread((&time, &moved(0.0)), &bin) - wanted).abs() < 1e-12);
        assert!((spread((&time, &moved(0.02)), &bin) / wanted - 1.0).abs() < 0.02);
        assert!(spread((&time, &vec![0.3; 40]), &bin) < 1e-12);
        assert_eq!(spread((&time, &moved(0.02)), &(3..4)), 0.0);
    }

    /// Between once and one and a half times the budget some bins would hold one sample and some two.
    #[test]
    fn a_recording_that_is_not_much_longer_keeps_every_sample() {
        let bins_of = |count: usize| {
            let time: Vec<f64> = (0..count).map(|k| k as f64 * 0.01).collect();
            let courses = Courses {
                time_s: &time,
                depth_mm: &time,
                force_n: &time,
                slide_mm: &[],
            };
            bins(courses, &stretches(courses), 100)
        };
        assert_eq!(bins_of(150).len(), 150);
        assert!((80..=110).contains(&bins_of(151).len()));
    }
}
