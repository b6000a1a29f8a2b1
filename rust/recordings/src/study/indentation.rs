//! The indentation of a recording: its file, which run of it, and which of its columns is what.

use super::place::Folder;
use super::toml_tree::Section;
use crate::curve::Curve;
use crate::fault::Fault;
use crate::recording::{listed, read_with};
use crate::recording_file::ReadOptions;
use crate::{Columns, RecordingError};
use std::path::Path;

/// `run = "Probe 2"` and the table `columns` of a recording.
pub(super) fn options(section: &mut Section) -> Result<ReadOptions, Fault> {
    let run = section.text("run")?;
    let mut columns = Columns::default();
    if let Some(table) = section.section("columns")? {
        for (key, entry) in table.pairs() {
            let header = entry.text()?;
            columns
                .add(&key, &header)
                .map_err(|problem| Fault::line(entry.line, problem, "correct the table columns"))?;
        }
    }
    Ok(ReadOptions { columns, run })
}

/// The indentation of a recording, with what its table says of it.
pub(super) fn of_section(
    section: &mut Section,
    file: &Path,
    folder: &Folder,
) -> Result<Curve, RecordingError> {
    let options = options(section).map_err(|fault| folder.fault(fault))?;
    read(file, &options)
}

/// The one indentation of a file.
pub(super) fn read(file: &Path, options: &ReadOptions) -> Result<Curve, RecordingError> {
    let fault = |problem: String, remedy: String| Fault::line(1, problem, remedy).in_file(file);
    let found = read_with(file, options)?;
    let mut curves = found.curves;
    if curves.len() != 1 {
        let problem = format!("the file holds {} indentations, expected one", curves.len());
        let names: Vec<String> = curves.iter().map(|curve| curve.name.clone()).collect();
        let remedy = match names.is_empty() {
            true => "name a file of force and depth".to_string(),
            false => listed(&names),
        };
        return Err(fault(problem, remedy));
    }
    let mut curve = curves.remove(0);
    let has = |name: &str| curve.channel(name).is_some();
    for (is_there, what, column) in [
        (has("time_s"), "time", "add a column time_s"),
        (has("force_n"), "force", "add a column force_n"),
        (
            has("depth_mm") || has("travel_mm"),
            "depth",
            "add a column depth_mm",
        ),
    ] {
        if !is_there {
            let (problem, remedy) = asked(&curve, what).unwrap_or_default();
            let remedy = if remedy.is_empty() {
                column.to_string()
            } else {
                remedy
            };
            return Err(fault(
                format!("the indentation has no {what}{problem}"),
                remedy,
            ));
        }
    }
    curve.warnings.extend(found.notes);
    Ok(curve)
}

/// Which column the missing quantity may be, and how to say so, where the reader asks.
fn asked(curve: &Curve, what: &str) -> Option<(String, String)> {
    let keys: &[&str] = if what == "depth" {
        &["the travel:", "the depth:"]
    } else {
        &["the force:"]
    };
    let asks = |text: &&String| keys.iter().any(|key| text.starts_with(key)) && text.contains('?');
    let text = curve.unknown.iter().find(asks)?;
    let (question, remedy) = text.split_once("? ")?;
    let (_, question) = question.split_once(':')?;
    Some((format!(":{question}"), remedy.replacen("Name", "name", 1)))
}
