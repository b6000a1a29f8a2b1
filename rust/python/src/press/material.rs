//! `thenar.Material` and the choice of one material per region.

use crate::conversion::arrays::Argument;
use crate::conversion::errors::MaterialError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use thenar_contact::{Model, Swelling};

/// Soft tissue of one region. Numbers not given take the defaults of `thenar.parameters()`.
///
/// `g0_mpa`, `g_lim_mpa`: shear modulus at first touch and from `d_lim_mm` on, MPa. `d_lim_mm`: mm.
/// `thickness_mm`: soft tissue over bone, mm; `inf` gives a half space (model "layer").
/// `poisson_ratio`: 0 to 0.5. `stiffening`: b of `W = G / (2 b) (exp(b (I1 - 3)) - 1)`, the growth of the modulus with the
/// strain of a place (model "layer"). `bone_half_width_mm`, `bone_half_length_mm`: of the bone under the tissue, mm; `inf` for
/// bone without end (model "layer"). `zone_mm`: reach of the active zone, mm (model "paper").
/// `swelling`: height (mm/N), radius (mm) and width (mm) of the swelling (model "paper"), or each by its name in
/// `thenar.parameters()`.
///
/// Raises `MaterialError` for a number that is not admissible.
#[pyclass(frozen, eq, module = "thenar")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material(pub thenar_contact::Material);

#[pymethods]
impl Material {
    #[new]
    #[pyo3(signature = (**numbers))]
    fn new(numbers: Option<&Bound<'_, PyDict>>) -> PyResult<Material> {
        let mut material = thenar_contact::Material::default();
        for (name, value) in numbers.into_iter().flatten() {
            let name: String = name.extract()?;
            if !value.is_none() {
                set(&mut material, &name, &value)?;
            }
        }
        material
            .validate("given")
            .map_err(|error| MaterialError::new_err(error.to_string()))?;
        Ok(Material(material))
    }

    /// Fingertip for the model "paper" (Xie 4.1, Table 2).
    #[staticmethod]
    fn finger() -> Material {
        Material(thenar_contact::Material::finger())
    }

    /// Palm for the model "paper" (Xie 4.1, Table 2).
    #[staticmethod]
    fn palm() -> Material {
        Material(thenar_contact::Material::palm())
    }

    /// Fingertip over bone, for the model "layer".
    #[staticmethod]
    fn finger_layer() -> Material {
        Material(thenar_contact::Material::finger_layer())
    }

    /// Other pads of a finger over bone, for the model "layer".
    #[staticmethod]
    fn phalanx_layer() -> Material {
        Material(thenar_contact::Material::phalanx_layer())
    }

    /// Palm over bone, for the model "layer".
    #[staticmethod]
    fn palm_layer() -> Material {
        Material(thenar_contact::Material::palm_layer())
    }

    #[getter]
    fn g0_mpa(&self) -> f64 {
        self.0.g0_mpa
    }

    #[getter]
    fn g_lim_mpa(&self) -> f64 {
        self.0.g_lim_mpa
    }

    #[getter]
    fn d_lim_mm(&self) -> f64 {
        self.0.d_lim_mm
    }

    #[getter]
    fn thickness_mm(&self) -> f64 {
        self.0.thickness_mm
    }

    #[getter]
    fn poisson_ratio(&self) -> f64 {
        self.0.poisson_ratio
    }

    #[getter]
    fn stiffening(&self) -> f64 {
        self.0.stiffening
    }

    #[getter]
    fn bone_half_width_mm(&self) -> f64 {
        self.0.bone_half_width_mm
    }

    #[getter]
    fn bone_half_length_mm(&self) -> f64 {
        self.0.bone_half_length_mm
    }

    #[getter]
    fn zone_mm(&self) -> f64 {
        self.0.zone_mm
    }

