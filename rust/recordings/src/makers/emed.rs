//! Novel emed: one page per frame with a window of the platform, its forces and its total.

use super::limits::count;
use crate::check::Check;
use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, PressureUnit, grid_sensels};
use crate::source::Source;
use crate::text::fields::{DAMAGED, MOST_VALUES, ODD, Row, Separator, value};
use crate::text::lines::{Line, Lines};
use crate::text::units::{Quantity, measure};

/// Rounding of a page's total and of its cells, N.
const FORCE_TOLERANCE: f64 = 0.005;

/// What every page repeats.
#[derive(Debug, Default)]
struct Platform {
    /// Columns and rows of the whole platform.
    matrix: Option<[usize; 2]>,
    area_mm2: Option<f64>,
    seconds_per_picture: Option<f64>,
    /// Width and height of a sensel, mm.
    size_mm: Option<[f64; 2]>,
}

/// The window of one page.
#[derive(Debug, Clone, PartialEq, Default)]
struct Page {
    picture: usize,
    first_column: usize,
    columns: usize,
    first_row: usize,
    rows: usize,
    total: f64,
    values: Vec<f64>,
}

pub(super) fn read(lines: &mut Lines) -> Result<Vec<PressureMap>, Fault> {
    let (mut platform, mut pages, mut held) = (Platform::default(), Vec::<Page>::new(), 0);
    while let Some(page) = next_page(lines, &mut platform)? {
        let line = lines.number();
        if pages
            .last()
            .is_some_and(|last| last.picture >= page.picture)
        {
            let problem = format!("picture {} does not follow the one before it", page.picture);
            return Err(Fault::line(
                line,
                problem,
                "export the pictures in order, each once",
            ));
        }
        held += page.values.len();
        if held > MOST_VALUES {
            return Err(Fault::line(
                line,
                "the recording holds too many values".into(),
                "export a shorter part of it",
            ));
        }
        pages.push(page);
    }
    if pages.is_empty() {
        return Err(lines.ended("a picture ('Pict-No.')"));
    }
    let area = platform.area_mm2;
    let (first, size) = window(&pages);
    super::limits::check_cells(size[0], size[1]).map_err(|problem| Fault::file(problem, ODD))?;
    if pages.len().saturating_mul(size[0] * size[1]) > MOST_VALUES {
        return Err(Fault::file(
            "the pictures' windows lie too far apart".into(),
            DAMAGED,
        ));
    }
    let source = Source::of("Novel", "emed");
    let sensels = grid_sensels(first.map(|at| at as u32), size, area);
    let mut map = PressureMap::new(source, PressureUnit::Kilopascal, sensels);
    let mut check = Check::new("total force", "N", FORCE_TOLERANCE);
    for (k, page) in pages.iter().enumerate() {
        place(page, first, size, &mut map.values);
        if let Some(ours) = map.force_n(k) {
            check.compare(k, page.total, ours);
        }
    }
    map.pitch_mm = platform.size_mm.map(|[width, height]| [height, width]);
    map.time_s = platform.seconds_per_picture.map(|step| {
        pages
            .iter()
            .map(|page| (page.picture - 1) as f64 * step)
            .collect()
    });
    if check.compared > 0 {
        map.push_check(check);
    }
    if let Some([columns, rows]) = platform
        .matrix
        .filter(|[columns, rows]| [*rows, *columns] != size)
    {
        map.unknown.push(format!(
            "cells of the {columns} x {rows} platform outside the exported window"
        ));
    }
    map.unknown
        .push("threshold and limit of the sensors".into());
    Ok(vec![map])
}

/// The next page that is a picture; summaries (`MPP`, `MVP`) are passed over.
fn next_page(lines: &mut Lines, platform: &mut Platform) -> Result<Option<Page>, Fault> {
    let (mut picture, mut is_summary) = (None, false);
    while let Some(line) = lines.next_filled(&['\u{c}'])? {
        let text = line
            .text
            .trim_matches(|c: char| c.is_whitespace() || c == '\u{c}');
        platform
            .take(text)
            .map_err(|problem| line.fault(problem, ODD))?;
        if let Some((_, rest)) = text.split_once("Pict-No.:") {
            let word = rest.split_whitespace().next().unwrap_or("");
            let number = word.parse::<usize>().ok().filter(|number| *number > 0);
            let problem = || {
                line.fault(
                    format!("{} is not a picture number", shown(word.as_bytes())),
                    DAMAGED,
                )
            };
            (picture, is_summary) = (Some(number.ok_or_else(problem)?), false);
        } else if text.contains("MPP") || text.contains("MVP") {
            is_summary = true;
        } else if text.ends_with("Force") && text.starts_with(|c: char| c.is_ascii_digit()) {
            let (first_column, columns) =
                column_numbers(text).map_err(|problem| line.fault(problem, ODD))?;
            let mut page = Page {
                first_column,
                columns,
                picture: picture.unwrap_or(0),
                ..Page::default()
            };
            read_rows(lines, &mut page)?;
            match (is_summary, picture) {
                (true, _) => {}
                (false, Some(_)) => return Ok(Some(page)),
                (false, None) => {
                    return Err(Fault::line(
                        lines.number(),
                        "a page without picture number".into(),
                        DAMAGED,
                    ));
                }
            }
        }
    }
    match picture {
        Some(picture) if !is_summary => {
            Err(lines.ended(&format!("the cells of picture {picture}")))
        }
        _ => Ok(None),
    }
}

