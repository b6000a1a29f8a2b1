//! Sections of the page: one recording, and how the figures were made.

use std::fmt::Write;

use crate::maps::{self, Mark};
use crate::plots::residual_curves::{Against, curve};
use crate::plots::trend_bars;
use crate::svg::escaped;
use crate::{prints, tables};
use thenar_comparison::Place;
use thenar_comparison::Scanned;
use thenar_comparison::Trend;
use thenar_comparison::{Comparison, Frame, RecordingComparison};
use thenar_inference::number_format::{capital, number};

/// A recording with its plots and tables.
pub fn recording(number: usize, comparison: &Comparison) -> String {
    let recording = &comparison.recordings[number];
    let marks = marks(comparison, &recording.name);
    let mut html = format!(
        "<section class='recording' id='recording-{number}'><h2>{}</h2>\n<p class='sentence'>{}</p>\n<p class='meta'>{}</p>\n",
        escaped(&recording.name),
        escaped(&recording.sentence),
        escaped(&setting(recording))
    );
    for series in &recording.series {
        let depth = curve(recording, series, Against::Depth);
        let time = curve(recording, series, Against::Time);
        let plots: String = [depth, time].into_iter().flatten().map(figure).collect();
        if !plots.is_empty() {
            let _ = writeln!(html, "<div class='pair'>{plots}</div>");
        }
    }
    if let Some(mat) = &recording.mat {
        for frame in &recording.frames {
            let unit = if recording.is_calibrated {
                "kPa"
            } else {
                "counts"
            };
            let mut caption = caption(recording, frame);
            if !marks.is_empty() {
                caption += " Ring: where a mismatch was located.";
            }
            let drawn = maps::frame(
                mat,
                (frame, &marks),
                unit,
                &format!("{}: {caption}", recording.name),
            );
            let _ = writeln!(
                html,
                "<figure class='map'>{drawn}<figcaption>{}</figcaption></figure>",
                escaped(&caption)
            );
        }
    }
    if let Some(scan) = &recording.scan {
        html += &scanned(recording, scan);
    }
    html += &prints::section(recording);
    if !recording.measures.is_empty() {
        html += &format!("<h3>Measures</h3>{}", tables::measures(&recording.measures));
    }
    if !recording.worst.is_empty() {
        html += &format!("<h3>Worst places</h3>{}", tables::worst(recording));
    }
    html += &trends(recording);
    html += &list("What cannot be known from it", &recording.unknown);
    html + "</section>\n"
}

fn scanned(recording: &RecordingComparison, scan: &Scanned) -> String {
    let moment = &recording.moments[scan.moment as usize];
    let caption = format!(
        "Height over the skin at rest at a depth of {} mm, and distance of the scan from the simulated skin, seen along the skin\u{2019}s mean \
         normal; {} places, each the mean of the points around it. Empty: under the tool, or not scanned.",
        number(moment.depth_mm),
        scan.places.len()
    );
    let drawn = maps::scan(scan, &format!("{}: {caption}", recording.name));
    format!(
        "<figure class='map'>{drawn}<figcaption>{}</figcaption></figure>\n",
        escaped(&caption)
    )
}

/// Discs on the mat of a recording that stand out.
fn marks(comparison: &Comparison, name: &str) -> Vec<Mark> {
    let found = comparison
        .location
        .iter()
        .flat_map(|location| &location.mismatches);
    let here = found.filter(|found| found.when.recordings.iter().any(|other| other == name));
    let mark = |place: &Place| Mark {
        center: place.center_mm,
        radius: place.radius_mm,
    };
    here.filter_map(|found| found.place.as_ref().map(mark))
        .collect()
}

/// Where and when the mismatch lies that parameters cannot absorb.
pub fn location(comparison: &Comparison) -> String {
    let Some(location) = &comparison.location else {
        return String::new();
    };
    let found = location.mismatches.iter();
    let items: String = found
        .map(|found| format!("<li>{}</li>", escaped(&found.sentence)))
        .collect();
    let body = match items.is_empty() {
        true => format!("<p>{}</p>", escaped(&location.sentence)),
        false => format!("<ol>{items}</ol>"),
    };
    format!(
        "<section><h2>Where and when</h2>{body}<p class='meta'>{} places and times were looked at; all of them are paid for in p.</p></section>\n",
        location.look_elsewhere_count
    )
}

fn figure(svg: String) -> String {
    format!("<figure>{svg}</figure>")
}