    /// Height (mm/N), radius (mm) and width (mm).
    #[getter]
    fn swelling(&self) -> (f64, f64, f64) {
        let Swelling {
            height_mm_per_n,
            radius_mm,
            width_mm,
        } = self.0.swelling;
        (height_mm_per_n, radius_mm, width_mm)
    }

    #[getter]
    fn swelling_height_mm_per_n(&self) -> f64 {
        self.0.swelling.height_mm_per_n
    }

    #[getter]
    fn swelling_radius_mm(&self) -> f64 {
        self.0.swelling.radius_mm
    }

    #[getter]
    fn swelling_width_mm(&self) -> f64 {
        self.0.swelling.width_mm
    }

    /// The same material with some numbers changed.
    #[pyo3(signature = (**numbers))]
    fn replace<'py>(
        &self,
        py: Python<'py>,
        numbers: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Material> {
        let all = self.numbers(py)?;
        if let Some(numbers) = numbers {
            all.update(numbers.as_mapping())?;
        }
        Material::new(Some(&all))
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        Ok((PyTuple::empty(py), self.numbers(py)?))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mut entries = Vec::new();
        for (name, value) in self.numbers(py)? {
            entries.push(format!("{name}={}", value.repr()?));
        }
        Ok(format!("thenar.Material({})", entries.join(", ")))
    }
}

impl Material {
    fn numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let numbers = PyDict::new(py);
        numbers.set_item("g0_mpa", self.0.g0_mpa)?;
        numbers.set_item("g_lim_mpa", self.0.g_lim_mpa)?;
        numbers.set_item("d_lim_mm", self.0.d_lim_mm)?;
        numbers.set_item("thickness_mm", self.0.thickness_mm)?;
        numbers.set_item("poisson_ratio", self.0.poisson_ratio)?;
        numbers.set_item("stiffening", self.0.stiffening)?;
        numbers.set_item("bone_half_width_mm", self.0.bone_half_width_mm)?;
        numbers.set_item("bone_half_length_mm", self.0.bone_half_length_mm)?;
        numbers.set_item("zone_mm", self.0.zone_mm)?;
        numbers.set_item("swelling", self.swelling())?;
        Ok(numbers)
    }
}

fn set(
    material: &mut thenar_contact::Material,
    name: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let argument = Argument::material(name, value);
    let number = match name {
        "swelling" => {
            let [height_mm_per_n, radius_mm, width_mm] = <[f64; 3]>::from(argument.vector()?);
            material.swelling = Swelling {
                height_mm_per_n,
                radius_mm,
                width_mm,
            };
            return Ok(());
        }
        "g0_mpa" => &mut material.g0_mpa,
        "g_lim_mpa" => &mut material.g_lim_mpa,
        "d_lim_mm" => &mut material.d_lim_mm,
        "thickness_mm" => &mut material.thickness_mm,
        "poisson_ratio" => &mut material.poisson_ratio,
        "stiffening" => &mut material.stiffening,
        "bone_half_width_mm" => &mut material.bone_half_width_mm,
        "bone_half_length_mm" => &mut material.bone_half_length_mm,
        "zone_mm" => &mut material.zone_mm,
        "swelling_height_mm_per_n" => &mut material.swelling.height_mm_per_n,
        "swelling_radius_mm" => &mut material.swelling.radius_mm,
        "swelling_width_mm" => &mut material.swelling.width_mm,
        _ => {
            return Err(MaterialError::new_err(format!(
                "a material has no {name:?}; it has g0_mpa, g_lim_mpa, d_lim_mm, thickness_mm, poisson_ratio, stiffening, bone_half_width_mm, bone_half_length_mm, zone_mm and swelling"
            )));
        }
    };
    *number = argument.number()?;
    Ok(())
}

/// The regions that materials are wanted for.
pub struct Regions<'a> {
    /// How many there are.
    pub count: usize,
    /// Which of them hold vertices.
    pub is_used: Vec<bool>,
    /// Their names, empty if they have none.
    pub names: &'a [String],
    pub model: Model,
}

