//! `thenar.Contact`: the result of a press as numpy arrays and records.

use crate::conversion::arrays::{Argument, column, owned_rows, triple, zeros};
use crate::conversion::record::Once;
use crate::press::contact_records as records;
use crate::press::product::Product;
use crate::press::skin::PressedGrip;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};
use std::mem::take;
use std::sync::Arc;
use thenar_contact::{Convergence, Grade, RegionResult, Residual, Shear, Warning};
use thenar_surface::Vec3;

/// The result of a press. Arrays over vertices are in the order of the skin's vertices.
///
/// Most of it is made for Python when it is asked for: Live reads a few arrays of each of its presses.
#[pyclass(frozen, module = "thenar")]
pub struct Contact {
    vertices: usize,
    region_names: Arc<Vec<String>>,
    displacement_mm: Once<Vec<Vec3>>,
    pressure_mpa: Once<Vec<f64>>,
    force_n: Once<Vec<f64>>,
    gap_mm: Once<Vec<f64>>,
    in_contact: Once<Vec<bool>>,
    product_normal: Once<Vec<Vec3>>,
    total_force_n: Once<Vec3>,
    total_moment_nmm: Once<Vec3>,
    center_of_pressure_mm: Once<Vec3>,
    contact_area_mm2: f64,
    peak_pressure_mpa: f64,
    mean_pressure_mpa: f64,
    patch_peak_mpa: f64,
    regions: Once<Vec<RegionResult>>,
    product_pressure_mpa: Once<Vec<f64>>,
    offset_mm: f64,
    direction: Once<Vec3>,
    adhesion_force_n: Once<Vec<f64>>,
    tangential_force_n: Once<Option<Vec<Vec3>>>,
    tangential_traction_mpa: Once<Option<Vec<f64>>>,
    slip_mm: Once<Option<Vec<Vec3>>>,
    slip_margin: Once<Option<Vec<f64>>>,
    is_sticking: Once<Option<Vec<bool>>>,
    friction: Once<Option<Shear>>,
    residual: Once<Residual>,
    convergence: Once<Convergence>,
    warnings: Once<Vec<String>>,
    remarks: Once<Vec<Warning>>,
    grade: Once<Grade>,
    reason: Once<Option<String>>,
    seconds: Once<Vec<(&'static str, f64)>>,
    grip_displacement_mm: Once<Option<Vec<Vec3>>>,
    pressed_product: Option<Arc<thenar_surface::Product>>,
}

impl Contact {
    /// With what a soft grip did.
    pub fn with_grip(mut self, grip: Option<PressedGrip>) -> Contact {
        if let Some((displacement, product)) = grip {
            self.grip_displacement_mm = Once::new(Some(displacement));
            self.pressed_product = Some(product);
        }
        self
    }

    /// Takes the result over; `region_names` is empty or has one name per region.
    pub fn new(result: thenar_contact::Contact, region_names: Arc<Vec<String>>) -> Contact {
        let (grade, reason) = (result.grade(), result.reason().map(Warning::to_string));
        let mut shear = result.shear;
        Contact {
            in_contact: Once::new(is_loaded(&result.nodal_force)),
            vertices: result.gap.len(),
            displacement_mm: Once::new(result.displacement),
            pressure_mpa: Once::new(result.pressure),
            force_n: Once::new(result.nodal_force),
            gap_mm: Once::new(result.gap),
            product_normal: Once::new(result.normal),
            total_force_n: Once::new(result.total_force),
            total_moment_nmm: Once::new(result.total_moment),
            center_of_pressure_mm: Once::new(result.center_of_pressure),
            contact_area_mm2: result.contact_area,
            peak_pressure_mpa: result.peak_pressure,
            mean_pressure_mpa: result.mean_pressure,
            patch_peak_mpa: result.patch_peak,
            regions: Once::new(result.regions),
            product_pressure_mpa: Once::new(result.product_pressure),
            offset_mm: result.offset,
            direction: Once::new(result.direction),
            adhesion_force_n: Once::new(result.adhesion),
            tangential_force_n: Once::new(shear.as_mut().map(|shear| take(&mut shear.force))),
            tangential_traction_mpa: Once::new(
                shear.as_mut().map(|shear| take(&mut shear.traction)),
            ),
            slip_mm: Once::new(shear.as_mut().map(|shear| take(&mut shear.slip))),
            slip_margin: Once::new(shear.as_mut().map(|shear| take(&mut shear.margin))),
            is_sticking: Once::new(shear.as_mut().map(|shear| take(&mut shear.is_sticking))),
            residual: Once::new(result.residual),
            convergence: Once::new(result.convergence),
            grade: Once::new(grade),
            reason: Once::new(reason),
            warnings: Once::new(result.warnings.iter().map(Warning::to_string).collect()),
            remarks: Once::new(result.warnings),
            seconds: Once::new(result.seconds),
            friction: Once::new(shear),
            grip_displacement_mm: Once::new(None),
            pressed_product: None,
            region_names,
        }
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
            offset: self.offset_mm,
            displacement,
        })
    }
}

