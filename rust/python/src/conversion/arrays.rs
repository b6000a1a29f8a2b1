//! Python arguments to Rust arrays and back; the only place that knows numpy.
//!
//! Any real number type, byte order and memory layout is taken, and anything that `numpy.asarray` takes. Booleans,
//! complex numbers, texts and objects are refused by the argument's name, what was expected and what was given.

use crate::conversion::ending;
use crate::conversion::errors::Topic;
use numpy::ndarray::IntoDimension;
use numpy::{
    Element, PyArray, PyArray1, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyArithmeticError, PyAttributeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use thenar_surface::Vec3;

/// Regions are numbered below this; a larger number is a mistake that would cost memory.
const MOST_REGIONS: i64 = 4096;

/// An argument with its name and what it belongs to.
#[derive(Clone, Copy)]
pub struct Argument<'a, 'py> {
    pub name: &'a str,
    pub value: &'a Bound<'py, PyAny>,
    pub topic: Topic,
}

impl<'a, 'py> Argument<'a, 'py> {
    pub fn mesh(name: &'a str, value: &'a Bound<'py, PyAny>) -> Self {
        Argument {
            name,
            value,
            topic: Topic::Mesh,
        }
    }

    pub fn solve(name: &'a str, value: &'a Bound<'py, PyAny>) -> Self {
        Argument {
            name,
            value,
            topic: Topic::Solve,
        }
    }

    pub fn material(name: &'a str, value: &'a Bound<'py, PyAny>) -> Self {
        Argument {
            name,
            value,
            topic: Topic::Material,
        }
    }

    /// The exception for a fault in this argument.
    pub fn fault(&self, problem: impl std::fmt::Display) -> PyErr {
        self.topic.error(format!("{}: {problem}", self.name))
    }

    /// (n, 3) finite numbers.
    pub fn points(&self) -> PyResult<Vec<Vec3>> {
        let array = self.array("an (n, 3) array of numbers", "fiu", |shape| {
            shape.len() == 2 && shape[1] == 3
        })?;
        self.read(&array, |numbers| {
            // All at once: looking for the first one that is not takes several times as long.
            let is_finite = numbers
                .iter()
                .fold(true, |all, value| all & f64::is_finite(*value));
            let bad = if is_finite {
                None
            } else {
                numbers.iter().position(|value| !value.is_finite())
            };
            match bad {
                Some(bad) => Err(self.fault(format_args!(
                    "row {} holds {} in column {}; every coordinate must be finite",
                    bad / 3,
                    numbers[bad],
                    bad % 3
                ))),
                None => Ok(numbers.chunks_exact(3).map(Vec3::from_row_slice).collect()),
            }
        })?
    }

    /// (3,) finite numbers.
    pub fn vector(&self) -> PyResult<Vec3> {
        let numbers = self.numbers("3 numbers", |shape| shape == [3])?;
        if !numbers.iter().all(|value| value.is_finite()) {
            return Err(self.fault(format_args!(
                "{numbers:?} is not finite; give three finite numbers"
            )));
        }
        Ok(Vec3::new(numbers[0], numbers[1], numbers[2]))
    }

    /// (m, 3) vertex numbers from 0 to below `vertices`.
    pub fn triangles(&self, vertices: usize) -> PyResult<Vec<[u32; 3]>> {
        let indices = self.integers("an (m, 3) array of integers", |shape| {
            shape.len() == 2 && shape[1] == 3
        })?;
        if let Some(bad) = indices
            .iter()
            .position(|index| *index < 0 || *index >= vertices as i64)
        {
            let (row, index) = (bad / 3, indices[bad]);
            return Err(self.fault(format_args!(
                "triangle {row} uses vertex {index}, but there are {vertices} vertices, numbered from 0; \
                 pass the triangles that belong to these vertices"
            )));
        }
        Ok(indices
            .chunks_exact(3)
            .map(|row| [row[0] as u32, row[1] as u32, row[2] as u32])
            .collect())
    }

    /// (n,) region numbers; every negative number becomes -1, "no skin".
    pub fn regions(&self, vertices: usize) -> PyResult<Vec<i32>> {
        let expected = format!("an array of {vertices} integers, one per vertex");
        let regions = self.integers(&expected, |shape| shape == [vertices])?;
        if let Some(vertex) = regions.iter().position(|region| *region >= MOST_REGIONS) {
            let region = regions[vertex];
            return Err(self.fault(format_args!(
                "vertex {vertex} is in region {region}; number regions from 0 to {}",
                MOST_REGIONS - 1
            )));
        }
        Ok(regions
            .into_iter()
            .map(|region| region.max(-1) as i32)
            .collect())
    }

    /// One number; infinite is allowed, NaN is not.
    pub fn number(&self) -> PyResult<f64> {
        let value = if self.value.is_instance_of::<PyBool>() {
            None
        } else {
            self.value.extract::<f64>().ok()
        };
        match value {
            Some(value) if !value.is_nan() => Ok(value),
            Some(_) => Err(self.fault("NaN is not a number; give a finite one")),
            None => Err(self.fault(format_args!("expected a number, got {}", self.kind()))),
        }
    }

    /// Name of the argument's Python type, for messages.
    pub fn kind(&self) -> String {
        self.value
            .get_type()
            .name()
            .map_or_else(|_| "an object".into(), |name| name.to_string())
    }

    /// (n, n) numbers, row by row.
    pub fn square(&self) -> PyResult<Vec<f64>> {
        self.numbers("an (n, n) array of numbers", |shape| {
            shape.len() == 2 && shape[0] == shape[1]
        })
    }

    /// (n,) numbers, n at least 1.
    pub fn list(&self) -> PyResult<Vec<f64>> {
        self.numbers("an (n,) array of numbers", |shape| {
            shape.len() == 1 && shape[0] > 0
        })
    }

    /// (n,) numbers.
    pub fn numbers_of(&self, n: usize) -> PyResult<Vec<f64>> {
        self.numbers(&format!("a ({n},) array of numbers"), |shape| shape == [n])
    }

    /// (n, 2) numbers, row by row.
    pub fn pairs_of(&self, n: usize) -> PyResult<Vec<f64>> {
        self.numbers(&format!("an ({n}, 2) array of numbers"), |shape| {
            shape == [n, 2]
        })
    }

    /// (n, m) numbers, row by row; NaN is let through.
    pub fn table_of(&self, n: usize, m: usize) -> PyResult<Vec<f64>> {
        self.numbers(&format!("an ({n}, {m}) array of numbers"), |shape| {
            shape == [n, m] || (n == 0 && shape.first() == Some(&0))
        })
    }

    fn numbers(&self, expected: &str, fits: impl Fn(&[usize]) -> bool) -> PyResult<Vec<f64>> {
        let array = self.array(expected, "fiu", fits)?;
        self.cast::<f64>(&array)
    }

    fn integers(&self, expected: &str, fits: impl Fn(&[usize]) -> bool) -> PyResult<Vec<i64>> {
        let array = self.array(expected, "iu", fits)?;
        if array.dtype().kind() == b'u' && array.dtype().itemsize() == 8 {
            return Ok(self
                .cast::<u64>(&array)?
                .into_iter()
                .map(|value| i64::try_from(value).unwrap_or(i64::MAX))
                .collect());
        }
        self.cast::<i64>(&array)
    }

    /// The argument as a numpy array of an allowed kind and shape.
    fn array(
        &self,
        expected: &str,
        kinds: &str,
        fits: impl Fn(&[usize]) -> bool,
    ) -> PyResult<Bound<'py, PyUntypedArray>> {
        let py = self.value.py();
        let _inside = ending::enter()?; // numpy may give the lock away
        let array = match self.value.cast::<PyUntypedArray>() {
            Ok(array) => array.clone(),
            Err(_) => {
                let made = numpy::get_array_module(py)?.call_method1("asarray", (self.value,));
                let made = made.map_err(|error| self.not_an_array(expected, error))?;
                made.cast_into::<PyUntypedArray>().map_err(PyErr::from)?
            }
        };
        let given = || format!("{} of shape {}", array.dtype(), shown(array.shape()));
        if !kinds.as_bytes().contains(&array.dtype().kind()) {
            let remedy = if kinds == "iu" {
                "convert it with .astype(int)"
            } else {
                "convert it with .astype(float)"
            };
            return Err(self.fault(format_args!(
                "expected {expected}, got {}; {remedy}",
                given()
            )));
        }
        if !fits(array.shape()) {
            return Err(self.fault(format_args!(
                "expected {expected}, got {}; check or reshape it",
                given()
            )));
        }
        Ok(array)
    }

    /// Keeps what is no fault of the argument (Ctrl-C, no memory) as it is.
    fn not_an_array(&self, expected: &str, error: PyErr) -> PyErr {
        let py = self.value.py();
        let is_fault = error.is_instance_of::<PyValueError>(py)
            || error.is_instance_of::<PyTypeError>(py)
            || error.is_instance_of::<PyAttributeError>(py)
            || error.is_instance_of::<PyArithmeticError>(py);
        if !is_fault {
            return error;
        }
        let fault = self.fault(format_args!(
            "expected {expected}, got {} that numpy cannot read",
            self.kind()
        ));
        fault.set_cause(py, Some(error));
        fault
    }

    /// Row by row, in this machine's byte order.
    fn cast<T: Element + Copy>(&self, array: &Bound<'py, PyUntypedArray>) -> PyResult<Vec<T>> {
        self.read(array, <[T]>::to_vec)
    }

    /// What `take` makes of the values, row by row, in this machine's byte order.
    fn read<T: Element, R>(
        &self,
        array: &Bound<'py, PyUntypedArray>,
        take: impl FnOnce(&[T]) -> R,
    ) -> PyResult<R> {
        let py = array.py();
        let _inside = ending::enter()?;
        let options = PyDict::new(py);
        options.set_item("dtype", numpy::dtype::<T>(py))?;
        let contiguous = numpy::get_array_module(py)?.call_method(
            "ascontiguousarray",
            (array,),
            Some(&options),
        )?;
        let contiguous = contiguous
            .cast_into::<PyArrayDyn<T>>()
            .map_err(PyErr::from)?;
        let values = contiguous
            .try_readonly()
            .map_err(|_| self.fault("the array is being written to by another thread"))?;
        let values = values
            .as_slice()
            .map_err(|_| self.fault("numpy gave no contiguous copy"))?;
        Ok(take(values))
    }
}

