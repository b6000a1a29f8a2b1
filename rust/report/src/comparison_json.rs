//! comparison.json: every number with its unit in its name, null for what is not known, keys in order.

use std::fmt::Write;

use serde_json::{Value, json};

use thenar_comparison::PrintRegion;
use thenar_comparison::Scanned;
use thenar_comparison::{Bin, SIGNIFICANT, Trend};
use thenar_comparison::{Carrier, Location, Mismatch, Place};
use thenar_comparison::{Comparison, Frame, RecordingComparison, Series};
use thenar_comparison::{Kind, Measure, WorstPlace};
use thenar_comparison::{PosePart, Printed};
use thenar_inference::observe::measured::{Mat, Moment};
use thenar_inference::parameters::estimate::Estimate;
use thenar_inference::parameters::target::Target;

/// Changes when a key changes its meaning.
const SCHEMA: u32 = 1;

/// The comparison as JSON, schema 1.
///
/// A residual is measured minus simulated. Lists of a series are aligned, those of a frame have a value per sensel of `mat`,
/// and `residual_kpa` one per skin vertex.
pub fn comparison_json(comparison: &Comparison) -> String {
    let value = json!({
        "schema": SCHEMA,
        "version": env!("CARGO_PKG_VERSION"),
        "title": comparison.title,
        "sentence": comparison.sentence,
        "lack_of_fit_p": comparison.lack_of_fit_p,
        "looks": comparison.look_elsewhere_count,
        "significant_below_p": SIGNIFICANT,
        "estimates": comparison.estimates.iter().map(estimate).collect::<Vec<_>>(),
        "recordings": comparison.recordings.iter().map(recording).collect::<Vec<_>>(),
        "location": comparison.location.as_ref().map(location),
        "notes": comparison.notes,
    });
    let mut text = String::new();
    write(&mut text, &value, 0);
    text + "\n"
}

fn location(location: &Location) -> Value {
    json!({
        "sentence": location.sentence,
        "p": location.p,
        "looks": location.look_elsewhere_count,
        "mismatches": location.mismatches.iter().map(mismatch).collect::<Vec<_>>(),
    })
}

fn mismatch(found: &Mismatch) -> Value {
    let place = |place: &Place| {
        let on_skin: Option<[f64; 3]> = place.on_skin_mm.map(Into::into);
        let center: [f64; 3] = place.center_mm.into();
        json!({
            "center_mm": center,
            "row_column": place.row_column,
            "on_skin_mm": on_skin,
            "vertices": place.vertices,
            "radius_mm": place.radius_mm,
            "resolution_mm": place.resolution_mm,
            "sensels_90": place.sensels_90,
            "area_90_mm2": place.area_90_mm2,
            "stays_with": match place.carrier {
                Carrier::Skin => "skin",
                Carrier::Sensor => "sensor",
                Carrier::CannotTell => "cannot_tell",
            },
        })
    };
    let when = &found.when;
    json!({
        "sentence": found.sentence,
        "quantity": found.shown.words(),
        "unit": found.shown.unit(),
        "size": found.size,
        "low": found.low,
        "high": found.high,
        "score": found.score,
        "p": found.p,
        "share_parameters_cannot_imitate": found.kept,
        "where": found.place.as_ref().map(place),
        "when": {
            "recordings": when.recordings,
            "phases": when.phases.iter().map(|phase| phase.name()).collect::<Vec<_>>(),
            "time_s": when.time_s,
            "depth_mm": when.depth_mm,
            "cycles": when.cycles,
            "rate_mm_s": when.rate_mm_s,
        },
    })
}

fn estimate(estimate: &Estimate) -> Value {
    let (kind, name) = match &estimate.target {
        Target::Region(name) => ("region", Some(name)),
        Target::Recording(name) => ("recording", Some(name)),
        Target::Instrument => ("instrument", None),
    };
    json!({
        "name": estimate.name,
        "of": {"kind": kind, "name": name},
        "start": estimate.start,
        "value": estimate.value,
        "low": estimate.low,
        "high": estimate.high,
        "least": estimate.bounds.0,
        "most": estimate.bounds.1,
        "is_at_bound": estimate.is_at_bound,
    })
}

