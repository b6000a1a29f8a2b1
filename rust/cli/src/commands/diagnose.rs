//! `thenar diagnose`: loads a study, says what the model leaves out, writes findings and report.

use crate::commands::compare::CompareArguments;
use crate::fault::Fault;
use crate::progress::ProgressLine;
use crate::results::{self, Output};
use crate::{interrupt, threads};
use std::path::Path;
use thenar_contact::Control;
use thenar_diagnosis::{DiagnoseOptions, Diagnosis, diagnose, findings_json};
use thenar_recordings::Study;
use thenar_report::{comparison_json, diagnosis_html};

/// Loads, diagnoses, writes, and tells what came out on the terminal.
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
    let options = DiagnoseOptions {
        seed: arguments.seed,
    };
    let found = diagnose(&study, &options, &control)?;
    let outputs = [
        Output {
            name: "report.html",
            text: diagnosis_html(&found),
        },
        Output {
            name: "comparison.json",
            text: comparison_json(&found.comparison),
        },
        Output {
            name: "findings.json",
            text: findings_json(&found),
        },
    ];
    interrupt::writing(|| results::write(&arguments.out, &outputs))?;
    drop(line);
    crate::terminal::write(&summary(&study, &found, &arguments.out));
    Ok(())
}

fn summary(study: &Study, found: &Diagnosis, out: &Path) -> String {
    let mut text = format!("{}\n\n", found.sentence);
    for finding in &found.findings {
        text += &format!("{} ({})\n", finding.effect, finding.confidence.in_words());
        for number in &finding.numbers {
            let (value, between, unit) = number.in_words();
            let line = match number.is_bounded() {
                true => format!("  {} = {value} ({between}) {unit}", number.name),
                false => format!("  {}: {between} {unit}", number.name),
            };
            text += line.trim_end();
            text += "\n";
        }
        for (name, option) in found.choices(finding.effect) {
            text += &format!("  {name} = {option}\n");
        }
    }
    for next in &found.record_next {
        text += &format!("record next: {} ({})\n", next.text, next.outlook());
    }
    for note in study.warnings.iter().chain(&found.notes) {
        text += &format!("note: {note}\n");
    }
    text + &format!("written to {}\n", out.display())
}
