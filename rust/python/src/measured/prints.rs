//! `thenar.Print`: a handprint's cells; and a print next to a contact, as a record.

use crate::conversion::arrays::column;
use crate::conversion::errors::{Failure, RecordingError};
use crate::conversion::record::record;
use crate::conversion::running::{Hooks, run};
use crate::measured::recordings::path;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;
use thenar_comparison::{PosePart, Printed};
use thenar_recordings::PressureMap;
use thenar_recordings::handprint::{Handprint, Ink, PrintOptions, Scale};

/// The image of a print in ink as shares of ink by cell: where skin touched, never how hard.
///
/// Looking at the inked side, columns count from left to right and rows from the lower edge up; `place_mat` takes it as it takes a file.
#[pyclass(frozen, module = "thenar")]
pub struct Print {
    inner: Arc<Handprint>,
}

impl Print {
    /// Of a handprint.
    pub fn new(print: Handprint) -> Print {
        Print {
            inner: Arc::new(print),
        }
    }

    /// Its cells and what its image says.
    pub fn inner(&self) -> &Arc<Handprint> {
        &self.inner
    }

    /// Its cells as a mat's.
    pub fn as_map(&self) -> PressureMap {
        self.inner.as_map()
    }
}

#[pymethods]
impl Print {
    /// Reads a PNG, JPEG or TIFF; what is transparent is no paper. The scale is `dpi`, `mm_per_px`, or two marks, `marks_px` ((x, y), (x, y))
    /// `marks_mm` apart. `cell_mm` is the side of a cell, `threshold` the brightness between ink and paper, 0 to 1 (None: Otsu's), `ink`
    /// "dark" or "light" (None: paper is what most of its edge is), `paper_px` the sheet (left, top, right, bottom), and `mirrored` says that
    /// the image shows the print from behind. Raises `RecordingError`.
    #[staticmethod]
    #[pyo3(signature = (file, *, dpi=None, mm_per_px=None, marks_px=None, marks_mm=None, cell_mm=2.5, threshold=None, ink=None,
        paper_px=None, mirrored=false))]
    #[expect(
        clippy::too_many_arguments,
        reason = "keywords of the public interface"
    )]
    fn read(
        py: Python<'_>,
        file: &Bound<'_, PyAny>,
        dpi: Option<f64>,
        mm_per_px: Option<f64>,
        marks_px: Option<[[f64; 2]; 2]>,
        marks_mm: Option<f64>,
        cell_mm: f64,
        threshold: Option<f64>,
        ink: Option<&str>,
        paper_px: Option<[f64; 4]>,
        mirrored: bool,
    ) -> PyResult<Print> {
        let file = path("file", file)?;
        let marks = marks_px.zip(marks_mm).map(|(px, mm)| Scale::Marks(px, mm));
        let scales = [dpi.map(Scale::Dpi), mm_per_px.map(Scale::MmPerPixel), marks];
        let mut scales = scales.into_iter().flatten();
        let (Some(scale), None) = (scales.next(), scales.next()) else {
            return Err(refused(
                "give one scale of the print: dpi, mm_per_px, or marks_px with marks_mm",
            ));
        };
        let ink = ink.map(|name| Ink::named(name).ok_or(name)).transpose();
        let ink = ink.map_err(|name| {
            refused(&format!(
                "ink '{name}' is not known; give \"dark\" or \"light\""
            ))
        })?;
        let options = PrintOptions {
            scale,
            cell_mm,
            threshold,
            ink,
            paper_px,
            is_mirrored: mirrored,
        };
        let print = run(py, &Hooks::new(None, None)?, move |_| {
            Handprint::read(&file, &options).map_err(Failure::Recording)
        })?;
        Ok(Print::new(print))
    }

    /// Share of ink by cell (n,), row by row from the lower edge; NaN where less than half of the cell is paper.
    #[getter]
    fn inked(&self, py: Python<'_>) -> Py<PyAny> {
        column(py, self.inner.inked.clone())
    }

    /// Rows and columns of cells.
    #[getter]
    fn cells(&self) -> (usize, usize) {
        (self.inner.cells[0], self.inner.cells[1])
    }

    #[getter]
    fn cell_mm(&self) -> f64 {
        self.inner.cell_mm
    }

    #[getter]
    fn mm_per_px(&self) -> f64 {
        self.inner.mm_per_px
    }

    /// Width and height of the image.
    #[getter]
    fn size_px(&self) -> (usize, usize) {
        (self.inner.size_px[0], self.inner.size_px[1])
    }

    /// Area of the inked pixels.
    #[getter]
    fn inked_mm2(&self) -> f64 {
        self.inner.inked_mm2
    }

    /// Brightness between ink and paper, 0 to 1.
    #[getter]
    fn threshold(&self) -> f64 {
        self.inner.threshold
    }

    /// "dark" or "light".
    #[getter]
    fn ink(&self) -> &'static str {
        self.inner.ink.name()
    }

    #[getter]
    fn unknown(&self) -> Vec<String> {
        self.inner.unknown.clone()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.warnings.clone()
    }

    fn __repr__(&self) -> String {
        let [rows, columns] = self.inner.cells;
        format!(
            "<Print of {rows} x {columns} cells of {} mm, {:.0} mm2 inked>",
            self.inner.cell_mm, self.inner.inked_mm2
        )
    }
}

/// What a print shows next to a contact, as a record.
pub fn printed(py: Python<'_>, print: &Printed) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("recorded_share", column(py, print.recorded.clone()))?;
    entries.set_item("simulated_share", column(py, print.simulated.clone()))?;
    entries.set_item("simulated_share_as_laid", column(py, print.as_laid.clone()))?;
    entries.set_item("cell_residual", column(py, print.by_cell()))?;
    entries.set_item("ink_kpa", print.ink_kpa)?;
    let part = |part: &PosePart| (part.value, part.low, part.high);
    entries.set_item("columns_mm", part(&print.pose[0]))?;
    entries.set_item("rows_mm", part(&print.pose[1]))?;
    entries.set_item("turn_rad", part(&print.pose[2]))?;
    entries.set_item("mirrored_overlap", print.mirrored_overlap)?;
    entries.set_item("is_mirrored", print.is_mirrored)?;
    let mut regions = Vec::new();
    for region in &print.regions {
        let row = PyDict::new(py);
        row.set_item("name", &region.name)?;
        row.set_item("recorded_mm2", region.recorded_mm2)?;
        row.set_item("simulated_mm2", region.simulated_mm2)?;
        row.set_item("overlap", region.overlap)?;
        regions.push(record(row)?);
    }
    entries.set_item("regions", regions)?;
    entries.set_item("print_residual", column(py, print.on_skin.clone()))?;
    entries.set_item("force_beside_share", print.beside)?;
    entries.set_item("is_at_end", print.is_at_end)?;
    record(entries)
}

/// A print, or what goes with it, that cannot be used.
pub fn refused(sentence: &str) -> PyErr {
    RecordingError::new_err(sentence.to_string())
}
