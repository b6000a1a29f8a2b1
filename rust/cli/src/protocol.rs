//! A protocol from a CSV file, and the table of what came out of it.

use crate::fault::Fault;
use crate::results::Output;
use crate::table::Table;
use std::fmt::Write as _;
use std::path::Path;
use thenar_contact::{Course, Demand, Protocol, Row};
use thenar_surface::Vec3;

const DEMANDS: [&str; 3] = ["offset_mm", "depth_mm", "force_n"];
const SLIDES: [&str; 3] = ["slide_x_mm", "slide_y_mm", "slide_z_mm"];
/// Largest time, length or force that a protocol may ask for, s, mm, N.
const LARGEST: f64 = 1e6;
const KPA_PER_MPA: f64 = 1e3;

/// Reads `time_s` with one of `offset_mm`, `depth_mm` and `force_n` per row (the others empty), and slides if there are any.
///
/// # Errors
/// Names file, line and remedy.
pub fn read(file: &Path, direction: Option<Vec3>) -> Result<Protocol, Fault> {
    let mut table = Table::open(file, "a CSV of time_s and depth_mm")?;
    let headers = table.columns.clone();
    let is_known = |name: &&String| {
        name.as_str() == "time_s"
            || DEMANDS.contains(&name.as_str())
            || SLIDES.contains(&name.as_str())
    };
    let at = |line: u64, problem: String| {
        Fault::Input(format!("{}, line {line}: {problem}", file.display()))
    };
    if let Some(stray) = headers.iter().find(|name| !is_known(name)) {
        let all = "time_s, offset_mm, depth_mm, force_n, slide_x_mm, slide_y_mm and slide_z_mm";
        return Err(at(
            1,
            format!("there is no column {stray:?}; there are {all}"),
        ));
    }
    if !headers.iter().any(|name| name == "time_s") {
        return Err(at(1, "the column time_s is missing".to_owned()));
    }
    let mut rows = Vec::new();
    for record in table.records() {
        let (line, record) = record?;
        rows.push(row(&headers, &record).map_err(|problem| at(line, problem))?);
    }
    Ok(Protocol { rows, direction })
}

fn row(headers: &[String], record: &csv::StringRecord) -> Result<Row, String> {
    let field = |name: &str| -> Result<Option<f64>, String> {
        let place = headers.iter().position(|header| header == name);
        let text = place
            .and_then(|place| record.get(place))
            .filter(|text| !text.is_empty());
        let number = |text: &str| match text.parse::<f64>() {
            Ok(number) if number.abs() > LARGEST => Err(format!(
                "{name} is {text}, which is out of range; give at most {LARGEST} either way"
            )),
            Ok(number) => Ok(number),
            Err(_) => Err(format!("{name} is {text:?}, which is no number")),
        };
        text.map(number).transpose()
    };
    let demand = match [field(DEMANDS[0])?, field(DEMANDS[1])?, field(DEMANDS[2])?] {
        [Some(offset), None, None] => Demand::Offset(offset),
        [None, Some(depth), None] => Demand::Depth(depth),
        [None, None, Some(force)] => Demand::Force(force),
        _ => {
            return Err(
                "give one of offset_mm, depth_mm and force_n, and leave the others empty"
                    .to_owned(),
            );
        }
    };
    let slide = [field(SLIDES[0])?, field(SLIDES[1])?, field(SLIDES[2])?];
    Ok(Row {
        time_s: field("time_s")?.ok_or("time_s is empty")?,
        demand,
        slide: Vec3::from(slide.map(|value| value.unwrap_or(0.0))),
    })
}

/// protocol.csv: one line per row of the protocol.
pub fn table(course: &Course) -> Output {
    let mut text =
        "time_s,offset_mm,depth_mm,force_n,fx_n,fy_n,fz_n,area_mm2,peak_kpa,work_mj\n".to_owned();
    for step in &course.steps {
        let depth = course
            .touch_offset
            .map_or_else(String::new, |touch| (step.offset - touch).to_string());
        let [x, y, z] = [step.total_force.x, step.total_force.y, step.total_force.z];
        let (peak, work) = (step.peak_pressure * KPA_PER_MPA, step.work);
        let _ = writeln!(
            text,
            "{},{},{depth},{},{x},{y},{z},{},{peak},{work}",
            step.time_s, step.offset, step.force, step.area
        );
    }
    Output {
        name: "protocol.csv",
        text,
    }
}
