//! The native wheel (cp311-abi3, manylinux_2_28) and its installation into an environment.

use crate::environment::python;
use crate::places::{Places, link_folder};
use crate::process;
use crate::stamp::{self, Key};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What every wheel of this project ends with on Linux.
const SUFFIX: &str = "-cp311-abi3-manylinux_2_28_x86_64.whl";

/// What the wheel is made of, from the top of the repository.
const SOURCES: [&str; 12] = [
    "Cargo.toml",
    "Cargo.lock",
    "rust/surface",
    "rust/contact",
    "rust/hand",
    "rust/reference",
    "rust/recordings",
    "rust/inference",
    "rust/comparison",
    "rust/diagnosis",
    "rust/report",
    "rust/python",
];

/// Builds the wheel unless it is up to date; returns its path.
///
/// # Errors
/// If a source cannot be read or maturin fails.
pub fn build(places: &Places) -> Result<PathBuf> {
    let folder = places.target.join("wheels");
    let wheel = folder.join(format!("thenar-{}{SUFFIX}", env!("CARGO_PKG_VERSION")));
    let key = sources_key(places)?;
    let ready = folder.join(".ready");
    if wheel.is_file() && stamp::is_current(&ready, &key) {
        return Ok(wheel);
    }
    println!("building the wheel");
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make {}", folder.display()))?;
    stamp::remove(&ready)?;
    process::in_view(&mut maturin(places, &folder), "building the wheel")?;
    if !wheel.is_file() {
        bail!(
            "maturin did not make {}; rust/python/pyproject.toml must name the project thenar with the abi3-py311 feature",
            wheel.display()
        );
    }
    stamp::write(&ready, &key)?;
    Ok(wheel)
}

/// Installs the wheel into the environment `name` and makes the add-on importable there as `thenar_blender`.
///
/// # Errors
/// If pip fails or the add-on cannot be linked.
pub fn install(places: &Places, name: &str, wheel: &Path) -> Result<()> {
    let python = places.python(name);
    let key = Key::new("installed").files(wheel)?.finish();
    let ready = places.target.join(name).join(".thenar");
    if !stamp::is_current(&ready, &key) {
        println!("installing the wheel in target/{name}");
        stamp::remove(&ready)?;
        let path = wheel.to_string_lossy();
        python::pip(&python, &["--no-deps", "--force-reinstall", &path])?;
        process::quiet(
            Command::new(&python).args(["-c", "import thenar"]),
            "importing the new wheel",
        )?;
        stamp::write(&ready, &key)?;
    }
    link_add_on(places, name)
}

fn maturin(places: &Places, folder: &Path) -> Command {
    let tools = places.target.join("tools");
    let mut search = vec![tools.join("bin")];
    search.extend(
        std::env::var_os("PATH")
            .iter()
            .flat_map(std::env::split_paths),
    );
    let mut command = Command::new(tools.join("bin/maturin"));
    command
        .args([
            "build",
            "--release",
            "--locked",
            "--zig",
            "--compatibility",
            "manylinux_2_28",
            "--quiet",
        ])
        .args(["--target", "x86_64-unknown-linux-gnu", "--manifest-path"])
        .arg(places.root.join("rust/python/Cargo.toml"))
        .arg("--out")
        .arg(folder)
        .env("CARGO_TARGET_DIR", &places.cargo_target)
        .env("VIRTUAL_ENV", &tools);
    if let Ok(path) = std::env::join_paths(search) {
        command.env("PATH", path);
    }
    command
}

fn sources_key(places: &Places) -> Result<String> {
    let mut key = Key::new("wheel");
    for tool in python::TOOLS.packages {
        key = key.text(tool);
    }
    for source in SOURCES {
        key = key.files(&places.root.join(source))?;
    }
    Ok(key.finish())
}

/// A link, so that edits of the add-on count at once and nothing is written into `addon`.
fn link_add_on(places: &Places, name: &str) -> Result<()> {
    let link = site_packages(places, name)?.join("thenar_blender");
    let source = places.root.join("addon");
    if std::fs::read_link(&link).is_ok_and(|to| to == source) {
        return Ok(());
    }
    stamp::remove(&link)?;
    link_folder(&source, &link).with_context(|| format!("cannot link {}", link.display()))
}

fn site_packages(places: &Places, name: &str) -> Result<PathBuf> {
    let script = "import sysconfig; print(sysconfig.get_path('purelib'))";
    let path = process::quiet(
        Command::new(places.python(name)).args(["-c", script]),
        "asking Python for its packages",
    )?;
    Ok(PathBuf::from(path.trim()))
}

#[cfg(test)]
mod tests {
    use super::SOURCES;

    #[test]
    fn every_crate_in_the_wheel_is_a_source_of_it() {
        let manifest = include_str!("../../../python/Cargo.toml");
        let ours: Vec<String> = manifest
            .lines()
            .filter_map(|line| line.strip_prefix("thenar-")?.split([' ', '.']).next())
            .map(|name| format!("rust/{name}"))
            .collect();
        assert!(ours.len() > 3, "{ours:?}");
        for name in ours {
            assert!(SOURCES.contains(&name.as_str()), "{name} can change unseen");
        }
    }
}
