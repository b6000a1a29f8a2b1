//! Errors of the crate: why a study could not be compared.

use thenar_contact::ContactError;
use thenar_surface::MeshError;

/// A study that could not be replayed or fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InferenceError {
    /// The study's skin is no mesh to press.
    #[error("the study's skin: {0}")]
    Skin(MeshError),
    /// A tool is no mesh to press with.
    #[error("the indenter '{indenter}': {source}")]
    Indenter {
        /// Name in the study.
        indenter: String,
        /// What is wrong with its mesh.
        source: MeshError,
    },
    /// A tool is too thin, or lies along its own travel.
    #[error("the indenter '{indenter}' at site '{site}': {problem}")]
    Placing {
        /// Name of the tool.
        indenter: String,
        /// Name of the place.
        site: String,
        /// What is wrong, and the remedy.
        problem: String,
    },
    /// The skin, its regions or materials were refused, or cannot be pressed.
    #[error("{what}: {source}")]
    Contact {
        /// What was being done.
        what: String,
        /// What the contact model says.
        source: ContactError,
    },
    /// Grasps that cannot be diagnosed together, or as they are asked to be.
    #[error("the study's grasps: {problem}")]
    Grasps {
        /// What is wrong, and the remedy.
        problem: String,
    },
    /// There is nothing to compare with.
    #[error(
        "none of the study's {recordings} recordings has a sample that can be simulated; {reasons}"
    )]
    NothingMeasured {
        /// Number of recordings.
        recordings: usize,
        /// Why not, from the recordings.
        reasons: String,
    },
    /// There are more numbers to fit than samples.
    #[error(
        "{samples} samples cannot carry {parameters} parameters; add recordings, or fit fewer (`fit` of the study's materials)"
    )]
    TooFewSamples {
        /// Number of samples.
        samples: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl InferenceError {
    /// The contact model's error, said of `what`; a cancellation stays one.
    pub fn of_contact(what: impl Into<String>) -> impl FnOnce(ContactError) -> InferenceError {
        let what = what.into();
        move |source| match source {
            ContactError::Cancelled => InferenceError::Cancelled,
            source => InferenceError::Contact { what, source },
        }
    }
}