fn shown(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!(
            "({})",
            shape
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(", ")
        ),
    }
}

/// A numpy array (n,).
pub fn column<T: Element>(py: Python<'_>, values: Vec<T>) -> Py<PyAny> {
    PyArray1::from_vec(py, values).into_any().unbind()
}

/// A numpy array of zeros, whose memory is not written before someone does.
pub fn zeros<T: Element, D: IntoDimension>(py: Python<'_>, shape: D) -> Py<PyAny> {
    PyArray::<T, D::Dim>::zeros(py, shape, false)
        .into_any()
        .unbind()
}

/// A numpy array (rows, columns) from values that stand row by row.
pub fn table<T: Element>(py: Python<'_>, values: Vec<T>, columns: usize) -> PyResult<Py<PyAny>> {
    let rows = values.len() / columns.max(1);
    Ok(PyArray1::from_vec(py, values)
        .reshape([rows, columns])?
        .into_any()
        .unbind())
}

/// A numpy array (n, 3) of doubles.
pub fn rows(py: Python<'_>, values: &[Vec3]) -> PyResult<Py<PyAny>> {
    owned_rows(py, values.to_vec())
}

/// The same of vectors that are given away: they are not copied.
pub fn owned_rows(py: Python<'_>, values: Vec<Vec3>) -> PyResult<Py<PyAny>> {
    let numbers: Vec<[f64; 3]> = values.into_iter().map(Into::into).collect();
    table(py, numbers.into_flattened(), 3)
}

/// A numpy array (3,) of doubles.
pub fn triple(py: Python<'_>, value: Vec3) -> Py<PyAny> {
    column(py, vec![value.x, value.y, value.z])
}