fn recording(recording: &RecordingComparison) -> Value {
    let is_calibrated = recording.is_calibrated;
    json!({
        "name": recording.name,
        "protocol": recording.protocol,
        "indenter": recording.indenter,
        "site": recording.site,
        "sentence": recording.sentence,
        "is_calibrated": is_calibrated,
        "has_noise": recording.has_noise,
        "is_noise_told": recording.is_noise_told,
        "measures": recording.measures.iter().map(measure).collect::<Vec<_>>(),
        "series": recording.series.iter().map(|each| series(recording, each)).collect::<Vec<_>>(),
        "mat": recording.mat.as_ref().map(mat),
        "scan": recording.scan.as_ref().map(|each| scan(recording, each)),
        "print": recording.print.as_ref().map(print),
        "frames": recording.frames.iter().map(|each| frame(recording, each)).collect::<Vec<_>>(),
        "trends": recording.trends.iter().map(|each| trend(each, is_calibrated)).collect::<Vec<_>>(),
        "worst": recording.worst.iter().map(|each| place(each, is_calibrated)).collect::<Vec<_>>(),
        "residual_kpa": recording.residual_kpa,
        "unknown": recording.unknown,
    })
}

fn measure(measure: &Measure) -> Value {
    json!({
        "name": measure.name,
        "of": measure.of,
        "measured": measure.measured,
        "noise": measure.noise,
        "simulated_before": measure.before,
        "simulated": measure.after,
    })
}

fn series(recording: &RecordingComparison, series: &Series) -> Value {
    let of_moment = |value: &dyn Fn(&Moment) -> f64| -> Vec<f64> {
        let moments = series.moments.iter();
        moments
            .map(|moment| value(&recording.moments[*moment as usize]))
            .collect()
    };
    json!({
        "name": series.name,
        "time_s": of_moment(&|moment| moment.time_s),
        "depth_mm": of_moment(&|moment| moment.depth_mm),
        "measured": series.measured,
        "simulated_before": series.before,
        "simulated": series.simulated,
        "noise": series.sigma,
    })
}

fn rows(points: &[nalgebra::Vector3<f64>]) -> Vec<[f64; 3]> {
    points.iter().map(|point| (*point).into()).collect()
}

/// Heights over the skin at rest by place, and the distance of scan and simulated skin.
fn scan(recording: &RecordingComparison, scan: &Scanned) -> Value {
    let moment = &recording.moments[scan.moment as usize];
    json!({
        "time_s": moment.time_s,
        "depth_mm": moment.depth_mm,
        "position_mm": rows(&scan.places),
        "vertex": scan.vertices,
        "measured_mm": scan.measured,
        "simulated_mm": scan.simulated,
        "residual_mm": scan.residual,
        "noise_mm": scan.sigma,
    })
}

/// A handprint: shares by cell of `mat`, the paper's pose, and the residual by vertex of the skin.
fn print(print: &Printed) -> Value {
    let part = |part: &PosePart| json!({"value": part.value, "low": part.low, "high": part.high});
    let region = |region: &PrintRegion| {
        json!({
            "name": region.name,
            "recorded_mm2": region.recorded_mm2,
            "simulated_mm2": region.simulated_mm2,
            "overlap": region.overlap,
        })
    };
    let [x, y, turn] = &print.pose;
    json!({
        "ink_kpa": print.ink_kpa,
        "recorded_share": print.recorded,
        "simulated_share": print.simulated,
        "simulated_share_as_laid": print.as_laid,
        "pose": {"columns_mm": part(x), "rows_mm": part(y), "turn_rad": part(turn)},
        "mirrored_overlap": print.mirrored_overlap,
        "is_mirrored": print.is_mirrored,
        "regions": print.regions.iter().map(region).collect::<Vec<_>>(),
        "print_residual": print.on_skin,
        "force_beside_share": print.beside,
        "is_at_end": print.is_at_end,
    })
}

