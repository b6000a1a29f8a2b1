//! A mat laid on any mesh by its UV map: each sensel where the chart that holds its center lies on the surface.

use super::seat::{Steps, steps};
use super::sensels::PlacedSensel;
use crate::RecordingError;
use crate::fault::Fault;
use crate::meshes::{Charted, read_charts};
use crate::pressure_map::{PressureMap, Sensel};
use crate::study::place::Folder;
use crate::study::toml_tree::Section;
use nalgebra::Vector3;
use std::collections::HashMap;

/// How far outside of its chart a center may lie and be on its edge, in barycentric weights.
const EDGE: f64 = 1e-9;
/// Two charts that hold a center put it on one place of the surface if it is the same within this, mm: they share an edge.
const ONE_PLACE: f64 = 1e-6;
/// Cells along the UV map's box in which charts are looked up.
const CELLS: usize = 256;

/// What becomes of a cell outside of every chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::study) enum OffChart {
    /// A sensel must lie on the product.
    Refused,
    /// A cell of a print that shows no ink lies on no product; one that does must.
    Blank,
}

/// Reads the table `placing` of a recording whose mat lies on a mesh, and places every sensel of the map, in its order; `None` for a cell
/// that is missing in every frame.
pub(in crate::study) fn place(
    section: &mut Section,
    (map, off): (&PressureMap, OffChart),
    folder: &Folder,
) -> Result<Vec<Option<PlacedSensel>>, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let Some(entry) = section.get("file") else {
        let needs = section.needs("file", "name the product's mesh, an OBJ with UVs");
        return Err(here(needs));
    };
    let atlas = Atlas::new(read_charts(&folder.file(&entry)?)?);
    let mut pair = |key, default| section.pair(key).map(|pair| pair.unwrap_or(default));
    let corner = pair("corner_uv", [0.0, 0.0]).map_err(here)?;
    let along = [
        pair("columns_uv", [1.0, 0.0]).map_err(here)?,
        pair("rows_uv", [0.0, 1.0]).map_err(here)?,
    ];
    let spanned = along[0][0] * along[1][1] - along[0][1] * along[1][0];
    if spanned == 0.0 {
        let problem = "columns_uv and rows_uv span no area".to_string();
        return Err(here(
            section.fault(problem, "give two directions across each other"),
        ));
    }
    let lie = Lie {
        corner,
        along,
        spanned,
        off,
    };
    let placed = lie.place(map, &atlas);
    placed.map_err(|(problem, remedy)| here(section.fault(problem, remedy)))
}

/// How the flat mat lies in the UV map.
struct Lie {
    corner: [f64; 2],
    along: [[f64; 2]; 2],
    /// Area of the mat in the map, with its sign.
    spanned: f64,
    off: OffChart,
}

impl Lie {
    fn place(
        &self,
        map: &PressureMap,
        atlas: &Atlas,
    ) -> Result<Vec<Option<PlacedSensel>>, (String, &'static str)> {
        let Steps { centers, count } = steps(map)?;
        let [columns, rows] = count;
        let in_map = self.spanned.abs() / (columns * rows);
        let mut placed = Vec::with_capacity(centers.len());
        for (k, ([column, row], sensel)) in centers.iter().zip(&map.sensels).enumerate() {
            let is_missing = (0..map.frames()).all(|frame| map.frame(frame)[k].is_nan());
            if is_missing {
                placed.push(None);
                continue;
            }
            let [x, y] = [column / columns, row / rows];
            let at = [0, 1].map(|c| self.corner[c] + x * self.along[0][c] + y * self.along[1][c]);
            let spot = atlas.spot(at);
            let is_blank = (0..map.frames()).all(|frame| map.frame(frame)[k] == 0.0);
            if spot.is_err() && is_blank && self.off == OffChart::Blank {
                placed.push(None);
                continue;
            }
            let spot =
                spot.map_err(|(problem, remedy)| (format!("{} {problem}", named(sensel)), remedy))?;
            placed.push(Some(PlacedSensel {
                center_mm: spot.point.into(),
                normal: Some(spot.normal.into()),
                area_mm2: sensel.area_mm2.unwrap_or(in_map * spot.stretch),
            }));
        }
        Ok(placed)
    }
}

