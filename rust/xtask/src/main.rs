//! The project's commands: which word runs what, and how a failure is told.

mod environment;
mod test_run;
mod places;
mod process;
mod stamp;
mod setup;
mod demo;

use anyhow::{Result, bail};
use places::Places;
use std::process::ExitCode;

const USAGE: &str = "cargo xtask COMMAND

  setup     wheel, extension zip, target/venv with bpy, target/blender, target/release/thenar
  demo      solve and render the sample grasp into target/demo
  test      every test: Rust, Python, Blender, architecture, packaging, docs, lint; `--blenders all` (or `4.2,5.3`):
            the whole life of the extension in these Blender modules of PyPI too, besides 4.5 and 5.0; with 5.3
            (CPython 3.13) among them the whole of tests/blender there as well
  blenders [VERSION...]  only the whole life of the extension, in every Blender module of PyPI or in those named
  blenders --tests [VERSION...]  only the whole of tests/blender, in 5.3 or in those named of 4.5, 5.0, 5.3
  samples   make blend-samples from code, in the oldest Blender
  prove     the blind trial of the diagnosis: table of verdicts against sealed labels (`-- --help`: options)
  bench     benchmarks, each as a ratio against a peer in the same run
  bundle WHEEL...  one extension zip per platform from ready wheels (for releases)";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match dispatch(&arguments) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn dispatch(arguments: &[String]) -> Result<ExitCode> {
    let (command, rest) = match arguments.split_first() {
        Some((command, rest)) => (command.as_str(), rest),
        None => ("help", arguments),
    };
    let places = Places::find()?;
    match command {
        "setup" => setup::run(&places),
        "demo" => demo::demo(&places, rest),
        "test" => test_run::testing::run(&places, rest),
        "blenders" => test_run::lives::run(&places, rest),
        "samples" => demo::samples(&places),
        "bench" => demo::bench(&places, rest),
        "prove" => test_run::prove::run(&places, rest),
        "bundle" => environment::extension::bundle_command(&places, rest),
        "help" | "--help" | "-h" => {
            println!("{USAGE}");
            Ok(ExitCode::SUCCESS)
        }
        other => bail!("there is no command '{other}'; run `cargo xtask` for the list"),
    }
}
