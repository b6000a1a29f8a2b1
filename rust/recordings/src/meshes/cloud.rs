//! A point cloud as a table: x, y, z by line, parted by commas, semicolons or blanks, with or without a line of names.

use super::mesh_file::MeshFile;
use crate::fault::{Fault, number, shown};
use nalgebra::Vector3;

const COLUMNS: &str = "name the columns x_mm, y_mm, z_mm, or give three numbers a line";
const NAMES: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// Points in the order of the lines; lines that are empty or begin with `#` are passed over.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut mesh = MeshFile::default();
    let mut columns = None;
    for (line, text) in (1..).zip(bytes.split(|byte| *byte == b'\n')) {
        let text = text.trim_ascii();
        if text.is_empty() || text.starts_with(b"#") {
            continue;
        }
        let cells: Vec<&[u8]> = cells(text).collect();
        let columns = match columns {
            Some(columns) => columns,
            None => {
                let (found, is_header) =
                    places(&cells).map_err(|p| Fault::line(line, p, COLUMNS))?;
                columns = Some(found);
                if is_header {
                    continue;
                }
                found
            }
        };
        let mut point = Vector3::zeros();
        for (axis, column) in columns.into_iter().enumerate() {
            let cell = cells.get(column).copied().unwrap_or_default();
            point[axis] = number(cell).map_err(|problem| Fault::line(line, problem, COLUMNS))?;
        }
        mesh.positions.push(point);
    }
    Ok(mesh)
}

/// Cells of a line: at commas or semicolons if there are any, else at blanks.
fn cells(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let separator = [b';', b','].into_iter().find(|byte| text.contains(byte));
    let cells = text.split(move |byte| match separator {
        Some(separator) => *byte == separator,
        None => byte.is_ascii_whitespace(),
    });
    let cells = cells.map(<[u8]>::trim_ascii);
    cells.filter(move |cell| separator.is_some() || !cell.is_empty())
}

/// Columns of x, y and z, and whether the line names them.
fn places(cells: &[&[u8]]) -> Result<([usize; 3], bool), String> {
    if cells.iter().all(|cell| number(cell).is_ok()) {
        return match cells.len() {
            0..3 => Err(format!(
                "a point with {} coordinates, expected 3",
                cells.len()
            )),
            _ => Ok(([0, 1, 2], false)),
        };
    }
    let at = |name: &str| cells.iter().position(|cell| *cell == name.as_bytes());
    let mut found = [0; 3];
    for (place, name) in found.iter_mut().zip(NAMES) {
        let Some(column) = at(name) else {
            let first = shown(cells.first().copied().unwrap_or_default());
            return Err(format!("there is no column {name}; the first is {first}"));
        };
        *place = column;
    }
    Ok((found, true))
}
