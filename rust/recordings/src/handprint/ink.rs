//! Parts ink from paper: Otsu's threshold, which side of it is ink, and what of the image is no paper.

use super::image::Gray;
use super::options::{Ink, PrintOptions};
use crate::fault::Fault;

/// Steps of brightness that are counted.
const STEPS: usize = 1024;
/// Least difference of the mean brightness of ink and paper.
const LEAST_CONTRAST: f64 = 0.08;
/// Part of the variance that the threshold explains, under which ink and paper run into one another: one even spread of brightness has 3/4.
const CLEAR_FROM: f64 = 0.75;
/// Ink along more than this part of the paper's edge may be a frame.
const FRAME_FROM: f64 = 0.1;

/// What is ink and what is paper.
pub struct Parted {
    /// Brightness between ink and paper.
    pub threshold: f64,
    /// Which side of it is ink.
    pub ink: Ink,
    /// By pixel: whether it is paper, inked or not.
    pub is_paper: Vec<bool>,
    /// What a reader should be told.
    pub warnings: Vec<String>,
}

impl Parted {
    /// Whether a brightness is ink.
    pub fn is_ink(&self, brightness: f32) -> bool {
        match self.ink {
            Ink::Dark => f64::from(brightness) < self.threshold,
            Ink::Light => f64::from(brightness) >= self.threshold,
        }
    }
}

/// Parts ink from paper.
///
/// # Errors
/// Paper that lies outside of the image, and ink that does not stand out.
pub fn part(gray: &Gray, options: &PrintOptions) -> Result<Parted, Fault> {
    let is_paper = on_paper(gray, options)?;
    let counts = histogram(gray, &is_paper);
    let threshold = match options.threshold {
        Some(threshold) => threshold,
        None => split(&counts)?,
    };
    let dark = dark_at_edge(gray, &is_paper, threshold);
    let ink = options.ink.unwrap_or(match dark > 0.5 {
        true => Ink::Light,
        false => Ink::Dark,
    });
    let mut warnings = Vec::new();
    let at_edge = match ink {
        Ink::Dark => dark,
        Ink::Light => 1.0 - dark,
    };
    if options.ink.is_none() && ink == Ink::Light {
        warnings.push(
            "most of the paper's edge is dark, so what is light is taken as ink; where that is the scanner's lid or a table, give paper_px or ink = \"dark\"".to_owned(),
        );
    }
    if at_edge > FRAME_FROM {
        warnings.push(format!(
            "ink lies along {:.0} % of the paper's edge; where that is the scanner's lid or a table, give paper_px",
            100.0 * at_edge
        ));
    }
    let share = explained(&counts, threshold);
    if share < CLEAR_FROM {
        warnings.push(format!(
            "ink and paper run into one another: the threshold explains {:.0} % of how brightness varies; look at the outline, and give threshold if it is off",
            100.0 * share
        ));
    }
    Ok(Parted {
        threshold,
        ink,
        is_paper,
        warnings,
    })
}

/// Pixels that are there, and within the paper that the study gives.
fn on_paper(gray: &Gray, options: &PrintOptions) -> Result<Vec<bool>, Fault> {
    let [left, top, right, bottom] =
        options
            .paper_px
            .unwrap_or([0.0, 0.0, gray.size[0] as f64, gray.size[1] as f64]);
    let is_within = |k: usize| {
        let (x, y) = (
            (k % gray.size[0]) as f64 + 0.5,
            (k / gray.size[0]) as f64 + 0.5,
        );
        (left..=right).contains(&x) && (top..=bottom).contains(&y)
    };
    let each = gray.pixels.iter().enumerate();
    let is_paper: Vec<bool> = each.map(|(k, p)| !p.is_nan() && is_within(k)).collect();
    match is_paper.contains(&true) {
        true => Ok(is_paper),
        false => Err(Fault::file(
            format!(
                "no pixel of the {} x {} is paper",
                gray.size[0], gray.size[1]
            ),
            "check paper_px (left, top, right, bottom) and the image's transparency",
        )),
    }
}

