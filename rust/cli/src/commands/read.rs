//! `thenar read`: what a measurement file or a study holds, its totals checked, and what it does not say.

use crate::fault::Fault;
use clap::Args;
use std::fmt::{Error, Write};
use std::path::Path;
use std::path::PathBuf;
use thenar_recordings::study::{Data, Study};
use thenar_recordings::{
    Check, Curve, PressureMap, PressureUnit, ReadOptions, RecordingFile, Source,
};

/// Most runs of a file that are written out; a map of curves has thousands.
const MOST_RUNS: usize = 20;

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

/// The report on a file or a study's folder.
///
/// # Errors
/// What is wrong with it, in one sentence.
pub fn report(arguments: &ReadArguments) -> Result<String, Fault> {
    let file = &arguments.file;
    let options = options(arguments)?;
    let mut text = String::new();
    let written = if file.is_dir() {
        if options != ReadOptions::default() {
            let problem =
                "a study's recordings say in study.toml which run and which columns they are";
            return Err(Fault::Input(format!(
                "{problem}; take --column and --run out"
            )));
        }
        write_study(&mut text, &Study::load(file)?)
    } else {
        write_file(
            &mut text,
            file,
            &thenar_recordings::read_with(file, &options)?,
        )
    };
    written.map_err(|_| Fault::Other("the report could not be written".into()))?;
    Ok(text)
}

fn write_file(text: &mut String, file: &Path, read: &RecordingFile) -> Result<(), Error> {
    writeln!(text, "{}: {}", file.display(), read.format.name())?;
    read.maps.iter().try_for_each(|map| write_map(text, map))?;
    let curves = read.curves.iter().take(MOST_RUNS);
    curves
        .into_iter()
        .try_for_each(|curve| write_curve(text, curve))?;
    if let Some(last) = read.curves.last().filter(|_| read.curves.len() > MOST_RUNS) {
        writeln!(
            text,
            "  and {} more runs, the last is {:?}",
            read.curves.len() - MOST_RUNS,
            last.name
        )?;
    }
    read.notes
        .iter()
        .try_for_each(|note| writeln!(text, "  note: {note}"))
}

/// What the arguments say of the file.
fn options(arguments: &ReadArguments) -> Result<ReadOptions, Fault> {
    let mut options = ReadOptions {
        run: arguments.run.clone(),
        ..ReadOptions::default()
    };
    for text in &arguments.columns {
        let Some((key, header)) = text.split_once('=') else {
            let problem =
                format!("--column {text}: no name of a column; write --column travel_mm=NAME");
            return Err(Fault::Input(problem));
        };
        let added = options.columns.add(key.trim(), header);
        added.map_err(|problem| Fault::Input(format!("--column {text}: {problem}")))?;
    }
    Ok(options)
}

fn write_study(text: &mut String, study: &Study) -> Result<(), Error> {
    let (vertices, triangles) = (
        study.skin.mesh.positions.len(),
        study.skin.mesh.triangles.len(),
    );
    writeln!(text, "{}: {}", study.folder.display(), study.title)?;
    writeln!(
        text,
        "skin: {vertices} vertices, {triangles} triangles, {} regions",
        study.skin.region_names.len().max(1)
    )?;
    for recording in &study.recordings {
        match recording.site.as_str() {
            "" => writeln!(text, "\n{} ({} held)", recording.name, recording.indenter)?,
            site => writeln!(
                text,
                "\n{} ({} at {site})",
                recording.name, recording.indenter
            )?,
        }
        match &recording.data {
            Data::Indentation(curve) => write_curve(text, curve)?,
            Data::PressureMap { map, sensels, .. } => {
                write_map(text, map)?;
                let placed = sensels.iter().flatten().flatten().count();
                writeln!(text, "  {placed} sensels placed on the product")?;
            }
            Data::Grasp {
                map,
                sensels,
                force,
                ..
            } => {
                write_map(text, map)?;
                let placed = sensels.iter().flatten().count();
                writeln!(text, "  {placed} sensels placed on the product")?;
                if let Some(force) = force {
                    write_curve(text, force)?;
                }
            }
            Data::Scan { mesh, .. } => {
                writeln!(text, "  scan of {} vertices", mesh.positions.len())?
            }
            Data::Handprint { print, sensels, .. } => {
                let [rows, columns] = print.cells;
                writeln!(
                    text,
                    "  print of {:.1} mm2 ink in {rows} x {columns} cells of {:.2} mm, threshold {:.3}",
                    print.inked_mm2, print.cell_mm, print.threshold
                )?;
                let placed = sensels.iter().flatten().flatten().count();
                writeln!(text, "  {placed} cells placed on the product")?;
                write_notes(text, &[], &print.unknown, &print.warnings)?;
            }
        }
    }
    Ok(())
}

