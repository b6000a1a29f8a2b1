//! Where things stand: the repository, cargo's build folder, and every product of setup.

use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// The folders that the commands read and write.
pub struct Places {
    /// Top of the repository.
    pub root: PathBuf,
    /// What setup makes, always `target` at the top, wherever cargo builds.
    pub target: PathBuf,
    /// Where cargo builds; differs from `target` if `CARGO_TARGET_DIR` is set.
    pub cargo_target: PathBuf,
}

impl Places {
    /// Finds the folders from where this program and its source lie.
    pub fn find() -> Result<Places> {
        let source = std::env::var_os("CARGO_MANIFEST_DIR")
            .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
        let root = source
            .ancestors()
            .nth(2)
            .context("rust/xtask has moved: it must lie two folders below the top")?
            .to_path_buf();
        let program = std::env::current_exe().context("cannot tell where cargo built xtask")?;
        let cargo_target = program
            .ancestors()
            .nth(2)
            .context("xtask does not lie in a cargo target folder")?
            .to_path_buf();
        let target = root.join("target");
        std::fs::create_dir_all(&target)
            .with_context(|| format!("cannot make {}", target.display()))?;
        Ok(Places {
            root,
            target,
            cargo_target,
        })
    }

    /// The interpreter of the environment `name` (`tools`, `venv`, `venv45`, ...).
    pub fn python(&self, name: &str) -> PathBuf {
        interpreter(&self.target.join(name))
    }

    /// Blender's user folder with the extension installed.
    pub fn blender_resources(&self) -> PathBuf {
        self.target.join("blender")
    }
}

/// The interpreter of the environment in `folder`.
pub fn interpreter(folder: &Path) -> PathBuf {
    folder.join(if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    })
}

/// Makes `link` point to the folder `to`. Windows allows it to administrators and in its developer mode.
pub fn link_folder(to: &Path, link: &Path) -> std::io::Result<()> {
    #[cfg(windows)]
    return std::os::windows::fs::symlink_dir(to, link);
    #[cfg(not(windows))]
    return std::os::unix::fs::symlink(to, link);
}

/// A path as the user would type it from the top of the repository.
pub fn shown(path: &Path, root: &Path) -> String {
    path.strip_prefix(root)
        .unwrap_or(path)
        .display()
        .to_string()
}