/// Otsu's threshold, if what it parts differs enough.
fn split(counts: &[f64]) -> Result<f64, Fault> {
    let threshold = otsu(counts);
    let (dark, light) = means(counts, threshold);
    match light - dark >= LEAST_CONTRAST {
        true => Ok(threshold),
        false => Err(Fault::file(
            "no ink stands out from the paper".into(),
            "scan it with more contrast, or give threshold (0 black to 1 white)",
        )),
    }
}

/// Numbers of paper pixels by brightness.
fn histogram(gray: &Gray, is_paper: &[bool]) -> Vec<f64> {
    let mut counts = vec![0.0; STEPS];
    for (brightness, _) in gray.pixels.iter().zip(is_paper).filter(|(_, is)| **is) {
        let step = (f64::from(*brightness) * STEPS as f64) as usize;
        counts[step.min(STEPS - 1)] += 1.0;
    }
    counts
}

/// Brightness that parts the pixels into the two classes whose means differ most against their spread (Otsu 1979, Eq. 14 and 18); of several that
/// are as good, the middle.
fn otsu(counts: &[f64]) -> f64 {
    let between: Vec<f64> = (1..STEPS).map(|step| between(counts, step)).collect();
    let most = between.iter().copied().fold(0.0, f64::max);
    let best: Vec<usize> = (0..between.len())
        .filter(|k| between[*k] >= most * (1.0 - 1e-12))
        .collect();
    let middle = match (best.first(), best.last()) {
        (Some(first), Some(last)) => 0.5 * (first + last) as f64 + 1.0,
        _ => 0.5 * STEPS as f64,
    };
    middle / STEPS as f64
}

/// Variance between the classes on both sides of a step.
fn between(counts: &[f64], step: usize) -> f64 {
    let sums = |part: &[f64], first: usize| {
        let weighted = part.iter().enumerate();
        (
            part.iter().sum::<f64>(),
            weighted
                .map(|(k, count)| (first + k) as f64 * count)
                .sum::<f64>(),
        )
    };
    let ((below, low), (above, high)) = (sums(&counts[..step], 0), sums(&counts[step..], step));
    if below == 0.0 || above == 0.0 {
        return 0.0;
    }
    below * above / (below + above).powi(2) * (high / above - low / below).powi(2)
}

/// Part of the variance of brightness that lies between the classes.
fn explained(counts: &[f64], threshold: f64) -> f64 {
    let total: f64 = counts.iter().sum();
    let of = |power: i32| {
        let each = counts.iter().enumerate();
        each.map(|(k, count)| (k as f64).powi(power) * count)
            .sum::<f64>()
            / total
    };
    let variance = of(2) - of(1).powi(2);
    let step = ((threshold * STEPS as f64) as usize).clamp(1, STEPS - 1);
    between(counts, step) / variance.max(f64::MIN_POSITIVE)
}

/// Mean brightness below a threshold and above it.
fn means(counts: &[f64], threshold: f64) -> (f64, f64) {
    let mean = |is_below: bool| {
        let (mut sum, mut count) = (0.0, 0.0);
        for (k, pixels) in counts.iter().enumerate() {
            let brightness = (k as f64 + 0.5) / STEPS as f64;
            if (brightness < threshold) == is_below {
                (sum, count) = (sum + brightness * pixels, count + pixels);
            }
        }
        sum / count
    };
    (mean(true), mean(false))
}

/// Part of the paper's edge that is dark.
fn dark_at_edge(gray: &Gray, is_paper: &[bool], threshold: f64) -> f64 {
    let (mut dark, mut all) = (0usize, 0usize);
    for pixel in (0..is_paper.len()).filter(|pixel| is_paper[*pixel]) {
        let beside = neighbors(gray, pixel);
        if beside
            .iter()
            .any(|other| other.is_none_or(|k| !is_paper[k]))
        {
            all += 1;
            dark += usize::from(f64::from(gray.pixels[pixel]) < threshold);
        }
    }
    dark as f64 / all.max(1) as f64
}

fn neighbors(gray: &Gray, pixel: usize) -> [Option<usize>; 4] {
    let [width, height] = gray.size;
    let (x, y) = (pixel % width, pixel / width);
    [
        (x > 0).then(|| pixel - 1),
        (x + 1 < width).then(|| pixel + 1),
        (y > 0).then(|| pixel - width),
        (y + 1 < height).then(|| pixel + width),
    ]
}
