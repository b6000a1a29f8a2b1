//! Mesh, study and measurement files to arrays with units; the only library crate that reads files.
//!
//! Knows nothing of physics or of Blender. Every error names the file, the line or byte, and the remedy.

mod error;
pub mod meshes;

pub use error::RecordingError;
