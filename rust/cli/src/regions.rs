//! The region of every vertex from a CSV file of vertex,region.

use crate::fault::Fault;
use crate::table::Table;
use std::path::Path;

/// Largest region number; more would be a mistake that costs memory.
const LAST_REGION: i32 = 4095;
/// Marks a vertex that the file has not named yet.
const UNSET: i32 = i32::MIN;

/// Regions by vertex, and their names if the file has names.
#[derive(Debug, PartialEq, Eq)]
pub struct RegionTable {
    /// One per vertex; -1 for no skin.
    pub regions: Vec<i32>,
    /// Empty if the file has numbers; else in order of first appearance.
    pub names: Vec<String>,
}

impl RegionTable {
    /// Every vertex in region 0.
    pub fn single(vertices: usize) -> RegionTable {
        RegionTable {
            regions: vec![0; vertices],
            names: Vec::new(),
        }
    }

    /// How many regions there are, at least one.
    pub fn count(&self) -> usize {
        let last = self.regions.iter().copied().max().unwrap_or(0).max(0);
        (last as usize + 1).max(self.names.len())
    }

    /// Number of the region with this name or number.
    pub fn find(&self, key: &str) -> Option<usize> {
        let by_number = || {
            key.parse::<usize>()
                .ok()
                .filter(|number| self.names.is_empty() && *number < self.count())
        };
        self.names
            .iter()
            .position(|name| name == key)
            .or_else(by_number)
    }

    /// Name, or number, of a region.
    pub fn name(&self, region: usize) -> String {
        self.names
            .get(region)
            .cloned()
            .unwrap_or_else(|| region.to_string())
    }
}

/// Reads the regions of `vertices` vertices.
///
/// # Errors
/// Names file and line of a vertex that is not there, is named twice or not at all, and of a region that is none.
pub fn read(file: &Path, vertices: usize) -> Result<RegionTable, Fault> {
    let rows = rows(file)?;
    let has_names = rows
        .iter()
        .any(|row| !is_bare(&row.region) && row.region.parse::<i32>().is_err());
    let mut table = RegionTable {
        regions: vec![UNSET; vertices],
        names: Vec::new(),
    };
    for row in &rows {
        let at = |problem: String| {
            Fault::Input(format!("{}, line {}: {problem}", file.display(), row.line))
        };
        let vertex = row
            .vertex
            .parse::<usize>()
            .ok()
            .filter(|vertex| *vertex < vertices);
        let vertex = vertex.ok_or_else(|| {
            at(format!(
                "there is no vertex {:?}; the hand has {vertices}, numbered from 0",
                row.vertex
            ))
        })?;
        if table.regions[vertex] != UNSET {
            return Err(at(format!(
                "vertex {vertex} already has a region; name every vertex once"
            )));
        }
        table.regions[vertex] = match row.region.as_str() {
            bare if is_bare(bare) => -1,
            name if has_names => table.number_of(name),
            number => number
                .parse::<i32>()
                .ok()
                .filter(|number| (0..=LAST_REGION).contains(number))
                .ok_or_else(|| {
                    at(format!(
                        "region {number} is not from 0 to {LAST_REGION} or -1"
                    ))
                })?,
        };
    }
    if let Some(vertex) = table.regions.iter().position(|region| *region == UNSET) {
        let file = file.display();
        return Err(Fault::Input(format!(
            "{file}: vertex {vertex} has no region; add it, with -1 for no skin"
        )));
    }
    Ok(table)
}

impl RegionTable {
    fn number_of(&mut self, name: &str) -> i32 {
        let known = self.names.iter().position(|known| known == name);
        known.unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.names.len() - 1
        }) as i32
    }
}

struct Row {
    line: u64,
    vertex: String,
    region: String,
}

fn is_bare(region: &str) -> bool {
    matches!(region, "" | "-1" | "none")
}

fn rows(file: &Path) -> Result<Vec<Row>, Fault> {
    let mut table = Table::open(file, "a CSV of vertex,region")?;
    let column = |name: &str| table.columns.iter().position(|column| column == name);
    let (Some(vertex), Some(region)) = (column("vertex"), column("region")) else {
        let problem = "the first line must name the columns vertex,region";
        return Err(Fault::Input(format!(
            "{}, line 1: {problem}",
            file.display()
        )));
    };
    let mut rows = Vec::new();
    for record in table.records() {
        let (line, record) = record?;
        let field = |column: usize| record.get(column).unwrap_or_default().to_owned();
        rows.push(Row {
            line,
            vertex: field(vertex),
            region: field(region),
        });
    }
    Ok(rows)
}