#[pymethods]
impl Contact {
    /// (n, 3), mm, to be added to the posed positions.
    #[getter]
    fn displacement_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.displacement_mm
            .get(py, |values| owned_rows(py, values))
    }

    /// (k, 3), mm, of the product's vertices as given, where a soft grip covers it: into the core where it yields; None without.
    #[getter]
    fn grip_displacement_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.grip_displacement_mm.get(py, |values| match values {
            Some(values) => owned_rows(py, values),
            None => Ok(py.None()),
        })
    }

    /// The `Product` with its soft grip as it is pressed, where the product was given; None without a grip.
    #[getter]
    fn pressed_product(&self) -> Option<Product> {
        self.pressed_product
            .as_ref()
            .map(|product| Product(Arc::clone(product)))
    }

    /// (n,), MPa.
    #[getter]
    fn pressure_mpa(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.pressure_mpa.get(py, |values| Ok(column(py, values)))
    }

    /// (n,), N, normal force per vertex.
    #[getter]
    fn force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.force_n.get(py, |values| Ok(column(py, values)))
    }

    /// (n,), mm, signed distance before deformation, inf beyond reach.
    #[getter]
    fn gap_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.gap_mm.get(py, |values| Ok(column(py, values)))
    }

    /// (n,), bool.
    #[getter]
    fn in_contact(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.in_contact.get(py, |values| Ok(column(py, values)))
    }

    /// (n, 3), the product's outward normal where the vertex touches, else zero.
    #[getter]
    fn product_normal(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.product_normal.get(py, |values| owned_rows(py, values))
    }

    /// (3,), N, on the product.
    #[getter]
    fn total_force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.total_force_n.get(py, |value| Ok(triple(py, value)))
    }

    /// (3,), N mm, of that force about the origin.
    #[getter]
    fn total_moment_nmm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.total_moment_nmm.get(py, |value| Ok(triple(py, value)))
    }

    /// (3,), mm.
    #[getter]
    fn center_of_pressure_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.center_of_pressure_mm
            .get(py, |value| Ok(triple(py, value)))
    }

    #[getter]
    fn contact_area_mm2(&self) -> f64 {
        self.contact_area_mm2
    }

    #[getter]
    fn peak_pressure_mpa(&self) -> f64 {
        self.peak_pressure_mpa
    }

    #[getter]
    fn mean_pressure_mpa(&self) -> f64 {
        self.mean_pressure_mpa
    }

    /// Largest mean pressure over 24 mm2, a mat's sensel.
    #[getter]
    fn patch_peak_mpa(&self) -> f64 {
        self.patch_peak_mpa
    }

    /// A record per region: index, name, force_n, area_mm2, peak_mpa, mean_mpa, dmax_mm, g_mpa.
    #[getter]
    fn regions(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.regions
            .get(py, |rows| records::regions(py, &rows, &self.region_names))
    }

    /// (k,), MPa, one per product vertex, force conserving.
    #[getter]
    fn product_pressure_mpa(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.product_pressure_mpa
            .get(py, |values| Ok(column(py, values)))
    }

    /// Travel of the product along `direction`, mm.
    #[getter]
    fn offset_mm(&self) -> f64 {
        self.offset_mm
    }

    /// (3,), direction of travel, or of the mean normal force without force control.
    #[getter]
    fn direction(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.direction.get(py, |value| Ok(triple(py, value)))
    }

    /// (n,), N, attraction towards the product, >= 0; zero without adhesion. Force and pressure are those of contact alone.
    #[getter]
    fn adhesion_force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.adhesion_force_n
            .get(py, |values| Ok(column(py, values)))
    }

    /// (n, 3), N, shear force on the skin; zero without friction and drag.
    #[getter]
    fn tangential_force_n(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.tangential_force_n.get(py, |force| match force {
            Some(force) => owned_rows(py, force),
            None => Ok(zeros::<f64, _>(py, [self.vertices, 3])),
        })
    }

    /// (n,), MPa, its length over the vertex area.
    #[getter]
    fn tangential_traction_mpa(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.tangential_traction_mpa
            .get(py, |traction| match traction {
                Some(traction) => Ok(column(py, traction)),
                None => Ok(zeros::<f64, _>(py, [self.vertices])),
            })
    }

    /// (n, 3), mm, slip of the skin over the product.
    #[getter]
    fn slip_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.slip_mm.get(py, |slip| match slip {
            Some(slip) => owned_rows(py, slip),
            None => Ok(zeros::<f64, _>(py, [self.vertices, 3])),
        })
    }

    /// (n,), 1 - shear force / (coefficient x normal force); nan where no friction acts.
    #[getter]
    fn slip_margin(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.slip_margin.get(py, |margin| match margin {
            Some(margin) => Ok(column(py, margin)),
            None => Ok(column(py, vec![f64::NAN; self.vertices])),
        })
    }

    /// (n,), bool, in contact and not slipping.
    #[getter]
    fn is_sticking(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.is_sticking.get(py, |is_sticking| match is_sticking {
            Some(is_sticking) => Ok(column(py, is_sticking)),
            None => Ok(zeros::<bool, _>(py, [self.vertices])),
        })
    }

    /// A record of the drag, None without: total_force_n (3,) on the skin, slide_mm (3,), twist_rad (3,), dissipated_nmm,
    /// stored_nmm, residual.
    #[getter]
    fn friction(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.friction
            .get(py, |shear| records::friction(py, shear.as_ref()))
    }

    /// A record: complementarity, penetration_mm, load_balance, far_field.
    #[getter]
    fn residual(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.residual
            .get(py, |residual| records::residual(py, &residual))
    }

    /// A record: has_converged, passes, pivots, cg_steps.
    #[getter]
    fn convergence(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.convergence
            .get(py, |how| records::convergence(py, &how))
    }

    /// Sentences for the user.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.warnings
            .get(py, |texts| Ok(PyList::new(py, texts)?.into_any().unbind()))
    }

    /// How far the result may be used: "good", "read this" or "do not use".
    #[getter]
    fn grade(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let text = |grade: Grade| Ok(PyString::new(py, grade.name()).into_any().unbind());
        self.grade.get(py, text)
    }

    /// The gravest of the warnings; None where the grade is "good".
    #[getter]
    fn reason(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.reason
            .get(py, |text| Ok(text.into_pyobject(py)?.unbind()))
    }

    /// A record per warning: kind, grade, text, and the vertex and the region it is about, each None where there is none.
    #[getter]
    fn remarks(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.remarks
            .get(py, |warnings| records::remarks(py, &warnings))
    }

    /// A record of wall time by stage, s.
    #[getter]
    fn seconds(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.seconds.get(py, |stages| records::seconds(py, &stages))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let force: [f64; 3] = self.total_force_n(py)?.extract(py)?;
        let newton = force.iter().map(|part| part * part).sum::<f64>().sqrt();
        Ok(format!(
            "<thenar.Contact: {newton:.3} N on {:.1} mm2, peak {:.1} kPa>",
            self.contact_area_mm2,
            1e3 * self.peak_pressure_mpa
        ))
    }
}

fn is_loaded(forces: &[f64]) -> Vec<bool> {
    forces.iter().map(|force| *force > 0.0).collect()
}
