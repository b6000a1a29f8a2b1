//! Sentences of a comparison, for the study and for each recording. Knows nothing of how a report looks.

use crate::comparison::quantities::{Kind, Measure};
use crate::comparison::result::{RecordingComparison, Series};
use crate::comparison::trends::{Bin, SIGNIFICANT, Trend, Variable};
use crate::location::locate::MODEL_ERROR;
use crate::location::mismatch::Location;
use crate::parameter_words::at_bounds;
use thenar_inference::fit::result::Fit;
use thenar_inference::number_format::{chance, number, percent};

/// The recordings of which something is left.
fn left_of(count: usize) -> String {
    match count {
        1 => "Parameters within their bounds".into(),
        _ => format!("Parameters within their bounds, fitted to all {count} recordings,"),
    }
}

/// Said where nothing was located though more than noise is left: the simulation's own error is allowed for then, as locating does.
fn within_the_model(all: &str, p: f64) -> String {
    format!(
        "{all} leave more than noise alone does ({}), but no place or time stands out once the simulation may be off by smooth factors and \
         by {} of the largest value, as finite elements show of it: smaller differences cannot be called real.",
        chance(p),
        percent(MODEL_ERROR)
    )
}

/// About the whole study.
pub(crate) fn of_study(
    recordings: &[RecordingComparison],
    fit: &Fit,
    location: Option<&Location>,
) -> String {
    let compared: Vec<_> = recordings
        .iter()
        .filter(|recording| has_values(recording) && recording.print.is_none())
        .collect();
    let count = compared.len();
    let prints = of_prints(recordings);
    let (all, are) = match count {
        0 if !prints.is_empty() => return prints.trim_start().to_string(),
        0 => return "No recording of this study can be compared with a simulation.".into(),
        1 => ("The recording".to_string(), "is"),
        _ => (format!("All {count} recordings"), "are"),
    };
    let mut text = match fit.lack_of_fit_p {
        Some(p) if p >= SIGNIFICANT => {
            format!(
                "{all} {are} explained by parameters within their bounds: what is left is no more than noise ({}).",
                chance(p)
            )
        }
        Some(p) => {
            let telling = compared
                .iter()
                .filter(|recording| strongest(recording).is_some());
            let worst = telling.min_by(|a, b| least_p(a).total_cmp(&least_p(b)));
            let start = format!(
                "Parameters within their bounds do not explain the recordings: noise alone leaves as much with {}.",
                chance(p)
            );
            let named = worst.map_or_else(String::new, |worst| format!(" {}", named(worst)));
            match location {
                Some(found) if !found.mismatches.is_empty() => {
                    format!("{start} {}", found.sentence)
                }
                // Places on the skin are no looks of its: what a scan leaves is not judged by it.
                Some(_) if !compared.iter().any(|recording| recording.scan.is_some()) => {
                    within_the_model(&left_of(count), p)
                }
                _ => start + &named,
            }
        }
        None => {
            let subject = match count {
                1 => "One recording was".to_string(),
                _ => format!("{count} recordings were"),
            };
            let worst = compared
                .iter()
                .max_by(|a, b| relative_rest(a).total_cmp(&relative_rest(b)));
            let start = format!(
                "{subject} compared; without repeats of two protocols nobody can say whether a difference is more than noise."
            );
            match worst {
                Some(worst) => format!("{start} {}", named(worst)),
                None => start,
            }
        }
    };
    text += &at_bounds(&fit.estimates);
    text + &prints
}

/// Of every handprint, by how much it overlaps; they take no part in the fit, and so none in what it leaves.
fn of_prints(recordings: &[RecordingComparison]) -> String {
    let told = |recording: &RecordingComparison| {
        let print = recording.print.as_ref()?;
        let overlap = find(recording, "overlap")?;
        let mirrored = if print.is_mirrored {
            ", and better mirrored"
        } else {
            ""
        };
        Some(format!(
            " The handprint \u{201c}{}\u{201d} overlaps with simulated contact by {}{mirrored}.",
            recording.name,
            percent(overlap.after)
        ))
    };
    recordings.iter().filter_map(told).collect()
}

/// A recording's sentence with its name in front.
fn named(recording: &RecordingComparison) -> String {
    match recording.name.is_empty() {
        true => recording.sentence.clone(),
        false => format!(
            "In \u{201c}{}\u{201d}: {}",
            recording.name,
            lowered(&recording.sentence)
        ),
    }
}

