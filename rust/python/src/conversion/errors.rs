//! The one error table: which Rust error becomes which Python exception.

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use thenar_contact::ContactError;
use thenar_hand::HandError;
use thenar_inference::InferenceError;
use thenar_recordings::RecordingError as RecordingFault;
use thenar_reference::ReferenceError;
use thenar_surface::MeshError as MeshFault;

create_exception!(
    thenar,
    ThenarError,
    PyException,
    "Anything that thenar refuses; the message says what, where, and the remedy."
);
create_exception!(
    thenar,
    MeshError,
    ThenarError,
    "A mesh, or an array that belongs to one, cannot be used."
);
create_exception!(
    thenar,
    MaterialError,
    ThenarError,
    "A material number is not admissible, or a region has no material."
);
create_exception!(
    thenar,
    SolveError,
    ThenarError,
    "A press was asked for something it cannot do, or was not solved; `vertices` are those of the hand where it failed."
);
create_exception!(
    thenar,
    RecordingError,
    ThenarError,
    "A recording or study file cannot be used."
);
create_exception!(thenar, Cancelled, ThenarError, "The caller asked to stop.");

/// What an argument belongs to, and with it the exception its faults raise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Topic {
    Mesh,
    Material,
    Solve,
}

impl Topic {
    /// The exception for a fault in an argument of this topic.
    pub fn error(self, message: String) -> PyErr {
        match self {
            Topic::Mesh => MeshError::new_err(message),
            Topic::Material => MaterialError::new_err(message),
            Topic::Solve => SolveError::new_err(message),
        }
    }
}

/// Why work in a thread ended without a result.
#[derive(Debug)]
pub enum Failure {
    Contact(ContactError),
    Mesh(MeshFault),
    Hand(HandError),
    Recording(RecordingFault),
    Diagnosis(InferenceError),
    Reference(ReferenceError),
    Cancelled,
}

impl From<ContactError> for Failure {
    fn from(error: ContactError) -> Failure {
        Failure::Contact(error)
    }
}

impl From<MeshFault> for Failure {
    fn from(error: MeshFault) -> Failure {
        Failure::Mesh(error)
    }
}

impl From<InferenceError> for Failure {
    fn from(error: InferenceError) -> Failure {
        match error {
            InferenceError::Cancelled => Failure::Cancelled,
            error => Failure::Diagnosis(error),
        }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> PyErr {
        match failure {
            Failure::Contact(error) => from_contact(error),
            Failure::Mesh(error) => MeshError::new_err(error.to_string()),
            Failure::Hand(error) => MeshError::new_err(error.to_string()),
            Failure::Recording(error) => RecordingError::new_err(error.to_string()),
            Failure::Diagnosis(error) => RecordingError::new_err(error.to_string()),
            Failure::Reference(error) => from_reference(&error),
            Failure::Cancelled => {
                Cancelled::new_err("cancelled before it was done, as asked; nothing was changed")
            }
        }
    }
}

fn from_reference(error: &ReferenceError) -> PyErr {
    match error {
        ReferenceError::Cancelled => Failure::Cancelled.into(),
        ReferenceError::Tissue { .. } => MeshError::new_err(error.to_string()),
        _ => {
            let raised = SolveError::new_err(error.to_string());
            let vertices: Vec<usize> = error.vertex().into_iter().collect();
            Python::attach(|py| drop(raised.value(py).setattr("vertices", vertices)));
            raised
        }
    }
}

fn from_contact(error: ContactError) -> PyErr {
    let message = error.to_string();
    let vertices = error.vertices().to_vec();
    let raised = exception(error, message);
    // Without memory for it the message still says the place.
    Python::attach(|py| drop(raised.value(py).setattr("vertices", vertices)));
    raised
}

fn exception(error: ContactError, message: String) -> PyErr {
    match error {
        ContactError::Cancelled => Failure::Cancelled.into(),
        ContactError::Hand(_)
        | ContactError::Product(_)
        | ContactError::RegionCount { .. }
        | ContactError::GripCount { .. }
        | ContactError::NoSkin
        | ContactError::TooCoarse { .. }
        | ContactError::PosedCount { .. }
        | ContactError::PosedNotFinite { .. } => MeshError::new_err(message),
        ContactError::Elastomer { .. }
        | ContactError::UnknownElastomer { .. }
        | ContactError::Material { .. }
        | ContactError::MissingMaterial { .. } => MaterialError::new_err(message),
        _ => SolveError::new_err(message),
    }
}

/// Adds every exception to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("ThenarError", py.get_type::<ThenarError>())?;
    module.add("MeshError", py.get_type::<MeshError>())?;
    module.add("MaterialError", py.get_type::<MaterialError>())?;
    module.add("SolveError", py.get_type::<SolveError>())?;
    module.add("RecordingError", py.get_type::<RecordingError>())?;
    module.add("Cancelled", py.get_type::<Cancelled>())
}