/// Column numbers of the window, which follow each other: the first and how many.
fn column_numbers(text: &str) -> Result<(usize, usize), String> {
    let numbers: Result<Vec<usize>, String> = text
        .split_whitespace()
        .take_while(|word| *word != "Force")
        .map(|word| count(word, "columns"))
        .collect();
    let numbers = numbers?;
    let first = numbers.first().copied().unwrap_or(0);
    if numbers
        .iter()
        .zip(first..)
        .any(|(number, expected)| *number != expected)
    {
        return Err("the column numbers do not follow each other".into());
    }
    Ok((first, numbers.len()))
}

/// Rows of cells up to the row `Force`, whose last number is the total.
fn read_rows(lines: &mut Lines, page: &mut Page) -> Result<(), Fault> {
    let mut row = Vec::new();
    loop {
        let Some(line) = lines.next_filled(&[])? else {
            return Err(lines.ended(&format!("the row 'Force' of picture {}", page.picture)));
        };
        let separator = if line.text.contains('\t') {
            Separator::Tab
        } else {
            Separator::Blank
        };
        let shape = Row {
            separator,
            columns: page.columns + 2,
            missing: None,
        };
        let text = line.text.trim();
        if let Some(rest) = text.strip_prefix("Force") {
            let total = separator
                .split(rest)
                .filter(|field| !field.is_empty())
                .last()
                .unwrap_or("");
            page.total = value(total).map_err(|problem| line.fault(problem, ODD))?;
            return Ok(());
        }
        row.clear();
        shape.read(
            Line {
                number: line.number,
                text,
            },
            &mut row,
        )?;
        let number = row[0];
        let expected = (page.first_row + page.rows) as f64;
        let is_number =
            number.fract() == 0.0 && (1.0..=super::limits::WIDEST as f64).contains(&number);
        if !is_number || (page.rows > 0 && number != expected) {
            let problem = format!("row number {number} where {expected} should follow");
            return Err(line.fault(problem, DAMAGED));
        }
        if page.rows == 0 {
            page.first_row = number as usize;
        }
        page.rows += 1;
        page.values.extend_from_slice(&row[1..=page.columns]);
    }
}

/// First row and column and size of the rectangle that holds every page.
fn window(pages: &[Page]) -> ([usize; 2], [usize; 2]) {
    let least = |of: fn(&Page) -> usize| pages.iter().map(of).min().unwrap_or(0);
    let most = |of: fn(&Page) -> usize| pages.iter().map(of).max().unwrap_or(0);
    let first = [
        least(|page| page.first_row),
        least(|page| page.first_column),
    ];
    let rows = most(|page| page.first_row + page.rows) - first[0];
    let columns = most(|page| page.first_column + page.columns) - first[1];
    (first, [rows, columns])
}

/// Appends a page as a frame; cells outside its window are missing.
fn place(page: &Page, first: [usize; 2], size: [usize; 2], into: &mut Vec<f64>) {
    let start = into.len();
    into.resize(start + size[0] * size[1], f64::NAN);
    for (k, row) in page.values.chunks_exact(page.columns.max(1)).enumerate() {
        let at = start + (page.first_row + k - first[0]) * size[1] + page.first_column - first[1];
        into[at..at + page.columns].copy_from_slice(row);
    }
}

impl Platform {
    fn take(&mut self, text: &str) -> Result<(), String> {
        let after = |key: &str| text.split_once(key).map(|(_, rest)| rest.trim_start());
        if let Some(rest) = after("Matrix:") {
            let (columns, rows) = rest
                .trim_end()
                .split_once('x')
                .ok_or("the matrix has no size")?;
            self.matrix = Some([count(columns, "columns")?, count(rows, "rows")?]);
        }
        if let Some(rest) = after("Sensor area:") {
            self.area_mm2 = Some(measure(rest, Quantity::Area)?).filter(|area| *area > 0.0);
        }
        if let Some(rest) = after("Time/picture:") {
            let glued = |name: &'static str, factor| {
                rest.trim_end()
                    .strip_suffix(name)
                    .map(|text| (text.trim(), factor))
            };
            let (text, factor) = glued("ms", 1e-3)
                .or(glued("s", 1.0))
                .ok_or("the time per picture has no unit")?;
            self.seconds_per_picture = Some(value(text)? * factor).filter(|step| *step > 0.0);
        }
        if let Some(rest) = after("Sensor size:") {
            let (width, height) = rest.split_once('x').ok_or("the sensor has no size")?;
            let height = measure(height, Quantity::Length)?;
            let unit = rest.split_whitespace().last().unwrap_or("");
            self.size_mm = Some([
                measure(&format!("{} {unit}", width.trim()), Quantity::Length)?,
                height,
            ]);
        }
        Ok(())
    }
}