fn lowered(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_lowercase().collect::<String>() + letters.as_str()
    })
}

fn has_values(recording: &RecordingComparison) -> bool {
    !recording.series.is_empty() || !recording.frames.is_empty() || !recording.measures.is_empty()
}

/// About one recording.
pub(crate) fn of_recording(recording: &RecordingComparison) -> String {
    if !has_values(recording) {
        let reason = recording.unknown.first();
        let reason = reason.map_or("it has no values".to_string(), |text| lowered(text));
        return format!(
            "Nothing of it can be compared: {}.",
            reason.trim_end_matches('.')
        );
    }
    if let Some(print) = &recording.print {
        return crate::prints::measures::sentence(print, &recording.measures);
    }
    let mut text = match strongest(recording) {
        Some((trend, bin)) => departs(recording, trend, bin),
        None => rest(recording),
    };
    if let Some(overlap) = find(recording, "overlap") {
        text += &on_mat(recording, overlap);
    }
    text
}

/// The range whose mean differs most surely; of those about as sure, what an engineer can act on comes before coordinates.
fn strongest(recording: &RecordingComparison) -> Option<(&Trend, &Bin)> {
    let all = || {
        let trends = recording.trends.iter();
        trends
            .flat_map(|trend| trend.bins.iter().map(move |bin| (trend, bin)))
            .filter(|(_, bin)| bin.stands_out())
    };
    let most = all()
        .map(|(_, bin)| bin.standard_errors())
        .fold(0.0, f64::max);
    all()
        .filter(|(_, bin)| bin.standard_errors() >= 0.8 * most)
        .min_by_key(|(trend, bin)| (rank(trend.variable), -(1e3 * bin.standard_errors()) as i64))
}

fn rank(variable: Variable) -> u8 {
    match variable {
        Variable::Phase => 0,
        Variable::Time | Variable::Depth => 1,
        Variable::Cycle | Variable::Rate => 2,
        Variable::SensorRow | Variable::SensorColumn => 3,
        Variable::Skin(_) => 4,
    }
}

fn least_p(recording: &RecordingComparison) -> f64 {
    -strongest(recording).map_or(0.0, |(_, bin)| bin.standard_errors())
}

fn departs(recording: &RecordingComparison, trend: &Trend, bin: &Bin) -> String {
    let unit = trend.kind.unit(recording.is_calibrated);
    let side = if bin.mean > 0.0 { "above" } else { "below" };
    let size = number(bin.mean.abs());
    let looks: usize = recording.trends.iter().map(|trend| trend.bins.len()).sum();
    let sure = match recording.is_noise_told {
        true => format!(
            "{} standard errors of the noise apart ({} after {looks} looks)",
            number(bin.standard_errors()),
            chance(bin.p)
        ),
        false => format!(
            "{} times what the recording's own roughness leaves; no repeats tell the noise",
            number(bin.standard_errors())
        ),
    };
    let share = largest(recording, trend.kind).map(|largest| bin.mean.abs() / largest);
    let part = share.map_or_else(String::new, |share| {
        format!(" ({} of the largest)", percent(share))
    });
    // Sure of the noise is not sure of the physics: the study's sentence calls as much no finding.
    let caution = match share {
        Some(share) if share < MODEL_ERROR => {
            format!(
                "; the simulation itself may be off by {}",
                percent(MODEL_ERROR)
            )
        }
        _ => String::new(),
    };
    format!(
        "Measured {} lies {size} {unit}{part} {side} the simulation {}, {sure}{caution}.",
        trend.kind.label().to_lowercase(),
        place(trend.variable, bin),
    )
}

fn largest(recording: &RecordingComparison, kind: Kind) -> Option<f64> {
    let frames = || recording.frames.iter().flat_map(|frame| &frame.measured);
    let values: Vec<f64> = match kind {
        Kind::Pressure => frames().copied().collect(),
        kind => {
            let name = kind.name(recording.is_calibrated);
            let series = recording.series.iter().find(|series| series.name == name)?;
            series.measured.clone()
        }
    };
    let largest = values.into_iter().fold(0.0, f64::max);
    (largest > 0.0).then_some(largest)
}