fn named(sensel: &Sensel) -> String {
    let [row, column] = sensel.place.unwrap_or_default();
    format!("the sensel in row {row}, column {column}")
}

/// A place of the surface.
struct Spot {
    point: Vector3<f64>,
    normal: Vector3<f64>,
    /// mm2 of surface for each unit of area of the map.
    stretch: f64,
    triangle: usize,
}

/// A mesh with its charts, found by place in the map.
struct Atlas {
    charted: Charted,
    low: [f64; 2],
    size: [f64; 2],
    cells: HashMap<[usize; 2], Vec<u32>>,
}

impl Atlas {
    fn new(charted: Charted) -> Atlas {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in charted.charts.iter().flatten() {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = [0, 1].map(|axis| (high[axis] - low[axis]).max(f64::MIN_POSITIVE));
        let mut atlas = Atlas {
            cells: HashMap::new(),
            charted,
            low,
            size,
        };
        for triangle in 0..atlas.charted.charts.len() {
            let chart = atlas.charted.charts[triangle];
            let ends = |pick: fn(f64, f64) -> f64| {
                let of = |axis: usize| pick(pick(chart[0][axis], chart[1][axis]), chart[2][axis]);
                atlas.cell([of(0), of(1)])
            };
            let ([a, b], [c, d]) = (ends(f64::min), ends(f64::max));
            for i in a..=c {
                for j in b..=d {
                    atlas.cells.entry([i, j]).or_default().push(triangle as u32);
                }
            }
        }
        atlas
    }

    fn cell(&self, at: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|axis| {
            let share = (at[axis] - self.low[axis]) / self.size[axis];
            ((share * CELLS as f64) as usize).min(CELLS - 1)
        })
    }

    /// The place of the surface at a place of the map.
    fn spot(&self, at: [f64; 2]) -> Result<Spot, (String, &'static str)> {
        let [u, v] = at;
        let here = self
            .cells
            .get(&self.cell(at))
            .map_or(&[][..], Vec::as_slice);
        let mut found: Option<Spot> = None;
        for spot in here
            .iter()
            .filter_map(|triangle| self.on(*triangle as usize, at))
        {
            match &found {
                Some(other) if (other.point - spot.point).norm() > ONE_PLACE => {
                    let problem = format!(
                        "lies at ({u:.4}, {v:.4}) of the UV map, where the charts of triangles {} and {} overlap",
                        other.triangle, spot.triangle
                    );
                    return Err((
                        problem,
                        "unwrap the mesh so that no charts overlap under the mat",
                    ));
                }
                Some(_) => {}
                None => found = Some(spot),
            }
        }
        found.ok_or_else(|| {
            let problem = format!("lies at ({u:.4}, {v:.4}) of the UV map, outside of every chart");
            (
                problem,
                "check corner_uv, columns_uv and rows_uv, or the unwrapping",
            )
        })
    }

    /// The place on a triangle, if its chart holds the place of the map.
    fn on(&self, triangle: usize, [u, v]: [f64; 2]) -> Option<Spot> {
        let [a, b, c] = self.charted.charts[triangle];
        let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        let from = |p: [f64; 2]| [p[0] - a[0], p[1] - a[1]];
        let (ab, ac, ap) = (from(b), from(c), from([u, v]));
        let twice = cross(ab, ac);
        let (second, third) = (cross(ap, ac) / twice, cross(ab, ap) / twice);
        let weights = [1.0 - second - third, second, third];
        // A chart without area gives NaN, which holds nothing.
        if !weights.iter().all(|weight| *weight >= -EDGE) {
            return None;
        }
        let corners = self.charted.mesh.triangles[triangle];
        let corners = corners.map(|vertex| self.charted.mesh.positions[vertex as usize]);
        let point = corners.iter().zip(weights).map(|(p, w)| p * w).sum();
        let across = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        Some(Spot {
            point,
            normal: across.try_normalize(1e-300)?,
            stretch: across.norm() / twice.abs(),
            triangle,
        })
    }
}
