//! The study's folder: files are named relative to it and may not leave it.

use super::toml_tree::Entry;
use crate::RecordingError;
use crate::fault::{Fault, shown};
use std::path::{Component, Path, PathBuf};

/// The folder and the file that names its files.
pub(super) struct Folder {
    path: PathBuf,
    real: PathBuf,
    study: PathBuf,
}

impl Folder {
    pub fn new(path: &Path, study: &Path) -> Result<Folder, RecordingError> {
        let unreadable = |source| RecordingError::Unreadable {
            file: path.to_path_buf(),
            source,
        };
        let real = path.canonicalize().map_err(unreadable)?;
        Ok(Folder {
            path: path.to_path_buf(),
            real,
            study: study.to_path_buf(),
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A fault of the description itself.
    pub fn fault(&self, fault: Fault) -> RecordingError {
        fault.in_file(&self.study)
    }

    /// The file that an entry names.
    pub fn file(&self, entry: &Entry) -> Result<PathBuf, RecordingError> {
        self.inside(entry).map_err(|fault| self.fault(fault))
    }

    fn inside(&self, entry: &Entry) -> Result<PathBuf, Fault> {
        const REMEDY: &str = "copy the file into the study's folder and name it relative to it";
        let text = entry.text()?;
        let shown = shown(text.as_bytes());
        let relative = Path::new(&text);
        let is_plain = relative
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if text.is_empty() || text.contains('\\') {
            return Err(entry.fault(
                format!("{shown} is no file name"),
                "name a file of the folder, folders parted by /",
            ));
        }
        if !is_plain {
            return Err(entry.fault(format!("{shown} leaves the study's folder"), REMEDY));
        }
        let path = self.path.join(relative);
        let Ok(real) = path.canonicalize() else {
            return Err(entry.fault(
                format!("{shown} is not in the study's folder"),
                "check the name, or copy the file there",
            ));
        };
        if !real.starts_with(&self.real) {
            return Err(entry.fault(
                format!("{shown} is a link that leaves the study's folder"),
                REMEDY,
            ));
        }
        Ok(path)
    }
}
