//! The frames of a mat that a recording names: which mat of its file, and whether it is calibrated.

use super::place::Folder;
use super::toml_tree::Section;
use crate::fault::Fault;
use crate::{PressureMap, PressureUnit, RecordingError};
use std::path::Path;

/// The frames of a mat, as the recording says what they are.
pub(super) fn read_map(
    section: &mut Section,
    file: &Path,
    folder: &Folder,
) -> Result<PressureMap, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let maps = crate::read(file)?.maps;
    let wanted = section.text("mat").map_err(here)?;
    let mut map = choose(section, maps, wanted).map_err(here)?;
    if let Some(entry) = section.get("calibrated") {
        let is_calibrated = entry.boolean().map_err(here)?;
        match (is_calibrated, map.unit) {
            (false, _) => map.unit = PressureUnit::RawCounts,
            (true, PressureUnit::Kilopascal) => {}
            (true, _) => {
                let problem =
                    "is true, but the file holds raw counts or states no unit".to_string();
                return Err(here(entry.fault(
                    problem,
                    "export calibrated pressures, or write calibrated = false",
                )));
            }
        }
    } else if map.unit != PressureUnit::Kilopascal {
        let problem = format!("{} holds raw counts, or states no unit", section.name);
        return Err(here(section.fault(
            problem,
            "declare it with calibrated = false, or export calibrated pressures",
        )));
    }
    if map.unit == PressureUnit::RawCounts {
        map.warnings
            .push("not calibrated: only shape and relative size are used".into());
    }
    Ok(map)
}

/// The mat of a name; the only one needs none.
fn choose(
    section: &Section,
    mut maps: Vec<PressureMap>,
    wanted: Option<String>,
) -> Result<PressureMap, Fault> {
    let names: Vec<String> = maps.iter().map(|map| map.name.clone()).collect();
    let at = match &wanted {
        None if maps.len() == 1 => Some(0),
        None => None,
        Some(wanted) => names.iter().position(|name| name == wanted),
    };
    match at {
        Some(at) => Ok(maps.swap_remove(at)),
        None => {
            let problem = format!(
                "{} must say which of {} mats of its file it is",
                section.name,
                maps.len()
            );
            let remedy = match names.is_empty() {
                true => "name a file of pressures".to_string(),
                false => format!("add mat = \"...\" with one of {}", names.join(", ")),
            };
            Err(Fault::line(section.line, problem, remedy))
        }
    }
}
