//! `thenar.Contact`: the result of a press as numpy arrays and records.

use crate::arrays::{Argument, column, rows, triple, zeros};
use crate::record::record;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use thenar_contact::{RegionResult, Shear};
use thenar_surface::Vec3;

/// The result of a press. Arrays over vertices are in the order of the skin's vertices.
#[pyclass(frozen, get_all, module = "thenar")]
pub struct Contact {
    /// (n, 3), mm, to be added to the posed positions.
    displacement_mm: Py<PyAny>,
    /// (n,), MPa.
    pressure_mpa: Py<PyAny>,
    /// (n,), N, normal force per vertex.
    force_n: Py<PyAny>,
    /// (n,), mm, signed distance before deformation, inf beyond reach.
    gap_mm: Py<PyAny>,
    /// (n,), bool.
    in_contact: Py<PyAny>,
    /// (n, 3), the product's outward normal where the vertex touches, else zero.
    product_normal: Py<PyAny>,
    /// (3,), N, on the product.
    total_force_n: Py<PyAny>,
    /// (3,), N mm, of that force about the origin.
    total_moment_nmm: Py<PyAny>,
    /// (3,), mm.
    center_of_pressure_mm: Py<PyAny>,
    contact_area_mm2: f64,
    peak_pressure_mpa: f64,
    mean_pressure_mpa: f64,
    /// Largest mean pressure over 24 mm2, a mat's sensel.
    patch_peak_mpa: f64,
    /// A record per region: index, name, force_n, area_mm2, peak_mpa, mean_mpa, dmax_mm, g_mpa.
    regions: Py<PyAny>,
    /// (k,), MPa, one per product vertex, force conserving.
    product_pressure_mpa: Py<PyAny>,
    /// Travel of the product along `direction`, mm.
    offset_mm: f64,
    /// (3,), direction of travel, or of the mean normal force without force control.
    direction: Py<PyAny>,
    /// (n,), N, attraction towards the product, >= 0; zero without adhesion. Force and pressure are those of contact alone.
    adhesion_force_n: Py<PyAny>,
    /// (n, 3), N, shear force on the skin; zero without friction and drag.
    tangential_force_n: Py<PyAny>,
    /// (n,), MPa, its length over the vertex area.
    tangential_traction_mpa: Py<PyAny>,
    /// (n, 3), mm, slip of the skin over the product.
    slip_mm: Py<PyAny>,
    /// (n,), 1 - shear force / (coefficient x normal force); nan where no friction acts.
    slip_margin: Py<PyAny>,
    /// (n,), bool, in contact and not slipping.
    is_sticking: Py<PyAny>,
    /// A record of the drag, None without: total_force_n (3,) on the skin, slide_mm (3,), twist_rad (3,), dissipated_nmm,
    /// stored_nmm, residual.
    friction: Py<PyAny>,
    /// A record: complementarity, penetration_mm, load_balance, far_field.
    residual: Py<PyAny>,
    /// A record: has_converged, passes, pivots, cg_steps.
    convergence: Py<PyAny>,
    /// Sentences for the user.
    warnings: Py<PyAny>,
    /// A record of wall time by stage, s.
    seconds: Py<PyAny>,
}