fn write_map(text: &mut String, map: &PressureMap) -> Result<(), Error> {
    let missing = (0..map.sensels.len())
        .filter(|k| (0..map.frames()).all(|frame| map.frame(frame)[*k].is_nan()))
        .count();
    let unit = match map.unit {
        PressureUnit::Kilopascal => "kPa",
        PressureUnit::RawCounts => "raw counts",
        PressureUnit::NotStated => "values without unit",
    };
    writeln!(text, "  mat{}{}", named(&map.name), source(&map.source))?;
    write!(
        text,
        "  {} frames of {} sensels in {unit}",
        map.frames(),
        map.sensels.len() - missing
    )?;
    if let Some(grid) = map.grid() {
        write!(
            text,
            ", a grid of {} x {} with {missing} cells missing",
            grid.rows, grid.columns
        )?;
    }
    if let Some(times) = map.time_s.as_ref().filter(|times| !times.is_empty()) {
        write!(text, ", {:.3} to {:.3} s", times[0], times[times.len() - 1])?;
    }
    let peak = (0..map.frames())
        .map(|frame| map.peak(frame))
        .fold(0.0, f64::max);
    write!(
        text,
        "\n  largest value {peak:.1}, {} clipped",
        map.clipped_count()
    )?;
    let forces: Option<Vec<f64>> = (0..map.frames()).map(|frame| map.force_n(frame)).collect();
    if let Some(largest) = forces.map(|forces| forces.into_iter().fold(0.0, f64::max)) {
        write!(text, ", largest force {largest:.1} N")?;
    }
    writeln!(text)?;
    write_notes(text, &map.checks, &map.unknown, &map.warnings)
}

fn write_curve(text: &mut String, curve: &Curve) -> Result<(), Error> {
    writeln!(text, "  run{}{}", named(&curve.name), source(&curve.source))?;
    writeln!(text, "  {} samples", curve.samples())?;
    for channel in &curve.channels {
        let finite = || {
            channel
                .values
                .iter()
                .copied()
                .filter(|value| value.is_finite())
        };
        let (low, high) = (
            finite().fold(f64::INFINITY, f64::min),
            finite().fold(f64::NEG_INFINITY, f64::max),
        );
        let (low, high) = (number(low), number(high));
        writeln!(text, "    {}: {low} to {high}", channel.name)?;
    }
    for fact in &curve.facts {
        writeln!(text, "    {} = {}", fact.name, number(fact.value))?;
    }
    write_notes(text, &curve.checks, &curve.unknown, &curve.warnings)
}

/// Six decimals without zeros at their end, or a power of ten with six digits where those would not show it.
fn number(value: f64) -> String {
    match value.abs() {
        size if size > 0.0 && !(1e-2..1e7).contains(&size) => format!("{value:.5e}"),
        _ => {
            let text = format!("{value:.6}");
            let short = text.trim_end_matches('0').trim_end_matches('.');
            if short == "-0" { "0" } else { short }.to_string()
        }
    }
}

fn write_notes(
    text: &mut String,
    checks: &[Check],
    unknown: &[String],
    warnings: &[String],
) -> Result<(), Error> {
    checks
        .iter()
        .try_for_each(|check| writeln!(text, "  check: {check}"))?;
    unknown
        .iter()
        .try_for_each(|note| writeln!(text, "  not known: {note}"))?;
    warnings
        .iter()
        .try_for_each(|note| writeln!(text, "  warning: {note}"))
}

fn named(name: &str) -> String {
    if name.is_empty() {
        String::new()
    } else {
        format!(" {name:?}")
    }
}

fn source(source: &Source) -> String {
    let parts = [source.maker, &source.product, &source.sensor];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(" ({})", parts.join(", "))
    }
}
