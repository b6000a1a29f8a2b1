//! `thenar.Elastomer`: what a soft grip is made of.

use crate::conversion::arrays::Argument;
use crate::conversion::errors::MaterialError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use thenar_contact::SoftGrip;

/// A soft layer bonded to the rigid core of a product; linear elastic.
///
/// `thickness_mm`: over the core; 0 is rigid, `inf` a half space. `youngs_mpa`: Young's modulus. `poisson_ratio`: 0 to 0.5; rubbers
/// are near 0.49, foams and cork near 0.
///
/// Raises `MaterialError` for a number that is not admissible.
#[pyclass(frozen, eq, module = "thenar")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastomer(pub thenar_contact::Elastomer);

impl Elastomer {
    fn checked(elastomer: thenar_contact::Elastomer) -> PyResult<Elastomer> {
        match elastomer.validate(0) {
            Ok(()) => Ok(Elastomer(elastomer)),
            Err(error) => Err(MaterialError::new_err(error.to_string())),
        }
    }
}

#[pymethods]
impl Elastomer {
    #[new]
    #[pyo3(signature = (thickness_mm, youngs_mpa, poisson_ratio = 0.49))]
    fn new(thickness_mm: f64, youngs_mpa: f64, poisson_ratio: f64) -> PyResult<Elastomer> {
        Elastomer::checked(thenar_contact::Elastomer {
            thickness_mm,
            youngs_mpa,
            poisson_ratio,
        })
    }

    /// A rubber of this hardness on the scale Shore A, 20 to 80 (Gent, Rubber Chemistry and Technology 31 (1958) 896); the modulus of a
    /// compound may be 1.5 times more or less.
    #[staticmethod]
    #[pyo3(signature = (hardness, thickness_mm, poisson_ratio = 0.49))]
    fn of_shore_a(hardness: f64, thickness_mm: f64, poisson_ratio: f64) -> PyResult<Elastomer> {
        if !(20.0..=80.0).contains(&hardness) {
            return Err(MaterialError::new_err(format!(
                "hardness is {hardness}, but must be 20 to 80 Shore A, where Gent's relation was measured; give youngs_mpa instead"
            )));
        }
        let youngs_mpa = thenar_contact::Elastomer::youngs_of_shore_a(hardness);
        Elastomer::new(thickness_mm, youngs_mpa, poisson_ratio)
    }

    /// Grips that are common: dicts of `name`, `title`, `youngs_mpa`, `poisson_ratio` and `source`.
    #[staticmethod]
    fn presets(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
        let one = |preset: &thenar_contact::GripPreset| {
            let row = PyDict::new(py);
            row.set_item("name", preset.name)?;
            row.set_item("title", preset.title)?;
            row.set_item("youngs_mpa", preset.youngs_mpa())?;
            row.set_item("poisson_ratio", preset.poisson_ratio)?;
            row.set_item("source", preset.source)?;
            Ok(row)
        };
        thenar_contact::GRIP_PRESETS.iter().map(one).collect()
    }

    #[getter]
    fn thickness_mm(&self) -> f64 {
        self.0.thickness_mm
    }

    #[getter]
    fn youngs_mpa(&self) -> f64 {
        self.0.youngs_mpa
    }

    #[getter]
    fn poisson_ratio(&self) -> f64 {
        self.0.poisson_ratio
    }

    fn __getnewargs__(&self) -> (f64, f64, f64) {
        (self.0.thickness_mm, self.0.youngs_mpa, self.0.poisson_ratio)
    }

    fn __repr__(&self) -> String {
        format!(
            "<thenar.Elastomer: {} mm, E {} MPa, nu {}>",
            self.0.thickness_mm, self.0.youngs_mpa, self.0.poisson_ratio
        )
    }
}

/// The grip of a product of so many vertices, as it came from Python.
pub fn grip_of(
    grip: Option<&Bound<'_, PyAny>>,
    of_vertex: Option<&Bound<'_, PyAny>>,
    vertices: usize,
) -> PyResult<Option<SoftGrip>> {
    let Some(grip) = grip else {
        return match of_vertex {
            None => Ok(None),
            Some(_) => Err(MaterialError::new_err(
                "grip_of_vertex: there is no grip; give the elastomers in grip",
            )),
        };
    };
    let one = |item: &Bound<'_, PyAny>| item.cast::<Elastomer>().ok().map(|e| e.get().0);
    let elastomers = match one(grip) {
        Some(elastomer) => vec![elastomer],
        None => {
            let kind = Argument::material("grip", grip).kind();
            let wrong = || {
                MaterialError::new_err(format!(
                    "grip: {kind} is no thenar.Elastomer, nor a list of them"
                ))
            };
            let items = grip.try_iter().map_err(|_| wrong())?;
            items
                .map(|item| one(&item?).ok_or_else(wrong))
                .collect::<PyResult<Vec<_>>>()?
        }
    };
    let of_vertex = match of_vertex {
        None => vec![0; vertices],
        Some(numbers) => Argument::mesh("grip_of_vertex", numbers).regions(vertices)?,
    };
    Ok(Some(SoftGrip {
        elastomers,
        of_vertex,
    }))
}
