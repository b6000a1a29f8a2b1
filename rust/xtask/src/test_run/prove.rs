//! `cargo xtask prove`: the blind trial of the diagnosis, with the baselines beside it.

use crate::environment::python::BLENDER_50;
use crate::places::Places;
use crate::setup;
use anyhow::{Context, Result};
use std::process::{Command, ExitCode};

/// Set up, then `tests/trial/prove.py` with these arguments; its exit code is the command's: 1 if a row falls short.
///
/// # Errors
/// If the set-up fails or Python does not start.
pub fn run(places: &Places, arguments: &[String]) -> Result<ExitCode> {
    setup::user_environment(places)?;
    let arguments = arguments.iter().skip_while(|word| *word == "--");
    let mut command = Command::new(places.python(BLENDER_50.name));
    command
        .current_dir(&places.root)
        .args(["-m", "trial.prove"])
        .args(arguments)
        .env("PYTHONPATH", places.root.join("tests"))
        .env("THENAR_RESULTS", "1");
    // One case per core: threads within a case would only take turns.
    for library in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"] {
        command.env(library, "1");
    }
    let status = command.status().context("the trial: cannot start Python")?;
    Ok(match status.code() {
        Some(0) => ExitCode::SUCCESS,
        Some(2) => ExitCode::from(2),
        _ => ExitCode::FAILURE,
    })
}
