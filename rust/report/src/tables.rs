//! Tables of the page: estimates, measures, largest residuals.

use std::fmt::Write;

use crate::plots::trend_bars;
use crate::svg::escaped;
use thenar_comparison::PrintRegion;
use thenar_comparison::Printed;
use thenar_comparison::{Comparison, RecordingComparison};
use thenar_comparison::{Measure, WorstPlace};
use thenar_inference::number_format::{capital, number, percent};
use thenar_inference::parameters::estimate::Estimate;
use thenar_inference::parameters::target::Target;

/// A table of rows; columns are numbers unless their head begins with `<`.
fn table(heads: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let rows: String = rows.map(|row| row_of(heads, &row)).collect();
    format!("{}{rows}</tbody></table>\n", head(heads))
}

fn head(heads: &[&str]) -> String {
    let cell = |head: &&str| match head.strip_prefix('<') {
        Some(head) => format!("<th class='left'>{head}</th>"),
        None => format!("<th>{head}</th>"),
    };
    let cells: String = heads.iter().map(cell).collect();
    format!("<table><thead><tr>{cells}</tr></thead><tbody>\n")
}

fn row_of(heads: &[&str], cells: &[String]) -> String {
    let mut html = String::from("<tr>");
    for (cell, head) in cells.iter().zip(heads) {
        let class = if head.starts_with('<') {
            " class='left'"
        } else {
            ""
        };
        let _ = write!(html, "<td{class}>{cell}</td>");
    }
    html + "</tr>\n"
}

/// Every recording in a row.
pub fn overview(comparison: &Comparison) -> String {
    let heads = ["<Recording", "<Tool", "<Place", "<In a sentence"];
    let row = |(k, recording): (usize, &RecordingComparison)| {
        vec![
            format!("<a href='#recording-{k}'>{}</a>", escaped(&recording.name)),
            escaped(&recording.indenter),
            escaped(&recording.site),
            escaped(&recording.sentence),
        ]
    };
    table(&heads, comparison.recordings.iter().enumerate().map(row))
}

/// Fitted numbers with their intervals.
pub fn estimates(estimates: &[Estimate]) -> String {
    let heads = [
        "<Number",
        "<Of",
        "Start",
        "Estimate",
        "90 % interval",
        "Admissible",
        "<",
    ];
    let row = |estimate: &Estimate| {
        let target = match &estimate.target {
            Target::Region(name) => format!("region {name}"),
            Target::Recording(name) => name.clone(),
            Target::Instrument => "instrument".to_string(),
        };
        let (low, high) = estimate.bounds;
        let range = |low: f64, high: f64| format!("{} \u{2026} {}", number(low), number(high));
        let flag = if estimate.is_at_bound {
            " <span class='flag'>at its bound</span>"
        } else {
            ""
        };
        vec![
            format!("<code>{}</code>", escaped(&estimate.name)),
            escaped(&target),
            number(estimate.start),
            format!("<b>{}</b>{flag}", number(estimate.value)),
            range(estimate.low, estimate.high),
            range(low, high),
            trend_bars::estimate(estimate),
        ]
    };
    table(&heads, estimates.iter().map(row))
}

/// Measures of a recording, before and after the fit, under a line for the whole and for every frame.
pub fn measures(rows: &[Measure]) -> String {
    let is_fitted = rows.iter().any(|measure| !measure.before.is_nan());
    let mut heads = vec!["<Measure", "Measured", "Noise \u{00b1}"];
    heads.extend(match is_fitted {
        true => &["Simulated, at the start", "Simulated, fitted", "<Unit"][..],
        false => &["Simulated", "<Unit"][..],
    });
    let mut html = String::new();
    for (k, measure) in rows.iter().enumerate() {
        if k == 0 || rows[k - 1].of != measure.of {
            let _ = writeln!(
                html,
                "<tr class='group'><td class='left' colspan='{}'>{}</td></tr>",
                heads.len(),
                escaped(&capital(measure.of))
            );
        }
        let is_share = measure.name.starts_with("overlap");
        let told = |value: f64| {
            if is_share {
                percent(value)
            } else {
                number(value)
            }
        };
        let mut cells = vec![
            escaped(measure.label),
            told(measure.measured),
            told(measure.noise),
            format!("<b>{}</b>", told(measure.after)),
            measure.unit.to_string(),
        ];
        if is_fitted {
            cells.insert(3, told(measure.before));
        }
        html += &row_of(&heads, &cells);
    }
    format!("{}{html}</tbody></table>\n", head(&heads))
}

