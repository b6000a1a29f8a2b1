//! What the binary can be told.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

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

#[derive(Debug, Args)]
pub struct ReadArguments {
    /// Export of a pressure mat or indenter, or a folder with study.toml.
    pub file: PathBuf,
    /// Which column of a table is what, where the file does not say: travel_mm=-Extension, force=Fz; a minus before the name turns the sign.
    #[arg(long = "column", value_name = "WHAT=NAME")]
    pub columns: Vec<String>,
    /// The one run to read of a workbook or a map of curves.
    #[arg(long, value_name = "NAME")]
    pub run: Option<String>,
}

#[derive(Debug, Args)]
pub struct PressArguments {
    /// Undeformed hand: OBJ, PLY or STL.
    pub hand: PathBuf,
    /// Product, in the frame of the (posed) hand: OBJ, PLY or STL.
    pub product: PathBuf,
    /// Contact model.
    #[arg(long, value_enum, default_value_t = ModelName::Layer)]
    pub model: ModelName,
    /// CSV of vertex,region: numbers from 0, or names; -1, none or empty for no skin.
    #[arg(long, value_name = "R.csv")]
    pub regions: Option<PathBuf>,
    /// TOML with a table of material numbers by region number, name, or `default`; without it all skin is a fingertip's.
    #[arg(long, value_name = "M.toml")]
    pub materials: Option<PathBuf>,
    /// Writes a contact that does not reach its tolerances as far as it came, graded "do not use"; else it is an error.
    #[arg(long)]
    pub keep_unsolved: bool,
    /// Moves the product until the normal force is this, N.
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        group = "travel"
    )]
    pub force: Option<f64>,
    /// CSV of time_s and depth_mm, offset_mm or force_n: follows it from rest and writes protocol.csv too.
    #[arg(long, value_name = "P.csv", group = "travel")]
    pub protocol: Option<PathBuf>,
    /// TOML with a table `[[effect]]` for each effect: name, amplitude, regions, numbers.
    #[arg(long, value_name = "E.toml")]
    pub effects: Option<PathBuf>,
    /// Where the product moves for --force or --protocol; the mean normal of the contact if not given.
    #[arg(long, value_name = "x,y,z", value_parser = direction, requires = "travel", allow_hyphen_values = true)]
    pub direction: Option<[f64; 3]>,
    /// Unit of all meshes.
    #[arg(long, value_enum, default_value_t = Unit::Mm)]
    pub unit: Unit,
    /// The hand in another posture: the same vertices in the same order.
    #[arg(long, value_name = "POSED")]
    pub posed: Option<PathBuf>,
    /// Threads to work with; all if not given. The result does not depend on it.
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Folder for the results; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ModelName {
    Layer,
    Paper,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Unit {
    Mm,
    M,
}

impl Unit {
    /// Length of the unit, mm.
    pub fn millimeters(self) -> f64 {
        match self {
            Unit::Mm => 1.0,
            Unit::M => 1000.0,
        }
    }
}

fn direction(text: &str) -> Result<[f64; 3], String> {
    let parts: Result<Vec<f64>, _> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>())
        .collect();
    match parts.as_deref() {
        Ok([x, y, z]) => Ok([*x, *y, *z]),
        _ => Err("expected three numbers such as 0,0,-1".into()),
    }
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
