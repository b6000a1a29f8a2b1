//! `thenar.Effect` and the catalogue of effects.

use crate::conversion::arrays::{Argument, column};
use crate::conversion::errors::SolveError;
use crate::conversion::record::record;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use thenar_contact::ActiveEffect;
use thenar_contact::effects::{CATALOGUE, Entry};

/// An effect switched on: physics beyond the base model, by its name in `thenar.effects()`.
///
/// `amplitude`: how much of it, 0 is the base model bit for bit; `regions`: region numbers it acts on, None: all; `painted`: (n,)
/// values per vertex where the catalogue allows it, NaN where nothing is painted; then its numbers and choices by
/// their names, such as `thickness_mm=5.0` or `law="power"`.
///
/// Raises `SolveError` for names that there are not; numbers are checked when a skin takes the effect.
#[pyclass(frozen, module = "thenar")]
#[derive(Debug, Clone)]
pub struct Effect(pub ActiveEffect);

#[pymethods]
impl Effect {
    #[new]
    #[pyo3(signature = (name, amplitude=1.0, *, regions=None, painted=None, **numbers))]
    fn new(
        name: &str,
        amplitude: f64,
        regions: Option<Vec<u32>>,
        painted: Option<&Bound<'_, PyAny>>,
        numbers: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Effect> {
        let refused = |error: thenar_contact::ContactError| SolveError::new_err(error.to_string());
        let mut effect = ActiveEffect::named(name, amplitude).map_err(refused)?;
        effect.regions = regions;
        if let Some(painted) = painted {
            let count = painted.len()?;
            effect.painted = Some(Argument::solve("painted", painted).numbers_of(count)?);
        }
        for (key, value) in numbers.into_iter().flatten() {
            let key: String = key.extract()?;
            effect = match value.extract::<String>() {
                Ok(option) => effect.choose(&key, &option),
                Err(_) => effect.with(&key, Argument::solve(&key, &value).number()?),
            }
            .map_err(refused)?;
        }
        Ok(Effect(effect))
    }

    /// Name in the catalogue.
    #[getter]
    fn name(&self) -> &'static str {
        self.0.entry().name
    }

    /// How much of it.
    #[getter]
    fn amplitude(&self) -> f64 {
        self.0.amplitude
    }

    /// Region numbers it acts on; None: all.
    #[getter]
    fn regions(&self) -> Option<Vec<u32>> {
        self.0.regions.clone()
    }

    /// (n,) values painted per vertex, or None.
    #[getter]
    fn painted(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.0.painted.clone().map(|painted| column(py, painted))
    }

    /// Its numbers and choices by name.
    #[getter]
    fn numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (numbers, entry) = (PyDict::new(py), self.0.entry());
        for (number, value) in entry.shape.iter().zip(&self.0.shape) {
            numbers.set_item(number.name, value)?;
        }
        for (choice, chosen) in entry.choices.iter().zip(&self.0.chosen) {
            numbers.set_item(choice.name, choice.options[*chosen])?;
        }
        Ok(numbers)
    }

    /// The same effect with another amplitude.
    fn with_amplitude(&self, amplitude: f64) -> Effect {
        let mut effect = self.0.clone();
        effect.amplitude = amplitude;
        Effect(effect)
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let keywords = self.numbers(py)?;
        keywords.set_item("regions", self.regions())?;
        keywords.set_item("painted", self.painted(py))?;
        let name = self.name().into_pyobject(py)?.into_any();
        let amplitude = self.0.amplitude.into_pyobject(py)?.into_any();
        Ok((PyTuple::new(py, [name, amplitude])?, keywords))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mut text = format!(
            "thenar.Effect({:?}, amplitude={}",
            self.name(),
            self.0.amplitude
        );
        for (name, value) in self.numbers(py)? {
            text += &format!(", {name}={}", value.repr()?);
        }
        Ok(text + ")")
    }
}

/// The effects of a list of `Effect`, or of an iterable of them.
pub fn effects_of(effects: Option<Vec<PyRef<'_, Effect>>>) -> Vec<ActiveEffect> {
    effects
        .into_iter()
        .flatten()
        .map(|effect| effect.0.clone())
        .collect()
}

/// The catalogue: name, kind ("tissue" acts on the skin, "instrument" on readings), stage, meaning, amplitude, most, shape, choices, painted, consequences, source of each effect, in the
/// order in which they compose.
#[pyfunction]
pub fn effects(py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
    CATALOGUE
        .iter()
        .map(|(_, entry)| about(py, entry))
        .collect()
}

fn about(py: Python<'_>, entry: &Entry) -> PyResult<Py<PyAny>> {
    let number = |number: &thenar_contact::effects::ShapeNumber| {
        let entries = PyDict::new(py);
        entries.set_item("name", number.name)?;
        entries.set_item("unit", number.unit)?;
        entries.set_item("default", number.default)?;
        entries.set_item("low", number.admissible[0])?;
        entries.set_item("high", number.admissible[1])?;
        entries.set_item(
            "physiological",
            (number.physiological[0], number.physiological[1]),
        )?;
        entries.set_item("meaning", number.meaning)?;
        entries.set_item("source", number.source)?;
        record(entries)
    };
    let choice = |choice: &thenar_contact::effects::Choice| {
        let entries = PyDict::new(py);
        entries.set_item("name", choice.name)?;
        entries.set_item("options", choice.options.to_vec())?;
        entries.set_item("meaning", choice.meaning)?;
        record(entries)
    };
    let sign = |sign: &thenar_contact::effects::Consequence| {
        let entries = PyDict::new(py);
        entries.set_item("sign", format!("{:?}", sign.sign))?;
        entries.set_item("sentence", sign.sentence)?;
        record(entries)
    };
    let entries = PyDict::new(py);
    entries.set_item("name", entry.name)?;
    entries.set_item("kind", entry.kind())?;
    entries.set_item("stage", format!("{:?}", entry.stage).to_lowercase())?;
    entries.set_item("meaning", entry.meaning)?;
    entries.set_item("amplitude", entry.amplitude)?;
    entries.set_item("most", entry.most)?;
    entries.set_item(
        "shape",
        entry
            .shape
            .iter()
            .map(number)
            .collect::<PyResult<Vec<_>>>()?,
    )?;
    entries.set_item(
        "choices",
        entry
            .choices
            .iter()
            .map(choice)
            .collect::<PyResult<Vec<_>>>()?,
    )?;
    entries.set_item("painted", entry.painted)?;
    let signs = entry
        .consequences
        .iter()
        .map(sign)
        .collect::<PyResult<Vec<_>>>()?;
    entries.set_item("consequences", signs)?;
    entries.set_item("source", entry.source)?;
    record(entries)
}
