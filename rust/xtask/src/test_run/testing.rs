//! `cargo xtask test`: every check as a step with a time limit, and one honest sum at the end.

use crate::environment::blenders;
use crate::environment::python::{self, BLENDER_50, PLAIN_313, TOOLS};
use crate::places::Places;
use crate::process::{self, Output};
use crate::setup::{self, cargo};
use crate::test_run::steps::{Counted, Done, Step, report, run_in_lanes, run_step, step};
use crate::test_run::tally::Tally;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::{Command, ExitCode};

/// Name of the step that looks for known vulnerabilities.
const ADVISORIES: &str = "cargo deny advisories";

/// Folders of `tests` for which there are steps of their own.
const NOT_PLAIN: [&str; 1] = ["blender"];

/// Blender modules of the whole life of the extension by default: their environments are made for other tests anyway.
const LIVED_IN: [&str; 2] = ["4.5", "5.0"];

/// The variable that says to `tests/packaging/test_whole_life.py` which versions it is to live in.
pub const VERSIONS: &str = "THENAR_BLENDERS";

/// The plain folder that takes longest; it starts early, so that no lane ends long after the others.
const LONGEST: &str = "trial";

/// Sets up, runs every step, prints the sum. `--blenders all` or `--blenders 4.2,5.3` names further Blender modules for
/// the whole life of the extension; the whole of `tests/blender` runs in 5.3 too where it is among them.
///
/// # Errors
/// If an argument is unknown or the set-up fails; a failed step is an exit code.
pub fn run(places: &Places, arguments: &[String]) -> Result<ExitCode> {
    let further = match arguments {
        [] => &[],
        [option, words @ ..] if option == "--blenders" && !words.is_empty() => words,
        _ => {
            bail!("`cargo xtask test` takes `--blenders all` or `--blenders 4.2,5.3`, nothing else")
        }
    };
    let versions = blenders::chosen(&[further, &LIVED_IN.map(str::to_string)].concat())?;
    setup::test_environment(places)?;
    blenders::make(places, &versions)?;
    let mut steps = rust_steps(places);
    steps.extend(lint_steps(places));
    steps.extend(type_steps(places));
    let python_steps = python_steps(places, &versions)?;
    let mut done = Vec::new();
    match advisory_step(places) {
        Some(step) => steps.push(step),
        None => done.push(Done {
            name: ADVISORIES.to_string(),
            tally: Tally {
                skipped: 1,
                ..Tally::default()
            },
            seconds: 0.0,
            note: "their database cannot be fetched",
        }),
    }
    for step in steps {
        println!("\n== {}", step.name);
        done.push(run_step(step, Output::AsItComes));
    }
    done.extend(run_in_lanes(python_steps));
    Ok(report(&done))
}

fn rust_steps(places: &Places) -> Vec<Step> {
    let mut doc = cargo(places);
    doc.args(["doc", "--workspace", "--no-deps", "--locked", "--quiet"])
        .env("RUSTDOCFLAGS", "-D warnings");
    let mut clippy = cargo(places);
    clippy.args([
        "clippy",
        "--workspace",
        "--all-targets",
        "--locked",
        "--quiet",
        "--",
        "-D",
        "warnings",
    ]);
    let mut format = cargo(places);
    format.args(["fmt", "--all", "--check"]);
    let mut examples = cargo(places);
    examples.args(["test", "--workspace", "--locked", "--doc"]);
    vec![
        step("cargo fmt", format, Counted::AsOne),
        step("cargo clippy", clippy, Counted::AsOne),
        step("cargo nextest", nextest(places), Counted::ByNextest),
        step("cargo test --doc", examples, Counted::ByCargo),
        step("cargo doc", doc, Counted::AsOne),
    ]
}

/// The crates' tests but for examples in their documents, by `.config/nextest.toml`.
fn nextest(places: &Places) -> Command {
    let mut command = Command::new(places.target.join("tools/bin/cargo-nextest"));
    command
        .current_dir(&places.root)
        .env("CARGO_TARGET_DIR", &places.cargo_target)
        .args(["nextest", "run", "--workspace", "--locked"])
        .args(["--status-level", "slow", "--final-status-level", "slow"]);
    command
}

