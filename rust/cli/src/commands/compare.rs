//! `thenar compare`: loads a study, fits and compares, writes the report.

use crate::fault::Fault;
use crate::progress::ProgressLine;
use crate::results::{self, Output};
use crate::{interrupt, threads};
use clap::Args;
use std::fmt::Write;
use std::path::Path;
use std::path::PathBuf;
use thenar_comparison::Comparison;
use thenar_comparison::{compare, of_what};
use thenar_contact::Control;
use thenar_inference::Options;
use thenar_recordings::Study;
use thenar_report::{comparison_html, comparison_json};

#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Folder with study.toml.
    pub study: PathBuf,
    /// Seed of all that is drawn; the same seed gives the same bytes.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Threads to work with; all if not given. The result does not depend on it.
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Loads, compares, writes, and tells what came out on the terminal.
///
/// # Errors
/// One sentence; then nothing was written.
pub fn run(arguments: &CompareArguments) -> Result<(), Fault> {
    interrupt::watch()?;
    threads::use_only(arguments.threads)?;
    let line = ProgressLine::new();
    let control = Control {
        cancelled: &interrupt::is_cancelled,
        progress: &|stage, share| line.show(stage, share),
    };
    let study = Study::load(&arguments.study)?;
    let options = Options {
        seed: arguments.seed,
        ..Options::default()
    };
    let comparison = compare(&study, &options, &control)?;
    let mut outputs = vec![Output {
        name: "report.html",
        text: comparison_html(&comparison),
    }];
    outputs.extend(residuals(&comparison));
    outputs.extend(prints(&comparison));
    outputs.push(Output {
        name: "comparison.json",
        text: comparison_json(&comparison),
    });
    interrupt::writing(|| results::write(&arguments.out, &outputs))?;
    drop(line);
    crate::terminal::write(&summary(&study, &comparison, &arguments.out));
    Ok(())
}

/// A name as a cell of a CSV; an apostrophe keeps spreadsheets from taking it for a formula.
fn cell(name: &str) -> String {
    let name = name.replace('"', "\"\"");
    match name.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        true => format!("\"'{name}\""),
        false => format!("\"{name}\""),
    }
}

/// residual.csv: for every calibrated mat the residual per skin vertex in its worst frame, kPa, empty away from the mat.
fn residuals(comparison: &Comparison) -> Option<Output> {
    let mats: Vec<_> = comparison
        .recordings
        .iter()
        .filter(|recording| !recording.residual_kpa.is_empty())
        .collect();
    let vertices = mats.first()?.residual_kpa.len();
    let mut text = "recording,vertex,residual_kpa\n".to_owned();
    for recording in &mats {
        let name = cell(&recording.name);
        for vertex in 0..vertices {
            let residual = recording.residual_kpa[vertex];
            if !residual.is_nan() {
                let _ = writeln!(text, "{name},{vertex},{residual}");
            }
        }
    }
    Some(Output {
        name: "residual.csv",
        text,
    })
}

/// prints.csv: for every handprint the residual per skin vertex, 1 inked alone, -1 simulated alone, 0 both or neither; vertices of which
/// nothing is known are left out.
fn prints(comparison: &Comparison) -> Option<Output> {
    let mut text = "recording,vertex,print_residual\n".to_owned();
    let mut has_any = false;
    for recording in &comparison.recordings {
        let Some(print) = &recording.print else {
            continue;
        };
        has_any = true;
        let name = cell(&recording.name);
        let known = print.on_skin.iter().enumerate();
        for (vertex, residual) in known.filter(|(_, residual)| !residual.is_nan()) {
            let _ = writeln!(text, "{name},{vertex},{residual}");
        }
    }
    has_any.then_some(Output {
        name: "prints.csv",
        text,
    })
}

fn summary(study: &Study, comparison: &Comparison, out: &Path) -> String {
    let mut text = format!("{}\n\n", comparison.sentence);
    for recording in &comparison.recordings {
        text += &format!("{}: {}\n", recording.name, recording.sentence);
        for unknown in &recording.unknown {
            text += &format!("  not known: {unknown}\n");
        }
    }
    for estimate in &comparison.estimates {
        text += &format!(
            "{} {} = {} ({} to {})\n",
            of_what(&estimate.target),
            estimate.name,
            short(estimate.value),
            short(estimate.low),
            short(estimate.high)
        );
    }
    for note in study.warnings.iter().chain(&comparison.notes) {
        text += &format!("note: {note}\n");
    }
    text + &format!("written to {}\n", out.display())
}

/// Four decimals, or four digits of what they would not show.
fn short(value: f64) -> String {
    match value.abs() {
        size if size > 0.0 && size < 1e-3 => format!("{value:.3e}"),
        _ => format!("{value:.4}"),
    }
}
