//! A record: a dict whose entries are attributes too; and what is made when it is first asked for.

use crate::conversion::ending;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use std::sync::{Mutex, PoisonError};

/// A subclass of a builtin needs Python 3.12 in the stable ABI, so the class is made by Python itself.
const SOURCE: &std::ffi::CStr = c"
class Record(dict):
    'A dict whose entries are attributes too: record.force_n is record[\"force_n\"].'
    __slots__ = ()
    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f'this record has no {name!r}; it has ' + ', '.join(map(str, self))) from None
    def __dir__(self):
        return [*super().__dir__(), *self]
    def __repr__(self):
        return 'Record(' + ', '.join(f'{name}={value!r}' for name, value in self.items()) + ')'
Record.__module__ = 'thenar'
";

static RECORD: PyOnceLock<Py<PyType>> = PyOnceLock::new();

fn class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    RECORD
        .get_or_try_init(py, || {
            let module = PyModule::from_code(py, SOURCE, c"thenar_record.py", c"thenar_record")?;
            Ok(module.getattr("Record")?.cast_into::<PyType>()?.unbind())
        })
        .map(|class| class.bind(py))
}

/// Adds the class `Record` to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Record", class(module.py())?)
}

/// An array or a record of a result, made of its source when it is first asked for; the same object ever after.
pub struct Once<S> {
    source: Mutex<Option<S>>,
    made: PyOnceLock<Py<PyAny>>,
}

impl<S> Once<S> {
    pub fn new(source: S) -> Once<S> {
        Once {
            source: Mutex::new(Some(source)),
            made: PyOnceLock::new(),
        }
    }

    /// What `make` returned, which is called once.
    pub fn get(
        &self,
        py: Python<'_>,
        make: impl FnOnce(S) -> PyResult<Py<PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        // Making objects may run Python's garbage collection, and with it Python code, in which a thread may be ended.
        let _inside = ending::enter()?;
        let made = self.made.get_or_try_init(py, || {
            let mut source = self.source.lock().unwrap_or_else(PoisonError::into_inner);
            // Gone only where making failed before, which takes a lack of memory.
            let source = source.take().ok_or_else(|| PyMemoryError::new_err(()))?;
            make(source)
        })?;
        Ok(made.clone_ref(py))
    }
}

/// A record with these entries.
pub fn record(entries: Bound<'_, PyDict>) -> PyResult<Py<PyAny>> {
    Ok(class(entries.py())?.call1((entries,))?.unbind())
}
