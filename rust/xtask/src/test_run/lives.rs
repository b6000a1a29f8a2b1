//! `cargo xtask blenders`: what is tested of the extension in Blender modules by name, without the other tests.

use crate::environment::blenders;
use crate::environment::python::BLENDER_50;
use crate::places::Places;
use crate::setup;
use crate::test_run::steps::run_in_view;
use crate::test_run::testing::{VERSIONS, pytest};
use anyhow::{Result, ensure};
use std::process::ExitCode;

/// The option for the whole of `tests/blender`.
const TESTS: &str = "--tests";

/// `cargo xtask blenders [VERSION...]`: the whole life of the extension in these versions. With `--tests` first: the
/// whole of `tests/blender` in them.
///
/// # Errors
/// If a version is unknown, none can be tested here, or the set-up fails; a failed test is an exit code.
pub fn run(places: &Places, words: &[String]) -> Result<ExitCode> {
    match words {
        [option, versions @ ..] if option == TESTS => all_tests(places, versions),
        _ => whole_life(places, words),
    }
}

fn whole_life(places: &Places, words: &[String]) -> Result<ExitCode> {
    let versions = blenders::chosen(words)?;
    setup::user_environment(places)?;
    blenders::make(places, &versions)?;
    let mut step = pytest(places, "packaging/test_whole_life.py", BLENDER_50.name);
    step.command.env(VERSIONS, versions.join(" "));
    Ok(run_in_view(vec![step]))
}

fn all_tests(places: &Places, words: &[String]) -> Result<ExitCode> {
    let versions = blenders::chosen_for_tests(words)?;
    setup::user_environment(places)?;
    blenders::make(places, &versions)?;
    let environments = blenders::with_tests(&versions);
    ensure!(
        !environments.is_empty(),
        "none of these versions can be tested here; their CPython is missing"
    );
    let steps = environments
        .into_iter()
        .map(|environment| pytest(places, "blender", environment));
    Ok(run_in_view(steps.collect()))
}
