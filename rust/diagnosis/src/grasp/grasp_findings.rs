//! Findings of grasps with their numbers, regions and signs.

use thenar_inference::grasp::causes::{Cause, Weighed};
use thenar_inference::grasp::channels::place;
use thenar_inference::grasp::explain::{Explained, THINNER};

use crate::findings::{Finding, Number, Switched, When, Where};
use crate::track_record::{Confidence, Kind};

/// Half of a 90 % interval in standard deviations.
const NINETY: f64 = 1.645;
/// Confidence of what the readings show by themselves.
const SHOWN: f64 = 0.98;

/// Faults that single cells and parts of the mat show.
pub(super) fn cell_findings(explained: &Explained) -> Vec<Finding> {
    let mut all = Vec::new();
    if let Some(at) = explained.limits.ceiling_kpa {
        let sign =
            format!("several cells stop at the same {at:.1} kPa, the largest reading of all");
        all.push(of_cells(
            "saturation",
            vec![exact("ceiling_kpa", at, "kPa")],
            sign,
        ));
    }
    if let Some(at) = explained.limits.floor_kpa {
        let sign = format!("no cell reads anything between nothing and {at:.1} kPa");
        all.push(of_cells(
            "threshold",
            vec![exact("floor_kpa", at, "kPa")],
            sign,
        ));
    }
    if !explained.dead.is_empty() {
        let count = explained.dead.len();
        let sign = format!(
            "{count} cell{} read nothing in every hold, {}",
            if count == 1 { "" } else { "s" },
            listed_cells(explained)
        );
        all.push(of_cells(
            "dead_cells",
            vec![exact("cells", count as f64, "1")],
            sign,
        ));
    }
    if let Some(part) = &explained.part {
        let line = if part.is_columns { "columns" } else { "rows" };
        let sign = format!(
            "across the edge of {line} {} to {} the readings of one and the same region change by a factor of {:.2}",
            part.band.0, part.band.1, part.gain
        );
        let number = Number {
            name: "error",
            value: part.gain - 1.0,
            interval: (part.interval.0 - 1.0, part.interval.1 - 1.0),
            unit: "1",
        };
        all.push(of_cells("gain", vec![number], sign));
    }
    all
}

fn of_cells(effect: &'static str, numbers: Vec<Number>, sign: String) -> Finding {
    Finding {
        effect,
        kind: "instrument",
        channel: "map",
        confidence: Confidence::new(SHOWN, Kind::GraspInstrument),
        numbers,
        place: None,
        when: None,
        depends_on: vec!["sensor_position"],
        consequences: vec![(sign, true)],
    }
}

fn exact(name: &'static str, value: f64, unit: &'static str) -> Number {
    Number {
        name,
        value,
        interval: (value, value),
        unit,
    }
}

/// The first dead cells by row and column.
fn listed_cells(explained: &Explained) -> String {
    let places = |cell: &usize| explained.holds.first().and_then(|hold| hold.places[*cell]);
    let named: Vec<String> = explained
        .dead
        .iter()
        .take(4)
        .map(|cell| match places(cell) {
            Some([row, col]) => format!("row {row} column {col}"),
            None => format!("cell {} of the mat", cell + 1),
        })
        .collect();
    let more = if explained.dead.len() > named.len() {
        " and more"
    } else {
        ""
    };
    format!("in {}{more}", named.join(", "))
}

/// A cause that was named.
pub(super) fn cause_finding(explained: &Explained, named: &Weighed, posterior: f64) -> Finding {
    let kind = match named.cause.is_instrument() {
        true => Kind::GraspInstrument,
        false => Kind::GraspSkin,
    };
    Finding {
        effect: named.cause.name(),
        kind: if named.cause.is_instrument() {
            "instrument"
        } else {
            "tissue"
        },
        channel: match named.cause {
            Cause::Relaxation(_) | Cause::Softening => "map",
            Cause::Gain | Cause::Drift(_) => "force",
            Cause::Stiffness(_) | Cause::Bone(_) => "map",
        },
        confidence: Confidence::new(posterior, kind),
        numbers: numbers(explained, named),
        place: named
            .cause
            .region()
            .map(|region| where_of(explained, region)),
        when: when(explained, named.cause),
        depends_on: match named.cause {
            Cause::Relaxation(_) | Cause::Drift(_) => vec!["time"],
            Cause::Softening => vec!["cycle"],
            _ => vec![],
        },
        consequences: signs(explained, named),
    }
}

/// Size with its 90 % interval, through a function that may fall.
fn sized(named: &Weighed, of: impl Fn(f64) -> f64) -> (f64, (f64, f64)) {
    let (size, spread) = (named.sized.size, NINETY * named.sized.deviation);
    let (a, b) = (of(size - spread), of(size + spread));
    (of(size), (a.min(b), a.max(b)))
}

