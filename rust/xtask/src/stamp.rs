//! Whether a product is still what its inputs would make: content hashes kept beside the product.

use anyhow::{Context, Result};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// Gathers inputs into one key. The same inputs give the same key until the compiler changes its hasher.
pub struct Key(DefaultHasher);

impl Key {
    /// Starts a key; `purpose` keeps products with equal inputs apart.
    pub fn new(purpose: &str) -> Key {
        let mut hasher = DefaultHasher::new();
        purpose.hash(&mut hasher);
        Key(hasher)
    }

    /// Adds a text, such as a version.
    pub fn text(mut self, text: &str) -> Key {
        text.hash(&mut self.0);
        self
    }

    /// Adds a file, or every file below a folder, names and bytes.
    pub fn files(mut self, path: &Path) -> Result<Key> {
        for file in files_below(path)? {
            file.strip_prefix(path).unwrap_or(&file).hash(&mut self.0);
            let bytes =
                std::fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
            bytes.hash(&mut self.0);
        }
        Ok(self)
    }

    /// The key as 16 hexadecimal digits.
    pub fn finish(self) -> String {
        format!("{:016x}", self.0.finish())
    }
}

/// Every file below `path` in a fixed order, without caches; `path` itself if it is a file.
pub fn files_below(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    let mut found = Vec::new();
    let mut folders = vec![path.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder)
            .with_context(|| format!("cannot list {}", folder.display()))?;
        for entry in entries {
            let entry = entry.with_context(|| format!("cannot list {}", folder.display()))?;
            if is_cache(&entry.file_name().to_string_lossy()) {
                continue;
            }
            if entry.path().is_dir() {
                folders.push(entry.path());
            } else {
                found.push(entry.path());
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Whether the stamp `file` holds `key`.
pub fn is_current(file: &Path, key: &str) -> bool {
    std::fs::read_to_string(file).is_ok_and(|text| text == key)
}

/// Takes the stamp away before its product is touched.
pub fn remove(file: &Path) -> Result<()> {
    match std::fs::remove_file(file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", file.display()))
        }
        _ => Ok(()),
    }
}

/// Writes the stamp once its product is whole.
pub fn write(file: &Path, key: &str) -> Result<()> {
    let partial = file.with_extension("partial");
    std::fs::write(&partial, key)
        .and_then(|()| std::fs::rename(&partial, file))
        .with_context(|| format!("cannot write {}", file.display()))
}

fn is_cache(name: &str) -> bool {
    name.starts_with('.') || name == "__pycache__" || name.ends_with(".pyc")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key_of(folder: &Path) -> String {
        Key::new("test").files(folder).unwrap().finish()
    }

    #[test]
    fn key_follows_names_and_bytes_but_not_caches() {
        let folder = std::env::temp_dir().join(format!("thenar-stamp-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("__pycache__")).unwrap();
        std::fs::write(folder.join("a.py"), "one").unwrap();
        let before = key_of(&folder);
        std::fs::write(folder.join("__pycache__/a.pyc"), "cache").unwrap();
        assert_eq!(before, key_of(&folder));
        std::fs::write(folder.join("a.py"), "two").unwrap();
        let changed = key_of(&folder);
        assert_ne!(before, changed);
        std::fs::rename(folder.join("a.py"), folder.join("b.py")).unwrap();
        assert_ne!(changed, key_of(&folder));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn stamp_holds_only_after_it_was_written() {
        let file = std::env::temp_dir().join(format!("thenar-stamp-{}.txt", std::process::id()));
        assert!(!is_current(&file, "key"));
        write(&file, "key").unwrap();
        assert!(is_current(&file, "key"));
        assert!(!is_current(&file, "other"));
        remove(&file).unwrap();
        remove(&file).unwrap();
        assert!(!is_current(&file, "key"));
    }
}