fn setting(recording: &RecordingComparison) -> String {
    let last = recording.moments.last().map_or(0.0, |moment| moment.time_s);
    let first = recording
        .moments
        .first()
        .map_or(0.0, |moment| moment.time_s);
    let mut parts = vec![
        format!(
            "tool \u{201c}{}\u{201d} at \u{201c}{}\u{201d}",
            recording.indenter, recording.site
        ),
        format!("protocol \u{201c}{}\u{201d}", recording.protocol),
        match recording.moments.len() {
            0 if recording.print.is_some() => "a handprint".to_string(),
            1 => "one moment".to_string(),
            count => format!("{count} moments in {} s", number(last - first)),
        },
    ];
    if let Some(mat) = &recording.mat {
        parts.push(match &recording.print {
            Some(_) => format!("{} cells", mat.centers.len()),
            None => format!("mat of {} sensels", mat.centers.len()),
        });
    }
    if !recording.is_calibrated {
        parts.push("not calibrated: shape and relative size only".into());
    }
    parts.join(" \u{00b7} ")
}

fn caption(recording: &RecordingComparison, frame: &Frame) -> String {
    let moment = &recording.moments[frame.moment as usize];
    let mut text = capital(&frame.why.join(", "));
    text += &format!(": {} s", number(moment.time_s));
    if !moment.depth_mm.is_nan() {
        text += &format!(", depth {} mm", number(moment.depth_mm));
    }
    text += ". Black outline: where the mat reads contact";
    let unit = if recording.is_calibrated {
        "kPa"
    } else {
        "counts"
    };
    if frame.contact_from > 0.0 {
        text += &format!(" ({} {unit} and more)", number(frame.contact_from));
    }
    text + "."
}

fn trends(recording: &RecordingComparison) -> String {
    if recording.trends.is_empty() {
        return String::new();
    }
    let one = |trend: &Trend| {
        figure(trend_bars::trend(
            trend,
            trend.kind.unit(recording.is_calibrated),
        ))
    };
    let plots: String = recording.trends.iter().map(one).collect();
    format!("<h3>Residual against what it may depend on</h3>\n<div class='small'>{plots}</div>\n")
}

/// A list under a title; nothing if it is empty.
pub fn list(title: &str, texts: &[String]) -> String {
    if texts.is_empty() {
        return String::new();
    }
    let items: String = texts
        .iter()
        .map(|text| format!("<li>{}</li>", escaped(text)))
        .collect();
    format!("<h3>{title}</h3><ul>{items}</ul>\n")
}

/// How the figures were made.
pub fn method(comparison: &Comparison) -> String {
    let looks = comparison.look_elsewhere_count;
    format!(
        "<section><h2>How to read this</h2><ul>\
<li><b>Residual</b> is measured minus simulated. \u{03c3} is the standard deviation of the noise that repeats of a protocol show; without repeats it is only how rough the recording itself is, and what stands out of that may still be noise. The band marks \u{00b1}2\u{03c3}.</li>\
<li><b>Bars</b> are means over a range, in the quantity\u{2019}s unit. A bar is vermillion if noise alone gives a mean as far from zero with a chance below 1 % in any of the {looks} ranges looked at (Bonferroni). Both the mean as read and the mean of the whitened residual, with all taken out that the fitted parameters can absorb, must lie that far off; so a bar may be large and still be explained by parameters, or by noise that repeats share.</li>\
<li><b>A mat</b> is compared as its instrument would show it: what lies under its threshold counts as nothing on both sides, and where sensels clip both sides count the ceiling. Contact area is the area of the sensels in contact; overlap is the area where both touch over the area where either does. Mean pressure is force over contact area.</li>\
<li><b>Frame of mean force</b> is the frame whose force is nearest to the mean over all frames that carry any.</li>\
<li><b>A map that is not calibrated</b> is scaled to the sum of the reading: force and pressure cannot be told from it.</li>\
<li><b>A scan</b> is laid on the skin as a rigid body, with its pose among the fitted numbers. What lies on the tool or next to it is left out. The residual is the distance from the scanned points to the simulated skin, along its normal, positive outside.</li>\
<li><b>A handprint</b> says where skin touched, never how hard. A cell of it touched if at least half of it is inked, and touches in simulation if at least half of it bears more than the pressure at which skin leaves ink. The paper\u{2019}s pose is fitted; nothing else is fitted to it.</li>\
<li><b>Noise</b> of a sum over sensels takes the sensels\u{2019} noise as independent.</li>\
<li><b>Intervals</b> hold the true number in 90 of 100 studies if the model is right; they say nothing of what the model leaves out.</li>\
</ul></section>\n"
    )
}