/// Contact of a print by region of the skin.
pub fn print_regions(print: &Printed) -> String {
    let heads = ["<Region", "Inked, mm²", "Simulated, mm²", "Overlap"];
    let row = |region: &PrintRegion| {
        vec![
            escaped(&region.name),
            number(region.recorded_mm2),
            number(region.simulated_mm2),
            format!("<b>{}</b>", percent(region.overlap)),
        ]
    };
    table(&heads, print.regions.iter().map(row))
}

/// Worst places of a recording.
pub fn worst(recording: &RecordingComparison) -> String {
    if recording.print.is_some() {
        return patches(&recording.worst);
    }
    let heads = [
        "<What",
        "<Where",
        "Time, s",
        "Depth, mm",
        "<Phase",
        "Measured",
        "Simulated",
        "Residual",
        "In \u{03c3}",
    ];
    let row = |place: &WorstPlace| {
        let unit = place.kind.unit(recording.is_calibrated);
        vec![
            format!("{}, {unit}", place.kind.label()),
            escaped(&place_name(place, ("sensel", &recording.site))),
            number(place.time_s),
            number(place.depth_mm),
            place.phase.name().to_string(),
            number(place.measured),
            number(place.simulated),
            format!("<b>{}</b>", number(place.residual)),
            number(place.sigmas),
        ]
    };
    table(&heads, recording.worst.iter().map(row))
}

/// Patches of a print on which only one of the two touches.
fn patches(worst: &[WorstPlace]) -> String {
    let heads = ["<What", "<Middle", "Area, mm²", "Vertices"];
    let row = |place: &WorstPlace| {
        let what = match place.residual > 0.0 {
            true => "inked alone",
            false => "simulated alone",
        };
        vec![
            what.to_string(),
            escaped(&place_name(place, ("cell", ""))),
            format!("<b>{}</b>", number(place.residual.abs())),
            place.vertices.len().to_string(),
        ]
    };
    table(&heads, worst.iter().map(row))
}

/// Sensel or cell, position and nearest vertex in words.
fn place_name(place: &WorstPlace, (cell, site): (&str, &str)) -> String {
    let mut parts = Vec::new();
    match (place.place, place.sensel) {
        (Some([row, column]), _) => parts.push(format!("{cell} row {row}, column {column}")),
        (None, Some(sensel)) => parts.push(format!("{cell} {sensel}")),
        (None, None) => parts.push(site.to_string()),
    }
    if let Some([x, y, z]) = place.position_mm {
        parts.push(format!("({x:.1}, {y:.1}, {z:.1}) mm"));
    }
    if let Some(vertex) = place.vertices.first() {
        parts.push(format!("vertex {vertex}"));
    }
    parts.join(", ")
}

/// Noise of the quantities of every recording, as rms and against their largest value.
pub fn noise(comparison: &Comparison) -> String {
    let heads = [
        "<Recording",
        "<Quantity",
        "Noise, rms",
        "<Unit",
        "Of the largest",
        "Residual, rms",
        "Residual / noise",
    ];
    let root_mean = |values: &[f64]| {
        (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
    };
    let mut rows = Vec::new();
    for recording in &comparison.recordings {
        for series in recording
            .series
            .iter()
            .filter(|series| !series.sigma.iter().all(|s| s.is_nan()))
        {
            let left: Vec<f64> = series
                .measured
                .iter()
                .zip(&series.simulated)
                .map(|(m, s)| m - s)
                .collect();
            let largest = series.measured.iter().copied().fold(0.0, f64::max);
            let (noise, left) = (root_mean(&series.sigma), root_mean(&left));
            rows.push(vec![
                escaped(&recording.name),
                series.label.to_string(),
                number(noise),
                series.unit.to_string(),
                percent(noise / largest),
                number(left),
                number(left / noise),
            ]);
        }
    }
    for (recording, scan) in comparison
        .recordings
        .iter()
        .filter_map(|r| Some((r, r.scan.as_ref()?)))
    {
        let (noise, left) = (root_mean(&scan.sigma), root_mean(&scan.residual));
        let largest = scan
            .measured
            .iter()
            .fold(0.0, |most: f64, h| most.max(h.abs()));
        rows.push(vec![
            escaped(&recording.name),
            "Scanned height".into(),
            number(noise),
            "mm".into(),
            percent(noise / largest),
            number(left),
            number(left / noise),
        ]);
    }
    match rows.is_empty() {
        true => {
            "<p>The noise of no recording is known: repeats of a protocol would tell it.</p>".into()
        }
        false => table(&heads, rows.into_iter()),
    }
}
