//! `thenar.Product`: a mesh prepared once for many presses and signed-distance queries.

use crate::conversion::arrays::{Argument, column, rows};
use crate::conversion::errors::{Failure, MeshError};
use crate::conversion::running::{Hooks, run};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;
use thenar_contact::Control;
use thenar_surface::{Gap, GapLimits, Mesh, Vec3};

/// Points asked between two looks at `cancel`.
const CHUNK: usize = 4096;

/// A product prepared for distance queries. Safe to use from several threads.
///
/// `vertices_mm` (n, 3), `triangles` (m, 3). Raises `MeshError`.
#[pyclass(frozen, module = "thenar")]
pub struct Product(pub Arc<thenar_surface::Product>);

/// Vertices and triangles as they came from Python, checked by shape and type.
pub struct Surface {
    pub vertices: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// # Errors
    /// `MeshError` naming the argument.
    pub fn new(vertices: Argument<'_, '_>, triangles: Argument<'_, '_>) -> PyResult<Surface> {
        let vertices = vertices.points()?;
        let triangles = triangles.triangles(vertices.len())?;
        Ok(Surface {
            vertices,
            triangles,
        })
    }

    /// Builds the tree; long for large meshes.
    pub fn into_product(self) -> Result<Arc<thenar_surface::Product>, thenar_surface::MeshError> {
        thenar_surface::Product::new(Mesh::new(self.vertices, self.triangles)?).map(Arc::new)
    }
}

#[pymethods]
impl Product {
    #[new]
    fn new(
        py: Python<'_>,
        vertices_mm: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
    ) -> PyResult<Product> {
        let surface = Surface::new(
            Argument::mesh("vertices_mm", vertices_mm),
            Argument::mesh("triangles", triangles),
        )?;
        run(py, &Hooks::none(), move |_| {
            Ok(Product(surface.into_product()?))
        })
    }

    /// Sentences about the mesh: open edges, flipped parts and the like.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings().to_vec()
    }

    /// (l,), bool: triangles of sheets without thickness, which have two sides and no inside.
    #[getter]
    fn is_sheet(&self, py: Python<'_>) -> Py<PyAny> {
        let triangles = 0..self.0.mesh().triangles().len();
        column(py, triangles.map(|t| self.0.is_sheet(t)).collect())
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.0.mesh().positions().len()
    }

    #[getter]
    fn triangle_count(&self) -> usize {
        self.0.mesh().triangles().len()
    }

    /// Signed distance of points to the product, mm: > 0 outside, < 0 inside.
    ///
    /// `points_mm` (n, 3); `skin_normals` (n, 3), outward normals of the skin at the points, keep deep points of thin
    /// products on their side; outside farther than `cut_off_mm`: no answer.
    /// Returns a dict of `gap_mm` (n,) inf without answer, `closest_mm` (n, 3) and `normal` (n, 3) NaN without answer,
    /// `triangle` (n,) -1 without answer.
    #[pyo3(signature = (points_mm, skin_normals=None, cut_off_mm=None, max_depth_mm=None, *, cancel=None, progress=None))]
    #[expect(
        clippy::too_many_arguments,
        reason = "keywords of the public interface"
    )]
    fn gap_mm<'py>(
        &self,
        py: Python<'py>,
        points_mm: &Bound<'py, PyAny>,
        skin_normals: Option<&Bound<'py, PyAny>>,
        cut_off_mm: Option<&Bound<'py, PyAny>>,
        max_depth_mm: Option<&Bound<'py, PyAny>>,
        cancel: Option<Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let points = Argument::mesh("points_mm", points_mm).points()?;
        let normals = skin_normals
            .map(|normals| Argument::mesh("skin_normals", normals).points())
            .transpose()?;
        if let Some(normals) = normals
            .as_ref()
            .filter(|normals| normals.len() != points.len())
        {
            let (found, expected) = (normals.len(), points.len());
            return Err(MeshError::new_err(format!(
                "skin_normals: {found} rows for {expected} points; give one per point"
            )));
        }
        let limits = GapLimits {
            cut_off_mm: limit("cut_off_mm", cut_off_mm)?,
            max_depth_mm: limit("max_depth_mm", max_depth_mm)?,
        };
        let product = Arc::clone(&self.0);
        let work =
            move |control: &Control| gaps(&product, &points, normals.as_deref(), limits, control);
        answer(py, &run(py, &Hooks::new(cancel, progress)?, work)?)
    }

    fn __repr__(&self) -> String {
        format!(
            "<thenar.Product: {} vertices, {} triangles>",
            self.vertex_count(),
            self.triangle_count()
        )
    }
}

fn limit(name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
    let Some(value) = value else {
        return Ok(f64::INFINITY);
    };
    let argument = Argument::mesh(name, value);
    match argument.number()? {
        limit if limit < 0.0 => Err(argument.fault(format_args!(
            "{limit} is negative; give 0 or more, or leave it out"
        ))),
        limit => Ok(limit),
    }
}

fn gaps(
    product: &thenar_surface::Product,
    points: &[Vec3],
    normals: Option<&[Vec3]>,
    limits: GapLimits,
    control: &Control,
) -> Result<Vec<Option<Gap>>, Failure> {
    let mut gaps = Vec::with_capacity(points.len());
    for part in points.chunks(CHUNK) {
        let done = gaps.len();
        control.step("distances", done as f64 / points.len() as f64)?;
        let normals = normals.map(|normals| &normals[done..done + part.len()]);
        gaps.extend(product.gaps(part, normals, limits));
    }
    Ok(gaps)
}

fn answer<'py>(py: Python<'py>, gaps: &[Option<Gap>]) -> PyResult<Bound<'py, PyDict>> {
    let nowhere = Vec3::repeat(f64::NAN);
    let each = |value: fn(&Gap) -> Vec3| {
        gaps.iter()
            .map(|gap| gap.as_ref().map_or(nowhere, value))
            .collect::<Vec<_>>()
    };
    let answer = PyDict::new(py);
    answer.set_item(
        "gap_mm",
        column(
            py,
            gaps.iter()
                .map(|gap| gap.as_ref().map_or(f64::INFINITY, |gap| gap.distance))
                .collect(),
        ),
    )?;
    answer.set_item("closest_mm", rows(py, &each(|gap| gap.closest))?)?;
    answer.set_item("normal", rows(py, &each(|gap| gap.normal))?)?;
    answer.set_item(
        "triangle",
        column(
            py,
            gaps.iter()
                .map(|gap| gap.as_ref().map_or(-1, |gap| i64::from(gap.triangle)))
                .collect(),
        ),
    )?;
    Ok(answer)
}
