//! `thenar.Contact`: the result of a press as numpy arrays and records.

use crate::arrays::{Argument, column, rows, triple, zeros};
use crate::contact_records as records;
use crate::record::Once;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::sync::Arc;
use thenar_surface::Vec3;

/// The result of a press. Arrays over vertices are in the order of the skin's vertices.
#[pyclass(frozen, module = "thenar")]
pub struct Contact {
    result: thenar_contact::Contact,
    region_names: Arc<Vec<String>>,
    made: Made,
}

/// Arrays and records that were asked for: making all of them takes as long as a tenth of a live press.
#[derive(Default)]
struct Made {
    displacement_mm: Once,
    pressure_mpa: Once,
    force_n: Once,
    gap_mm: Once,
    in_contact: Once,
    product_normal: Once,
    total_force_n: Once,
    total_moment_nmm: Once,
    center_of_pressure_mm: Once,
    regions: Once,
    product_pressure_mpa: Once,
    direction: Once,
    adhesion_force_n: Once,
    tangential_force_n: Once,
    tangential_traction_mpa: Once,
    slip_mm: Once,
    slip_margin: Once,
    is_sticking: Once,
    friction: Once,
    residual: Once,
    convergence: Once,
    warnings: Once,
    seconds: Once,
}

impl Contact {
    /// `region_names` is empty or has one name per region.
    pub fn new(result: thenar_contact::Contact, region_names: Arc<Vec<String>>) -> Contact {
        Contact {
            result,
            region_names,
            made: Made::default(),
        }
    }

    fn count(&self) -> usize {
        self.result.gap.len()
    }
}

/// What a mat needs of a contact.
pub struct PressedSkin {
    pub displacement: Vec<Vec3>,
    pub force: Vec<f64>,
    pub pressure: Vec<f64>,
    pub direction: Vec3,
    pub offset: f64,
}

impl Contact {
    /// What a mat needs, out of Python again: its arrays can be written to.
    pub fn pressed(&self, py: Python<'_>) -> PyResult<PressedSkin> {
        let displacement = self.displacement_mm(py)?;
        let displacement = Argument::mesh("displacement_mm", displacement.bind(py)).points()?;
        let count = displacement.len();
        let numbers =
            |name: &str, values: Py<PyAny>| Argument::mesh(name, values.bind(py)).numbers_of(count);
        Ok(PressedSkin {
            force: numbers("force_n", self.force_n(py)?)?,
            pressure: numbers("pressure_mpa", self.pressure_mpa(py)?)?,
            direction: Argument::mesh("direction", self.direction(py)?.bind(py)).vector()?,
            offset: self.result.offset,
            displacement,
        })
    }
}

