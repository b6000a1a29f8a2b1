//! The commands that run the add-on on samples: `demo`, `samples`, and the benchmarks against peers.

use crate::environment::python::{self, BLENDER_50, Environment};
use crate::places::Places;
use crate::process;
use crate::{environment::blenders, environment::wheel, setup};
use anyhow::Result;
use std::process::{Command, ExitCode};

/// Where the benchmarks run; peers come on top, each if it can be installed.
const BENCH: Environment = Environment {
    name: "bench-venv",
    version: "3.11",
    packages: &["numpy==1.26.4", "scipy==1.17.1"],
};

/// What the benchmarks compare with; Siconos is no package of this index, its benchmark fetches it from Debian.
const PEERS: [&str; 2] = ["open3d==0.20.0", "numba>=0.61"];

/// `cargo xtask demo`: solves and renders the sample grasp in a fresh Blender.
///
/// # Errors
/// If the set-up or the demo fails.
pub fn demo(places: &Places, arguments: &[String]) -> Result<ExitCode> {
    setup::user_environment(places)?;
    let mut command = add_on(places, BLENDER_50.name, "demo");
    command
        .args(["--samples", "blend-samples", "--out", "target/demo"])
        .args(arguments);
    process::in_view(&mut command, "the demo")?;
    Ok(ExitCode::SUCCESS)
}

/// `cargo xtask samples`: makes `blend-samples` from code, in Blender 4.2: a later one's files need not open in it.
///
/// # Errors
/// If the set-up or the making fails.
pub fn samples(places: &Places) -> Result<ExitCode> {
    let mut command = add_on(places, blenders::oldest(places)?, "samples");
    command.args(["--out", "blend-samples"]);
    process::in_view(&mut command, "making the samples")?;
    Ok(ExitCode::SUCCESS)
}

/// `cargo xtask bench`: runs `tests/bench/run.py` beside every peer that can be installed.
///
/// # Errors
/// If the set-up or the benchmarks fail; a peer that cannot be installed is only reported.
pub fn bench(places: &Places, arguments: &[String]) -> Result<ExitCode> {
    let wheel = setup::wheel(places)?;
    python::make(places, &BENCH)?;
    let python = places.python(BENCH.name);
    for peer in PEERS {
        if let Err(error) = python::pip(&python, &[peer]) {
            println!(
                "peer {peer} is left out: {}",
                error.to_string().lines().last().unwrap_or_default()
            );
        }
    }
    wheel::install(places, BENCH.name, &wheel)?;
    let mut command = Command::new(python);
    command
        .current_dir(&places.root)
        .arg("tests/bench/run.py")
        .env("THENAR_RESULTS", "1")
        .args(arguments);
    process::in_view(&mut command, "the benchmarks")?;
    Ok(ExitCode::SUCCESS)
}

fn add_on(places: &Places, environment: &str, word: &str) -> Command {
    let mut command = Command::new(places.python(environment));
    command
        .current_dir(&places.root)
        .args(["-m", "thenar_blender", word])
        .env("BLENDER_USER_RESOURCES", places.blender_resources());
    command
}