fn mat(mat: &Mat) -> Value {
    let place = |axis: usize| -> Vec<Option<u32>> {
        mat.places
            .iter()
            .map(|place| place.map(|place| place[axis]))
            .collect()
    };
    json!({
        "center_mm": rows(&mat.centers),
        "normal": rows(&mat.normals),
        "area_mm2": mat.areas,
        "row": place(0),
        "column": place(1),
    })
}

fn frame(recording: &RecordingComparison, frame: &Frame) -> Value {
    let moment = &recording.moments[frame.moment as usize];
    let unit = if recording.is_calibrated {
        "kpa"
    } else {
        "counts"
    };
    let mut value = json!({
        "why": frame.why,
        "time_s": moment.time_s,
        "depth_mm": moment.depth_mm,
        "phase": moment.phase.name(),
        "residual_sigmas": frame.sigmas,
    });
    let numbers = [
        ("measured", json!(frame.measured)),
        ("simulated_before", json!(frame.before)),
        ("simulated", json!(frame.simulated)),
        ("residual", json!(frame.residual)),
        ("contact_from", json!(frame.contact_from)),
    ];
    for (name, numbers) in numbers {
        value[format!("{name}_{unit}")] = numbers;
    }
    value
}

fn trend(trend: &Trend, is_calibrated: bool) -> Value {
    let bin = |bin: &Bin| {
        json!({
            "low": bin.range[0],
            "high": bin.range[1],
            "label": (!bin.label.is_empty()).then_some(&bin.label),
            "count": bin.count,
            "mean": bin.mean,
            "standard_error": bin.standard_error,
            "standard_errors": bin.standard_errors(),
            "stands_out": bin.stands_out(),
            "mean_sigmas": bin.mean_sigma,
            "standard_error_sigmas": bin.standard_error_sigma,
            "p": bin.p,
        })
    };
    json!({
        "quantity": trend.kind.name(is_calibrated),
        "variable": trend.variable.name(),
        "bins": trend.bins.iter().map(bin).collect::<Vec<_>>(),
    })
}

fn place(place: &WorstPlace, is_calibrated: bool) -> Value {
    let kind: Kind = place.kind;
    json!({
        "quantity": kind.name(is_calibrated),
        "time_s": place.time_s,
        "depth_mm": place.depth_mm,
        "phase": place.phase.name(),
        "sensel": place.sensel,
        "row": place.place.map(|place| place[0]),
        "column": place.place.map(|place| place[1]),
        "position_mm": place.position_mm,
        "vertices": place.vertices,
        "measured": place.measured,
        "simulated": place.simulated,
        "residual": place.residual,
        "residual_sigmas": place.sigmas,
    })
}

/// Objects line by line, lists of plain values in one line.
fn write(text: &mut String, value: &Value, depth: usize) {
    let is_plain = |value: &Value| !value.is_object() && !value.is_array();
    match value {
        Value::Object(entries) if !entries.is_empty() => {
            for (k, (key, value)) in entries.iter().enumerate() {
                text.push_str(if k == 0 { "{\n" } else { ",\n" });
                indent(text, depth + 1);
                let _ = write!(text, "{}: ", Value::from(key.as_str()));
                write(text, value, depth + 1);
            }
            text.push('\n');
            indent(text, depth);
            text.push('}');
        }
        Value::Array(items) if !items.is_empty() && !items.iter().all(is_plain) => {
            for (k, item) in items.iter().enumerate() {
                text.push_str(if k == 0 { "[\n" } else { ",\n" });
                indent(text, depth + 1);
                write(text, item, depth + 1);
            }
            text.push('\n');
            indent(text, depth);
            text.push(']');
        }
        plain => {
            let _ = write!(text, "{plain}");
        }
    }
}

fn indent(text: &mut String, depth: usize) {
    text.extend(std::iter::repeat_n(' ', 2 * depth));
}