fn place(variable: Variable, bin: &Bin) -> String {
    let [low, high] = bin.range.map(number);
    match variable {
        Variable::Phase => format!("in the phase \u{201c}{}\u{201d}", bin.label),
        Variable::Cycle => format!("in cycle {}", bin.label),
        Variable::Time if low == high => format!("at {low} s"),
        Variable::Time => format!("from {low} to {high} s"),
        Variable::Depth if low == high => format!("at a depth of {low} mm"),
        Variable::Depth => format!("at a depth of {low} to {high} mm"),
        Variable::Rate => format!("at a rate of {low} to {high} mm/s"),
        Variable::SensorRow if low == high => format!("in row {low} of the mat"),
        Variable::SensorRow => format!("in rows {low} to {high} of the mat"),
        Variable::SensorColumn if low == high => format!("in column {low} of the mat"),
        Variable::SensorColumn => format!("in columns {low} to {high} of the mat"),
        Variable::Skin(axis) => {
            let axis = ["x", "y", "z"][axis.min(2)];
            format!("where {axis} of the skin is {low} to {high} mm")
        }
    }
}

/// What is left where nothing stands out.
fn rest(recording: &RecordingComparison) -> String {
    let (what, left, noise, unit) = match main(recording) {
        Some(series) => {
            let what = series.label.to_lowercase();
            (what, rms(series), root_mean(&series.sigma), series.unit)
        }
        None => match find(recording, "scan_rms_residual_mm") {
            Some(row) => (
                "the scanned surface".to_string(),
                row.after,
                row.noise,
                "mm",
            ),
            None => return "Simulation and recording were compared by shape.".into(),
        },
    };
    let share = main(recording).and_then(|series| {
        let largest = series.measured.iter().copied().fold(0.0, f64::max);
        (largest > 0.0).then(|| format!(", {} of the largest", percent(rms(series) / largest)))
    });
    let share = share.unwrap_or_default();
    match recording.has_noise {
        true if !recording.is_noise_told => format!(
            "Measured and simulated {what} differ by {} {unit} rms{share}; no repeats tell the noise.",
            number(left)
        ),
        true if left > 1.5 * noise => format!(
            "Measured and simulated {what} differ by {} {unit} rms{share}, {} times the noise, and no range of time, depth or place stands out.",
            number(left),
            number(left / noise)
        ),
        true => format!(
            "Simulation and recording agree within the noise: {what} differs by {} {unit} rms{share}; the noise is {} {unit}.",
            number(left),
            number(noise)
        ),
        false => {
            let rms = if recording.moments.len() > 1 {
                " rms"
            } else {
                ""
            };
            format!(
                "Measured and simulated {what} differ by {} {unit}{rms}{share}; the noise is not known.",
                number(left)
            )
        }
    }
}

fn on_mat(recording: &RecordingComparison, overlap: &Measure) -> String {
    let mut text = format!(
        " In the {}, the areas of contact overlap by {}",
        overlap.of,
        percent(overlap.after)
    );
    if let Some(peak) = find(recording, "peak_kpa") {
        text += &format!(
            "; the peak is {} kPa measured and {} kPa simulated",
            number(peak.measured),
            number(peak.after)
        );
    }
    if !recording.is_calibrated {
        text += "; the mat is not calibrated, so only the shape is compared";
    }
    text + "."
}

fn main(recording: &RecordingComparison) -> Option<&Series> {
    let named = |name: &str| recording.series.iter().find(|series| series.name == name);
    named("force_n")
        .or_else(|| named("mat_force_n"))
        .or_else(|| recording.series.first())
}

fn find<'r>(recording: &'r RecordingComparison, name: &str) -> Option<&'r Measure> {
    recording
        .measures
        .iter()
        .find(|measure| measure.name == name)
}

fn rms(series: &Series) -> f64 {
    let squares = series.measured.iter().zip(&series.simulated);
    (squares.map(|(m, s)| (m - s).powi(2)).sum::<f64>() / series.measured.len() as f64).sqrt()
}

fn root_mean(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

fn relative_rest(recording: &RecordingComparison) -> f64 {
    main(recording).map_or(0.0, |series| {
        let largest = series.measured.iter().copied().fold(0.0, f64::max);
        if largest > 0.0 {
            rms(series) / largest
        } else {
            0.0
        }
    })
}
