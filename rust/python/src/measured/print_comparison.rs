//! `thenar.compare_print`: a handprint next to a contact that was solved.

use crate::conversion::arrays::Argument;
use crate::conversion::running::{Hooks, run};
use crate::measured::comparison::{Comparison, mat_of};
use crate::measured::prints::{Print, refused};
use pyo3::prelude::*;
use std::sync::Arc;
use thenar_comparison::{Pressed, StillPrint, compare_print as compare};
use thenar_surface::{Mesh, vertex_areas};

/// Compares a print with a contact that was solved: overlap, areas and where they differ. Only the paper's pose is fitted.
///
/// `mat` is the record that `place_mat` gives for the print. The contact as in `compare_map`; skin leaves ink where it presses with more
/// than `ink_kpa`. `regions` (m,) and `region_names` tell the result by region of the hand. Raises `MeshError`, `RecordingError`.
#[pyfunction]
#[pyo3(signature = (print, mat, vertices_mm, triangles, force_n, *, ink_kpa=0.0, regions=None, region_names=Vec::new(), name="print",
    product="product", hand="hand"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keywords of the public interface"
)]
pub fn compare_print(
    py: Python<'_>,
    print: &Print,
    mat: &Bound<'_, PyAny>,
    vertices_mm: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    force_n: &Bound<'_, PyAny>,
    ink_kpa: f64,
    regions: Option<Vec<i32>>,
    region_names: Vec<String>,
    name: &str,
    product: &str,
    hand: &str,
) -> PyResult<Comparison> {
    let (mat, cells) = mat_of(mat)?;
    let handprint = Arc::clone(print.inner());
    if cells.len() != handprint.inked.len() {
        return Err(refused(&format!(
            "mat: it has {} cells and the print {}; lay this print with place_mat",
            cells.len(),
            handprint.inked.len()
        )));
    }
    if ink_kpa.is_nan() || ink_kpa < 0.0 {
        return Err(refused("ink_kpa: give a pressure from 0 on, kPa"));
    }
    let inked: Vec<f64> = (0..cells.len())
        .filter(|k| cells[*k])
        .map(|k| handprint.inked[k])
        .collect();
    let positions = Argument::mesh("vertices_mm", vertices_mm).points()?;
    let triangles = Argument::mesh("triangles", triangles).triangles(positions.len())?;
    let force_n = Argument::solve("force_n", force_n).numbers_of(positions.len())?;
    let regions = regions.unwrap_or_default();
    if !regions.is_empty() && regions.len() != positions.len() {
        return Err(refused(&format!(
            "regions: it has {} entries and vertices_mm {}; give one for each vertex",
            regions.len(),
            positions.len()
        )));
    }
    let (name, product, hand) = (name.to_string(), product.to_string(), hand.to_string());
    let inner = run(py, &Hooks::none(), move |_| {
        let mesh = Mesh::new(positions, triangles)?;
        let mut unknown = handprint.unknown.clone();
        unknown.extend(handprint.warnings.iter().cloned());
        let still = StillPrint {
            name: &name,
            product: &product,
            hand: &hand,
            pressed: Pressed {
                positions: mesh.positions(),
                areas: &vertex_areas(&mesh),
                force_n: &force_n,
            },
            mat,
            inked: &inked,
            ink_kpa,
            regions: (&regions, &region_names),
            unknown,
        };
        Ok(compare(still)?)
    })?;
    Ok(Comparison::new(inner))
}