#[pymethods]
impl Contact {
    /// (n, 3), mm, to be added to the posed positions.
    #[getter]
    fn displacement_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .displacement_mm
            .get(py, || rows(py, &self.result.displacement))
    }

    /// (n,), MPa.
    #[getter]
    fn pressure_mpa(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .pressure_mpa
            .get(py, || Ok(column(py, self.result.pressure.clone())))
    }

    /// (n,), N, normal force per vertex.
    #[getter]
    fn force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .force_n
            .get(py, || Ok(column(py, self.result.nodal_force.clone())))
    }

    /// (n,), mm, signed distance before deformation, inf beyond reach.
    #[getter]
    fn gap_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .gap_mm
            .get(py, || Ok(column(py, self.result.gap.clone())))
    }

    /// (n,), bool.
    #[getter]
    fn in_contact(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .in_contact
            .get(py, || Ok(column(py, is_loaded(&self.result.nodal_force))))
    }

    /// (n, 3), the product's outward normal where the vertex touches, else zero.
    #[getter]
    fn product_normal(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .product_normal
            .get(py, || rows(py, &self.result.normal))
    }

    /// (3,), N, on the product.
    #[getter]
    fn total_force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .total_force_n
            .get(py, || Ok(triple(py, self.result.total_force)))
    }

    /// (3,), N mm, of that force about the origin.
    #[getter]
    fn total_moment_nmm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .total_moment_nmm
            .get(py, || Ok(triple(py, self.result.total_moment)))
    }

    /// (3,), mm.
    #[getter]
    fn center_of_pressure_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .center_of_pressure_mm
            .get(py, || Ok(triple(py, self.result.center_of_pressure)))
    }

    #[getter]
    fn contact_area_mm2(&self) -> f64 {
        self.result.contact_area
    }

    #[getter]
    fn peak_pressure_mpa(&self) -> f64 {
        self.result.peak_pressure
    }

    #[getter]
    fn mean_pressure_mpa(&self) -> f64 {
        self.result.mean_pressure
    }

    /// Largest mean pressure over 24 mm2, a mat's sensel.
    #[getter]
    fn patch_peak_mpa(&self) -> f64 {
        self.result.patch_peak
    }

    /// A record per region: index, name, force_n, area_mm2, peak_mpa, mean_mpa, dmax_mm, g_mpa.
    #[getter]
    fn regions(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made.regions.get(py, || {
            records::regions(py, &self.result.regions, &self.region_names)
        })
    }

    /// (k,), MPa, one per product vertex, force conserving.
    #[getter]
    fn product_pressure_mpa(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .product_pressure_mpa
            .get(py, || Ok(column(py, self.result.product_pressure.clone())))
    }

    /// Travel of the product along `direction`, mm.
    #[getter]
    fn offset_mm(&self) -> f64 {
        self.result.offset
    }

    /// (3,), direction of travel, or of the mean normal force without force control.
    #[getter]
    fn direction(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .direction
            .get(py, || Ok(triple(py, self.result.direction)))
    }

    /// (n,), N, attraction towards the product, >= 0; zero without adhesion. Force and pressure are those of contact alone.
    #[getter]
    fn adhesion_force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .adhesion_force_n
            .get(py, || Ok(column(py, self.result.adhesion.clone())))
    }

    /// (n, 3), N, shear force on the skin; zero without friction and drag.
    #[getter]
    fn tangential_force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .tangential_force_n
            .get(py, || match &self.result.shear {
                None => Ok(zeros::<f64, _>(py, [self.count(), 3])),
                Some(shear) => rows(py, &shear.force),
            })
    }

    /// (n,), MPa, its length over the vertex area.
    #[getter]
    fn tangential_traction_mpa(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .tangential_traction_mpa
            .get(py, || match &self.result.shear {
                None => Ok(zeros::<f64, _>(py, [self.count()])),
                Some(shear) => Ok(column(py, shear.traction.clone())),
            })
    }

    /// (n, 3), mm, slip of the skin over the product.
    #[getter]
    fn slip_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made.slip_mm.get(py, || match &self.result.shear {
            None => Ok(zeros::<f64, _>(py, [self.count(), 3])),
            Some(shear) => rows(py, &shear.slip),
        })
    }

    /// (n,), 1 - shear force / (coefficient x normal force); nan where no friction acts.
    #[getter]
    fn slip_margin(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made.slip_margin.get(py, || match &self.result.shear {
            None => Ok(column(py, vec![f64::NAN; self.count()])),
            Some(shear) => Ok(column(py, shear.margin.clone())),
        })
    }

    /// (n,), bool, in contact and not slipping.
    #[getter]
    fn is_sticking(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made.is_sticking.get(py, || match &self.result.shear {
            None => Ok(zeros::<bool, _>(py, [self.count()])),
            Some(shear) => Ok(column(py, shear.is_sticking.clone())),
        })
    }

    /// A record of the drag, None without: total_force_n (3,) on the skin, slide_mm (3,), twist_rad (3,), dissipated_nmm,
    /// stored_nmm, residual.
    #[getter]
    fn friction(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .friction
            .get(py, || records::friction(py, self.result.shear.as_ref()))
    }

    /// A record: complementarity, penetration_mm, load_balance, far_field.
    #[getter]
    fn residual(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .residual
            .get(py, || records::residual(py, &self.result.residual))
    }

    /// A record: has_converged, passes, pivots, cg_steps.
    #[getter]
    fn convergence(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .convergence
            .get(py, || records::convergence(py, &self.result.convergence))
    }

    /// Sentences for the user.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made.warnings.get(py, || {
            Ok(PyList::new(py, &self.result.warnings)?.into_any().unbind())
        })
    }

    /// A record of wall time by stage, s.
    #[getter]
    fn seconds(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.made
            .seconds
            .get(py, || records::seconds(py, &self.result))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let force: [f64; 3] = self.total_force_n(py)?.extract(py)?;
        let newton = force.iter().map(|part| part * part).sum::<f64>().sqrt();
        Ok(format!(
            "<thenar.Contact: {newton:.3} N on {:.1} mm2, peak {:.1} kPa>",
            self.result.contact_area,
            1e3 * self.result.peak_pressure
        ))
    }
}

fn is_loaded(forces: &[f64]) -> Vec<bool> {
    forces.iter().map(|force| *force > 0.0).collect()
}