fn lint_steps(places: &Places) -> Vec<Step> {
    let ruff = |arguments: &[&str]| {
        let mut command = Command::new(places.target.join("tools/bin/ruff"));
        command
            .current_dir(&places.root)
            .args(arguments)
            .args(["addon", "tests", "rust"]);
        command
    };
    vec![
        step("ruff check", ruff(&["check"]), Counted::AsOne),
        step("ruff format", ruff(&["format", "--check"]), Counted::AsOne),
        step(
            "cargo deny",
            deny(places, &["check", "licenses", "bans", "sources"]),
            Counted::AsOne,
        ),
    ]
}

/// Types of the add-on by `.mypy.ini`, and the stub of the native module against the module itself.
fn type_steps(places: &Places) -> Vec<Step> {
    let (tools, user) = (places.python(TOOLS.name), places.python(BLENDER_50.name));
    let mut mypy = Command::new(&tools);
    mypy.current_dir(&places.root)
        .args(["-m", "mypy", "--python-executable"])
        .arg(&user);
    let mut stubtest = Command::new(&tools);
    stubtest
        .current_dir(&places.root)
        .args(["-m", "mypy.stubtest", "thenar", "--concise", "--allowlist"])
        .arg("rust/python/stubtest.txt")
        // Both environments are of one Python; the module and NumPy are in the user's alone.
        .env(
            "PYTHONPATH",
            places
                .target
                .join(BLENDER_50.name)
                .join(format!("lib/python{}/site-packages", BLENDER_50.version)),
        );
    vec![
        step("mypy --strict", mypy, Counted::AsOne),
        step("stubtest thenar.pyi", stubtest, Counted::AsOne),
    ]
}

/// None where the database of known vulnerabilities cannot be fetched: without a network.
fn advisory_step(places: &Places) -> Option<Step> {
    process::quiet(&mut deny(places, &["fetch", "db"]), "fetching advisories").ok()?;
    let check = deny(places, &["--offline", "check", "advisories"]);
    Some(step(ADVISORIES, check, Counted::AsOne))
}

fn deny(places: &Places, arguments: &[&str]) -> Command {
    let mut command = Command::new(places.target.join("tools/bin/cargo-deny"));
    command
        .current_dir(&places.root)
        .arg("--locked")
        .args(arguments);
    command
}

fn python_steps(places: &Places, versions: &[&str]) -> Result<Vec<Step>> {
    let tests = places.root.join("tests");
    let mut folders: Vec<String> = std::fs::read_dir(&tests)
        .with_context(|| format!("cannot list {}", tests.display()))?
        .flatten()
        .filter(|entry| holds_tests(&entry.path()))
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| !NOT_PLAIN.contains(&name.as_str()))
        .collect();
    folders.sort_by_key(|folder| (folder != LONGEST, folder.clone()));
    let mut steps = Vec::new();
    if tests.join("blender").is_dir() {
        steps.extend(
            blenders::with_tests(versions)
                .into_iter()
                .rev()
                .map(|environment| pytest(places, "blender", environment)),
        );
    }
    steps.extend(
        folders
            .iter()
            .map(|folder| pytest(places, folder, BLENDER_50.name)),
    );
    for step in &mut steps {
        step.command.env(VERSIONS, versions.join(" "));
    }
    if tests.join("python").is_dir() && python::find(PLAIN_313.version).is_ok() {
        steps.push(pytest(places, "python", PLAIN_313.name));
    }
    Ok(steps)
}

/// Whether pytest finds a file of tests directly in `folder`; it fails where there is none.
fn holds_tests(folder: &Path) -> bool {
    std::fs::read_dir(folder).is_ok_and(|entries| {
        entries.flatten().any(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            name.starts_with("test_") && name.ends_with(".py")
        })
    })
}

/// A step of pytest over `tests/FOLDER` in an environment.
pub fn pytest(places: &Places, folder: &str, environment: &str) -> Step {
    let mut command = Command::new(places.python(environment));
    command
        .current_dir(&places.root)
        .args(["-m", "pytest", "--quiet", "--durations=12"])
        .arg(Path::new("tests").join(folder))
        // Keeps the preferences of the person who runs this out of the tests, and the tests out of theirs.
        .env(
            "BLENDER_USER_RESOURCES",
            places
                .target
                .join("test-blender")
                .join(format!("{environment}-{}", folder.replace(['/', '.'], "-"))),
        );
    step(
        &format!("pytest tests/{folder} ({environment})"),
        command,
        Counted::ByPytest,
    )
}
