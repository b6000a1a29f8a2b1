//! Where the cells of a mat lie on the product: a CSV of row, col (or sensor), x_mm, y_mm, z_mm, area_mm2.

use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, Sensel};
use crate::tables::columns::{Column, names};
use crate::text::fields::{Separator, value};
use crate::text::lines::Lines;
use crate::text::units::Quantity;
use crate::{RecordingError, plain_file};
use std::collections::HashMap;
use std::io::BufReader;
use std::path::Path;

const REMEDY: &str = "columns are row, col, x_mm, y_mm, z_mm, area_mm2 (sensor instead of row, col on a mat without a grid)";
/// Most sensels of a mat.
const MOST: usize = 1 << 24;

/// A sensel on the product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedSensel {
    /// Center, mm, skin coordinates.
    pub center_mm: [f64; 3],
    /// Unit normal out of the product, where it is known.
    pub normal: Option<[f64; 3]>,
    /// Area, mm2.
    pub area_mm2: f64,
}

/// The places of a map's sensels, in its order; `None` for a cell that is missing in every frame and has no place.
pub(in crate::study) fn read(
    file: &Path,
    map: &PressureMap,
) -> Result<Vec<Option<PlacedSensel>>, RecordingError> {
    let mut lines = Lines::new(BufReader::new(plain_file::open(file)?.0));
    let placed = parse(&mut lines).and_then(|places| of_map(&places, map));
    placed.map_err(|fault| fault.in_file(file))
}

type Places = HashMap<[u32; 2], PlacedSensel>;

/// A mat without a grid is keyed by sensor number, with this as its row.
const BY_NUMBER: u32 = u32::MAX;

fn parse(lines: &mut Lines) -> Result<Places, Fault> {
    let Some(line) = lines.next_filled(&[',', ';'])? else {
        return Err(lines.ended("the line of column names"));
    };
    let separator = Separator::of(line.text);
    let columns = names(line.text, separator);
    let at = |base: &str| columns.iter().position(|column| column.base == base);
    let length = |base: &str| at(base).filter(|k| is(&columns[*k], Quantity::Length));
    let area = at("area").filter(|k| is(&columns[*k], Quantity::Area));
    let (Some(x), Some(y), Some(z), Some(area)) = (length("x"), length("y"), length("z"), area)
    else {
        return Err(line.fault(
            "x, y, z or area is not there, or without its unit".into(),
            REMEDY,
        ));
    };
    let keys = match (at("row"), at("column"), at("sensor")) {
        (Some(row), Some(column), _) => [Some(row), Some(column)],
        (_, _, Some(sensor)) => [None, Some(sensor)],
        _ => return Err(line.fault("there is neither row and col nor sensor".into(), REMEDY)),
    };
    let (mut places, mut cells) = (Places::new(), Vec::new());
    while let Some(line) = lines.next_filled(&[',', ';'])? {
        let fault = |problem: String| line.fault(problem, REMEDY);
        cells.clear();
        for (column, text) in columns.iter().zip(separator.split(line.text)) {
            let number =
                value(text).map_err(|problem| fault(format!("{}: {problem}", column.base)))?;
            cells.push(number * column.unit.map_or(1.0, |unit| unit.factor));
        }
        if cells.len() < columns.len() {
            return Err(fault(format!(
                "the row holds {} values, expected {}",
                cells.len(),
                columns.len()
            )));
        }
        let key = keys.map(|key| key.map_or(Ok(BY_NUMBER), |k| whole(cells[k])));
        let [row, column] = key;
        let key = [row.map_err(fault)?, column.map_err(fault)?];
        let placed = PlacedSensel {
            center_mm: [cells[x], cells[y], cells[z]],
            normal: None,
            area_mm2: cells[area],
        };
        if placed.area_mm2 <= 0.0 {
            return Err(line.fault(
                format!("the area is {} mm2", placed.area_mm2),
                "give an area above zero",
            ));
        }
        if places.insert(key, placed).is_some() {
            return Err(line.fault("this sensel stands twice".into(), "name each sensel once"));
        }
        if places.len() > MOST {
            return Err(fault("there are too many sensels".into()));
        }
    }
    Ok(places)
}

fn is(column: &Column, quantity: Quantity) -> bool {
    column.unit.is_some_and(|unit| unit.quantity == quantity)
}

fn whole(number: f64) -> Result<u32, String> {
    match number.fract() == 0.0 && (0.0..1e9).contains(&number) {
        true => Ok(number as u32),
        false => Err(format!(
            "{} is no row, column or sensor number",
            shown(number.to_string().as_bytes())
        )),
    }
}

fn of_map(places: &Places, map: &PressureMap) -> Result<Vec<Option<PlacedSensel>>, Fault> {
    let mut placed = Vec::with_capacity(map.sensels.len());
    for (k, sensel) in map.sensels.iter().enumerate() {
        let found = key(sensel).and_then(|key| places.get(&key)).copied();
        let is_missing = || (0..map.frames()).all(|frame| map.frame(frame)[k].is_nan());
        if found.is_none() && !is_missing() {
            let name = match (sensel.place, sensel.number) {
                (Some([row, column]), _) => format!("row {row}, column {column}"),
                (None, number) => format!("sensor {}", number.unwrap_or(0)),
            };
            return Err(Fault::file(
                format!("{name} of the recording has no place"),
                "add a line for it",
            ));
        }
        placed.push(found);
    }
    Ok(placed)
}

fn key(sensel: &Sensel) -> Option<[u32; 2]> {
    sensel
        .place
        .or(sensel.number.map(|number| [BY_NUMBER, number]))
}
