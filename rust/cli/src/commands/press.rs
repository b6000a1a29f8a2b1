//! `thenar press`: reads the meshes, presses, writes the results.

use crate::fault::Fault;
use crate::regions::RegionTable;
use crate::results::Output;
use crate::{effects, interrupt, materials, protocol, regions, results, threads};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::Path;
use std::path::PathBuf;
use thenar_contact::{
    Contact, Control, ForceTarget, Keep, Model, Press, Run, Skin, SkinInput, Start, Unsolved,
    Workspace,
};
use thenar_recordings::meshes::{self, MeshFile};
use thenar_surface::{Mesh, Product, Vec3};

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

/// Reads, presses, writes, and tells what came out on the terminal.
///
/// # Errors
/// One sentence; then nothing was written.
pub fn run(arguments: &PressArguments) -> Result<(), Fault> {
    interrupt::watch()?;
    threads::use_only(arguments.threads)?;
    let control = Control {
        cancelled: &interrupt::is_cancelled,
        progress: &|_, _| {},
    };
    let (contact, regions, table) = press(arguments, &control)?;
    let [vertices, product] = results::tables(&contact);
    let summary = results::summary(&contact, &regions, said(arguments));
    let mut outputs = vec![vertices, product];
    outputs.extend(table);
    outputs.extend(results::shear_table(&contact));
    outputs.push(summary);
    interrupt::writing(|| results::write(&arguments.out, &outputs))?;
    crate::terminal::write(&report(&contact, &regions, &arguments.out));
    Ok(())
}

/// The contact, at the last row of a protocol if there is one, and then the protocol's table.
fn press(
    arguments: &PressArguments,
    control: &Control,
) -> Result<(Contact, RegionTable, Option<Output>), Fault> {
    let model = match arguments.model {
        ModelName::Layer => Model::Layer,
        ModelName::Paper => Model::Paper,
    };
    let hand = scaled(&arguments.hand, arguments)?;
    let regions = match &arguments.regions {
        Some(file) => regions::read(file, hand.positions.len())?,
        None => RegionTable::single(hand.positions.len()),
    };
    let materials = match &arguments.materials {
        Some(file) => materials::read(file, model, &regions)?,
        None => materials::presets(model, &regions),
    };
    let product = scaled(&arguments.product, arguments)?;
    let posed = arguments
        .posed
        .as_ref()
        .map(|file| scaled(file, arguments))
        .transpose()?;
    control.check()?;
    let notes = [(&arguments.hand, &hand), (&arguments.product, &product)].map(|(file, read)| {
        let say = |note: &String| format!("{}: {note}", file.display());
        read.notes.iter().map(say).collect::<Vec<String>>()
    });
    let product = mesh(product, &arguments.product)?;
    let product = Product::new(product).map_err(|error| named(&arguments.product, &error))?;
    let input = SkinInput {
        mesh: mesh(hand, &arguments.hand)?,
        regions: regions.regions.clone(),
        materials,
        model,
    };
    let mut skin = Skin::prepare_named(input, regions.names.clone(), control)?;
    let assumed = arguments.materials.is_none().then(|| model.preset_note());
    for note in notes.concat().into_iter().chain(assumed) {
        skin = skin.with_note(note);
    }
    if let Some(file) = &arguments.effects {
        skin = skin.with_effects(effects::read(file, &regions)?, control)?;
    }
    let mut workspace = Workspace::default();
    let mut pressing = workspace.on(&skin);
    let posed = posed.as_ref().map(|posed| posed.positions.as_slice());
    let direction = arguments.direction.map(Vec3::from);
    if let Some(file) = &arguments.protocol {
        let run = Run {
            product: &product,
            posed,
            protocol: &protocol::read(file, direction)?,
            keep: Keep::Totals,
        };
        let course = pressing.run(&run, control)?;
        let table = protocol::table(&course);
        return Ok((course.last, regions, Some(table)));
    }
    let press = Press {
        product: &product,
        posed,
        force: arguments
            .force
            .map(|newton| ForceTarget { newton, direction }),
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::kept_if(arguments.keep_unsolved),
    };
    Ok((pressing.press(&press, control)?, regions, None))
}

fn scaled(file: &Path, arguments: &PressArguments) -> Result<MeshFile, Fault> {
    let mut mesh = meshes::read(file)?;
    let millimeters = arguments.unit.millimeters();
    mesh.positions
        .iter_mut()
        .for_each(|position| *position *= millimeters);
    Ok(mesh)
}

fn mesh(read: MeshFile, file: &Path) -> Result<Mesh, Fault> {
    Mesh::new(read.positions, read.triangles).map_err(|error| named(file, &error))
}

fn named(file: &Path, error: &thenar_surface::MeshError) -> Fault {
    Fault::Input(format!("{}: {error}", file.display()))
}

/// What was asked, for the summary.
fn said(arguments: &PressArguments) -> Value {
    let name = |path: &Path| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    json!({
        "hand": name(&arguments.hand),
        "product": name(&arguments.product),
        "posed": arguments.posed.as_deref().map(name),
        "regions": arguments.regions.as_deref().map(name),
        "materials": arguments.materials.as_deref().map(name),
        "model": match arguments.model { ModelName::Layer => "layer", ModelName::Paper => "paper" },
        "force_n": arguments.force,
        "direction": arguments.direction,
        "protocol": arguments.protocol.as_deref().map(name),
        "effects": arguments.effects.as_deref().map(name),
    })
}

fn report(contact: &Contact, regions: &RegionTable, out: &Path) -> String {
    let mut text = format!(
        "{:>20} {:>10} {:>10} {:>10} {:>8}\n",
        "region", "force N", "area mm2", "peak kPa", "dmax mm"
    );
    for row in contact.regions.iter().filter(|row| row.force > 0.0) {
        let (name, peak) = (regions.name(row.index), 1e3 * row.peak);
        text += &format!(
            "{name:>20} {:>10.3} {:>10.1} {peak:>10.2} {:>8.2}\n",
            row.force, row.area, row.max_penetration
        );
    }
    let force: f64 = contact.nodal_force.iter().sum();
    let peak = 1e3 * contact.peak_pressure;
    text += &format!(
        "{:>20} {force:>10.3} {:>10.1} {peak:>10.2}\n",
        "all", contact.contact_area
    );
    text += &format!("{:>20} {:>10}\n", "grade", contact.grade().name());
    for warning in &contact.warnings {
        text += &format!("note: {warning}\n");
    }
    text + &format!("written to {}\n", out.display())
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
