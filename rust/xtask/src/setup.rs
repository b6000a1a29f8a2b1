//! Conducts the set-up: environments and wheel side by side, then the extension and the binary.

use crate::environment::python::{self, BLENDER_45, BLENDER_50, PLAIN_313, TOOLS};
use crate::places::{Places, shown};
use crate::process;
use crate::{environment::extension, environment::wheel};
use anyhow::{Context, Result, anyhow, ensure};
use std::fs::File;
use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::Instant;

/// `cargo xtask setup`.
///
/// # Errors
/// The first step that failed, in one sentence, with the tail of its output.
pub fn run(places: &Places) -> Result<ExitCode> {
    let start = Instant::now();
    let zip = user_environment(places)?;
    println!(
        "ready in {:.0} s: {}, target/venv, target/blender, target/release/thenar",
        start.elapsed().as_secs_f64(),
        shown(&zip, &places.root)
    );
    Ok(ExitCode::SUCCESS)
}

/// The wheel alone, for what needs no Blender; returns its path.
///
/// # Errors
/// If the tools cannot be installed or the wheel does not build.
pub fn wheel(places: &Places) -> Result<PathBuf> {
    let _alone = lock(places)?;
    python::make(places, &TOOLS)?;
    wheel::build(places)
}

/// Everything a user needs; returns the extension zip.
pub fn user_environment(places: &Places) -> Result<PathBuf> {
    ensure!(
        cfg!(all(target_os = "linux", target_arch = "x86_64")),
        "setup is made for Linux on x86_64; for Windows and macOS see .github/workflows/release.yml"
    );
    let _alone = lock(places)?;
    python::make(places, &TOOLS)?;
    let wheel = std::thread::scope(|scope| {
        let environment = scope.spawn(|| python::make(places, &BLENDER_50));
        let wheel = wheel::build(places).and_then(|wheel| binary(places).map(|()| wheel));
        environment
            .join()
            .map_err(|_| anyhow!("making target/venv panicked"))??;
        wheel
    })?;
    wheel::install(places, BLENDER_50.name, &wheel)?;
    let zip = extension::build(places, &wheel)?;
    extension::install(places, &zip)?;
    Ok(zip)
}

/// What tests need beyond the user's environment: the Blender 4.5 module with the same wheel.
pub fn test_environment(places: &Places) -> Result<PathBuf> {
    let zip = user_environment(places)?;
    let _alone = lock(places)?;
    python::make(places, &BLENDER_45)?;
    let wheel = wheel::build(places)?;
    wheel::install(places, BLENDER_45.name, &wheel)?;
    if python::find(PLAIN_313.version).is_ok() {
        python::make(places, &PLAIN_313)?;
        wheel::install(places, PLAIN_313.name, &wheel)?;
    }
    Ok(zip)
}

/// A cargo command that builds where this program was built.
pub fn cargo(places: &Places) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .current_dir(&places.root)
        .env("CARGO_TARGET_DIR", &places.cargo_target);
    command
}

fn binary(places: &Places) -> Result<()> {
    let mut command = cargo(places);
    command.args([
        "build",
        "--release",
        "--locked",
        "--quiet",
        "--package",
        "thenar-cli",
    ]);
    process::in_view(&mut command, "building the thenar binary")?;
    if places.cargo_target != places.target {
        let (built, wanted) = (
            places.cargo_target.join("release/thenar"),
            places.target.join("release"),
        );
        std::fs::create_dir_all(&wanted)
            .and_then(|()| std::fs::copy(&built, wanted.join("thenar.partial")))
            .and_then(|_| std::fs::rename(wanted.join("thenar.partial"), wanted.join("thenar")))
            .with_context(|| format!("cannot copy {} to {}", built.display(), wanted.display()))?;
    }
    Ok(())
}

/// Two set-ups in one target folder would break each other: the second waits.
pub fn lock(places: &Places) -> Result<File> {
    let path = places.target.join(".setup-lock");
    let file = File::create(&path).with_context(|| format!("cannot make {}", path.display()))?;
    file.lock()
        .with_context(|| format!("cannot lock {}", path.display()))?;
    Ok(file)
}