impl Contact {
    /// Moves the result into Python; `names` is empty or has one name per region.
    pub fn new(
        py: Python<'_>,
        contact: thenar_contact::Contact,
        names: &[String],
    ) -> PyResult<Contact> {
        let regions: Vec<_> = contact
            .regions
            .iter()
            .map(|region| region_record(py, region, names))
            .collect::<PyResult<_>>()?;
        let friction = friction_record(py, contact.shear.as_ref())?;
        let sheared = Sheared::new(py, contact.shear, contact.gap.len())?;
        let seconds = PyDict::new(py);
        for (stage, time) in &contact.seconds {
            seconds.set_item(stage, time)?;
        }
        Ok(Contact {
            displacement_mm: rows(py, &contact.displacement)?,
            pressure_mpa: column(py, contact.pressure),
            in_contact: column(
                py,
                contact
                    .nodal_force
                    .iter()
                    .map(|force| *force > 0.0)
                    .collect(),
            ),
            force_n: column(py, contact.nodal_force),
            gap_mm: column(py, contact.gap),
            product_normal: rows(py, &contact.normal)?,
            total_force_n: triple(py, contact.total_force),
            total_moment_nmm: triple(py, contact.total_moment),
            center_of_pressure_mm: triple(py, contact.center_of_pressure),
            contact_area_mm2: contact.contact_area,
            peak_pressure_mpa: contact.peak_pressure,
            mean_pressure_mpa: contact.mean_pressure,
            patch_peak_mpa: contact.patch_peak,
            regions: PyList::new(py, regions)?.into_any().unbind(),
            product_pressure_mpa: column(py, contact.product_pressure),
            offset_mm: contact.offset,
            direction: triple(py, contact.direction),
            adhesion_force_n: column(py, contact.adhesion),
            tangential_force_n: sheared.force,
            tangential_traction_mpa: sheared.traction,
            slip_mm: sheared.slip,
            slip_margin: sheared.margin,
            is_sticking: sheared.is_sticking,
            friction,
            residual: residual_record(py, &contact.residual)?,
            convergence: convergence_record(py, &contact.convergence)?,
            warnings: PyList::new(py, contact.warnings)?.into_any().unbind(),
            seconds: record(seconds)?,
        })
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
    /// What a mat needs, out of Python again.
    pub fn pressed(&self, py: Python<'_>) -> PyResult<PressedSkin> {
        let displacement = self.displacement_mm.bind(py);
        let displacement = Argument::mesh("displacement_mm", displacement).points()?;
        let count = displacement.len();
        let numbers = |name: &str, values: &Py<PyAny>| {
            Argument::mesh(name, values.bind(py)).numbers_of(count)
        };
        Ok(PressedSkin {
            force: numbers("force_n", &self.force_n)?,
            pressure: numbers("pressure_mpa", &self.pressure_mpa)?,
            direction: Argument::mesh("direction", self.direction.bind(py)).vector()?,
            offset: self.offset_mm,
            displacement,
        })
    }
}

#[pymethods]
impl Contact {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let force: [f64; 3] = self.total_force_n.extract(py)?;
        let newton = force.iter().map(|part| part * part).sum::<f64>().sqrt();
        Ok(format!(
            "<thenar.Contact: {newton:.3} N on {:.1} mm2, peak {:.1} kPa>",
            self.contact_area_mm2,
            1e3 * self.peak_pressure_mpa
        ))
    }
}

fn friction_record(py: Python<'_>, shear: Option<&Shear>) -> PyResult<Py<PyAny>> {
    let Some(shear) = shear else {
        return Ok(py.None());
    };
    let entries = PyDict::new(py);
    entries.set_item("total_force_n", triple(py, shear.total))?;
    entries.set_item("slide_mm", triple(py, shear.travel))?;
    entries.set_item("twist_rad", triple(py, shear.turn))?;
    entries.set_item("dissipated_nmm", shear.dissipated)?;
    entries.set_item("stored_nmm", shear.stored)?;
    entries.set_item("residual", shear.residual)?;
    record(entries)
}

/// What friction makes of a drag, as arrays.
struct Sheared {
    force: Py<PyAny>,
    traction: Py<PyAny>,
    slip: Py<PyAny>,
    margin: Py<PyAny>,
    is_sticking: Py<PyAny>,
}

impl Sheared {
    /// Of a press of so many `vertices`; without friction or without a drag all is zero, and there is no margin.
    fn new(py: Python<'_>, shear: Option<Shear>, vertices: usize) -> PyResult<Sheared> {
        let Some(shear) = shear else {
            return Ok(Sheared {
                force: zeros::<f64, _>(py, [vertices, 3]),
                traction: zeros::<f64, _>(py, [vertices]),
                slip: zeros::<f64, _>(py, [vertices, 3]),
                margin: column(py, vec![f64::NAN; vertices]),
                is_sticking: zeros::<bool, _>(py, [vertices]),
            });
        };
        Ok(Sheared {
            force: rows(py, &shear.force)?,
            traction: column(py, shear.traction),
            slip: rows(py, &shear.slip)?,
            margin: column(py, shear.margin),
            is_sticking: column(py, shear.is_sticking),
        })
    }
}

fn region_record(py: Python<'_>, region: &RegionResult, names: &[String]) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("index", region.index)?;
    entries.set_item("name", names.get(region.index))?;
    entries.set_item("force_n", region.force)?;
    entries.set_item("area_mm2", region.area)?;
    entries.set_item("peak_mpa", region.peak)?;
    entries.set_item("mean_mpa", region.mean)?;
    entries.set_item("dmax_mm", region.max_penetration)?;
    entries.set_item("g_mpa", region.shear_modulus)?;
    record(entries)
}

fn residual_record(py: Python<'_>, residual: &thenar_contact::Residual) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("complementarity", residual.complementarity)?;
    entries.set_item("penetration_mm", residual.penetration_mm)?;
    entries.set_item("load_balance", residual.load_balance)?;
    entries.set_item("far_field", residual.far_field)?;
    record(entries)
}

fn convergence_record(
    py: Python<'_>,
    convergence: &thenar_contact::Convergence,
) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("has_converged", convergence.has_converged)?;
    entries.set_item("passes", convergence.passes)?;
    entries.set_item("pivots", convergence.pivots)?;
    entries.set_item("cg_steps", convergence.cg_steps)?;
    record(entries)
}
