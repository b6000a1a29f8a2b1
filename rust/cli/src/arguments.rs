//! The commands of the binary; the arguments of each stand in its own file.

use crate::commands::compare::CompareArguments;
use crate::commands::press::PressArguments;
use crate::commands::read::ReadArguments;
use clap::{Parser, Subcommand};

/// Contact of soft skin with products.
#[derive(Debug, Parser)]
#[command(name = "thenar", version, about, arg_required_else_help = false)]
pub struct Thenar {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Presses a hand against a product and writes vertices.csv, product.csv and summary.json.
    Press(Box<PressArguments>),
    /// Reads a measurement file of any maker, or a study's folder, and tells what it holds and what it does not say.
    Read(ReadArguments),
    /// Fits a study's parameters to its recordings and writes report.html, comparison.json and, for mats, residual.csv.
    Compare(CompareArguments),
    /// Says what physics a study's recordings show that the model leaves out; writes findings.json, report.html and comparison.json.
    Diagnose(CompareArguments),
}

/// One sentence from clap's error, which has several lines.
pub fn sentence(error: &clap::Error) -> String {
    let text = error.to_string();
    let first = text.split("\n\n").next().unwrap_or_default();
    let words: Vec<&str> = first.split_whitespace().collect();
    let sentence = words.join(" ");
    format!(
        "{}; see thenar --help",
        sentence.trim_start_matches("error: ")
    )
}