impl Regions<'_> {
    /// One material per region from a single one, a list, a dict by number, name or "default", or the model's preset.
    ///
    /// # Errors
    /// `MaterialError` if a region that holds vertices has none, or the argument is of another kind.
    pub fn materials(
        &self,
        given: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<thenar_contact::Material>> {
        let preset = self.model.preset();
        let Some(given) = given else {
            return Ok(vec![preset; self.count]);
        };
        if let Ok(one) = given.cast::<Material>() {
            return Ok(vec![one.get().0; self.count]);
        }
        if let Ok(by_region) = given.cast::<PyDict>() {
            return self.keyed(by_region, preset);
        }
        if given.is_instance_of::<PyList>() || given.is_instance_of::<PyTuple>() {
            return self.listed(given);
        }
        let kind = Argument::material("materials", given).kind();
        Err(MaterialError::new_err(format!(
            "materials: expected a Material, a list or a dict of them, got {kind}"
        )))
    }

    fn listed(&self, given: &Bound<'_, PyAny>) -> PyResult<Vec<thenar_contact::Material>> {
        let mut materials = Vec::new();
        for (region, material) in given.try_iter()?.enumerate() {
            materials.push(one(&material?, &format!("region {region}"))?);
        }
        if let Some(region) = (materials.len()..self.count).find(|region| self.is_used[*region]) {
            return Err(self.missing(region, &format!("{} were given", materials.len())));
        }
        let filler = materials.first().copied().unwrap_or_default();
        materials.resize(materials.len().max(self.count), filler);
        Ok(materials)
    }

    fn keyed(
        &self,
        given: &Bound<'_, PyDict>,
        preset: thenar_contact::Material,
    ) -> PyResult<Vec<thenar_contact::Material>> {
        let mut found = vec![None; self.count];
        let mut default = None;
        for (key, material) in given {
            let material = one(&material, &format!("{}", key.repr()?))?;
            match self.region_of(&key)? {
                Some(region) => found[region] = Some(material),
                None => default = Some(material),
            }
        }
        if default.is_none()
            && let Some(region) =
                (0..self.count).find(|region| self.is_used[*region] && found[*region].is_none())
        {
            return Err(self.missing(region, "it is not in the dict and there is no 'default'"));
        }
        Ok(found
            .into_iter()
            .map(|material| material.or(default).unwrap_or(preset))
            .collect())
    }

    /// The region a key means, None for "default".
    fn region_of(&self, key: &Bound<'_, PyAny>) -> PyResult<Option<usize>> {
        let by_name = key.extract::<String>().ok();
        let region = match &by_name {
            Some(name) => self.names.iter().position(|known| known == name),
            None => key
                .extract::<usize>()
                .ok()
                .filter(|region| *region < self.count),
        };
        if region.is_some() || by_name.as_deref() == Some("default") {
            return Ok(region);
        }
        let names = if self.names.is_empty() {
            String::new()
        } else {
            format!(", {}", self.names.join(", "))
        };
        let last = self.count.saturating_sub(1);
        Err(MaterialError::new_err(format!(
            "materials: there is no region {}; the keys are 0 to {last}{names} or 'default'",
            key.repr()?
        )))
    }

    fn missing(&self, region: usize, why: &str) -> PyErr {
        let name = self
            .names
            .get(region)
            .map_or_else(String::new, |name| format!(" ('{name}')"));
        MaterialError::new_err(format!(
            "materials: region {region}{name} has none ({why}); give one per region"
        ))
    }
}

fn one(material: &Bound<'_, PyAny>, whose: &str) -> PyResult<thenar_contact::Material> {
    match material.cast::<Material>() {
        Ok(material) => Ok(material.get().0),
        Err(_) => {
            let kind = Argument::material("materials", material).kind();
            Err(MaterialError::new_err(format!(
                "materials: {whose} has {kind}, expected a thenar.Material"
            )))
        }
    }
}