fn numbers(explained: &Explained, named: &Weighed) -> Vec<Number> {
    let number = |name, (value, interval), unit| Number {
        name,
        value,
        interval,
        unit,
    };
    match named.cause {
        Cause::Relaxation(time) => {
            let share = sized(named, |size| relaxed(explained, size, time));
            vec![
                number("amplitude", share, "1"),
                exact("time_3_s", time, "s"),
            ]
        }
        Cause::Softening => vec![number("amplitude", sized(named, |s| 1.0 - (-s).exp()), "1")],
        Cause::Stiffness(region) => {
            let given = explained.product.moduli_mpa(region).0;
            vec![
                number("factor", sized(named, f64::exp), "1"),
                number("g0_mpa", sized(named, |s| given * s.exp()), "MPa"),
            ]
        }
        Cause::Bone(region) => {
            let given = explained.product.thickness_mm(region);
            let thickness = sized(named, |s| given * THINNER.powf(s));
            vec![
                number("amplitude", (1.0, (1.0, 1.0)), "1"),
                number("thickness_mm", thickness, "mm"),
            ]
        }
        Cause::Gain => vec![number("error", sized(named, |s| s.exp() - 1.0), "1")],
        Cause::Drift(_) => vec![number("change", sized(named, |s| s.exp() - 1.0), "1")],
    }
}

/// Share of the first force that fades in the end, from the change over the mean of the holds.
fn relaxed(explained: &Explained, size: f64, time: f64) -> f64 {
    let all = explained.holds.iter().flat_map(|hold| &hold.time_s);
    let faded: Vec<f64> = all.map(|t| 1.0 - (-t / time).exp()).collect();
    let mean = faded.iter().sum::<f64>() / faded.len().max(1) as f64;
    size / (1.0 + size * mean)
}

fn where_of(explained: &Explained, region: usize) -> Where {
    Where {
        site: String::new(),
        region: Some(explained.product.regions()[region].clone()),
        center_mm: None,
        radius_mm: None,
        area_90_mm2: None,
        vertices: explained.product.vertices(region),
    }
}

fn when(explained: &Explained, cause: Cause) -> Option<When> {
    let longest = explained
        .holds
        .iter()
        .map(|hold| hold.length_s())
        .fold(0.0, f64::max);
    let from = match cause {
        Cause::Relaxation(_) | Cause::Drift(_) => 0.0,
        _ => return None,
    };
    Some(When {
        recordings: explained
            .holds
            .iter()
            .map(|hold| hold.name.clone())
            .collect(),
        phase: "hold",
        time_s: [from, longest],
        depth_mm: [f64::NAN; 2],
        cycles: [0, 0],
    })
}

fn signs(explained: &Explained, named: &Weighed) -> Vec<(String, bool)> {
    let mut signs = Vec::new();
    if let Cause::Relaxation(_) = named.cause {
        let (fall, all) = falling(explained);
        signs.push((
            format!("pressure falls at unchanged contact in {fall} of {all} places (each part of the hand in each hold), corrected for finger motion"),
            10 * fall >= 7 * all,
        ));
        signs.extend(trace_sign(explained));
    }
    if let Some(gain) = named.held_out {
        let text = format!(
            "each hold is predicted better with it by the others: their log predictive density rises by {gain:.1} in all"
        );
        signs.push((text, gain > 0.0));
    }
    signs
}

/// Region-and-hold courses whose scale falls from the first third to the last, and all of them.
pub(super) fn falling(explained: &Explained) -> (usize, usize) {
    let (mut fall, mut all) = (0, 0);
    for courses in &explained.courses {
        let stretches = courses.scale.len();
        let part = (stretches / 3).max(1);
        for region in 0..courses.scale.first().map_or(0, Vec::len) {
            let mean = |range: std::ops::Range<usize>| {
                let count = range.len() as f64;
                range.map(|b| courses.scale[b][region]).sum::<f64>() / count
            };
            all += 1;
            fall += usize::from(mean(stretches - part..stretches) < mean(0..part));
        }
    }
    (fall, all)
}

fn trace_sign(explained: &Explained) -> Option<(String, bool)> {
    let falls = |hold: &thenar_inference::grasp::hold::Hold| {
        let force = hold.force_n.as_ref()?;
        Some(force.last()? < force.first()?)
    };
    let all: Vec<bool> = explained.holds.iter().filter_map(falls).collect();
    (!all.is_empty()).then(|| {
        let count = all.iter().filter(|falls| **falls).count();
        let text = format!(
            "the force trace falls in {count} of {} holds as well",
            all.len()
        );
        (text, 2 * count > all.len())
    })
}

/// The effect as the model takes it; None for what is no effect of the model.
pub(super) fn switched(explained: &Explained, named: &Weighed) -> Option<Switched> {
    let numbers = |numbers: Vec<(&'static str, f64)>, amplitude| Switched {
        name: named.cause.name(),
        amplitude,
        numbers,
        choices: Vec::new(),
    };
    match named.cause {
        Cause::Relaxation(time) => {
            let share = relaxed(explained, named.sized.size, time).clamp(0.0, 0.99);
            let one = vec![
                ("time_3_s", time),
                ("weight_1", 0.0),
                ("weight_2", 0.0),
                ("weight_3", 1.0),
            ];
            Some(numbers(one, share))
        }
        Cause::Bone(region) => {
            let thickness = explained.product.thickness_mm(region) * THINNER.powf(named.sized.size);
            Some(numbers(vec![("thickness_mm", thickness)], 1.0))
        }
        _ => None,
    }
}

/// Force of a region in the mean over holds, N.
pub(super) fn region_force(explained: &Explained, region: usize) -> f64 {
    let of = |(fit, hold): (
        &thenar_inference::grasp::regional_fit::RegionalFit,
        &thenar_inference::grasp::hold::Hold,
    )| place(fit, region).map_or(0.0, |k| hold.sum_n(&fit.maps[k]));
    let all = explained.fits.iter().zip(&explained.holds);
    all.map(of).sum::<f64>() / explained.holds.len().max(1) as f64
}
